//! Effect of each systematic error on readings, compared with the same drive without it.

mod targets_and_facets;

use std::f64::consts::TAU;

use nalgebra::Vector3;

use super::errors::WanderingRange;
use super::*;
use resect_core::deployment::{ControlPoint, Measurement};
use resect_core::geometry::{ARCSECOND_RAD, LevelTransform, Polar, RigidTransform, wrap_to_pi};

/// Simulates a minute of the Warthog's drive without noise, with some systematic errors.
fn drive(errors: SystematicErrors) -> Simulated {
    simulate_scenario(&Scenario { errors, ..noiseless() }, 5)
}

fn noiseless() -> Scenario {
    let mut scenario = Preset::Warthog.scenario();
    scenario.duration_s = 60.0;
    scenario.prism_constant_m = 0.0;
    scenario.noise.range_sigma_m = 0.0;
    scenario.noise.angle_sigma_rad = 0.0;
    scenario.noise.outlier_share = 0.0;
    scenario.noise.lost_locks_per_minute = 0.0;
    scenario
}

fn none() -> SystematicErrors {
    SystematicErrors::default()
}

/// Readings of a station, with stamps from 0 on.
fn readings(simulated: &Simulated, station: usize) -> Vec<Measurement> {
    let own = simulated.records.iter().filter(|record| record.station == station as i64 + 1);
    let readings: Vec<_> = own
        .map(|record| Measurement {
            time_s: record.measurement.time_s - EPOCH_S,
            ..record.measurement
        })
        .collect();
    assert!(!readings.is_empty());
    readings
}

fn polar(m: &Measurement) -> Polar {
    Polar { range_m: m.range_m, azimuth_rad: m.azimuth_rad, zenith_rad: m.zenith_rad }
}

/// Pairs of each station's readings without and with some errors.
fn side_by_side(errors: SystematicErrors) -> [Vec<(Measurement, Measurement)>; 3] {
    let (right, wrong) = (drive(none()), drive(errors));
    std::array::from_fn(|station| {
        let (right, wrong) = (readings(&right, station), readings(&wrong, station));
        assert_eq!(right.len(), wrong.len());
        right.into_iter().zip(wrong).collect()
    })
}

/// Readings of static targets without and with some errors, with station and prism.
fn standing(errors: SystematicErrors) -> Vec<(usize, Option<usize>, Polar, Polar)> {
    let (right, wrong) = (drive(none()), drive(errors));
    let points = |simulated: &Simulated| -> Vec<(usize, Polar)> {
        let points = simulated.control_points.iter().flat_map(|set| set.points.clone());
        points
            .flat_map(|point| point.readings.map(|r| r.expect("read")).into_iter().enumerate())
            .collect()
    };
    let targets = points(&right).into_iter().zip(points(&wrong));
    let rig = (0..3).map(|p| (0, Some(p), right.rig_reading[p], wrong.rig_reading[p]));
    targets.map(|((station, a), (_, b))| (station, None, a, b)).chain(rig).collect()
}

fn near(found: f64, expected: f64, within: f64) {
    assert!((found - expected).abs() <= within, "{found} is not {expected}");
}

#[test]
fn ranges_are_wrong_by_offset_scale_and_prism() {
    let errors = || SystematicErrors {
        range_offset_m: [0.001, -0.002, 0.003].into(),
        range_scale: [40e-6, -20e-6, 10e-6].into(),
        prism_offset_m: [0.0005, 0.0007, -0.0009].into(),
        prism_constant_m: 0.0002,
        ..none()
    };
    let expected_m = |station: usize, prism: Option<usize>, range_m: f64| {
        let e = errors();
        let prism_m = prism.map_or(0.0, |prism| e.prism_offset_m[prism]);
        e.range_offset_m[station] + e.range_scale[station] * range_m + prism_m + e.prism_constant_m
    };
    for (station, pairs) in side_by_side(errors()).iter().enumerate() {
        for (right, wrong) in pairs {
            let expected_m = expected_m(station, Some(station), right.range_m);
            near(wrong.range_m - right.range_m, expected_m, 1e-12);
            assert_eq!(wrong.azimuth_rad, right.azimuth_rad);
        }
    }
    // Control points and pillars are not prisms of the vehicle; station 1 reads the rig.
    for (station, prism, right, wrong) in standing(errors()) {
        near(wrong.range_m - right.range_m, expected_m(station, prism, right.range_m), 1e-12);
    }
}

