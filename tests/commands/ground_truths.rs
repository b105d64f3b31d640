//! Trajectories compared with ground truths that are no deployments: trajectories with and without orientation and covariance,
//! surveyed points, and the track of one station. The data of other groups is in `../shared/datasets/others`.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::common::slam::{SLAM, Slam, driven, true_pose, write_tum};
use crate::common::{field_data, of_field};
use crate::evaluate::evo_statistics;
use nalgebra::{UnitQuaternion, Vector3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use resect_core::geometry::Geodetic;
use resect_tools::simulation::{EPOCH_S, Preset, Simulated, simulate};
use serde_json::Value;

/// Clock and body of the estimates: 59 ms late, 0.4 m away from the vehicle's origin.
const CLOCK_S: f64 = 0.059;
const LEVER_M: Vector3<f64> = Vector3::new(0.3, -0.2, 0.15);
/// Map coordinates, such as UTM.
const MAP_M: Vector3<f64> = Vector3::new(255_855.0, 5_242_729.0, 643.0);

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a folder"))
    }

    fn at(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, text: &str) -> PathBuf {
        std::fs::write(self.at(name), text).expect("written");
        self.at(name)
    }
}

fn run(arguments: &[&str]) -> std::process::Output {
    Command::new(env!("CARGO_BIN_EXE_resect")).args(arguments).output().expect("runs")
}

fn said(arguments: &[&str]) -> String {
    let output = run(arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("text")
}

/// Evaluates estimates against a ground truth as JSON.
fn evaluated(estimates: &[&Path], truth: &Path, more: &[&str]) -> Value {
    let paths: Vec<&str> = estimates.iter().map(|path| path.to_str().expect("UTF-8")).collect();
    let truth = ["--against", truth.to_str().expect("UTF-8"), "--json"];
    let text = said(&[&["evaluate"], &paths[..], &truth, more].concat());
    serde_json::from_str(&text).expect("JSON")
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is a number"))
}

/// Times of a simulated drive (s) at a rate.
fn times_s(rate_hz: f64) -> impl Iterator<Item = f64> {
    (0..(150.0 * rate_hz) as usize).map(move |step| EPOCH_S + 5.0 + step as f64 / rate_hz)
}

/// Lines of TUM with the true poses and noise of 1 mm, without orientations as 0 0 0 1.
fn truth_tum(simulated: &Simulated, times_s: impl Iterator<Item = f64>, turned: bool) -> String {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    times_s
        .map(|time_s| {
            let (position_m, orientation) = true_pose(simulated, time_s);
            let noise_m = Vector3::from_fn(|_, _| StandardNormal.sample(&mut rng)) * 1e-3;
            let (t, q) = (position_m + noise_m + MAP_M, orientation);
            let q = if turned { q } else { UnitQuaternion::identity() };
            let [x, y, z] = [t.x, t.y, t.z];
            format!("{time_s:.6} {x:.5} {y:.5} {z:.5} {} {} {} {}\n", q.i, q.j, q.k, q.w)
        })
        .collect()
}

/// A simulated drive, and an estimate of it with another clock and body.
fn estimated(folder: &Folder) -> (Simulated, PathBuf) {
    estimated_drive(folder, 4)
}

fn estimated_drive(folder: &Folder, seed: u64) -> (Simulated, PathBuf) {
    let (simulated, _) = driven(seed);
    let slam = Slam { noise_m: 0.005, clock_s: CLOCK_S, lever_m: LEVER_M, ..SLAM };
    write_tum(&slam.drive(&simulated), &folder.at("slam.tum"));
    (simulated, folder.at("slam.tum"))
}

#[test]
fn clock_and_lever_arm_are_estimated_against_poses_and_against_positions() {
    let folder = Folder::new();
    let configurations = [(true, 100.0), (true, 4.0), (false, 20.0), (false, 4.0)];
    let mut off_s = [const { Vec::new() }; 4];
    for seed in 4..8 {
        let (simulated, slam) = estimated_drive(&folder, seed);
        for ((turned, rate_hz), off_s) in configurations.into_iter().zip(&mut off_s) {
            let truth = truth_tum(&simulated, times_s(rate_hz), turned);
            let answer = evaluated(&[&slam], &folder.write("truth.tum", &truth), &[]);
            off_s.push(check_against(&answer["estimates"][0], turned, rate_hz));
        }
    }
    for (off_s, (turned, rate_hz)) in off_s.iter().zip(configurations) {
        let squares: f64 = off_s.iter().map(|off_s| off_s * off_s).sum();
        let rms_s = (squares / off_s.len() as f64).sqrt();
        assert!(rms_s < 0.0025, "turned {turned}, {rate_hz} Hz: {off_s:?}");
    }
}

/// Checks clock, lever arm and errors, and returns the error of the time offset (s).
fn check_against(judged: &Value, turned: bool, rate_hz: f64) -> f64 {
    let what = format!("turned {turned}, {rate_hz} Hz: {judged:#}");
    let offset_s = number(&judged["time_offset_s"]);
    assert!((offset_s + CLOCK_S).abs() < 4.0 * number(&judged["time_offset_sigma_s"]), "{what}");
    // Against positions, the lever arm is that of the antenna in the estimate's body.
    let expected = if turned { LEVER_M } else { -LEVER_M };
    for axis in 0..2 {
        let lever_m = number(&judged["lever_arm_m"][axis]);
        assert!((lever_m - expected[axis]).abs() < 0.02, "{what}");
    }
    assert!(number(&judged["ape_position_m"]["rmse"]) < 0.05, "{what}");
    assert_eq!(judged["ape_rotation_rad"].is_object(), turned, "{what}");
    assert_eq!(judged["rpe"][0]["of"], if turned { "pose" } else { "distance" });
    // The frames differ by map coordinates, which the alignment hides.
    assert!(number(&judged["ape_position_not_aligned_m"]["rmse"]) > 5e6, "{what}");
    // Nothing states an uncertainty.
    assert!(judged["ground_truth_sigma_m"].is_null() && judged["undecided_share"].is_null());
    offset_s + CLOCK_S
}

#[test]
fn the_uncertainty_of_a_trajectory_is_read_from_columns_a_file_or_an_option() {
    let folder = Folder::new();
    let (simulated, slam) = estimated(&folder);
    let tum = truth_tum(&simulated, times_s(20.0), true);
    let rows = || tum.lines().map(|line| line.split(' ').collect::<Vec<_>>());
    let columns = rows().map(|row| format!("{},0.001,0.002,0.002\n", row.join(",")));
    let columns = columns.collect::<String>();
    let csv = format!("t,x,y,z,qx,qy,qz,qw,sigma_x,sigma_y,sigma_z\n{columns}");
    let beside = rows().map(|row| format!("{},1e-6,0,0,0,4e-6,0,0,0,4e-6\n", row[0]));
    let beside = beside.collect::<String>();
    let with_columns = folder.write("columns.csv", &csv);
    let plain = folder.write("plain.tum", &tum);
    let with_file = folder.write("gt.txt", &tum);
    folder.write("gt_covariance.csv", &beside);
    for (truth, more) in [
        (&with_columns, &[][..]),
        (&with_file, &[]),
        (&plain, &["--truth-sigma", "0.001,0.002,0.002"]),
    ] {
        let found = evaluated(&[&slam], truth, more);
        let sigma_m = number(&found["estimates"][0]["ground_truth_sigma_m"]);
        assert!((sigma_m - 0.003_f64.sqrt() * 0.001_f64.sqrt()).abs() < 1e-6, "{sigma_m}");
        assert_eq!(found["ground_truth"]["states_covariance"], true);
    }
    // A pose without covariance, and a line that is none, are errors of that file.
    // Findings about the ground truth are printed with the errors.
    let broken = folder.write("broken.tum", &format!("{tum}nan 1 2 3 0 0 0 1\n"));
    let paths = [&slam, &broken].map(|path| path.to_str().expect("UTF-8"));
    let text = said(&["evaluate", paths[0], "--against", paths[1]]);
    assert!(text.contains("broken.tum: 1 row is not valid"), "{text}");
    let first = beside.lines().next().expect("a line");
    folder.write("gt_covariance.csv", &format!("{first}\n"));
    for (text, part) in
        [(first.to_owned(), "no covariance for"), ("1,2,3\n".to_owned(), "gt_covariance.csv:1: 3")]
    {
        folder.write("gt_covariance.csv", &text);
        let paths = [&slam, &with_file].map(|path| path.to_str().expect("UTF-8"));
        let output = run(&["evaluate", paths[0], "--against", paths[1]]);
        let why = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(1) && why.contains(part), "{why}");
    }
}

