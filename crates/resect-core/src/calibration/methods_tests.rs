//! Methods A, B and C with two and with four stations: simulated readings with noise, compared with the truth.

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

use super::method_answer::MethodAnswer;
use super::{
    CalibrationSettings, ErrorSizes, Method, Offer, Verdict, dynamic_gcp, static_gcp, two_point,
};
use crate::deployment::{ControlPoint, ControlPointSet, Deployment, Track};
use crate::geometry::{LevelTransform, Polar, RigidTransform, wrap_to_pi};
use crate::network::{Number, PerStation, Station};
use crate::pipeline::Triplets;

/// Standard deviation of each coordinate of a reading (m).
const SIGMA_M: f64 = 0.001;
/// Drives or surveys per number of stations.
const DRAWS: u64 = 20;

/// Returns stations on a circle around the working area, level, with different yaws.
fn station1_from_station(stations: usize) -> PerStation<RigidTransform> {
    PerStation::from_fn(stations, |station: Station| {
        let Some(slot) = station.slot() else { return RigidTransform::IDENTITY };
        let angle = 1.3 * slot as f64;
        let (x, y) = (8.0 + 9.0 * angle.cos(), 9.0 * angle.sin());
        LevelTransform::new(Vector3::new(x, y, 0.2 * angle), 2.1 * angle - 1.0).into()
    })
}

/// Adds the noise of a reading to a point (m).
fn noisy(point_m: &Vector3<f64>, rng: &mut ChaCha8Rng) -> Vector3<f64> {
    let noise = Normal::new(0.0, SIGMA_M).expect("a σ");
    point_m.map(|axis| axis + noise.sample(rng))
}

/// Returns a deployment whose stations measured some points, with surveyed coordinates in the frame of station 1 if `is_known`.
fn surveyed(
    truth: &PerStation<RigidTransform>,
    points: usize,
    is_known: bool,
    rng: &mut ChaCha8Rng,
) -> Deployment {
    let points = (1..=points as i64).map(|marker| {
        let mut along = |reach_m: f64| rng.random_range(-reach_m..reach_m);
        let point_m = Vector3::new(8.0 + along(30.0), along(30.0), along(2.0));
        let mut read =
            |to: &RigidTransform| Polar::from_cartesian(noisy(&to.inverse().apply(&point_m), rng));
        ControlPoint {
            marker,
            readings: truth.map(|to| Some(read(to))),
            face_one: truth.map(|_| None),
            known_m: is_known.then_some(point_m),
        }
    });
    let file = "GCP.txt".to_owned();
    let set = ControlPointSet { file, points: points.collect(), pillars: false };
    Deployment {
        name: "simulated".to_owned(),
        tracks: truth.map(|_| Track::default()),
        time_corrections: truth.map(|_| Vec::new()),
        control_points: vec![set],
        ..Deployment::default()
    }
}

/// Returns the largest error of the transforms, relative to the stated σ.
fn largest_error_sigmas<D>(answer: &MethodAnswer<D>, truth: &PerStation<RigidTransform>) -> f64 {
    let sigma = answer.sigma().expect("all directions are determined");
    assert_eq!((sigma.len(), answer.station1_from_station.len()), (truth.len(), truth.len()));
    assert_eq!(answer.station1_from_station[Station::FIRST], RigidTransform::IDENTITY);
    let others = truth.each().skip(1);
    let errors = others.flat_map(|(station, truth)| {
        let (found, sigma) = (&answer.station1_from_station[station], &sigma[station]);
        let off = (found.translation_m - truth.translation_m).component_div(&sigma.translation_m);
        let turned = wrap_to_pi(found.yaw_rad() - truth.yaw_rad()) / sigma.yaw_rad;
        [off.x, off.y, off.z, turned]
    });
    errors.map(f64::abs).fold(0.0, f64::max)
}

fn by_control_points(
    deployment: &Deployment,
) -> Result<MethodAnswer<static_gcp::StaticGcpDetails>, super::CalibrationError> {
    let triplets = Triplets::default();
    let offer = Offer::of(deployment, &triplets);
    static_gcp::solve(deployment, &triplets, &CalibrationSettings::default(), &offer)
}

#[test]
fn control_points_place_two_and_four_stations() {
    for (stations, is_known) in [(2, false), (2, true), (4, false), (4, true)] {
        let truth = station1_from_station(stations);
        for seed in 0..DRAWS {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let deployment = surveyed(&truth, 15, is_known, &mut rng);
            let answer = by_control_points(&deployment).expect("an answer");
            let largest = largest_error_sigmas(&answer, &truth);
            assert!(largest < 4.5, "{stations} stations, {is_known}, seed {seed}: {largest:.1} σ");
            assert_eq!(answer.judgement.verdict, Verdict::Good, "{:?}", answer.judgement.findings);
            assert_eq!(answer.details.shared_points, PerStation::repeat(stations, 15));
            assert_eq!(answer.details.world_from_station1.is_some(), is_known);
        }
    }
}

