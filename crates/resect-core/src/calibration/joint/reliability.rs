//! Reliability of the groups of readings (Baarda 1968, "A testing procedure for use in geodetic networks").
//!
//! The redundancy number r of a reading is the share of its error that remains in the residual v. Without an error `v / (σ √r)` has the
//! standard deviation 1. The minimal detectable bias is `δ₀ σ_∇`: a test with a false-alarm rate of 0.1 % detects it with a probability
//! of 80 %, with `δ₀ = 4.13`. A reading of a control point has `σ_∇ = σ / √r`.
//!
//! An error that all readings of a group share is a constant `θ_c`. With the prior information Λ and the posterior covariance C of the
//! constants, the score of a shift of its prior mean has the information `N = (Λ − ΛCΛ)_cc` (de Jong & Penzer 1998). So `σ_∇ = 1/√N`, and
//! `N / Λ_cc` is the redundancy number of the prior. An undetected bias b moves the poses x by `Cov(x, θ) Λ e_c b`.

use std::ops::Range;

use nalgebra::{SMatrix, SVector};

use super::equations::{ANGLES, RANGES, ResidualSquares, SquareSum};
use super::loss::CONSISTENCY;
use super::prior_conflict::LEAST_INFORMATION;
use super::state_vector::{
    COLLIMATIONS, CONSTANTS, Constants, ConstantsMatrix, DISTANCES, INDICES, OFFSETS, SCALES,
};
use super::survey::SurveyReading;
use crate::calibration::Quantity;
use crate::deployment::PAIRS;
use crate::statistics::median;

/// Noncentrality of a bias that a test with a false-alarm rate of 0.1 % detects with a probability of 80 % (σ).
const NONCENTRALITY: f64 = 4.13;

/// Change of (x, y, z, yaw) of stations 2 and 3 (m, rad).
pub type PoseChange = SVector<f64, 8>;

/// Kind of a group of readings, with the error that its readings share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GroupKind {
    /// Ranges of the drive, with a common offset.
    Ranges,
    /// The same ranges, with a common scale.
    RangeScale,
    /// Horizontal angles of the drive, with a common collimation error.
    HorizontalAngles,
    /// Vertical angles of the drive, with a common index error.
    VerticalAngles,
    /// Ranges to control points, each with an error of its own.
    ControlPointRanges,
    /// Angles to control points, each with an error of its own across the sight (m).
    ControlPointAngles,
    /// A distance of the rig.
    RigDistance,
}

/// Reliability of one group of readings.
#[derive(Clone, Debug, PartialEq)]
pub struct GroupReliability {
    pub kind: GroupKind,
    /// The station, 0 to 2; of a distance of the rig, the pair of prisms.
    pub index: usize,
    /// Mean redundancy number of the readings. Stations of a drive share that of ranges, and that of angles. `None` for a group that
    /// repeats the readings of another, and in predictions.
    pub redundancy: Option<f64>,
    pub residual: Option<NormalisedResidual>,
    /// The minimal detectable bias; `None` if no bias of any size is detected.
    pub bias: Option<DetectableBias>,
}

/// Normalised residual of a group: residual over its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NormalisedResidual {
    /// Root mean square of the readings of a drive, by the noise level that all stations share.
    RootMeanSquare(f64),
    /// The largest one, with the reading's set of control points and its point in that.
    Largest { sigmas: f64, set: usize, point: usize },
    /// A single number: estimated less measured.
    Single(f64),
}

/// A minimal detectable bias and its effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DetectableBias {
    /// In the SI unit of [`GroupKind::quantity`]; the median of readings with biases of their own.
    pub size: f64,
    /// Effect on stations 2 and 3 if it is not detected; the largest of readings with biases of their own.
    pub effect: [PoseEffect; 2],
}

/// Change of a station's pose.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PoseEffect {
    /// Length of the displacement (m), and size of the rotation about z (rad).
    pub position_m: f64,
    pub yaw_rad: f64,
}

impl GroupKind {
    /// Quantity of the bias.
    pub fn quantity(self) -> Quantity {
        match self {
            Self::HorizontalAngles | Self::VerticalAngles => Quantity::Angle,
            Self::RangeScale => Quantity::Share,
            _ => Quantity::Length,
        }
    }

