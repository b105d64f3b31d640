//! Commands run as processes: their output and exit codes.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::common::{field_data, knock, of_field, sample_folder, two_runs};
use resect_io::simulation_files::write_folder;
use resect_tools::simulation::Preset;
use serde_json::Value;

/// Runs resect without a display.
pub fn resect(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_resect"))
        .args(arguments)
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .output()
        .expect("resect starts")
}

fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8")
}

/// Standard output of a run that must succeed.
#[track_caller]
pub fn stdout(arguments: &[&str]) -> String {
    let output = resect(arguments);
    let complaint = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {complaint}");
    String::from_utf8(output.stdout).expect("UTF-8")
}

/// Returns the one line on standard error of a run that must fail with this code.
#[track_caller]
pub fn complaint(arguments: &[&str], code: i32) -> String {
    let output = resect(arguments);
    let line = String::from_utf8(output.stderr).expect("UTF-8");
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {line}");
    assert!(output.stdout.is_empty(), "nothing is printed beside an error");
    assert_eq!(line.trim_end().lines().count(), 1, "one line, not:\n{line}");
    line
}

fn json(arguments: &[&str]) -> Value {
    serde_json::from_str(&stdout(arguments)).expect("JSON")
}

#[test]
fn without_a_method_the_joint_estimate_answers_and_has_the_papers_beside_it() {
    let path = sample_folder("warthog");
    let timeless = |mut value: Value| {
        value["time_ms"] = Value::Null;
        value["settings"]["calibration"]["method"] = Value::Null;
        value
    };
    let joint = timeless(json(&["calibrate", text(&path), "--json"]));
    assert_eq!(joint["method"], "joint");
    for flags in [&["--robust"][..], &["--method", "joint"], &["--method", "joint", "--robust"]] {
        let named = json(&[&["calibrate", text(&path), "--json"], flags].concat());
        assert_eq!(timeless(named), joint, "{flags:?}");
    }
    let published =
        timeless(json(&["calibrate", text(&path), "--method", "inter-prism", "--json"]));
    assert_eq!(published["published"], Value::Null, "only a joint estimate has one beside it");
    let beside = &joint["published"];
    assert_eq!(beside["method"], "inter-prism");
    for key in ["transforms", "covariance"] {
        assert_eq!(beside[key], published[key], "{key}");
    }
    for key in ["verdict", "independently_checked", "findings"] {
        assert!(!beside[key].is_null(), "{key}");
    }
    assert_eq!(beside["verdict"], published["diagnosis"]["verdict"]);
    let number = |value: &Value| value.as_f64().expect("a number");
    for slot in 0..2 {
        let moved = &beside["moved"][slot];
        assert_eq!(moved["station"], slot + 2);
        let (now, before) = (&joint["transforms"][slot], &published["transforms"][slot]);
        let mut square = 0.0;
        for axis in 0..3 {
            let off = number(&now["translation_m"][axis]) - number(&before["translation_m"][axis]);
            assert!((number(&moved["translation_m"][axis]) - off).abs() < 1e-12);
            let sigma = |of: &Value| number(&of["sigma"]["translation_m"][axis]);
            let sigmas = off.abs() / sigma(now).hypot(sigma(before));
            assert!((number(&moved["translation_sigmas"][axis]) - sigmas).abs() < 1e-9);
            square += off * off;
        }
        assert!((number(&moved["distance_m"]) - square.sqrt()).abs() < 1e-12);
        let turned = number(&now["yaw_rad"]) - number(&before["yaw_rad"]);
        assert!((number(&moved["yaw_rad"]) - turned).abs() < 1e-12);
        let sigma = |of: &Value| number(&of["sigma"]["yaw_rad"]);
        let sigmas = turned.abs() / sigma(now).hypot(sigma(before));
        assert!((number(&moved["yaw_sigmas"]) - sigmas).abs() < 1e-9);
    }
    // The terminal's text has it as well.
    let said = stdout(&["calibrate", text(&path)]);
    assert!(said.contains(" · the joint estimate · verdict: "), "{said}");
    let millimetres = number(&beside["moved"][0]["distance_m"]) * 1e3;
    let line = format!("  T12 {millimetres:.2} mm (");
    assert!(said.contains("difference from the paper's D (method inter-prism, verdict "), "{said}");
    assert!(said.contains(&line), "{line} is not in {said}");
}

#[test]
fn the_result_begins_with_the_answer_to_use() {
    let path = sample_folder("warthog");
    let said = stdout(&["calibrate", text(&path)]);
    let place =
        |words: &str| said.find(words).unwrap_or_else(|| panic!("{words} is not in {said}"));
    let [conclusion, reason, next_step] = [
        "\nUse the joint estimate for this drive.\n",
        "\nσ of a station's position is at most ",
        "\nFor a smaller σ, reduce its largest source, ",
    ]
    .map(place);
    let in_order = conclusion < reason && reason < next_step && next_step < place("pipeline");
    assert!(in_order, "{said}");
    let value = json(&["calibrate", text(&path), "--json"]);
    let recommendation = &value["recommendation"];
    assert_eq!(
        (&recommendation["answer"], &recommendation["reason"]),
        (&"joint".into(), &"good".into())
    );
    let words = recommendation["text"].as_str().expect("text");
    assert!(
        words.starts_with("Use the joint estimate for this drive. σ of a station's"),
        "{words}"
    );
    let published = json(&["calibrate", text(&path), "--method", "D", "--json"]);
    assert_eq!(published["recommendation"]["answer"], "inter-prism");

    let folder = tempfile::tempdir().expect("a folder");
    stdout(&["simulate", "--preset", "straight-line", "--out", text(folder.path())]);
    let by_drive = ["calibrate", text(folder.path()), "--json", "--evidence", "drive,rig"];
    let value = json(&by_drive);
    let recommendation = &value["recommendation"];
    assert_eq!(
        (&recommendation["answer"], &recommendation["reason"]),
        (&Value::Null, &"degenerate".into())
    );
    let words = recommendation["text"].as_str().expect("text");
    assert!(words.contains(" of 8 directions are not determined: "), "{words}");
}

#[test]
fn one_prism_has_the_joint_estimate_by_default_and_the_papers_c_beside_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("single");
    stdout(&["simulate", "--preset", "single-prism", "--seed", "1", "--out", text(&path)]);
    let joint = json(&["calibrate", text(&path), "--json"]);
    let published = json(&["calibrate", text(&path), "--method", "dynamic-gcp", "--json"]);
    assert_eq!((&joint["method"], &published["method"]), (&"joint".into(), &"dynamic-gcp".into()));
    assert_eq!(joint["published"]["method"], "dynamic-gcp");
    assert_eq!(joint["published"]["transforms"], published["transforms"]);
}