/// A solution of RTKLIB about 46.78° N, 71.28° W of an antenna with these positions in the vehicle; every tenth is float, 0.5 m too high.
fn solution(simulated: &Simulated, antenna_m: &Vector3<f64>) -> String {
    let base = Geodetic { latitude_rad: 0.816_465, longitude_rad: -1.243_983, height_m: 67.7 };
    let mut text = String::from(
        "%  UTC latitude(deg) longitude(deg) height(m) Q ns sdn(m) sde(m) sdu(m) sdne(m) sdeu(m) sdun(m) age(s) ratio\n",
    );
    for (index, time_s) in times_s(5.0).enumerate() {
        let (position_m, orientation) = true_pose(simulated, time_s);
        let is_float = index % 10 == 3;
        let error_m = Vector3::z() * if is_float { 0.5 } else { 0.0 };
        let local_m = position_m + orientation * antenna_m + error_m;
        let ecef_m = base.to_ecef() + base.ecef_from_local() * local_m;
        let geodetic = Geodetic::from_ecef(ecef_m);
        let of_day_s = (time_s - 1_759_968_000.0) % 86_400.0;
        let [hour, minute] = [of_day_s / 3600.0, of_day_s / 60.0 % 60.0].map(f64::trunc);
        let (quality, sigma) = if is_float { (2, 0.5) } else { (1, 0.005) };
        text += &format!(
            "2025/10/09 {hour:02}:{minute:02}:{:06.3} {:.10} {:.10} {:.4} {quality} 9 {sigma} {sigma} {sigma} 0 0 0 0 9\n",
            of_day_s % 60.0,
            geodetic.latitude_rad.to_degrees(),
            geodetic.longitude_rad.to_degrees(),
            geodetic.height_m,
        );
    }
    text
}

#[test]
fn a_gnss_solution_is_a_ground_truth_by_its_fixed_positions() {
    let folder = Folder::new();
    let (simulated, slam) = estimated(&folder);
    let antenna_m = Vector3::new(0.4, 0.1, 0.5);
    let truth = folder.write("rover.pos", &solution(&simulated, &antenna_m));
    let codes = |answer: &Value| -> Vec<String> {
        let findings = answer["ground_truth"]["findings"].as_array().expect("findings");
        findings.iter().map(|finding| finding["code"].as_str().expect("text").to_owned()).collect()
    };
    let fixed = evaluated(&[&slam], &truth, &[]);
    assert_eq!(codes(&fixed), ["gnss-solutions-left-out", "gnss-positions-local"]);
    let judged_slam = &fixed["estimates"][0];
    assert!((number(&judged_slam["time_offset_s"]) + CLOCK_S).abs() < 0.004, "{judged_slam:#}");
    for (axis, expected) in (antenna_m - LEVER_M).iter().enumerate().take(2) {
        let lever_m = number(&judged_slam["lever_arm_m"][axis]);
        assert!((lever_m - expected).abs() < 0.04, "{judged_slam:#}");
    }
    assert!(number(&judged_slam["ape_position_m"]["rmse"]) < 0.05, "{judged_slam:#}");
    let sigma_m = number(&judged_slam["ground_truth_sigma_m"]);
    assert!((sigma_m - 0.005).abs() < 1e-4, "{sigma_m}");
    // Float solutions are off by half a metre.
    let all = evaluated(&[&slam], &truth, &["--truth-solutions", "all"]);
    assert_eq!(codes(&all), ["gnss-solutions-mixed", "gnss-positions-local"]);
    assert!(number(&all["estimates"][0]["ape_position_m"]["rmse"]) > 0.1, "{all:#}");
    // A solution that is evaluated has all its positions.
    let judged = evaluated(&[&truth], &slam, &["--body", "found"]);
    assert_eq!(judged["estimates"][0]["findings"][0]["code"], "gnss-solutions-mixed");
    // A line that is cut off is an error with its place.
    let text = std::fs::read_to_string(&truth).expect("text");
    let cut = folder.write("cut.pos", &text[..text.len() - 30]);
    let arguments = ["evaluate", slam.to_str().expect("UTF-8"), "--against"];
    let output = run(&[&arguments[..], &[cut.to_str().expect("UTF-8")]].concat());
    let why = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success() && why.contains("cut.pos:751: "), "{why}");
}

