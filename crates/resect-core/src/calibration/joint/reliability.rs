//! Reliability of the groups of readings (Baarda 1968, "A testing procedure for use in geodetic networks").
//!
//! The redundancy number r of a reading is the share of its error that remains in the residual ε. Without a bias `ε / (σ √r)` has the
//! standard deviation 1. The minimal detectable bias is `δ₀ σ_∇`: the finding of a test reports it with a probability of 80 %. `δ₀` is the
//! critical size of the test plus 1.28. All tests of a kind reject one good drive of a thousand. A reading of a control point has `σ_∇ = σ / √r`.
//!
//! An error that all readings of a group share is a constant, with the index ∗. P is the prior precision and C the posterior covariance of
//! the constants. The score of a shift of the prior mean has the information `σ_∇⁻² = (P − PCP)_∗∗` (de Jong & Penzer 1998). `σ_∇⁻² / P_∗∗` is the
//! redundancy number of the prior. Errors that the normal matrix does not have, with
//! the covariance F of their effects, add `(PFP)_∗∗` to the variance of the score. An undetected bias ∇ moves the poses (o, ψ) by `Cov((o, ψ), θ) P_∗ ∇`.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::equations::{HORIZONTAL_ANGLES, RANGES, ResidualSquares, SquareSum, VERTICAL_ANGLES};
use super::loss::CONSISTENCY;
use super::prior_conflict::{CRITICAL_SIGMAS, LEAST_INFORMATION};
use super::state_vector::{Constants, ConstantsMatrix, Layout};
use super::survey::{RangesTest, SurveyReading};
use super::unknown::{COLLIMATION, DISTANCE, RANGE_OFFSET, RANGE_SCALE, Unknown, VERTICAL_INDEX};
use crate::calibration::{Estimate, Quantity};
use crate::network::{Number, Pair};
use crate::statistics::median;

/// A detectable bias moves a normalised number this far beyond its critical size (σ). Textbook: 90 % of a normal distribution are
/// above its mean less 1.28 σ. Simulated: 80 % are reported, because noise and slow errors, which are learned, take a tenth of a bias.
const POWER_SIGMAS: f64 = 1.28;

/// Change of (x, y, z, yaw) of stations 2, 3, … (m, rad).
pub type PoseChange = DVector<f64>;

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
    /// The same ranges, with a common offset.
    ControlPointOffset,
    /// Angles to control points, each with an error of its own across the sight (m).
    ControlPointAngles,
    /// A distance of the rig.
    RigDistance,
}

