//! Residuals of one triplet and their Jacobian.

use std::ops::Range;

use nalgebra::{DMatrix, DVector, Matrix3, Rotation3, Vector3};

use crate::calibration::inter_prism::PrismNetwork;
use crate::calibration::inter_prism::prism_network::{UNKNOWNS_PER_STATION, first_unknown};
use crate::calibration::{Clock, MovingTriplets};
use crate::geometry::{LevelTransform, RigidTransform};
use crate::linear_algebra::sums::OUTER;
use crate::network::{Number, Pair, PerStation, Station, StationPair};

/// Values of the unknowns of a [`ClockCheckModel`].
pub type State = DVector<f64>;

/// The unknowns and the residuals of the clock check.
///
/// The state vector has (x, y, z, yaw) of all stations but the first; their clock offsets; the distances of all pairs of prisms; the
/// stations' tilts about their own x and y; the jumps of their clocks; the error of the prism constant, which lengthens all ranges.
pub struct ClockCheckModel {
    /// Number of stations with unknowns.
    moving: usize,
    /// The pairs of prisms whose distances are unknowns, with the rig's distances (m).
    pub distances_m: Vec<(Pair, f64)>,
    /// The residuals of a triplet.
    pub residuals: Vec<ObservedResidual>,
}

/// A residual of two stations.
pub struct ObservedResidual {
    stations: StationPair,
    /// Index of the pair in the network.
    pub pair: usize,
    kind: ResidualKind,
}

enum ResidualKind {
    /// The distance between two prisms, which is this unknown.
    Distance { unknown: usize },
    /// A coordinate of the vector between two positions of one prism.
    Coordinate { axis: usize },
}

impl ClockCheckModel {
    pub fn new(network: &PrismNetwork) -> Self {
        let distance_m = |prisms: Pair| {
            let pair = network.pairs.iter().find(|pair| pair.prisms == Some(prisms));
            (prisms, pair.map_or(0.0, |pair| pair.distance_m))
        };
        let mut model = Self {
            moving: network.stations() - 1,
            distances_m: network.prism_pairs().into_iter().map(distance_m).collect(),
            residuals: Vec::new(),
        };
        for (index, pair) in network.pairs.iter().enumerate() {
            let place =
                model.distances_m.iter().position(|(prisms, _)| Some(*prisms) == pair.prisms);
            let kinds = match place {
                Some(place) => {
                    vec![ResidualKind::Distance { unknown: model.distances().start + place }]
                }
                None => (0..3).map(|axis| ResidualKind::Coordinate { axis }).collect(),
            };
            let stations = pair.stations;
            let residual = |kind| ObservedResidual { stations, pair: index, kind };
            model.residuals.extend(kinds.into_iter().map(residual));
        }
        model
    }

    /// Returns the indices of the poses.
    pub fn poses(&self) -> Range<usize> {
        0..UNKNOWNS_PER_STATION * self.moving
    }

    pub fn clocks(&self) -> Range<usize> {
        let start = self.poses().end;
        start..start + self.moving
    }

    pub fn distances(&self) -> Range<usize> {
        let start = self.clocks().end;
        start..start + self.distances_m.len()
    }

    pub fn tilts(&self) -> Range<usize> {
        let start = self.distances().end;
        start..start + 2 * self.moving
    }

    pub fn jumps(&self) -> Range<usize> {
        let start = self.tilts().end;
        start..start + self.moving
    }

    /// Returns the index of the error of the prism constant.
    pub fn constant(&self) -> usize {
        self.jumps().end
    }

    /// Returns the length of the state vector: the unknowns, and unused ones for vector instructions.
    pub fn order(&self) -> usize {
        (self.constant() + 1).next_multiple_of(OUTER)
    }

    /// Returns the indices of the unknowns that are estimated. Tilts are constrained: their σ only widens the covariance.
    pub fn estimated(&self) -> Vec<usize> {
        (0..self.tilts().start).chain(self.jumps()).chain([self.constant()]).collect()
    }

    /// Returns the clock of a station; correct of station 1.
    pub fn clock(&self, state: &State, station: Station) -> Clock {
        station.slot().map_or(Clock { offset_s: 0.0, drift: 0.0 }, |slot| Clock {
            offset_s: state[self.clocks().start + slot],
            drift: state[self.jumps().start + slot],
        })
    }

    /// Returns the transforms from the frames of the stations to station 1's, with the tilt applied before the yaw.
    pub fn transforms(&self, state: &State) -> PerStation<RigidTransform> {
        PerStation::from_fn(self.moving + 1, |station: Station| {
            let Some(slot) = station.slot() else { return LevelTransform::IDENTITY.into() };
            let (first, tilt) = (UNKNOWNS_PER_STATION * slot, self.tilts().start + 2 * slot);
            let yaw = Rotation3::from_axis_angle(&Vector3::z_axis(), state[first + 3]);
            RigidTransform {
                rotation: yaw * Rotation3::new(Vector3::new(state[tilt], state[tilt + 1], 0.0)),
                translation_m: Vector3::new(state[first], state[first + 1], state[first + 2]),
            }
        })
    }

