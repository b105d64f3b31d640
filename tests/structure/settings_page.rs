//! The page of the settings, `docs/src/settings.md`, compared with the types of the core and the flags of the program.
//!
//! `UPDATE_GOLDEN=1 cargo test --test structure settings_page` writes it again.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::ops::Bound;

use crate::documents::assert_written;
use resect_core::analysis::Settings;
use resect_core::calibration::{CALIBRATION_NUMBERS, Method};
use resect_core::number_setting::NumberSetting;
use resect_core::pipeline::PIPELINE_NUMBERS;
use serde_json::Value;

/// Numbers at least this large are written without an exponent.
const LEAST_PLAIN: f64 = 1e-3;

/// Tables of a settings file: path, title and introduction.
const TABLES: [(&str, &str, &str); 5] = [
    ("pipeline", "Pipeline", "`[pipeline]`: modules, interpolation and rate."),
    (
        "pipeline.thresholds",
        "Thresholds",
        "`[pipeline.thresholds]`: the thresholds of the paper. [Tune the filters](tour/4_tune.md) shows their effect.",
    ),
    (
        "calibration",
        "Calibration",
        "`[calibration]`: methods, and the σ of the inter-prism distances.",
    ),
    (
        "calibration.evidence",
        "Evidence",
        "`[calibration.evidence]`: measurements that the joint estimate uses. It needs `drive` or `control_points`.",
    ),
    (
        "calibration.errors",
        "Prior σ of the errors",
        "`[calibration.errors]`: priors of the joint estimate. The other methods do not use them.",
    ),
];

/// A setting that is a word or a switch.
struct Choice {
    path: &'static str,
    flag: &'static str,
    values: &'static [&'static str],
    meaning: &'static str,
}

const SWITCH: &[&str] = &["true", "false"];

const CHOICES: [Choice; 11] = [
    Choice {
        path: "pipeline.outlier_filter",
        flag: "--no-outlier-filter",
        values: SWITCH,
        meaning: "Module 1, the outlier filter",
    },
    Choice {
        path: "pipeline.interval_filter",
        flag: "--no-interval-filter",
        values: SWITCH,
        meaning: "Module 3, the interval filter",
    },
    Choice {
        path: "pipeline.all_readings",
        flag: "--kept-readings",
        values: SWITCH,
        meaning: "The joint estimate takes all readings, not only those of the kept intervals",
    },
    Choice {
        path: "pipeline.interpolation",
        flag: "--interpolation",
        values: &["linear", "gp", "wnoa"],
        meaning: "Module 4, interpolation between readings",
    },
    Choice {
        path: "calibration.method",
        flag: "--method",
        values: &["two-point", "static-gcp", "dynamic-gcp", "inter-prism", "joint"],
        meaning: "Calibration method",
    },
    Choice {
        path: "calibration.alignment",
        flag: "--alignment",
        values: &["level", "rigid"],
        meaning: "Rotations that methods B and C estimate: yaw, or roll and pitch as well",
    },
    Choice {
        path: "calibration.prior",
        flag: "--prior",
        values: &["closed-form", "search"],
        meaning: "Initial value of method D and of the joint estimate",
    },
    Choice {
        path: "calibration.evidence.drive",
        flag: "--evidence",
        values: SWITCH,
        meaning: "Readings of the prisms during the drive",
    },
    Choice {
        path: "calibration.evidence.control_points",
        flag: "--evidence",
        values: SWITCH,
        meaning: "Readings of static points by all stations",
    },
    Choice {
        path: "calibration.evidence.rig",
        flag: "--evidence",
        values: SWITCH,
        meaning: "Measured inter-prism distances",
    },
    Choice {
        path: "calibration.errors.ranges_wander",
        flag: "–",
        values: SWITCH,
        meaning: "Errors of ranges and sights may vary over seconds to minutes",
    },
];

const HEAD: &str = "\
# Settings

A settings file (TOML) has the settings of the pipeline and the calibration. `--config` reads it: `calibrate`, `compare`, `trajectory`, `live` and all other commands that use these settings.
The tables of this page are generated from the source: `UPDATE_GOLDEN=1 cargo test --test structure settings_page`.

```sh
resect simulate --preset warthog --seed 1 --out warthog
cat > settings.toml <<'END'
[pipeline]
interpolation = \"wnoa\"

[pipeline.thresholds]
tau_s_seconds = 1.5      # longest gap inside an interval

[calibration]
inter_prism_sigma_m = 0.002  # prior σ: distances measured to 2 mm

[calibration.evidence]
control_points = false   # for a check: the estimate does not use them

[calibration.errors]
clock_offset_s = 0.05    # prior σ: clocks agree to about 50 ms
latency_s = 0.005        # prior σ: latencies of about 5 ms
END
resect calibrate warthog --config settings.toml
```

