//! Validation of a calibration on another run: simulated pairs of runs of one set-up, and inconclusive runs.

use resect_core::deployment::kinds;
use std::sync::{Arc, LazyLock};

use crate::common::{analyse, answer, by, field_data, knock, of_field, two_runs};
use nalgebra::Vector3;
use rayon::prelude::*;
use resect_core::analysis::{Analysis, Settings};
use resect_core::calibration::distance_errors_m;
use resect_core::calibration::{Method, Verdict};
use resect_core::deployment::{Deployment, TrackFrame};
use resect_io::open::open;
use resect_tools::simulation::{Preset, Settling, simulate};
use resect_tools::validation::{Cause, Earlier, Outcome, Validation, drive_alone, validate};

/// Returns two opened runs of one set-up.
fn runs(preset: Preset, seed: u64, between: &[Settling]) -> [Deployment; 2] {
    two_runs(preset.scenario(), seed, between)
        .map(|run| resect_io::simulation_files::open(&run).expect("valid"))
}

fn earlier(deployment: &Deployment, settings: &Settings) -> Earlier {
    Earlier::of(deployment, answer(&analyse(deployment, settings)))
}

/// Returns the calibration of a run that is to be validated.
fn own(deployment: &Deployment) -> Analysis {
    analyse(&drive_alone(&Arc::new(deployment.clone())), &Settings::default())
}

fn validated(runs: &[Deployment; 2]) -> Validation {
    let [first, second] = runs;
    validate(&earlier(first, &Settings::default()), second, &own(second))
}

/// Asserts that this station moved, with each component of its motion within 3 σ of the truth.
#[track_caller]
fn assert_moved(found: &Validation, knock: &Settling) {
    let said = found.to_string();
    assert_eq!(found.outcome, Outcome::DoesNotHold(Cause::Station(knock.station)), "{said}");
    let moved = &found.difference.as_ref().expect("σ").stations[knock.station];
    let truth = [knock.move_m.x, knock.move_m.y, knock.move_m.z, knock.turn_rad];
    for (part, truth) in truth.into_iter().enumerate() {
        let sigmas = moved.part(part).sigmas_from(truth);
        assert!(sigmas.abs() < 3.0, "part {part} is {sigmas:.1} σ off: {said}");
    }
    assert!(said.contains(&format!("station {} turned by", knock.station + 1)), "{said}");
}

/// Two runs of the Warthog, the calibration of the first, and the analysis of the second.
static SAMPLE: LazyLock<([Deployment; 2], Earlier, Analysis)> = LazyLock::new(|| {
    let runs = runs(Preset::Warthog, 3, &[]);
    let before = earlier(&runs[0], &Settings::default());
    let own = own(&runs[1]);
    (runs, before, own)
});

#[test]
fn where_nothing_moved_it_holds_and_says_what_would_have_shown() {
    let ([_, second], before, own) = &*SAMPLE;
    let found = validate(before, second, own);
    let said = found.to_string();
    assert_eq!(found.outcome, Outcome::Holds, "{said}");
    assert!(said.contains("minimal detectable displacement"), "{said}");
    let metric = found.metric.expect("a rig is there");
    assert!(!metric.is_worse() && metric.earlier_mm.median < 1.5 * metric.own_mm.median);
    // Both metrics refer to the measured distances, as in the calibration's own evaluation.
    let evaluation = &answer(own).evaluation;
    assert_eq!(Some(metric.own_mm), evaluation.against_measured_mm);
}

#[test]
fn a_station_that_was_turned_or_moved_is_named_with_its_size() {
    let knocks = [
        knock(1, 0.3e-3, [0.0; 3]),
        knock(1, 0.0, [0.008, -0.006, 0.0]),
        knock(2, -0.4e-3, [0.005, 0.0, 0.0]),
        knock(0, 0.3e-3, [0.0; 3]),
        knock(0, 0.0, [0.006, 0.008, 0.0]),
        // Far enough that a rotation of station 1 has a large effect.
        knock(0, 20e-3, [0.05, -0.1, 0.02]),
    ];
    knocks.par_iter().for_each(|knock| {
        let runs = runs(Preset::Warthog, 3, &[*knock]);
        let found = validated(&runs);
        eprintln!("{found}");
        assert_moved(&found, knock);
        // A rotation has its effect far from the station, where the prisms show it as well.
        let metric = found.metric.expect("a rig is there");
        assert!(metric.is_worse() || knock.turn_rad == 0.0, "{metric}");
    });
}