#[test]
fn one_page_or_file_is_by_one_method() {
    let folder = tempfile::tempdir().expect("a folder");
    let (path, page) = (sample_folder("warthog"), folder.path().join("a.html"));
    let report = ["report", text(&path), "--out", text(&page)];
    let two = ["--method", "joint", "--method", "inter-prism"];
    let line = complaint(&[&report[..], &two].concat(), 2);
    assert!(line.contains("2 methods are given"), "{line}");
    let heading = |flags: &[&str]| {
        stdout(&[&report[..], flags].concat());
        std::fs::read_to_string(&page).expect("written")
    };
    let joint = heading(&[]);
    assert!(joint.contains("the joint estimate") && joint.contains("The paper's D"));
    let published = heading(&two[2..]);
    assert!(published.contains("method D, inter-prism distances"));
    assert!(!published.contains("The paper's D"));
    let both = json(&[&["calibrate", text(&path), "--json"], &two[..]].concat());
    let methods: Vec<&str> =
        both.as_array().expect("a list").iter().filter_map(|it| it["method"].as_str()).collect();
    assert_eq!(methods, ["joint", "inter-prism"]);
}

#[test]
fn the_json_keeps_its_contract() {
    let path = sample_folder("warthog");
    let value = json(&["calibrate", text(&path), "--method", "inter-prism", "--json"]);
    assert_eq!(value["schema"], 2);
    assert_eq!(value["deployment"], "warthog (simulated)");
    assert_eq!(value["method"], "inter-prism");
    assert_eq!(value["settings"]["pipeline"]["thresholds"]["tau_s_seconds"], 1.0);
    let observed = &value["diagnosis"]["observability"];
    assert_eq!(observed["drive"]["shape"], "winding");
    let directions = observed["directions"].as_array().expect("directions");
    assert_eq!(directions.len(), 8);
    assert!(directions.iter().all(|d| d["hold"] == "held" && d["sigma_m"].as_f64() > Some(0.0)));
    assert_eq!(directions[7]["relative_eigenvalue"], 1.0);
    assert_eq!(directions[0]["motion"][1]["station"], 3);
    // σ is the root of the covariance's diagonal, and the correlation of a quantity with itself is 1.
    let sigma_x = value["transforms"][1]["sigma"]["translation_m"][0].as_f64().expect("σ");
    let variance_x = value["covariance"][4][4].as_f64().expect("a variance");
    assert!((variance_x.sqrt() - sigma_x).abs() < 1e-12);
    assert_eq!(value["correlation"].as_array().map(Vec::len), Some(8));
    assert!((value["correlation"][4][4].as_f64().expect("a number") - 1.0).abs() < 1e-12);
    for key in ["raw", "kept"] {
        assert_eq!(value["pipeline"][key].as_array().map(Vec::len), Some(3));
    }
    assert!(value["pipeline"]["intervals"].as_u64() > Some(3));
    assert!(value["pipeline"]["triplets"].as_u64() > Some(1000));
    for (index, from) in [2, 3].into_iter().enumerate() {
        let transform = &value["transforms"][index];
        assert_eq!((&transform["from"], &transform["to"]), (&from.into(), &1.into()));
        let number = |value: &Value| value.as_f64().expect("a number");
        let yaw = number(&transform["yaw_rad"]);
        assert!((number(&transform["matrix"][0][0]) - yaw.cos()).abs() < 1e-12);
        assert!((number(&transform["matrix"][0][1]) + yaw.sin()).abs() < 1e-12);
        for axis in 0..3 {
            assert_eq!(transform["matrix"][axis][3], transform["translation_m"][axis]);
            assert!(number(&transform["sigma"]["translation_m"][axis]) > 0.0);
        }
        assert!(number(&transform["sigma"]["yaw_rad"]) > 0.0);
    }
    for key in ["median", "q25", "q75", "iqr", "n"] {
        assert!(value["metrics"]["inter_prism_mm"][key].is_number(), "{key}");
    }
    assert_eq!(value["metrics"]["gcp_mm"].as_array().map(Vec::len), Some(2));
    assert_eq!(value["metrics"]["gcp_mm"][0]["file"], "GCP_raw_1.txt");
    assert_eq!(value["diagnosis"]["verdict"], "good");
    assert_eq!(value["diagnosis"]["mirror"]["resolved_by"], "rig");
    assert!(value["diagnosis"]["mirror"]["cost_ratio"].as_f64() > Some(2.0));
    let basins = value["diagnosis"]["basins"].as_array().expect("method D lists its minima");
    assert_eq!(basins.iter().map(|b| &b["is"]).collect::<Vec<_>>(), ["answer", "mirror twin"]);
    assert_eq!(basins[1]["cost_ratio"], value["diagnosis"]["mirror"]["cost_ratio"]);
    assert_eq!(basins[0]["transforms"][0]["from"], 2);
    assert!(value["diagnosis"]["findings"].as_array().is_some_and(|f| !f.is_empty()));
    for key in ["load", "pipeline", "prior", "solve", "total"] {
        assert!(value["time_ms"][key].as_f64() >= Some(0.0), "{key}");
    }
}

#[test]
fn what_is_not_there_is_null_or_empty_and_never_zero() {
    let value = json(&["calibrate", text(&sample_folder("hd2-tunnel")), "--json"]);
    assert_eq!(value["metrics"]["gcp_mm"], Value::Array(vec![]));
    // A straight line leaves directions unconstrained, so there is no σ.
    let folder = tempfile::tempdir().expect("a folder");
    stdout(&["simulate", "--preset", "straight-line", "--out", text(folder.path())]);
    let value = json(&["calibrate", text(folder.path()), "--json", "--evidence", "drive,rig"]);
    assert_eq!(value["transforms"][0]["sigma"], Value::Null);
    assert_eq!(value["diagnosis"]["verdict"], "degenerate");
}

#[test]
fn flags_reach_the_answer() {
    let path = sample_folder("warthog");
    let triplets = |extra: &[&str]| {
        let mut arguments = vec!["calibrate", text(&path), "--json"];
        arguments.extend(extra);
        let value = json(&arguments);
        value["pipeline"]["triplets"].as_u64().expect("a count")
    };
    let default = triplets(&[]);
    assert!(triplets(&["--rate", "5"]) < default);
    assert!(triplets(&["--tau-l", "30"]) < default);
    assert!(triplets(&["--tau-a", "0.2"]) < default);
    assert!(triplets(&["--tau-s", "3"]) > default);
    assert!(triplets(&["--no-outlier-filter"]) > default);
    assert!(triplets(&["--no-interval-filter"]) > default);
    assert!(triplets(&["--tau-r", "0.5"]) < default);
    assert!(triplets(&["--tau-e", "0.05"]) < default);
    assert_eq!(triplets(&["--prior", "search", "--interpolation", "linear"]), default);
}

#[test]
fn a_config_file_is_the_settings_and_flags_overrule_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let config = folder.path().join("settings.toml");
    std::fs::write(
        &config,
        "[pipeline]\nrate_hz = 4.0\n[pipeline.thresholds]\ntau_l_seconds = 9.0\n",
    )
    .expect("writable");
    let path = sample_folder("warthog");
    let value =
        json(&["calibrate", text(&path), "--json", "--config", text(&config), "--tau-l", "7"]);
    assert_eq!(value["settings"]["pipeline"]["rate_hz"], 4.0);
    assert_eq!(value["settings"]["pipeline"]["thresholds"]["tau_l_seconds"], 7.0);
    std::fs::write(&config, "[pipeline]\nrat_hz = 4.0\n").expect("writable");
    let line = complaint(&["calibrate", text(&path), "--config", text(&config)], 2);
    assert!(line.contains("settings.toml:2: unknown field `rat_hz`"), "{line}");
}

