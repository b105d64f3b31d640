//! The live deployment: it is begun and ended beside the window, and what it gives grows in the open deployment.

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
                // An arrangement of the user's own is left as it is.
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
                // It is on disk already.
                self.ask_for_live(question, |form, path| {
                    (form.replay, form.records) = (Some(path), false);
                });
            }
            LiveCommand::ChooseKnown => {
                let wanted = WantedPath::ToOpen { folder: true };
                let question = Question::new("Folder or file with the rig", wanted);
                self.ask_for_live(question, |form, path| form.known = Some(path));
            }
            LiveCommand::ChooseRecord => {
                let question = Question::new_file("Record what comes in", &record_name(), "mcap");
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

    /// Begins to listen, beside the window: names of computers and large deployments take their time.
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

    /// Ends it beside the window: what is on its way is taken in, and the recording is ended.
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

    /// Waits until nothing is recorded any more: the window is closed.
    pub(super) fn finish_live(&mut self) {
        self.live.session = None;
        while self.live.is_ending && self.wait_for_outcome() {}
        // One that has just begun is not listened to.
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

    /// Where what is recorded can be read again, whether or not it is still written: a window that is killed opens it again.
    fn recorded_source(&self) -> Option<Source> {
        let path = self.live.view.as_ref()?.recorded.as_ref()?.path.clone();
        // What was replayed has its rig beside it.
        let LiveForm { known, replay, .. } = &self.live.form;
        let rig = replay.clone().or_else(|| known.clone());
        Some(Source::at(path).with(Extras { rig, ..Extras::default() }))
    }

    /// Looks at what listens, once a frame, at a time of the window's clock (s); tells whether anything does.
    pub fn follow_live(&mut self, now_s: f64) -> bool {
        let Some(session) = &self.live.session else { return self.live.is_changing };
        self.live.view = Some(session.view());
        let has_ended = session.has_ended();
        let id = self.live.id;
        let growing = self.deployments.open.iter().find(|open| Some(open.id) == id);
        if let Some(open) = growing {
            session.set(&open.settings);
        }
        // Who closes it wants no more of it; what was recorded by then is kept.
        if growing.is_none() && id.is_some() {
            self.live.was_closed = true;
            self.stop_live();
            return true;
        }
        // The next snapshot is taken once the last one has its answer, the joint estimate's too, and a rest after that.
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

    /// The deployment has more readings than the one that is open; its answer takes the place of that one's with it.
    fn grow(&mut self, deployment: Arc<Deployment>) {
        let id = self.live.id;
        let Some(index) = self.deployments.open.iter().position(|open| Some(open.id) == id) else {
            let source = self.recorded_source();
            self.add(deployment, source);
            self.live.id = Some(self.deployments.newest_id);
            // The cursor follows what comes until it is moved.
            if let Some(open) = self.deployments.open.last_mut() {
                open.timeline.move_cursor(open.now_s());
            }
            return;
        };
        let number = self.jobs.next_number();
        let open = &mut self.deployments.open[index];
        // What is remembered of fewer readings must not answer for more.
        self.analyser.forget(open.id);
        self.analyser.analyse(number, open.id, Arc::clone(&deployment), open.settings);
        self.session.files.insert(open.id, Files::of(&deployment));
        open.more = Some(deployment);
        // An answer is shown meanwhile, which is not wrong, but of fewer readings.
        open.analysing = Some(Analysing { number, since: Instant::now(), joint_follows: true });
    }

    /// Has a growing deployment read with what its source says now, what comes from now on too. Beside the window, for files are read.
    pub(super) fn put_right_live(&mut self, id: u64, source: Source, step: bool) {
        let Some(wanted) = self.live.wanted.clone() else { return };
        let mut extras = source.extras.clone();
        // What lies where the readings come from, or was named before, is read there.
        let LiveForm { known, replay, .. } = &self.live.form;
        if extras.rig == *replay || extras.rig == *known {
            extras.rig = wanted.extras.rig.clone();
        }
        let topics = wanted.extras.put_right.topics.clone();
        extras.put_right.topics = extras.put_right.topics.take().or(topics);
        let Some(open) = self.deployments.get_mut(id) else { return };
        let before = open.source.replace(source.clone());
        self.jobs.start_unnumbered(
            move || Some(resect_live::around(&wanted, &extras).map_err(|error| error.to_string())),
            move |state: &mut Self, read| {
                state.take_put_right(id, [before, Some(source)], step, read);
            },
        );
    }

    fn take_put_right(
        &mut self,
        id: u64,
        [before, after]: [Option<Source>; 2],
        step: bool,
        read: Result<Growing, String>,
    ) {
        let Some(open) = self.deployments.get_mut(id) else { return };
        // What was put right since then counts.
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
            // It is read as any other.
            _ => self.replace_by(id, after, false),
        }
    }

    /// An answer to the growing deployment, for the coach; the first of the settings after the end is to all readings.
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

/// A name for a recording that is begun now.
fn record_name() -> String {
    let now = jiff::Zoned::now();
    format!("live {}", now.strftime("%Y-%m-%d %H-%M-%S"))
}

fn wanted(form: &LiveForm, settings: Settings) -> Wanted {
    let feed = match &form.replay {
        Some(path) => Feed::Replay { source: Box::new(Source::at(path)), speed: form.speed },
        None => Feed::Url(form.address.clone()),
    };
    // A folder says more than its rig.
    let (deployment, rig) = match &form.known {
        Some(path) if path.is_dir() => (Some(path.clone()), None),
        known => (None, known.clone()),
    };
    let mut extras = Extras { rig, ..Extras::default() };
    let names: Vec<String> = form.stations.split(',').map(|name| name.trim().to_owned()).collect();
    let mut instruments = <[String; 3]>::try_from(names).ok();
    if instruments.as_ref().is_some_and(|names| names.iter().all(|name| name.starts_with('/'))) {
        extras.put_right.topics = instruments.take();
    }
    let home = || {
        let folders = directories::UserDirs::new();
        let home = folders
            .as_ref()
            .map(|folders| folders.document_dir().unwrap_or_else(|| folders.home_dir()).to_owned());
        home.unwrap_or_default().join(format!("{}.mcap", record_name()))
    };
    let record = form.records.then(|| form.record.clone().unwrap_or_else(home));
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