#[test]
fn a_wrong_prism_brings_its_own_offset() {
    let mut scenario = noiseless();
    scenario.noise.wrong_targets_per_minute = 4.0;
    let right = simulate_scenario(&scenario, 5);
    scenario.errors.prism_offset_m = [0.001, 0.002, 0.003].into();
    let wrong = simulate_scenario(&scenario, 5);
    let mut seen = [false; 3];
    for (right, wrong) in readings(&right, 0).iter().zip(&readings(&wrong, 0)) {
        let millimetres = 1000.0 * (wrong.range_m - right.range_m);
        near(millimetres, millimetres.round(), 1e-9);
        seen[millimetres.round() as usize - 1] = true;
    }
    assert_eq!(seen, [true, true, false], "station 1 takes prism 2 for its own");
}

#[test]
fn angles_are_those_of_a_latency_earlier() {
    let latency_s = [0.0, 0.010, 0.300];
    let simulated = drive(SystematicErrors { latency_s: latency_s.into(), ..none() });
    let mut fastest_m = 0.0_f64;
    for station in 0..3 {
        let this_from_station1 = simulated.truth.station1_from_station[station].inverse();
        let seen_at = |time_s: f64| {
            let prism = &simulated.truth.prisms_m[station];
            let place = simulated.truth.motion.position_m(prism, time_s);
            Polar::from_cartesian(this_from_station1.apply(&place))
        };
        for reading in readings(&simulated, station) {
            let (now, earlier) =
                (seen_at(reading.time_s), seen_at(reading.time_s - latency_s[station]));
            // Stamps of this size resolve a quarter of a microsecond.
            near(reading.range_m, now.range_m, 1e-6);
            near(wrap_to_pi(reading.azimuth_rad - earlier.azimuth_rad), 0.0, 1e-7);
            near(reading.zenith_rad, earlier.zenith_rad, 1e-7);
            fastest_m = fastest_m.max((now.to_cartesian() - earlier.to_cartesian()).norm());
        }
    }
    assert!(fastest_m > 0.2, "the vehicle drives: {fastest_m}");
}

fn settling(station: usize) -> Settling {
    Settling {
        station,
        from_s: 20.0,
        over_s: 0.0,
        turn_rad: 0.0,
        move_m: Vector3::zeros(),
        lean_rad: [0.0; 2],
    }
}

#[test]
fn a_station_that_turns_at_once_reads_larger_azimuths_from_then_on() {
    let settling = vec![Settling { turn_rad: 1e-3, ..settling(1) }];
    let [first, second, third] = side_by_side(SystematicErrors { settling, ..none() });
    for (right, wrong) in second {
        // Rotations are counter-clockwise, but azimuths increase clockwise.
        let turned_rad = if right.time_s < 20.0 { 0.0 } else { 1e-3 };
        near(wrap_to_pi(wrong.azimuth_rad - right.azimuth_rad), turned_rad, 1e-12);
        near(wrong.zenith_rad, right.zenith_rad, 1e-12);
        near(wrong.range_m, right.range_m, 1e-9);
    }
    assert!(first.iter().chain(&third).all(|(right, wrong)| right == wrong));
}

#[test]
fn a_station_that_settles_slowly_is_half_way_at_half_time() {
    let settling = vec![Settling { turn_rad: 1e-3, over_s: 30.0, ..settling(0) }];
    let [first, ..] = side_by_side(SystematicErrors { settling, ..none() });
    for (right, wrong) in first {
        let turned_rad = 1e-3 * ((right.time_s - 20.0) / 30.0).clamp(0.0, 1.0);
        near(wrap_to_pi(wrong.azimuth_rad - right.azimuth_rad), turned_rad, 1e-10);
    }
}

#[test]
fn readings_fit_the_truth_through_the_frames_of_their_moments() {
    let errors = || SystematicErrors {
        settling: vec![
            // Station 1 settles as well, and one station settles twice.
            Settling { move_m: Vector3::new(0.01, -0.02, 0.005), over_s: 10.0, ..settling(0) },
            Settling { lean_rad: [2e-3, -1e-3], ..settling(1) },
            Settling { turn_rad: -3e-3, from_s: 40.0, ..settling(1) },
        ],
        ..none()
    };
    let simulated = drive(errors());
    let truth = &simulated.truth;
    let mut furthest_m = [0.0_f64; 3];
    for station in 0..3 {
        for reading in readings(&simulated, station) {
            let seen = polar(&reading).to_cartesian();
            let place = truth.motion.position_m(&truth.prisms_m[station], reading.time_s);
            let frames = simulated.station1_from_station_at(reading.time_s);
            assert!((frames[station].apply(&seen) - place).norm() < 1e-6);
            let set_up = &truth.station1_from_station[station];
            furthest_m[station] = furthest_m[station].max((set_up.apply(&seen) - place).norm());
        }
    }
    assert!(furthest_m[0] > 0.02 && furthest_m[1] > 0.05 && furthest_m[2] < 1e-6, "{furthest_m:?}");
    // A displacement is along the axes of station 1, for any yaw of the station.
    let frames = simulated.station1_from_station_at(25.0);
    let (first, second) = (&frames[0], &frames[1]);
    assert!((first.translation_m - Vector3::new(0.005, -0.01, 0.0025)).norm() < 1e-12);
    assert_eq!(second.translation_m, truth.station1_from_station[1].translation_m);
    near(second.tilt_rad(), 2e-3_f64.hypot(1e-3), 1e-8);
    // Static targets were read before the settling.
    assert!(standing(errors()).iter().all(|(_, _, right, wrong)| right == wrong));
}

