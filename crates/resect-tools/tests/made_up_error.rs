//! A made-up error of the instruments, all in this file: it is simulated, estimated and listed like those of the table of unknowns.

use std::f64::consts::TAU;
use std::sync::Arc;

use resect_core::calibration::joint::instrument_errors::instrument_errors;
use resect_core::calibration::joint::unknown::{
    Effect, Owner, PriorSize, ReadingError, UNKNOWNS, Unknown,
};
use resect_core::calibration::joint::{
    DriveReadings, JointEstimate, JointInput, Layout, RigDistances, estimate,
};
use resect_core::calibration::{ErrorSizes, Quantity};
use resect_core::deployment::Rig;
use resect_core::network::{Number, PerStation, Prism, PrismSchedule};
use resect_core::pipeline;
use resect_core::pipeline::PipelineSettings;
use resect_core::progress::Progress;
use resect_tools::simulation::{FurtherError, Preset, simulate_scenario};

/// Wavelength of the cyclic error of a distance meter (m).
const WAVELENGTH_M: f64 = 10.0;
const PRIOR_SIGMA_M: f64 = 0.010;

/// The amplitude of a range error that repeats with the range.
static CYCLIC: Unknown = Unknown {
    name: "cyclic error",
    symbol: "c",
    quantity: Quantity::Length,
    key: Some("cyclic_errors_m"),
    owner: Owner::Station,
    source: "cyclic errors",
    prior: Some(PriorSize { sigma: |_| PRIOR_SIGMA_M, least: 1e-6 }),
    effect: Effect::Reading(ReadingError {
        correction_m: |sight| -sight.along * (TAU * sight.range_m / WAVELENGTH_M).sin(),
        is_of_pointing: false,
    }),
    sentence: "station {}'s ranges have a cyclic error of",
};

/// Estimates a simulated drive whose ranges have cyclic errors of these amplitudes (m).
fn estimated(amplitudes_m: &PerStation<f64>) -> JointEstimate {
    let mut scenario = Preset::Warthog.scenario();
    let error = FurtherError { unknown: &CYCLIC, sizes: amplitudes_m.clone() };
    scenario.errors.further.push(error);
    let simulated = simulate_scenario(&scenario, 5);
    let triplets = pipeline::run(&simulated.readings(), &PipelineSettings::default()).triplets;
    let table: Vec<&'static Unknown> = UNKNOWNS.into_iter().chain([&CYCLIC]).collect();
    let followed = amplitudes_m.map_each(|station, _| Prism::at(station.index()));
    let layout = &Arc::new(Layout::with_unknowns(&PrismSchedule::constant(followed), &table));
    let inter_prism_m = simulated.truth.inter_prism_m.clone();
    let rig = Rig { inter_prism_m, prisms_m: None, in_vehicle_m: None, inter_antenna_m: None };
    let input = JointInput {
        layout,
        published: &simulated.truth.station1_from_station,
        rig: RigDistances::new(&rig, layout, true),
        survey: None,
        is_determined_by_drive: true,
        sizes: &ErrorSizes::default(),
    };
    let result = estimate(&DriveReadings::of_triplets(&triplets), &input, &Progress::default());
    result.expect("not cancelled").expect("it converges")
}

#[test]
fn a_row_of_the_table_is_estimated_listed_and_simulated() {
    let amplitudes_m = PerStation::from([0.004, -0.003, 0.0]);
    let joint = estimated(&amplitudes_m);
    let listed = instrument_errors(&joint);
    let own: Vec<_> = listed.iter().filter(|error| error.unknown.name == CYCLIC.name).collect();
    assert_eq!(own.len(), amplitudes_m.len());
    for (error, amplitude_m) in own.iter().zip(&amplitudes_m) {
        let found = error.estimate;
        assert!(found.sigma < 0.2 * PRIOR_SIGMA_M, "{found:?}");
        assert!(found.sigmas_from(*amplitude_m).abs() < 4.0, "{found:?} for {amplitude_m}");
        assert_eq!(error.is_significant(), *amplitude_m != 0.0, "{found:?}");
    }
    assert!(joint.budget.iter().any(|(source, _)| *source == CYCLIC.source));
}
