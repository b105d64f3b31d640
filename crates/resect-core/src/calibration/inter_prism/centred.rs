//! Triplets in the layout of the solver: separate coordinates, relative to the centroid of each station's points.
//!
//! With centred points the yaw rotates about the middle of the track instead of about a station 100 m away. Yaw and translation are
//! then hardly correlated, and the normal equations are well conditioned.

use nalgebra::{DVector, Vector3};

use super::PrismNetwork;
use super::prism_network::first_unknown;
use super::same_solution::same_pose;
use crate::geometry::LevelTransform;
use crate::network::{PerStation, Station};
use crate::pipeline::Triplets;

/// Fewest triplets of an answer; with three stations, each has three residuals, and there are eight unknowns.
pub const FEWEST_TRIPLETS: usize = 10;

/// (x, y, z, yaw) of station 2, then of each further one (m, rad), relative to the centroids.
pub type Parameters = DVector<f64>;

/// Points of each station as three lists of coordinates relative to their centroid (m).
#[derive(Clone, Debug)]
pub struct CentredTriplets {
    /// Centroid of each station's points in its own frame (m).
    pub centre_m: PerStation<Vector3<f64>>,
    /// Coordinates relative to the centroids (m), as `coordinates[station][axis][instant]`.
    pub coordinates: PerStation<[Vec<f64>; 3]>,
    pub network: PrismNetwork,
}

impl CentredTriplets {
    pub fn new(triplets: &Triplets, network: &PrismNetwork) -> Self {
        Self::of(triplets.points_m.map(|points| centred(&points.iter())), network)
    }

    /// Returns some of the triplets, relative to their own centroids.
    pub fn some(triplets: &Triplets, instants: &[usize], network: &PrismNetwork) -> Self {
        let some = |points: &Vec<_>| centred(&instants.iter().map(|i| &points[*i]));
        Self::of(triplets.points_m.map(some), network)
    }

    /// Converts points by station (m, each in its station's frame). Frees the memory of each station's points after its conversion.
    pub fn from_points(points_m: PerStation<Vec<Vector3<f64>>>, network: &PrismNetwork) -> Self {
        let stations = points_m.into_iter().map(|points| centred(&points.iter()));
        Self::of(stations.collect(), network)
    }

    fn of(stations: PerStation<(Vector3<f64>, [Vec<f64>; 3])>, network: &PrismNetwork) -> Self {
        assert_eq!(stations.len(), network.stations(), "stations of the triplets");
        let centre_m = stations.map(|(centre_m, _)| *centre_m);
        let coordinates = stations.into_iter().map(|(_, coordinates)| coordinates).collect();
        Self { centre_m, coordinates, network: network.clone() }
    }

    /// Returns the chosen instants in the given order, relative to the centroids of all.
    pub fn select(&self, instants: &[usize]) -> Self {
        self.map(|list| instants.iter().map(|i| list[*i]).collect())
    }

    /// Returns the first instants, relative to the centroids of all.
    pub fn first(&self, count: usize) -> Self {
        self.map(|list| list[..count].to_vec())
    }

    /// Returns at most `count` instants, evenly spread, relative to the centroids of all.
    pub fn thinned(&self, count: usize) -> Self {
        let step = self.len().div_ceil(count).max(1);
        self.map(|list| list.iter().step_by(step).copied().collect())
    }

    fn map(&self, pick: impl Fn(&[f64]) -> Vec<f64>) -> Self {
        let coordinates = self.coordinates.map(|station| station.each_ref().map(|list| pick(list)));
        Self { centre_m: self.centre_m.clone(), coordinates, network: self.network.clone() }
    }

