#![no_main]

//! A trajectory of another system in any encoding and layout, and the file of its covariances; evaluated against itself.

use resect_core::analysis::{Analyst, Settings};
use resect_core::progress::Progress;
use resect_io::source::{Source, TrajectoryFile};
use resect_tools::estimates::{GroundTruth, Options, judge};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let folder = tempfile::tempdir_in(resect_fuzz::place()).expect("a folder");
    // A form feed separates the trajectory from its covariances.
    let mut parts = bytes.splitn(2, |byte| *byte == 0x0c);
    let path = folder.path().join("gt.txt");
    std::fs::write(&path, parts.next().unwrap_or_default()).expect("writable");
    if let Some(covariances) = parts.next() {
        std::fs::write(folder.path().join("gt_covariance.csv"), covariances).expect("writable");
    }
    let opened = Source::ground_truth(TrajectoryFile::at(&path, None)).open(&Progress::default());
    let (Ok(estimates), Ok(deployment)) = (resect_io::estimate_file::read(&path), opened) else {
        return;
    };
    let deployment = std::sync::Arc::new(deployment);
    let analysis = Analyst::new(deployment.clone()).run(&Settings::default());
    let truth = GroundTruth::of(&deployment, &analysis, None);
    let estimates = estimates.into_iter().map(|one| (one, Options::default())).collect();
    _ = judge(&truth, estimates);
});
