//! Findings of biases that are stated to be detectable, of mistakes at control points, and false alarms by the rate of readings.

use rayon::prelude::*;
use resect_core::calibration::joint::reliability::GroupKind;
use resect_core::calibration::{Calibration, Method, Verdict};
use resect_core::deployment::{Deployment, Severity, kinds};
use resect_core::geometry::Polar;
use resect_core::network::{Number, Station};
use resect_tools::simulation::{ErrorKind, Preset, Scenario, simulate_scenario};

use super::scenario_with;
use crate::common::{analyse, answer, by};

/// A drive with all errors but clock jumps.
fn deployment(preset: Preset, seed: u64, change: impl FnOnce(&mut Scenario)) -> Deployment {
    let kinds: Vec<ErrorKind> =
        ErrorKind::ALL.into_iter().filter(|kind| *kind != ErrorKind::ClockJumps).collect();
    let mut scenario = scenario_with(preset, seed, &kinds).draw_errors(seed);
    change(&mut scenario);
    resect_io::simulation_files::open(&simulate_scenario(&scenario, seed)).expect("valid")
}

fn solved(deployment: &Deployment) -> Calibration {
    answer(&analyse(deployment, &by(Method::Joint))).calibration.clone()
}

fn is_warned(calibration: &Calibration) -> bool {
    calibration.findings.iter().any(|finding| finding.severity > Severity::Note)
}

/// Station and point that change with the seed.
fn station(seed: u64) -> Station {
    Station::at(seed as usize % 3)
}

/// Returns true if a reading of a control point is reported that is off by a multiple of its detectable bias.
fn reading_is_reported(axis: usize, times: f64, seed: u64) -> bool {
    let mut wrong = deployment(Preset::Warthog, seed, |_| ());
    let right = solved(&wrong);
    let survey = right.joint().and_then(|joint| joint.control_points()).expect("control points");
    let mut readings =
        survey.readings.iter().filter(|it| it.station == station(seed) && it.set == 0);
    let reading = readings.nth(seed as usize % 4).expect("read");
    let bias_m = times * reading.detectable_bias_m(axis).expect("checked");
    let point = &mut wrong.control_points[reading.set].points[reading.point];
    let polar: &mut Polar = point.readings[reading.station].as_mut().expect("read");
    match axis {
        0 => polar.range_m += bias_m,
        1 => polar.azimuth_rad += bias_m / polar.range_m,
        _ => polar.zenith_rad += bias_m / polar.range_m,
    }
    let findings = solved(&wrong).findings;
    findings.iter().any(|finding| finding.kind == kinds::CONTROL_POINT_OUTLIER)
}

/// Returns true if a scale error of ranges is reported that is a multiple of its detectable bias.
fn scale_is_reported(times: f64, seed: u64) -> bool {
    let right = solved(&deployment(Preset::Warthog, seed, |_| ()));
    let station = station(seed);
    let mut groups = right.joint().expect("a joint estimate").reliability.iter();
    let group = groups
        .find(|it| it.kind == GroupKind::RangeScale && it.index == station.index())
        .expect("a group");
    let bias = times * group.bias.as_ref().expect("determined").size;
    let wrong = deployment(Preset::Warthog, seed, |scenario| {
        scenario.errors.range_scale[station] += bias;
    });
    is_warned(&solved(&wrong))
}

/// Returns true if ranges of one station to all control points that are 10 mm long are reported.
fn ranges_are_reported(seed: u64) -> bool {
    let mut wrong = deployment(Preset::Warthog, seed, |_| ());
    for point in wrong.control_points.iter_mut().flat_map(|set| &mut set.points) {
        if let Some(reading) = &mut point.readings[station(seed)] {
            reading.range_m += 0.010;
        }
    }
    solved(&wrong).verdict != Verdict::Good
}

/// Returns true if a station that turned by 0.3 mrad before the second set is reported.
fn turn_is_reported(seed: u64) -> bool {
    let mut wrong = deployment(Preset::Warthog, seed, |_| ());
    for point in &mut wrong.control_points[1].points {
        if let Some(reading) = &mut point.readings[station(seed)] {
            reading.azimuth_rad += 3e-4;
        }
    }
    let findings = solved(&wrong).findings;
    findings.iter().any(|finding| finding.kind == kinds::STATION_MOVED_BETWEEN_SETS)
}

/// Share of the seeds for which something is true.
fn share(seeds: std::ops::Range<u64>, is_true: impl Fn(u64) -> bool + Sync) -> f64 {
    let count = seeds.end - seeds.start;
    seeds.into_par_iter().filter(|seed| is_true(*seed)).count() as f64 / count as f64
}

fn print_power(seeds: &std::ops::Range<u64>) -> [f64; 2] {
    let power = [1.0, 2.0].map(|times| {
        let of_axis = |axis: usize| {
            let reported = share(seeds.clone(), |seed| reading_is_reported(axis, times, seed));
            println!("  {times} × a reading, axis {axis}: {:.0} %", 100.0 * reported);
            reported
        };
        let of_axes = (0..3).map(of_axis).fold(1.0, f64::min);
        let of_scale = share(seeds.clone(), |seed| scale_is_reported(times, seed));
        println!("  {times} × the scale of ranges: {:.0} %", 100.0 * of_scale);
        of_axes.min(of_scale)
    });
    let ranges = share(seeds.clone(), ranges_are_reported);
    let turns = share(seeds.clone(), turn_is_reported);
    println!("  10 mm at one station: {:.0} %", 100.0 * ranges);
    println!("  0.3 mrad between two sets: {:.0} %", 100.0 * turns);
    [power[0].min(ranges).min(turns), power[1]]
}

#[test]
fn a_detectable_bias_is_reported() {
    let [once, twice] = print_power(&(1..9));
    // Eight drives: one more or less is an eighth.
    assert!(once > 0.49 && twice > 0.99, "{once} {twice}");
}

#[test]
#[ignore = "minutes in release; prints the power of the findings"]
fn a_detectable_bias_is_reported_in_forty_drives() {
    let [once, twice] = print_power(&(1..41));
    assert!(once >= 0.70 && twice >= 0.95, "{once} {twice}");
}

#[test]
#[ignore = "minutes in release; prints false alarms by the rate of readings"]
fn false_alarms_are_rare_at_every_rate() {
    let presets = [Preset::Warthog, Preset::Hd2Tunnel, Preset::FlatFloor, Preset::FigureEight];
    for rate_hz in [1.0, 2.5, 5.0, 10.0, 20.0] {
        let alarms: Vec<f64> = presets
            .iter()
            .map(|preset| {
                share(1..31, |seed| {
                    let deployment =
                        deployment(*preset, seed, |scenario| scenario.rate_hz = rate_hz);
                    solved(&deployment).verdict != Verdict::Good
                })
            })
            .collect();
        println!(
            "  {rate_hz:>4} Hz: not good {:.1?} %",
            alarms.iter().map(|it| 100.0 * it).collect::<Vec<_>>()
        );
        let mean = alarms.iter().sum::<f64>() / alarms.len() as f64;
        assert!(mean <= 0.02, "{rate_hz} Hz: {mean}");
    }
}
