//! Toasts: short messages in a strip at the foot of the window.

use std::collections::BTreeSet;

use super::Pane;
use super::Units;
use super::new_findings::new_findings;
use super::{Command, WorkspaceCommand};
use resect_core::deployment::{Finding, FindingIdentity, Severity};
use resect_io::source::Place;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ToastLevel {
    Done,
    Warning,
    Error,
}

impl ToastLevel {
    /// Lifetime (s); infinite for errors, which the user dismisses.
    fn life_s(self) -> f64 {
        match self {
            Self::Done => 5.0,
            Self::Warning => 12.0,
            Self::Error => f64::INFINITY,
        }
    }
}

#[derive(Clone, Debug)]
pub struct Toast {
    pub id: u64,
    pub level: ToastLevel,
    /// The event.
    pub text: String,
    /// The reason or the remedy; may be empty.
    pub detail: String,
    /// Label and command of a button.
    pub action: Option<(&'static str, Command)>,
    /// Number of identical messages while the toast is shown.
    pub count: usize,
    about: About,
    /// Time since which the toast is visible (s, the window's clock); `None` until the next frame.
    since_s: Option<f64>,
}

impl Toast {
    fn life_s(&self) -> f64 {
        if self.about == About::Offer { f64::INFINITY } else { self.level.life_s() }
    }

    /// Returns the text and the detail, with angles in the user's unit, which may change while the toast is shown.
    pub fn lines(&self, units: Units) -> [String; 2] {
        match &self.about {
            About::Findings(_, name, findings) => in_words(name, findings, units).1,
            _ => [self.text.clone(), self.detail.clone()],
        }
    }
}

/// Subject of a toast; the toast is removed once it no longer applies.
#[derive(Clone, Debug, PartialEq)]
enum About {
    /// A past event.
    Past,
    /// Findings about an open deployment, with its id and its name.
    Findings(u64, String, Vec<Finding>),
    /// A place that could not be opened.
    Place(Place),
    /// A decision that is still open.
    Offer,
}

/// Largest number of toasts while one of them is not an error; more would cover the panes.
const MOST_TOASTS: usize = 4;
/// Largest number of toasts; the strip scrolls.
const MOST_ERRORS: usize = 100;

/// The displayed toasts, the newest last.
#[derive(Debug, Default)]
pub struct Toasts {
    shown: Vec<Toast>,
    newest_id: u64,
}

impl Toasts {
    pub fn shown(&self) -> &[Toast] {
        &self.shown
    }

    /// Returns the text and the detail of each displayed error.
    pub fn errors(&self) -> impl Iterator<Item = (&str, &str)> {
        let errors = self.shown.iter().filter(|toast| toast.level == ToastLevel::Error);
        errors.map(|toast| (toast.text.as_str(), toast.detail.as_str()))
    }

    pub fn done(&mut self, text: impl Into<String>) {
        self.push(ToastLevel::Done, [text.into(), String::new()], None, About::Past);
    }

    /// Shows an error of the form "what; remedy", as the library returns them.
    pub fn error(&mut self, line: &str) {
        self.line(ToastLevel::Error, line, About::Past);
    }

    /// Shows that a place could not be opened, until it is opened.
    pub fn not_opened(&mut self, place: &Place, line: &str) {
        self.line(ToastLevel::Error, line, About::Place(place.clone()));
    }

    /// Shows that something was repaired or left out, in the form "what; remedy".
    pub fn warning(&mut self, line: &str) {
        self.line(ToastLevel::Warning, line, About::Past);
    }

    /// Shows what was done, with a button to undo it, until the user decides.
    pub fn offer(&mut self, line: &str, action: (&'static str, Command)) {
        self.push(ToastLevel::Warning, halves(line), Some(action), About::Offer);
    }

    /// Withdraws the offer after another decision.
    pub fn withdraw_offer(&mut self) {
        self.shown.retain(|toast| toast.about != About::Offer);
    }

    fn line(&mut self, level: ToastLevel, line: &str, about: About) {
        self.push(level, halves(line), None, about);
    }

    /// Shows new findings about an open deployment in one toast, together with its earlier ones that are still shown.
    ///
    /// `told` contains the identities of findings already shown: while a slider moves, a warning recurs with other numbers.
    pub fn findings<'a>(
        &mut self,
        (id, name): (u64, &str),
        findings: impl IntoIterator<Item = &'a Finding>,
        told: &mut BTreeSet<FindingIdentity>,
    ) {
        let new: Vec<Finding> = new_findings(findings, told).into_iter().cloned().collect();
        if new.is_empty() {
            return;
        }
        let mut all = Vec::new();
        self.shown.retain_mut(|toast| match &mut toast.about {
            About::Findings(of, _, earlier) if *of == id => {
                all.append(earlier);
                false
            }
            _ => true,
        });
        all.extend(new);
        let (level, lines) = in_words(name, &all, Units::default());
        let show =
            Some(("Show findings", Command::Workspace(WorkspaceCommand::ShowPane(Pane::Findings))));
        self.push(level, lines, show, About::Findings(id, name.to_owned(), all));
    }

