//! Tests for a displacement or rotation of a station between two runs: the station, the size of its move, and its
//! covariance.
//!
//! A move of a station has four parameters, (x, y, z) and yaw. A move of station 2, 3, … changes its own transform. A move
//! of station 1 changes all transforms, because it is their reference. "Only this station moved" is fitted to all
//! components of the difference. The χ² that the fit explains tests whether the station moved. The remaining χ² tests
//! whether that is the only cause.

use nalgebra::{DMatrix, DVector, Dyn, Matrix4, OMatrix, U4, Vector3, Vector4};

use super::outcome::{Cause, LEVEL_OF_ONE};
use resect_core::calibration::ErrorSizes;
use resect_core::calibration::Estimate;
use resect_core::geometry::{LevelTransform, wrap_to_pi};
use resect_core::network::{PerStation, Station};

/// Critical χ² with four degrees of freedom at significance level [`LEVEL_OF_ONE`].
const CHI_SQUARE_OF_ONE: f64 = 16.924;
/// Excess of explained χ² that identifies one station rather than another: a likelihood ratio of one hundred.
const CLEARLY: f64 = 9.2;
/// Gauss–Newton steps; only a rotation of station 1 needs more than one.
const STEPS: usize = 6;

/// The difference between two calibrations of one set-up, and its possible causes.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// Own calibration minus the earlier one: (x, y, z, yaw) of station 2, then of station 3, … (m, rad).
    pub values: DVector<f64>,
    /// Sum of the covariances of both calibrations and of the settling of tripods in between.
    pub covariance: DMatrix<f64>,
    pub chi_square: f64,
    /// Probability of a larger χ² if nothing moved.
    pub p_value: f64,
    /// Fitted move of each station, as if only that station had moved.
    pub stations: PerStation<StationMove>,
}

/// Fitted move of a station, as if only that station had moved.
#[derive(Clone, Debug, PartialEq)]
pub struct StationMove {
    /// Displacement along station 1's axes before the move (m) and rotation about z (rad), with their covariance.
    pub by: Vector4<f64>,
    pub covariance: Matrix4<f64>,
    /// Explained χ², and the probability of a larger one if the station did not move.
    pub chi_square: f64,
    pub p_value: f64,
    /// Probability of a larger remaining χ² if only this station moved.
    pub rest_p_value: f64,
}

impl StationMove {
    /// Returns the displacement along x, y or z (m), or the rotation (rad).
    pub fn part(&self, part: usize) -> Estimate {
        Estimate { value: self.by[part], sigma: self.covariance[(part, part)].max(0.0).sqrt() }
    }

    pub fn turned_rad(&self) -> Estimate {
        self.part(3)
    }

    /// Returns the length of the displacement (m), with the σ along it.
    pub fn moved_m(&self) -> Estimate {
        let by: Vector3<f64> = self.by.xyz();
        let along = by.try_normalize(1e-12).unwrap_or_else(Vector3::x);
        let covariance = self.covariance.fixed_view::<3, 3>(0, 0);
        Estimate { value: by.norm(), sigma: along.dot(&(covariance * along)).max(0.0).sqrt() }
    }

    /// Returns the minimal detectable displacement along its worst axis (m) and rotation (rad), detected with probability one half.
    /// `None` if the covariance is not positive definite.
    pub fn visible(&self) -> Option<(f64, f64)> {
        let precision = self.covariance.cholesky()?.inverse();
        let least = |part: usize| (CHI_SQUARE_OF_ONE / precision[(part, part)]).sqrt();
        Some(((0..3).map(least).fold(0.0, f64::max), least(3)))
    }

    /// Returns true if the move is significant.
    pub fn rejects(&self) -> bool {
        self.p_value < LEVEL_OF_ONE
    }

    /// Returns true if the remaining difference is not significant.
    pub fn explains_all(&self) -> bool {
        self.rest_p_value >= LEVEL_OF_ONE
    }
}

impl Difference {
    /// Compares two calibrations; `None` if the covariance is not positive definite.
    pub fn between(
        before: &PerStation<LevelTransform>,
        after: &PerStation<LevelTransform>,
        covariance: DMatrix<f64>,
    ) -> Option<Self> {
        let precision = covariance.clone().cholesky()?.inverse();
        let values = minus(after, before);
        let chi_square = values.dot(&(&precision * &values));
        let degrees = values.len();
        let stations = before.numbers().map(|station| {
            only(station, before, after, &precision).map(|(by, covariance, left)| {
                let explained = (chi_square - left).max(0.0);
                StationMove {
                    by,
                    covariance,
                    chi_square: explained,
                    p_value: chance_of_more(explained, 4),
                    rest_p_value: chance_of_more(left, degrees - 4),
                }
            })
        });
        let stations = stations.collect::<Option<_>>()?;
        Some(Self {
            values,
            covariance,
            chi_square,
            p_value: chance_of_more(chi_square, degrees),
            stations,
        })
    }

    /// Returns true if any test finds a significant difference.
    pub fn rejects(&self) -> bool {
        self.p_value < LEVEL_OF_ONE || self.stations.iter().any(StationMove::rejects)
    }

