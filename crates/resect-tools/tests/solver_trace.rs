//! Tests of the trace: its rows and events, and each status of a failure.

use resect_core::deployment::kinds;
use std::sync::Arc;

use resect_core::analysis::{Analyst, Settings};
use resect_core::calibration::joint::{DriveReadings, JointInput, Layout, RigDistances, estimate};
use resect_core::calibration::joint::{SolverPhase, SolverStatus, Trace, TraceEvent};
use resect_core::calibration::{Calibration, ErrorSizes, Verdict};
use resect_core::deployment::{Deployment, FindingKind};
use resect_core::network::{PerPair, Prism};
use resect_core::pipeline::Triplets;
use resect_core::progress::Progress;
use resect_tools::simulation::{Preset, simulate, simulate_scenario};

fn calibrate(deployment: Deployment, settings: &Settings) -> Calibration {
    let analysis = Analyst::new(deployment.into()).run(settings);
    analysis.answer.expect("an answer").calibration.clone()
}

/// Calibrates with settling of the stations in these multiples of the usual size.
fn calibrate_with_settling(preset: Preset, multiple: f64) -> Calibration {
    let mut settings = Settings::default();
    settings.calibration.errors.settling_m *= multiple;
    settings.calibration.errors.settling_rad *= multiple;
    calibrate(simulate(preset, 1).readings(), &settings)
}

/// Asserts that the published method answers for this reason, and returns the trace.
#[track_caller]
fn assert_failed(calibration: &Calibration, status: SolverStatus, kind: FindingKind) -> &Trace {
    let trace = calibration.trace().expect("a trace");
    assert_eq!(trace.status, status);
    assert!(calibration.joint().is_none() && calibration.verdict >= Verdict::Weak);
    let mut kinds = calibration.findings.iter().map(|finding| finding.kind);
    assert!(kinds.any(|own| own == kind), "{:?}", calibration.findings);
    trace
}

/// Estimates from a start that is this far from the truth along x (m).
fn trace_from(triplets: &Triplets, off_m: f64) -> Trace {
    let truth = simulate(Preset::SinglePrism, 1).truth.station1_from_station;
    let mut published = truth;
    for station in published.iter_mut().skip(1) {
        station.translation_m.x += off_m;
    }
    let layout = Layout::new(&published.map(|_| Prism::default()));
    let input = JointInput {
        layout: &Arc::new(layout),
        published: &published,
        rig: RigDistances::exact(PerPair::default()),
        survey: None,
        is_determined_by_drive: true,
        sizes: &ErrorSizes::default(),
    };
    let estimate = estimate(&DriveReadings::of_triplets(triplets), &input, &Progress::default());
    estimate.expect("not cancelled").map_or_else(|trace| trace, |estimate| estimate.trace)
}

#[test]
fn a_good_drive_converges_with_falling_costs_and_two_searches() {
    let scenario = Preset::SinglePrism.scenario().with_field_errors(1);
    let calibration = calibrate(simulate_scenario(&scenario, 1).readings(), &Settings::default());
    let trace = calibration.trace().expect("a trace");
    assert_eq!(trace.status, SolverStatus::Converged);
    let phases: Vec<SolverPhase> = trace.rows.iter().map(|row| row.phase).collect();
    assert_eq!(phases[0], SolverPhase::Motion);
    assert_eq!(phases.last(), Some(&SolverPhase::FixedWeights));
    let reweighted = trace.rows.iter().filter(|row| row.phase == SolverPhase::Reweighted);
    let costs: Vec<f64> = reweighted.filter_map(|row| row.cost).collect();
    assert!(costs.len() > 1 && costs.is_sorted_by(|before, after| before > after), "{costs:?}");
    let last = trace.rows.last().and_then(|row| row.squared_length);
    assert!(last.is_some_and(|length| length < 4e-3), "{last:?}");
    let searches = trace.events().filter(|event| matches!(event, TraceEvent::Search(_)));
    assert!(searches.count() >= 2);
    assert_eq!(trace.events().next(), Some(&TraceEvent::BlockLength(6.0)));
    assert!(trace.events().any(|event| *event == TraceEvent::WeightsFixed));
    assert!(trace.last_events.is_empty());
}

#[test]
fn a_start_far_from_the_solution_needs_too_many_steps() {
    let deployment = simulate(Preset::SinglePrism, 1).readings();
    let analysis = Analyst::new(deployment.into()).run(&Settings::default());
    let trace = trace_from(analysis.triplets(), 60.0);
    assert_eq!(trace.status, SolverStatus::TooManySteps);
    assert!(trace.rows.len() > 40);
    assert_eq!(trace.last_events, [TraceEvent::Failed(trace.status)]);
}

#[test]
fn absurd_priors_leave_the_normal_matrix_singular() {
    let calibration = calibrate_with_settling(Preset::SinglePrism, 1e12);
    let kind = kinds::JOINT_ESTIMATE_UNDETERMINED;
    let trace = assert_failed(&calibration, SolverStatus::NotDefinite, kind);
    let lengths = trace.events().filter(|event| matches!(event, TraceEvent::BlockLength(_)));
    assert_eq!(lengths.count(), 3);
}

#[test]
fn an_estimate_by_tighter_priors_is_not_the_answer() {
    let calibration = calibrate_with_settling(Preset::SinglePrism, 1e6);
    let (status, kind) = (SolverStatus::StifferPriors, kinds::PRIORS_TIGHTENED);
    let trace = assert_failed(&calibration, status, kind);
    assert!(trace.events().any(|event| *event == TraceEvent::StifferPriors));
}

#[test]
fn an_estimate_far_from_its_start_has_not_converged() {
    let deployment = simulate(Preset::SinglePrism, 1).readings();
    let analysis = Analyst::new(deployment.into()).run(&Settings::default());
    assert_eq!(trace_from(analysis.triplets(), 0.0).status, SolverStatus::Converged);
    let far = trace_from(analysis.triplets(), 200.0).status;
    assert!(matches!(far, SolverStatus::Diverged | SolverStatus::TooManySteps), "{far:?}");
}

#[test]
fn without_readings_there_are_no_steps() {
    let trace = trace_from(&Triplets::default(), 0.0);
    assert_eq!(trace, Trace { status: SolverStatus::NoReadings, ..Trace::default() });
}
