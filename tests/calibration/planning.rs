//! Predictions before a drive, compared with drives with all errors of the field.

#![allow(clippy::print_stdout, reason = "the tables are the point")]

use std::path::Path;

use crate::common::{analyse, by};
use nalgebra::{DVector, Matrix3, Rotation2, SVector, Vector2, Vector3};
use rayon::prelude::*;
use resect_core::calibration::inter_prism::observability::Hold;
use resect_core::calibration::{ErrorSizes, Method, Verdict};
use resect_core::geometry::ARCSECOND_RAD;
use resect_core::geometry::{RigidTransform, wrap_to_pi};
use resect_core::progress::Progress;
use resect_io::plan_file;
use resect_tools::planning::locks::WhyNotRead;
use resect_tools::planning::{
    FigureEight, ImprovementKind, Loop, Piece, Plan, Prediction, improvements, predict,
};
use resect_tools::simulation::{ErrorKind, Preset, Ramp, Scenario, Waypoint, simulate_scenario};

/// Presets whose drives constrain all eight parameters well.
const WELL_POSED: [Preset; 6] = [
    Preset::Warthog,
    Preset::Hd2Tunnel,
    Preset::FlatFloor,
    Preset::UnevenGround,
    Preset::FigureEight,
    Preset::ShortBaselines,
];
/// A tripod settles at any time of the drive, at once or over the rest of it. On average
/// its error is this share of a random walk's from the beginning with the same end.
const SETTLED: f64 = 0.85;

/// Returns a plan of a preset with the error sizes of the simulation; the priors of the estimate are wider.
fn as_drawn(preset: Preset) -> Plan {
    let mut plan = Plan::from_preset(preset, 1);
    plan.errors = ErrorSizes {
        // Uniform from zero to 15 ms: root mean square.
        latency_s: 0.015 / 3.0_f64.sqrt(),
        // Tilts, and leans of tripods while they settle.
        lean_rad: (1.5_f64.powi(2) + 0.5).sqrt() * ARCSECOND_RAD,
        // Offsets of stations and of prisms.
        range_offset_m: 0.0007 * 2.0_f64.sqrt(),
        range_scale: 5e-6,
        settling_rad: 30e-6 * SETTLED,
        settling_m: 0.0005 * SETTLED,
        ..plan.errors
    };
    // The drawn error, with that of the prism constant, and the noise of the rig's measurement that gives the written distances.
    let read_m = 1e-3 * plan.instrument.range_mm / 10.0_f64.sqrt();
    plan.rig.inter_prism_sigma_m = 0.0022_f64.hypot(read_m * 0.9);
    // Simulations have no occlusion.
    plan.rig.clearance_m = 0.0;
    plan
}

/// A good calibration of a simulated drive of a plan.
struct Realised {
    /// Error (x, y, z, yaw) of stations 2 and 3: estimate minus truth.
    error: SVector<f64, 8>,
    /// Error at the far end of the track (m).
    far_end_m: f64,
    /// Variances that the estimate itself states.
    stated: DVector<f64>,
}

fn realised(plan: &Plan, prediction: &Prediction, seed: u64) -> Option<Realised> {
    // A prediction has no clock jumps.
    let left_out = [ErrorKind::ClockJumps];
    let drawn_errors = ErrorKind::ALL.into_iter().filter(|kind| !left_out.contains(kind)).collect();
    let scenario = Scenario { drawn_errors, ..plan.scenario().expect("a plan") };
    let simulated = simulate_scenario(&scenario, seed);
    let mut settings = by(Method::Joint);
    settings.calibration.errors = plan.errors;
    settings.calibration.inter_prism_sigma_m = plan.rig.inter_prism_sigma_m;
    let analysis =
        analyse(&resect_io::simulation_files::open(&simulated).expect("valid"), &settings);
    let calibration = &analysis.answer.as_ref().ok()?.calibration;
    // Tripods that settle by more than the prior allows are detected, and enlarge σ: a plan does not include that.
    if calibration.verdict != Verdict::Good {
        return None;
    }
    let truth = simulated.truth.station1_from_station.map(|level| RigidTransform::from(*level));
    let error = SVector::<f64, 8>::from_fn(|k, _| {
        let (found, truth) = (&calibration.station1_from_station[k / 4 + 1], &truth[k / 4 + 1]);
        match k % 4 {
            3 => wrap_to_pi(found.yaw_rad() - truth.yaw_rad()),
            axis => found.translation_m[axis] - truth.translation_m[axis],
        }
    });
    let far = &prediction.held.as_ref()?.far_end;
    let own = truth[far.station].inverse().apply(&(far.position_m - plan.stations_m[0]));
    let found = calibration.station1_from_station[far.station].apply(&own);
    let far_end_m = (found - truth[far.station].apply(&own)).norm();
    Some(Realised { error, far_end_m, stated: calibration.covariance.as_ref()?.diagonal() })
}

