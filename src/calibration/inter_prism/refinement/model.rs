//! The distances of one triplet as a function of everything that can be estimated.

use std::borrow::Cow;

use nalgebra::{Matrix3, Rotation3, SVector, Vector3};

use crate::deployment::PAIRS;
use crate::geometry::{LevelTransform, RigidTransform};
use crate::pipeline::Triplets;

/// (x, y, z, yaw) of stations 2 and 3; their clock offsets; the three distances; their tilts about their own x and y.
pub const UNKNOWNS: usize = 17;
pub const CLOCKS: usize = 8;
pub const DISTANCES: usize = 10;
pub const TILTS: usize = 13;

pub type State = SVector<f64, UNKNOWNS>;

/// Triplets with the velocities of their prisms, each in its station's frame.
pub struct MovingTriplets<'a> {
    pub triplets: Cow<'a, Triplets>,
    /// m/s; by differences with the neighbours of the same interval.
    velocity_m_per_s: [Vec<Vector3<f64>>; 3],
}

impl<'a> MovingTriplets<'a> {
    pub fn all(triplets: &'a Triplets) -> Self {
        let velocity_m_per_s = velocities(triplets, 1);
        Self { triplets: Cow::Borrowed(triplets), velocity_m_per_s }
    }

    /// Every so many of them, with the velocities that they have among all.
    pub fn every(triplets: &Triplets, stride: usize) -> Self {
        let indices: Vec<usize> = (0..triplets.len()).step_by(stride).collect();
        let velocity_m_per_s = velocities(triplets, stride);
        Self { triplets: Cow::Owned(triplets.select(&indices)), velocity_m_per_s }
    }

    /// Where a station's prism was when its stamp, `late_s` late, says so (m, the station's frame).
    pub fn at_true_time(&self, station: usize, index: usize, late_s: f64) -> Vector3<f64> {
        self.triplets.points_m[station][index] + late_s * self.velocity_m_per_s[station][index]
    }
}

fn velocities(triplets: &Triplets, stride: usize) -> [Vec<Vector3<f64>>; 3] {
    let last = triplets.len().saturating_sub(1);
    let velocity = |station: usize| {
        let points = &triplets.points_m[station];
        let at = |i: usize| {
            let same = |j: usize| triplets.interval[j] == triplets.interval[i];
            let before = if i > 0 && same(i - 1) { i - 1 } else { i };
            let after = if i < last && same(i + 1) { i + 1 } else { i };
            let span_s = triplets.time_s[after] - triplets.time_s[before];
            if span_s > 0.0 { (points[after] - points[before]) / span_s } else { Vector3::zeros() }
        };
        (0..triplets.len()).step_by(stride).map(at).collect()
    };
    [velocity(0), velocity(1), velocity(2)]
}

/// Frames of stations 1, 2, 3 into station 1's: the yaw turns what the tilt has put upright.
pub fn transforms(state: &State) -> [RigidTransform; 3] {
    let one = |slot: usize| {
        let at = 4 * slot;
        let yaw = Rotation3::from_axis_angle(&Vector3::z_axis(), state[at + 3]);
        let tilt =
            Rotation3::new(Vector3::new(state[TILTS + 2 * slot], state[TILTS + 2 * slot + 1], 0.0));
        RigidTransform {
            rotation: yaw * tilt,
            translation_m: Vector3::new(state[at], state[at + 1], state[at + 2]),
        }
    };
    [LevelTransform::IDENTITY.into(), one(0), one(1)]
}

/// Apparent minus estimated distance of each pair at one instant (m), its derivatives, and the unit vectors between the
/// prisms (station 1's frame).
pub struct Distances {
    pub residual_m: [f64; 3],
    pub derivative: [State; 3],
    pub direction: [Vector3<f64>; 3],
}

