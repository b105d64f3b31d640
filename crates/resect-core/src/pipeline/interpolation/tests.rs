//! Tests of both Gaussian processes, and comparisons with linear interpolation.

use nalgebra::{DMatrix, DVector, Rotation3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::series::{InterpolatedTrack, ReadingSeries};
use super::{linear, squared_exponential, white_noise_on_acceleration};
use crate::pipeline::{FilteredTrack, Interval};
use crate::progress::{Cancelled, Progress};

type Method = fn(
    &FilteredTrack,
    &[Interval],
    (&[f64], &[u32]),
    &Progress,
) -> Result<InterpolatedTrack, Cancelled>;
const BOTH: [(&str, Method); 2] = [
    ("squared exponential", squared_exponential::at),
    ("white noise on acceleration", white_noise_on_acceleration::at),
];
fn positions_at(
    method: Method,
    track: &FilteredTrack,
    intervals: &[Interval],
    times_s: &[f64],
    owners: &[u32],
) -> InterpolatedTrack {
    method(track, intervals, (times_s, owners), &Progress::default()).expect("nobody cancels it")
}

/// Spectral density of the simulated acceleration: a few millimetres between readings, so that noise of 2 mm is observable.
const DENSITY_M2_PER_S3: f64 = 1e-3;
/// Unix time: the stamps of real readings are this large.
const START_S: f64 = 1.6e9;

fn normal(rng: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(rng)
}

/// Simulates readings of a motion about every 0.4 s, with this noise along each axis.
fn measured(
    motion: impl Fn(f64) -> Vector3<f64>,
    count: usize,
    noise_m: f64,
    seed: u64,
) -> FilteredTrack {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let since_s: Vec<f64> =
        (0..count).map(|k| 0.4 * k as f64 + 0.1 * rng.random::<f64>()).collect();
    let noisy = |t: &f64| motion(*t) + noise_m * Vector3::from_fn(|_, _| normal(&mut rng));
    FilteredTrack {
        position_m: since_s.iter().map(noisy).collect(),
        time_s: since_s.iter().map(|t| START_S + t).collect(),
        ..Default::default()
    }
}

fn whole(track: &FilteredTrack) -> Interval {
    Interval { start_s: track.time_s[0], end_s: track.time_s[track.time_s.len() - 1] }
}

/// Returns a sample of a squared-exponential process of 3 m and 3 s about a point far from the station (random Fourier
/// features).
fn smooth_sample(seed: u64) -> impl Fn(f64) -> Vector3<f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let waves: [Vec<(f64, f64)>; 3] = std::array::from_fn(|_| {
        (0..400)
            .map(|_| (normal(&mut rng) / 3.0, std::f64::consts::TAU * rng.random::<f64>()))
            .collect()
    });
    move |t| {
        Vector3::new(200.0, -150.0, 5.0)
            + Vector3::from_fn(|axis, _| {
                let sum: f64 =
                    waves[axis].iter().map(|(rate, phase)| (rate * t + phase).cos()).sum();
                3.0 * sum * (2.0 / 400.0_f64).sqrt()
            })
    }
}

/// Returns a sample of the process with white acceleration, simulated in short steps.
fn driven_sample(seed: u64) -> impl Fn(f64) -> Vector3<f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let step_s: f64 = 0.01;
    let (mut place, mut velocity) = (Vector3::new(200.0, -150.0, 5.0), Vector3::zeros());
    let path: Vec<_> = (0..60_000)
        .map(|_| {
            velocity +=
                (DENSITY_M2_PER_S3 * step_s).sqrt() * Vector3::from_fn(|_, _| normal(&mut rng));
            place += velocity * step_s;
            place
        })
        .collect();
    move |t| {
        let steps = (t / step_s).max(0.0);
        path[steps as usize].lerp(&path[steps as usize + 1], steps.fract())
    }
}

/// Alternates between 6 s at 1 m/s and 6 s at rest.
fn stopping(t: f64) -> Vector3<f64> {
    let rounds = (t / 12.0).floor();
    Vector3::new(100.0 + 6.0 * rounds + (t - 12.0 * rounds).min(6.0), 0.0, 0.0)
}

pub fn stop_and_go(noise_m: f64) -> FilteredTrack {
    measured(stopping, 300, noise_m, 70)
}

