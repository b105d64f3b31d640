//! Conventions of command-line tools: help, version, completions, standard output, quiet.

use crate::commands::{resect, stdout};
use crate::common::sample_folder;

const COMMANDS: [&str; 18] = [
    "calibrate",
    "compare",
    "validate",
    "ablate",
    "sweep",
    "trajectory",
    "evaluate",
    "live",
    "check",
    "report",
    "screenshot",
    "plan",
    "simulate",
    "export",
    "schema",
    "explain",
    "desktop",
    "completions",
];

#[test]
fn the_help_of_each_command_fits_100_columns_and_has_an_example() {
    let whole = stdout(&["--help"]);
    for command in COMMANDS {
        assert!(whole.contains(&format!("\n  {command}")), "{command} is not listed");
        let help = stdout(&[command, "--help"]);
        let wide = help.lines().find(|line| line.chars().count() > 100);
        assert_eq!(wide, None, "{command}");
        assert!(help.contains(&format!("Example: resect {command}")), "{command}");
    }
    assert!(whole.contains("Exit codes"));
    assert_eq!(whole.lines().find(|line| line.chars().count() > 100), None);
}

#[test]
fn the_version_names_the_build() {
    let version = stdout(&["--version"]);
    assert!(version.starts_with(&format!("resect {} (", env!("CARGO_PKG_VERSION"))), "{version}");
    assert!(version.contains("features: "), "{version}");
}

#[test]
fn shells_complete_commands_and_flags() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = stdout(&["completions", shell]);
        assert!(script.contains("calibrate") && script.contains("pose-rate"), "{shell}");
    }
}

#[test]
fn a_dash_as_file_is_standard_output_with_nothing_beside_the_file() {
    let path = sample_folder("warthog");
    let path = path.to_str().expect("UTF-8");
    let page = stdout(&["report", path, "--out", "-"]);
    assert!(page.starts_with("<!DOCTYPE html>") && page.trim_end().ends_with("</html>"));
    let plan = stdout(&["plan", "--preset", "warthog", "--out", "-"]);
    assert!(plan.parse::<toml::Table>().is_ok(), "{plan}");
    let poses = stdout(&["trajectory", path, "--out", "-"]);
    assert_eq!(poses, stdout(&["trajectory", path]));
    // A recording is written to a file only.
    let refused = resect(&["export", path, "--csv", "tables", "--rrd", "-"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("give a file name"));
}

#[test]
fn quiet_suppresses_notes_and_no_errors() {
    let folder = tempfile::tempdir().expect("a folder");
    let tracks =
        "timestamp,id,distance,ha,va\n1.0,1,10.0,0.1,1.5\n1.1,2,11.0,0.2,1.5\n1.2,3,12.0,0.3,1.5\n";
    std::fs::write(folder.path().join("inter_prism.csv"), tracks).expect("written");
    let path = folder.path().to_str().expect("UTF-8");
    let tables = folder.path().join("tables");
    let tables = tables.to_str().expect("UTF-8");
    let note = |more: &[&str]| {
        let output = resect(&[&["export", path, "--csv", tables][..], more].concat());
        assert_eq!(output.status.code(), Some(0));
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    assert!(note(&[]).contains("no answer"));
    assert_eq!(note(&["--quiet"]), "");
    let error = resect(&["--quiet", "calibrate", path]);
    assert_eq!(error.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&error.stderr).contains("no triplets"), "{error:?}");
    let warthog = sample_folder("warthog");
    let warthog = warthog.to_str().expect("UTF-8");
    assert_eq!(resect(&["--quiet", "check", warthog]).status.code(), Some(0));
    let misplaced = resect(&[warthog, "check"]);
    assert_eq!(misplaced.status.code(), Some(2));
    // Without a terminal there is no progress and no colour.
    let output = resect(&["calibrate", sample_folder("warthog").to_str().expect("UTF-8")]);
    assert!(output.stderr.is_empty() && !output.stdout.contains(&0x1b));
}
