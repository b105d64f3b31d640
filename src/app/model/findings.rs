//! Findings of the window: one constructor for each kind, with its message.

use crate::app::model::kinds;
use std::fmt::Display;
use std::path::Path;

use resect_core::deployment::{Finding, FindingKind, Subject, Unit};

fn about(kind: FindingKind, path: &Path, message: impl Display) -> Finding {
    let file = path.display().to_string();
    Finding::new(kind, format!("{file}: {message}")).about(Subject::File(file))
}

pub fn autosave_unavailable(folder: &Path, error: &dyn Display) -> Finding {
    let message = format!("{error}; the open session will not be restored after a crash");
    about(kinds::AUTOSAVE_UNAVAILABLE, folder, message)
}

/// `when` is the time of the crash in words.
pub fn earlier_session_kept(when: &str) -> Finding {
    Finding::new(
        kinds::EARLIER_SESSION_KEPT,
        format!(
            "resect stopped unexpectedly {when}; the next window that opens without a file restores that session"
        ),
    )
}

/// `part` names the component of the session.
pub fn session_part_unknown(part: &str) -> Finding {
    Finding::new(
        kinds::SESSION_PART_UNKNOWN,
        format!("{part} has a format that this version of resect does not know; ignored"),
    )
    .about(Subject::Named(part.to_owned()))
}

pub fn session_plan_invalid(why: &str) -> Finding {
    Finding::new(kinds::SESSION_PLAN_INVALID, format!("the plan is invalid: {why}; ignored"))
}

/// `kept` is the new name of the file; `None` if it could not be moved.
pub fn unusable_file_kept(why: &str, kept: Option<&Path>) -> Finding {
    let message = match kept {
        Some(kept) => format!("{why}; the old file is kept as {}", kept.display()),
        None => format!("{why}; the file could not be renamed and stays unchanged"),
    };
    Finding::new(kinds::UNUSABLE_FILE_KEPT, message)
}

/// Sizes are those of the file when the session was saved, and now (bytes).
pub fn session_file_changed(path: &Path, bytes_before: u64, bytes_now: u64) -> Finding {
    let sizes = if bytes_before == bytes_now {
        "same size, different content".to_owned()
    } else {
        format!("{bytes_before} bytes, {bytes_now} now")
    };
    let message = format!("changed since the session was saved ({sizes}); the result may differ");
    about(kinds::SESSION_FILE_CHANGED, path, message)
        .quantity("bytes_before", bytes_before as f64, Unit::Count)
        .quantity("bytes_now", bytes_now as f64, Unit::Count)
}

pub fn session_file_missing(path: &Path, error: &dyn Display) -> Finding {
    let message =
        format!("cannot be read now ({error}); it was readable when the session was saved");
    about(kinds::SESSION_FILE_MISSING, path, message)
}

/// `what` describes the error of the layout, and its consequence.
pub fn layout_invalid(what: &str) -> Finding {
    Finding::new(kinds::LAYOUT_INVALID, what)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use resect_core::deployment::Severity;

    use super::*;

    const LONGEST_SENTENCE_WORDS: usize = 25;

    fn examples() -> Vec<Finding> {
        let path = Path::new("day/tracks.csv");
        vec![
            autosave_unavailable(Path::new("autosave"), &"disk full"),
            earlier_session_kept("an hour ago"),
            session_part_unknown("the layout"),
            session_plan_invalid("no waypoint"),
            unusable_file_kept("preferences.toml: not TOML", Some(Path::new("preferences.bak"))),
            session_file_changed(path, 3, 4),
            session_file_missing(path, &"no such file"),
            layout_invalid("the layout names an unknown pane `maps`; ignored"),
        ]
    }

    #[test]
    fn every_kind_has_an_example_with_a_message() {
        let all = [
            resect_core::deployment::findings::examples(),
            resect_io::findings::examples(),
            resect_tools::findings::examples(),
            resect_live::findings::examples(),
            examples(),
        ]
        .concat();
        // The HTML report creates this kind from an error.
        let made: BTreeSet<FindingKind> = all
            .iter()
            .map(|finding| finding.kind)
            .chain([resect_core::deployment::kinds::NO_ANSWER])
            .collect();
        let kinds = kinds::of_all_crates();
        let missing: Vec<&FindingKind> = kinds.iter().filter(|kind| !made.contains(kind)).collect();
        assert!(missing.is_empty(), "{missing:?}");
        for kind in &kinds {
            let needs_advice = kind.is_doubt() || kind.severity() == Severity::Problem;
            assert!(!needs_advice || kind.advice.is_some(), "{kind:?}");
        }
        let is_kebab = |code: &str| code.chars().all(|c| c.is_ascii_lowercase() || c == '-');
        assert!(kinds.iter().all(|kind| is_kebab(kind.code)), "{kinds:?}");
        let codes: BTreeSet<&str> = kinds.iter().map(|kind| kind.code).collect();
        assert_eq!(codes.len(), kinds.len());
        let mut long = Vec::new();
        for finding in &all {
            let message = finding.to_string();
            assert!(message.len() > 8 && !message.contains('\n'), "{message}");
            for sentence in message.split([';', ':']).flat_map(|part| part.split(". ")) {
                let words = sentence.split_whitespace().count();
                if words > LONGEST_SENTENCE_WORDS {
                    long.push(format!("{words} words: {sentence}"));
                }
            }
            let mut keys: Vec<String> = finding
                .quantities
                .iter()
                .map(resect_core::deployment::FindingQuantity::key)
                .collect();
            keys.sort_unstable();
            keys.dedup();
            assert_eq!(keys.len(), finding.quantities.len(), "{finding:?}");
            assert!(finding.quantities.iter().all(|one| one.value.is_finite()), "{finding:?}");
        }
        assert!(long.is_empty(), "{}", long.join("\n"));
    }
}