/// Simulates readings of a smooth motion.
pub fn wander(count: usize, seed: u64) -> FilteredTrack {
    measured(smooth_sample(seed), count, 2e-3, seed)
}

pub fn series_of(track: &FilteredTrack) -> ReadingSeries {
    ReadingSeries::new(track, &whole(track))
}

/// Kriging with an unknown straight line, by one linear system for each instant's weights.
pub fn dense_by_the_book(
    kernel: impl Fn(f64, f64) -> f64,
    noise_m: f64,
    series: &ReadingSeries,
    instants_s: &[f64],
) -> (Vec<Vector3<f64>>, Vec<f64>) {
    let (n, times_s) = (series.len(), &series.time_s);
    let line = |t: f64, j: usize| if j == 0 { 1.0 } else { t };
    let system = DMatrix::from_fn(n + 2, n + 2, |i, j| match (i < n, j < n) {
        (true, true) => kernel(times_s[i], times_s[j]) + if i == j { noise_m.powi(2) } else { 0.0 },
        (true, false) => line(times_s[i], j - n),
        (false, true) => line(times_s[j], i - n),
        (false, false) => 0.0,
    })
    .full_piv_lu();
    let solve =
        |t: &f64| {
            let right = DVector::from_fn(n + 2, |i, _| {
                if i < n { kernel(times_s[i], *t) } else { line(*t, i - n) }
            });
            let weights = system.solve(&right).expect("regular");
            let point_m: Vector3<f64> =
                (0..n).map(|i| weights[i] * (series.position_m[i] - series.position_m[0])).sum();
            (series.position_m[0] + point_m, (kernel(*t, *t) - weights.dot(&right)).sqrt())
        };
    instants_s.iter().map(solve).unzip()
}

/// Instants at 10 Hz from the first reading to the last.
fn instants_s(track: &FilteredTrack) -> Vec<f64> {
    let span = whole(track);
    (0..=(span.length_s() * 10.0) as usize).map(|k| span.start_s + 0.1 * k as f64).collect()
}

fn estimated(track: &FilteredTrack, method: Method) -> InterpolatedTrack {
    let times_s = instants_s(track);
    positions_at(method, track, &[whole(track)], &times_s, &vec![0; times_s.len()])
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0_f64), |(sum, count), v| (sum + v * v, count + 1.0));
    (sum / count).sqrt()
}

fn errors_m(
    track: &FilteredTrack,
    points_m: &[Vector3<f64>],
    motion: &impl Fn(f64) -> Vector3<f64>,
) -> Vec<f64> {
    let times_s = instants_s(track);
    points_m.iter().zip(times_s).map(|(point, t)| (point - motion(t - START_S)).norm()).collect()
}

fn median_error_m(
    track: &FilteredTrack,
    points_m: &[Vector3<f64>],
    motion: &impl Fn(f64) -> Vector3<f64>,
) -> f64 {
    let mut errors_m = errors_m(track, points_m, motion);
    errors_m.sort_by(f64::total_cmp);
    errors_m[errors_m.len() / 2]
}

/// Returns the root-mean-square errors of linear interpolation and of both processes (m).
fn rms_errors_m(motion: impl Fn(f64) -> Vector3<f64>, track: &FilteredTrack) -> [f64; 3] {
    let by_lines = linear::at(track, &instants_s(track));
    let [smooth, driven] = BOTH.map(|(_, method)| estimated(track, method).points_m);
    [by_lines, smooth, driven].map(|points_m| rms(errors_m(track, &points_m, &motion).into_iter()))
}

/// Returns the rms of errors over their predicted standard deviations, which should be 1.
fn normalised_error(
    track: &FilteredTrack,
    found: &InterpolatedTrack,
    motion: &impl Fn(f64) -> Vector3<f64>,
) -> f64 {
    let scaled = instants_s(track)
        .into_iter()
        .enumerate()
        .map(|(i, t)| (found.points_m[i] - motion(t - START_S)).component_div(&found.sigma_m[i]));
    rms(scaled.flat_map(<[f64; 3]>::from))
}