/// Errors of drives of a plan relative to the prediction.
struct Ratios {
    /// Root mean square errors relative to the predicted σ, by component and at the far end.
    realised: [f64; 8],
    far_end: f64,
    /// The same for the σ that the estimates state.
    stated: [f64; 8],
    good: usize,
}

fn ratios(plan: &Plan, drives: u64) -> Ratios {
    let prediction = predict(plan).expect("a prediction");
    let held = prediction.held.as_ref().expect("nothing is free");
    let one = |seed| realised(plan, &prediction, seed);
    let all: Vec<Realised> = (0..drives).into_par_iter().filter_map(one).collect();
    let rms =
        |of: &dyn Fn(&Realised) -> f64| (all.iter().map(of).sum::<f64>() / all.len() as f64).sqrt();
    let sigma = held.covariance.diagonal().map(f64::sqrt);
    Ratios {
        realised: std::array::from_fn(|k| rms(&|one| one.error[k].powi(2)) / sigma[k]),
        far_end: rms(&|one| one.far_end_m.powi(2)) / held.far_end.sigma_m,
        stated: std::array::from_fn(|k| rms(&|one| one.stated[k]) / sigma[k]),
        good: all.len(),
    }
}

fn rms(values: impl IntoIterator<Item = f64>) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for value in values {
        sum += value * value;
        count += 1.0;
    }
    (sum / f64::max(count, 1.0)).sqrt()
}

/// Simulates some drives of each preset, and returns their ratios.
fn campaign(drives: u64) -> Vec<Ratios> {
    let one = |preset: Preset| {
        let found = ratios(&as_drawn(preset), drives);
        let list = |all: &[f64; 8]| all.map(|ratio| format!("{ratio:.2}")).join(" ");
        println!(
            "{:<16} {:>3} good  far end {:.2}  realised {}  stated {}",
            preset.name(),
            found.good,
            found.far_end,
            list(&found.realised),
            list(&found.stated)
        );
        found
    };
    WELL_POSED.into_iter().map(one).collect()
}

fn near_one(ratio: f64, what: &str) {
    // A prediction has the smallest slow errors on all axes; drives show them on some.
    assert!((0.65..=1.35).contains(&ratio), "{what}: {ratio:.2} times what was predicted");
}

#[test]
fn what_is_predicted_is_what_simulated_drives_come_to() {
    let all = campaign(16);
    for (found, preset) in all.iter().zip(WELL_POSED) {
        assert!(found.good >= 11, "{}: {} good", preset.name(), found.good);
        // A few drives determine a spread to a fifth of itself. All eight parameters together, and the stated σ, are more precise.
        near_one(rms(found.realised), preset.name());
        found.stated.iter().for_each(|ratio| near_one(*ratio, preset.name()));
    }
    near_one(rms(all.iter().map(|found| found.far_end)), "the far end");
}

/// Errors of 1200 drives relative to the prediction, at the far end by preset and for each parameter over all presets. Far ends 1.06 to
/// 1.16 times; single parameters 0.91 to 1.23, of which y of station 3 is the largest (1.19 to 1.23 except in the tunnel). The cause is the
/// time-correlated range errors. In 200 drives of the preset warthog the ratio is 1.22 relative to the σ of the estimates, and 0.92 without
/// these errors. It is 0.99 for a correlation time of 2 to 6 s, and 1.16 for 20 to 60 s, which is longer than expected.
#[test]
#[ignore = "minutes; prints the table"]
fn what_is_predicted_is_what_many_drives_come_to() {
    let all = campaign(200);
    for (found, preset) in all.iter().zip(WELL_POSED) {
        near_one(found.far_end, preset.name());
        near_one(rms(found.realised), preset.name());
        found.stated.iter().for_each(|ratio| near_one(*ratio, preset.name()));
    }
    for (k, name) in ["x", "y", "z", "yaw"].into_iter().enumerate() {
        near_one(rms(all.iter().flat_map(|f| [f.realised[k], f.realised[k + 4]])), name);
    }
}