#[test]
fn bad_usage_is_2_and_bad_input_is_1() {
    let path = sample_folder("warthog");
    for arguments in [
        &["calibrate"] as &[&str],
        &["calibrate", text(&path), "--tau-s", "zero"],
        &["calibrate", text(&path), "--tau-s", "-1"],
        &["calibrate", text(&path), "--tau-s", "0"],
        &["calibrate", text(&path), "--rate", "NaN"],
        &["calibrate", text(&path), "--method", "guesswork"],
        &["screenshot", "--out", "x.png", "--size", "10"],
        &["export", text(&path)],
        &["simulate", "--preset", "moon", "--out", "x"],
    ] {
        complaint(arguments, 2);
    }
    let line = complaint(&["calibrate", text(&path), "--evidence", "gnss"], 2);
    let remedy = "unknown evidence \"gnss\"; name some of drive, control-points, rig";
    assert!(line.contains(remedy), "{line}");
    let line = complaint(&["calibrate", "/nowhere/at/all"], 1);
    assert!(line.contains("/nowhere/at/all"), "{line}");
}

#[test]
fn broken_folders_end_in_one_line_with_the_place_and_a_remedy() {
    let folder = tempfile::tempdir().expect("a folder");
    let data = folder.path().join("inter_prism.csv");
    let good = std::fs::read_to_string(sample_folder("warthog").join("inter_prism.csv"))
        .expect("readable");
    let cases: [(&str, String, &str); 5] = [
        ("empty", String::new(), "no tracks of the stations"),
        ("words", good.replace("1760000", "later"), "inter_prism.csv:2: `later000"),
        (
            "a column of row numbers",
            good.replace("\n1760", "\n0,1760"),
            "inter_prism.csv:2: 6 fields",
        ),
        ("a column gone", good.replacen("va", "vb", 1), "its columns are unknown"),
        ("binary", "\u{1}\u{2}\u{fffd}".repeat(50), "no tracks of the stations"),
    ];
    for (name, content, expected) in cases {
        std::fs::write(&data, content).expect("writable");
        for command in ["calibrate", "check"] {
            let line = complaint(&[command, text(folder.path())], 1);
            assert!(line.contains(expected), "{name}: {line}");
            assert!(line.contains("; "), "{name}: no remedy in {line}");
        }
    }
    std::fs::write(&data, [0xff, 0xfe, 0x00, 0x41]).expect("writable");
    complaint(&["check", text(folder.path())], 1);
}

/// Rejects physically impossible numbers, without hanging.
#[test]
fn absurd_numbers_are_refused_or_left_out() {
    let folder = tempfile::tempdir().expect("a folder");
    let source = sample_folder("warthog");
    let good = std::fs::read_to_string(source.join("inter_prism.csv")).expect("readable");
    let data = folder.path().join("inter_prism.csv");
    let rig = folder.path().join("calibration_results.csv");
    let toml = folder.path().join("deployment.toml");
    let reset = || {
        std::fs::write(&data, &good).expect("writable");
        std::fs::copy(source.join("calibration_results.csv"), &rig).expect("copied");
        std::fs::write(&toml, "").expect("writable");
    };
    for constant in ["nan", "inf", "1e200", "-1000.0"] {
        reset();
        std::fs::write(&toml, format!("prism_constant_m = {constant}\n")).expect("writable");
        complaint(&["calibrate", text(folder.path())], 1);
    }
    for distances in ["1e300 1e300 1e300", "nan 1 1", "0 0 0", "1e-300 1e-300 1e-300"] {
        reset();
        std::fs::write(&rig, distances).expect("writable");
        complaint(&["calibrate", text(folder.path())], 1);
    }
    for (line, finding) in [
        ("1760000100.0,1,1e160,0.1,1.5", "range beyond 10 km"),
        ("1e300,1,50,0.1,1.5", "not a time stamp"),
        ("1760000100.0,-9e14,50,0.1,1.5", "other than 1, 2, 3"),
        ("1760000100.0,1,50,0.1,91", "zenith angle outside"),
    ] {
        reset();
        std::fs::write(&data, format!("{good}{line}\n")).expect("writable");
        let value = json(&["calibrate", text(folder.path()), "--json"]);
        let findings = value["diagnosis"]["findings"].to_string();
        assert!(findings.contains(finding), "{finding}: {findings}");
    }
    reset();
    std::fs::write(&data, format!("{good}1760000100.0,1.9,50,0.1,1.5\n")).expect("writable");
    let value = json(&["calibrate", text(folder.path()), "--json"]);
    let findings = value["diagnosis"]["findings"].to_string();
    assert!(
        findings.contains("rows-skipped") && findings.contains("not a whole number"),
        "{findings}"
    );
    reset();
    for flag in [["--tau-s", "1e308"], ["--rate", "999"]] {
        complaint(&["calibrate", text(folder.path()), flag[0], flag[1]], 2);
    }
}

#[test]
fn simulate_neither_mixes_deployments_nor_replaces_what_was_measured() {
    let folder = tempfile::tempdir().expect("a folder");
    stdout(&["simulate", "--preset", "warthog", "--out", text(folder.path())]);
    stdout(&["simulate", "--preset", "warthog", "--seed", "2", "--out", text(folder.path())]);
    let line = complaint(&["simulate", "--preset", "hd2-tunnel", "--out", text(folder.path())], 1);
    assert!(line.contains("choose an empty folder"), "{line}");

    let measured = tempfile::tempdir().expect("a folder");
    let recording = measured.path().join("inter_prism.csv");
    std::fs::write(&recording, "timestamp,id,distance,ha,va\n").expect("writable");
    let line = complaint(&["simulate", "--preset", "warthog", "--out", text(measured.path())], 1);
    assert!(line.contains("no truth.toml, so they may not be simulated"), "{line}");
    let kept = std::fs::read_to_string(&recording).expect("still there");
    assert_eq!(kept, "timestamp,id,distance,ha,va\n");
}

#[test]
fn a_missing_station_is_found_by_check_and_refused_by_calibrate() {
    let folder = tempfile::tempdir().expect("a folder");
    let source = sample_folder("warthog");
    for file in ["calibration_results.csv", "calibration_raw.csv"] {
        std::fs::copy(source.join(file), folder.path().join(file)).expect("copied");
    }
    let good = std::fs::read_to_string(source.join("inter_prism.csv")).expect("readable");
    let two: String =
        good.lines().filter(|l| !l.contains(",3,")).map(|l| l.to_owned() + "\n").collect();
    std::fs::write(folder.path().join("inter_prism.csv"), two).expect("writable");
    let report = stdout(&["check", text(folder.path())]);
    assert!(report.contains("station 3 has no measurement"), "{report}");
    let line = complaint(&["calibrate", text(folder.path())], 1);
    assert!(line.contains("station 3 has no measurement"), "{line}");
}