#[test]
fn surveyed_points_judge_an_estimate_without_claiming_its_clock() {
    let folder = Folder::new();
    let (simulated, slam) = estimated(&folder);
    // A point every 10 s; the vehicle moves, so the clock is determined. Standing, it would not be.
    let truth = folder.write("points.txt", &truth_tum(&simulated, times_s(0.1), false));
    let found = evaluated(&[&slam], &truth, &[]);
    let one = &found["estimates"][0];
    assert_eq!(one["poses_with_ground_truth"], 15, "{one:#}");
    assert_eq!(one["ground_truth_without_poses"], 0, "{one:#}");
    assert!(number(&one["ape_position_m"]["rmse"]) < 0.05, "{one:#}");
    let over_sigma =
        (number(&one["time_offset_s"]) + CLOCK_S) / number(&one["time_offset_sigma_s"]);
    assert!(over_sigma.abs() < 4.0, "{over_sigma}: {one:#}");
    // Few points align the frame, and nothing else is claimed.
    let lines = truth_tum(&simulated, times_s(0.1), false);
    let few: String = lines.lines().take(6).map(|line| format!("{line}\n")).collect();
    let truth = folder.write("few.txt", &few);
    let one = &evaluated(&[&slam], &truth, &[])["estimates"][0];
    assert!(one["time_offset_sigma_s"].is_null() && one["lever_arm_sigma_m"].is_null(), "{one:#}");
    assert_eq!(one["findings"][0]["code"], "estimate-few-points", "{one:#}");
    // Points of another clock: the offset is found by positions.
    let shifted = slam.with_file_name("shifted.tum");
    let late = Slam { noise_m: 0.005, clock_s: -37.0, ..SLAM };
    write_tum(&late.drive(&simulated), &shifted);
    let one = &evaluated(&[&shifted], &folder.at("points.txt"), &[])["estimates"][0];
    assert!((number(&one["time_offset_s"]) - 37.0).abs() < 0.05, "{one:#}");
}

#[test]
fn one_station_is_a_ground_truth_and_exports_positions_with_sigma() {
    let folder = Folder::new();
    let simulated = simulate(Preset::Warthog, 4);
    resect_io::simulation_files::write_folder(&simulated, &folder.at("all")).expect("written");
    let mut csv = std::fs::read_to_string(folder.at("all/inter_prism.csv")).expect("readings");
    let rows = csv.lines().enumerate();
    let rows = rows.filter(|(line, row)| *line == 0 || row.split(',').nth(1) == Some("2"));
    csv = rows.map(|(_, row)| format!("{row}\n")).collect();
    std::fs::create_dir(folder.at("one")).expect("made");
    folder.write("one/inter_prism.csv", &csv);
    write_tum(
        &Slam { noise_m: 0.005, clock_s: CLOCK_S, ..SLAM }.drive(&simulated),
        &folder.at("slam.tum"),
    );
    let one = &evaluated(&[&folder.at("slam.tum")], &folder.at("one"), &[])["estimates"][0];
    // The lever arm is that of prism 2.
    let prism_m = simulated.truth.prisms_m[1];
    for axis in 0..2 {
        assert!((number(&one["lever_arm_m"][axis]) - prism_m[axis]).abs() < 0.05, "{one:#}");
    }
    assert!((number(&one["time_offset_s"]) + CLOCK_S).abs() < 0.03, "{one:#}");
    assert!((0.001..0.02).contains(&number(&one["ground_truth_sigma_m"])), "{one:#}");
    let path = |name: &str| folder.at(name).to_str().expect("UTF-8").to_owned();
    let text = said(&["trajectory", &path("one"), "--out", &path("track.csv")]);
    assert!(text.contains("station 2") && text.contains("typical σ"), "{text}");
    let track = std::fs::read_to_string(folder.at("track.csv")).expect("written");
    let header = track.lines().next().expect("a header");
    assert!(header.starts_with("timestamp_s,x_m,y_m,z_m,sigma_x_m"), "{header}");
    // That export is a ground truth with covariance itself.
    let again = evaluated(&[&folder.at("slam.tum")], &folder.at("track.csv"), &[]);
    let sigmas = [one, &again["estimates"][0]].map(|one| number(&one["ground_truth_sigma_m"]));
    assert!((sigmas[0] - sigmas[1]).abs() < 1e-5, "{sigmas:?}");
    // Each of three stations can be chosen; options that do not apply are refused.
    let found = evaluated(&[&folder.at("slam.tum")], &folder.at("all"), &["--truth-station", "3"]);
    assert_eq!(found["ground_truth"]["kind"], "trajectory");
    for (truth, option) in [
        (path("track.csv"), &["--truth-station", "1"][..]),
        (path("all"), &["--truth-sigma", "0.01"]),
        (path("all"), &["--truth-sigma", "0"]),
    ] {
        let slam = path("slam.tum");
        let arguments = [&["evaluate", &slam, "--against", &truth], option].concat();
        assert_eq!(run(&arguments).status.code(), Some(2), "{option:?}");
    }
}

