//! Verdict with its reasons, extended by the checks of a method.

use super::Verdict;
use crate::deployment::Finding;

/// A verdict and the findings that explain it.
pub struct Judgement {
    pub verdict: Verdict,
    pub findings: Vec<Finding>,
}

impl Judgement {
    /// Returns a good verdict with these findings.
    pub fn good(findings: Vec<Finding>) -> Self {
        Self { verdict: Verdict::Good, findings }
    }

    /// Lowers the verdict to at most `to` and adds the finding that states the reason.
    pub fn lower(&mut self, to: Verdict, finding: Finding) {
        self.verdict = self.verdict.max(to);
        self.findings.push(finding);
    }

    /// Lowers the verdict to at most weak for each finding.
    pub fn doubt(&mut self, findings: impl IntoIterator<Item = Finding>) {
        findings.into_iter().for_each(|finding| self.lower(Verdict::Weak, finding));
    }

    /// Lowers the verdict for each doubt and puts the doubts before other findings, in their order. A doubt with a good verdict is
    /// a note and is added at the end.
    pub fn put_first(
        &mut self,
        doubts: impl IntoIterator<Item = (Verdict, Finding), IntoIter: DoubleEndedIterator>,
    ) {
        for (to, finding) in doubts.into_iter().rev() {
            self.verdict = self.verdict.max(to);
            let place = if to == Verdict::Good { self.findings.len() } else { 0 };
            self.findings.insert(place, finding);
        }
    }
}