#[test]
fn spoiled_lines_are_left_out_and_counted() {
    let folder = tempfile::tempdir().expect("a folder");
    let source = sample_folder("warthog");
    std::fs::copy(source.join("calibration_results.csv"), folder.path().join("d.csv"))
        .expect("copied");
    let good = std::fs::read_to_string(source.join("inter_prism.csv")).expect("readable");
    let mut lines: Vec<String> = good.lines().map(str::to_owned).collect();
    let duplicate = lines[40].clone();
    lines.insert(41, duplicate);
    lines.swap(100, 160);
    lines[200] = "1760000100.0,1,NaN,0.1,1.5".to_owned();
    std::fs::write(folder.path().join("p.csv"), lines.join("\n")).expect("writable");
    let value = json(&["calibrate", text(folder.path()), "--json"]);
    let findings = value["diagnosis"]["findings"].to_string();
    for expected in ["duplicate stamps", "out-of-order stamps", "not a number"] {
        assert!(findings.contains(expected), "{expected}: {findings}");
    }
}

#[test]
fn simulate_writes_what_calibrate_opens() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("made/here");
    for preset in ["warthog", "hd2-tunnel"] {
        let out = out.join(preset);
        stdout(&["simulate", "--preset", preset, "--seed", "7", "--out", text(&out)]);
        assert!(out.join("truth.toml").is_file());
        let value = json(&["calibrate", text(&out), "--json"]);
        assert!(value["metrics"]["inter_prism_mm"]["median"].as_f64() < Some(3.0));
    }
}

#[test]
fn true_poses_of_a_simulation_are_judged_as_such() {
    let folder = tempfile::tempdir().expect("a folder");
    let [out, poses] = ["drive", "true.tum"].map(|name| folder.path().join(name));
    let simulate = ["simulate", "--preset", "warthog", "--seed", "7", "--out", text(&out)];
    let [inside, other] = [out.join("true.tum"), folder.path().join("true.foo")];
    let simulate_with = |file| [&simulate[..], &["--true-poses", file]].concat();
    stdout(&simulate_with(text(&poses)));
    let value = json(&["evaluate", text(&poses), "--against", text(&out), "--json"]);
    let judged = &value["estimates"][0];
    let of = |name: &str| judged[name].as_f64().expect("a number");
    let rmse_m = judged["ape_position_m"]["rmse"].as_f64().expect("a number");
    // A consistent error is about as large as its σ.
    let ratio = rmse_m / of("ground_truth_sigma_m");
    assert!((0.5..1.6).contains(&ratio), "{ratio}");
    // From prism 1 down to the ground between the axles, as the vehicle is built.
    let arm_m: Vec<f64> = (0..3).map(|i| judged["lever_arm_m"][i].as_f64().expect("m")).collect();
    let length_m = arm_m.iter().map(|part| part * part).sum::<f64>().sqrt();
    assert!((length_m - 0.45_f64.hypot(0.05).hypot(1.55)).abs() < 0.005, "{arm_m:?}");
    // Neither inside the drive, where it would be read as data, nor with an unknown extension.
    let line = complaint(&simulate_with(text(&inside)), 2);
    assert!(line.contains("outside its folder"), "{line}");
    let line = complaint(&simulate_with(text(&other)), 2);
    assert!(line.contains(".foo") && line.contains(".mcap"), "{line}");
    let line = complaint(&["trajectory", text(&out), "--out", text(&other)], 2);
    assert!(line.contains(".foo"), "{line}");
    assert!(!other.exists());
}

/// Offers a remedy that was not tried already.
#[test]
fn where_no_motion_fits_the_readings_the_way_leads_to_the_answer() {
    let folder = tempfile::tempdir().expect("a folder");
    let drive = folder.path().join("drive");
    stdout(&["simulate", "--preset", "warthog", "--duration", "120", "--out", text(&drive)]);
    let track = drive.join("inter_prism.csv");
    let in_feet = |line: &str| {
        let mut fields: Vec<String> = line.split(',').map(str::to_owned).collect();
        if fields[1] == "2" {
            let range_m: f64 = fields[2].parse().expect("a range");
            fields[2] = (range_m / 0.3048).to_string();
        }
        fields.join(",") + "\n"
    };
    let readings = std::fs::read_to_string(&track).expect("written");
    std::fs::write(&track, readings.lines().map(in_feet).collect::<String>()).expect("written");
    let line = complaint(&["trajectory", text(&drive), "--pose-rate", "10"], 1);
    assert!(line.contains("no motion") && line.contains("resect calibrate"), "{line}");
    assert!(!line.contains("--method joint"), "{line}");
}

#[test]
fn without_a_display_the_sample_is_calibrated_and_the_ways_on_are_named() {
    let output = stdout(&[]);
    for expected in ["built-in sample", "verdict: GOOD", "T12", "±", "resect screenshot", "ssh -X"]
    {
        assert!(output.contains(expected), "{expected} is not in:\n{output}");
    }
    let output = stdout(&[text(&sample_folder("hd2-tunnel"))]);
    assert!(output.contains("hd2-tunnel"), "{output}");
}

#[test]
fn control_points_and_rig_can_come_from_elsewhere() {
    let folder = tempfile::tempdir().expect("a folder");
    let source = sample_folder("warthog");
    std::fs::copy(source.join("inter_prism.csv"), folder.path().join("p.csv")).expect("copied");
    let tracks = folder.path().join("p.csv");
    let line = complaint(&["calibrate", text(&tracks)], 1);
    assert!(line.contains("--rig"), "{line}");
    let gcp = source.join("GCP_raw_2.txt");
    let value = json(&[
        "calibrate",
        text(&tracks),
        "--rig",
        text(&source),
        "--json",
        "--gcp",
        text(&gcp),
        "--evidence",
        "drive,rig",
    ]);
    assert_eq!(value["metrics"]["gcp_mm"].as_array().map(Vec::len), Some(1));
    let whole = json(&["calibrate", text(&source), "--json", "--evidence", "drive,rig"]);
    assert_eq!(value["transforms"], whole["transforms"]);
}

#[test]
fn exported_triplets_reproduce_the_metric() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = sample_folder("warthog");
    stdout(&["export", text(&path), "--csv", text(folder.path())]);
    let mut reader = csv::Reader::from_path(folder.path().join("residuals.csv")).expect("readable");
    let column = |name: &str, headers: &csv::StringRecord| {
        headers.iter().position(|h| h == name).unwrap_or_else(|| panic!("no column {name}"))
    };
    let headers = reader.headers().expect("a header").clone();
    let errors = ["error_12_mm", "error_13_mm", "error_23_mm"].map(|name| column(name, &headers));
    let mut sizes = Vec::new();
    for row in reader.records() {
        let row = row.expect("a row");
        sizes.extend(errors.map(|at| row[at].parse::<f64>().expect("a number").abs()));
    }
    sizes.sort_by(f64::total_cmp);
    let value = json(&["calibrate", text(&path), "--json"]);
    let metric = &value["metrics"]["inter_prism_mm"];
    assert_eq!(metric["n"].as_u64(), Some(sizes.len() as u64));
    let middle = sizes[sizes.len() / 2];
    assert!((metric["median"].as_f64().expect("a number") - middle).abs() < 0.01);
}

