//! Scenarios with other numbers of stations and prisms than those of the presets.

use std::f64::consts::TAU;

use nalgebra::{Vector2, Vector3};

use super::errors::SystematicErrors;
use super::scenario::{Path, Scenario};
use super::waypoint::Waypoint;
use resect_core::network::{Pair, PerPrism, USUAL_STATIONS};

/// Distance of further stations from the centre of a winding path, as a multiple of its radius.
const OUTSIDE: f64 = 1.5;
/// Distance of further stations from the centre of other paths (m).
const BESIDE_M: f64 = 40.0;
/// Directions from the centre to further stations, against that from station 1 to the centre (turns): the far side first.
const DIRECTIONS: [f64; 5] = [0.0, 0.25, -0.25, 0.125, -0.125];
/// Distance of further stations behind the end of a tunnel, and from each other (m).
const BEHIND_M: f64 = 6.0;
const APART_M: f64 = 2.0;
/// Heights of further stations (m).
const HEIGHTS_M: [f64; 5] = [-0.15, 0.25, -0.35, 0.1, -0.05];
/// Directions in which a place for a further prism is searched.
const PRISM_DIRECTIONS: usize = 24;
/// Radius and height of a rig whose preset has a single prism (m).
const RIG_RADIUS_M: f64 = 0.5;
const RIG_HEIGHT_M: f64 = 0.35;

impl Scenario {
    /// Returns the number of stations.
    pub fn stations(&self) -> usize {
        self.stations_m.len() + 1
    }

    /// Returns the prism that a station follows: stations share prisms if there are fewer prisms.
    pub fn prism_of(&self, station: usize) -> usize {
        station % self.prisms_m.len()
    }

    /// Returns true if all stations follow one prism.
    pub fn is_one_prism(&self) -> bool {
        let mut prisms_m = self.prisms_m.iter();
        let first_m = prisms_m.next();
        prisms_m.all(|prism_m| Some(prism_m) == first_m)
    }

    /// Returns the number of different prisms.
    pub fn prisms(&self) -> usize {
        if self.is_one_prism() { 1 } else { self.prisms_m.len() }
    }

    /// Returns the scenario with these numbers of stations and prisms. Further stations stand around the path, further prisms are
    /// spread over the vehicle. The own numbers of a preset change nothing.
    pub fn with_network(mut self, stations: usize, prisms: usize) -> Self {
        for further in self.stations_m.len()..stations - 1 {
            let station_m = self.further_station_m(further.saturating_sub(2));
            self.stations_m.push(station_m);
        }
        self.stations_m.truncate(stations - 1);
        let is_usual = (stations, prisms) == (USUAL_STATIONS, self.prisms());
        if prisms != self.prisms() || (!is_usual && self.is_one_prism()) {
            if self.is_one_prism() {
                self.prisms_m.resize_with(1, Vector3::zeros);
            }
            while self.prisms_m.len() < prisms {
                self.prisms_m.push(further_prism_m(&self.prisms_m));
            }
            self.prisms_m.resize_with(prisms, Vector3::zeros);
        }
        self.errors.resize(stations, self.prisms_m.len());
        self
    }

    /// Returns the position of a station beyond those of the presets (m), the first of which has index 0.
    fn further_station_m(&self, index: usize) -> Vector3<f64> {
        let height_m = HEIGHTS_M[index % HEIGHTS_M.len()];
        let (centre_m, radius_m) = match &self.path {
            Path::Wander { centre_m, radius_m } => (Vector2::from(*centre_m), OUTSIDE * radius_m),
            Path::Tunnel { to_x_m, amplitude_m, .. } => {
                let side = if index.is_multiple_of(2) { 1.0 } else { -1.0 };
                let x_m = to_x_m + BEHIND_M + APART_M * index as f64;
                return Vector3::new(x_m, side * (amplitude_m + 0.3), height_m);
            }
            Path::Bends { start_m, .. } => (Vector2::from(*start_m), BESIDE_M),
            Path::Waypoints { waypoints, .. } => {
                let sum_m: Vector2<f64> = waypoints.iter().map(Waypoint::place_m).sum();
                (sum_m / waypoints.len().max(1) as f64, BESIDE_M)
            }
        };
        let towards_rad = centre_m.y.atan2(centre_m.x);
        let (sin, cos) = (towards_rad + TAU * DIRECTIONS[index % DIRECTIONS.len()]).sin_cos();
        let place_m = centre_m + radius_m * Vector2::new(cos, sin);
        Vector3::new(place_m.x, place_m.y, height_m)
    }
}

