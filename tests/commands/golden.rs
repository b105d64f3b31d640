//! The JSON of `calibrate` for every preset, compared with the files in `tests/fixtures/golden`.
//!
//! `UPDATE_GOLDEN=1 cargo test --test commands golden` rewrites them; check the difference before you commit it.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use resect_core::analysis::{Analyst, Settings};
use resect_core::calibration::Method;
use resect_core::progress::Progress;
use resect_io::simulation_files::write_folder;
use resect_io::source::Source;
use resect_report::json::calibration;
use resect_tools::simulation::{Preset, simulate};
use serde_json::Value;

use crate::common::{by, published};

/// Relative tolerance of numbers; processors round differently.
const RELATIVE: f64 = 1e-9;
/// Numbers below this are rounding errors of zero (m, rad, s, 1).
const ZERO: f64 = 1e-12;
/// Paths that differ from run to run, or that another test covers.
const LEFT_OUT: [&str; 7] = [
    // Each reading of a control point.
    "details.joint.reliability",
    "time_ms",
    "schema",
    "recommendation.text",
    "diagnosis.findings",
    "diagnosis.doubts",
    "published.findings",
];

fn golden(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/golden").join(name)
}

/// The object that `calibrate FOLDER --json` prints for a simulated drive.
fn object(preset: Preset, settings: &Settings) -> Value {
    let temporary = tempfile::tempdir().expect("a folder");
    let folder = temporary.path().join(preset.name());
    write_folder(&simulate(preset, 1), &folder).expect("written");
    let deployment = Source::at(&folder).open(&Progress::default()).expect("valid");
    let analysis = Analyst::new(deployment.clone().into()).run(settings);
    let answer = analysis.answer.as_ref().expect("an answer");
    calibration(&deployment, &analysis, answer, 0.0)
}

/// Removes the value at a path of keys.
fn remove(value: &mut Value, path: &str) {
    let (folder, key) = path.rsplit_once('.').unwrap_or(("", path));
    let pointer = folder.split('.').filter(|key| !key.is_empty()).map(|key| format!("/{key}"));
    let object = value.pointer_mut(&pointer.collect::<String>()).and_then(Value::as_object_mut);
    if let Some(object) = object {
        object.remove(key);
    }
}

/// Lists the paths at which two values differ.
fn differences(path: &str, expected: &Value, found: &Value, into: &mut Vec<String>) {
    match (expected, found) {
        (Value::Object(a), Value::Object(b)) => {
            for key in a.keys().chain(b.keys()).collect::<BTreeSet<_>>() {
                let path = format!("{path}.{key}");
                match (a.get(key), b.get(key)) {
                    (Some(a), Some(b)) => differences(&path, a, b, into),
                    (Some(_), None) => into.push(format!("{path} is missing")),
                    _ => into.push(format!("{path} is new")),
                }
            }
        }
        (Value::Array(a), Value::Array(b)) if a.len() == b.len() => {
            for (index, (a, b)) in a.iter().zip(b).enumerate() {
                differences(&format!("{path}[{index}]"), a, b, into);
            }
        }
        (Value::Number(a), Value::Number(b)) => {
            let [a, b] = [a, b].map(|number| number.as_f64().expect("a number"));
            if (a - b).abs() > (RELATIVE * a.abs().max(b.abs())).max(ZERO) {
                into.push(format!("{path}: {a} became {b}"));
            }
        }
        _ if expected == found => {}
        _ => into.push(format!("{path}: {expected} became {found}")),
    }
}

/// Compares a value with its file, or writes the file.
#[track_caller]
fn assert_golden(name: &str, found: &Value) {
    let file = golden(name);
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&file, format!("{found:#}\n")).expect("written");
        return;
    }
    let text = std::fs::read_to_string(&file).unwrap_or_else(|error| panic!("{name}: {error}"));
    let mut all = Vec::new();
    differences("", &serde_json::from_str(&text).expect("JSON"), found, &mut all);
    assert!(all.is_empty(), "{name}, {} differences:\n{}", all.len(), all.join("\n"));
}

#[track_caller]
fn assert_preset(preset: Preset) {
    let mut found = object(preset, &by(Method::Joint));
    LEFT_OUT.iter().for_each(|path| remove(&mut found, path));
    assert_golden(&format!("{}.json", preset.name()), &found);
}

macro_rules! presets {
    ($($name:ident: $preset:ident),* $(,)?) => {
        $(#[test]
        fn $name() {
            assert_preset(Preset::$preset);
        })*

        #[test]
        fn every_preset_has_its_file() {
            let tested = [$(Preset::$preset),*];
            assert!(Preset::ALL.iter().all(|preset| tested.contains(preset)));
        }
    };
}

presets! {
    warthog: Warthog,
    hd2_tunnel: Hd2Tunnel,
    flat_floor: FlatFloor,
    uneven_ground: UnevenGround,
    single_prism: SinglePrism,
    figure_eight: FigureEight,
    short_baselines: ShortBaselines,
    straight_line: StraightLine,
    circle: Circle,
    l_shape: LShape,
    field_errors: FieldErrors,
}

/// Paths of all keys of a value; elements of a list share one path.
fn keys(path: &str, value: &Value, into: &mut BTreeSet<String>) {
    match value {
        Value::Object(object) => {
            for (key, value) in object {
                let path = format!("{path}.{key}").trim_start_matches('.').to_owned();
                keys(&path, value, into);
                into.insert(path);
            }
        }
        Value::Array(list) => {
            list.iter().for_each(|value| keys(&format!("{path}[]"), value, into));
        }
        _ => {}
    }
}

/// Scripts read these keys: none may disappear, and a new one is added on purpose.
#[test]
fn the_keys_of_the_contract() {
    let mut methods = serde_json::Map::new();
    for (name, preset, settings) in [
        ("joint", Preset::Warthog, by(Method::Joint)),
        ("inter-prism", Preset::Warthog, published()),
        ("static-gcp", Preset::Warthog, by(Method::StaticGcp)),
        ("two-point", Preset::Warthog, by(Method::TwoPoint)),
        ("dynamic-gcp", Preset::SinglePrism, by(Method::DynamicGcp)),
    ] {
        let mut found = BTreeSet::new();
        keys("", &object(preset, &settings), &mut found);
        methods.insert(name.to_owned(), found.into_iter().collect());
    }
    assert_golden("keys.json", &Value::Object(methods));
}