#[test]
fn wandering_ranges_have_the_spread_and_memory_that_were_asked_for() {
    const STEP_S: f64 = 0.4;
    let wander = Wander { sigma_m: 0.002, correlation_s: 4.0 };
    let mean = |values: &mut dyn Iterator<Item = f64>, of: usize| values.sum::<f64>() / of as f64;
    let wandered: [Vec<f64>; 3] = std::array::from_fn(|station| {
        let mut range = WanderingRange::new(wander, 5, station);
        (0..100_000).map(|k| range.at_m(f64::from(k) * STEP_S) / wander.sigma_m).collect()
    });
    let product =
        |a: &[f64], b: &[f64]| mean(&mut a.iter().zip(b).map(|(a, b)| a * b), a.len().min(b.len()));
    for station in &wandered {
        near(product(station, station), 1.0, 0.05);
        for steps in [1, 10, 20] {
            let left = (-STEP_S * steps as f64 / wander.correlation_s).exp();
            near(product(station, &station[steps..]), left, 0.05);
        }
    }
    near(product(&wandered[0], &wandered[1]), 0.0, 0.05);
}

#[test]
fn wandering_ranges_are_in_the_readings_of_the_drive_alone() {
    let wander = Wander { sigma_m: 0.002, correlation_s: 4.0 };
    let errors = || SystematicErrors { range_wander: Some(wander), ..none() };
    for (station, pairs) in side_by_side(errors()).iter().enumerate() {
        let mut range = WanderingRange::new(wander, 5, station);
        for (right, wrong) in pairs {
            // Stamps of this size resolve a quarter of a microsecond.
            near(wrong.range_m - right.range_m, range.at_m(right.time_s), 1e-6);
            assert_eq!(*wrong, Measurement { range_m: wrong.range_m, ..*right });
        }
    }
    assert!(standing(errors()).iter().all(|(_, _, right, wrong)| right == wrong));
}

#[test]
fn jittering_stamps_change_nothing_but_stamps() {
    let stamp_jitter_s = 0.003;
    let mut errors_s = Vec::new();
    for pairs in side_by_side(SystematicErrors { stamp_jitter_s, ..none() }) {
        for (right, wrong) in pairs {
            assert_eq!(wrong, Measurement { time_s: wrong.time_s, ..right });
            errors_s.push(wrong.time_s - right.time_s);
        }
    }
    let rms = |values: &mut dyn Iterator<Item = f64>| {
        (values.map(|value| value * value).sum::<f64>() / errors_s.len() as f64).sqrt()
    };
    near(rms(&mut errors_s.iter().copied()), stamp_jitter_s, 0.0004);
    // Independent errors differ by √2 times their standard deviation.
    let differences = &mut errors_s.windows(2).map(|pair| pair[1] - pair[0]);
    near(rms(differences), 2.0_f64.sqrt() * stamp_jitter_s, 0.0006);
}

#[test]
fn stamps_that_jitter_past_each_other_are_sorted() {
    let simulated = drive(SystematicErrors { stamp_jitter_s: 1.0, ..none() });
    let ordered = readings(&simulated, 0).windows(2).all(|pair| pair[0].time_s <= pair[1].time_s);
    assert!(ordered, "as the recorder of a real drive leaves them");
    assert_eq!(simulated.records.len(), drive(none()).records.len());
}

#[test]
fn clocks_step_at_any_time_and_more_than_once() {
    let clock_steps = vec![
        ClockStep { station: 2, at_s: 13.0, by_s: 0.020 },
        ClockStep { station: 2, at_s: 41.7, by_s: -0.005 },
    ];
    let [first, second, third] = side_by_side(SystematicErrors { clock_steps, ..none() });
    assert!(first.iter().chain(&second).all(|(right, wrong)| right == wrong));
    for (right, wrong) in third {
        let late_s = match right.time_s {
            ..13.0 => 0.0,
            ..41.7 => 0.020,
            _ => 0.015,
        };
        near(wrong.time_s - right.time_s, late_s, 1e-6);
    }
}