/// Tests each process on motion of its own kind.
#[test]
fn noise_is_recovered_and_errors_are_as_large_as_said() {
    for seed in 10..14 {
        let (smooth, driven) = (smooth_sample(seed), driven_sample(seed));
        let on_smooth = measured(&smooth, 500, 2e-3, seed);
        let on_driven = measured(&driven, 500, 2e-3, seed);
        let learned =
            squared_exponential::learn(&on_smooth, &[whole(&on_smooth)], &Progress::default())
                .expect("nobody cancels it");
        let learned_driven = white_noise_on_acceleration::learn(
            &on_driven,
            &[whole(&on_driven)],
            &Progress::default(),
        )
        .expect("nobody cancels it");
        let [a, b] = learned[0].map(|own| own.noise_m);
        let [c, d] = learned_driven[0].map(|own| own.noise_m);
        for noise_m in [a, b, c, d] {
            assert!((noise_m / 2e-3 - 1.0).abs() < 0.25, "{noise_m}");
        }
        let normalised = [
            normalised_error(&on_smooth, &estimated(&on_smooth, BOTH[0].1), &smooth),
            normalised_error(&on_driven, &estimated(&on_driven, BOTH[1].1), &driven),
        ];
        assert!(normalised.iter().all(|one| (0.8..1.25).contains(one)), "{normalised:?}");
    }
}

#[test]
fn a_turned_and_shifted_frame_turns_and_shifts_the_answer() {
    let track = wander(120, 20);
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), 2.1);
    let shift = Vector3::new(-500.0, 900.0, 30.0);
    let elsewhere = FilteredTrack {
        position_m: track.position_m.iter().map(|p| turn * p + shift).collect(),
        ..track.clone()
    };
    for (name, method) in BOTH {
        let (here, there) = (estimated(&track, method), estimated(&elsewhere, method));
        for (a, b) in here.points_m.iter().zip(&there.points_m) {
            assert!((turn * a + shift - b).norm() < 1e-6, "{name}: {a} {b}");
        }
        for (a, b) in here.sigma_m.iter().zip(&there.sigma_m) {
            assert!((a - b).norm() < 1e-3 * a.norm(), "{name}");
        }
    }
}

#[test]
fn a_straight_drive_without_noise_is_met() {
    let motion = |t: f64| Vector3::new(300.0 + 1.5 * t, -80.0 - 0.4 * t, 0.02 * t);
    let track = measured(motion, 300, 0.0, 30);
    for error_m in &rms_errors_m(motion, &track)[1..] {
        assert!(*error_m < 1e-4, "{error_m}");
    }
}

#[test]
fn standing_still_averages_the_noise_away() {
    let motion = |_: f64| Vector3::new(40.0, 70.0, -1.0);
    let errors_m = rms_errors_m(motion, &measured(motion, 200, 2e-3, 40));
    assert!(errors_m[1..].iter().all(|error_m| *error_m < 1e-3), "{errors_m:?}");
}

/// The shortest tracks have one reading; an interval may begin and end at readings.
#[test]
fn few_readings_are_enough_for_an_answer() {
    for count in 1..24 {
        let track = wander(count, 50);
        let end_s = track.time_s[count - 1];
        let intervals =
            [(START_S, START_S + 0.05), (track.time_s[0], end_s), (end_s - 0.01, end_s)]
                .map(|(start_s, end_s)| Interval { start_s, end_s });
        let times_s: Vec<_> =
            intervals.iter().flat_map(|i| [i.start_s, i.end_s, i.end_s]).collect();
        for (name, method) in BOTH {
            let found =
                positions_at(method, &track, &intervals, &times_s, &[0, 0, 0, 1, 1, 1, 2, 2, 2]);
            assert_eq!((found.points_m.len(), found.sigma_m.len()), (9, 9));
            let near = |p: &Vector3<f64>| (p - track.position_m[0]).norm() < 50.0;
            assert!(found.points_m.iter().all(near), "{name}, {count}: {:?}", found.points_m);
            let finite = |s: &Vector3<f64>| s.iter().all(|s| s.is_finite() && *s > 0.0);
            assert!(found.sigma_m.iter().all(finite), "{name}, {count}: {:?}", found.sigma_m);
            assert!(positions_at(method, &track, &intervals, &[], &[]).points_m.is_empty());
        }
    }
}