pub fn distances(
    data: &MovingTriplets<'_>,
    index: usize,
    state: &State,
    station1_from_station: &[RigidTransform; 3],
) -> Distances {
    let mut placed = [data.triplets.points_m[0][index]; 3];
    // How each placed point moves with the unknowns of its own station.
    let mut moves = [[Vector3::zeros(); 7]; 3];
    for station in 1..3 {
        let slot = station - 1;
        let transform = &station1_from_station[station];
        let point = data.at_true_time(station, index, state[CLOCKS + slot]);
        let turned = transform.rotate(&point);
        placed[station] = turned + transform.translation_m;
        let tilted_by = |axis: Vector3<f64>| transform.rotate(&axis.cross(&point));
        moves[station] = [
            Vector3::x(),
            Vector3::y(),
            Vector3::z(),
            Vector3::z().cross(&turned),
            transform.rotate(&data.velocity_m_per_s[station][index]),
            // To first order in the tilt, which is arcseconds.
            tilted_by(Vector3::x()),
            tilted_by(Vector3::y()),
        ];
    }
    let mut result = Distances {
        residual_m: [0.0; 3],
        derivative: [State::zeros(); 3],
        direction: [Vector3::zeros(); 3],
    };
    for (pair, (a, b)) in PAIRS.into_iter().enumerate() {
        let between = placed[a] - placed[b];
        let length_m = between.norm();
        let unit = between / length_m.max(1e-9);
        result.residual_m[pair] = length_m - state[DISTANCES + pair];
        result.direction[pair] = unit;
        let derivative = &mut result.derivative[pair];
        derivative[DISTANCES + pair] = -1.0;
        for (station, sign) in [(a, 1.0), (b, -1.0)] {
            if station == 0 {
                continue;
            }
            let slot = station - 1;
            let places = [
                4 * slot,
                4 * slot + 1,
                4 * slot + 2,
                4 * slot + 3,
                CLOCKS + slot,
                TILTS + 2 * slot,
                TILTS + 2 * slot + 1,
            ];
            for (place, step) in places.into_iter().zip(&moves[station]) {
                derivative[place] += sign * unit.dot(step);
            }
        }
    }
    result
}

/// Nominal noise of a total station: range (m, and parts of the range), and both angles (rad).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PolarNoise {
    pub range_m: f64,
    pub range_share: f64,
    pub angle_rad: f64,
}

impl PolarNoise {
    /// Variance (m²) along a direction, given in the station's frame, of a point that the station sees there.
    pub fn variance_along(&self, point_m: &Vector3<f64>, direction: &Vector3<f64>) -> f64 {
        let range_m = point_m.norm();
        let along = (point_m.dot(direction) / range_m.max(1e-9)).powi(2);
        let range_sigma_m = self.range_m + self.range_share * range_m;
        along * range_sigma_m.powi(2) + (1.0 - along) * (self.angle_rad * range_m).powi(2)
    }
}

/// Rotation that takes a direction of station 1's frame into a station's own.
pub fn back(transform: &RigidTransform) -> Matrix3<f64> {
    transform.rotation.matrix().transpose()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_the_differences() {
        let points: [Vec<Vector3<f64>>; 3] = [0.0, 1.0, 2.0].map(|k| {
            (0..3)
                .map(|i| {
                    Vector3::new(
                        20.0 + 0.1 * f64::from(i) + k,
                        7.0 - k * 0.6,
                        0.3 * k + 0.02 * f64::from(i),
                    )
                })
                .collect()
        });
        let triplets = Triplets::new(vec![0.0, 0.1, 0.2], vec![0; 3], points);
        let data = MovingTriplets::all(&triplets);
        let mut state = State::zeros();
        for (place, value) in [
            0.3, -0.2, 0.5, 0.4, -0.6, 0.1, 0.2, -0.3, 0.004, -0.003, 0.7, 0.9, 1.0, 1e-6, -2e-6,
            3e-6, 1e-6,
        ]
        .into_iter()
        .enumerate()
        {
            state[place] = value;
        }
        let at = |state: &State| distances(&data, 1, state, &transforms(state));
        let here = at(&state);
        for unknown in 0..UNKNOWNS {
            let step = 1e-6;
            let (mut up, mut down) = (state, state);
            up[unknown] += step;
            down[unknown] -= step;
            for pair in 0..3 {
                let numeric =
                    (at(&up).residual_m[pair] - at(&down).residual_m[pair]) / (2.0 * step);
                let exact = here.derivative[pair][unknown];
                assert!(
                    (numeric - exact).abs() < 2e-4 * (1.0 + exact.abs()),
                    "{unknown} {pair}: {numeric} {exact}"
                );
            }
        }
    }

    #[test]
    fn noise_is_the_range_s_along_the_sight_and_the_angle_s_across() {
        let noise = PolarNoise { range_m: 0.002, range_share: 2e-6, angle_rad: 5e-6 };
        let point = Vector3::new(100.0, 0.0, 0.0);
        let along = noise.variance_along(&point, &Vector3::x()).sqrt();
        let across = noise.variance_along(&point, &Vector3::y()).sqrt();
        assert!(
            (along - 0.0022).abs() < 1e-9 && (across - 0.0005).abs() < 1e-9,
            "{along} {across}"
        );
    }
}