#[test]
fn a_pause_has_no_readings_and_changes_no_others() {
    let whole = drive(none());
    let paused = simulate_scenario(
        &Scenario { pauses_s: vec![[10.0, 20.0], [50.0, 55.0]], ..noiseless() },
        5,
    );
    let recorded = |time_s: f64| !(10.0..20.0).contains(&time_s) && !(50.0..55.0).contains(&time_s);
    for station in 0..3 {
        let mut expected = readings(&whole, station);
        expected.retain(|reading| recorded(reading.time_s));
        assert_eq!(readings(&paused, station), expected);
    }
    assert!(paused.records.len() < whole.records.len());
}

#[test]
fn index_and_collimation_go_into_the_angles() {
    let errors = || SystematicErrors {
        index_rad: [1e-4, -2e-4, 3e-4].into(),
        collimation_rad: [-5e-4, 1e-4, 2e-4].into(),
        ..none()
    };
    let check = |station: usize, right: Polar, wrong: Polar| {
        let SystematicErrors { index_rad, collimation_rad, .. } = errors();
        near(wrong.zenith_rad - right.zenith_rad, index_rad[station], 1e-12);
        let turned_rad = wrap_to_pi(wrong.azimuth_rad - right.azimuth_rad);
        near(turned_rad, collimation_rad[station] / right.zenith_rad.sin(), 1e-12);
        assert_eq!(wrong.range_m, right.range_m);
    };
    for (station, pairs) in side_by_side(errors()).iter().enumerate() {
        pairs.iter().for_each(|(right, wrong)| check(station, polar(right), polar(wrong)));
    }
    for (station, _, right, wrong) in standing(errors()) {
        check(station, right, wrong);
    }
}

#[test]
fn plumb_lines_200_m_apart_differ_by_6_5_arcseconds() {
    let mut scenario = noiseless();
    scenario.stations_m[0] = Vector3::new(200.0, 0.0, 0.0);
    let right = simulate_scenario(&scenario, 5);
    scenario.errors.curvature = Some(Curvature { refraction: 0.0, ..Curvature::STANDARD });
    let wrong = simulate_scenario(&scenario, 5);
    let apart_rad = 6.475 * ARCSECOND_RAD;
    let station1_from_station = &right.truth.station1_from_station[1];
    for (right, wrong) in readings(&right, 1).iter().zip(&readings(&wrong, 1)) {
        // Up leans towards +x there, so targets in that direction appear higher, with a smaller zenith angle.
        let ahead = station1_from_station.rotate(&polar(right).to_cartesian()).xy().normalize().x;
        near(wrong.zenith_rad - right.zenith_rad, -ahead * apart_rad, 1e-8);
        // The heading of a station at set-up is its yaw, not an error.
        near(wrap_to_pi(wrong.azimuth_rad - right.azimuth_rad), 0.0, 0.1 * apart_rad);
    }
    assert_eq!(readings(&right, 0), readings(&wrong, 0), "station 1's is the reference");
}

#[test]
fn refraction_lifts_what_is_far() {
    let curvature = Some(Curvature { earth_radius_m: 6_371_000.0, refraction: 0.2 });
    let expected_rad = |range_m: f64| -0.2 * range_m / (2.0 * 6_371_000.0);
    let [first, ..] = side_by_side(SystematicErrors { curvature, ..none() });
    for (right, wrong) in first {
        near(wrong.zenith_rad - right.zenith_rad, expected_rad(right.range_m), 1e-12);
        assert_eq!(wrong.range_m, right.range_m);
    }
    for (station, _, right, wrong) in standing(SystematicErrors { curvature, ..none() }) {
        if station == 0 {
            near(wrong.zenith_rad - right.zenith_rad, expected_rad(right.range_m), 1e-12);
        }
    }
}

#[test]
fn a_leaning_station_sees_the_world_lean_the_other_way() {
    // A right-handed rotation about y leans up towards +x, so targets ahead appear higher.
    let tilt_rad = [[0.0, 1e-3], [0.0; 2], [0.0; 2]];
    let [first, ..] = side_by_side(SystematicErrors { tilt_rad: tilt_rad.into(), ..none() });
    for (right, wrong) in first {
        let ahead = right.azimuth_rad.cos();
        near(wrong.zenith_rad - right.zenith_rad, -1e-3 * ahead, 1e-6);
    }
}

