//! What a running window keeps: preferences for all windows, and its own session for the case that it dies.
//!
//! Pictures and tests keep nothing: they have none of this.

use std::sync::Arc;
use std::time::{Duration, Instant, SystemTime};

use eframe::egui;

use super::Folders;
use super::autosave::{Autosave, Recovered};
use super::hashes::HashCache;
use super::preferences::{Preferences, PreferencesFile};
use crate::app::layout::Layout;
use crate::app::state::State;
use crate::deployment::Finding;

/// How often the window is looked at for changes.
const EVERY: Duration = Duration::from_secs(3);

pub struct Keeping {
    file: PreferencesFile,
    preferences: Preferences,
    /// None where there is no folder to write to.
    autosave: Option<Autosave>,
    cache: Arc<HashCache>,
    /// What a window that died had open, until this one has it.
    recovered: Option<Recovered>,
    findings: Vec<Finding>,
    looked: Instant,
}

impl Keeping {
    /// Reads what was kept. What cannot be read or written is said when the window opens, and stops nothing.
    pub fn start(folders: &Folders) -> Self {
        let (file, preferences, mut findings) = PreferencesFile::open(&folders.config);
        let cache = Arc::new(HashCache::default());
        let (autosave, recovered) = match Autosave::start(&folders.autosave, Arc::clone(&cache)) {
            Ok((autosave, recovered, found)) => {
                findings.extend(found);
                (Some(autosave), recovered)
            }
            Err(error) => {
                let folder = folders.autosave.display();
                findings.push(Finding::warning(format!(
                    "{folder}: {error}; what is open will not be restored if resect stops"
                )));
                (None, None)
            }
        };
        Self { file, preferences, autosave, cache, recovered, findings, looked: Instant::now() }
    }

    pub fn preferences(&self) -> &Preferences {
        &self.preferences
    }

    /// Whether there is something to restore.
    pub fn has_recovered(&self) -> bool {
        self.recovered.is_some()
    }

    /// Gives a new window what was kept: to be called before anything is opened in it.
    pub fn begin(&mut self, ctx: &egui::Context, state: &mut State, layout: &mut Layout) {
        ctx.set_theme(egui::ThemePreference::from(self.preferences.theme));
        state.units = self.preferences.units;
        state.session.recent = self.preferences.recent.clone();
        state.session.share(Arc::clone(&self.cache));
        let mut findings = std::mem::take(&mut self.findings);
        if let Some(description) = &self.preferences.layout {
            let (kept, found) = Layout::of_description(description);
            *layout = kept;
            findings.extend(found);
        }
        if let (Some(autosave), Some(recovered)) = (&mut self.autosave, self.recovered.take()) {
            let when = recovered.saved.map(ago).unwrap_or_default();
            state.toasts.done(format!("restored what was open when resect stopped{when}"));
            let (session, found) = autosave.take_over(recovered);
            findings.extend(found);
            state.restore(session);
        }
        state.tell(&findings);
    }

    /// To be called in every frame. Every few seconds it has written what changed, in the background.
    pub fn frame(&mut self, ctx: &egui::Context, state: &mut State, layout: &Layout) {
        let since = self.looked.elapsed();
        if since < EVERY {
            // A last look after the user's last move.
            ctx.request_repaint_after(EVERY - since);
            return;
        }
        self.look(ctx, state, layout);
        let autosave = self.autosave.as_ref().and_then(Autosave::take_error);
        if let Some(line) = autosave.or(self.file.take_error()) {
            state.toasts.error(&line);
        }
    }

    fn look(&mut self, ctx: &egui::Context, state: &State, layout: &Layout) {
        self.looked = Instant::now();
        let described = layout.describe();
        let size = ctx.input(|input| {
            let viewport = input.viewport();
            let normal =
                !viewport.maximized.unwrap_or(false) && !viewport.fullscreen.unwrap_or(false);
            viewport.inner_rect.filter(|_| normal).map(|rect| [rect.width(), rect.height()])
        });
        self.preferences = Preferences {
            theme: ctx.options(|options| options.theme_preference).into(),
            units: state.units,
            // The first layout stays the program's: a newer one may have a better.
            layout: Some(&described).filter(|it| **it != Layout::default().describe()).cloned(),
            window_points: size.or(self.preferences.window_points),
            recent: state.session.recent.clone(),
        };
        self.file.keep(&self.preferences);
        if let Some(autosave) = &mut self.autosave {
            autosave.offer(state.session(described));
        }
    }

    /// The user closes the window: preferences are kept, and nothing is left to be restored.
    pub fn finish(mut self, ctx: &egui::Context, state: &State, layout: &Layout) {
        self.look(ctx, state, layout);
        self.file.finish();
        if let Some(autosave) = self.autosave {
            autosave.finish();
        }
    }
}

/// How long ago, in words.
fn ago(time: SystemTime) -> String {
    let Ok(since) = time.elapsed() else { return String::new() };
    let (count, unit) = match since.as_secs() {
        0..120 => return " just now".to_owned(),
        seconds @ 120..7200 => (seconds / 60, "minutes"),
        seconds @ 7200..172_800 => (seconds / 3600, "hours"),
        seconds => (seconds / 86_400, "days"),
    };
    format!(" {count} {unit} ago")
}
