//! The JSON outputs of all commands against `resect schema`.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Command;

use serde_json::{Value, json};

use crate::commands::{resect, stdout};
use crate::schema_check::{Checker, described};

/// Described keys that these outputs lack, with the reason.
const NEVER: [(&str, &str); 2] = [
    (
        "/$defs/live_state/properties/left_out/additionalProperties/properties/count",
        "a replay has every message",
    ),
    (
        "/$defs/live_state/properties/left_out/additionalProperties/properties/first",
        "a replay has every message",
    ),
];

fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8")
}

fn schema() -> Value {
    serde_json::from_str(&stdout(&["schema"])).expect("JSON")
}

/// Runs the commands in a folder, where each finds the files of those before it.
struct Runs<'a> {
    folder: &'a Path,
    outputs: BTreeMap<String, Vec<Value>>,
}

impl Runs<'_> {
    fn path(&self, name: &str) -> String {
        text(&self.folder.join(name)).to_owned()
    }

    /// Runs a command line, in which `@name` is a path in the folder.
    fn run(&self, line: &str) -> String {
        let arguments: Vec<String> = line
            .split_whitespace()
            .map(|word| {
                word.strip_prefix('@').map_or_else(|| word.to_owned(), |name| self.path(name))
            })
            .collect();
        stdout(&arguments.iter().map(String::as_str).collect::<Vec<_>>())
    }

    /// Runs a command line with `--json`, and keeps its output, or each of its lines.
    fn keep(&mut self, line: &str) {
        let output = self.run(&format!("{line} --json"));
        let command = line.split(' ').next().expect("a command").to_owned();
        let values = serde_json::Deserializer::from_str(&output).into_iter();
        let values: Result<Vec<Value>, _> = values.collect();
        self.outputs.entry(command).or_default().extend(values.expect("JSON"));
    }

    fn simulate(&self, preset: &str, name: &str, flags: &str) {
        self.run(&format!("simulate --preset {preset} --out @{name} {flags}"));
    }
}

fn calibrations(runs: &mut Runs<'_>) {
    runs.simulate("warthog", "warthog", "--true-poses @true.tum");
    runs.simulate(
        "warthog",
        "stepped",
        "--seed 3 --settle 3,100,1,2,20,0,0 --clock-step 2,200,150",
    );
    runs.simulate("warthog", "turned", "--seed 4 --set-up-change 2,1.5,0,0,0");
    for preset in
        ["single-prism", "straight-line", "circle", "l-shape", "flat-floor", "field-errors"]
    {
        runs.simulate(preset, preset, "");
        runs.keep(&format!("calibrate @{preset} --evidence drive,rig"));
    }
    for folder in ["warthog", "stepped", "turned"] {
        runs.keep(&format!("calibrate @{folder}"));
    }
    runs.keep("calibrate @warthog --trace");
    runs.keep("calibrate @warthog --method two-point --method inter-prism");
    runs.keep("calibrate @warthog --method inter-prism --prior search");
    runs.keep("calibrate @single-prism --method dynamic-gcp");
    let known = runs.folder.join("warthog/known.csv");
    std::fs::write(known, coordinates(&runs.folder.join("warthog/GCP_raw_1.txt")))
        .expect("written");
    runs.keep("calibrate @warthog --method static-gcp");
    // A misread control point.
    runs.simulate("warthog", "misread", "");
    let points = runs.folder.join("misread/GCP_raw_1.txt");
    let text = std::fs::read_to_string(&points).expect("control points");
    let number = text.lines().nth(13).and_then(|line| line.split(" , ").nth(5)).expect("a range");
    let longer = format!("{:.4}", number.parse::<f64>().expect("a number") + 0.08);
    std::fs::write(points, text.replacen(number, &longer, 1)).expect("written");
    runs.keep("calibrate @misread --method static-gcp");
}

/// Coordinates of the control points as station 1 measured them, moved by 100 m.
fn coordinates(readings: &Path) -> String {
    let mut table = "file,marker_number,x_m,y_m,z_m\n".to_owned();
    for line in std::fs::read_to_string(readings).expect("control points").lines().skip(1) {
        let number: Vec<f64> =
            line.split(',').map(|n| n.trim().parse().expect("a number")).collect();
        let (marker, zenith, azimuth, range) = (number[1], number[3], number[4], number[5]);
        let [x, y] = [azimuth.cos(), -azimuth.sin()].map(|along| range * zenith.sin() * along);
        if number[0] == 1.0 {
            table +=
                &format!("GCP_raw_1.txt,{marker},{},{y},{}\n", x + 100.0, range * zenith.cos());
        }
    }
    table
}

fn studies(runs: &mut Runs<'_>) {
    runs.keep("compare @warthog @single-prism");
    runs.keep("compare @turned");
    runs.keep("ablate @warthog");
    runs.keep("sweep @warthog --parameter tau-s --from 0.5 --to 3");
    for folder in ["warthog", "stepped"] {
        let calibration = runs.run(&format!("calibrate @{folder} --json"));
        std::fs::write(runs.folder.join("earlier.json"), calibration).expect("written");
        runs.keep("validate @earlier.json @warthog @turned");
        runs.keep("validate @earlier.json @warthog");
    }
}