/// Returns the place on the vehicle that is furthest from all prisms (m), of the heights of the rig.
pub fn further_prism_m(prisms_m: &PerPrism<Vector3<f64>>) -> Vector3<f64> {
    let count = prisms_m.len() as f64;
    let middle_m = prisms_m.iter().sum::<Vector3<f64>>() / count;
    let radii_m = prisms_m.iter().map(|prism_m| (prism_m - middle_m).xy().norm());
    let largest_m = radii_m.fold(0.0, f64::max);
    let radius_m = if largest_m > 0.0 { largest_m } else { RIG_RADIUS_M };
    let heights = || prisms_m.iter().map(|prism_m| prism_m.z);
    let (low_m, high_m) = heights()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), own| (low.min(own), high.max(own)));
    let low_m = if high_m > low_m { low_m } else { high_m - RIG_HEIGHT_M };
    // A height that no other prism has.
    let height_m = low_m + (high_m - low_m) * (0.381_966 * count).fract();
    let nearest_m = |place_m: &Vector3<f64>| {
        let distances_m = prisms_m.iter().map(|prism_m| (prism_m - place_m).norm());
        distances_m.fold(f64::INFINITY, f64::min)
    };
    let places_m = (0..PRISM_DIRECTIONS).map(|direction| {
        let (sin, cos) = (TAU * direction as f64 / PRISM_DIRECTIONS as f64).sin_cos();
        Vector3::new(middle_m.x + radius_m * cos, middle_m.y + radius_m * sin, height_m)
    });
    places_m.max_by(|a, b| nearest_m(a).total_cmp(&nearest_m(b))).expect("there are directions")
}

impl SystematicErrors {
    /// Changes the numbers of stations and prisms; further ones have no errors.
    pub fn resize(&mut self, stations: usize, prisms: usize) {
        for by_station in [
            &mut self.clock_offset_s,
            &mut self.clock_drift,
            &mut self.latency_s,
            &mut self.range_offset_m,
            &mut self.range_scale,
            &mut self.index_rad,
            &mut self.collimation_rad,
        ] {
            by_station.resize_with(stations, || 0.0);
        }
        self.further.iter_mut().for_each(|error| error.sizes.resize_with(stations, || 0.0));
        self.tilt_rad.resize_with(stations, || [0.0; 2]);
        self.prism_offset_m.resize_with(prisms, || 0.0);
        self.inter_prism_m.resize_with(Pair::count(prisms), || 0.0);
        let is_there = |station: usize| station < stations;
        self.clock_steps.retain(|step| is_there(step.station));
        self.settling.retain(|settling| is_there(settling.station));
        self.set_up_changes.retain(|change| is_there(change.station));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::{Preset, simulate_scenario};

    #[test]
    fn the_own_numbers_of_a_preset_change_nothing() {
        for preset in Preset::ALL {
            let scenario = preset.scenario();
            let prisms = scenario.prisms();
            assert_eq!(scenario.clone().with_network(3, prisms), scenario);
        }
    }

    #[test]
    fn every_station_reads_its_prism_and_no_two_share_a_place() {
        for preset in [Preset::Warthog, Preset::Hd2Tunnel, Preset::SinglePrism, Preset::Circle] {
            for (stations, prisms) in [(1, 1), (2, 1), (2, 2), (4, 3), (4, 4), (6, 6), (8, 8)] {
                let mut scenario = preset.scenario().with_network(stations, prisms);
                assert_eq!((scenario.stations(), scenario.prisms()), (stations, prisms));
                scenario.duration_s = 20.0;
                let simulated = simulate_scenario(&scenario, 1);
                for station in 1..=stations as i64 {
                    let own = simulated.records.iter().filter(|own| own.station == station);
                    assert!(own.count() > 10, "{} {stations} {prisms}", preset.name());
                }
                let distances_m = &simulated.truth.inter_prism_m;
                assert_eq!(distances_m.len(), Pair::count(prisms));
                assert!(distances_m.iter().all(|distance_m| *distance_m > 0.07), "{distances_m:?}");
                let places_m = &scenario.stations_m;
                for (place, own_m) in places_m.iter().enumerate() {
                    assert!(own_m.norm() > 1.0);
                    assert!(places_m[..place].iter().all(|other_m| (own_m - other_m).norm() > 1.0));
                }
            }
        }
    }
}