#[test]
fn two_stations_that_moved_are_not_taken_for_one() {
    let knocks = [knock(1, 1e-3, [0.0, 0.02, 0.0]), knock(2, -1e-3, [0.02, 0.0, 0.01])];
    let found = validated(&runs(Preset::Warthog, 3, &knocks));
    assert_eq!(found.outcome, Outcome::DoesNotHold(Cause::NoneAlone), "{found}");
}

/// With random errors of real instruments for each seed, settling tripods included.
#[test]
fn a_calibration_that_holds_is_hardly_ever_said_not_to() {
    let outcomes: Vec<Outcome> = (0..40_u64)
        .into_par_iter()
        .map(|seed| {
            let found = validated(&runs(Preset::FieldErrors, 1000 + seed, &[]));
            eprintln!("{seed}: {found}");
            found.outcome
        })
        .collect();
    let count = |name: &str| outcomes.iter().filter(|outcome| outcome.name() == name).count();
    let (held, alarms, untold) = (count("holds"), count("does not hold"), count("inconclusive"));
    eprintln!("{held} hold, {alarms} do not, {untold} inconclusive");
    assert!(alarms <= 2, "{alarms} false alarms");
    assert!(held >= 24, "only {held} hold");
}

#[test]
fn what_is_said_of_the_metric_is_what_the_distances_do() {
    let (mut before, own) = (SAMPLE.1.clone(), &SAMPLE.2);
    before.station1_from_station[1].translation_m.x += 0.004;
    before.station1_from_station[2].translation_m += Vector3::new(0.003, -0.002, 0.001);
    let found = validate(&before, &SAMPLE.0[1], own);
    let answer = answer(own);
    let rig = SAMPLE.0[1].rig.as_ref().expect("a rig");
    let known_m = &rig.inter_prism_m;
    let followed = &own.offer.followed;
    let [ours, theirs] = [&answer.calibration.station1_from_station, &before.station1_from_station]
        .map(|transforms| distance_errors_m(&answer.triplets, transforms, followed, known_m));
    let squares: Vec<f64> = (0..3)
        .flat_map(|pair| ours[pair].iter().zip(&theirs[pair]).map(|(a, b)| (a - b).powi(2)))
        .collect();
    let apart_m = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    let metric = found.metric.expect("a rig is there");
    assert!((metric.apart_m / apart_m - 1.0).abs() < 0.02, "{} {apart_m}", metric.apart_m);
}

#[test]
fn one_prism_tells_as_well() {
    let knock = knock(2, 0.5e-3, [0.0; 3]);
    let holds = validated(&runs(Preset::SinglePrism, 5, &[]));
    assert_eq!(holds.outcome, Outcome::Holds, "{holds}");
    assert_moved(&validated(&runs(Preset::SinglePrism, 5, &[knock])), &knock);
}

/// Control points that were measured before a station moved show the change; the motion is detected nevertheless.
#[test]
fn control_points_do_not_stand_in_the_way() {
    let knock = knock(1, 2e-3, [0.0; 3]);
    let [_, second] = runs(Preset::Warthog, 3, &[knock]);
    let analysis = analyse(&second, &Settings::default());
    let findings = &answer(&analysis).calibration.findings;
    let changes = [kinds::SET_UP_CHANGED, kinds::SET_UP_CHANGE_UNDECIDED];
    assert!(findings.iter().any(|finding| changes.contains(&finding.kind)), "{findings:?}");
    assert_moved(&validate(&SAMPLE.1, &second, &own(&second)), &knock);
}

#[track_caller]
fn assert_untold(found: &Validation, why: &str) {
    let said = found.to_string();
    assert!(matches!(found.outcome, Outcome::CannotBeTold(_)), "{said}");
    assert!(said.contains(why), "`{why}` is not in: {said}");
}