- A key that the file does not name has its default. A flag takes precedence over the file.
- An unknown key or a number beyond its limits is an error.
- In the window, drop the file. `settings` in the JSON of `calibrate` has the settings of a run under the same keys.
- The parameters of the [Python](python.md) module have the same names, without the tables; `evidence` is one text there.
- Files, units and corrections of one deployment are in its `deployment.toml` ([Files and formats](formats.md#deploymenttoml)).

## A prior σ is not a value
`latency_s`, `clock_offset_s`, `range_offset_m` and all other numbers of `[calibration.errors]` are prior standard deviations (1 σ), not values.
They state the expected size of an error before the drive. The expected error itself is zero, and the joint estimate determines its value from the readings.

`latency_s = 0.005` expects latencies of about 5 ms, early or late. It does not subtract 5 ms from any stamp. `inter_prism_sigma_m` is the
prior σ of the measured distances in the same way.

- A larger σ lets the readings decide, and widens σ of the answer if they do not.
- A σ that is too small biases the answer. If the readings contradict it, the verdict is *weak*.
- A σ of zero fixes the error at zero, or the distances at their measurements. The test for a contradiction remains.
- The defaults are the errors of sound instruments in the field ([Methods](methods.md#joint-estimate)).

Method D follows the paper: its σ of the distances is `inter_prism_sigma_m`, but at most 1 mm. The default of 3 mm is for the joint estimate.
";

/// Returns the paths of all settings of a JSON object: "pipeline.rate_hz".
fn paths(value: &Value, before: &str) -> Vec<String> {
    let Value::Object(entries) = value else { return vec![before.to_owned()] };
    let path = |key: &str| match before {
        "" => key.to_owned(),
        _ => format!("{before}.{key}"),
    };
    entries.iter().flat_map(|(key, value)| paths(value, &path(key))).collect()
}

fn defaults() -> Value {
    serde_json::to_value(Settings::default()).expect("JSON")
}

/// Splits a path into the table of the file and the key.
fn table_and_key(path: &str) -> (&str, &str) {
    path.rsplit_once('.').expect("a table")
}

/// Returns the stored unit by the suffix of the key; "–" for a ratio.
fn stored_unit(key: &str) -> &'static str {
    const UNITS: [(&str, &str); 7] = [
        ("_m_per_s", "m/s"),
        ("_deg_per_s", "°/s"),
        ("_hz", "Hz"),
        ("_seconds", "s"),
        ("_s", "s"),
        ("_m", "m"),
        ("_rad", "rad"),
    ];
    UNITS.iter().find(|(suffix, _)| key.ends_with(suffix)).map_or("–", |(_, unit)| unit)
}

/// Formats a number with three digits, as TOML accepts it.
fn in_toml(value: f64) -> String {
    let rounded: f64 = format!("{value:.2e}").parse().expect("a number");
    if rounded == 0.0 || rounded.abs() >= LEAST_PLAIN {
        format!("{rounded}")
    } else {
        format!("{rounded:e}")
    }
}

/// Returns the row of a number, of the table with this path.
fn number_row<S: Copy + Default>(number: &NumberSetting<S>, table: &str) -> String {
    let NumberSetting { key, meaning, most, .. } = number;
    let flag = number.flag.map_or_else(|| "–".to_owned(), |flag| format!("`--{flag}`"));
    let mut default = in_toml(number.value(&S::default()));
    let unit = stored_unit(key);
    if number.unit != unit && !number.unit.is_empty() {
        _ = write!(default, " ({} {})", in_toml(number.default_shown()), number.unit);
    }
    let mut limits = match number.least {
        Bound::Included(least) => format!("at least {least}"),
        Bound::Excluded(least) => format!("above {least}"),
        Bound::Unbounded => "–".to_owned(),
    };
    if most.is_finite() {
        _ = write!(limits, ", at most {most}");
    }
    let of = if table == "calibration.errors" { "Prior σ: " } else { "" };
    format!("| `{key}` | {flag} | {unit} | {default} | {limits} | {of}{meaning} |\n")
}

fn choice_row(choice: &Choice, defaults: &Value) -> String {
    let default = defaults.pointer(&format!("/{}", choice.path.replace('.', "/")));
    let default = match default.expect("a setting") {
        Value::Null => Method::default().name().to_owned(),
        Value::String(word) => word.clone(),
        other => other.to_string(),
    };
    let (_, key) = table_and_key(choice.path);
    let flag = if choice.flag == "–" { "–".to_owned() } else { format!("`{}`", choice.flag) };
    let values: Vec<String> = choice.values.iter().map(|value| format!("`{value}`")).collect();
    let (values, meaning) = (values.join(", "), choice.meaning);
    format!("| `{key}` | {flag} | – | `{default}` | {values} | {meaning} |\n")
}

/// Returns the path of a number from its key, which occurs once.
fn path_of(key: &str, all: &[String]) -> String {
    let mut with_key = all.iter().filter(|path| table_and_key(path).1 == key);
    let path = with_key.next().unwrap_or_else(|| panic!("no field is named {key}"));
    assert!(with_key.next().is_none(), "{key} occurs twice");
    path.clone()
}

/// Returns the path of each number.
fn number_paths() -> Vec<String> {
    let all = paths(&defaults(), "");
    let pipeline = PIPELINE_NUMBERS.iter().map(|number| number.key);
    let keys = pipeline.chain(CALIBRATION_NUMBERS.iter().map(|number| number.key));
    keys.map(|key| path_of(key, &all)).collect()
}

fn page() -> String {
    let (defaults, all) = (defaults(), paths(&defaults(), ""));
    let mut page = HEAD.to_owned();
    for (table, title, introduction) in TABLES {
        _ = write!(
            page,
            "\n## {title}\n{introduction}\n\n| key | flag | unit | default | limits | meaning |\n|---|---|---|---|---|---|\n"
        );
        let is_here = |path: &str| table_and_key(path).0 == table;
        for choice in CHOICES.iter().filter(|choice| is_here(choice.path)) {
            page += &choice_row(choice, &defaults);
        }
        for number in PIPELINE_NUMBERS.iter().filter(|it| is_here(&path_of(it.key, &all))) {
            page += &number_row(number, table);
        }
        for number in CALIBRATION_NUMBERS.iter().filter(|it| is_here(&path_of(it.key, &all))) {
            page += &number_row(number, table);
        }
    }
    page
}

#[test]
fn the_page_has_every_setting_as_the_types_do() {
    assert_written("docs/src/settings.md", &page());
}

/// Each field of the settings has a row in a table of the page, and each row a field.
#[test]
fn no_setting_lacks_a_row() {
    let fields: BTreeSet<String> = paths(&defaults(), "").into_iter().collect();
    let mut rows: BTreeSet<String> = number_paths().into_iter().collect();
    rows.extend(CHOICES.iter().map(|choice| choice.path.to_owned()));
    assert_eq!(fields, rows);
    for path in &rows {
        let (table, _) = table_and_key(path);
        assert!(TABLES.iter().any(|(known, ..)| *known == table), "no table for {path}");
    }
}

#[test]
fn every_choice_has_the_values_that_a_settings_file_accepts() {
    for Choice { path, values, .. } in &CHOICES {
        let (table, key) = table_and_key(path);
        let read = |value: &str| {
            let value = if *values == SWITCH { value.to_owned() } else { format!("{value:?}") };
            toml::from_str::<Settings>(&format!("[{table}]\n{key} = {value}\n"))
        };
        for value in *values {
            assert!(read(value).is_ok(), "{path} = {value}: {:?}", read(value).err());
        }
        if *values != SWITCH {
            // The message of a word that is not accepted lists those that are.
            let message = read("other").expect_err("no such value").to_string();
            let known = (message.matches('`').count() / 2).saturating_sub(1);
            assert_eq!(known, values.len(), "{path}: {message}");
        }
    }
}

#[test]
fn every_flag_of_the_page_is_one_of_the_program() {
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_resect"))
        .args(["calibrate", "--help"])
        .output()
        .expect("resect starts");
    let help = String::from_utf8(output.stdout).expect("UTF-8");
    let flags: BTreeSet<&str> = help.split_whitespace().filter(|it| it.starts_with("--")).collect();
    let numbers = PIPELINE_NUMBERS.iter().filter_map(|number| Some(format!("--{}", number.flag?)));
    let own = CHOICES.iter().map(|choice| choice.flag.to_owned()).filter(|flag| flag != "–");
    for flag in numbers.chain(own) {
        assert!(flags.contains(flag.as_str()), "{flag} is not a flag");
    }
}