    /// Updates the findings of a deployment with their present numbers, and removes those that no longer apply.
    pub fn update<'a>(
        &mut self,
        (id, name): (u64, &str),
        now: &(impl Iterator<Item = &'a Finding> + Clone),
    ) {
        self.shown.retain_mut(|toast| {
            let About::Findings(of, known_as, findings) = &mut toast.about else { return true };
            if *of != id {
                return true;
            }
            let present = |was: &Finding| {
                let identity = was.identity();
                now.clone().find(|finding| finding.identity() == identity).cloned()
            };
            *findings = findings.iter().filter_map(present).collect();
            if findings.is_empty() {
                return false;
            }
            name.clone_into(known_as);
            (toast.level, [toast.text, toast.detail]) = in_words(name, findings, Units::default());
            true
        });
    }

    /// Removes the findings of a closed deployment.
    pub fn closed(&mut self, id: u64) {
        self.shown.retain(|toast| !matches!(toast.about, About::Findings(of, ..) if of == id));
    }

    /// Removes the errors of a place that was opened, or is no longer wanted.
    pub fn settled(&mut self, place: &Place) {
        self.shown.retain(|toast| !matches!(&toast.about, About::Place(other) if other == place));
    }

    fn push(
        &mut self,
        level: ToastLevel,
        [text, detail]: [String; 2],
        action: Option<(&'static str, Command)>,
        about: About,
    ) {
        // An identical message only increases the count.
        let same = |toast: &Toast| {
            toast.level == level
                && (&toast.text, &toast.detail, &toast.about) == (&text, &detail, &about)
        };
        let before = self.shown.iter().position(same).map(|index| self.shown.remove(index));
        let count = 1 + before.map_or(0, |toast| toast.count);
        self.newest_id += 1;
        let (id, since_s) = (self.newest_id, None);
        self.shown.push(Toast { id, level, text, detail, action, count, about, since_s });
        let expendable = |toast: &Toast| toast.life_s().is_finite();
        if self.shown.len() > MOST_TOASTS
            && let Some(oldest) = self.shown.iter().position(expendable)
        {
            self.shown.remove(oldest);
        }
        if self.shown.len() > MOST_ERRORS {
            self.shown.remove(0);
        }
    }

    pub fn dismiss(&mut self, id: u64) {
        self.shown.retain(|toast| toast.id != id);
    }

    /// Restarts a toast's lifetime while the pointer is on it.
    pub fn hold(&mut self, id: u64) {
        if let Some(toast) = self.shown.iter_mut().find(|toast| toast.id == id) {
            toast.since_s = None;
        }
    }

    /// Removes expired toasts at a time (s, the window's clock); returns the time at which the next one expires.
    pub fn advance(&mut self, now_s: f64) -> Option<f64> {
        self.shown.retain_mut(|toast| {
            let since_s = *toast.since_s.get_or_insert(now_s);
            now_s - since_s < toast.life_s()
        });
        let ends = self.shown.iter().filter_map(|t| Some(t.since_s? + t.life_s()));
        ends.filter(|end_s| end_s.is_finite()).min_by(f64::total_cmp)
    }
}

/// Splits a line into message and remedy.
fn halves(line: &str) -> [String; 2] {
    let (text, detail) = line.split_once("; ").unwrap_or((line, ""));
    [text.to_owned(), detail.to_owned()]
}

/// Level, text and detail of the toast for findings about a deployment.
fn in_words(name: &str, findings: &[Finding], units: Units) -> (ToastLevel, [String; 2]) {
    // The most severe finding determines the level.
    let worst = findings.iter().map(|finding| finding.severity).max();
    let level = match worst {
        Some(Severity::Problem) => ToastLevel::Error,
        Some(Severity::Warning | Severity::Note) | None => ToastLevel::Warning,
    };
    let lines = match findings {
        [one] => [format!("{name}: {}", units.message(one)), String::new()],
        several => {
            let spokesman = several.iter().find(|finding| Some(finding.severity) == worst);
            let detail = spokesman.map(|finding| units.message(finding)).unwrap_or_default();
            [format!("{} warnings about {name}", several.len()), detail]
        }
    };
    (level, lines)
}

#[cfg(test)]
#[path = "toasts_tests.rs"]
mod tests;
