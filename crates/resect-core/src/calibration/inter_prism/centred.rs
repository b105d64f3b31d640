//! Triplets in the layout of the solver: separate coordinates, relative to the centroid of each station's points.
//!
//! With centred points the yaw rotates about the middle of the track instead of about a station 100 m away. Yaw and translation are
//! then hardly correlated, and the normal equations are well conditioned.

use nalgebra::{SVector, Vector3};

use crate::geometry::LevelTransform;
use crate::network::PerStation;
use crate::pipeline::Triplets;

/// Fewest triplets of an answer; each has three residuals, and there are eight unknowns.
pub const FEWEST_TRIPLETS: usize = 10;

/// (x, y, z, yaw) of station 2, then of station 3 (m, rad), relative to the centroids.
pub type Parameters = SVector<f64, 8>;

/// Points of the three stations as nine lists of coordinates relative to their centroids (m).
#[derive(Clone, Debug)]
pub struct CentredTriplets {
    /// Centroid of each station's points in its own frame (m).
    pub centre_m: [Vector3<f64>; 3],
    /// Coordinates relative to the centroids (m), as `coordinates[station][axis][instant]`.
    pub coordinates: [[Vec<f64>; 3]; 3],
    /// Inter-prism distances α, β, γ (m).
    pub inter_prism_m: [f64; 3],
}

impl CentredTriplets {
    pub fn new(triplets: &Triplets, inter_prism_m: [f64; 3]) -> Self {
        Self::of(triplets.points_m.map(|points| centred(&points.iter())), inter_prism_m)
    }

    /// Returns some of the triplets, relative to their own centroids.
    pub fn some(triplets: &Triplets, instants: &[usize], inter_prism_m: [f64; 3]) -> Self {
        let some = |points: &Vec<_>| centred(&instants.iter().map(|i| &points[*i]));
        Self::of(triplets.points_m.map(some), inter_prism_m)
    }

    /// Converts points by station (m, each in its station's frame). Frees the memory of each station's points after its conversion.
    pub fn from_points(points_m: PerStation<Vec<Vector3<f64>>>, inter_prism_m: [f64; 3]) -> Self {
        let stations = points_m.into_iter().map(|points| centred(&points.iter()));
        Self::of(stations.collect(), inter_prism_m)
    }

    fn of(stations: PerStation<(Vector3<f64>, [Vec<f64>; 3])>, inter_prism_m: [f64; 3]) -> Self {
        let stations = stations.into_array::<3>().expect("three stations");
        let centre_m = stations.each_ref().map(|(centre_m, _)| *centre_m);
        let coordinates = stations.map(|(_, coordinates)| coordinates);
        Self { centre_m, coordinates, inter_prism_m }
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
        let coordinates =
            self.coordinates.each_ref().map(|station| station.each_ref().map(|list| pick(list)));
        Self { centre_m: self.centre_m, coordinates, inter_prism_m: self.inter_prism_m }
    }

    pub fn len(&self) -> usize {
        self.coordinates[0][0].len()
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the parameters of transforms: `q1 − c1 = R (q − c) + t'` with `t' = t + R c − c1`.
    pub fn parameters(&self, station1_from_station: &[LevelTransform]) -> Parameters {
        let mut parameters = Parameters::zeros();
        for (slot, station) in [1, 2].into_iter().enumerate() {
            let transform = &station1_from_station[station];
            let moved = transform.apply(&self.centre_m[station]) - self.centre_m[0];
            parameters.fixed_rows_mut::<3>(4 * slot).copy_from(&moved);
            parameters[4 * slot + 3] = transform.yaw_rad;
        }
        parameters
    }

    /// Returns the transforms of parameters: the inverse of [`CentredTriplets::parameters`].
    pub fn transforms(&self, parameters: &Parameters) -> [LevelTransform; 3] {
        let transform = |slot: usize| {
            let moved = parameters.fixed_rows::<3>(4 * slot).into_owned();
            let turn = LevelTransform::new(Vector3::zeros(), parameters[4 * slot + 3]);
            let translation_m = self.centre_m[0] + moved - turn.rotate(&self.centre_m[slot + 1]);
            LevelTransform::new(translation_m, turn.yaw_rad)
        };
        [LevelTransform::IDENTITY, transform(0), transform(1)]
    }

    /// Returns the mean heights of prism 1 above prisms 2 and 3 (m). The centred points have mean zero.
    pub fn height_differences_m(&self, parameters: &Parameters) -> [f64; 2] {
        [-parameters[2], -parameters[6]]
    }

    /// Returns a solution with the heights of the chosen stations' prisms mirrored in that of prism 1.
    pub fn mirrored_in_height(&self, parameters: &Parameters, flips: [bool; 2]) -> Parameters {
        let mut mirrored = *parameters;
        for (slot, _) in flips.iter().enumerate().filter(|(_, flip)| **flip) {
            mirrored[4 * slot + 2] = -mirrored[4 * slot + 2];
        }
        mirrored
    }

    /// Returns a solution with the rig rotated about the vertical through prism 1.
    pub fn turned(&self, parameters: &Parameters, angle_rad: f64) -> Parameters {
        let (sin, cos) = angle_rad.sin_cos();
        let mut turned = *parameters;
        for at in [0, 4] {
            let (x, y) = (parameters[at], parameters[at + 1]);
            turned[at] = cos * x - sin * y;
            turned[at + 1] = sin * x + cos * y;
        }
        turned
    }

    /// Returns a solution with the rig mirrored in a vertical plane through prism 1, in the direction `angle_rad`.
    pub fn mirrored_in_plane(&self, parameters: &Parameters, angle_rad: f64) -> Parameters {
        let (sin, cos) = (2.0 * angle_rad).sin_cos();
        let mut mirrored = *parameters;
        for at in [0, 4] {
            let (x, y) = (parameters[at], parameters[at + 1]);
            mirrored[at] = cos * x + sin * y;
            mirrored[at + 1] = sin * x - cos * y;
        }
        mirrored
    }

    /// Returns the distance errors (m): three of each triplet, for pairs 12, 13, 23.
    pub fn distance_errors_m(&self, parameters: &Parameters) -> Vec<f64> {
        let poses = [0, 4].map(|at| {
            let moved = Vector3::new(parameters[at], parameters[at + 1], parameters[at + 2]);
            LevelTransform::new(moved, parameters[at + 3])
        });
        let point = |station: usize, i: usize| {
            let [x, y, z] = &self.coordinates[station];
            Vector3::new(x[i], y[i], z[i])
        };
        let mut errors = Vec::with_capacity(3 * self.len());
        for i in 0..self.len() {
            let placed = [point(0, i), poses[0].apply(&point(1, i)), poses[1].apply(&point(2, i))];
            for (pair, (a, b)) in crate::calibration::inter_prism::PAIRS.into_iter().enumerate() {
                errors.push((placed[a] - placed[b]).norm() - self.inter_prism_m[pair]);
            }
        }
        errors
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
        let data = CentredTriplets::new(&triplets, [1.0; 3]);
        let transforms = [
            LevelTransform::IDENTITY,
            LevelTransform::new(Vector3::new(5.0, -2.0, 0.4), 0.7),
            LevelTransform::new(Vector3::new(-3.0, 1.0, 0.1), -2.9),
        ];
        let back = data.transforms(&data.parameters(&transforms));
        for (a, b) in transforms.iter().zip(back) {
            assert!((a.translation_m - b.translation_m).norm() < 1e-12);
            assert!((a.yaw_rad - b.yaw_rad).abs() < 1e-12);
        }
    }
}
