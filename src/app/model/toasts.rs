//! Short messages in a strip at the foot of the window: what was done, what was noticed, what went wrong.

use std::collections::BTreeSet;

use super::Command;
use super::Pane;
use super::Units;
use super::told::{self, new_findings};
use crate::deployment::{Finding, Place, Severity};

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
    /// `told` remembers them, numbers left out: while a slider moves, the same warning comes with other numbers.
    pub fn findings<'a>(
        &mut self,
        (id, name): (u64, &str),
        findings: impl IntoIterator<Item = &'a Finding>,
        told: &mut BTreeSet<String>,
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
        let show = Some(("Show findings", Command::ShowPane(Pane::Findings)));
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
                let key = told::key(&was.message);
                now.clone().find(|finding| told::key(&finding.message) == key).cloned()
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
mod tests {
    use super::*;

    fn texts(toasts: &Toasts) -> Vec<&str> {
        toasts.shown().iter().map(|toast| toast.text.as_str()).collect()
    }

    #[test]
    fn what_is_done_goes_and_errors_stay() {
        let mut toasts = Toasts::default();
        toasts.done("saved");
        toasts.error("a.csv:1: no column `id`; the header must name it");
        assert_eq!(toasts.advance(100.0), Some(105.0));
        assert_eq!(texts(&toasts), ["saved", "a.csv:1: no column `id`"]);
        assert_eq!(toasts.errors().next().expect("one").1, "the header must name it");
        // Under the pointer it stays.
        toasts.hold(toasts.shown()[0].id);
        toasts.advance(106.0);
        assert_eq!(toasts.shown().len(), 2);
        assert_eq!(toasts.advance(111.0), None);
        assert_eq!(texts(&toasts), ["a.csv:1: no column `id`"]);
        toasts.dismiss(toasts.shown()[0].id);
        assert!(toasts.shown().is_empty());
    }

    #[test]
    fn what_no_longer_holds_is_taken_away() {
        let (mut toasts, mut told) = (Toasts::default(), BTreeSet::new());
        let late = |ms: f64| Finding::warning(format!("station 3 is {ms} ms late"));
        toasts.findings((1, "drive"), &[late(2.7)], &mut told);
        toasts.findings((2, "other"), &[late(1.0)], &mut BTreeSet::new());
        toasts.update((1, "drive"), &[late(3.1)].iter());
        // The number is the present one.
        assert_eq!(texts(&toasts)[0], "drive: station 3 is 3.1 ms late");
        toasts.update((1, "drive"), &[Finding::warning("the clocks jump")].iter());
        assert_eq!(texts(&toasts), ["other: station 3 is 1 ms late"]);
        toasts.closed(2);
        let place = Place::Path("/day/broken.csv".into());
        toasts.not_opened(&place, "broken.csv:1: semicolons; save the table with commas");
        toasts.settled(&Place::Path("/day/other.csv".into()));
        assert_eq!(toasts.errors().count(), 1);
        toasts.settled(&place);
        assert!(toasts.shown().is_empty());
    }

    #[test]
    fn angles_are_told_in_the_unit_that_is_chosen_while_they_are_shown() {
        use super::super::AngleUnit;
        use crate::deployment::{ToldAngle, ToldIn};
        let turned = ToldAngle::signed(1e-3, ToldIn::Milliradians, 2);
        let finding = Finding::warning(format!("station 2 turned by {turned}")).telling([turned]);
        let mut toasts = Toasts::default();
        toasts.findings((1, "drive"), &[finding], &mut BTreeSet::new());
        let told = |angle| {
            let [text, _] = toasts.shown()[0].lines(Units { angle, ..Units::default() });
            text.trim_start_matches("drive: station 2 turned by ").to_owned()
        };
        assert_eq!(
            AngleUnit::ALL.map(told),
            ["+1.0 mrad", "+206 ″", "+64 mgon"].map(str::to_owned)
        );
    }

    #[test]
    fn the_same_is_counted_and_another_remedy_is_another_thing() {
        let mut toasts = Toasts::default();
        toasts.error("a.csv: not readable; check its permissions");
        toasts.error("a.csv: not readable; check its permissions");
        toasts.error("a.csv: not readable; mount the disk");
        let counts: Vec<usize> = toasts.shown().iter().map(|toast| toast.count).collect();
        assert_eq!(counts, [2, 1]);
    }

    #[test]
    fn they_never_flood_the_window() {
        let mut toasts = Toasts::default();
        toasts.error("first");
        for number in 0..9 {
            toasts.done(format!("saved {number}"));
        }
        toasts.done("saved 8");
        assert_eq!(texts(&toasts), ["first", "saved 6", "saved 7", "saved 8"]);
    }

    #[test]
    fn each_finding_is_told_once_and_several_in_one_toast() {
        let (mut toasts, mut told) = (Toasts::default(), BTreeSet::new());
        let findings = [
            Finding::note("all is well"),
            Finding::warning("station 2: 14 duplicate stamps"),
            Finding::problem("station 3 has no measurement"),
        ];
        toasts.findings((1, "day 1"), &findings, &mut told);
        assert_eq!(texts(&toasts), ["2 warnings about day 1"]);
        assert_eq!(toasts.shown()[0].detail, "station 3 has no measurement");
        assert_eq!(toasts.shown()[0].level, ToastLevel::Error);
        toasts.dismiss(toasts.shown()[0].id);
        toasts.findings((1, "day 1"), &findings, &mut told);
        toasts.findings(
            (1, "day 1"),
            &[Finding::warning("station 2: 15 duplicate stamps")],
            &mut told,
        );
        assert!(toasts.shown().is_empty());
        toasts.findings(
            (1, "day 1"),
            &[Finding::warning("station 1: 15 duplicate stamps")],
            &mut told,
        );
        assert_eq!(texts(&toasts), ["day 1: station 1: 15 duplicate stamps"]);
        told::forget_past([].iter(), &mut told);
        toasts.update((1, "day 1"), &[].iter());
        toasts.findings((1, "day 1"), &[Finding::warning("the drive is short")], &mut told);
        assert_eq!(texts(&toasts), ["day 1: the drive is short"]);
    }
}