/// On a circle of radius 4 m at 1 m/s, the chord between readings 0.4 s apart is 5 mm off the arc.
#[test]
fn on_a_winding_track_both_beat_straight_lines() {
    let winding = |t: f64| Vector3::new(100.0 + 4.0 * (t / 4.0).cos(), 4.0 * (t / 4.0).sin(), 0.0);
    let [lines_m, smooth_m, driven_m] = rms_errors_m(winding, &measured(winding, 300, 2e-3, 60));
    assert!(smooth_m < 0.25 * lines_m, "{smooth_m} and {lines_m}");
    assert!(driven_m < 0.65 * lines_m, "{driven_m} and {lines_m}");
}

/// No length scale fits both a straight drive and a sudden stop, so the smooth process models the difference as noise.
#[test]
fn where_the_vehicle_stops_dead_the_smooth_process_loses() {
    let track = stop_and_go(2e-3);
    let [lines_m, smooth_m, driven_m] = rms_errors_m(stopping, &track);
    assert!(smooth_m > 2.0 * lines_m, "{smooth_m} and {lines_m}");
    assert!(driven_m < lines_m, "{driven_m} and {lines_m}");
}

/// An outlier does not affect linear interpolation elsewhere; both processes spread it.
#[test]
fn where_outliers_are_left_in_straight_lines_win_almost_everywhere() {
    let straight = |t: f64| Vector3::new(100.0 + 1.2 * t, 3.0 + 0.5 * t, 0.01 * t);
    let mut track = measured(straight, 300, 2e-3, 70);
    for k in [17, 117, 217] {
        track.position_m[k].x += 1.0;
    }
    let by_lines = linear::at(&track, &instants_s(&track));
    let lines_m = median_error_m(&track, &by_lines, &straight);
    for (name, method) in BOTH {
        let found_m = median_error_m(&track, &estimated(&track, method).points_m, &straight);
        assert!(found_m > 3.0 * lines_m, "{name}: {found_m} and {lines_m}");
    }
}

/// A long interval is learned from all its readings, so that a sharp turn is not mistaken for noise.
#[test]
fn one_sharp_turn_in_a_long_straight_drive_is_followed() {
    let count = 420;
    let at = |t: f64| {
        // 0.8 m/s along x, a quarter turn of radius 1 m at 100 s, then along y.
        let (speed, turn_s) = (0.8, 100.0);
        let angle = (speed * (t - turn_s)).clamp(0.0, std::f64::consts::FRAC_PI_2);
        let before = speed * t.min(turn_s);
        let after = (speed * (t - turn_s) - angle).max(0.0);
        Vector3::new(before + angle.sin(), 1.0 - angle.cos() + after, 0.0)
    };
    let time_s: Vec<f64> = (0..count).map(|k| 0.4 * f64::from(k)).collect();
    let position_m = time_s.iter().map(|t| at(*t)).collect();
    let track = FilteredTrack { time_s, position_m, ..Default::default() };
    let intervals = [Interval { start_s: 0.0, end_s: 0.4 * f64::from(count - 1) }];
    let instants: Vec<f64> = (0..1600).map(|k| 0.1 * f64::from(k)).collect();
    let owners = vec![0; instants.len()];
    let estimate = positions_at(squared_exponential::at, &track, &intervals, &instants, &owners);
    let worst_m = instants
        .iter()
        .zip(&estimate.points_m)
        .map(|(t, found)| (found - at(*t)).norm())
        .fold(0.0, f64::max);
    assert!(worst_m < 0.03, "{worst_m}");
}

#[test]
fn a_long_interval_tells_how_far_it_is_and_stops_at_once() {
    let track = wander(3000, 9);
    let intervals = [whole(&track)];
    let instants = (&track.time_s[..], &vec![0; track.time_s.len()][..]);
    for (name, method) in BOTH {
        let progress = Progress::default();
        method(&track, &intervals, instants, &progress).expect("nobody cancels it");
        let total = progress.total();
        assert_eq!(progress.done(), total, "{name}");

        let unwanted = Progress::default();
        unwanted.cancel();
        assert!(method(&track, &intervals, instants, &unwanted).is_err(), "{name}");
        assert_eq!((unwanted.done(), unwanted.total()), (0, total), "{name}");
    }
}
