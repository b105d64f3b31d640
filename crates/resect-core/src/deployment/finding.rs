//! Findings of a reader, the pipeline or a solver, as data.

use std::borrow::Cow;
use std::fmt;

use super::{FindingKind, FindingQuantity, Message, MessageAngle, Remedy, Severity, Unit};
use crate::statistics::estimate::Estimate;

/// Subject of a finding.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Subject {
    /// A station, 0 to 2.
    Station(usize),
    /// One error or property of a station, such as an error of its instrument or a reason why its readings are dropped.
    OfStation { station: usize, part: String },
    /// A pair of prisms, by its index in the order of [`Pair`](crate::network::Pair).
    Pair(usize),
    /// A file, by its name in the folder.
    File(String),
    /// A control point, by its file and marker.
    Point { file: String, marker: i64 },
    /// Anything else with a name: a method, a topic, a column, a parameter.
    Named(String),
}

/// A finding for the user. Constructors in `findings` set kind, quantities and message together.
///
/// `Display` writes the message without the remedies: the window offers them as buttons, the command line as flags.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    pub kind: FindingKind,
    pub severity: Severity,
    pub subject: Option<Subject>,
    /// The file, drive, session or deployment of the finding; written before the message.
    pub context: Option<String>,
    pub quantities: Vec<FindingQuantity>,
    /// Remedies, the best first.
    pub remedies: Vec<Remedy>,
    message: Message,
}

/// Kind, subject and context of a finding. Two findings with the same identity differ in their numbers only.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct FindingIdentity {
    kind: FindingKind,
    subject: Option<Subject>,
    context: Option<String>,
}

impl Finding {
    /// A finding with the usual severity of its kind.
    pub fn new(kind: FindingKind, message: impl Into<Message>) -> Self {
        Self {
            kind,
            severity: kind.severity(),
            subject: None,
            context: None,
            quantities: Vec::new(),
            remedies: Vec::new(),
            message: message.into(),
        }
    }

    /// Sets the subject.
    #[must_use]
    pub fn about(self, subject: Subject) -> Self {
        Self { subject: Some(subject), ..self }
    }

    /// Sets a severity other than the usual one of the kind.
    #[must_use]
    pub fn with_severity(self, severity: Severity) -> Self {
        Self { severity, ..self }
    }

    /// Names the drive, session or deployment that the finding belongs to. An existing context follows the new one:
    /// `outer: inner`.
    #[must_use]
    pub fn within(self, context: impl Into<String>) -> Self {
        let outer = context.into();
        let context = match self.context {
            Some(inner) => format!("{outer}: {inner}"),
            None => outer,
        };
        Self { context: Some(context), ..self }
    }

    /// Adds a quantity.
    #[must_use]
    pub fn quantity(mut self, name: impl Into<Cow<'static, str>>, value: f64, unit: Unit) -> Self {
        self.quantities.push(FindingQuantity { name: name.into(), value, sigma: None, unit });
        self
    }

    /// Adds an estimated quantity with its standard deviation.
    #[must_use]
    pub fn estimate(mut self, name: &'static str, estimate: &Estimate, unit: Unit) -> Self {
        let Estimate { value, sigma } = *estimate;
        self.quantities.push(FindingQuantity {
            name: name.into(),
            value,
            sigma: Some(sigma),
            unit,
        });
        self
    }

    /// Adds a count.
    #[must_use]
    pub fn count(self, name: &'static str, count: usize) -> Self {
        self.quantity(name, count as f64, Unit::Count)
    }

    /// Adds a remedy.
    #[must_use]
    pub fn with(mut self, remedy: Remedy) -> Self {
        self.remedies.push(remedy);
        self
    }

    /// Returns the value of a quantity by its name without unit; `None` if the finding has none of this name.
    pub fn value(&self, name: &str) -> Option<f64> {
        self.quantities.iter().find(|quantity| quantity.name == name).map(|found| found.value)
    }

    /// Returns true if the finding is about this station (0 to 2).
    pub fn is_about_station(&self, station: usize) -> bool {
        match &self.subject {
            Some(Subject::Station(own) | Subject::OfStation { station: own, .. }) => {
                *own == station
            }
            _ => false,
        }
    }

    /// Identity of the finding, which does not depend on its numbers.
    pub fn identity(&self) -> FindingIdentity {
        let Self { kind, subject, context, .. } = self;
        FindingIdentity { kind: *kind, subject: subject.clone(), context: context.clone() }
    }

    /// Renders the message with its context; `render_angle` renders each angle.
    pub fn render(&self, render_angle: impl Fn(&MessageAngle) -> String) -> String {
        let message = self.message.render(render_angle);
        match &self.context {
            Some(context) => format!("{context}: {message}"),
            None => message,
        }
    }

    /// The message without its context.
    pub fn message(&self) -> &Message {
        &self.message
    }
}

/// Selects the findings that limit an answer: problems, then warnings.
pub fn doubts(findings: &[Finding]) -> Vec<&Finding> {
    let mut doubts: Vec<&Finding> =
        findings.iter().filter(|finding| finding.severity > Severity::Note).collect();
    doubts.sort_by_key(|finding| std::cmp::Reverse(finding.severity));
    doubts
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.render(MessageAngle::to_string))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deployment::kinds;

    #[test]
    fn the_identity_has_subject_and_context_and_no_numbers() {
        let late = |station: usize, late_s: f64| {
            Finding::new(kinds::CLOCK_OFFSET_SUSPECTED, format!("late by {late_s} s"))
                .about(Subject::Station(station))
                .quantity("offset", late_s, Unit::Second)
        };
        assert_eq!(late(1, 0.01).identity(), late(1, 0.02).identity());
        assert_ne!(late(1, 0.01).identity(), late(2, 0.01).identity());
        assert_ne!(late(1, 0.01).identity(), late(1, 0.01).within("drive 2").identity());
        assert_eq!(late(1, 0.01).within("drive 2").to_string(), "drive 2: late by 0.01 s");
    }
}