    /// Returns the cause of a significant difference.
    pub fn cause(&self) -> Cause {
        let alone = |station: &usize| {
            self.stations[*station].rejects() && self.stations[*station].explains_all()
        };
        let mut stations: Vec<usize> = (0..self.stations.len()).filter(alone).collect();
        let best = stations.iter().map(|k| self.stations[*k].chi_square).fold(0.0, f64::max);
        stations.retain(|station| self.stations[*station].chi_square > best - CLEARLY);
        match stations[..] {
            [] => Cause::NoneAlone,
            [station] => Cause::Station(station),
            _ => Cause::OneOf(stations),
        }
    }

    /// Returns true if a station other than the first is displaced (m) or rotated (rad) by more than these limits.
    pub fn reaches(&self, far_m: f64, far_rad: f64) -> bool {
        (0..self.values.len()).step_by(4).any(|slot| {
            let far = self.values.fixed_rows::<3>(slot).norm();
            far > far_m || self.values[slot + 3].abs() > far_rad
        })
    }

    /// Returns the largest standard deviation of a translation (m).
    pub fn largest_sigma_m(&self) -> f64 {
        let variance = |k: usize| if k % 4 == 3 { 0.0 } else { self.covariance[(k, k)] };
        (0..self.values.len()).map(variance).fold(0.0, f64::max).sqrt()
    }
}

/// Covariance of (x, y, z, yaw) of stations 2, 3, … due to the settling of all tripods between two runs.
pub fn settled(before: &PerStation<LevelTransform>, sizes: &ErrorSizes) -> DMatrix<f64> {
    let (move_m2, turn_rad2) = (sizes.settling_m.powi(2), sizes.settling_rad.powi(2));
    let own = Matrix4::from_diagonal(&Vector4::new(move_m2, move_m2, move_m2, turn_rad2));
    let by_station = before.numbers().map(|station| {
        let shape = shape(station, before);
        &shape * own * shape.transpose()
    });
    by_station.sum()
}

/// Jacobian of (x, y, z, yaw) of stations 2, 3, … with respect to a small move of one station.
fn shape(station: Station, before: &PerStation<LevelTransform>) -> OMatrix<f64, Dyn, U4> {
    let slots = before.len() - 1;
    let mut shape = OMatrix::<f64, Dyn, U4>::zeros(4 * slots);
    match station.slot() {
        Some(slot) => shape.fixed_view_mut::<4, 4>(4 * slot, 0).fill_with_identity(),
        None => {
            // A move of station 1 is the opposite move of everything else in its frame.
            for slot in 0..slots {
                shape.fixed_view_mut::<4, 4>(4 * slot, 0).copy_from(&-Matrix4::identity());
                let arm = Vector3::z().cross(&before[slot + 1].translation_m);
                shape.fixed_view_mut::<3, 1>(4 * slot, 3).copy_from(&-arm);
            }
        }
    }
    shape
}

/// Returns the transforms of the stations after a move of one of them.
fn once_moved(
    station: Station,
    by: &Vector4<f64>,
    before: &PerStation<LevelTransform>,
) -> PerStation<LevelTransform> {
    let mut after = before.clone();
    if station == Station::FIRST {
        let now_from_before = LevelTransform::new(by.xyz(), by.w).inverse();
        for other in after.iter_mut().skip(1) {
            *other = now_from_before.then_from(other);
        }
    } else {
        let moved = &mut after[station];
        *moved = LevelTransform::new(moved.translation_m + by.xyz(), moved.yaw_rad + by.w);
    }
    after
}

/// Fits "only this station moved" by least squares: the four parameters, their covariance, and the remaining χ². `None` if
/// the normal matrix is not positive definite.
fn only(
    station: Station,
    before: &PerStation<LevelTransform>,
    after: &PerStation<LevelTransform>,
    precision: &DMatrix<f64>,
) -> Option<(Vector4<f64>, Matrix4<f64>, f64)> {
    let shape = shape(station, before);
    let weighted = precision * &shape;
    let covariance = shape.tr_mul(&weighted).cholesky()?.inverse();
    let mut by = Vector4::zeros();
    for _ in 0..STEPS {
        by += covariance * weighted.tr_mul(&minus(after, &once_moved(station, &by, before)));
    }
    let left = minus(after, &once_moved(station, &by, before));
    Some((by, covariance, left.dot(&(precision * &left))))
}

/// Difference a − b of (x, y, z, yaw) of stations 2, 3, … (m, rad).
fn minus(a: &PerStation<LevelTransform>, b: &PerStation<LevelTransform>) -> DVector<f64> {
    DVector::from_fn(4 * (a.len() - 1), |k, _| {
        let (a, b) = (&a[k / 4 + 1], &b[k / 4 + 1]);
        match k % 4 {
            3 => wrap_to_pi(a.yaw_rad - b.yaw_rad),
            axis => a.translation_m[axis] - b.translation_m[axis],
        }
    })
}