#[test]
fn estimates_are_ranked_by_each_kind_of_error() {
    let folder = Folder::new();
    let (simulated, _) = driven(4);
    let drive =
        |name, seed, noise_m| Slam { name, seed, noise_m, drift_m: 0.0, ..SLAM }.drive(&simulated);
    write_tum(&drive("a", 1, 0.01), &folder.at("a.tum"));
    // Better in position, worse in rotation.
    let mut b = drive("b", 2, 0.005);
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    for pose in &mut b.poses {
        let turn = Vector3::from_fn(|_, _| StandardNormal.sample(&mut rng)) * 0.01;
        pose.orientation = pose.orientation.map(|own| own * UnitQuaternion::from_scaled_axis(turn));
    }
    write_tum(&b, &folder.at("b.tum"));
    let truth = folder.write("truth.tum", &truth_tum(&simulated, times_s(50.0), true));
    let found = evaluated(&[&folder.at("a.tum"), &folder.at("b.tum")], &truth, &[]);
    let comparisons = found["comparisons"].as_array().expect("comparisons");
    let better = |by: &str| {
        let two = comparisons.iter().find(|two| two["by"] == by).expect(by);
        assert_eq!(two["significant"], true, "{two:#}");
        two["better"].as_str().expect("a name").to_owned()
    };
    assert_eq!([better("position"), better("rotation")], ["b", "a"]);
    assert_eq!(better("rotation over 5 m"), "a");
    let paths = ["a.tum", "b.tum", "truth.tum"].map(|name| folder.at(name).display().to_string());
    let latex = folder.at("table.tex").display().to_string();
    let text = said(&["evaluate", &paths[0], &paths[1], "--against", &paths[2], "--latex", &latex]);
    for part in ["verdict", "b better, ", "a better, ", "RPE over 100 m (°)"] {
        assert!(text.contains(part), "{text}");
    }
    let latex = std::fs::read_to_string(latex).expect("written");
    assert!(latex.contains("\\toprule") && latex.contains(" & a & b \\\\"), "{latex}");
}

#[test]
fn a_ground_truth_that_several_estimates_contradict_is_named() {
    let folder = Folder::new();
    let (simulated, _) = driven(4);
    let drive = |name, seed| Slam { name, seed, noise_m: 0.003, drift_m: 0.0, ..SLAM };
    for (name, seed) in [("a", 1), ("b", 2)] {
        write_tum(&drive(name, seed).drive(&simulated), &folder.at(&format!("{name}.tum")));
    }
    // The ground truth drifts by decimetres and jumps for two seconds.
    let wrong = |text: String| -> String {
        let lines = text.lines().enumerate().map(|(index, line)| {
            let mut fields: Vec<String> = line.split(' ').map(str::to_owned).collect();
            let x: f64 = fields[1].parse().expect("a number");
            let drift_m = 0.1 * (index as f64 * 0.002).sin();
            let jump_m = if (1000..1100).contains(&index) { 0.8 } else { 0.0 };
            fields[1] = format!("{}", x + drift_m + jump_m);
            fields.join(" ") + "\n"
        });
        lines.collect()
    };
    let text = truth_tum(&simulated, times_s(50.0), true);
    let truth = folder.write("truth.tum", &wrong(text));
    let both = evaluated(&[&folder.at("a.tum"), &folder.at("b.tum")], &truth, &[]);
    assert_eq!(both["agreements"].as_array().map(Vec::len), Some(1), "{both:#}");
    let blamed = |found: &Value| {
        let spans = found["estimates"][0]["odd_spans"].as_array().expect("spans").clone();
        spans.iter().map(|span| span["wrong"].clone()).collect::<Vec<Value>>()
    };
    assert_eq!(blamed(&both), ["ground-truth"]);
    // One estimate alone does not decide.
    assert_eq!(blamed(&evaluated(&[&folder.at("a.tum")], &truth, &[])), ["undecided"]);
}

/// Pairs of `../shared/datasets/others`: estimate, ground truth, and the alignment that it needs.
const PAIRS: [(&str, &str, &str); 9] = [
    ("evo/freiburg1_xyz-rgbdslam.txt", "evo/freiburg1_xyz-groundtruth.txt", "rigid"),
    ("evo/freiburg1_xyz-rgbdslam_drift.txt", "evo/freiburg1_xyz-groundtruth.txt", "rigid"),
    ("euroc/MH_05_svo_stereo.txt", "euroc/MH_05_groundtruth.txt", "rigid"),
    ("euroc/MH_05_svo_mono.txt", "euroc/MH_05_groundtruth.txt", "similarity"),
    ("hilti2021/Basement_4_svo2.txt", "hilti2021/Basement_4_prism.txt", "similarity"),
    ("hilti2021/Basement_4_hdl_graph_slam.txt", "hilti2021/Basement_4_prism.txt", "rigid"),
    ("hilti2021/Campus_2_hdl_graph_slam.txt", "hilti2021/Campus_2_prism.txt", "rigid"),
    ("fomo/odom.csv", "fomo/gt.txt", "rigid"),
    ("ntu_viral/leica_pose.csv", "ntu_viral/leica_pose.csv", "rigid"),
];

#[test]
#[cfg_attr(not(field_data), ignore = "needs ../shared/datasets")]
fn files_of_other_groups_are_judged_without_preparation() {
    for (estimate, truth, align) in PAIRS {
        let path = |name: &str| of_field(&format!("others/{name}"));
        let found = evaluated(&[&path(estimate)], &path(truth), &["--align", align]);
        let one = &found["estimates"][0];
        let limit_m = match estimate {
            "fomo/odom.csv" => 40.0,
            "ntu_viral/leica_pose.csv" => 1e-6,
            _ if estimate.starts_with("hilti") => 0.5,
            _ => 0.2,
        };
        assert!(number(&one["ape_position_m"]["rmse"]) < limit_m, "{estimate}: {one:#}");
        assert!(number(&one["time_offset_s"]).abs() < 0.2, "{estimate}: {one:#}");
    }
    let path = |name: &str| of_field(&format!("others/{name}"));
    let fomo = evaluated(&[&path("fomo/odom.csv")], &path("fomo/gt.txt"), &[]);
    let sigma_m = number(&fomo["estimates"][0]["ground_truth_sigma_m"]);
    assert!((0.002..0.003).contains(&sigma_m), "{sigma_m}");
    // A single camera has no scale.
    let mono = evaluated(
        &[&path("hilti2021/Campus_2_svo2.txt")],
        &path("hilti2021/Campus_2_prism.txt"),
        &[],
    );
    assert_eq!(mono["estimates"][0]["findings"][0]["code"], "estimate-scale-off");
}

