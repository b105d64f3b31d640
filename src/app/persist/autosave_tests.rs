use std::collections::BTreeSet;
use std::process::{Command, Stdio};
use std::time::Duration;

use super::*;
use crate::app::persist::session::SavedDeployment;
use resect_io::sample::Sample;
use resect_io::source::Source;

/// Environment variable of the child process, with the folder in which it saves until it is killed.
const CHILD_FOLDER: &str = "RESECT_TEST_SAVING_CHILD";

fn start(folder: &Path) -> (Autosave, Option<Recovered>, Vec<Finding>) {
    Autosave::start(folder, Arc::default()).expect("a folder")
}

/// A session with `count` deployments, the last of which is shown.
fn session(count: usize) -> Session {
    let saved = |number: usize| SavedDeployment {
        source: Source::at(format!("/data/deployment {number}")),
        settings: Default::default(),
        cursor_s: Some(number as f64),
        window_s: None,
        selection_s: None,
        files: Default::default(),
        estimates: Vec::new(),
    };
    Session {
        deployments: (0..count).map(saved).collect(),
        active: count.saturating_sub(1),
        ..Session::default()
    }
}

fn names(folder: &Path) -> BTreeSet<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    entries
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect()
}

/// Simulates a crash: the lock is released with the process, and the file remains.
fn die(autosave: Autosave) {
    autosave.writer.finish();
    drop(autosave);
}

/// Starts after a crash. A process that another test forks at that moment may briefly keep the crashed window's lock.
fn start_after_death(folder: &Path) -> (Autosave, Option<Recovered>, Vec<Finding>) {
    for _ in 0..400 {
        let started = start(folder);
        if started.1.is_some() {
            return started;
        }
        started.0.finish();
        std::thread::sleep(Duration::from_millis(5));
    }
    start(folder)
}

#[test]
fn what_a_window_that_died_had_open_comes_back_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut first, recovered, _) = start(folder.path());
    assert!(recovered.is_none());
    first.offer(session(2));
    first.offer(session(3));
    die(first);
    let (mut second, recovered, findings) = start_after_death(folder.path());
    assert_eq!(findings, []);
    let (back, _) = second.take_over(recovered.expect("what was open"));
    assert_eq!(back, session(3));
    // A second crash before anything was written loses nothing.
    die(second);
    let (mut third, recovered, _) = start_after_death(folder.path());
    let (back, _) = third.take_over(recovered.expect("what was open"));
    assert_eq!(back, session(3));
    third.offer(back);
    third.writer.finish();
    assert_eq!(names(folder.path()).len(), 2, "its own file and lock, and no other's");
    third.finish();
    assert_eq!(names(folder.path()), BTreeSet::new(), "a clean exit leaves nothing");
    assert!(start(folder.path()).1.is_none());
}

#[test]
fn two_windows_at_once_leave_each_other_alone() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut first, ..) = start(folder.path());
    first.offer(session(1));
    first.writer.finish();
    let (mut second, recovered, _) = start(folder.path());
    assert!(recovered.is_none(), "the first window lives");
    second.offer(session(2));
    second.finish();
    assert_eq!(names(folder.path()).len(), 2);
    die(first);
    let (_, recovered, _) = start_after_death(folder.path());
    assert_eq!(recovered.expect("the first window's").session, session(1));
}

#[test]
fn an_empty_window_leaves_nothing_to_restore() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut window, ..) = start(folder.path());
    window.offer(session(1));
    window.offer(Session::default());
    die(window);
    // As in `start_after_death`, the lock may not be free at once.
    let mut left = usize::MAX;
    for _ in 0..400 {
        let (window, recovered, _) = start(folder.path());
        assert!(recovered.is_none());
        left = names(folder.path()).len();
        window.finish();
        if left == 1 {
            break;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    assert_eq!(left, 1, "only the lock of the new window");
}

#[test]
fn what_cannot_be_restored_is_kept_aside_and_said() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("1-2-0.toml"), "resect_session = 1\nactive = [")
        .expect("written");
    std::fs::write(folder.path().join("1-3-0.toml"), "resect_session = 9\nresect = \"7.0\"\n")
        .expect("written");
    let (window, recovered, findings) = start(folder.path());
    assert!(recovered.is_none());
    let said: Vec<String> = findings.iter().map(ToString::to_string).collect();
    assert_eq!(said.len(), 2, "{said:?}");
    assert!(said.iter().any(|line| line.contains("1-2-0.toml:2")), "{said:?}");
    assert!(said.iter().any(|line| line.contains("newer resect (7.0)")), "{said:?}");
    window.finish();
    let kept = ["1-2-0.toml.bak", "1-3-0.toml.bak"].map(str::to_owned);
    assert_eq!(names(folder.path()), BTreeSet::from(kept));
}

