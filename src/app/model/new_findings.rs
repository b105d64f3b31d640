//! New findings: while a slider moves, a warning recurs with other numbers and is not new.

use std::collections::BTreeSet;

use resect_core::deployment::{Finding, FindingIdentity, Severity};

/// Returns the problems and warnings that were not shown before, and marks them as shown.
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

/// Forgets findings that no longer apply, so that they count as new when they recur.
pub fn forget_past<'a>(
    now: impl Iterator<Item = &'a Finding>,
    told: &mut BTreeSet<FindingIdentity>,
) {
    let now: BTreeSet<FindingIdentity> = now.map(Finding::identity).collect();
    told.retain(|identity| now.contains(identity));
}