    /// Axes of [`SurveyReading`] with the group's numbers; empty except for control points.
    pub fn axes(self) -> Range<usize> {
        match self {
            Self::ControlPointRanges => 0..1,
            Self::ControlPointAngles => 1..3,
            _ => 0..0,
        }
    }

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ranges => "ranges",
            Self::RangeScale => "scale of ranges",
            Self::HorizontalAngles => "horizontal angles",
            Self::VerticalAngles => "vertical angles",
            Self::ControlPointRanges => "control points, ranges",
            Self::ControlPointAngles => "control points, angles",
            Self::RigDistance => "distance",
        }
    }

    /// Name in files.
    fn code(self) -> &'static str {
        match self {
            Self::Ranges => "ranges",
            Self::RangeScale => "range-scale",
            Self::HorizontalAngles => "horizontal-angles",
            Self::VerticalAngles => "vertical-angles",
            Self::ControlPointRanges => "control-point-ranges",
            Self::ControlPointAngles => "control-point-angles",
            Self::RigDistance => "distance",
        }
    }
}

impl GroupReliability {
    /// The instrument: "station 2", or "rig, prisms 1 and 2".
    pub fn subject(&self) -> String {
        match self.kind {
            GroupKind::RigDistance => {
                let (a, b) = PAIRS[self.index];
                format!("rig, prisms {} and {}", a + 1, b + 1)
            }
            _ => format!("station {}", self.index + 1),
        }
    }

    /// Name in files: "station-2-ranges", "rig-12-distance".
    pub fn code(&self) -> String {
        let code = self.kind.code();
        match self.kind {
            GroupKind::RigDistance => {
                let (a, b) = PAIRS[self.index];
                format!("rig-{}{}-{code}", a + 1, b + 1)
            }
            _ => format!("station-{}-{code}", self.index + 1),
        }
    }

    /// The normalised residual, or the root mean square of several (σ).
    pub fn residual_sigmas(&self) -> Option<f64> {
        self.residual.map(|residual| match residual {
            NormalisedResidual::RootMeanSquare(sigmas)
            | NormalisedResidual::Single(sigmas)
            | NormalisedResidual::Largest { sigmas, .. } => sigmas,
        })
    }

    /// Set and point of the reading with the largest normalised residual.
    pub fn largest_at(&self) -> Option<(usize, usize)> {
        match self.residual {
            Some(NormalisedResidual::Largest { set, point, .. }) => Some((set, point)),
            _ => None,
        }
    }
}

impl DetectableBias {
    /// `change` is that of the poses.
    fn new(size: f64, change: &PoseChange) -> Self {
        let effect = [0, 1].map(|slot| PoseEffect {
            position_m: change.fixed_rows::<3>(4 * slot).norm(),
            yaw_rad: change[4 * slot + 3].abs(),
        });
        Self { size, effect }
    }

    /// Largest displacement of a station (m).
    pub fn position_m(&self) -> f64 {
        self.effect.iter().map(|effect| effect.position_m).fold(0.0, f64::max)
    }
}

impl SurveyReading {
    /// Normalised residual of the range (0) or of an angle (1, 2) in σ; `None` if no other reading checks it.
    pub fn normalised_residual(&self, axis: usize) -> Option<f64> {
        let redundancy = self.redundancy[axis];
        let is_checked = redundancy > LEAST_INFORMATION;
        is_checked.then(|| self.residual_m[axis] / (self.sigma_m[axis] * redundancy.sqrt()))
    }

    /// Minimal detectable bias of the range or of an angle (m); `None` if no other reading checks it.
    pub fn detectable_bias_m(&self, axis: usize) -> Option<f64> {
        let redundancy = self.redundancy[axis];
        let is_checked = redundancy > LEAST_INFORMATION;
        is_checked.then(|| NONCENTRALITY * self.sigma_m[axis] / redundancy.sqrt())
    }
}

/// Priors and posterior of the constants.
pub struct PosteriorMoments<'a> {
    /// Information of the priors.
    pub information: ConstantsMatrix,
    /// Estimate less prior mean.
    pub change: Constants,
    pub covariance: &'a ConstantsMatrix,
    /// Covariance of the constants with the poses of stations 2 and 3.
    pub with_poses: &'a SMatrix<f64, CONSTANTS, 8>,
}

/// Test of the prior of a constant.
struct PriorTest {
    redundancy: f64,
    /// `None` if the data says too little about the constant.
    residual_sigmas: Option<f64>,
    bias: Option<DetectableBias>,
}