#[test]
#[ignore = "needs evo: tests/run --peers"]
fn errors_against_trajectories_agree_with_the_peer_evo() {
    let folder = Folder::new();
    if field_data("others").is_none() {
        return;
    }
    for (estimate, truth, align) in &PAIRS[..4] {
        let path = |name: &str| of_field(&format!("others/{name}"));
        let found = evaluated(&[&path(estimate)], &path(truth), &["--as-evo", "--align", align]);
        let own = &found["estimates"][0];
        let rpe = own["rpe"].as_array().expect("paths").iter().find(|r| r["delta"] == 1.0);
        let rpe = rpe.expect("over 1 m");
        let aligned: &[&str] =
            if *align == "rigid" { &["--align"] } else { &["--align", "--correct_scale"] };
        for (program, options, values) in [
            ("evo_ape", [aligned, &["-r", "trans_part"]].concat(), &own["ape_position_m"]),
            ("evo_ape", [aligned, &["-r", "angle_rad"]].concat(), &own["ape_rotation_rad"]),
            ("evo_ape", vec!["--align_origin"], &own["ape_position_at_first_pose_m"]),
            ("evo_ape", vec![], &own["ape_position_not_aligned_m"]),
            ("evo_rpe", [aligned, &["-r", "trans_part"]].concat(), &rpe["position_m"]),
            ("evo_rpe", [aligned, &["-r", "angle_rad"]].concat(), &rpe["rotation_rad"]),
        ] {
            let mut command = Command::new(program);
            command.arg("tum").arg(path(truth)).arg(path(estimate)).args(&options);
            if program == "evo_rpe" {
                command.args(["--delta", "1", "--delta_unit", "m"]);
            }
            let stats = evo_statistics(&mut command, folder.0.path());
            for (key, theirs) in stats {
                let Some(ours) = values[&key].as_f64() else { continue };
                let what = format!("{program} {options:?} {estimate} {key}: {ours} {theirs}");
                assert!((ours - theirs).abs() < 1e-6, "{what}");
            }
        }
    }
}

/// Motions as evo names them: `--delta` here, `--delta` and `--delta_unit` there.
const MOTIONS: [(&str, &str, &str); 4] =
    [("2.5m", "2.5", "m"), ("0.3m", "0.3", "m"), ("20f", "20", "f"), ("12deg", "12", "d")];

#[test]
#[ignore = "needs evo: tests/run --peers"]
fn relative_errors_of_any_motion_agree_with_the_peer_evo() {
    let folder = Folder::new();
    if field_data("others").is_none() {
        return;
    }
    let deltas: Vec<&str> = MOTIONS.iter().flat_map(|(delta, ..)| ["--delta", *delta]).collect();
    for (estimate, truth, _) in &PAIRS[..3] {
        let path = |name: &str| of_field(&format!("others/{name}"));
        for all_pairs in [&[][..], &["--all-pairs"]] {
            let flags = [&["--as-evo"], &deltas[..], all_pairs].concat();
            let found = evaluated(&[&path(estimate)], &path(truth), &flags);
            let rpe = found["estimates"][0]["rpe"].as_array().expect("motions").clone();
            for ((_, delta, unit), rpe) in MOTIONS.iter().zip(&rpe) {
                for (relation, values) in
                    [("trans_part", &rpe["position_m"]), ("angle_rad", &rpe["rotation_rad"])]
                {
                    let mut command = Command::new("evo_rpe");
                    command.arg("tum").arg(path(truth)).arg(path(estimate)).args(["--align"]);
                    command.args(["-r", relation, "--delta", delta, "--delta_unit", unit]);
                    if !all_pairs.is_empty() {
                        command.arg("--all_pairs");
                    }
                    for (key, theirs) in evo_statistics(&mut command, folder.0.path()) {
                        let Some(ours) = values[&key].as_f64() else { continue };
                        let what =
                            format!("{estimate} {delta} {unit} {all_pairs:?} {relation} {key}");
                        assert!((ours - theirs).abs() < 1e-6, "{what}: {ours} {theirs}");
                    }
                }
            }
        }
    }
}

/// Each motion has its row, and each empty cell the reason of this estimate.
#[test]
fn motions_of_any_size_have_rows_and_missing_ones_their_reason() {
    let folder = Folder::new();
    let (simulated, _) = driven(5);
    let truth = folder.write("truth.tum", &truth_tum(&simulated, times_s(50.0), true));
    let slam = folder.at("slam.tum");
    write_tum(&Slam { lever_m: Vector3::zeros(), ..SLAM }.drive(&simulated), &slam);
    let path = |path: &Path| path.to_str().expect("UTF-8").to_owned();
    let (slam, truth) = (path(&slam), path(&truth));
    let deltas = [
        "--delta", "2", "--delta", "10s", "--delta", "50f", "--delta", "90deg", "--delta", "9000m",
    ];
    let text = said(&[&["evaluate", &slam, "--against", &truth], &deltas[..]].concat());
    for label in [
        "RPE over 2 m, rmse (mm)",
        "RPE over 10 s, rmse (°)",
        "RPE over 50 frames, rmse (mm)",
        "RPE over 90°, rmse (°)",
    ] {
        let row =
            text.lines().find(|line| line.starts_with(label)).unwrap_or_else(|| panic!("{text}"));
        let value: f64 = row.rsplit(' ').next().expect("a cell").parse().expect("a number");
        assert!(value > 0.0, "{row}");
    }
    let why =
        "– in RPE over 9000 m, rmse (mm) to RPE over 9000 m, rmse (°): the compared drive of ";
    assert!(text.contains(why) && text.contains(" m is shorter than 9000 m"), "{text}");
    // Without orientations the angle of a motion is unknown, and the rows of rotations remain.
    let points: String = std::fs::read_to_string(&truth)
        .expect("read")
        .lines()
        .map(|line| line.split(' ').take(4).collect::<Vec<_>>().join(" ") + "\n")
        .collect();
    let points = path(&folder.write("points.txt", &points));
    let text = said(&[&["evaluate", &slam, "--against", &points], &deltas[..]].concat());
    for part in [
        "RPE over 2 m, distance (mm)",
        "APE rotation, rmse (°)                                         –",
        "– in APE aligned at the first pose, rmse (mm); APE rotation, rmse (°) to RPE over 2 m, rmse (°); ",
        "RPE over 9000 m, rmse (°): the estimate or the ground truth has no orientations",
    ] {
        assert!(text.contains(part), "{part} in {text}");
    }
    let all = evaluated(&[Path::new(&slam)], Path::new(&truth), &["--all-pairs", "--delta", "20f"]);
    let count = number(&all["estimates"][0]["rpe"][0]["position_m"]["count"]);
    let poses = number(&all["estimates"][0]["poses_with_ground_truth"]);
    assert!(all["rpe_all_pairs"] == true && count == poses - 20.0, "{count} {poses}");
    assert_eq!(
        run(&["evaluate", &slam, "--against", &truth, "--delta", "5km"]).status.code(),
        Some(2)
    );
}

