//! Determinism: the same input gives the same bytes in every output, for any number of threads.
//!
//! `SOURCE_DATE_EPOCH` fixes the date and the durations of a run.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use tempfile::TempDir;

/// Standard output of a command, and every file that it wrote, by name.
type Outputs = BTreeMap<String, Vec<u8>>;

/// Runs resect in an empty folder, which receives all output files.
#[track_caller]
fn outputs(arguments: &[&str], threads: usize) -> Outputs {
    let folder = tempfile::tempdir().expect("a folder");
    let output = Command::new(env!("CARGO_BIN_EXE_resect"))
        .args(arguments)
        .current_dir(folder.path())
        .env("SOURCE_DATE_EPOCH", "1783987200")
        .env("RAYON_NUM_THREADS", threads.to_string())
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .output()
        .expect("resect starts");
    let complaint = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {complaint}");
    let mut all = Outputs::from([
        ("standard output".to_owned(), output.stdout),
        ("standard error".to_owned(), output.stderr),
    ]);
    take_files(folder.path(), folder.path(), &mut all);
    all
}

fn take_files(top: &Path, folder: &Path, into: &mut Outputs) {
    for entry in std::fs::read_dir(folder).expect("readable") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            take_files(top, &path, into);
        } else {
            let name = path.strip_prefix(top).expect("below").to_string_lossy().into_owned();
            into.insert(name, std::fs::read(path).expect("readable"));
        }
    }
}

/// Runs a command twice with one thread and twice with four.
#[track_caller]
fn assert_always_the_same(arguments: &[&str], files: usize) {
    let first = outputs(arguments, 1);
    assert!(first.len() == files + 2, "{arguments:?} wrote {:?}", first.keys());
    for threads in [1, 4, 4] {
        let again = outputs(arguments, threads);
        assert!(first.keys().eq(again.keys()), "{arguments:?}: {:?}", again.keys());
        for (name, bytes) in &first {
            let other = &again[name];
            let at = bytes.iter().zip(other).position(|(a, b)| a != b);
            let at = at.or((bytes.len() != other.len()).then_some(bytes.len().min(other.len())));
            if let Some(at) = at {
                let about = |bytes: &[u8]| {
                    let part = &bytes[at.saturating_sub(60)..(at + 60).min(bytes.len())];
                    String::from_utf8_lossy(part).into_owned()
                };
                panic!(
                    "{arguments:?} with {threads} threads: {name} differs from byte {at} of {} on:\n{}\n{}",
                    bytes.len(),
                    about(bytes),
                    about(other)
                );
            }
        }
    }
}

/// Returns a short drive with all errors of the field, so that every output has content.
fn drive() -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = resect_tools::simulation::Scenario {
        duration_s: 120.0,
        ..resect_tools::simulation::Preset::FieldErrors.scenario()
    };
    let simulated = resect_tools::simulation::simulate_scenario(&scenario, 3);
    resect_io::simulation_files::write_folder(&simulated, folder.path()).expect("written");
    folder
}

/// Tests commands: each with its arguments, `@` for the drive, and the number of files that it writes.
#[track_caller]
fn hold(commands: &[(&str, usize)]) {
    let folder = drive();
    let path = folder.path().to_str().expect("UTF-8");
    for (line, files) in commands {
        let line: Vec<&str> =
            line.split(' ').map(|word| if word == "@" { path } else { word }).collect();
        assert_always_the_same(&line, *files);
    }
}

#[test]
fn answers() {
    hold(&[
        ("check @", 0),
        ("calibrate @", 0),
        ("calibrate @ --json", 0),
        ("calibrate @ --method two-point --method static-gcp --method inter-prism --json", 0),
        ("calibrate @ --method inter-prism --prior search --json", 0),
        ("calibrate @ --method inter-prism --interpolation wnoa --json", 0),
    ]);
}

#[test]
fn studies() {
    hold(&[
        ("compare @ --out out --splits 3 --seed 7", 3),
        ("ablate @ --out out", 3),
        ("sweep @ --parameter tau-s --from 0.5 --to 2 --steps 3 --out out", 3),
    ]);
}

#[test]
fn files_for_other_programs() {
    hold(&[
        ("report @ --out report.html", 1),
        ("trajectory @ --out drive.tum", 1),
        ("trajectory @ --out drive.csv", 1),
        ("export @ --csv out", 6),
        ("simulate --preset field-errors --seed 5 --out out", 12),
    ]);
}

#[test]
#[cfg(feature = "rerun")]
fn recordings_for_the_rerun_viewer() {
    hold(&[("export @ --rrd drive.rrd", 1)]);
}

#[test]
fn pictures() {
    hold(&[("screenshot @ --out window.png --size 1200x800", 1)]);
}

#[test]
fn validations() {
    let calibration = outputs(&["calibrate", drive().path().to_str().expect("UTF-8"), "--json"], 1);
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("calibration.json");
    std::fs::write(&file, &calibration["standard output"]).expect("written");
    hold(&[(&format!("validate {} @", file.display()), 0)]);
}