#[test]
fn turns_at_both_ends_of_a_line_determine_the_stations_as_advised() {
    let mut plan = Plan::from_preset(Preset::StraightLine, 1);
    assert_eq!(predict(&plan).expect("a prediction").verdict, Verdict::Degenerate);
    let ends_m = [[50.0, -25.0], [114.0, -25.0]];
    let around = ends_m.into_iter().flat_map(|[x_m, y_m]| {
        (0..9).map(move |eighth| {
            let (sine, cosine) = (f64::from(eighth) * std::f64::consts::FRAC_PI_4).sin_cos();
            Waypoint::at(Vector2::new(x_m + 0.4 * cosine, y_m + 0.4 * sine))
        })
    });
    plan.way = vec![Piece::Waypoints(around.collect())];
    let predicted = predict(&plan).expect("a prediction");
    assert_eq!(predicted.verdict, Verdict::Good, "{:?}", predicted.findings);
}

#[test]
fn a_drive_that_holds_too_little_is_told_before_it_is_driven() {
    for (preset, verdict, told) in [
        (Preset::StraightLine, Verdict::Degenerate, ["straight line", "on the spot"]),
        (Preset::Circle, Verdict::Degenerate, ["circle", "figure-eight"]),
        (Preset::LShape, Verdict::Weak, ["l shape", "on the spot"]),
    ] {
        let found = predict(&Plan::from_preset(preset, 1)).expect("a prediction");
        assert_eq!(found.verdict, verdict, "{}", preset.name());
        let said: Vec<String> = found.findings.iter().map(ToString::to_string).collect();
        let advised = |line: &String| told.iter().all(|words| line.contains(words));
        assert!(said.iter().any(advised), "{}: {said:?}", preset.name());
        assert_eq!(found.held.is_none(), verdict == Verdict::Degenerate, "{}", preset.name());
        let seen = found.observability.expect("a rig");
        let free = seen.count(Hold::Free);
        let expected = match preset {
            Preset::StraightLine => 3,
            Preset::Circle => 1,
            _ => 0,
        };
        assert_eq!(free, expected, "{}", preset.name());
    }
}

#[test]
fn one_prism_is_planned_as_three() {
    let found = predict(&Plan::from_preset(Preset::SinglePrism, 1)).expect("a prediction");
    let held = found.held.expect("a winding drive");
    assert!((0.001..0.01).contains(&held.far_end.sigma_m), "{:?}", held.far_end);
    assert!(found.observability.is_none() && found.mirror_cost_ratio.is_none());
    let known = found.way.iter().filter(|at| at.position_sigma_m.is_some()).count();
    assert!(known > found.way.len() / 2, "{known} of {}", found.way.len());
    assert!(found.way.iter().all(|at| at.rotation_sigma_rad.is_none()));
}

/// The ratio of the mean squares of the published method's two solutions, with well-adjusted instruments.
#[test]
fn the_mirror_twin_costs_what_is_predicted() {
    for preset in [Preset::Warthog, Preset::UnevenGround, Preset::Hd2Tunnel] {
        let plan = as_drawn(preset);
        let predicted = predict(&plan).expect("a prediction").mirror_cost_ratio.expect("a twin");
        let simulated = simulate_scenario(&plan.scenario().expect("a plan"), 3);
        let deployment = resect_io::simulation_files::open(&simulated).expect("valid");
        let analysis = analyse(&deployment, &by(Method::InterPrism));
        let calibration = &analysis.answer.as_ref().expect("an answer").calibration;
        let mirror = &calibration.inter_prism().expect("method D").mirror;
        let found = mirror.cost_ratio.expect("a twin");
        println!("{}: {predicted:.2}, found {found:.2}", preset.name());
        let apart = (found - 1.0) / (predicted - 1.0);
        assert!((0.6..1.7).contains(&apart), "{}: {predicted} {found}", preset.name());
    }
}