#[test]
#[ignore = "needs evo: tests/run --peers"]
fn spans_planes_and_first_poses_agree_with_the_peer_evo() {
    let folder = Folder::new();
    if field_data("others").is_none() {
        return;
    }
    let (estimate, truth, _) = PAIRS[0];
    let path = |name: &str| of_field(&format!("others/{name}"));
    for (ours, theirs) in [
        (["--plane", "xy"].as_slice(), ["--project_to_plane", "xy"].as_slice()),
        (&["--plane", "xz"], &["--project_to_plane", "xz"]),
        (&["--plane", "yz"], &["--project_to_plane", "yz"]),
        (&["--align-first", "150"], &["--n_to_align", "150"]),
        (
            &["--from", "1305031103.0", "--to", "1305031115.5"],
            &["--t_start", "1305031103.0", "--t_end", "1305031115.5"],
        ),
    ] {
        let flags = [&["--as-evo", "--delta", "0.5m"], ours].concat();
        let found = evaluated(&[&path(estimate)], &path(truth), &flags);
        let judged = &found["estimates"][0];
        for (program, relation, values) in [
            ("evo_ape", "trans_part", &judged["ape_position_m"]),
            ("evo_ape", "angle_rad", &judged["ape_rotation_rad"]),
            ("evo_rpe", "trans_part", &judged["rpe"][0]["position_m"]),
            ("evo_rpe", "angle_rad", &judged["rpe"][0]["rotation_rad"]),
        ] {
            let mut command = Command::new(program);
            command
                .arg("tum")
                .arg(path(truth))
                .arg(path(estimate))
                .args(["--align", "-r", relation]);
            command.args(theirs);
            if program == "evo_rpe" {
                command.args(["--delta", "0.5", "--delta_unit", "m"]);
            }
            for (key, theirs) in evo_statistics(&mut command, folder.0.path()) {
                let Some(value) = values[&key].as_f64() else { continue };
                let what = format!("{program} {relation} {ours:?} {key}");
                assert!((value - theirs).abs() < 1e-6, "{what}: {value} {theirs}");
            }
        }
    }
}

/// The estimate is shifted by 2 m up from the 60th second on.
#[test]
fn a_comparison_is_restricted_to_a_span_to_first_poses_or_to_a_plane() {
    let folder = Folder::new();
    let (simulated, _) = driven(5);
    let truth = folder.write("truth.tum", &truth_tum(&simulated, times_s(20.0), true));
    let shifted: String = std::fs::read_to_string(&truth)
        .expect("read")
        .lines()
        .map(|line| {
            let mut fields: Vec<f64> =
                line.split(' ').map(|field| field.parse().expect("a number")).collect();
            fields[3] += if fields[0] - EPOCH_S >= 65.0 { 2.0 } else { 0.0 };
            fields.iter().map(f64::to_string).collect::<Vec<_>>().join(" ") + "\n"
        })
        .collect();
    let slam = folder.write("slam.tum", &shifted);
    let same = ["--time-offset", "0", "--body", "same"];
    let evaluate = |flags: &[&str]| evaluated(&[&slam], &truth, &[&same, flags].concat());
    let rmse_m = |found: &Value| number(&found["estimates"][0]["ape_position_m"]["rmse"]);
    assert!(rmse_m(&evaluate(&[])) > 0.5);
    let before = evaluate(&["--from", "10", "--to", "59"]);
    assert!(rmse_m(&before) < 1e-3, "{before:#}");
    let judged = &before["estimates"][0];
    // 49 s at 20 Hz, both ends included; poses outside are not counted as poses without ground truth.
    assert_eq!(
        (&judged["poses_with_ground_truth"], &judged["poses_without_ground_truth"]),
        (&981.into(), &0.into())
    );
    assert_eq!(judged["span_s"][0], EPOCH_S + 15.0);
    let stamps = [EPOCH_S + 15.0, EPOCH_S + 64.0].map(|time_s| format!("{time_s}"));
    let by_stamps = evaluate(&["--from", &stamps[0], "--to", &stamps[1]]);
    assert_eq!(by_stamps["estimates"][0]["poses_with_ground_truth"], 981);
    // By the first poses the frame is right, and the shift remains as it is.
    let first = &evaluate(&["--align-first", "800"])["estimates"][0];
    assert!((number(&first["ape_position_m"]["max"]) - 2.0).abs() < 0.05, "{first:#}");
    assert!(
        number(&first["ape_position_m"]["min"]) < 1e-3 && first["alignment"]["first_poses"] == 800
    );
    // Nothing of it is in the plane, if the frames are one.
    let plane = evaluate(&["--plane", "xy", "--align", "none"]);
    assert!(rmse_m(&plane) < 1e-3 && plane["estimates"][0]["plane"] == "xy", "{plane:#}");
    let path = |path: &Path| path.to_str().expect("UTF-8").to_owned();
    let (slam, truth) = (path(&slam), path(&truth));
    let all = [&["evaluate", &slam, "--against", &truth], &same[..]].concat();
    let text = said(&[&all, &["--from", "10", "--to", "59", "--plane", "yz"][..]].concat());
    assert!(text.contains("compared from 10.0 s to 59.0 s, projected to the yz plane"), "{text}");
    for (flags, code, why) in [
        (["--from", "59", "--to", "10"].as_slice(), 2, "--from must be before --to"),
        (&["--from", "500"], 1, "only 0 of its poses with ground truth are in the span"),
        (&["--align-first", "3"], 2, "3 is not in 4.."),
    ] {
        let output = run(&[&all, flags].concat());
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(code) && said.contains(why), "{said}");
    }
}