impl PosteriorMoments<'_> {
    fn test_prior(&self, index: usize) -> PriorTest {
        let own: Constants = self.information.column(index).into_owned();
        let information = own[index] - own.dot(&(self.covariance * own));
        let redundancy = (information / own[index]).clamp(0.0, 1.0);
        let is_tested = redundancy > LEAST_INFORMATION;
        PriorTest {
            redundancy,
            residual_sigmas: is_tested.then(|| own.dot(&self.change) / information.sqrt()),
            bias: is_tested.then(|| {
                let size = NONCENTRALITY / information.sqrt();
                DetectableBias::new(size, &(self.with_poses.tr_mul(&own) * size))
            }),
        }
    }
}

/// Reliability of the readings of a drive, station by station.
pub fn drive_reliability(
    posterior: &PosteriorMoments<'_>,
    squares: &ResidualSquares,
) -> Vec<GroupReliability> {
    let mut groups = Vec::new();
    for index in 0..3 {
        let [ranges, horizontal, vertical] = squares.by_station[index];
        let rms = |sum: SquareSum, kind: usize| {
            let expected = CONSISTENCY * sum.expected * squares.redundancy(kind)?;
            let square = (expected > 0.0).then(|| sum.observed / expected)?;
            Some(NormalisedResidual::RootMeanSquare(square.sqrt()))
        };
        let mut add = |kind, first: usize, redundancy, residual| {
            let bias = posterior.test_prior(first + index).bias;
            groups.push(GroupReliability { kind, index, redundancy, residual, bias });
        };
        let [of_ranges, of_angles] = [RANGES, ANGLES].map(|kind| squares.redundancy(kind));
        add(GroupKind::Ranges, OFFSETS, of_ranges, rms(ranges, RANGES));
        add(GroupKind::RangeScale, SCALES, None, None);
        add(GroupKind::HorizontalAngles, COLLIMATIONS, of_angles, rms(horizontal, ANGLES));
        add(GroupKind::VerticalAngles, INDICES, of_angles, rms(vertical, ANGLES));
    }
    groups
}

/// Reliability of the distances of the rig.
pub fn rig_reliability(posterior: &PosteriorMoments<'_>) -> Vec<GroupReliability> {
    let distance = |index: usize| {
        let PriorTest { redundancy, residual_sigmas, bias } =
            posterior.test_prior(DISTANCES + index);
        GroupReliability {
            kind: GroupKind::RigDistance,
            index,
            redundancy: Some(redundancy),
            residual: residual_sigmas.map(NormalisedResidual::Single),
            bias,
        }
    };
    (0..3).map(distance).collect()
}

/// Reliability of the readings of control points, station by station. `pose_change` is the change of the poses for a gradient of the
/// survey's cost by the constants.
pub fn control_point_reliability(
    readings: &[SurveyReading],
    pose_change: impl Fn(&Constants) -> PoseChange,
) -> Vec<GroupReliability> {
    let mut groups = Vec::new();
    for index in 0..3 {
        for kind in [GroupKind::ControlPointRanges, GroupKind::ControlPointAngles] {
            let of_station = readings.iter().filter(|reading| reading.station == index);
            let numbers: Vec<(&SurveyReading, usize)> = of_station
                .flat_map(|reading| kind.axes().map(move |axis| (reading, axis)))
                .collect();
            if numbers.is_empty() {
                continue;
            }
            let sum: f64 = numbers.iter().map(|(reading, axis)| reading.redundancy[*axis]).sum();
            let residuals = numbers.iter().filter_map(|(reading, axis)| {
                let sigmas = reading.normalised_residual(*axis)?;
                let (set, point) = (reading.set, reading.point);
                Some((sigmas.abs(), NormalisedResidual::Largest { sigmas, set, point }))
            });
            let largest = residuals.max_by(|a, b| a.0.total_cmp(&b.0));
            let biases = numbers.iter().filter_map(|(reading, axis)| {
                let size = reading.detectable_bias_m(*axis)?;
                let influence: Constants = reading.influence.column(*axis).into_owned();
                Some(DetectableBias::new(size, &(pose_change(&influence) * size)))
            });
            groups.push(GroupReliability {
                kind,
                index,
                redundancy: Some(sum / numbers.len() as f64),
                residual: largest.map(|(_, residual)| residual),
                bias: summarise(&biases.collect::<Vec<_>>()),
            });
        }
    }
    groups
}

