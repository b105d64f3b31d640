//! `resect live` as a script uses it.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Output, Stdio};

use serde_json::Value;

use super::server::{Server, Step};
use crate::common::sample_folder;

fn resect() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_resect"));
    command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").env("SOURCE_DATE_EPOCH", "0");
    command
}

fn run(arguments: &[&str]) -> Output {
    resect().args(arguments).output().expect("resect starts")
}

fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8")
}

fn objects(output: &[u8]) -> Vec<Value> {
    let lines = std::str::from_utf8(output).expect("UTF-8").lines();
    lines.map(|line| serde_json::from_str(line).expect("a line is an object")).collect()
}

#[test]
fn a_replay_prints_a_line_a_second_and_in_the_end_what_calibrate_prints_of_its_recording() {
    let folder = tempfile::tempdir().expect("a folder");
    let (sample, file) = (sample_folder("hd2-tunnel"), folder.path().join("r.mcap"));
    let output = run(&[
        "live",
        "--replay",
        text(&sample),
        "--speed",
        "60",
        "--json",
        "--answer",
        "--record",
        text(&file),
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let lines = objects(&output.stdout);
    assert!(lines.len() >= 3, "{}", lines.len());
    let (answer, lines) = lines.split_last().expect("lines");
    for line in lines {
        assert_eq!(line["schema"], 2);
        assert_eq!(line["stations"].as_array().expect("a list").len(), 3);
        assert!(line["enough"].is_boolean() && line["advice"].is_string(), "{line}");
    }
    let last = &lines[lines.len() - 1];
    assert_eq!(last["link"], "ended");
    // The last line covers all readings, too.
    let all_mm = &answer["answer"]["metrics"]["inter_prism_mm"]["median"];
    assert_eq!((&last["answer_age_s"], &last["inter_prism_mm"]), (&serde_json::json!(0.0), all_mm));
    assert!(lines.iter().any(|line| line["far_end_mm"].is_number()), "an answer on the way");
    let offline = run(&["calibrate", text(&file), "--rig", text(&sample), "--json"]);
    let offline: Value = serde_json::from_slice(&offline.stdout).expect("JSON");
    for part in ["transforms", "covariance", "metrics", "pipeline"] {
        assert_eq!(answer["answer"][part], offline[part], "{part}");
    }
    assert_eq!(answer["answer"]["diagnosis"]["verdict"], offline["diagnosis"]["verdict"]);
}

#[cfg(unix)]
#[test]
fn a_signal_ends_it_with_its_recording() {
    let folder = tempfile::tempdir().expect("a folder");
    let (sample, file) = (sample_folder("hd2-tunnel"), folder.path().join("r.mcap"));
    let mut child = resect()
        .args(["live", "--replay", text(&sample), "--speed", "5", "--record", text(&file)])
        .stdout(Stdio::piped())
        .spawn()
        .expect("resect starts");
    let mut lines = BufReader::new(child.stdout.take().expect("piped")).lines();
    // The replay has started.
    lines.next().expect("a line").expect("text");
    lines.next().expect("a line").expect("text");
    let killed = Command::new("kill").arg(child.id().to_string()).status().expect("kill");
    assert!(killed.success());
    let rest: Vec<String> = lines.map(|line| line.expect("text")).collect();
    assert_eq!(child.wait().expect("it ends").code(), Some(0), "{rest:?}");
    assert!(rest.iter().any(|line| line.contains("recorded")), "{rest:?}");
    let check = run(&["check", text(&file), "--rig", text(&sample)]);
    let said = String::from_utf8(check.stdout).expect("UTF-8");
    assert!(said.contains("station 3") && !said.contains("interrupted"), "{said}");
}

#[test]
fn bad_usage_is_one_line() {
    let sample = sample_folder("hd2-tunnel");
    for (arguments, code, expected) in [
        (vec!["live"], 2, "URL"),
        (vec!["live", "http://robot"], 2, "ws://"),
        (vec!["live", "--replay", text(&sample), "--speed", "0"], 2, "not a speed"),
        (vec!["live", "--replay", text(&sample), "--speed", "-1"], 2, "not a speed"),
        (vec!["live", "--replay", text(&sample), "--target-mm", "0"], 2, "not a target"),
        (vec!["live", "--replay", text(&sample), "--topics", "a,b,c,d,e,f,g,h,i"], 2, "9 names"),
        (vec!["live", "--replay", "/not/there"], 1, "/not/there"),
        (vec!["live", "ws://127.0.0.1:9", "--drive", "x"], 2, "--drive"),
        (vec!["live", "ws://127.0.0.1:9", "--seconds", "1"], 1, "no server answers"),
        (vec!["live", "ws://127.0.0.1:9", "--record", "/not/there/x.mcap"], 1, "does not exist"),
    ] {
        let output = run(&arguments);
        let said = String::from_utf8(output.stderr).expect("UTF-8");
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {said}");
        assert!(said.contains(expected) && said.trim_end().lines().count() == 1, "{said}");
    }
}

#[test]
fn without_json_it_is_a_line_for_people() {
    let sample = resect_io::sample::Sample::Hd2Tunnel.open().expect("built in");
    let steps = resect_live::replay::messages(&sample, &[0.01; 3].into()).map(Step::Send).collect();
    let server = Server::start(Some("foxglove.sdk.v1"), steps);
    let rig = sample_folder("hd2-tunnel");
    let output = run(&["live", &server.url, "--rig", text(&rig), "--seconds", "4"]);
    let said = String::from_utf8(output.stdout).expect("UTF-8");
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(said.contains("- connected to test"), "{said}");
    assert!(said.contains(" mm (1 σ)") || said.contains("Not determined yet"), "{said}");
    server.join();
}
