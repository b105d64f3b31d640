use super::*;
use crate::app::model::DeploymentCommand;
use crate::app::persist::hashes::HashCache;
use resect_core::analysis::Settings;
use resect_io::sample::Sample;

fn state() -> State {
    State::new(Default::default())
}

fn saved(source: Source) -> SavedDeployment {
    SavedDeployment {
        source,
        settings: Settings::default(),
        cursor_s: None,
        window_s: None,
        selection_s: None,
        files: Default::default(),
        estimates: Vec::new(),
    }
}

/// Two samples around a missing deployment; the second sample is active.
fn session() -> Session {
    let sources = [
        Source::sample(Sample::Warthog),
        Source::at("/nowhere/at all"),
        Source::sample(Sample::Hd2Tunnel),
    ];
    Session { deployments: sources.map(saved).into(), active: 2, ..Session::default() }
}

fn sources(session: &Session) -> Vec<Source> {
    session.deployments.iter().map(|saved| saved.source.clone()).collect()
}

#[test]
fn a_missing_deployment_keeps_its_place() {
    let mut state = state();
    state.restore(session());
    state.settle();
    assert_eq!((state.deployments.open.len(), state.session.missing.len()), (2, 1));
    for _ in 0..2 {
        let again = state.session();
        assert_eq!((sources(&again), again.active), (sources(&session()), 2));
        state.retry_missing();
        state.settle();
    }
}

#[test]
fn what_the_user_activates_stays_shown_while_others_are_restored() {
    let mut state = state();
    state.add(Arc::new(Sample::Warthog.open().expect("built in")), None);
    let id = state.deployments.open[0].id;
    state.restore(session());
    state.handle(DeploymentCommand::Activate(id), &Default::default());
    state.settle();
    assert_eq!(state.deployments.open.len(), 3);
    assert_eq!(state.active().map(|open| open.id), Some(id));
}

#[test]
fn a_cancelled_deployment_stays_in_the_session_and_that_is_said() {
    let mut state = state();
    state.restore(session());
    let number = state.deployments.opening[0].number;
    state.take_opened(number, Err(resect_io::error::OpenError::Cancelled));
    state.settle();
    let again = state.session();
    assert_eq!(sources(&again), sources(&session()));
    let title = session().deployments[0].source.title();
    let line = format!("{title}: reading was cancelled (it stays in the session)");
    assert!(state.toasts.errors().any(|(text, _)| text == line), "{:?}", state.toasts);
}

#[test]
fn a_session_saved_after_another_was_opened_does_not_give_it_its_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str| folder.path().join(name);
    session().save(&file("b"), &HashCache::default()).expect("saved");
    let mut state = state();
    state.session.path = Some(file("a"));
    state.save_session(false);
    let opened = Ok((session(), Vec::new()));
    state.take_session(0, file("b"), opened);
    state.settle();
    assert!(file("a").is_file());
    assert_eq!(state.session.path, Some(file("b")));
}