/// The trajectory has a gap of 3 s and a jump of 1.5 m, and two files are checked at once.
#[test]
fn a_trajectory_is_checked_without_a_ground_truth() {
    let folder = Folder::new();
    let (simulated, _) = driven(5);
    let whole = truth_tum(&simulated, times_s(10.0), true);
    let broken: String = whole
        .lines()
        .enumerate()
        .filter(|(index, _)| !(300..330).contains(index))
        .map(|(index, line)| {
            let mut fields: Vec<f64> =
                line.split(' ').map(|field| field.parse().expect("a number")).collect();
            fields[1] += if index >= 800 { 1.5 } else { 0.0 };
            fields.iter().map(f64::to_string).collect::<Vec<_>>().join(" ") + "\n"
        })
        .collect();
    let path = |path: PathBuf| path.to_str().expect("UTF-8").to_owned();
    let (whole, broken) =
        (path(folder.write("whole.tum", &whole)), path(folder.write("broken.tum", &broken)));
    let text = said(&["check", &whole, &broken]);
    let (of_whole, of_broken) = text.split_once("\nbroken\n").expect("two trajectories");
    for part in [
        "whole\n",
        "1500 over 149.9 s, 10.00 Hz",
        "none, longest interval 0.10 s",
        "unit quaternions",
    ] {
        assert!(of_whole.contains(part), "{text}");
    }
    for part in [
        "1470 over 149.9 s",
        "1 beyond 5 times the median: 3.10 s at 29.9 s",
        "in 0.100 s) at 79.9 s",
    ] {
        assert!(of_broken.contains(part), "{text}");
    }
    let found: Value = serde_json::from_str(&said(&["check", &broken, "--json"])).expect("JSON");
    let jump = &found["trajectories"][0]["fastest_steps"][0];
    assert!((number(&jump["length_m"]) - 1.5).abs() < 0.3, "{jump}");
    // Positions with a σ, without orientations.
    let points = path(folder.write(
        "p.csv",
        "timestamp,x,y,z,sigma_x,sigma_y,sigma_z\n1,0,0,0,0.01,0.01,0.01\n2,3,4,0,0.01,0.01,0.01\n",
    ));
    let text = said(&["check", &points]);
    for part in ["2 over 1.0 s, 1.00 Hz", "5.0 m", "orientations  none", "median σ 10.0 mm"] {
        assert!(text.contains(part), "{part} in {text}");
    }
}

/// Returns lines of TUM as those of KITTI, without times.
fn as_kitti(tum: &str) -> String {
    tum.lines()
        .map(|line| {
            let fields: Vec<f64> =
                line.split(' ').map(|field| field.parse().expect("a number")).collect();
            let [_, x, y, z, qx, qy, qz, qw] = fields[..] else { panic!("{line}") };
            let turn = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(qw, qx, qy, qz));
            let m = turn.to_rotation_matrix();
            let row = |index: usize, last: f64| {
                format!("{:.9} {:.9} {:.9} {last:.9}", m[(index, 0)], m[(index, 1)], m[(index, 2)])
            };
            format!("{} {} {}\n", row(0, x), row(1, y), row(2, z))
        })
        .collect()
}

/// Writes an estimate and its ground truth as KITTI without times, with the same number of poses; returns both paths and the
/// lines of the estimate.
fn write_kitti(folder: &Folder) -> (PathBuf, PathBuf, Vec<String>) {
    let (simulated, _) = driven(5);
    let truth = truth_tum(&simulated, times_s(10.0), true);
    write_tum(&SLAM.drive(&simulated), &folder.at("slam.tum"));
    let slam = std::fs::read_to_string(folder.at("slam.tum")).expect("read");
    // The ground truth begins 5 s later.
    let slam: Vec<&str> = slam.lines().skip(50).collect();
    let count = truth.lines().count().min(slam.len());
    let truth: Vec<&str> = truth.lines().take(count).collect();
    let (estimate, reference) = (folder.at("00.txt"), folder.at("gt.txt"));
    let slam = as_kitti(&slam[..count].join("\n"));
    std::fs::write(&estimate, &slam).expect("written");
    std::fs::write(&reference, as_kitti(&truth.join("\n"))).expect("written");
    (estimate, reference, slam.lines().map(|line| format!("{line}\n")).collect())
}

#[test]
#[ignore = "needs evo: tests/run --peers"]
fn poses_of_kitti_agree_with_the_peer_evo() {
    let folder = Folder::new();
    let (estimate, reference, _) = write_kitti(&folder);
    let found = evaluated(&[&estimate], &reference, &["--as-evo"]);
    let mut command = Command::new("evo_ape");
    command.arg("kitti").arg(&reference).arg(&estimate).arg("--align");
    for (key, theirs) in evo_statistics(&mut command, folder.0.path()) {
        let Some(ours) = found["estimates"][0]["ape_position_m"][&key].as_f64() else { continue };
        assert!((ours - theirs).abs() < 1e-6, "{key}: {ours} {theirs}");
    }
}

