//! Method D with other numbers of stations and prisms than three.

use nalgebra::{Rotation3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

use super::published::{self, Published};
use super::{
    CentredTriplets, PrismNetwork, clock_check, gross_errors, prior_search, same_solution,
    uncertainty,
};
use crate::calibration::CalibrationSettings;
use crate::geometry::{LevelTransform, align_level, wrap_to_pi};
use crate::network::{Number, Pair, PerPair, PerStation, Prism, Station};
use crate::pipeline::Triplets;

/// Noise of a coordinate (m).
const NOISE_M: f64 = 0.001;
/// Prisms of a rig, of which the first ones are used (m).
const RIG_M: [[f64; 3]; 6] = [
    [0.5, 0.1, 0.45],
    [-0.4, 0.6, 0.0],
    [-0.2, -0.6, 0.2],
    [0.7, -0.4, -0.15],
    [-0.7, 0.0, 0.6],
    [0.1, 0.8, 0.3],
];

/// A drive with ramps and bumps, or on a level floor.
#[derive(Clone, Copy, Debug)]
enum Ground {
    Uneven,
    Level,
}

/// Simulated triplets, with their truth.
struct SimulatedTriplets {
    triplets: Triplets,
    network: PrismNetwork,
    station1_from_station: PerStation<LevelTransform>,
    /// Heights of station 1's prism above that of each station (m).
    heights_m: PerStation<f64>,
}

/// Simulates a drive that stations follow by these prisms. Station `late` is late by 10 ms.
fn simulate(
    prisms: &[usize],
    ground: Ground,
    late: Option<Station>,
    seed: u64,
) -> SimulatedTriplets {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let prism_of_station: PerStation<Prism> =
        prisms.iter().map(|prism| Prism::at(*prism)).collect();
    let position_m = |prism: Prism, time_s: f64| {
        let s = 0.12 * time_s;
        let tilt = match ground {
            Ground::Uneven => 0.08,
            Ground::Level => 0.0,
        };
        let turn = Rotation3::from_euler_angles(
            tilt * (1.3 * s).sin(),
            tilt * (0.9 * s).cos(),
            1.1 * s + (2.1 * s).sin(),
        );
        let middle =
            Vector3::new(20.0 + 9.0 * s.sin(), 8.0 * (0.6 * s).cos(), 5.0 * tilt * (0.5 * s).sin());
        middle + turn * Vector3::from(RIG_M[prism.index()])
    };
    let station1_from_station = prism_of_station.map_each(|station, _| {
        let k = station.index() as f64;
        if station == Station::FIRST {
            LevelTransform::IDENTITY
        } else {
            LevelTransform::new(Vector3::new(6.0 * k, 40.0 - 17.0 * k, 0.2 * k), 0.9 * k - 2.5)
        }
    });
    let time_s: Vec<f64> = (0..2400).map(|i| 0.1 * f64::from(i)).collect();
    let points_m = prism_of_station.map_each(|station, prism| {
        let station_from_station1 = station1_from_station[station].inverse();
        let late_s = if late == Some(station) { 0.01 } else { 0.0 };
        let point_m = |time_s: &f64| {
            let noise = Vector3::from_fn(|_, _| random.sample::<f64, _>(StandardNormal));
            station_from_station1.apply(&position_m(*prism, time_s - late_s)) + NOISE_M * noise
        };
        time_s.iter().map(point_m).collect()
    });
    let rig_m = |prism: Prism| Vector3::from(RIG_M[prism.index()]);
    let inter_prism_m = PerPair::from_fn(Pair::count(RIG_M.len()), |pair: Pair| {
        (rig_m(pair.first) - rig_m(pair.second)).norm()
    });
    let first_m = rig_m(prism_of_station[Station::FIRST]).z;
    SimulatedTriplets {
        triplets: Triplets::new(time_s, vec![0; 2400], points_m),
        heights_m: prism_of_station.map(|prism| first_m - rig_m(*prism).z),
        network: PrismNetwork::new(prism_of_station, &inter_prism_m),
        station1_from_station,
    }
}

impl SimulatedTriplets {
    fn solve(&self) -> (CentredTriplets, Published) {
        let data = CentredTriplets::new(&self.triplets, &self.network);
        let solution = published::solve(Some(&self.heights_m), &[], &data, None);
        (data, solution)
    }

    /// Asserts that all unknowns are within 3 σ of the truth.
    fn assert_solved(&self, case: &str) {
        let (data, solution) = self.solve();
        let Triplets { time_s, interval, .. } = &self.triplets;
        let fitting = gross_errors::inliers(&solution.thinned, &solution.answer.parameters);
        let settings =
            CalibrationSettings { inter_prism_sigma_m: 0.0, ..CalibrationSettings::default() };
        let answer = &solution.answer;
        let found = uncertainty::estimate(&data, &fitting, time_s, interval, answer, &settings);
        let sigma = found.sigma().expect("all directions are observable");
        for (station, estimate) in solution.choice.answer.station1_from_station.each() {
            let (truth, sigma) = (&self.station1_from_station[station], &sigma[station]);
            let off_m = estimate.translation_m - truth.translation_m;
            for axis in 0..3 {
                assert!(
                    off_m[axis].abs() <= 3.0 * sigma.translation_m[axis]
                        && sigma.translation_m[axis] < 0.01,
                    "{case}, station {station}, axis {axis}: {} ± {}",
                    off_m[axis],
                    sigma.translation_m[axis]
                );
            }
            let off_rad = wrap_to_pi(estimate.yaw_rad - truth.yaw_rad);
            assert!(off_rad.abs() <= 3.0 * sigma.yaw_rad, "{case}, station {station}: {off_rad}");
        }
    }
}

const OWN_PRISMS: [usize; 6] = [0, 1, 2, 3, 4, 5];

#[test]
fn any_number_of_stations_is_solved_to_the_truth() {
    for ground in [Ground::Uneven, Ground::Level] {
        for stations in [2, 3, 4, 6] {
            let simulated = simulate(&OWN_PRISMS[..stations], ground, None, 7);
            simulated.assert_solved(&format!("{stations} stations, {ground:?}"));
        }
    }
}

#[test]
fn stations_that_share_a_prism_are_solved_to_the_truth() {
    for ground in [Ground::Uneven, Ground::Level] {
        for prisms in [[0, 1, 2, 1], [0, 1, 0, 2], [0, 0, 1, 1]] {
            let simulated = simulate(&prisms, ground, None, 8);
            simulated.assert_solved(&format!("{prisms:?}, {ground:?}"));
        }
    }
}

#[test]
fn the_search_of_the_prior_finds_the_answer_of_four_stations() {
    let simulated = simulate(&OWN_PRISMS[..4], Ground::Uneven, None, 9);
    let search = prior_search::search(&simulated.triplets, &simulated.network);
    assert!(search.agreed);
    assert!(same_solution(&search.chosen, &simulated.station1_from_station));
}

/// The pairs of station 1 with every other station have the cost of the point-to-point alignment, method C.
#[test]
fn one_prism_with_station_1_is_the_alignment_of_method_c() {
    for stations in [2, 3, 5] {
        let mut simulated = simulate(&[0; 6][..stations], Ground::Uneven, None, 10);
        simulated.network.pairs.retain(|pair| pair.stations.first == Station::FIRST);
        let (data, solution) = simulated.solve();
        assert!(solution.choice.mirror.twin.is_none());
        let points_m = &simulated.triplets.points_m;
        let mut cost_m2 = 0.0;
        for (station, found) in solution.choice.answer.station1_from_station.each().skip(1) {
            let aligned = align_level(&points_m[Station::FIRST], &points_m[station]);
            let aligned = aligned.expect("many points");
            assert!((found.translation_m - aligned.translation_m).norm() < 1e-9, "{station}");
            assert!(wrap_to_pi(found.yaw_rad - aligned.yaw_rad).abs() < 1e-9, "{station}");
            let both = points_m[Station::FIRST].iter().zip(&points_m[station]);
            cost_m2 += both.map(|(a, b)| (a - aligned.apply(b)).norm_squared()).sum::<f64>();
        }
        let mean_square_m2 = solution.choice.answer.mean_square_m2;
        assert!((mean_square_m2 - data.mean_square_m2(cost_m2)).abs() < 1e-12);
    }
}

#[test]
fn a_late_clock_of_the_fourth_station_is_suspected() {
    for prisms in [[0, 1, 2, 3], [0, 1, 2, 0]] {
        let late = Station::at(3);
        let simulated = simulate(&prisms, Ground::Uneven, Some(late), 11);
        let (_, solution) = simulated.solve();
        let plain = &solution.choice.answer.station1_from_station;
        let clocks =
            clock_check::suspected_clocks(&simulated.triplets, plain, &simulated.network, 1e-4)
                .expect("a late clock");
        for (station, offset) in clocks.offsets_s.each().skip(1) {
            let truth_s = if station == late { 0.01 } else { 0.0 };
            assert!((offset.value - truth_s).abs() < 2e-3, "{prisms:?} {station}: {offset:?}");
        }
    }
}