/// Returns a plan rotated about the vertical and translated.
fn moved(plan: &Plan, turn: &Rotation2<f64>, by_m: &Vector3<f64>) -> Plan {
    let place = |at: Vector2<f64>| turn * at + by_m.xy();
    let mut moved = plan.clone();
    moved.ground.height_m += by_m.z;
    for at in &mut moved.stations_m {
        let level = place(at.xy());
        *at = Vector3::new(level.x, level.y, at.z + by_m.z);
    }
    let waypoints = plan.way.iter().flat_map(Piece::waypoints).map(|at| {
        let level = place(at.place_m());
        Waypoint { x_m: level.x, y_m: level.y, ..at }
    });
    moved.way = vec![Piece::Waypoints(waypoints.collect())];
    moved
}

fn eights() -> Plan {
    let eight = |x: f64, heading_rad: f64| {
        Piece::FigureEight(FigureEight {
            centre_m: [x, 10.0],
            length_m: 16.0,
            heading_rad,
            times: 1,
        })
    };
    Plan { way: vec![eight(40.0, 0.3), eight(60.0, 1.8)], ..Plan::default() }
}

#[test]
fn where_a_plan_lies_changes_nothing() {
    let plan = eights();
    let (turn, by_m) = (Rotation2::new(2.1), Vector3::new(-700.0, 1300.0, 55.0));
    let held = |plan: &Plan| predict(plan).expect("a prediction").held.expect("held");
    let (here, there) = (held(&plan), held(&moved(&plan, &turn, &by_m)));
    let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-3, "{a} and {b}");
    close(here.far_end.sigma_m, there.far_end.sigma_m);
    let expected = turn * here.far_end.position_m.xy() + by_m.xy();
    assert!((there.far_end.position_m.xy() - expected).norm() < 0.1);
    let mut level = Matrix3::identity();
    level.fixed_view_mut::<2, 2>(0, 0).copy_from(turn.matrix());
    for slot in [0, 4] {
        let turned = level * here.covariance.fixed_view::<3, 3>(slot, slot) * level.transpose();
        for axis in 0..3 {
            close(turned[(axis, axis)], there.covariance[(slot + axis, slot + axis)]);
        }
        close(here.covariance[(slot + 3, slot + 3)], there.covariance[(slot + 3, slot + 3)]);
    }
}

#[test]
fn stations_that_change_their_numbers_change_their_sigma() {
    let mut plan = eights();
    // With uncertain distances the tilts of the vehicle determine heights, and these depend on the times of the readings.
    plan.rig.inter_prism_sigma_m = 0.001;
    let mut other = plan.clone();
    other.stations_m.as_mut_slice().swap(1, 2);
    other.rig.prisms_m.as_mut_slice().swap(1, 2);
    let held = |plan: &Plan| predict(plan).expect("a prediction").held.expect("held");
    let (plan, other) = (held(&plan), held(&other));
    for k in 0..8 {
        let (own, swapped) =
            (plan.covariance[(k, k)], other.covariance[((k + 4) % 8, (k + 4) % 8)]);
        // Stations read at other times within a period then.
        assert!((own / swapped - 1.0).abs() < 0.05, "{k}: {own} and {swapped}");
    }
    assert_eq!(plan.far_end.station, 3 - other.far_end.station);
}

#[test]
fn stations_that_cannot_follow_are_told() {
    let mut plan = eights();
    // Prism 1 is in the line of sight to prism 2 whenever the vehicle approaches the stations.
    plan.rig.prisms_m[0].z = plan.rig.prisms_m[1].z;
    plan.rig.clearance_m = 0.15;
    plan.instrument.reach_m = [1.5, 62.0];
    plan.thresholds.tau_a_deg_per_s = 0.8;
    let found = predict(&plan).expect("a prediction");
    let failures = found.locks.iter().flat_map(|lock| &lock.failures);
    let why: Vec<WhyNotRead> = failures.map(|failure| failure.why).collect();
    assert!(why.contains(&WhyNotRead::TooFar), "{why:?}");
    assert!(why.iter().any(|why| matches!(why, WhyNotRead::Hidden(_))), "{why:?}");
    assert!(why.iter().any(|why| matches!(why, WhyNotRead::TooFast(_))), "{why:?}");
    let said: Vec<String> = found.findings.iter().map(ToString::to_string).collect();
    for part in
        ["is out of reach (1.5 to 62 m)", "blocks the line of sight", "faster than τ_a (0.8°/s)"]
    {
        assert!(said.iter().any(|line| line.contains(part)), "{part} in {said:?}");
    }
    plan.instrument.reach_m = [1.5, 20.0];
    let error = predict(&plan).expect_err("out of reach").to_string();
    assert!(error.contains("plan the path within reach"), "{error}");
}