    pub fn len(&self) -> usize {
        self.coordinates[Station::FIRST][0].len()
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the mean square of the errors of all distances (m²), from their sum of squares.
    pub fn mean_square_m2(&self, cost_m2: f64) -> f64 {
        cost_m2 / (self.network.pairs.len() * self.len()) as f64
    }

    /// Returns the pose of a station's centred frame in that of station 1.
    pub fn pose(&self, parameters: &Parameters, station: Station) -> LevelTransform {
        first_unknown(station).map_or(LevelTransform::IDENTITY, |first| {
            let moved = parameters.fixed_rows::<3>(first).into_owned();
            LevelTransform::new(moved, parameters[first + 3])
        })
    }

    /// Returns the points of one instant, relative to station 1's centroid (m, station 1's frame).
    pub fn placed_m(&self, parameters: &Parameters, instant: usize) -> PerStation<Vector3<f64>> {
        self.coordinates.map_each(|station, [x, y, z]| {
            let point = Vector3::new(x[instant], y[instant], z[instant]);
            self.pose(parameters, station).apply(&point)
        })
    }

    /// Returns the parameters of transforms: `q1 − c1 = R (q − c) + t'` with `t' = t + R c − c1`.
    pub fn parameters(&self, station1_from_station: &PerStation<LevelTransform>) -> Parameters {
        let mut parameters = Parameters::zeros(self.network.unknowns());
        for (station, transform) in station1_from_station.each() {
            if let Some(first) = first_unknown(station) {
                let moved =
                    transform.apply(&self.centre_m[station]) - self.centre_m[Station::FIRST];
                parameters.fixed_rows_mut::<3>(first).copy_from(&moved);
                parameters[first + 3] = transform.yaw_rad;
            }
        }
        parameters
    }

    /// Returns the transforms of parameters: the inverse of [`CentredTriplets::parameters`].
    pub fn transforms(&self, parameters: &Parameters) -> PerStation<LevelTransform> {
        self.centre_m.map_each(|station, _| self.transform(parameters, station))
    }

    fn transform(&self, parameters: &Parameters, station: Station) -> LevelTransform {
        if station == Station::FIRST {
            return LevelTransform::IDENTITY;
        }
        let pose = self.pose(parameters, station);
        let turned_m = pose.rotate(&self.centre_m[station]);
        let translation_m = self.centre_m[Station::FIRST] + pose.translation_m - turned_m;
        LevelTransform::new(translation_m, pose.yaw_rad)
    }

    /// Returns true if two solutions are the same minimum.
    pub fn are_same(&self, a: &Parameters, b: &Parameters) -> bool {
        self.network
            .unknown_stations()
            .all(|station| same_pose(&self.transform(a, station), &self.transform(b, station)))
    }

    /// Returns the mean height of station 1's prism above that of each station (m). The centred points have mean zero.
    pub fn height_differences_m(&self, parameters: &Parameters) -> PerStation<f64> {
        self.centre_m.map_each(|station, _| {
            first_unknown(station).map_or(0.0, |first| -parameters[first + 2])
        })
    }

    /// Returns a solution with all heights mirrored in that of station 1's prism.
    pub fn mirrored_in_height(&self, parameters: &Parameters) -> Parameters {
        let flip = |station: Station| station != Station::FIRST;
        self.flipped(parameters, &PerStation::from_fn(self.network.stations(), flip))
    }

    /// Returns a solution with the heights of the chosen stations' prisms mirrored in that of station 1's prism.
    pub fn flipped(&self, parameters: &Parameters, flips: &PerStation<bool>) -> Parameters {
        let mut mirrored = parameters.clone();
        for (station, _) in flips.each().filter(|(_, flip)| **flip) {
            if let Some(first) = first_unknown(station) {
                mirrored[first + 2] = -mirrored[first + 2];
            }
        }
        mirrored
    }

    /// Returns a solution with the rig rotated about the vertical through station 1's prism.
    pub fn turned(&self, parameters: &Parameters, angle_rad: f64) -> Parameters {
        let (sin, cos) = angle_rad.sin_cos();
        self.changed_in_plan(parameters, |x, y| (cos * x - sin * y, sin * x + cos * y))
    }

    /// Returns a solution with the rig mirrored in a vertical plane through station 1's prism, in the direction `angle_rad`.
    pub fn mirrored_in_plane(&self, parameters: &Parameters, angle_rad: f64) -> Parameters {
        let (sin, cos) = (2.0 * angle_rad).sin_cos();
        self.changed_in_plan(parameters, |x, y| (cos * x + sin * y, sin * x - cos * y))
    }

    fn changed_in_plan(
        &self,
        parameters: &Parameters,
        change: impl Fn(f64, f64) -> (f64, f64),
    ) -> Parameters {
        let mut changed = parameters.clone();
        for first in self.network.unknown_stations().filter_map(first_unknown) {
            let (x, y) = change(parameters[first], parameters[first + 1]);
            (changed[first], changed[first + 1]) = (x, y);
        }
        changed
    }

    /// Returns the distance errors (m): those of all pairs of a triplet, then those of the next one.
    pub fn distance_errors_m(&self, parameters: &Parameters) -> Vec<f64> {
        let poses = self.coordinates.map_each(|station, _| self.pose(parameters, station));
        let mut placed_m = vec![Vector3::zeros(); self.network.stations()];
        let mut errors_m = Vec::with_capacity(self.network.pairs.len() * self.len());
        for i in 0..self.len() {
            let stations = self.coordinates.iter().zip(&poses);
            for (placed_m, ([x, y, z], pose)) in placed_m.iter_mut().zip(stations) {
                *placed_m = pose.apply(&Vector3::new(x[i], y[i], z[i]));
            }
            errors_m.extend(self.network.errors_m(&placed_m));
        }
        errors_m
    }
}

/// Returns the centroid of some points (m), and their coordinates relative to it by axis.
fn centred<'a>(
    points_m: &(impl ExactSizeIterator<Item = &'a Vector3<f64>> + Clone),
) -> (Vector3<f64>, [Vec<f64>; 3]) {
    let count = points_m.len().max(1) as f64;
    let centre_m = points_m.clone().sum::<Vector3<f64>>() / count;
    let along = |axis: usize| points_m.clone().map(|p| p[axis] - centre_m[axis]).collect();
    (centre_m, std::array::from_fn(along))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_and_transforms_are_inverse() {
        let points = |offset: f64| -> Vec<Vector3<f64>> {
            (0..5).map(|i| Vector3::new(f64::from(i), offset, 0.3 * f64::from(i * i))).collect()
        };
        let triplets =
            Triplets::new(vec![0.0; 5], vec![0; 5], [points(10.0), points(-30.0), points(55.0)]);
        let data = CentredTriplets::new(&triplets, &PrismNetwork::of_own_prisms([1.0; 3]));
        let transforms = PerStation::from([
            LevelTransform::IDENTITY,
            LevelTransform::new(Vector3::new(5.0, -2.0, 0.4), 0.7),
            LevelTransform::new(Vector3::new(-3.0, 1.0, 0.1), -2.9),
        ]);
        let back = data.transforms(&data.parameters(&transforms));
        for (a, b) in transforms.iter().zip(&back) {
            assert!((a.translation_m - b.translation_m).norm() < 1e-12);
            assert!((a.yaw_rad - b.yaw_rad).abs() < 1e-12);
        }
    }
}