#[test]
fn what_could_not_be_written_is_tried_again_and_told_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut window, ..) = start(folder.path());
    // A folder at the file's path prevents writing.
    std::fs::create_dir(&window.file.path).expect("created");
    assert!(window.offer(session(1)));
    window.writer.finish();
    let error = window.take_error().expect("told");
    assert!(error.contains("cannot be written"), "{error}");
    assert!(window.offer(session(1)), "the same once more");
    window.writer.finish();
    assert_eq!(window.take_error(), None, "told already");
    std::fs::remove_dir(&window.file.path).expect("removed");
    assert!(window.offer(session(1)));
    assert!(!window.offer(session(1)), "on its way");
    die(window);
    let (_, recovered, _) = start_after_death(folder.path());
    assert_eq!(recovered.expect("what was open").session, session(1));
}

/// The process that the next test kills; not a test by itself.
#[test]
fn child_that_saves_until_it_is_killed() {
    let Some(folder) = std::env::var_os(CHILD_FOLDER) else { return };
    let folder = PathBuf::from(folder);
    let (mut autosave, ..) = start(&folder.join("autosave"));
    for round in 0.. {
        let session = session(1 + round % 200);
        session.save(&folder.join("session.resect.toml"), &HashCache::default()).expect("saved");
        autosave.offer(session);
    }
}

#[cfg(unix)]
#[test]
fn a_killed_process_damages_neither_session_nor_autosave() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("session.resect.toml");
    std::fs::create_dir(folder.path().join("autosave")).expect("created");
    let name = concat!(module_path!(), "::child_that_saves_until_it_is_killed");
    let name = name.split_once("::").expect("a path").1;
    let whole = |session: &Session| session.active + 1 == session.deployments.len();
    for kill in 0..50 {
        let mut child = Command::new(std::env::current_exe().expect("this program"))
            .args(["--exact", name])
            .env(CHILD_FOLDER, folder.path())
            .stdout(Stdio::null())
            .spawn()
            .expect("started");
        let before = path.metadata().and_then(|metadata| metadata.modified()).ok();
        let autosaved =
            || names(&folder.path().join("autosave")).iter().any(|name| name.ends_with(".toml"));
        while path.metadata().and_then(|metadata| metadata.modified()).ok() == before
            || !autosaved()
        {
            // A save may take any time on a busy machine.
            assert!(child.try_wait().expect("a child").is_none(), "the child ended by itself");
            std::thread::sleep(Duration::from_micros(200));
        }
        std::thread::sleep(Duration::from_micros(311 * kill));
        // After SIGKILL, the child executes nothing.
        child.kill().expect("killed");
        child.wait().expect("gone");
        let (session, findings) = session_file::load(&path).expect("whole");
        assert!(whole(&session) && findings.is_empty());
        let (window, recovered, findings) = start(&folder.path().join("autosave"));
        assert_eq!(findings, [], "kill {kill}");
        let recovered = recovered.expect("what was open");
        assert!(whole(&recovered.session), "kill {kill}");
        recovered.file.remove();
        window.finish();
    }
    assert_eq!(names(&folder.path().join("autosave")), BTreeSet::new(), "nothing is left behind");
}

#[test]
fn a_sample_is_worth_restoring_too() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut window, ..) = start(folder.path());
    let mut sample = session(1);
    sample.deployments[0].source = Source::sample(Sample::Hd2Tunnel);
    window.offer(sample.clone());
    die(window);
    let (_, recovered, _) = start_after_death(folder.path());
    assert_eq!(recovered.expect("what was open").session, sample);
}
