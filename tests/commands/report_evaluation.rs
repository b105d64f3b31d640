//! Reports and pictures of an evaluation without a deployment.

use std::path::Path;

use crate::commands::{complaint, stdout};
use crate::common::slam::{SLAM, Slam, driven, write_tum};

/// Writes two estimates and their ground truth; returns their paths.
fn trajectories(folder: &Path) -> [String; 3] {
    let (simulated, _) = driven(1);
    let vio = Slam { noise_m: 0.05, seed: 2, drift_m: 0.0, ..SLAM };
    let truth = Slam { noise_m: 0.001, drift_m: 0.0, rate_hz: 50.0, seed: 3, ..SLAM };
    let all = [("lio", Slam { drift_m: 0.0, ..SLAM }), ("vio", vio), ("truth", truth)];
    all.map(|(name, slam)| {
        let path = folder.join(format!("{name}.tum"));
        write_tum(&slam.drive(&simulated), &path);
        path.to_str().expect("UTF-8").to_owned()
    })
}

#[test]
fn a_page_has_the_verdict_the_table_and_the_errors_over_time() {
    let folder = tempfile::tempdir().expect("a folder");
    let [lio, vio, truth] = trajectories(folder.path());
    let page = stdout(&["report", &lio, &vio, "--against", &truth, "--out", "-"]);
    let places = [
        "<title>truth: evaluation of trajectories</title>",
        "lio is better in position",
        "Ground truth: truth",
        "APE position, rmse (mm)",
        "aria-label=\"position errors over time\"",
        "SHA-256",
    ]
    .map(|text| page.find(text).unwrap_or_else(|| panic!("no {text} in the page")));
    assert!(places.is_sorted(), "{places:?}");
    assert!(!page.contains("NO ANSWER") && !page.contains("calibration of"));
    for name in ["lio.tum", "vio.tum", "truth.tum"] {
        assert!(page.contains(name), "{name} is among the files");
    }
    // The inputs are not overwritten, and flags of a ground truth need one.
    let line = complaint(&["report", &lio, "--against", &truth, "--out", &truth], 1);
    assert!(line.contains("is not overwritten"), "{line}");
    let line = complaint(&["report", &lio, "--truth-sigma", "0.01", "--out", "-"], 2);
    assert!(line.contains("--against"), "{line}");
    let line = complaint(&["report", &lio, "--against", &vio, "--judge", &lio, "--out", "-"], 2);
    assert!(line.contains("--judge"), "{line}");
}

#[test]
fn a_picture_shows_trajectories_against_their_ground_truth() {
    let folder = tempfile::tempdir().expect("a folder");
    let [lio, vio, truth] = trajectories(folder.path());
    let file = folder.path().join("window.png");
    let out = file.to_str().expect("UTF-8");
    let picture = ["screenshot", &lio, &vio, "--against", &truth, "--out", out];
    assert!(stdout(&picture).contains("1600×1000"));
    let pane = file.with_extension("svg");
    let pane = pane.to_str().expect("UTF-8");
    stdout(&[&picture[..5], &["--pane", "evaluation", "--out", pane]].concat());
    let svg = std::fs::read_to_string(pane).expect("written");
    assert!(svg.contains("lio is better") || svg.contains("<path"), "the pane has a verdict");
    let line = complaint(&["screenshot", &lio, &vio, "--out", out], 2);
    assert!(line.contains("--against"), "{line}");
}
