//! Kinds of findings of the window.

use resect_core::deployment::FindingKind;

resect_core::finding_kinds! {
    /// Autosave cannot write, so nothing is restored after a crash.
    AUTOSAVE_UNAVAILABLE = "autosave-unavailable", Warning;
    /// A session of an earlier crash is kept.
    EARLIER_SESSION_KEPT = "earlier-session-kept", Warning;
    /// An element of a session has an unknown form, and was left out.
    SESSION_PART_UNKNOWN = "session-part-unknown", Warning;
    /// The plan of a session is invalid, and was left out.
    SESSION_PLAN_INVALID = "session-plan-invalid", Warning;
    /// A file of the user cannot be used, and was moved aside.
    UNUSABLE_FILE_KEPT = "unusable-file-kept", Warning;
    /// A file has changed since the session was saved.
    SESSION_FILE_CHANGED = "session-file-changed", Warning;
    /// A file of the session can no longer be read.
    SESSION_FILE_MISSING = "session-file-missing", Warning;
    /// The stored layout of the window has an unknown or repeated element.
    LAYOUT_INVALID = "layout-invalid", Warning;
}

/// Returns the kinds of all crates, in the order of the documentation.
pub fn of_all_crates() -> Vec<FindingKind> {
    let files = resect_io::findings::kinds::ALL;
    let calibration = resect_core::deployment::kinds::ALL;
    let tools = resect_tools::findings::kinds::ALL;
    [files, calibration, tools, resect_live::kinds::ALL, ALL].concat()
}