#[test]
fn every_table_of_an_export_agrees_with_the_answer() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = sample_folder("warthog");
    stdout(&["export", text(&path), "--csv", text(folder.path())]);
    let value = json(&["calibrate", text(&path), "--json"]);
    let rows = |name: &str| -> Vec<std::collections::HashMap<String, String>> {
        let mut reader = csv::Reader::from_path(folder.path().join(name)).expect("readable");
        reader.deserialize().map(|row| row.expect("a row")).collect()
    };
    let readings = rows("readings.csv");
    for station in 0..3 {
        let own = || readings.iter().filter(|row| row["station"] == (station + 1).to_string());
        assert_eq!(Some(own().count() as u64), value["pipeline"]["raw"][station].as_u64());
        let kept = own().filter(|row| row["fate"] == "kept").count();
        assert_eq!(Some(kept as u64), value["pipeline"]["kept"][station].as_u64());
    }
    let number = |text: &str| text.parse::<f64>().expect("a number");
    for (row, transform) in
        rows("transforms.csv").iter().zip(value["transforms"].as_array().expect("two"))
    {
        for (place, name) in ["x_m", "y_m", "z_m"].iter().enumerate() {
            let told = transform["translation_m"][place].as_f64().expect("a number");
            assert!((number(&row[*name]) - told).abs() < 1e-9);
        }
        assert!(number(&row["sigma_yaw_rad"]) > 0.0);
    }
    let clocks = rows("clocks.csv");
    assert_eq!(clocks.iter().map(|row| row["station"].as_str()).collect::<Vec<_>>(), ["2", "3"]);
    assert!(clocks.iter().all(|row| number(&row["sigma_offset_s"]) > 0.0));
    assert_eq!(rows("residuals.csv").len(), rows("triplets.csv").len());
    // Compares the rows of the JSON, number by number.
    let answer = rows("answer.csv");
    let described = value["rows"].as_array().expect("rows");
    assert_eq!(answer.len(), described.len());
    for (row, told) in answer.iter().zip(described) {
        for key in ["group", "subject", "name", "symbol", "unit"] {
            assert_eq!(told[key], row[key].as_str());
        }
        // The JSON parser may round the last bit.
        for key in ["value", "sigma"] {
            let both = [told[key].as_f64(), row[key].parse().ok()];
            let [Some(told), Some(written)] = both else {
                assert_eq!(both, [None, None], "{row:?}");
                continue;
            };
            assert!((told - written).abs() <= 1e-15 * written.abs(), "{told} {written}");
        }
    }
    for name in ["x", "clock offset", "range offset", "collimation", "distance", "median"] {
        assert!(answer.iter().any(|row| row["name"] == name), "{name}");
    }
}

#[cfg(feature = "rerun")]
#[test]
fn a_recording_holds_tracks_fates_stations_and_residuals() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("sample.rrd");
    stdout(&["export", text(&sample_folder("warthog")), "--rrd", text(&file)]);
    let bytes = std::fs::read(&file).expect("readable");
    assert!(bytes.starts_with(b"RRF2"), "not a recording");
    assert!(bytes.len() > 100_000, "{} bytes", bytes.len());
    let nowhere =
        complaint(&["export", text(&sample_folder("warthog")), "--rrd", "/nowhere/at/all.rrd"], 1);
    assert!(nowhere.contains("/nowhere/at/all.rrd"), "{nowhere}");
}

/// Compares a recording, as rerun-sdk reads it, with the JSON and CSV of the same calibration.
#[cfg(feature = "rerun")]
#[test]
#[ignore = "needs the PyPI package rerun-sdk: tests/run --peers"]
fn a_recording_is_read_by_its_peer_rerun_sdk() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("sample.rrd");
    let path = sample();
    stdout(&["export", &path, "--rrd", text(&file)]);
    stdout(&["export", &path, "--csv", text(folder.path())]);
    let calibration = json(&["calibrate", &path, "--json"]);
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/peers/read_recording.py");
    let output = Command::new("python").arg(script).arg(&file).output();
    let output = output.expect("tests/run --peers has it on the path");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let recording: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let entity = |path: &str| recording.get(path).unwrap_or_else(|| panic!("no entity {path}"));
    let number = |value: &Value| value.as_f64().expect("a number");
    let length = |value: &Value| value.as_array().expect("a list").len();

    let fates = recording.as_object().expect("entities").iter();
    for slot in 0..3 {
        let station = slot + 1;
        let raw = format!("/world/station_{station}/raw/");
        let readings = fates.clone().filter(|(path, _)| path.starts_with(&raw));
        let readings: usize = readings.map(|(_, fate)| length(&fate["positions"])).sum();
        let kept = length(&entity(&format!("{raw}kept"))["positions"]);
        assert_eq!(calibration["pipeline"]["raw"][slot], readings);
        assert_eq!(calibration["pipeline"]["kept"][slot], kept);
        let prism = entity(&format!("/world/station_{station}/prism"));
        assert_eq!(prism["rows"], calibration["pipeline"]["triplets"]);
        let rates = entity(&format!("/rates/azimuth_deg_per_s/station_{station}"));
        assert_eq!(rates["rows"], readings - 1);
    }
    for transform in calibration["transforms"].as_array().expect("two transforms") {
        let position_m = &entity(&format!("/world/station_{}", transform["from"]))["positions"][0];
        for axis in 0..3 {
            let (peer, own) = (&position_m[axis], &transform["translation_m"][axis]);
            assert!((number(peer) - number(own)).abs() < 1e-6, "{peer} {own}");
        }
    }
    let residuals = std::fs::read_to_string(folder.path().join("residuals.csv")).expect("there");
    let errors = entity("/distance_error_mm/23");
    assert_eq!(errors["rows"], residuals.lines().count() - 1);
    for (row, line) in residuals.lines().skip(1).enumerate() {
        let fields: Vec<f64> = line.split(',').map(|field| field.parse().expect(line)).collect();
        // The CSV has microseconds.
        assert!((number(&errors["times"][row]) * 1e-9 - fields[0]).abs() < 1e-6, "{line}");
        assert!((number(&errors["scalars"][row]) - fields[4]).abs() < 1e-9, "{line}");
    }
    for path in ["/verdict", "/viewport", "/world/pillars/Two_points_txt/station_3"] {
        entity(path);
    }
}