#[test]
fn a_plan_is_written_as_it_is_read() {
    let mut plan = eights();
    plan.name = "yard \"north\"".to_owned();
    plan.ground.ramps.push(Ramp { centre_m: [50.0, 3.0], radius_m: 4.0, height_m: 0.4 });
    plan.way.push(Piece::Loop(Loop {
        centre_m: [70.0, 0.0],
        radius_m: 6.0,
        from_rad: 0.0,
        turns: -1.5,
    }));
    let waypoint =
        |speed_m_per_s, stand_s| Waypoint { x_m: 1.5, y_m: -2.0, speed_m_per_s, stand_s };
    plan.way.push(Piece::Waypoints(vec![
        waypoint(None, 0.0),
        waypoint(Some(0.5), 0.0),
        waypoint(None, 12.0),
        waypoint(Some(0.5), 12.0),
    ]));
    let text = plan_file::text(&plan);
    assert_eq!(plan_file::parse("plan.toml", &text).expect("own text"), plan, "{text}");
}

#[test]
fn the_plan_of_the_readme_is_a_good_one() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/plan.toml");
    let plan = plan_file::read(&path).expect("a plan");
    assert_eq!(plan.way.len(), 3);
    let found = predict(&plan).expect("a prediction");
    assert_eq!(found.verdict, Verdict::Good, "{:?}", found.findings);
    let far_end_mm = found.held.expect("held").far_end.sigma_m * 1e3;
    assert!(far_end_mm < plan.target_mm, "{far_end_mm}");
}

#[test]
fn a_plan_that_makes_no_sense_is_told_with_its_place() {
    let good = "stations_m = [[0, 0, 0], [5, -2.6, -0.3], [-5, 0.4, -0.2]]\n\n[[way]]\nwaypoints = [[40, 0], [60, 0, 0.5], [60, 20]]\n";
    plan_file::parse("plan.toml", good).expect("a plan");
    for (from, to, said) in [
        ("[[way]]", "[[ways]]", "plan.toml:3: unknown field `ways`"),
        ("[60, 0, 0.5]", "[60]", "plan.toml:4: a waypoint is [x, y], [x, y, speed]"),
        ("[60, 0, 0.5]", "[60, 0, -0.5]", "speed of -0.5 m/s; give 0.01 to 20 m/s"),
        ("[5, -2.6, -0.3]", "[0, 0, 0]", "stations 1 and 2 have the same position"),
        ("[5, -2.6, -0.3]", "[5, -2.6]", "plan.toml:1: "),
        ("[40, 0], [60, 0, 0.5], [60, 20]", "[40, 0]", "the way is 0.0 m long"),
        ("\n[[way]]", "[instrument]\nrate_hz = 0\n[[way]]", "rate_hz is 0; give 0.5 to 50"),
        ("\n[[way]]", "[instrument]\nrate = 2\n[[way]]", "plan.toml:3: unknown field `rate`"),
        ("[40, 0]", "[nan, 0]", "a waypoint has no valid position"),
        ("waypoints = ", "eights = ", "plan.toml:4: unknown variant `eights`"),
    ] {
        assert!(good.contains(from), "{from}");
        let error = plan_file::parse("plan.toml", &good.replace(from, to)).expect_err(said);
        assert!(error.to_string().contains(said), "{error} instead of {said}");
    }
}

/// Returns the improvement of one kind with the largest gain.
#[track_caller]
fn best(plan: &Plan, kind: ImprovementKind) -> (Plan, f64) {
    let all = improvements(plan, &Progress::default()).expect("improvements");
    assert!(all.is_sorted_by(|a, b| a.after_m <= b.after_m), "ranked");
    let best = all.into_iter().find(|one| one.kind == kind).expect("one of this kind");
    (best.plan, best.after_m / best.before_m.expect("nothing was free"))
}

