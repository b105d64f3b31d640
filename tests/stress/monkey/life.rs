//! A life of the monkey: its acts in sequence, across crashes of the window, and its report after a failure.

use std::collections::VecDeque;
use std::panic::AssertUnwindSafe;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, Once, PoisonError};
use std::time::Duration;

use eframe::egui_wgpu::RenderState;
use resect::app::persist::session_file;
use resect::app::{Command, DeploymentCommand, ResultsCommand, SessionCommand};
use resect_io::sample::Sample;

use super::act::Act;
use super::dice::Dice;
use super::reached::Reached;
use super::screen::Screen;
use super::sessions::assert_same;
use super::things;
use crate::process::resident_mb;

/// Number of the last acts in the report.
const TOLD: usize = 25;

/// Panics on any thread: most threads of the window catch them and report a bug, which counts as well.
static PANICS: Mutex<Vec<String>> = Mutex::new(Vec::new());

fn panics() -> Vec<String> {
    std::mem::take(&mut *PANICS.lock().unwrap_or_else(PoisonError::into_inner))
}

fn watch_panics() {
    static WATCHED: Once = Once::new();
    WATCHED.call_once(|| {
        let before = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            before(info);
            PANICS.lock().unwrap_or_else(PoisonError::into_inner).push(info.to_string());
        }));
    });
}

pub struct Life {
    seed: u64,
    screen: Screen,
    things: Vec<PathBuf>,
    sessions: PathBuf,
    saved: Option<PathBuf>,
    told: VecDeque<String>,
    pub reached: Reached,
}

impl Life {
    pub fn new(gpu: &RenderState, folder: &Path, seed: u64) -> Self {
        watch_panics();
        let things = things::lay_out(folder);
        let sessions = folder.join("sessions");
        std::fs::create_dir(&sessions).expect("a folder");
        let screen = Screen::new(gpu, folder);
        Self {
            seed,
            screen,
            things,
            sessions,
            saved: None,
            told: VecDeque::new(),
            reached: Reached::default(),
        }
    }

    pub fn slowest(&self) -> Duration {
        self.screen.slowest
    }

    /// Does a number of acts.
    pub fn live(&mut self, acts: usize) {
        let trace = std::env::var_os("RESECT_MONKEY_TRACE").is_some();
        for number in 0..acts {
            let act = Dice::of(self.seed, number).act(&self.screen, &self.things);
            let mut told = format!("{number}: {act:?}");
            told.truncate(told.floor_char_boundary(300));
            if trace {
                eprintln!("{told}");
            }
            self.told.push_back(told);
            if self.told.len() > TOLD {
                self.told.pop_front();
            }
            let done = std::panic::catch_unwind(AssertUnwindSafe(|| self.act(number, act)));
            self.reached.look(self.screen.state());
            let panics = panics();
            if done.is_err() || !panics.is_empty() {
                let last: Vec<_> = self.told.iter().map(String::as_str).collect();
                let seed = self.seed;
                panic!(
                    "the monkey broke something in act {number}:\n{}\n\nits last acts:\n{}\n\nagain: RESECT_MONKEY_SEED={seed} \
                     cargo test{} --test stress a_monkey_breaks_nothing_in_a_short_while",
                    panics.join("\n"),
                    last.join("\n"),
                    if cfg!(debug_assertions) { "" } else { " --release" },
                );
            }
        }
    }

    fn act(&mut self, number: usize, act: Act) {
        match act {
            Act::CloseAll => self.close_all(),
            Act::SaveSession => self.save_session(number),
            Act::ReopenSaved => self.reopen_saved(),
            Act::Die => self.die(),
            Act::Exit => self.exit(),
            other => self.screen.perform(other),
        }
    }

    fn close_all(&mut self) {
        let state = self.screen.state();
        let close = state
            .deployments
            .open
            .iter()
            .map(|open| Command::Deployment(DeploymentCommand::Close(open.id)));
        let unpin =
            state.results.pins.iter().map(|pin| Command::Results(ResultsCommand::Unpin(pin.id)));
        let commands: Vec<Command> = close.chain(unpin).collect();
        commands.into_iter().for_each(|command| self.screen.send(command));
    }

    /// Saves into a file that has a name already, as a user does by the key.
    fn save_session(&mut self, number: usize) {
        self.screen.settle();
        let path = self.sessions.join(format!("{number}.resect.toml"));
        self.screen.window().state.session.path = Some(path.clone());
        let session = self.screen.state().session();
        self.screen.send(SessionCommand::Save);
        self.screen.settle();
        let (saved, findings) = session_file::load(&path).expect("saved");
        assert_eq!(findings, [], "what was just saved is whole");
        assert_same(&session, &saved, "in the file of the session");
        self.saved = Some(path);
    }

    fn reopen_saved(&mut self) {
        let Some(path) = self.saved.clone() else { return };
        let (saved, _) = session_file::load(&path).expect("saved");
        // Earlier dropped files that are still being opened are added: no request is lost.
        self.screen.settle();
        self.screen.perform(Act::Drop(vec![path]));
        self.screen.settle();
        assert_same(&saved, &self.screen.state().session(), "in the session that is opened again");
    }

    fn die(&mut self) {
        self.screen.send(ResultsCommand::CancelStudy);
        let had = self.screen.state().session();
        self.screen.die();
        self.screen.start();
        self.screen.settle();
        let has = self.screen.state().session();
        // Without open deployments nothing is restored; the layout is stored with the preferences, the view is not.
        if had.is_empty() {
            assert!(has.is_empty());
        } else {
            assert_same(&had, &has, "after the window died");
        }
    }

    fn exit(&mut self) {
        self.screen.send(ResultsCommand::CancelStudy);
        // A deployment that is being opened when the window closes may or may not be restored.
        self.screen.settle();
        let had = self.screen.state().session();
        self.screen.exit();
        self.screen.start();
        self.screen.settle();
        assert!(self.screen.state().session().is_empty(), "a clean exit leaves nothing to restore");
        if !had.is_empty() {
            self.screen.send(SessionCommand::ReopenLast);
            self.screen.settle();
            let has = self.screen.state().session();
            assert_same(&had, &has, "in what was open last");
        }
    }

    /// Opens, draws and closes all samples repeatedly; returns the resident size (MB) after each round.
    pub fn open_and_close(&mut self, rounds: usize) -> Vec<f64> {
        let round = |_| {
            for sample in Sample::ALL {
                self.screen.send(DeploymentCommand::OpenSample(sample));
            }
            let folder = self.things.iter().find(|path| path.ends_with("eight"));
            self.screen.send(DeploymentCommand::OpenPaths(folder.into_iter().cloned().collect()));
            self.screen.settle();
            assert_eq!(self.screen.state().deployments.open.len(), 3);
            self.close_all();
            self.screen.settle();
            resident_mb()
        };
        (0..rounds).map(round).collect()
    }
}