/// Compares the estimate by control points alone with a least-squares adjustment of the same readings by scipy.
#[test]
#[ignore = "needs the PyPI package scipy: tests/run --peers"]
fn control_points_are_adjusted_as_by_the_peer_scipy() {
    const TOLERANCE_M: f64 = 1e-5;
    // Distance at which a rotation displaces the points (m).
    const REACH_M: f64 = 50.0;
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/peers/adjust_control_points.py");
    let real = ["real/20221129-1", "real/20221205-1", "2022-07-11-2"];
    let real = real.iter().filter_map(|name| field_data(name));
    // The peer knows the usual refraction only.
    let other = tempfile::tempdir().expect("a folder");
    let settings = other.path().join("settings.toml");
    std::fs::write(&settings, "[calibration.errors]\nrefraction = 0.0\n").expect("written");
    for folder in std::iter::once(sample_folder("warthog")).chain(real) {
        let path = text(&folder);
        let output = Command::new("python").args([script, path]).output();
        let output = output.expect("tests/run --peers has it on the path");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let peer: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        let with_settings = ["--config", text(&settings), "--evidence", "control-points"];
        let own = json(&[&["calibrate", path, "--json"][..], &with_settings].concat());
        for slot in 0..2 {
            let [peer, own] = [&peer, &own].map(|answer| &answer["transforms"][slot]);
            let number = |value: &Value| value.as_f64().expect("a number");
            for axis in 0..3 {
                let [a, b] = [peer, own].map(|from| number(&from["translation_m"][axis]));
                assert!((a - b).abs() < TOLERANCE_M, "{path}, station {}: {a} {b}", slot + 2);
            }
            let [a, b] = [peer, own].map(|from| number(&from["yaw_rad"]));
            let turned_rad = (a - b).sin().abs();
            assert!(turned_rad * REACH_M < TOLERANCE_M, "{path}, station {}: {a} {b}", slot + 2);
        }
    }
}

#[test]
fn screenshot_writes_a_picture_of_the_wanted_size() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("window.png");
    stdout(&["screenshot", "--out", text(&file), "--size", "900x600", "--theme", "light"]);
    let picture = image::open(&file).expect("a picture").to_rgb8();
    assert_eq!(picture.dimensions(), (900, 600));
    let colours: std::collections::HashSet<_> = picture.pixels().copied().collect();
    assert!(colours.len() > 200, "only {} colours", colours.len());
}

#[test]
#[cfg_attr(not(field_data), ignore = "needs ../shared/datasets")]
fn the_field_data_by_the_command_line() {
    let path = of_field("2022-07-11-2");
    let value = json(&["calibrate", text(&path), "--method", "inter-prism", "--json"]);
    assert_eq!(value["deployment"], "2022-07-11-2");
    assert_eq!(value["pipeline"]["triplets"], 2032);
    assert_eq!(value["pipeline"]["raw"], serde_json::json!([1040, 1041, 1041]));
    assert!(value["diagnosis"]["findings"].to_string().contains("mirror"));
    let report = stdout(&["check", text(&path)]);
    for expected in ["inter_prism.csv", "1041 readings", "4 pillars", "0.7282 m"] {
        assert!(report.contains(expected), "{expected} is not in:\n{report}");
    }
}

fn sample() -> String {
    text(&sample_folder("warthog")).to_owned()
}

#[test]
fn several_methods_give_a_list_in_the_order_asked_for() {
    let mut arguments = vec!["calibrate"];
    let path = sample();
    arguments.push(&path);
    let asked = ["static-gcp", "inter-prism", "two-point"];
    arguments.extend(asked.iter().flat_map(|method| ["--method", method]));
    arguments.push("--json");
    let list = json(&arguments);
    let methods: Vec<&str> =
        list.as_array().expect("a list").iter().filter_map(|o| o["method"].as_str()).collect();
    assert_eq!(methods, asked);
    assert!(list[0]["diagnosis"]["mirror"].is_null(), "absent is null");
    assert!(list[1]["diagnosis"]["mirror"]["cost_ratio"].is_number());
    assert_eq!(list[2]["details"]["pairs"].as_array().map(Vec::len), Some(6));
}

#[test]
fn a_method_that_the_data_lacks_is_bad_input() {
    let line = complaint(&["calibrate", &sample(), "--method", "dynamic-gcp"], 1);
    assert!(line.contains("method C (dynamic-gcp) needs one prism"), "{line}");
}

#[test]
fn the_studies_print_tables_and_write_pictures() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("made/for/this");
    let sweep = ["sweep", "--parameter", "tau-s", "--from", "0.5", "--to", "3", "--steps", "4"];
    for (arguments, name) in
        [(&["compare"][..], "comparison"), (&["ablate"], "ablation"), (&sweep, "sweep-tau-s")]
    {
        let path = sample();
        let mut all = arguments.to_vec();
        all.extend([path.as_str(), "--out", text(&out)]);
        let table = stdout(&all);
        assert!(table.contains("median") && table.contains("warthog"), "{table}");
        for extension in ["csv", "svg", "png"] {
            let file = out.join(format!("{name}.{extension}"));
            assert!(file.metadata().expect("written").len() > 200, "{name}.{extension}");
        }
        all.push("--json");
        let object = json(&all);
        assert_eq!((&object["schema"], &object["study"]), (&2.into(), &name.into()));
    }
}

#[test]
fn nonsense_for_a_study_is_bad_usage() {
    for more in [
        &["--parameter", "tau-s", "--from", "0", "--to", "3"][..],
        &["--parameter", "tau-s", "--from", "1", "--to", "3", "--steps", "1"],
        &["--parameter", "tau-x", "--from", "1", "--to", "3"],
        &["--parameter", "tau-r", "--from", "1", "--to", "3", "--no-outlier-filter"],
        &["--parameter", "tau-s", "--from", "1", "--to", "3", "--splits", "0"],
    ] {
        let path = sample();
        let mut all = vec!["sweep", path.as_str()];
        all.extend(more);
        complaint(&all, 2);
    }
}

/// A calibration as JSON in a file, and the folder of another run of its set-up in which station 2 was turned.
fn calibration_and_a_run(folder: &Path) -> (PathBuf, PathBuf) {
    let knock = knock(1, 1e-3, [0.0; 3]);
    let [first, second] = ["first", "second"].map(|name| folder.join(name));
    let runs = two_runs(Preset::Warthog.scenario(), 3, &[knock]);
    for (run, path) in runs.iter().zip([&first, &second]) {
        write_folder(run, path).expect("writable");
    }
    let file = folder.join("first.json");
    let calibration = stdout(&["calibrate", text(&first), "--json"]);
    std::fs::write(&file, calibration).expect("writable");
    (file, second)
}