#[test]
fn two_stations_have_the_same_answer_alone_as_among_four() {
    let truth = station1_from_station(4);
    let all = surveyed(&truth, 15, false, &mut ChaCha8Rng::seed_from_u64(7));
    let mut two = all.clone();
    two.tracks = all.tracks.iter().take(2).cloned().collect();
    for point in &mut two.control_points[0].points {
        point.readings = point.readings.iter().take(2).copied().collect();
        point.face_one = point.face_one.iter().take(2).copied().collect();
    }
    let [all, two] = [&all, &two].map(|deployment| by_control_points(deployment).expect("σ"));
    let second = Station::at(1);
    let off =
        all.station1_from_station[second].matrix() - two.station1_from_station[second].matrix();
    assert!(off.norm() < 1e-12, "{off}");
    let covariance = all.covariance.expect("σ").view((0, 0), (4, 4)).into_owned();
    let of_two = two.covariance.expect("σ");
    // Residuals of the others limit the errors of station 1.
    let ratio = covariance.norm() / of_two.norm();
    assert!((0.7..1.1).contains(&ratio), "{covariance}{of_two}");
}

#[test]
fn a_station_without_enough_points_is_named() {
    let truth = station1_from_station(4);
    let mut deployment = surveyed(&truth, 6, false, &mut ChaCha8Rng::seed_from_u64(3));
    for point in deployment.control_points[0].points.iter_mut().skip(2) {
        point.readings[2] = None;
    }
    let error = by_control_points(&deployment).map(|_| ()).expect_err("too few points");
    let words = error.to_string();
    assert!(words.contains("stations 1 and 3 share 2 here"), "{words}");
}

#[test]
fn two_known_points_place_two_and_four_stations() {
    for stations in [2, 4] {
        let truth = station1_from_station(stations);
        for seed in 0..DRAWS {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let deployment = surveyed(&truth, 5, true, &mut rng);
            let triplets = Triplets::default();
            let offer = Offer::of(&deployment, &triplets);
            let answer = two_point::solve(&deployment, &triplets, &ErrorSizes::default(), &offer)
                .expect("an answer");
            let largest = largest_error_sigmas(&answer, &truth);
            assert!(largest < 4.5, "{stations} stations, seed {seed}: {largest:.1} σ");
            assert_eq!(answer.details.pairs[0].baseline_errors_m.len(), stations);
        }
    }
}

/// Returns the readings of one prism on a winding track by all stations.
fn tracked(truth: &PerStation<RigidTransform>, rng: &mut ChaCha8Rng) -> Triplets {
    let time_s: Vec<f64> = (0..600).map(|k| 0.5 * f64::from(k)).collect();
    let points_m = truth.map(|to| -> Vec<Vector3<f64>> {
        let at = |t: &f64| {
            let (x, y) = (8.0 + 20.0 * (0.13 * t).sin(), 15.0 * (0.29 * t + 1.0).cos());
            noisy(&to.inverse().apply(&Vector3::new(x, y, 0.3 * (0.2 * t).sin())), rng)
        };
        time_s.iter().map(at).collect()
    });
    let interval = vec![0; time_s.len()];
    Triplets::new(time_s, interval, points_m)
}

#[test]
fn one_prism_places_two_and_four_stations() {
    for stations in [2, 4] {
        let truth = station1_from_station(stations);
        for seed in 0..DRAWS {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let triplets = tracked(&truth, &mut rng);
            let deployment = Deployment {
                name: "simulated".to_owned(),
                tracks: truth.map(|_| Track::default()),
                prisms: Some(1),
                ..Deployment::default()
            };
            let offer = Offer::of(&deployment, &triplets);
            let settings =
                CalibrationSettings { method: Some(Method::DynamicGcp), ..Default::default() };
            let answer = dynamic_gcp::solve(&deployment, &triplets, &settings, &offer);
            let answer = answer.expect("an answer");
            let largest = largest_error_sigmas(&answer, &truth);
            assert!(largest < 4.5, "{stations} stations, seed {seed}: {largest:.1} σ");
            assert_eq!(answer.judgement.verdict, Verdict::Good, "{:?}", answer.judgement.findings);
        }
    }
}
