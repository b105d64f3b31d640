//! Distance residuals of one triplet and their Jacobian.

use nalgebra::{DMatrix, DVector, Matrix3, Rotation3, SMatrix, SVector, Vector3};

use crate::calibration::inter_prism::PAIRS;
use crate::calibration::{Clock, MovingTriplets};
use crate::geometry::{LevelTransform, RigidTransform};

/// Size of the state vector: (x, y, z, yaw) of stations 2 and 3; their clock offsets; the three distances; their tilts about their
/// own x and y; the jumps of their clocks; the error of the prism constant, which lengthens all ranges.
pub const UNKNOWNS: usize = 20;
pub const CLOCKS: usize = 8;
pub const DISTANCES: usize = 10;
pub const TILTS: usize = 13;
pub const JUMPS: usize = 17;
pub const CONSTANT: usize = 19;

pub type State = SVector<f64, UNKNOWNS>;
pub type Matrix = SMatrix<f64, UNKNOWNS, UNKNOWNS>;

/// Returns the rows and columns of some of the unknowns, in increasing order, of a symmetric matrix with a valid lower triangle.
pub fn reduced(matrix: &Matrix, places: &[usize]) -> DMatrix<f64> {
    let mut small = DMatrix::zeros(places.len(), places.len());
    for (j, column) in places.iter().enumerate() {
        for i in j..places.len() {
            small[(i, j)] = matrix[(places[i], *column)];
        }
    }
    small.fill_upper_triangle_with_lower_triangle();
    small
}

pub fn reduced_vector(vector: &State, places: &[usize]) -> DVector<f64> {
    DVector::from_fn(places.len(), |i, _| vector[places[i]])
}

/// Returns the clock of station 2 (slot 0) or 3.
pub fn clock(state: &State, slot: usize) -> Clock {
    Clock { offset_s: state[CLOCKS + slot], drift: state[JUMPS + slot] }
}

/// Returns the transforms from the frames of stations 1, 2, 3 to station 1's, with the tilt applied before the yaw.
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

/// Apparent minus estimated distance of each pair at one instant (m).
pub struct Residuals {
    pub residual_m: [f64; 3],
    /// Unit vectors from the second prism of each pair to the first (station 1's frame), and their distance (m).
    direction: [Vector3<f64>; 3],
    length_m: [f64; 3],
}

/// Distance residuals of one triplet, linearised about a state.
pub struct Linearised {
    /// Apparent minus estimated distance of each pair (m).
    pub residual_m: [f64; 3],
    /// Jacobian of the residual of each pair with respect to the state.
    pub derivative: [State; 3],
    /// Expectation of derivative × residual from noise alone.
    pub noise_pull: [State; 3],
}

impl Linearised {
    /// Linearises a triplet at a state, with the covariance of the noise of its separations (m², station 1's frame).
    pub fn at(
        data: &MovingTriplets<'_>,
        index: usize,
        state: &State,
        station1_from_station: &[RigidTransform; 3],
        covariance_m2: &[Matrix3<f64>; 3],
    ) -> Self {
        let found = distances(data, index, state, station1_from_station);
        let mut linearised = Self {
            residual_m: found.residuals.residual_m,
            derivative: [State::zeros(); 3],
            noise_pull: [State::zeros(); 3],
        };
        for pair in 0..3 {
            found.set_derivative(pair, &mut linearised.derivative[pair]);
            let pull = &mut linearised.noise_pull[pair];
            found.set_noise_pull(pair, &covariance_m2[pair], pull);
        }
        linearised
    }

    /// Updates the residuals for a small step of the state.
    pub fn step(&mut self, step: &State) {
        for (residual_m, derivative) in self.residual_m.iter_mut().zip(&self.derivative) {
            *residual_m += derivative.dot(step);
        }
    }
}

/// Distance residuals, and the Jacobians of the transformed points.
struct Distances {
    residuals: Residuals,
    /// Jacobian of each station's transformed point with respect to the unknowns of [`places`].
    moves: [[Vector3<f64>; 8]; 3],
    /// Line of sight of each station (station 1's frame).
    sights: [Vector3<f64>; 3],
}

/// Returns the indices of the unknowns that move the points of station 2 (slot 0) or 3.
fn places(slot: usize) -> [usize; 8] {
    let (at, tilt) = (4 * slot, TILTS + 2 * slot);
    [at, at + 1, at + 2, at + 3, CLOCKS + slot, JUMPS + slot, tilt, tilt + 1]
}

/// Returns the position of each station's prism (m), and its line of sight, both in the station's own frame.
fn seen(
    data: &MovingTriplets<'_>,
    index: usize,
    state: &State,
) -> ([Vector3<f64>; 3], [Vector3<f64>; 3]) {
    let sights = data
        .triplets
        .triplet_m(index)
        .map(|point_m| point_m.try_normalize(1e-9).unwrap_or_default());
    let points_m = std::array::from_fn(|station| {
        let seen_m = match station.checked_sub(1) {
            None => data.triplets.points_m[0][index],
            Some(slot) => data.at_true_time(station, index, clock(state, slot)),
        };
        seen_m - sights[station] * state[CONSTANT]
    });
    (points_m, sights)
}

/// Returns the residuals without their Jacobian.
pub fn residuals(
    data: &MovingTriplets<'_>,
    index: usize,
    state: &State,
    station1_from_station: &[RigidTransform; 3],
) -> Residuals {
    let (points_m, _) = seen(data, index, state);
    let [_, second, third] = station1_from_station;
    Residuals::between(&[points_m[0], second.apply(&points_m[1]), third.apply(&points_m[2])], state)
}