#[test]
fn every_kind_is_drawn_on_its_own() {
    // This seed gives a clock step and pauses.
    let all = noiseless().with_field_errors(15);
    for left_out in ErrorKind::ALL {
        let mut scenario = noiseless();
        scenario.drawn_errors =
            ErrorKind::ALL.into_iter().filter(|kind| *kind != left_out).collect();
        let mut without = scenario.draw_errors(15);
        assert!(without.drawn_errors.is_empty(), "drawn once");
        assert_ne!(without, all, "{} does something", left_out.name());
        draw(left_out, &mut without, &mut left_out.rng(15));
        assert_eq!(without, all, "{} changes no other", left_out.name());
    }
    assert_ne!(all.errors, noiseless().with_field_errors(16).errors);
}

#[test]
fn the_preset_draws_its_errors_from_the_seed() {
    let simulated = simulate(Preset::FieldErrors, 4);
    let warthog = Preset::Warthog.scenario().with_field_errors(4);
    assert_eq!(simulated.scenario, Scenario { name: "field-errors", ..warthog });
    assert_ne!(simulated.scenario.errors, simulate(Preset::FieldErrors, 6).scenario.errors);
}

#[test]
fn errors_are_drawn_as_large_as_the_priors_and_as_in_the_field() {
    type Pick = fn(&SystematicErrors) -> f64;
    let drawn: Vec<Scenario> = (0..1000).map(|seed| noiseless().with_field_errors(seed)).collect();
    let rms = |pick: Pick| {
        let squares = drawn.iter().map(|scenario| pick(&scenario.errors).powi(2));
        (squares.sum::<f64>() / drawn.len() as f64).sqrt()
    };
    let sizes: [(f64, Pick); 21] = [
        (36e-6, |e| e.settling[0].turn_rad),
        (0.0007, |e| e.settling[1].move_m.z),
        (1.0 * ARCSECOND_RAD, |e| e.settling[2].lean_rad[1]),
        // With that of the prism 1.2 mm.
        (0.00097, |e| e.range_offset_m[2]),
        (0.0007, |e| e.prism_offset_m[0]),
        (7e-6, |e| e.range_scale[1]),
        (0.001, |e| e.range_wander.expect("drawn").sigma_m),
        // A uniform distribution from 0 has an rms of 1/√3 of its maximum.
        (0.015 / 3.0_f64.sqrt(), |e| e.latency_s[0]),
        (0.005 / 3.0_f64.sqrt(), |e| e.stamp_jitter_s),
        (0.004, |e| e.clock_offset_s[1]),
        (5e-6, |e| e.clock_drift[2]),
        (4.0 * ARCSECOND_RAD, |e| e.index_rad[0]),
        (3.0 * ARCSECOND_RAD, |e| e.collimation_rad[0]),
        (2.0 * ARCSECOND_RAD, |e| e.tilt_rad[0][1]),
        (0.002, |e| e.inter_prism_m[2]),
        (1.0, |e| e.further[0].sizes[0]),
        (0.25, |e| e.further[1].sizes[2]),
        // One of three orders.
        (0.001 / 3.0_f64.sqrt(), |e| e.facets.as_ref().expect("drawn")[1].along_m[0][1]),
        (36e-6, |e| e.set_up_changes[1].turn_rad),
        (0.0007, |e| e.set_up_changes[0].move_m.y),
        (1.5 * ARCSECOND_RAD, |e| e.set_up_changes[2].lean_rad[0]),
    ];
    for (size, pick) in sizes {
        near(rms(pick) / size, 1.0, 0.1);
    }
    let share = |of: &dyn Fn(&Scenario) -> bool| {
        drawn.iter().filter(|scenario| of(scenario)).count() as f64 / drawn.len() as f64
    };
    near(share(&|s| s.errors.clock_steps.len() == 1), 0.08, 0.03);
    near(share(&|s| s.errors.clock_steps.len() == 2), 0.02, 0.015);
    near(share(&|s| !s.pauses_s.is_empty()), 0.5, 0.05);
    near(share(&|s| s.errors.rig_constant_m == -0.010), 0.5, 0.05);
    near(share(&|s| s.errors.settling[0].over_s == 0.0), 0.5, 0.05);
}

#[test]
fn a_single_prism_has_a_single_offset() {
    let errors = Preset::SinglePrism.scenario().with_field_errors(1).errors;
    let drawn = errors.prism_offset_m;
    assert!(drawn[0] != 0.0 && drawn[1] == drawn[0] && drawn[2] == drawn[0], "{drawn:?}");
    let facets = errors.facets.expect("drawn");
    assert!(facets[1] == facets[0] && facets[2] == facets[0], "{facets:?}");
}
