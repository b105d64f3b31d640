//! The coach on growing simulated drives: it never reports sufficient data too early, and reports faults.

use resect_live::kinds;
use resect_live::warnings::Warning;
use std::sync::Arc;

use resect_core::analysis::{Analyst, Settings};
use resect_core::deployment::{Deployment, Overrides};
use resect_io::growing::Growing;
use resect_live::event::Event;
use resect_live::judged::judge;
use resect_live::{Engine, View, bonn, replay};
use resect_tools::simulation::{Preset, Scenario, Settling, Simulated, simulate_scenario};

use crate::common::knock;

const TARGET_M: f64 = 6e-3;

/// Replays a deployment as a stream, with a calibration every `every_s` seconds; calls back with each view.
fn drive(deployment: &Deployment, every_s: f64, mut seen: impl FnMut(&View) -> bool) {
    let growing = Growing::of_readings_again(deployment.clone(), &Overrides::default());
    let mut engine = Engine::new(growing, Some(1.0), None, TARGET_M);
    engine.take(Event::Connected("simulated".to_owned()), 0.0);
    engine.take(Event::Channel(bonn::BonnProtocol::channel()), 0.0);
    let settings = Settings::default();
    let (mut next_s, mut first_s) = (every_s, None);
    for sent in replay::messages(deployment, &[0.01; 3].into()) {
        let clock_s = sent.received_s - *first_s.get_or_insert(sent.received_s);
        engine.take(Event::Message(sent), clock_s);
        if clock_s < next_s {
            continue;
        }
        next_s += every_s;
        let Some(Ok(snapshot)) = engine.snapshot() else { continue };
        let snapshot = Arc::new(snapshot);
        let mut analyst = Analyst::new(Arc::clone(&snapshot));
        let known = engine.known();
        let published = analyst.run_published_while(&settings, &Default::default());
        if let Ok(Some(published)) = published {
            engine.judged(judge(&snapshot, &published, true, known.as_deref()), clock_s);
        }
        let analysis = analyst.run(&settings);
        engine.judged(judge(&snapshot, &analysis, false, known.as_deref()), clock_s);
        if !seen(&engine.view(clock_s)) {
            break;
        }
    }
}

/// Returns the error of the prism's position at the far end of the track (m).
fn realised_m(view: &View, simulated: &Simulated) -> f64 {
    let judged = view.answer.as_ref().expect("an answer");
    let far_end = judged.far_end.expect("nothing is free");
    let found = &judged.station1_from_station[far_end.station];
    let in_station_m = found.inverse().apply(&far_end.position_m);
    // Stations settle: the truth is their mean position.
    let truth = simulated.station1_from_station_at(0.5 * view.driven_s)[far_end.station];
    (truth.apply(&in_station_m) - far_end.position_m).norm()
}

fn warthog(duration_s: f64) -> Scenario {
    Scenario { duration_s, ..Preset::Warthog.scenario() }
}

#[test]
fn enough_is_not_said_before_the_error_is_within_three_sigma_of_the_target() {
    let mut said = 0;
    for seed in 0..6 {
        let scenario = Scenario { duration_s: 400.0, ..Preset::FieldErrors.scenario() };
        let simulated = simulate_scenario(&scenario, seed);
        let deployment = resect_io::simulation_files::open(&simulated).expect("valid");
        drive(&deployment, 40.0, |view| {
            if view.enough {
                let realised_m = realised_m(view, &simulated);
                assert!(
                    realised_m < 3.0 * TARGET_M,
                    "seed {seed}, after {:.0} s: {:.1} mm",
                    view.driven_s,
                    realised_m * 1e3
                );
                eprintln!(
                    "seed {seed}: enough after {:.0} s, off by {:.1} mm",
                    view.driven_s,
                    realised_m * 1e3
                );
                said += 1;
            }
            !view.enough
        });
    }
    assert!(said >= 3, "only {said} of 6 drives were enough: that tells little");
}

#[test]
fn a_straight_line_is_said_and_is_never_enough() {
    let scenario = Scenario { duration_s: 120.0, ..Preset::StraightLine.scenario() };
    let deployment =
        resect_io::simulation_files::open(&simulate_scenario(&scenario, 1)).expect("valid");
    let mut last = View::default();
    drive(&deployment, 40.0, |view| {
        assert!(!view.enough, "{}", view.sentence);
        last = view.clone();
        true
    });
    let is_line = |w: &Warning| w.finding.kind == kinds::LIVE_STRAIGHT_LINE;
    assert!(last.warnings.iter().any(is_line), "{:?}", last.warnings);
    assert!(last.sentence.contains("on the spot"), "{}", last.sentence);
}

#[test]
fn a_station_that_was_knocked_is_said_and_ends_what_was_enough() {
    let mut scenario = warthog(360.0);
    let knocked = Settling { from_s: 200.0, ..knock(1, 2e-3, [0.03, 0.0, 0.0]) };
    scenario.errors.settling.push(knocked);
    let deployment =
        resect_io::simulation_files::open(&simulate_scenario(&scenario, 2)).expect("valid");
    let mut last = View::default();
    drive(&deployment, 60.0, |view| {
        last = view.clone();
        true
    });
    let is_step = |w: &&Warning| w.finding.kind == kinds::LIVE_STEPPED;
    let told = last.warnings.iter().find(is_step).expect("it is said");
    assert!(told.finding.is_about_station(1), "{told:?}");
    assert!(!last.enough, "{}", last.sentence);
}

#[test]
fn a_prism_of_another_station_is_said_while_it_is_followed() {
    let simulated = simulate_scenario(&warthog(200.0), 3);
    let mut deployment = resect_io::simulation_files::open(&simulated).expect("valid");
    // From 150 s on, station 3 tracks a prism two metres beside its own.
    let from_s = deployment.start_s().expect("readings") + 150.0;
    for reading in &mut deployment.tracks[2].measurements {
        if reading.time_s > from_s {
            reading.range_m += 2.0;
        }
    }
    let mut told = Vec::new();
    drive(&deployment, 10.0, |view| {
        told.extend(view.warnings.iter().cloned());
        view.driven_s < 185.0
    });
    let wrong: Vec<&Warning> =
        told.iter().filter(|w| w.finding.kind == kinds::LIVE_WRONG_PRISM).collect();
    assert!(!wrong.is_empty(), "{told:?}");
    assert!(wrong.iter().all(|w| w.finding.is_about_station(2) && w.since_s > from_s), "{wrong:?}");
}