/// Median size and largest effect of biases; `None` without any.
fn summarise(biases: &[DetectableBias]) -> Option<DetectableBias> {
    let size = median(biases.iter().map(|bias| bias.size))?;
    let mut effect = [PoseEffect::default(); 2];
    for bias in biases {
        for (largest, own) in effect.iter_mut().zip(&bias.effect) {
            largest.position_m = largest.position_m.max(own.position_m);
            largest.yaw_rad = largest.yaw_rad.max(own.yaw_rad);
        }
    }
    Some(DetectableBias { size, effect })
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector, Vector3};
    use rand::{RngExt, SeedableRng};

    use super::super::constants_prior::precisions;
    use super::super::survey::{Survey, adjust};
    use super::*;
    use crate::calibration::ErrorSizes;
    use crate::deployment::{ControlPoint, ControlPointSet};
    use crate::geometry::{LevelTransform, Polar};

    /// Readings of all constants and, except for the poses, priors; those of the distances are correlated.
    fn dense_problem() -> (DMatrix<f64>, ConstantsMatrix) {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(7);
        let design = DMatrix::from_fn(50, CONSTANTS, |_, _| rng.random_range(-1.0..1.0));
        let mut information = ConstantsMatrix::zeros();
        (8..CONSTANTS).for_each(|index| information[(index, index)] = 4.0 + index as f64);
        for (a, b) in [(0, 1), (0, 2), (1, 2)] {
            information[(DISTANCES + a, DISTANCES + b)] = -5.0;
            information[(DISTANCES + b, DISTANCES + a)] = -5.0;
        }
        (design, information)
    }

    /// Least squares of exact readings of zero and of biased priors: the estimates, and the sum of squared residuals.
    fn solve(
        design: &DMatrix<f64>,
        information: &ConstantsMatrix,
        prior_mean: &Constants,
    ) -> (DVector<f64>, f64) {
        // The priors as whitened observations; the poses have none.
        let own = information.fixed_view::<{ CONSTANTS - 8 }, { CONSTANTS - 8 }>(8, 8).into_owned();
        let root = own.cholesky().expect("definite").l().transpose();
        let readings = design.nrows();
        let mut rows = DMatrix::<f64>::zeros(readings + CONSTANTS - 8, CONSTANTS);
        rows.rows_mut(0, readings).copy_from(design);
        rows.view_mut((readings, 8), (CONSTANTS - 8, CONSTANTS - 8)).copy_from(&root);
        let mut right = DVector::<f64>::zeros(rows.nrows());
        let of_priors = root * prior_mean.fixed_rows::<{ CONSTANTS - 8 }>(8);
        right.rows_mut(readings, CONSTANTS - 8).copy_from(&of_priors);
        let solution = rows.clone().svd(true, true).solve(&right, 1e-12).expect("a solution");
        let residuals = &rows * &solution - right;
        (solution, residuals.norm_squared())
    }

    #[test]
    fn a_detectable_bias_has_the_noncentrality_and_the_effect_of_least_squares() {
        let (design, information) = dense_problem();
        let by_readings = design.tr_mul(&design);
        let by_readings = ConstantsMatrix::from_fn(|i, j| by_readings[(i, j)]);
        let covariance = (by_readings + information).cholesky().expect("definite").inverse();
        let with_poses = covariance.fixed_columns::<8>(0).into_owned();
        let change = Constants::zeros();
        let posterior = PosteriorMoments {
            information,
            change,
            covariance: &covariance,
            with_poses: &with_poses,
        };
        for index in [OFFSETS + 1, SCALES, COLLIMATIONS + 2, INDICES, DISTANCES, DISTANCES + 2] {
            let test = posterior.test_prior(index);
            let bias = test.bias.expect("determined");
            let mut prior_mean = Constants::zeros();
            prior_mean[index] = bias.size;
            let (solution, square) = solve(&design, &information, &prior_mean);
            let noncentrality = square.sqrt();
            assert!((noncentrality - NONCENTRALITY).abs() < 1e-9, "{index}: {noncentrality}");
            for (slot, effect) in bias.effect.iter().enumerate() {
                let position_m = solution.rows(4 * slot, 3).norm();
                let yaw_rad = solution[4 * slot + 3].abs();
                assert!((effect.position_m - position_m).abs() < 1e-9, "{index}: {position_m}");
                assert!((effect.yaw_rad - yaw_rad).abs() < 1e-9, "{index}: {yaw_rad}");
            }
            assert!((0.0..1.0).contains(&test.redundancy), "{index}: {}", test.redundancy);
        }
    }

    #[test]
    fn a_prior_that_the_data_does_not_reduce_has_no_detectable_bias() {
        let information = ConstantsMatrix::identity();
        let covariance = ConstantsMatrix::from_diagonal_element(0.97);
        let with_poses = SMatrix::zeros();
        let posterior = PosteriorMoments {
            information,
            change: Constants::zeros(),
            covariance: &covariance,
            with_poses: &with_poses,
        };
        let test = posterior.test_prior(OFFSETS);
        assert_eq!((test.bias, test.residual_sigmas), (None, None));
        assert!((test.redundancy - 0.03).abs() < 1e-12);
    }

    /// Readings of twelve markers by three stations, without errors.
    fn exact_survey() -> Vec<ControlPointSet> {
        let stations = [
            LevelTransform::IDENTITY,
            LevelTransform::new(Vector3::new(32.0, -9.0, 0.8), 0.6),
            LevelTransform::new(Vector3::new(11.0, 27.0, -0.5), -2.0),
        ];
        let point = |marker: i64| {
            let angle_rad = 0.53 * marker as f64;
            let radius_m = 12.0 + (7 * marker % 25) as f64;
            let height_m = 0.4 * (marker % 4) as f64 - 1.0;
            let position_m = Vector3::new(
                15.0 + radius_m * angle_rad.cos(),
                radius_m * angle_rad.sin(),
                height_m,
            );
            let reading = |station: &LevelTransform| {
                Some(Polar::from_cartesian(station.inverse().apply(&position_m)))
            };
            // The last three are surveyed as well.
            let known_m = (marker > 9).then(|| position_m + Vector3::new(100.0, 50.0, 3.0));
            ControlPoint { marker, readings: stations.each_ref().map(reading), known_m }
        };
        let points = (1..=12).map(point).collect();
        vec![ControlPointSet { file: "GCP.txt".to_owned(), points, pillars: false }]
    }

    fn adjusted(sets: &[ControlPointSet]) -> Survey {
        adjust(sets, &ErrorSizes::default()).expect("an adjustment")
    }

    #[test]
    fn an_error_of_a_control_point_moves_the_adjustment_by_its_influence() {
        const ERROR_M: f64 = 5e-5;
        let before = adjusted(&exact_survey());
        let own = ConstantsMatrix::from_diagonal(&precisions(&ErrorSizes::default()));
        let covariance = (before.information + own).cholesky().expect("definite").inverse();
        let errors = [(1, 4, 0), (2, 10, 0), (0, 7, 1), (1, 2, 2), (2, 11, 2)];
        for (station, point, axis) in errors {
            let mut sets = exact_survey();
            let reading = sets[0].points[point].readings[station].as_mut().expect("a reading");
            match axis {
                0 => reading.range_m += ERROR_M,
                1 => reading.azimuth_rad += ERROR_M / (reading.range_m * reading.zenith_rad.sin()),
                _ => reading.zenith_rad -= ERROR_M / reading.range_m,
            }
            let after = adjusted(&sets);
            let is_it = |one: &&SurveyReading| one.station == station && one.point == point;
            let find = |survey: &Survey| *survey.readings.iter().find(is_it).expect("adjusted");
            let (own, biased) = (find(&before), find(&after));
            // Robust weights and noise levels follow the error a little.
            let expected = -covariance * own.influence.column(axis) * ERROR_M;
            let moved = after.constants - before.constants;
            for slot in 0..2 {
                let [expected, moved] =
                    [&expected, &moved].map(|all| all.fixed_rows::<3>(4 * slot).into_owned());
                let off_m = (expected - moved).norm();
                assert!(off_m < 0.05 * expected.norm() + 2e-6, "{station} {point}: {off_m}");
            }
            let remains = (own.residual_m - biased.residual_m)[axis] / ERROR_M;
            let redundancy = own.redundancy[axis];
            assert!((remains - redundancy).abs() < 0.05, "{station} {point}: {remains}");
        }
    }

    #[test]
    fn groups_of_control_points_have_the_reading_with_the_largest_residual() {
        let mut sets = exact_survey();
        sets[0].points[5].readings[1].as_mut().expect("a reading").range_m += 0.02;
        let survey = adjusted(&sets);
        let groups = control_point_reliability(&survey.readings, |_| PoseChange::zeros());
        let codes: Vec<String> = groups.iter().map(GroupReliability::code).collect();
        assert_eq!(
            codes[2..4],
            ["station-2-control-point-ranges", "station-2-control-point-angles"]
        );
        assert_eq!(groups.len(), 6);
        let group = &groups[2];
        assert_eq!(group.largest_at(), Some((0, 5)));
        assert!(group.residual_sigmas().expect("residuals").abs() > 4.0, "{group:?}");
        let redundancy = group.redundancy.expect("redundant");
        let bias = group.bias.expect("determined");
        assert!((0.2..1.0).contains(&redundancy) && bias.size > 1e-3 && bias.size < 0.02);
    }
}