/// Reliability of one group of readings.
#[derive(Clone, Debug, PartialEq)]
pub struct GroupReliability {
    pub kind: GroupKind,
    /// The station, from 0; of a distance of the rig, the pair of prisms.
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
#[derive(Clone, Debug, PartialEq)]
pub struct DetectableBias {
    /// In the SI unit of [`GroupKind::quantity`]; the median of readings with biases of their own.
    pub size: f64,
    /// Effect on stations 2, 3, … if it is not detected; the largest of readings with biases of their own.
    pub effect: Vec<PoseEffect>,
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
            Self::ControlPointOffset => "control points, offset of ranges",
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
            Self::ControlPointOffset => "control-point-offset",
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
                let Pair { first, second } = Pair::at(self.index);
                format!("rig, prisms {first} and {second}")
            }
            _ => format!("station {}", self.index + 1),
        }
    }

    /// Name in files: "station-2-ranges", "rig-12-distance".
    pub fn code(&self) -> String {
        let code = self.kind.code();
        match self.kind {
            GroupKind::RigDistance => {
                let Pair { first, second } = Pair::at(self.index);
                format!("rig-{first}{second}-{code}")
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
        let effect = |slot: usize| PoseEffect {
            position_m: change.fixed_rows::<3>(4 * slot).norm(),
            yaw_rad: change[4 * slot + 3].abs(),
        };
        Self { size, effect: (0..change.len() / 4).map(effect).collect() }
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

    /// Number of its residuals that other readings check.
    pub fn tests(&self) -> usize {
        self.redundancy.iter().filter(|redundancy| **redundancy > LEAST_INFORMATION).count()
    }

    /// The error of the range or of an angle by all other readings (m).
    pub fn bias_m(&self, axis: usize) -> Estimate {
        let redundancy = self.redundancy[axis];
        Estimate {
            value: -self.residual_m[axis] / redundancy,
            sigma: self.sigma_m[axis] / redundancy.sqrt(),
        }
    }

    /// Minimal detectable bias of the range or of an angle (m); `None` if no other reading checks it.
    pub fn detectable_bias_m(&self, axis: usize) -> Option<f64> {
        let redundancy = self.redundancy[axis];
        let is_checked = redundancy > LEAST_INFORMATION;
        let detectable_sigmas = self.critical_sigmas[axis] + POWER_SIGMAS;
        is_checked.then(|| detectable_sigmas * self.sigma_m[axis] / redundancy.sqrt())
    }
}

/// Priors and posterior of the constants.
pub struct PosteriorMoments<'a> {
    pub layout: &'a Layout,
    /// Information of the priors.
    pub information: ConstantsMatrix,
    /// Estimate less prior mean.
    pub change: Constants,
    pub covariance: &'a ConstantsMatrix,
    /// Covariance of errors that the normal matrix does not have.
    pub added: &'a ConstantsMatrix,
    /// Covariance of the constants with the poses of stations 2, 3, ….
    pub with_poses: &'a DMatrix<f64>,
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
        let information = own[index] - own.dot(&(self.covariance * &own));
        let redundancy = (information / own[index]).clamp(0.0, 1.0);
        let is_tested = redundancy > LEAST_INFORMATION;
        // The score has the variance of further errors, too.
        let score_sigma = (information + own.dot(&(self.added * &own))).sqrt();
        PriorTest {
            redundancy,
            residual_sigmas: is_tested.then(|| own.dot(&self.change) / score_sigma),
            bias: is_tested.then(|| {
                let size = (CRITICAL_SIGMAS + POWER_SIGMAS) * score_sigma / information;
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
    for (station, [ranges, horizontal, vertical]) in squares.by_station.each() {
        let index = station.index();
        let rms = |sum: &SquareSum, kind: usize| {
            let expected = CONSISTENCY * sum.expected * squares.redundancy(kind)?;
            let square = (expected > 0.0).then(|| sum.observed / expected)?;
            Some(NormalisedResidual::RootMeanSquare(square.sqrt()))
        };
        let mut add = |kind, unknown: &Unknown, redundancy, residual| {
            let bias = posterior.test_prior(posterior.layout.index(unknown, index)).bias;
            groups.push(GroupReliability { kind, index, redundancy, residual, bias });
        };
        let [of_ranges, of_horizontal, of_vertical] =
            [RANGES, HORIZONTAL_ANGLES, VERTICAL_ANGLES].map(|kind| squares.redundancy(kind));
        add(GroupKind::Ranges, &RANGE_OFFSET, of_ranges, rms(ranges, RANGES));
        add(GroupKind::RangeScale, &RANGE_SCALE, None, None);
        add(
            GroupKind::HorizontalAngles,
            &COLLIMATION,
            of_horizontal,
            rms(horizontal, HORIZONTAL_ANGLES),
        );
        add(
            GroupKind::VerticalAngles,
            &VERTICAL_INDEX,
            of_vertical,
            rms(vertical, VERTICAL_ANGLES),
        );
    }
    groups
}

/// Reliability of the distances of the rig.
pub fn rig_reliability(posterior: &PosteriorMoments<'_>) -> Vec<GroupReliability> {
    let distance = |(place, index): (usize, usize)| {
        let PriorTest { redundancy, residual_sigmas, bias } = posterior.test_prior(index);
        GroupReliability {
            kind: GroupKind::RigDistance,
            index: posterior.layout.pair(Pair::at(place)).index(),
            redundancy: Some(redundancy),
            residual: residual_sigmas.map(NormalisedResidual::Single),
            bias,
        }
    };
    posterior.layout.indices(&DISTANCE).enumerate().map(distance).collect()
}

/// Reliability of the ranges of each station to control points, which share an offset. `pose_change` is the change of the poses for a gradient
/// of the survey's cost by the constants.
pub fn control_point_offsets(
    tests: &[RangesTest],
    pose_change: impl Fn(&Constants) -> PoseChange,
) -> Vec<GroupReliability> {
    let group = |test: &RangesTest| {
        let size = (test.critical_sigmas + POWER_SIGMAS) * test.sigma_m;
        GroupReliability {
            kind: GroupKind::ControlPointOffset,
            index: test.station.index(),
            redundancy: None,
            residual: None,
            bias: Some(DetectableBias::new(size, &(pose_change(&test.influence) * size))),
        }
    };
    tests.iter().map(group).collect()
}

/// Reliability of the readings of control points, station by station. `pose_change` is the change of the poses for a gradient of the
/// survey's cost by the constants.
pub fn control_point_reliability(
    readings: &[SurveyReading],
    stations: usize,
    pose_change: impl Fn(&Constants) -> PoseChange,
) -> Vec<GroupReliability> {
    let mut groups = Vec::new();
    for index in 0..stations {
        for kind in [GroupKind::ControlPointRanges, GroupKind::ControlPointAngles] {
            let of_station = readings.iter().filter(|reading| reading.station.index() == index);
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
    let slots = biases.first().map_or(0, |bias| bias.effect.len());
    let mut effect = vec![PoseEffect::default(); slots];
    for bias in biases {
        for (largest, own) in effect.iter_mut().zip(&bias.effect) {
            largest.position_m = largest.position_m.max(own.position_m);
            largest.yaw_rad = largest.yaw_rad.max(own.yaw_rad);
        }
    }
    Some(DetectableBias { size, effect })
}

#[cfg(test)]
mod tests;
