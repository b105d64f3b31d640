//! Saving and restoring: preferences of all windows, and this window's session for recovery after a crash.
//!
//! Pictures and tests do not use this.

use std::sync::Arc;
use std::time::{Duration, Instant, SystemTime};

use super::persist::Folders;
use super::persist::autosave::{Autosave, Recovered};
use super::persist::hashes::HashCache;
use super::persist::last::LastSession;
use super::persist::preferences::{Preferences, PreferencesFile};
use crate::app::layout::Layout;
use crate::app::model::ago::ago;
use crate::app::model::findings::{autosave_unavailable, earlier_session_kept};
use crate::app::state::State;
use crate::app::theme;
use resect_core::deployment::Finding;

/// Interval of the checks for changes.
const EVERY: Duration = Duration::from_secs(3);

pub struct SavedState {
    file: PreferencesFile,
    preferences: Preferences,
    /// Sessions of running windows; `None` without a writable folder.
    autosave: Option<Autosave>,
    cache: Arc<HashCache>,
    /// Session of a crashed window, until this window adopts it.
    recovered: Option<Recovered>,
    /// The session that was open last.
    last: LastSession,
    findings: Vec<Finding>,
    every: Duration,
    looked: Instant,
}

impl SavedState {
    /// Reads preferences and sessions. Failures are reported when the window opens, and never prevent that.
    pub fn start(folders: &Folders) -> Self {
        let (file, preferences, mut findings) = PreferencesFile::open(&folders.config);
        let cache = Arc::new(HashCache::default());
        let (autosave, recovered) = match Autosave::start(&folders.autosave, Arc::clone(&cache)) {
            Ok((autosave, recovered, found)) => {
                findings.extend(found);
                (Some(autosave), recovered)
            }
            Err(error) => {
                findings.push(autosave_unavailable(&folders.autosave, &error));
                (None, None)
            }
        };
        let last = LastSession::at(folders.last());
        let (every, looked) = (EVERY, Instant::now());
        Self { file, preferences, autosave, cache, recovered, last, findings, every, looked }
    }

    pub fn preferences(&self) -> &Preferences {
        &self.preferences
    }

    /// Sets another interval of the checks; for tests.
    pub fn every(self, every: Duration) -> Self {
        Self { every, ..self }
    }

    /// Applies preferences and any recovered session to a new window, before anything is opened in it; returns true if a session was
    /// restored.
    ///
    /// If the user asked for other data (`restores` is false), a crashed window's session remains for the next window.
    pub fn begin(&mut self, ctx: &egui::Context, state: &mut State, restores: bool) -> bool {
        state.workspace.theme = self.preferences.theme.into();
        ctx.set_theme(state.workspace.theme);
        state.workspace.in_the_sun = self.preferences.in_the_sun;
        theme::in_the_sun(ctx, state.workspace.in_the_sun);
        state.workspace.units = self.preferences.units;
        state.workspace.asks_before_closing = !self.preferences.closes_unasked;
        state.session.recent = self.preferences.recent.clone();
        state.session.last = Some(self.last.clone());
        state.session.share(Arc::clone(&self.cache));
        let mut findings = std::mem::take(&mut self.findings);
        if let Some(description) = &self.preferences.layout {
            let (kept, found) = Layout::of_description(description);
            state.workspace.layout = kept;
            findings.extend(found);
        }
        let mut restored = false;
        if let (Some(autosave), Some(recovered)) = (&mut self.autosave, self.recovered.take()) {
            let when = in_words(recovered.saved);
            if restores {
                let (session, found) = autosave.take_over(recovered);
                findings.extend(found);
                state.recover(session, &when);
                restored = true;
            } else {
                findings.push(earlier_session_kept(&when));
            }
        }
        state.tell(&findings);
        restored
    }

    /// Saves preferences and session. Called in every frame; every few seconds it writes the changes in the background.
    pub fn frame(&mut self, ctx: &egui::Context, state: &mut State) {
        let since = self.looked.elapsed();
        if since < self.every {
            // Schedules a last check after the user's last action.
            ctx.request_repaint_after(self.every - since);
            return;
        }
        self.looked = Instant::now();
        self.keep_preferences(ctx, state);
        if let Some(autosave) = &mut self.autosave {
            let error = autosave.take_error();
            if autosave.offer(state.session()) {
                // Repaints to check that the write succeeded.
                ctx.request_repaint_after(self.every);
            }
            if let Some(line) = error {
                state.toasts.error(&line);
            }
        }
        if let Some(line) = self.file.take_error() {
            state.toasts.error(&line);
        }
    }

    fn keep_preferences(&mut self, ctx: &egui::Context, state: &State) {
        let zoom = ctx.zoom_factor();
        let size = ctx.input(|input| {
            let viewport = input.viewport();
            let normal =
                !viewport.maximized.unwrap_or(false) && !viewport.fullscreen.unwrap_or(false);
            // Size without the zoom of large type, because the next window opens with that size.
            let size = viewport.inner_rect.filter(|_| normal)?.size() * zoom;
            Some([size.x, size.y])
        });
        self.preferences = Preferences {
            theme: ctx.options(|options| options.theme_preference).into(),
            in_the_sun: state.workspace.in_the_sun,
            units: state.workspace.units,
            // An unchanged default layout is not saved: a newer version may have a better one.
            layout: Some(state.workspace.lasting_layout().describe())
                .filter(|it| *it != Layout::default().describe()),
            window_points: size.or(self.preferences.window_points),
            closes_unasked: !state.workspace.asks_before_closing,
            maximized: ctx.input(|input| input.viewport().maximized).unwrap_or(false),
            recent: state.session.recent.clone(),
        };
        self.file.keep(&self.preferences);
    }

    /// Saves preferences and the session when the user closes the window.
    pub fn finish(mut self, ctx: &egui::Context, state: &State) {
        self.keep_preferences(ctx, state);
        self.file.finish();
        let session = state.session();
        let kept = self.last.write(&session);
        match (self.autosave, kept) {
            (Some(autosave), Ok(())) => autosave.finish(),
            (Some(autosave), Err(_)) => autosave.leave(session),
            (None, _) => {}
        }
    }
}

/// Formats a time as "3 min ago (2026-11-23 00:12 UTC)".
fn in_words(saved: Option<SystemTime>) -> String {
    let Some(saved) = saved else { return "at an unknown time".to_owned() };
    let since = saved.elapsed().ok().and_then(ago);
    let since = since.map_or("just now".to_owned(), |time| format!("{time} ago"));
    match jiff::Timestamp::try_from(saved) {
        Ok(at) => format!("{since} ({})", at.strftime("%Y-%m-%d %H:%M UTC")),
        Err(_) => since,
    }
}
