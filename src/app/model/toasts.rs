//! Short messages at the lower right of the window: what was done, what was noticed, what went wrong.

use std::collections::BTreeSet;

use super::Command;
use super::Pane;
use crate::deployment::{Finding, Severity};

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
    /// The deployment whose findings it tells, and these, numbers left out.
    about: Option<(String, Vec<String>)>,
    /// Since when it is seen (s of the window's clock); `None` until the next frame.
    since_s: Option<f64>,
}

/// Most toasts that are shown: more would hide the window behind them.
const MOST_TOASTS: usize = 4;

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
        self.push(ToastLevel::Done, text.into(), String::new(), None);
    }

    /// A line of the form "what; remedy", as errors of the library are.
    pub fn error(&mut self, line: &str) {
        self.line(ToastLevel::Error, line);
    }

    /// Tells what was repaired or left out, in a line of the form "what; remedy".
    pub fn warning(&mut self, line: &str) {
        self.line(ToastLevel::Warning, line);
    }

    fn line(&mut self, level: ToastLevel, line: &str) {
        let (text, detail) = line.split_once("; ").unwrap_or((line, ""));
        self.push(level, text.to_owned(), detail.to_owned(), None);
    }

    /// One toast on those findings about a deployment that were not told before.
    ///
    /// `told` remembers them, numbers left out: while a slider moves, the same warning comes with other numbers.
    pub fn findings<'a>(
        &mut self,
        about: &str,
        findings: impl IntoIterator<Item = &'a Finding>,
        told: &mut BTreeSet<String>,
    ) {
        let new: Vec<&Finding> = new_findings(findings, told);
        let show = Some(("Show findings", Command::ShowPane(Pane::Findings)));
        match new[..] {
            [] => {}
            [one] => {
                let level = level(one.severity);
                self.push(level, format!("{about}: {one}"), String::new(), show);
            }
            [first, ..] => {
                // The worst of them speaks for all.
                let worst = new.iter().map(|finding| finding.severity).max();
                let spokesman = new.iter().find(|finding| Some(finding.severity) == worst);
                let text = format!("{} warnings about {about}", new.len());
                let detail = spokesman.unwrap_or(&first).message.clone();
                self.push(worst.map_or(ToastLevel::Warning, level), text, detail, show);
            }
        }
        if let (false, Some(toast)) = (new.is_empty(), self.shown.last_mut()) {
            let keys = new.iter().map(|finding| without_numbers(&finding.message)).collect();
            toast.about = Some((about.to_owned(), keys));
        }
    }

    /// Takes away what tells of a deployment nothing that still holds.
    pub fn retire<'a>(&mut self, about: &str, now: impl Iterator<Item = &'a Finding>) {
        let now: BTreeSet<String> = now.map(|finding| without_numbers(&finding.message)).collect();
        self.shown.retain(|toast| match &toast.about {
            Some((name, keys)) if name == about => keys.iter().any(|key| now.contains(key)),
            _ => true,
        });
    }

    pub fn push(
        &mut self,
        level: ToastLevel,
        text: String,
        detail: String,
        action: Option<(&'static str, Command)>,
    ) {
        // The same again is news, and takes no further room.
        self.shown.retain(|toast| (toast.level, &toast.text) != (level, &text));
        self.newest_id += 1;
        let id = self.newest_id;
        self.shown.push(Toast { id, level, text, detail, action, about: None, since_s: None });
        if self.shown.len() > MOST_TOASTS {
            let expendable = self.shown.iter().position(|toast| toast.level != ToastLevel::Error);
            self.shown.remove(expendable.unwrap_or(0));
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
            now_s - since_s < toast.level.life_s()
        });
        let ends = self.shown.iter().filter_map(|t| Some(t.since_s? + t.level.life_s()));
        ends.filter(|end_s| end_s.is_finite()).min_by(f64::total_cmp)
    }
}

/// Problems and warnings that were not told before; from now on they were.
pub fn new_findings<'a>(
    findings: impl IntoIterator<Item = &'a Finding>,
    told: &mut BTreeSet<String>,
) -> Vec<&'a Finding> {
    findings
        .into_iter()
        .filter(|finding| finding.severity >= Severity::Warning)
        .filter(|finding| told.insert(without_numbers(&finding.message)))
        .collect()
}

fn without_numbers(message: &str) -> String {
    message.chars().filter(|c| !c.is_ascii_digit() && !".+-−".contains(*c)).collect()
}

fn level(severity: Severity) -> ToastLevel {
    match severity {
        Severity::Problem => ToastLevel::Error,
        Severity::Warning | Severity::Note => ToastLevel::Warning,
    }
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
        toasts.findings("drive", &[late(2.7)], &mut told);
        toasts.findings("other", &[late(1.0)], &mut BTreeSet::new());
        toasts.retire("drive", [late(3.1)].iter());
        assert_eq!(toasts.shown().len(), 2);
        toasts.retire("drive", [Finding::warning("the clocks jump")].iter());
        assert_eq!(texts(&toasts), ["other: station 3 is 1 ms late"]);
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
        toasts.findings("day 1", &findings, &mut told);
        assert_eq!(texts(&toasts), ["2 warnings about day 1"]);
        assert_eq!(toasts.shown()[0].detail, "station 3 has no measurement");
        assert_eq!(toasts.shown()[0].level, ToastLevel::Error);
        toasts.dismiss(toasts.shown()[0].id);
        toasts.findings("day 1", &findings, &mut told);
        toasts.findings("day 1", &[Finding::warning("station 2: 15 duplicate stamps")], &mut told);
        assert!(toasts.shown().is_empty());
        toasts.findings("day 1", &[Finding::warning("the drive is short")], &mut told);
        assert_eq!(texts(&toasts), ["day 1: the drive is short"]);
    }
}