#[test]
fn what_improves_a_plan_improves_its_drives() {
    let plan = as_drawn(Preset::FigureEight);
    let far_end_m = |plan: &Plan| {
        let prediction = predict(plan).expect("a prediction");
        let one = |seed| Some(realised(plan, &prediction, seed)?.far_end_m);
        rms((0..20).into_par_iter().filter_map(one).collect::<Vec<_>>())
    };
    let before_m = far_end_m(&plan);
    for kind in [ImprovementKind::PrismHeight, ImprovementKind::Ramp] {
        let (better, predicted) = best(&plan, kind);
        let found = far_end_m(&better) / before_m;
        println!("{}: {predicted:.2}, found {found:.2}", kind.name());
        assert!(predicted < 0.9 && found < 0.95, "{}: {predicted} {found}", kind.name());
        assert!((0.7..1.3).contains(&(found / predicted)), "{}: {found}", kind.name());
    }
}

#[test]
fn a_line_is_improved_by_leaving_it() {
    let all = improvements(&Plan::from_preset(Preset::StraightLine, 1), &Progress::default())
        .expect("improvements");
    let eight = all.iter().find(|one| one.kind == ImprovementKind::FigureEight);
    let eight = eight.expect("a figure-eight");
    assert_eq!(eight.before_m, None, "a line leaves directions free");
    assert!(eight.sentence.contains("at the far end: not determined → "), "{}", eight.sentence);
    assert!((20.0..150.0).contains(&eight.more_s), "{}", eight.more_s);
    let found = predict(&eight.plan).expect("a prediction");
    assert!(found.held.is_some());
}

/// A recorded path shows the room of the place; a drawn line shows nothing.
#[test]
fn a_recorded_path_through_a_tunnel_is_improved_within_its_width() {
    let drawn = Plan::from_preset(Preset::StraightLine, 1);
    let driven = Plan { is_driven: true, ..drawn.clone() };
    let kinds = |plan: &Plan| -> Vec<ImprovementKind> {
        improvements(plan, &Progress::default())
            .expect("improvements")
            .iter()
            .map(|one| one.kind)
            .collect()
    };
    let wide = [ImprovementKind::FigureEight, ImprovementKind::Loop];
    let (of_drawn, of_driven) = (kinds(&drawn), kinds(&driven));
    assert!(of_drawn.contains(&wide[0]), "{of_drawn:?}");
    assert!(!of_driven.iter().any(|kind| wide.contains(kind)), "{of_driven:?}");
    for kinds in [of_drawn, of_driven] {
        assert!(kinds.contains(&ImprovementKind::TurnOnTheSpot), "{kinds:?}");
    }
    let circle = Plan { is_driven: true, ..Plan::from_preset(Preset::Circle, 1) };
    assert!(kinds(&circle).contains(&wide[0]), "an open field has room");
}

/// A station whose azimuth increases in the wrong sense leaves no position for a plan; a plan names a doubtful calibration.
#[test]
fn a_plan_is_made_of_no_answer_that_does_not_know_where_stations_stand() {
    let simulated = simulate_scenario(&Preset::Warthog.scenario(), 2);
    let sound = resect_io::simulation_files::open(&simulated).expect("valid");
    let of = |deployment| Plan::from_analysis(deployment, &analyse(deployment, &by(Method::Joint)));
    assert_eq!(of(&sound).expect("a plan").name, sound.name);
    let mut reversed = sound.clone();
    for reading in &mut reversed.tracks[1].measurements {
        reading.azimuth_rad = -reading.azimuth_rad;
    }
    let why = of(&reversed).expect_err("no plan").to_string();
    // Contradictory readings may end anywhere.
    assert!(why.contains("station positions are unknown"), "{why}");
    let mut without = sound.clone();
    without.tracks[2].measurements.clear();
    let why = of(&without).expect_err("no plan").to_string();
    assert_eq!(why.matches(&sound.name).count(), 1, "{why}");
    let mut late = sound.clone();
    late.tracks[2].measurements.iter_mut().for_each(|reading| reading.time_s += 0.8);
    let plan = of(&late).expect("a plan");
    assert!(plan.name.contains("from a weak calibration"), "{}", plan.name);
}
