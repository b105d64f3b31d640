//! Opening: its progress, its cancellation, and files that the user names in addition to those beside the tracks.

use resect_io::findings::kinds;
use std::path::{Path, PathBuf};

use crate::common::{field_data, sample_folder};
use resect_core::progress::Progress;
use resect_io::error::OpenError;
use resect_io::open::open;
use resect_io::sample::Sample;
use resect_io::source::{Extras, Source};

fn used(deployment: &resect_core::deployment::Deployment, end: &str) -> Vec<bool> {
    let ends = deployment.ingredients.iter().filter(|i| Path::new(&i.file).ends_with(end));
    ends.map(|i| i.used).collect()
}

#[test]
fn progress_ends_at_the_bytes_that_were_read() {
    let mut paths = vec![sample_folder("warthog")];
    paths.extend(field_data("2022-07-11-2-bags").map(|bags| bags.join("2022-07-11-2-bz2.bag")));
    for path in paths {
        let progress = Progress::default();
        Source::at(&path).open(&progress).expect("opens");
        assert!(progress.total() > 10_000, "{}", path.display());
        assert_eq!(progress.done(), progress.total(), "{}", path.display());
    }
}

/// Also among more other files than a message names.
#[test]
fn an_empty_file_of_tracks_is_named_in_the_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let points = sample_folder("warthog").join("GCP_raw_1.txt");
    for k in 1..=6 {
        let copy = folder.path().join(format!("GCP_raw_{k}.txt"));
        std::fs::copy(&points, copy).expect("copied");
    }
    std::fs::write(folder.path().join("inter_prism.csv"), "").expect("written");
    let error = open(folder.path()).expect_err("no tracks").to_string();
    assert!(error.contains("among: inter_prism.csv (empty), GCP_raw_1.txt"), "{error}");
    assert!(error.contains("and 3 more"), "{error}");
}

#[test]
fn what_is_cancelled_is_not_an_error_of_the_data() {
    let mut paths =
        vec![sample_folder("warthog"), sample_folder("warthog").join("inter_prism.csv")];
    paths.extend(field_data("2022-07-11-2-bags").map(|bags| bags.join("2022-07-11-2.bag")));
    for path in paths {
        let progress = Progress::default();
        progress.cancel();
        let result = Source::at(&path).open(&progress);
        assert!(matches!(result, Err(OpenError::Cancelled)), "{}", path.display());
    }
}

#[test]
fn named_control_points_are_added_or_used_instead() {
    let folder = tempfile::tempdir().expect("a folder");
    let more = folder.path().join("more.txt");
    std::fs::copy(sample_folder("warthog").join("GCP_raw_1.txt"), &more).expect("copied");
    let open = |gcp: &[&PathBuf], gcp_instead| {
        let gcp = gcp.iter().map(|path| (*path).clone()).collect();
        let extras = Extras { gcp, gcp_instead, ..Extras::default() };
        Source::sample(Sample::Warthog).with(extras).open(&Progress::default()).expect("opens")
    };
    let own = open(&[], false);
    let added = open(&[&more], false);
    assert_eq!(added.control_points.len(), own.control_points.len() + 1);
    // The survey of the pillars, beside the tracks, still belongs to them.
    assert!(added.control_points.iter().any(|set| set.points.iter().all(|p| p.known_m.is_some())));
    let instead = open(&[&more], true);
    assert_eq!(instead.control_points.len(), 1);
    assert_eq!(used(&instead, "GCP_raw_1.txt"), [false]);
    assert_eq!(used(&instead, "more.txt"), [true]);
}

#[test]
fn a_file_that_lies_with_the_tracks_counts_once_when_it_is_named_too() {
    let path = sample_folder("warthog");
    let own = open(&path).expect("opens");
    let extras = Extras { gcp: vec![path.join("GCP_raw_2.txt")], ..Extras::default() };
    let named = Source::at(&path).with(extras).open(&Progress::default()).expect("opens");
    assert_eq!(named.control_points.len(), own.control_points.len());
    assert_eq!(used(&named, "GCP_raw_2.txt"), [false, true]);
}

#[test]
fn a_named_rig_is_used_whatever_else_describes_one() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let sample = sample_folder("warthog");
    std::fs::copy(sample.join("inter_prism.csv"), path("p.csv")).expect("copied");
    std::fs::write(path("deployment.toml"), "inter_prism_m = [0.7, 0.9, 1.0]\n").expect("written");
    let other = tempfile::tempdir().expect("a folder");
    let rig = other.path().join("distances.txt");
    std::fs::write(&rig, "0.8 0.9 1.1\n").expect("written");
    let with = |rig: Option<PathBuf>| {
        let extras = Extras { rig, ..Extras::default() };
        Source::at(folder.path()).with(extras).open(&Progress::default())
    };
    let own = with(None).expect("opens").rig.expect("given").inter_prism_m;
    assert_eq!(own, [0.7, 0.9, 1.0].into());
    let named = with(Some(rig)).expect("opens");
    assert_eq!(named.rig.expect("named").inter_prism_m, [0.8, 0.9, 1.1].into());
    assert!(named.findings.iter().any(|f| f.kind == kinds::RIG_FILE_PREFERRED));
    let error = with(Some(path("p.csv"))).expect_err("tracks are no rig").to_string();
    assert!(error.contains("does not describe the rig (polar measurements"), "{error}");
}

#[test]
fn three_named_antennas_take_the_place_of_those_that_are_there() {
    let path = sample_folder("warthog");
    let gnss = vec![path.join("gnss_2.pos"), path.join("gnss_1.pos"), path.join("gnss_3.pos")];
    let extras = Extras { gnss, ..Extras::default() };
    let own = open(&path).expect("opens").gnss.expect("three");
    let named = Source::at(&path).with(extras).open(&Progress::default()).expect("opens");
    let named = named.gnss.expect("three");
    assert_eq!(named[0], own[1]);
    assert_eq!(named[2], own[2]);
}

/// For example `lost+found`, or a file of another user: readable files are read, and the rest is reported.
#[cfg(target_os = "linux")]
#[test]
fn a_neighbour_that_cannot_be_read_is_passed_over_and_told() {
    let folder = tempfile::tempdir().expect("a folder");
    for file in ["inter_prism.csv", "calibration_results.csv"] {
        std::fs::copy(sample_folder("hd2-tunnel").join(file), folder.path().join(file))
            .expect("copied");
    }
    // A file that exists but cannot be read, even by root.
    std::os::unix::fs::symlink("/proc/self/mem", folder.path().join("sealed.csv")).expect("linked");
    let deployment = open(folder.path()).expect("the rest is whole");
    let told: Vec<_> = deployment.findings.iter().map(ToString::to_string).collect();
    assert!(told.iter().any(|line| line.contains("sealed.csv: cannot be read")), "{told:#?}");
    assert_eq!(used(&deployment, "sealed.csv"), [false]);
    let alone = open(&folder.path().join("sealed.csv")).expect_err("asked for by name");
    assert!(alone.to_string().contains("check the path and its permissions"), "{alone}");
}

#[cfg(unix)]
#[test]
fn a_pipe_is_refused_instead_of_waited_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let pipe = folder.path().join("tracks.csv");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status().expect("mkfifo");
    assert!(made.success());
    let error = open(&pipe).expect_err("no file").to_string();
    assert!(error.contains("tracks.csv: a pipe"), "{error}");
    assert!(error.contains("save its output as a file"), "{error}");
}