#[test]
fn validate_tells_what_holds_and_which_station_moved() {
    let folder = tempfile::tempdir().expect("a folder");
    let (file, second) = calibration_and_a_run(folder.path());
    let first = folder.path().join("first");
    // A validation succeeds with every verdict.
    let found = json(&["validate", text(&file), text(&first), text(&second), "--json"]);
    assert_eq!(found[0]["verdict"], "holds", "{:#}", found[0]);
    assert_eq!(found[1]["verdict"], "does-not-hold", "{:#}", found[1]);
    assert_eq!(found[1]["cause"], serde_json::json!({ "is": "station", "stations": [2] }));
    let turned = &found[1]["stations"][1];
    let number = |value: &Value| value.as_f64().expect("a number");
    let off = (number(&turned["turned_rad"]) - 1e-3) / number(&turned["sigma"]["turned_rad"]);
    assert!(off.abs() < 3.0, "{off} σ");
    let metrics = &found[1]["metrics"]["inter_prism_mm"];
    assert!(number(&metrics["earlier"]["median"]) > 2.0 * number(&metrics["own"]["median"]));
    // A single run is one object, and the text agrees.
    let one = json(&["validate", text(&file), text(&second), "--json"]);
    assert_eq!(found[1]["deployment"], "warthog (simulated), second", "told apart from the first");
    let mut named_alone = found[1].clone();
    named_alone["deployment"] = "warthog (simulated)".into();
    assert_eq!(one, named_alone);
    let said = stdout(&["validate", text(&file), text(&second)]);
    assert!(said.contains("DOES NOT HOLD") && said.contains("station 2 turned by"), "{said}");
    assert!(said.contains(one["why"].as_str().expect("a reason")), "{said}");
}

#[test]
fn validate_reads_calibrations_by_every_method() {
    let folder = tempfile::tempdir().expect("a folder");
    let (path, file) = (sample_folder("warthog"), folder.path().join("a.json"));
    for method in ["two-point", "static-gcp", "inter-prism", "joint"] {
        let calibration = stdout(&["calibrate", text(&path), "--method", method, "--json"]);
        std::fs::write(&file, calibration).expect("writable");
        let found = json(&["validate", text(&file), text(&path), "--json"]);
        assert_eq!(found["verdict"], "holds", "{method}: {found:#}");
    }
}

#[test]
fn a_word_is_explained_and_all_are_listed() {
    let text = stdout(&["explain", "tau-s"]);
    assert!(text.starts_with("τ_s\n") && text.contains("longest gap inside an interval"), "{text}");
    assert!(text.contains("Vaidis et al. 2022, "), "{text}");
    let heads =
        |text: &str| text.lines().filter(|line| !line.starts_with(' ') && !line.is_empty()).count();
    assert_eq!(heads(&text), 1, "{text}");
    let all = stdout(&["explain"]);
    assert_eq!(heads(&all), resect_report::glossary::ALL.len());
    assert!(all.lines().all(|line| line.chars().count() <= 96), "{all}");
    let line = complaint(&["explain", "no", "such", "word"], 2);
    assert!(line.contains("\"no such word\"") && line.contains("resect explain"), "{line}");
}

#[test]
fn validate_without_a_calibration_is_one_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let (path, file) = (sample_folder("warthog"), folder.path().join("a.json"));
    let line = complaint(&["validate", text(&path), text(&path)], 1);
    assert!(line.contains("give the file of `resect calibrate FOLDER --json` first"), "{line}");
    let line = complaint(&["validate", text(&file), text(&path)], 1);
    assert!(line.contains("a.json"), "{line}");
    std::fs::write(&file, "{").expect("writable");
    let line = complaint(&["validate", text(&file), text(&path)], 1);
    assert!(line.contains("a.json: not the JSON of a calibration"), "{line}");
    complaint(&["validate", text(&file)], 2);
    let methods = ["--method", "joint", "--method", "inter-prism"];
    complaint(&[&["validate", text(&file), text(&path)], &methods[..]].concat(), 2);
}

#[test]
fn nothing_is_written_over_what_was_read() {
    let folder = tempfile::tempdir().expect("a folder");
    for file in ["inter_prism.csv", "calibration_results.csv", "calibration_raw.csv"] {
        let from = sample_folder("hd2-tunnel").join(file);
        std::fs::copy(from, folder.path().join(file)).expect("copied");
    }
    let recording = folder.path().join("inter_prism.csv");
    let before = std::fs::read(&recording).expect("readable");
    for command in ["report", "trajectory"] {
        let line = complaint(&[command, text(folder.path()), "--out", text(&recording)], 1);
        assert!(line.contains("not overwritten; choose another file"), "{line}");
        assert_eq!(std::fs::read(&recording).expect("there"), before, "{command}");
    }
    // An existing page is replaced.
    let page = folder.path().join("page.html");
    for _ in 0..2 {
        stdout(&["report", text(folder.path()), "--out", text(&page)]);
    }
}

#[test]
fn deployments_that_are_called_the_same_are_told_apart() {
    let folder = tempfile::tempdir().expect("a folder");
    for run in ["run1/data", "run2/data"] {
        let path = folder.path().join(run);
        std::fs::create_dir_all(&path).expect("made");
        std::fs::copy(sample_folder("hd2-tunnel").join("inter_prism.csv"), path.join("tracks.csv"))
            .expect("copied");
        let rig = "calibration_results.csv";
        std::fs::copy(sample_folder("hd2-tunnel").join(rig), path.join(rig)).expect("copied");
    }
    let place = |run: &str| folder.path().join(run).join("data").to_string_lossy().into_owned();
    let (first, second) = (place("run1"), place("run2"));
    let compared = stdout(&["compare", &first, &second]);
    assert!(compared.contains("run1/data") && compared.contains("run2/data"), "{compared}");
    let page = folder.path().join("report.html").to_string_lossy().into_owned();
    stdout(&["report", &first, &second, "--out", &page]);
    let page = std::fs::read_to_string(page).expect("written");
    assert!(page.contains("run1/data") && page.contains("run2/data"));
}

#[cfg(target_os = "linux")]
#[test]
fn the_desktop_gets_an_entry_with_icon_and_file_type_and_loses_them_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let desktop = |arguments: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_resect"))
            .arg("desktop")
            .args(arguments)
            .env("XDG_DATA_HOME", folder.path())
            .output()
            .expect("resect starts");
        assert_eq!(output.status.code(), Some(0), "{output:?}");
    };
    let files = [
        "applications/resect.desktop",
        "icons/hicolor/256x256/apps/resect.png",
        "mime/packages/resect.xml",
    ];
    desktop(&[]);
    desktop(&[]);
    let entry = std::fs::read_to_string(folder.path().join(files[0])).expect("written");
    let program = env!("CARGO_BIN_EXE_resect");
    assert!(entry.contains(&format!("Exec=\"{program}\" %F\n")), "{entry}");
    assert!(files.iter().all(|file| folder.path().join(file).is_file()));
    desktop(&["--remove"]);
    desktop(&["--remove"]);
    assert!(!files.iter().any(|file| folder.path().join(file).exists()));
}