/// Probability that χ² with an even number of degrees of freedom exceeds a value.
fn chance_of_more(chi_square: f64, degrees: usize) -> f64 {
    debug_assert!(degrees.is_multiple_of(2), "{degrees} degrees of freedom");
    let half = 0.5 * chi_square;
    let (mut term, mut sum) = (1.0, 1.0);
    for k in 1..degrees / 2 {
        term *= half / k as f64;
        sum += term;
    }
    (sum * (-half).exp()).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use resect_core::network::Number;

    fn stations() -> PerStation<LevelTransform> {
        let at = |x: f64, y: f64, yaw: f64| LevelTransform::new(Vector3::new(x, y, -0.3), yaw);
        [LevelTransform::IDENTITY, at(5.2, -2.6, 3.1), at(-5.4, 0.4, -0.5)].into()
    }

    /// Covariance with σ of 2 mm and 0.05 mrad, and a correlation of one half between the two stations.
    fn covariance() -> DMatrix<f64> {
        let sigma = |k: usize| if k % 4 == 3 { 5e-5 } else { 2e-3 };
        DMatrix::from_fn(8, 8, |i, j| {
            let shared = if i == j { 1.0 } else { f64::from(u8::from(i % 4 == j % 4)) * 0.5 };
            shared * sigma(i) * sigma(j)
        })
    }

    #[test]
    fn chances_are_those_of_tables() {
        assert!((chance_of_more(9.487_729, 4) - 0.05).abs() < 1e-6);
        assert!((chance_of_more(20.090_235, 8) - 0.01).abs() < 1e-6);
        assert!((chance_of_more(CHI_SQUARE_OF_ONE, 4) / LEVEL_OF_ONE - 1.0).abs() < 1e-3);
        assert_eq!((chance_of_more(0.0, 8), chance_of_more(1e6, 8)), (1.0, 0.0));
    }

    #[test]
    fn stations_that_moved_alike_cannot_be_told_apart() {
        // Stations 2 and 3 moved alike, or station 1 moved the opposite way: the simplest explanation is chosen.
        let before = stations();
        let mut after = before.clone();
        after[1].translation_m.x += 0.05;
        after[2].translation_m.x += 0.05;
        let found = Difference::between(&before, &after, covariance()).expect("a covariance");
        assert_eq!(found.cause(), Cause::Station(0));
        // Without information on station 3, moves of stations 1 and 2 are indistinguishable.
        let mut blind = covariance();
        for k in 4..8 {
            blind[(k, k)] *= 1e6;
        }
        let found =
            Difference::between(&before, &once_moved(Station::at(1), &MOVE, &before), blind);
        assert_eq!(found.expect("a covariance").cause(), Cause::OneOf(vec![0, 1]));
    }

    const MOVE: Vector4<f64> = Vector4::new(0.03, -0.01, 0.0, 1e-3);

    #[test]
    fn what_settles_is_what_each_station_may_move() {
        let sizes = ErrorSizes { settling_m: 1e-3, settling_rad: 2e-4, ..ErrorSizes::default() };
        let before = stations();
        let covariance = settled(&before, &sizes);
        // Sum over moves by one σ of settling, one component of one station at a time.
        let mut sum = DMatrix::zeros(8, 8);
        for station in before.numbers() {
            for part in 0..4 {
                let mut by = Vector4::zeros();
                by[part] = if part == 3 { sizes.settling_rad } else { sizes.settling_m };
                let change = minus(&once_moved(station, &by, &before), &before);
                sum += &change * change.transpose();
            }
        }
        assert!((&covariance - &sum).norm() < 1e-3 * sum.norm(), "{covariance}{sum}");
    }

    proptest! {
        #[test]
        fn the_station_that_moved_is_found_exactly(
            station in 0..3_usize,
            by in proptest::array::uniform4(-1.0..1.0f64),
        ) {
            let by = Vector4::new(0.2 * by[0], 0.2 * by[1], 0.1 + 0.1 * by[2], 0.04 * by[3]);
            let before = stations();
            let after = once_moved(Station::at(station), &by, &before);
            let found = Difference::between(&before, &after, covariance()).expect("a covariance");
            prop_assert_eq!(found.cause(), Cause::Station(station));
            prop_assert!((found.stations[station].by - by).norm() < 1e-6);
        }

        /// The tests do not depend on the order of the runs.
        #[test]
        fn the_order_of_runs_does_not_matter(
            off in proptest::collection::vec(-1.0..1.0f64, 8),
        ) {
            let before = stations();
            let mut after = before.clone();
            for k in 0..8 {
                let transform = &mut after[k / 4 + 1];
                match k % 4 {
                    3 => transform.yaw_rad += 2e-4 * off[k],
                    axis => transform.translation_m[axis] += 0.01 * off[k],
                }
            }
            let one = Difference::between(&before, &after, covariance()).expect("a covariance");
            let other = Difference::between(&after, &before, covariance()).expect("a covariance");
            prop_assert!((one.chi_square - other.chi_square).abs() < 1e-6 * one.chi_square);
            prop_assert!((&one.values + &other.values).norm() < 1e-12);
            for station in 1..3 {
                let [one, other] = [&one, &other].map(|found| &found.stations[station]);
                prop_assert!((one.by + other.by).norm() < 1e-9);
            }
        }
    }
}
