//! The commands with deployments of one, two, four and eight stations.

use std::path::Path;

use resect_io::simulation_files::write_folder;
use resect_tools::simulation::{Preset, simulate_scenario};
use serde_json::Value;
use tempfile::TempDir;

use super::commands::{complaint, resect, stdout};
use super::schema_check::Checker;

/// Simulates a deployment into a folder.
fn folder(stations: usize, prisms: usize) -> TempDir {
    let folder = TempDir::new().expect("a folder");
    let scenario = Preset::Warthog.scenario().with_network(stations, prisms);
    write_folder(&simulate_scenario(&scenario, 3), folder.path()).expect("writes");
    folder
}

fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8")
}

#[test]
fn every_command_takes_one_to_eight_stations() {
    let out = TempDir::new().expect("a folder");
    let file = |name: &str| text(&out.path().join(name)).to_owned();
    let schema: Value = serde_json::from_str(&stdout(&["schema"])).expect("JSON");
    let checker = Checker { schema: &schema };
    for (stations, prisms) in [(1, 1), (2, 1), (2, 2), (2, 3), (4, 1), (4, 3), (4, 4), (8, 4)] {
        let own = folder(stations, prisms);
        let own = text(own.path());
        let answer: Value =
            serde_json::from_str(&stdout(&["calibrate", own, "--json"])).expect("JSON");
        let transforms = answer["transforms"].as_array().expect("a list");
        assert_eq!(transforms.len(), stations - 1, "{stations} stations, {prisms} prisms");
        let errors = checker.check("/$defs/calibration", &answer, "calibrate").errors;
        assert!(errors.is_empty(), "{stations} stations, {prisms} prisms: {errors:?}");
        if stations > 1 {
            let plan: Value =
                serde_json::from_str(&stdout(&["plan", own, "--json"])).expect("JSON");
            let errors = checker.check("/$defs/plan", &plan, "plan").errors;
            assert!(errors.is_empty(), "{stations} stations, {prisms} prisms: {errors:?}");
        }
        let further = (stations % 8 + 1).to_string();
        if stations < 8 {
            let line = complaint(&["trajectory", own, "--station", &further], 1);
            assert!(line.contains(&format!("there is no station {further}")), "{line}");
        }
        std::fs::write(out.path().join("answer.json"), answer.to_string()).expect("writes");
        for arguments in [
            &["calibrate", own][..],
            &["compare", own],
            &["ablate", own],
            &["sweep", own, "--parameter", "tau-s", "--from", "1", "--to", "2", "--steps", "2"],
            &["validate", &file("answer.json"), own],
            &["trajectory", own, "--out", &file("poses.csv")],
            &["report", own, "--out", &file("report.html")],
            &["export", own, "--csv", &file(&format!("tables-{stations}-{prisms}"))],
            &["check", own],
            &["plan", own],
        ] {
            let output = resect(arguments);
            let (code, said) = (output.status.code(), String::from_utf8_lossy(&output.stderr));
            let printed = String::from_utf8_lossy(&output.stdout);
            let place = format!("{stations} stations, {prisms} prisms, {arguments:?}: {said}");
            assert!(!printed.contains("NaN"), "{place}\n{printed}");
            match arguments[0] {
                // One station has nothing that could have changed, and a plan has at least two.
                "validate" | "plan" if stations == 1 => {
                    assert!(code != Some(101), "{place}");
                }
                // Two prisms have no orientation.
                "trajectory" if prisms == 2 || (stations == 2 && prisms > 2) => {
                    assert_eq!(code, Some(1), "{place}");
                    assert!(said.contains("fewer than three prisms"), "{place}");
                }
                "validate" => assert!(matches!(code, Some(0 | 3)), "{place}"),
                _ => assert_eq!(code, Some(0), "{place}"),
            }
        }
    }
}