#[test]
fn a_session_without_a_display_is_calibrated_in_the_terminal() {
    let folder = tempfile::tempdir().expect("a folder");
    let session = folder.path().join("two.resect.toml");
    let of = |name: &str, tau_s: f64| {
        let path = sample_folder(name);
        let thresholds = "deployment.settings.pipeline.thresholds";
        format!("[[deployment]]\npath = {path:?}\n[{thresholds}]\ntau_s_seconds = {tau_s}\n")
    };
    let both = of("warthog", 1.0) + &of("hd2-tunnel", 2.0);
    std::fs::write(&session, format!("resect_session = 1\n{both}")).expect("writable");
    let said = stdout(&[text(&session)]);
    assert!(said.contains("no display") && !said.contains("built-in sample"), "{said}");
    assert!(said.contains("warthog (simulated)") && said.contains("hd2-tunnel"), "{said}");
    // The session's settings apply, not the default ones.
    let (path, tau) = (sample_folder("hd2-tunnel"), ["--tau-s", "2"]);
    let own = stdout(&[&["calibrate", text(&path)][..], &tau].concat());
    let pipeline = own.lines().find(|line| line.starts_with("pipeline")).expect("a line");
    assert!(said.contains(pipeline), "{pipeline} is not in {said}");
    let line = complaint(&["calibrate", text(&session)], 1);
    assert!(line.contains("a session: open it with `resect FILE`"), "{line}");
    std::fs::write(&session, "resect_session = 1\n").expect("writable");
    let line = complaint(&[text(&session)], 1);
    assert!(line.contains("without deployments") && line.contains("a display"), "{line}");
}

#[test]
fn a_newline_in_a_name_makes_no_second_line() {
    let path = sample();
    let line = complaint(&["trajectory", &path, "--out", "no\nsuch/\u{1b}[31mx.tum"], 1);
    assert!(line.contains("folder no\\nsuch does not exist; create it"), "{line}");
}

#[cfg(unix)]
#[test]
fn a_link_back_to_its_own_folder_is_not_followed() {
    let folder = tempfile::tempdir().expect("a folder");
    for file in ["inter_prism.csv", "calibration_results.csv"] {
        let from = sample_folder("hd2-tunnel").join(file);
        std::fs::copy(from, folder.path().join(file)).expect("copied");
    }
    std::os::unix::fs::symlink(".", folder.path().join("again")).expect("linked");
    let said = stdout(&["check", text(folder.path())]);
    assert!(!said.contains("again"), "{said}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_one_line_with_a_remedy() {
    let path = sample();
    for arguments in [
        &["trajectory", &path, "--out"][..],
        &["report", &path, "--out"],
        #[cfg(feature = "rerun")]
        &["export", &path, "--rrd"],
    ] {
        let line = complaint(&[arguments, &["/dev/full"]].concat(), 1);
        assert!(
            line.contains("/dev/full: cannot be written") && line.contains("free space"),
            "{line}"
        );
    }
    let folder = tempfile::tempdir().expect("a folder");
    let table = folder.path().join("readings.csv");
    std::os::unix::fs::symlink("/dev/full", table).expect("linked");
    let line = complaint(&["export", &path, "--csv", text(folder.path())], 1);
    assert!(
        line.contains("readings.csv: cannot be written") && line.contains("free space"),
        "{line}"
    );
}

#[test]
fn plan_says_what_a_drive_will_leave_open_and_what_improves_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("line.toml");
    let printed =
        stdout(&["plan", "--preset", "straight-line", "--seed", "2", "--out", text(&file)]);
    for part in [
        "verdict: DEGENERATE",
        "unobservable with this drive",
        "largest improvements at the far end",
        "not determined → ",
    ] {
        assert!(printed.contains(part), "{part} is not in\n{printed}");
    }
    // The written file is the plan: the command gives the same result from it.
    assert_eq!(stdout(&["plan", text(&file)]), printed);
    let way = folder.path().join("way.csv");
    std::fs::write(&way, "x,y,speed\n40,0,0.6\n60,0,0.6\n60,20,0.6\n45,12,0.6\n60,-5,0.6\n")
        .expect("writable");
    let value = json(&["plan", text(&file), "--way", text(&way), "--target", "3", "--json"]);
    assert_eq!(value["schema"], 2);
    assert_eq!(value["plan"]["target_mm"], 3.0);
    assert_eq!(value["plan"]["way"][0]["waypoints"][1][2], 0.6);
    let far_m = value["held"]["far_end"]["sigma_m"].as_f64().expect("held");
    assert!((0.001..0.1).contains(&far_m), "{far_m}");
    assert_eq!(value["held"]["covariance"].as_array().map(Vec::len), Some(8));
    assert_eq!(value["observability"]["directions"].as_array().map(Vec::len), Some(8));
    let best = &value["improvements"][0];
    assert!(best["after_m"].as_f64() < Some(far_m) && best["plan"]["way"].is_array(), "{best}");
}

#[test]
fn a_past_deployment_is_a_plan() {
    let path = sample_folder("warthog");
    let value = json(&["plan", text(&path), "--json"]);
    let calibrated = json(&["calibrate", text(&path), "--json"]);
    // A plan has no control points.
    let by_drive = json(&["calibrate", text(&path), "--json", "--evidence", "drive,rig"]);
    for slot in 0..2 {
        let (station, transform) =
            (&value["plan"]["stations_m"][slot + 1], &calibrated["transforms"][slot]);
        for axis in 0..3 {
            let [planned_m, found_m] = [station, &transform["translation_m"]]
                .map(|place_m| place_m[axis].as_f64().expect("a number"));
            let is_there = (planned_m - found_m).abs() < 0.501e-3;
            assert!(is_there, "to the millimetre: {planned_m}, {found_m}");
            let is_round = ((1e3 * planned_m).round() - 1e3 * planned_m).abs() < 1e-9;
            assert!(is_round, "a plan has no more digits: {planned_m}");
        }
        // The predicted σ agrees with the σ that the estimate states.
        for axis in 0..3 {
            let foreseen = value["held"]["sigma"][slot]["translation_m"][axis].as_f64();
            let stated = by_drive["transforms"][slot]["sigma"]["translation_m"][axis].as_f64();
            let ratio = foreseen.expect("held") / stated.expect("held");
            // The drive has learned smaller noise than a plan expects: slow errors over 200 s instead of 12 s.
            assert!((0.7..1.5).contains(&ratio), "T1{} axis {axis}: {ratio:.2}", slot + 2);
        }
    }
}

#[test]
fn a_plan_that_cannot_be_read_is_one_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("plan.toml");
    std::fs::write(&file, "stations_m = [[0, 0, 0], [5, 0, 0], [0, 5, 0]]\nway = []\nrate = 2\n")
        .expect("writable");
    let line = complaint(&["plan", text(&file)], 1);
    assert!(line.contains("plan.toml:3: unknown field `rate`"), "{line}");
    complaint(&["plan"], 2);
    complaint(&["plan", "--preset", "warthog", "--target", "-1"], 2);
    complaint(&["plan", text(&file), "--preset", "warthog"], 2);
    std::fs::write(&file, "stations_m = [[0, 0, 0], [5, 0, 0], [0, 5, 0]]\nway = []\n")
        .expect("writable");
    let line = complaint(&["plan", text(&file)], 1);
    assert!(line.contains("the way is 0.0 m long; give waypoints"), "{line}");
    let line = complaint(&["plan", "--preset", "warthog", "--way", text(&file)], 1);
    assert!(line.contains("has no x and y"), "{line}");
}