fn distances(
    data: &MovingTriplets<'_>,
    index: usize,
    state: &State,
    station1_from_station: &[RigidTransform; 3],
) -> Distances {
    let (points_m, sights) = seen(data, index, state);
    let mut moves = [[Vector3::zeros(); 8]; 3];
    let sights = std::array::from_fn(|k| station1_from_station[k].rotate(&sights[k]));
    let mut placed = points_m;
    for station in 1..3 {
        let transform = &station1_from_station[station];
        let point = &points_m[station];
        let moving = transform.rotate(&data.velocity_m_per_s[station][index]);
        let turned = transform.rotate(point);
        placed[station] = turned + transform.translation_m;
        let tilted_by = |axis: Vector3<f64>| transform.rotate(&axis.cross(point));
        moves[station] = [
            Vector3::x(),
            Vector3::y(),
            Vector3::z(),
            Vector3::z().cross(&turned),
            moving,
            moving * data.growth[index],
            // To first order in the tilt, which is arcseconds.
            tilted_by(Vector3::x()),
            tilted_by(Vector3::y()),
        ];
    }
    Distances { residuals: Residuals::between(&placed, state), moves, sights }
}

impl Residuals {
    /// Returns the distance residuals of prisms at given positions (m, station 1's frame).
    fn between(placed: &[Vector3<f64>; 3], state: &State) -> Self {
        let between = PAIRS.map(|(a, b)| placed[a] - placed[b]);
        let length_m = between.map(|between| between.norm().max(1e-9));
        Self {
            residual_m: std::array::from_fn(|pair| length_m[pair] - state[DISTANCES + pair]),
            direction: std::array::from_fn(|pair| between[pair] / length_m[pair]),
            length_m,
        }
    }

    /// Returns the variance of a pair's distance from the covariance of its separation (m²).
    pub fn variance_along_m2(&self, pair: usize, covariance_m2: &Matrix3<f64>) -> f64 {
        self.direction[pair].dot(&(covariance_m2 * self.direction[pair]))
    }
}

impl Distances {
    /// Sets the derivatives of a pair's separation along a vector with respect to each unknown that moves points.
    fn set_moved_along(&self, pair: usize, vector: &Vector3<f64>, moved: &mut State) {
        let (a, b) = PAIRS[pair];
        moved[CONSTANT] = vector.dot(&(self.sights[b] - self.sights[a]));
        for (station, sign) in [(a, 1.0), (b, -1.0)].into_iter().filter(|(s, _)| *s > 0) {
            for (place, step) in places(station - 1).into_iter().zip(&self.moves[station]) {
                moved[place] = sign * vector.dot(step);
            }
        }
    }

    fn set_derivative(&self, pair: usize, derivative: &mut State) {
        self.set_moved_along(pair, &self.residuals.direction[pair], derivative);
        derivative[DISTANCES + pair] = -1.0;
    }

    /// Sets the expectation of derivative × residual from noise alone.
    ///
    /// Let the noise n of a separation of length d along u have covariance Σ. The residual is u·n + nᵀ(I − uuᵀ)n/2d, and u itself
    /// rotates by (I − uuᵀ)n/d, so that E[r u] = (I − uuᵀ)Σu/d + u tr((I − uuᵀ)Σ)/2d. In weakly observable directions, such as
    /// height and distance on level ground, this bias of a sum moves the answer by centimetres.
    fn set_noise_pull(&self, pair: usize, covariance_m2: &Matrix3<f64>, pull: &mut State) {
        let (unit, length_m) = (&self.residuals.direction[pair], self.residuals.length_m[pair]);
        let pulled = covariance_m2 * unit;
        let along = unit.dot(&pulled);
        let longer_m = (covariance_m2.trace() - along) / (2.0 * length_m);
        let turned = (pulled - along * unit) / length_m + longer_m * unit;
        self.set_moved_along(pair, &turned, pull);
        pull[DISTANCES + pair] = -longer_m;
    }
}

/// Nominal noise of a total station: range (m, and share of the range), and both angles (rad).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PolarNoise {
    pub range_m: f64,
    pub range_share: f64,
    pub angle_rad: f64,
}

impl PolarNoise {
    /// Returns the covariance of a measured point (m², the station's frame).
    pub fn covariance_m2(&self, point_m: &Vector3<f64>) -> Matrix3<f64> {
        let range_m = point_m.norm().max(1e-9);
        let sight = point_m / range_m;
        let along = (self.range_m + self.range_share * range_m).powi(2);
        let across = (self.angle_rad * range_m).powi(2);
        Matrix3::identity() * across + sight * sight.transpose() * (along - across)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::Triplets;

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
            3e-6, 1e-6, 2e-3, -1e-3, 4e-4,
        ]
        .into_iter()
        .enumerate()
        {
            state[place] = value;
        }
        let at = |state: &State| residuals(&data, 1, state, &transforms(state));
        let here = Linearised::at(&data, 1, &state, &transforms(&state), &[Matrix3::zeros(); 3]);
        assert_eq!(here.residual_m, at(&state).residual_m);
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
        let covariance = noise.covariance_m2(&point);
        let (along, across) = (covariance[(0, 0)].sqrt(), covariance[(1, 1)].sqrt());
        assert!(
            (along - 0.0022).abs() < 1e-9 && (across - 0.0005).abs() < 1e-9,
            "{along} {across}"
        );
    }
}
