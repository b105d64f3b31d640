//! The live deployment: it is started and stopped in the background, and its data extends the open deployment.

use resect_core::network::{MOST_STATIONS, PerStation};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use super::State;
use crate::app::file_dialog::{Question, Wanted as WantedPath};
use crate::app::layout::Layout;
use crate::app::model::live::{LiveCommand, LiveForm};
use crate::app::model::{Analysing, LayoutPreset, Pane};
use crate::app::persist::session::Files;
use resect_core::analysis::{Analysis, Settings};
use resect_core::deployment::Deployment;
use resect_io::growing::Growing;
use resect_io::source::{Extras, Source};
use resect_live::{Feed, Finished, Pace, Session, Wanted};

impl State {
    pub(super) fn handle_live(&mut self, command: LiveCommand) {
        match command {
            LiveCommand::Show => {
                // A layout that the user has changed is kept.
                if self.workspace.layout.is_as_chosen() {
                    self.workspace.layout = Layout::from(LayoutPreset::Live);
                }
                self.workspace.layout.show(Pane::Live);
            }
            LiveCommand::Edit(form) => {
                if let Some(session) = &self.live.session
                    && form.target_mm != self.live.form.target_mm
                {
                    session.aim(form.target_mm * 1e-3);
                }
                self.live.form = form;
            }
            LiveCommand::ChooseReplay => {
                let wanted = WantedPath::ToOpen { folder: true };
                let question = Question::new("Replay a deployment", wanted);
                self.ask_for_live(question, |form, path| form.replay = Some(path));
            }
            LiveCommand::ChooseKnown => {
                let wanted = WantedPath::ToOpen { folder: true };
                let question = Question::new("Folder or file with the rig", wanted);
                self.ask_for_live(question, |form, path| form.known = Some(path));
            }
            LiveCommand::ChooseRecord => {
                let question = Question::new_file("Record the stream", &record_name(), "mcap");
                self.ask_for_live(question, |form, path| form.record = Some(path));
            }
            LiveCommand::Connect => self.connect(),
            LiveCommand::Stop => self.stop_live(),
        }
    }

    fn ask_for_live(&mut self, question: Question, take: fn(&mut LiveForm, PathBuf)) {
        let answer = self.ask(question);
        self.jobs.start_unnumbered(
            move || answer.wait(),
            move |state: &mut Self, path| take(&mut state.live.form, path),
        );
    }

    /// Starts the session in the background, as name resolution and large deployments take time.
    fn connect(&mut self) {
        if self.live.is_running() || self.live.is_changing {
            return;
        }
        let wanted = wanted(&self.live.form, *self.settings());
        (self.live.is_changing, self.live.trouble) = (true, None);
        self.live.wanted = Some(wanted.clone());
        self.jobs.start_unnumbered(
            move || Some(Session::start(&wanted).map_err(|error| error.to_string())),
            |state: &mut Self, begun| {
                state.live.is_changing = false;
                match begun {
                    Ok(session) => {
                        (state.live.session, state.live.id) = (Some(session), None);
                        (state.live.view, state.live.closing) = (None, None);
                        state.live.was_closed = false;
                        state.live.pace = Pace::default();
                    }
                    Err(line) => state.live.trouble = Some(line),
                }
            },
        );
    }

    /// Stops the session in the background, after it has processed the data in transit and closed the recording.
    fn stop_live(&mut self) {
        let Some(session) = self.live.session.take() else { return };
        (self.live.is_changing, self.live.is_ending) = (true, true);
        self.jobs.start_unnumbered(
            move || Some(session.stop()),
            |state: &mut Self, finished| {
                (state.live.is_changing, state.live.is_ending) = (false, false);
                if let Some(finished) = finished {
                    state.take_finished(finished);
                }
            },
        );
    }

    /// Waits until the recording is closed, before the window closes.
    pub(super) fn finish_live(&mut self) {
        self.live.session = None;
        while self.live.is_ending && self.wait_for_outcome() {}
        // A session that was just started is dropped.
        self.live.session = None;
    }

