//! Comparison of a session with the saved one.

use std::fmt::Debug;

use resect::app::persist::session::{SavedDeployment, Session};

/// Asserts that everything saved is restored.
#[track_caller]
pub fn assert_same(saved: &Session, found: &Session, when: &str) {
    let mut off = Vec::new();
    let sources = |session: &Session| {
        let of = |saved: &SavedDeployment| saved.source.clone();
        session.deployments.iter().map(of).collect::<Vec<_>>()
    };
    compare(&mut off, "deployments", &sources(saved), &sources(found));
    if off.is_empty() {
        for (one, other) in saved.deployments.iter().zip(&found.deployments) {
            compare(&mut off, "settings", &one.settings, &other.settings);
            // There is no cursor before the first calibration, which a crash may precede.
            if one.cursor_s.is_some() {
                compare(&mut off, "cursor", &one.cursor_s, &other.cursor_s);
            }
            compare(&mut off, "window of time", &one.window_s, &other.window_s);
            compare(&mut off, "selection", &one.selection_s, &other.selection_s);
        }
        compare(&mut off, "what is shown", &saved.active, &found.active);
    }
    compare(&mut off, "view", &saved.view, &found.view);
    compare(&mut off, "layout", &saved.layout, &found.layout);
    compare(&mut off, "pins", &saved.pins, &found.pins);
    assert!(off.is_empty(), "{when}, not all that was saved is there:\n{}", off.join("\n"));
}

fn compare<T: PartialEq + Debug>(off: &mut Vec<String>, what: &str, saved: &T, found: &T) {
    if saved != found {
        off.push(format!("{what}: saved {saved:?}\n  found {found:?}"));
    }
}
