//! Warnings as data: what a reader, the pipeline or a solver noticed on the way.

use std::fmt;

use serde::Serialize;

use super::printable::printable;
use super::remedy::Remedy;
use super::told_angle::ToldAngle;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// Worth knowing; nothing is wrong.
    Note,
    /// Something was repaired or left out, or limits how far an answer can be trusted.
    Warning,
    /// Something needed is missing; an answer will not come, or must not be used.
    Problem,
}

impl Severity {
    /// The sign before a finding in plain text.
    pub fn mark(self) -> char {
        match self {
            Self::Note => '-',
            Self::Warning => '!',
            Self::Problem => 'x',
        }
    }
}

/// One line for the user. Shown in the window, printed by the commands, and part of the JSON.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    pub severity: Severity,
    /// What was noticed and what to do about it, without the flags that do it: the window has none. Where there is a
    /// command line, its `Display` is the whole line.
    pub message: String,
    /// Whether no answer from this data can be better than weak.
    pub doubt: bool,
    /// What can be done about it, the best first.
    pub remedies: Vec<Remedy>,
    /// The angles that the message tells, in their order.
    pub angles: Vec<ToldAngle>,
    /// Whether a table beside the answer says the same.
    pub is_tabled: bool,
}

impl Finding {
    fn new(severity: Severity, message: impl Into<String>) -> Self {
        Self {
            severity,
            message: printable(&message.into()),
            doubt: false,
            remedies: Vec::new(),
            angles: Vec::new(),
            is_tabled: false,
        }
    }

    pub fn note(message: impl Into<String>) -> Self {
        Self::new(Severity::Note, message)
    }

    pub fn warning(message: impl Into<String>) -> Self {
        Self::new(Severity::Warning, message)
    }

    /// A warning that no answer from this data can be better than weak.
    pub fn doubt(message: impl Into<String>) -> Self {
        Self { doubt: true, ..Self::warning(message) }
    }

    pub fn problem(message: impl Into<String>) -> Self {
        Self::new(Severity::Problem, message)
    }

    /// Adds something that can be done about the finding.
    #[must_use]
    pub fn with(mut self, remedy: Remedy) -> Self {
        self.remedies.push(remedy);
        self
    }

    /// Names the angles that the message tells, so that they can be told in another unit.
    #[must_use]
    pub fn telling(mut self, angles: impl IntoIterator<Item = ToldAngle>) -> Self {
        self.angles.extend(angles);
        self
    }

    /// Marks the finding as one that a table beside the answer tells too.
    #[must_use]
    pub fn tabled(self) -> Self {
        Self { is_tabled: true, ..self }
    }

    /// The message with its angles in other words.
    pub fn with_angles(&self, words: impl Fn(&ToldAngle) -> String) -> String {
        let (mut text, mut rest) = (String::new(), self.message.as_str());
        for angle in &self.angles {
            let own = angle.to_string();
            let Some((before, after)) = rest.split_once(&own) else { continue };
            text = text + before + &words(angle);
            rest = after;
        }
        text + rest
    }
}

/// Gives what speaks against an answer among its findings: problems, then warnings.
pub fn doubts(findings: &[Finding]) -> Vec<&Finding> {
    let mut doubts: Vec<&Finding> =
        findings.iter().filter(|finding| finding.severity > Severity::Note).collect();
    doubts.sort_by_key(|finding| std::cmp::Reverse(finding.severity));
    doubts
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)?;
        for (index, flag) in self.remedies.iter().filter_map(Remedy::flag).enumerate() {
            write!(f, "{} {flag}", if index == 0 { "; use" } else { " or" })?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_whole_line_has_the_flags_and_the_message_has_none() {
        let finding = Finding::warning("the twins cannot be told apart")
            .with(Remedy::GiveControlPoints)
            .with(Remedy::ShowTimes([1.0, 2.0]))
            .with(Remedy::GiveRig);
        assert_eq!(finding.message, "the twins cannot be told apart");
        assert_eq!(finding.to_string(), "the twins cannot be told apart; use --gcp or --rig");
    }
}