    /// Returns the indices of the unknowns that move the points of a station; `None` of station 1.
    fn places(&self, station: Station) -> Option<[usize; 8]> {
        let (slot, at) = (station.slot()?, first_unknown(station)?);
        let tilt = self.tilts().start + 2 * slot;
        let (clock, jump) = (self.clocks().start + slot, self.jumps().start + slot);
        Some([at, at + 1, at + 2, at + 3, clock, jump, tilt, tilt + 1])
    }
}

/// Returns the rows and columns of some of the unknowns, in increasing order, of a symmetric matrix with a valid lower triangle.
pub fn reduced(matrix: &DMatrix<f64>, places: &[usize]) -> DMatrix<f64> {
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

/// One residual of a triplet.
pub struct Residual {
    /// Apparent minus estimated distance, or a coordinate of the vector between two positions of one prism (m).
    pub residual_m: f64,
    /// Unit vector from the second prism to the first, or of the coordinate (station 1's frame).
    direction: Vector3<f64>,
    /// Distance of the prisms (m); infinite for a coordinate, whose direction does not depend on noise.
    length_m: f64,
}

impl Residual {
    /// Returns the variance of the residual from the covariance of the separation (m²).
    pub fn variance_along_m2(&self, covariance_m2: &Matrix3<f64>) -> f64 {
        self.direction.dot(&(covariance_m2 * self.direction))
    }
}

impl ObservedResidual {
    /// Returns the residual of prisms at given positions (m, station 1's frame).
    fn between(&self, placed_m: &PerStation<Vector3<f64>>, state: &State) -> Residual {
        let between = placed_m[self.stations.first] - placed_m[self.stations.second];
        match self.kind {
            ResidualKind::Distance { unknown } => {
                let length_m = between.norm().max(1e-9);
                let residual_m = length_m - state[unknown];
                Residual { residual_m, direction: between / length_m, length_m }
            }
            ResidualKind::Coordinate { axis } => {
                let direction = Vector3::ith(axis, 1.0);
                Residual { residual_m: between[axis], direction, length_m: f64::INFINITY }
            }
        }
    }
}

/// The residuals of all triplets, linearised about a state.
pub struct LinearisedTriplets {
    /// Length of the state vector.
    pub order: usize,
    /// Number of residuals of a triplet.
    pub per_triplet: usize,
    /// Residuals (m), triplet by triplet.
    pub residual_m: Vec<f64>,
    /// Jacobian of each residual with respect to the state.
    derivative: Vec<f64>,
    /// Expectation of derivative × residual from noise alone, for each residual.
    noise_pull: Vec<f64>,
}

impl LinearisedTriplets {
    /// Linearises all triplets at a state, with the covariances of the noise of their separations by pair (m², station 1's frame).
    pub fn at(
        model: &ClockCheckModel,
        data: &MovingTriplets<'_>,
        state: &State,
        covariances_m2: &[Vec<Matrix3<f64>>],
    ) -> Self {
        let (order, per_triplet) = (model.order(), model.residuals.len());
        let count = covariances_m2.len() * per_triplet;
        let mut all = Self {
            order,
            per_triplet,
            residual_m: Vec::with_capacity(count),
            derivative: vec![0.0; count * order],
            noise_pull: vec![0.0; count * order],
        };
        let station1_from_station = model.transforms(state);
        let mut placed = PlacedTriplet::empty(&station1_from_station);
        for (index, covariances_m2) in covariances_m2.iter().enumerate() {
            placed.replace(model, data, index, state, &station1_from_station);
            for observed in &model.residuals {
                let residual = observed.between(&placed.points_m, state);
                let row = all.residual_m.len() * order..(all.residual_m.len() + 1) * order;
                all.residual_m.push(residual.residual_m);
                let derivative = &mut all.derivative[row.clone()];
                placed.set_derivative(model, observed, &residual, derivative);
                let covariance_m2 = &covariances_m2[observed.pair];
                let pull = &mut all.noise_pull[row];
                placed.set_noise_pull(model, observed, &residual, covariance_m2, pull);
            }
        }
        all
    }

    /// Returns the Jacobian of a residual.
    pub fn derivative(&self, row: usize) -> &[f64] {
        &self.derivative[row * self.order..(row + 1) * self.order]
    }

    /// Returns the expectation of derivative × residual from noise alone.
    pub fn noise_pull(&self, row: usize) -> &[f64] {
        &self.noise_pull[row * self.order..(row + 1) * self.order]
    }

    /// Updates the residuals for a small step of the state.
    pub fn step(&mut self, step: &State) {
        let rows = self.residual_m.iter_mut().zip(self.derivative.chunks_exact(self.order));
        for (residual_m, derivative) in rows {
            *residual_m += derivative.iter().zip(step).map(|(d, s)| d * s).sum::<f64>();
        }
    }
}

/// Returns the position of a station's prism (m), and its line of sight, both in the station's own frame.
fn seen(
    model: &ClockCheckModel,
    data: &MovingTriplets<'_>,
    index: usize,
    state: &State,
    station: Station,
) -> (Vector3<f64>, Vector3<f64>) {
    let point_m = data.triplets.points_m[station][index];
    let sight = point_m.try_normalize(1e-9).unwrap_or_default();
    let seen_m = match station.slot() {
        None => point_m,
        Some(_) => data.at_true_time(station.index(), index, model.clock(state, station)),
    };
    (seen_m - sight * state[model.constant()], sight)
}

/// Returns the residuals of a triplet without their Jacobian.
pub fn residuals(
    model: &ClockCheckModel,
    data: &MovingTriplets<'_>,
    index: usize,
    state: &State,
    station1_from_station: &PerStation<RigidTransform>,
) -> Vec<Residual> {
    let placed_m = station1_from_station.map_each(|station, transform| {
        let (point_m, _) = seen(model, data, index, state, station);
        if station == Station::FIRST { point_m } else { transform.apply(&point_m) }
    });
    model.residuals.iter().map(|observed| observed.between(&placed_m, state)).collect()
}

/// The transformed points of a triplet, and their Jacobians.
struct PlacedTriplet {
    /// Positions (m, station 1's frame).
    points_m: PerStation<Vector3<f64>>,
    /// Jacobian of each point with respect to the unknowns of [`ClockCheckModel::places`].
    moves: PerStation<[Vector3<f64>; 8]>,
    /// Line of sight of each station (station 1's frame).
    sights: PerStation<Vector3<f64>>,
}

impl PlacedTriplet {
    fn empty(stations: &PerStation<RigidTransform>) -> Self {
        Self {
            points_m: stations.map(|_| Vector3::zeros()),
            moves: stations.map(|_| [Vector3::zeros(); 8]),
            sights: stations.map(|_| Vector3::zeros()),
        }
    }

    /// Replaces the points by those of another triplet.
    fn replace(
        &mut self,
        model: &ClockCheckModel,
        data: &MovingTriplets<'_>,
        index: usize,
        state: &State,
        station1_from_station: &PerStation<RigidTransform>,
    ) {
        for (station, transform) in station1_from_station.each() {
            let (point, sight) = seen(model, data, index, state, station);
            self.sights[station] = transform.rotate(&sight);
            if station == Station::FIRST {
                self.points_m[station] = point;
                continue;
            }
            let moving = transform.rotate(&data.velocity_m_per_s[station][index]);
            let turned = transform.rotate(&point);
            self.points_m[station] = turned + transform.translation_m;
            let tilted_by = |axis: Vector3<f64>| transform.rotate(&axis.cross(&point));
            self.moves[station] = [
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
    }

    /// Sets the derivatives of a pair's separation along a vector with respect to each unknown that moves points.
    fn set_moved_along(
        &self,
        model: &ClockCheckModel,
        stations: StationPair,
        vector: &Vector3<f64>,
        moved: &mut [f64],
    ) {
        let StationPair { first, second } = stations;
        moved[model.constant()] = vector.dot(&(self.sights[second] - self.sights[first]));
        for (station, sign) in [(first, 1.0), (second, -1.0)] {
            let places = model.places(station).into_iter().flatten();
            for (place, step) in places.zip(&self.moves[station]) {
                moved[place] = sign * vector.dot(step);
            }
        }
    }

    fn set_derivative(
        &self,
        model: &ClockCheckModel,
        observed: &ObservedResidual,
        residual: &Residual,
        derivative: &mut [f64],
    ) {
        self.set_moved_along(model, observed.stations, &residual.direction, derivative);
        if let ResidualKind::Distance { unknown } = observed.kind {
            derivative[unknown] = -1.0;
        }
    }

    /// Sets the expectation of derivative × residual from noise alone.
    ///
    /// Let the noise n of a separation of length d along u have covariance Σ. The residual is u·n + nᵀ(I − uuᵀ)n/2d, and u itself
    /// rotates by (I − uuᵀ)n/d, so that E[r u] = (I − uuᵀ)Σu/d + u tr((I − uuᵀ)Σ)/2d. In weakly observable directions, such as
    /// height and distance on level ground, this bias of a sum moves the answer by centimetres. A coordinate has none.
    fn set_noise_pull(
        &self,
        model: &ClockCheckModel,
        observed: &ObservedResidual,
        residual: &Residual,
        covariance_m2: &Matrix3<f64>,
        pull: &mut [f64],
    ) {
        let ResidualKind::Distance { unknown } = observed.kind else { return };
        let Residual { direction: unit, length_m, .. } = residual;
        let pulled = covariance_m2 * unit;
        let along = unit.dot(&pulled);
        let longer_m = (covariance_m2.trace() - along) / (2.0 * length_m);
        let turned = (pulled - along * unit) / *length_m + longer_m * unit;
        self.set_moved_along(model, observed.stations, &turned, pull);
        pull[unknown] = -longer_m;
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
mod tests;