/// Without times, poses of two files of equal length are compared by their numbers; otherwise a rate or times are needed.
#[test]
fn poses_of_kitti_without_times_are_compared_by_their_numbers() {
    let folder = Folder::new();
    let (estimate, reference, slam) = write_kitti(&folder);
    let found = evaluated(&[&estimate], &reference, &[]);
    let judged = &found["estimates"][0];
    assert_eq!(
        (&judged["poses_with_ground_truth"], &judged["time_offset_s"]),
        (&slam.len().into(), &0.0.into())
    );
    assert!(number(&judged["ape_position_m"]["rmse"]) < 0.05, "{judged:#}");
    let text = said(&[
        "evaluate",
        estimate.to_str().expect("UTF-8"),
        "--against",
        reference.to_str().expect("UTF-8"),
    ]);
    assert_eq!(text.matches("without times are compared by their numbers").count(), 2, "{text}");
    // With one pose less, numbers do not associate them.
    std::fs::write(&estimate, slam[1..].concat()).expect("written");
    let arguments = [
        "evaluate",
        estimate.to_str().expect("UTF-8"),
        "--against",
        reference.to_str().expect("UTF-8"),
    ];
    let output = run(&arguments);
    let why = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        !output.status.success()
            && why.contains("KITTI poses have no times")
            && why.contains("--rate"),
        "{why}"
    );
    // A rate gives them times; the clock is estimated as that of any file.
    let found = evaluated(&[&estimate], &reference, &["--rate", "10"]);
    // The estimate lacks its first pose, so its times are 0.1 s early.
    let offset_s = number(&found["estimates"][0]["time_offset_s"]);
    assert!((offset_s - 0.1).abs() < 0.01, "{found:#}");
    let tum = folder.at("slam.tum");
    let tum = tum.to_str().expect("UTF-8");
    let output = run(&["evaluate", tum, "--against", tum, "--rate", "10"]);
    let why = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(2) && why.contains("all files have times"), "{why}");
}

/// Rows are never dropped: an unreadable estimate and a drive without a ground truth have theirs, with the true reason.
#[test]
fn several_drives_are_one_table_with_a_row_for_each_estimate() {
    let folder = Folder::new();
    let (simulated, _) = driven(5);
    folder.write("truth.tum", &truth_tum(&simulated, times_s(20.0), true));
    let points: String = truth_tum(&simulated, times_s(20.0), true)
        .lines()
        .map(|line| line.split(' ').take(4).collect::<Vec<_>>().join(" ") + "\n")
        .collect();
    folder.write("points.txt", &points);
    write_tum(&SLAM.drive(&simulated), &folder.at("lio.tum"));
    write_tum(&Slam { noise_m: 0.04, seed: 2, ..SLAM }.drive(&simulated), &folder.at("vio.tum"));
    folder.write("broken.tum", "1 2 3\n");
    let file = folder.write(
        "drives.toml",
        "delta = [\"2m\", \"9000m\"]\n\n\
         [[drive]]\nname = \"yard\"\ntruth = \"truth.tum\"\nestimates = { lio = \"lio.tum\", vio = \"vio.tum\" }\n\n\
         [[drive]]\nname = \"street\"\ntruth = \"points.txt\"\nestimates = { lio = \"lio.tum\", vio = \"broken.tum\" }\n\n\
         [[drive]]\nname = \"tunnel\"\ntruth = \"missing.tum\"\nestimates = { lio = \"lio.tum\" }\n",
    );
    let (file, boxes) = (file.to_str().expect("UTF-8").to_owned(), folder.at("boxes.svg"));
    let boxes_path = boxes.to_str().expect("UTF-8").to_owned();
    let text = said(&["evaluate", "--drives", &file, "--plot", &boxes_path]);
    let row = |drive: &str, estimate: &str| -> Vec<String> {
        let is_row = |line: &&str| {
            let mut words = line.split_whitespace();
            words.next() == Some(drive) && words.next() == Some(estimate)
        };
        let row = text.lines().find(is_row).unwrap_or_else(|| panic!("{text}"));
        row.split_whitespace().skip(2).map(str::to_owned).collect()
    };
    assert!(row("yard", "lio")[0].parse::<f64>().expect("a number") < 40.0, "{text}");
    assert!(row("yard", "vio")[0].parse::<f64>().expect("a number") > 40.0, "{text}");
    assert!(row("street", "lio")[0].parse::<f64>().is_ok(), "{text}");
    for (drive, estimate) in [("street", "vio"), ("tunnel", "lio")] {
        assert!(row(drive, estimate).iter().all(|cell| cell == "–"), "{text}");
    }
    for reason in [
        "– of street, vio: ",
        "3 fields without a header do not form a pose",
        "– of tunnel, lio: ",
        "missing.tum",
        "– of yard, lio in RPE 9000 m (mm), RPE 9000 m (°): the compared drive of ",
        "– of street, lio in APE rmse (°), RPE 2 m (°), RPE 9000 m (°): the estimate or",
    ] {
        assert!(text.contains(reason), "{reason} in {text}");
    }
    let svg = std::fs::read_to_string(&boxes).expect("written");
    for name in ["yard", "street", "tunnel", "lio", "vio", "position error (mm)"] {
        assert!(svg.contains(name), "{name}");
    }
    let [csv, latex] = ["all.csv", "all.tex"].map(|name| folder.at(name));
    let [csv_path, latex_path] = [&csv, &latex].map(|path| path.to_str().expect("UTF-8"));
    said(&["evaluate", "--drives", &file, "--csv", csv_path, "--latex", latex_path]);
    let csv = std::fs::read_to_string(&csv).expect("written");
    assert!(csv.starts_with("drive,estimate,quantity,value,sigma,why_empty\n"), "{csv}");
    let line = |start: &str| csv.lines().find(|line| line.starts_with(start)).expect(start);
    let offset = line("\"yard\",\"lio\",\"time offset (ms)\",");
    let numbers: Vec<f64> = offset.split(',').skip(3).take(2).flat_map(str::parse).collect();
    assert!(numbers.len() == 2 && numbers[1] > 0.0, "value and σ: {offset}");
    assert!(line("\"tunnel\",\"lio\",,,,\"").contains("missing.tum"), "{csv}");
    let latex = std::fs::read_to_string(&latex).expect("written");
    assert!(latex.contains("yard & lio & ") && latex.contains(" $\\pm$ "), "{latex}");
    // A wrong option is an error before the first drive, and options beside the file are refused.
    folder.write(
        "drives.toml",
        "[[drive]]\ntruth = \"truth.tum\"\nestimates = [\"lio.tum\"]\nalgin = \"none\"\n",
    );
    for (flags, why) in [
        (["--drives", &file].as_slice(), "drive truth: unexpected argument '--algin'"),
        (&["--drives", &file, "--as-evo"], "cannot be used with"),
    ] {
        let output = run(&[&["evaluate"], flags].concat());
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && said.contains(why), "{said}");
    }
}
