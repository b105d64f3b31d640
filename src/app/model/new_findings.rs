//! Findings that the user has not seen yet: a warning comes again with other numbers while a slider moves.

use std::collections::BTreeSet;

use resect_core::deployment::{Finding, FindingIdentity, Severity};

/// Selects the problems and warnings that were not shown before, and remembers them.
pub fn new_findings<'a>(
    findings: impl IntoIterator<Item = &'a Finding>,
    told: &mut BTreeSet<FindingIdentity>,
) -> Vec<&'a Finding> {
    findings
        .into_iter()
        .filter(|finding| finding.severity >= Severity::Warning)
        .filter(|finding| told.insert(finding.identity()))
        .collect()
}

/// Forgets the findings that no longer hold: should one come again, it is new.
pub fn forget_past<'a>(
    now: impl Iterator<Item = &'a Finding>,
    told: &mut BTreeSet<FindingIdentity>,
) {
    let now: BTreeSet<FindingIdentity> = now.map(Finding::identity).collect();
    told.retain(|identity| now.contains(identity));
}
