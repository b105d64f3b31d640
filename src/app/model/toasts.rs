//! Short messages in a strip at the foot of the window: what was done, what was noticed, what went wrong.

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
    /// How long it stays (s); errors until they are dismissed.
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
    /// What happened.
    pub text: String,
    /// Why, or what to do about it; may be empty.
    pub detail: String,
    /// A button, and what it does.
    pub action: Option<(&'static str, Command)>,
    /// How often the same was said while it is shown.
    pub count: usize,
    about: About,
    /// Since when it is seen (s of the window's clock); `None` until the next frame.
    since_s: Option<f64>,
}

impl Toast {
    fn life_s(&self) -> f64 {
        if self.about == About::Offer { f64::INFINITY } else { self.level.life_s() }
    }

    /// The text and the detail with angles in the user's unit, which may change while they are shown.
    pub fn lines(&self, units: Units) -> [String; 2] {
        match &self.about {
            About::Findings(_, name, findings) => in_words(name, findings, units).1,
            _ => [self.text.clone(), self.detail.clone()],
        }
    }
}

/// What a toast tells of: it goes when that is no longer so.
#[derive(Clone, Debug, PartialEq)]
enum About {
    /// What happened once, and stays so.
    Past,
    /// Findings about an open deployment, by its id and its name.
    Findings(u64, String, Vec<Finding>),
    /// A place that could not be opened.
    Place(Place),
    /// What the user may still decide.
    Offer,
}

/// Most toasts while one of them tells no error: more would leave the panes no room.
const MOST_TOASTS: usize = 4;
/// Most toasts at all; the strip scrolls.
const MOST_ERRORS: usize = 100;

/// The toasts that are shown, the newest last.
#[derive(Debug, Default)]
pub struct Toasts {
    shown: Vec<Toast>,
    newest_id: u64,
}

impl Toasts {
    pub fn shown(&self) -> &[Toast] {
        &self.shown
    }

    /// The text and the detail of each error that is shown.
    pub fn errors(&self) -> impl Iterator<Item = (&str, &str)> {
        let errors = self.shown.iter().filter(|toast| toast.level == ToastLevel::Error);
        errors.map(|toast| (toast.text.as_str(), toast.detail.as_str()))
    }

    pub fn done(&mut self, text: impl Into<String>) {
        self.push(ToastLevel::Done, [text.into(), String::new()], None, About::Past);
    }

    /// A line of the form "what; remedy", as errors of the library are.
    pub fn error(&mut self, line: &str) {
        self.line(ToastLevel::Error, line, About::Past);
    }

    /// Says that a place could not be opened, which holds until that place is open.
    pub fn not_opened(&mut self, place: &Place, line: &str) {
        self.line(ToastLevel::Error, line, About::Place(place.clone()));
    }

    /// Tells what was repaired or left out, in a line of the form "what; remedy".
    pub fn warning(&mut self, line: &str) {
        self.line(ToastLevel::Warning, line, About::Past);
    }

    /// Tells what was done and can be undone by a button, until that is decided.
    pub fn offer(&mut self, line: &str, action: (&'static str, Command)) {
        self.push(ToastLevel::Warning, halves(line), Some(action), About::Offer);
    }

    /// It was decided otherwise.
    pub fn withdraw_offer(&mut self) {
        self.shown.retain(|toast| toast.about != About::Offer);
    }

    fn line(&mut self, level: ToastLevel, line: &str, about: About) {
        self.push(level, halves(line), None, about);
    }

    /// Tells those findings about an open deployment that were not told before, in one toast with those that still hold.
    ///
    /// `told` remembers their identities: while a slider moves, the same warning comes with other numbers.
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

    /// Has what is told of a deployment say what holds now, with its present numbers; what holds no longer goes.
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

    /// A deployment was closed: nothing is told of it any more.
    pub fn closed(&mut self, id: u64) {
        self.shown.retain(|toast| !matches!(toast.about, About::Findings(of, ..) if of == id));
    }

    /// A place was opened, or is no longer wanted.
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
        // The same again is counted, and takes no further room.
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

    /// Lets a toast's time start anew: the pointer is on it.
    pub fn hold(&mut self, id: u64) {
        if let Some(toast) = self.shown.iter_mut().find(|toast| toast.id == id) {
            toast.since_s = None;
        }
    }

    /// Drops those whose time is up at this time of the window's clock (s); gives when the next one's will be.
    pub fn advance(&mut self, now_s: f64) -> Option<f64> {
        self.shown.retain_mut(|toast| {
            let since_s = *toast.since_s.get_or_insert(now_s);
            now_s - since_s < toast.life_s()
        });
        let ends = self.shown.iter().filter_map(|t| Some(t.since_s? + t.life_s()));
        ends.filter(|end_s| end_s.is_finite()).min_by(f64::total_cmp)
    }
}

/// What, and the remedy.
fn halves(line: &str) -> [String; 2] {
    let (text, detail) = line.split_once("; ").unwrap_or((line, ""));
    [text.to_owned(), detail.to_owned()]
}

/// What a toast says of findings about a deployment.
fn in_words(name: &str, findings: &[Finding], units: Units) -> (ToastLevel, [String; 2]) {
    // The worst of them speaks for all.
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