    fn take_finished(&mut self, finished: Finished) {
        let Finished { deployment, view, recorded, closing } = finished;
        (self.live.view, self.live.closing) = (Some(Arc::new(view)), Some(closing));
        match recorded {
            Some(Ok(recorded)) => {
                self.toasts.done(format!("recorded to {}", recorded.path.display()));
            }
            Some(Err(error)) => self.live.trouble = Some(error.to_string()),
            None => {}
        }
        if let (Ok(deployment), false) = (deployment, self.live.was_closed) {
            self.grow(Arc::new(deployment));
        }
    }

    /// Returns the source of the recording, even while it is written, so that it can be reopened if the window is killed; of a
    /// replay that is not recorded, the replayed deployment.
    fn recorded_source(&self) -> Option<Source> {
        let LiveForm { known, replay, .. } = &self.live.form;
        let recorded = self.live.view.as_ref().and_then(|view| view.recorded.as_ref());
        let Some(path) = recorded.map(|recorded| recorded.path.clone()) else {
            return replay.as_ref().map(Source::at);
        };
        // A replay has its rig beside it.
        let rig = replay.clone().or_else(|| known.clone());
        Some(Source::at(path).with(Extras { rig, ..Extras::default() }))
    }

    /// Polls the session once a frame, at a time of the window's clock (s); returns true while there is one.
    pub fn follow_live(&mut self, now_s: f64) -> bool {
        let Some(session) = &self.live.session else { return self.live.is_changing };
        self.live.view = Some(session.view());
        let has_ended = session.has_ended();
        let id = self.live.id;
        let growing = self.deployments.open.iter().find(|open| Some(open.id) == id);
        if let Some(open) = growing {
            session.set(&open.settings);
        }
        // Closing the deployment stops the session; the recording up to then is kept.
        if growing.is_none() && id.is_some() {
            self.live.was_closed = true;
            self.stop_live();
            return true;
        }
        // The next snapshot follows once the last one has its joint estimate, after a pause.
        if growing.is_none_or(|open| open.analysing.is_none()) {
            self.live.pace.end(now_s);
            if self.live.pace.is_free(now_s)
                && let Some(deployment) = session.take_deployment()
            {
                self.live.pace.begin(now_s);
                self.grow(deployment);
            }
        }
        if has_ended {
            self.stop_live();
        }
        true
    }

    /// Extends the open deployment to more readings. The old data stays until the new result is computed.
    fn grow(&mut self, deployment: Arc<Deployment>) {
        let id = self.live.id;
        let Some(index) = self.deployments.open.iter().position(|open| Some(open.id) == id) else {
            let source = self.recorded_source();
            self.add(deployment, source);
            self.live.id = Some(self.deployments.newest_id);
            // The cursor follows the newest data until the user moves it.
            if let Some(open) = self.deployments.open.last_mut() {
                open.timeline.move_cursor(open.now_s());
            }
            return;
        };
        let number = self.jobs.next_number();
        let open = &mut self.deployments.open[index];
        // Cached results of fewer readings are not valid for more.
        self.analyser.forget(open.id);
        self.analyser.analyse(number, open.id, Arc::clone(&deployment), open.settings);
        self.session.files.insert(open.id, Files::of(&deployment));
        open.more = Some(deployment);
        // The displayed result stays valid meanwhile, but for fewer readings.
        open.analysing = Some(Analysing { number, since: Instant::now(), joint_follows: true });
    }

    /// Applies a new source to a growing deployment, including its future readings; in the background, since it reads files.
    pub(super) fn apply_live_corrections(&mut self, id: u64, source: Source, step: bool) {
        let Some(wanted) = self.live.wanted.clone() else { return };
        let mut extras = source.extras.clone();
        // A rig at the form's path, and topics that are not given, are taken from the session's parameters.
        let LiveForm { known, replay, .. } = &self.live.form;
        if extras.rig == *replay || extras.rig == *known {
            extras.rig = wanted.extras.rig.clone();
        }
        let topics = wanted.extras.corrections.topics.clone();
        extras.corrections.topics = extras.corrections.topics.take().or(topics);
        let Some(open) = self.deployments.get_mut(id) else { return };
        let before = open.source.replace(source.clone());
        self.jobs.start_unnumbered(
            move || Some(resect_live::around(&wanted, &extras).map_err(|error| error.to_string())),
            move |state: &mut Self, read| {
                state.accept_live_corrections(id, [before, Some(source)], step, read);
            },
        );
    }