fn evaluations(runs: &mut Runs<'_>) {
    // A pose that the usual tilt completes agrees with nothing to millimetres.
    runs.run("trajectory @warthog --max-sigma 20,0.5 --out @own.tum");
    let poses = std::fs::read_to_string(runs.path("true.tum")).expect("poses");
    let changed = |name: &str, change: &dyn Fn(&mut [f64])| {
        let lines = poses.lines().filter(|line| !line.starts_with('#')).map(|line| {
            let mut numbers: Vec<f64> =
                line.split_whitespace().map(|n| n.parse().expect("a number")).collect();
            change(&mut numbers);
            numbers.iter().map(|n| format!("{n:.9}")).collect::<Vec<_>>().join(" ") + "\n"
        });
        std::fs::write(runs.path(name), lines.collect::<String>()).expect("written");
    };
    changed("bent.tum", &|pose| pose[2] += 1e-3 * pose[1] * pose[1]);
    changed("late.tum", &|pose| pose[0] += 1e6);
    runs.keep("evaluate @true.tum @own.tum --against @warthog");
    runs.keep("check @true.tum @own.tum");
    let drives = "[[drive]]\ntruth = \"bent.tum\"\nestimates = [\"true.tum\", \"missing.tum\"]\n";
    std::fs::write(runs.path("drives.toml"), drives).expect("written");
    runs.keep("evaluate --drives @drives.toml");
    runs.keep("evaluate @true.tum @late.tum --against @warthog --time-offset 0");
    runs.keep("evaluate @true.tum @own.tum --against @bent.tum");
    runs.keep("evaluate @true.tum --against @warthog --truth-station 2");
    runs.keep("extrinsics @true.tum @own.tum");
    runs.keep("extrinsics @true.tum @bent.tum");
}

fn drives_to_come(runs: &mut Runs<'_>) {
    for preset in ["warthog", "hd2-tunnel", "single-prism", "straight-line"] {
        runs.keep(&format!("plan --preset {preset}"));
    }
    let plan = concat!("plan ", env!("CARGO_MANIFEST_DIR"), "/assets/plan.toml");
    runs.keep(plan);
    runs.keep("plan @warthog");
    runs.keep("live --replay @stepped --speed 40 --record @drive.mcap --answer");
    runs.keep("live --replay @single-prism --speed 100");
}

/// Runs all commands with JSON outputs, by several methods and with many kinds of data.
fn outputs(folder: &Path) -> BTreeMap<String, Vec<Value>> {
    let mut runs = Runs { folder, outputs: BTreeMap::new() };
    calibrations(&mut runs);
    studies(&mut runs);
    evaluations(&mut runs);
    drives_to_come(&mut runs);
    runs.outputs
}

#[test]
fn every_json_output_is_as_described_and_every_described_key_occurs() {
    let folder = tempfile::tempdir().expect("a folder");
    let schema = schema();
    let checker = Checker { schema: &schema };
    let (mut errors, mut met) = (BTreeSet::new(), BTreeSet::new());
    let outputs = outputs(folder.path());
    for (command, values) in &outputs {
        for value in values {
            let checked = checker.check(&format!("/$defs/{command}"), value, command);
            errors.extend(checked.errors);
            met.extend(checked.met);
        }
    }
    let errors: Vec<String> = errors.into_iter().collect();
    assert!(errors.is_empty(), "{} errors:\n{}", errors.len(), errors.join("\n"));
    let mut all = BTreeSet::new();
    described(&schema, "", &mut all);
    let never: BTreeSet<String> = NEVER.iter().map(|(pointer, _)| (*pointer).to_owned()).collect();
    let unmet: BTreeSet<String> = all.difference(&met).cloned().collect();
    assert_eq!(unmet, never, "described keys that no output has, and those expected");
}

#[test]
fn an_undescribed_a_missing_and_a_wrong_value_are_found() {
    let schema = schema();
    let checker = Checker { schema: &schema };
    let sound = json!({ "answer": "joint", "reason": "good", "text": "Use it." });
    let errors = |change: &dyn Fn(&mut Value)| {
        let mut value = sound.clone();
        change(&mut value);
        checker.check("/$defs/recommendation", &value, "it").errors
    };
    assert_eq!(errors(&|_| ()), Vec::<String>::new());
    assert_eq!(errors(&|it| it["more"] = 1.into()), ["it.more is not described"]);
    assert_eq!(errors(&|it| it["reason"] = "other".into()).len(), 1);
    assert_eq!(errors(&|it| it["text"] = Value::Null).len(), 1);
    assert_eq!(errors(&|it| _ = it.as_object_mut().map(|it| it.remove("reason"))).len(), 1);
}

#[test]
fn the_schema_of_a_command_refers_to_its_definition() {
    let schema = schema();
    let file = include_str!("../../assets/schema.json");
    assert_eq!(schema, serde_json::from_str::<Value>(file).expect("JSON"));
    let alternatives = schema["anyOf"].as_array().expect("a list");
    for alternative in alternatives {
        let reference = alternative["$ref"].as_str().expect("text");
        let command = reference.trim_start_matches("#/$defs/");
        let own: Value = serde_json::from_str(&stdout(&["schema", command])).expect("JSON");
        assert_eq!(own["$ref"], reference);
        assert_eq!((&own["anyOf"], &own["$defs"]), (&Value::Null, &schema["$defs"]));
    }
    assert_eq!(alternatives.len(), 10);
    assert_eq!(resect(&["schema", "export"]).status.code(), Some(2));
}

/// Validates the schema and the same outputs with an independent validator.
#[test]
#[ignore = "needs the PyPI package jsonschema: tests/run --peers"]
fn the_peer_jsonschema_accepts_every_output() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("outputs.json");
    std::fs::write(&file, json!(outputs(folder.path())).to_string()).expect("written");
    let described = folder.path().join("schema.json");
    std::fs::write(&described, stdout(&["schema"])).expect("written");
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/peers/validate_json.py");
    let output = Command::new("python").args([script, text(&described), text(&file)]).output();
    let output = output.expect("tests/run --peers has it on the path");
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{said}{}", String::from_utf8_lossy(&output.stderr));
}