#[test]
fn a_run_that_cannot_see_says_so() {
    let ([_, second], before, own) = &*SAMPLE;
    // A run with a weak calibration, one without any, and an earlier calibration that failed.
    let line = resect_io::simulation_files::open(&simulate(Preset::LShape, 1)).expect("valid");
    let weak = analyse(&line, &Settings::default());
    assert_untold(&validate(before, &line, &weak), "the run's own calibration is");
    let mut unknown = second.clone();
    unknown.rig = None;
    let none = analyse(&unknown, &Settings::default());
    assert_untold(&validate(before, &unknown, &none), "inter-prism distances are not known");
    let free = Earlier { verdict: Verdict::Degenerate, covariance: None, ..before.clone() };
    assert_untold(&validate(&free, second, own), "the earlier calibration is degenerate");
    let without = Earlier { covariance: None, ..before.clone() };
    assert_untold(&validate(&without, second, own), "has no σ");
    let ambiguous = Earlier { verdict: Verdict::Ambiguous, ..before.clone() };
    assert_untold(&validate(&ambiguous, second, own), "the earlier calibration is ambiguous");
    // Calibrations that agree, one of which is too uncertain.
    let coarse =
        Earlier { covariance: before.covariance.as_ref().map(|c| c * 1e3), ..before.clone() };
    assert_untold(&validate(&coarse, second, own), "too large to detect");
    let other_frame = Earlier { track_frame: Some(TrackFrame::Common), ..before.clone() };
    assert_untold(&validate(&other_frame, second, own), "different frames");
}

#[test]
fn what_looks_like_a_move_and_is_none_is_said() {
    let ([_, second], before, own) = &*SAMPLE;
    let caveat = |earlier: &Earlier, words: &str| {
        let found = validate(earlier, second, own);
        let said: Vec<_> = found.caveats.iter().map(ToString::to_string).collect();
        assert!(said.iter().any(|line| line.contains(words)), "`{words}` is not in {said:?}");
        found.outcome
    };
    assert_eq!(validate(before, second, own).caveats, []);
    let mut rig = before.clone();
    rig.inter_prism_m.as_mut().expect("a rig")[1] += 0.02;
    assert_eq!(caveat(&rig, "prisms 1–3 were"), Outcome::Holds);
    let doubt = Some("something".to_owned());
    let weak = Earlier { verdict: Verdict::Weak, doubt, ..before.clone() };
    assert_eq!(caveat(&weak, "the earlier calibration is weak: something"), Outcome::Holds);
    let by_d = Earlier { method: Method::InterPrism, ..before.clone() };
    caveat(&by_d, "the earlier calibration is by method D");
    let mut elsewhere = before.clone();
    elsewhere.station1_from_station[2].translation_m.y += 2.0;
    let found = validate(&elsewhere, second, own);
    assert_eq!(found.outcome, Outcome::DoesNotHold(Cause::OtherSetUp), "{found}");
}

#[test]
fn the_calibration_of_a_field_run_holds_for_that_run() {
    for name in ["2022-07-11-2", "2022-07-11-2-published"] {
        let Some(path) = field_data(name) else { return };
        let deployment = open(&path).expect("opens");
        let drive = drive_alone(&Arc::new(deployment.clone()));
        let found =
            validate(&earlier(&drive, &Settings::default()), &deployment, &own(&deployment));
        assert_eq!(found.outcome, Outcome::Holds, "{name}: {found}");
        let difference = found.difference.expect("σ");
        assert!(difference.chi_square < 1e-12, "{name}: {}", difference.chi_square);
    }
}

/// The authors' control points and their drive disagree by 0.87 mrad about station 2 (`../shared/datasets/README.md`).
#[test]
#[cfg_attr(not(field_data), ignore = "needs ../shared/datasets")]
fn field_control_points_do_not_hold_for_the_drive_because_of_station_2() {
    let path = of_field("2022-07-11-2");
    let deployment = open(&path).expect("opens");
    let by_points = earlier(&deployment, &by(Method::StaticGcp));
    let found = validate(&by_points, &deployment, &own(&deployment));
    assert_eq!(found.outcome, Outcome::DoesNotHold(Cause::Station(1)), "{found}");
    let turned = found.difference.expect("σ").stations[1].turned_rad();
    assert!((turned.value - 0.86e-3).abs() < 3.0 * turned.sigma, "{turned:?}");
}