    fn accept_live_corrections(
        &mut self,
        id: u64,
        [before, after]: [Option<Source>; 2],
        step: bool,
        read: Result<Growing, String>,
    ) {
        let Some(open) = self.deployments.get_mut(id) else { return };
        // A newer correction has priority.
        let is_newest = open.source == after;
        let around = match read {
            Ok(around) => around,
            Err(line) => {
                if is_newest {
                    open.source = before;
                }
                self.toasts.error(&line);
                return;
            }
        };
        let (Some(before), Some(after)) = (before, after) else { return };
        if step {
            self.record_extras(id, before.extras, after.extras.clone());
        }
        match &self.live.session {
            _ if !is_newest => {}
            Some(session) if !session.has_ended() => session.read_with(around),
            // Replaced as any other deployment.
            _ => self.replace_by(id, after, false),
        }
    }

    /// Passes a result of the growing deployment to the coach. `is_first` marks a preliminary result; the first final one
    /// after the end covers all readings.
    pub(super) fn tell_live(&mut self, id: u64, analysis: &Arc<Analysis>, is_first: bool) {
        let growing =
            self.deployments.open.iter().find(|open| open.id == id && Some(id) == self.live.id);
        if let (Some(session), Some(open)) = (&self.live.session, growing) {
            session.answered(Arc::clone(&open.deployment), Arc::clone(analysis), is_first);
        } else if let (Some(open), Some(view), false) = (growing, &self.live.view, is_first)
            && let Some(closing) = self.live.closing.take()
        {
            let view = closing.judged(view, &open.deployment, analysis);
            self.live.view = Some(Arc::new(view));
        }
    }
}

/// Returns a name for a recording that starts now.
fn record_name() -> String {
    let now = jiff::Zoned::now();
    format!("live {}", now.strftime("%Y-%m-%d %H-%M-%S"))
}

fn wanted(form: &LiveForm, settings: Settings) -> Wanted {
    let feed = match &form.replay {
        Some(path) => Feed::Replay { source: Box::new(Source::at(path)), speed: form.speed },
        None => Feed::Url(form.address.clone()),
    };
    // A folder contains more than its rig.
    let (deployment, rig) = match &form.known {
        Some(path) if path.is_dir() => (Some(path.clone()), None),
        known => (None, known.clone()),
    };
    let mut extras = Extras { rig, ..Extras::default() };
    let names: Vec<String> = form.stations.split(',').map(|name| name.trim().to_owned()).collect();
    let are_names = names.len() <= MOST_STATIONS && names.iter().all(|name| !name.is_empty());
    let mut instruments: Option<PerStation<String>> =
        are_names.then(|| names.into_iter().collect());
    if instruments.as_ref().is_some_and(|names| names.iter().all(|name| name.starts_with('/'))) {
        extras.corrections.topics = instruments.take();
    }
    let home = || {
        let folders = directories::UserDirs::new();
        let home = folders
            .as_ref()
            .map(|folders| folders.document_dir().unwrap_or_else(|| folders.home_dir()).to_owned());
        home.unwrap_or_default().join(format!("{}.mcap", record_name()))
    };
    let record = form.record.clone().or_else(|| form.replay.is_none().then(home));
    Wanted {
        feed,
        deployment,
        extras,
        instruments,
        settings,
        record,
        target_m: form.target_mm * 1e-3,
        calculates: false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// So that no live run is lost with its window.
    #[test]
    fn every_stream_is_recorded_and_a_replay_only_on_request() {
        let recording = |form: LiveForm| wanted(&form, Settings::default()).record;
        let name = recording(LiveForm::default()).expect("recorded");
        assert_eq!(name.extension().and_then(|extension| extension.to_str()), Some("mcap"));
        let replay = LiveForm { replay: Some("drive".into()), ..LiveForm::default() };
        assert_eq!(recording(replay.clone()), None);
        let record = Some(PathBuf::from("again.mcap"));
        assert_eq!(recording(LiveForm { record: record.clone(), ..replay }), record);
    }
}
