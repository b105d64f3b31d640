//! The result of the joint estimate.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use super::detected_steps::is_usual;
use super::prior_conflict::{LEAST_INFORMATION, PriorConflict};
use super::prism_motion::Solution;
use super::random_walks::GaussMarkov;
use super::reliability::GroupReliability;
use super::residuals::NoiseLevels;
use super::state_vector::{Layout, by_station};
use super::stated_size_conflict::StatedSizeConflict;
use super::step_search::StationStep;
use super::survey::Survey;
use super::survey_change::{SetUpChange, SurveyEvidence};
use super::trace::Trace;
use super::unknown::{CLOCK_DRIFT, DISTANCE, Unknown};
use crate::calibration::{ErrorSizes, Estimate, TransformSigma};
use crate::geometry::{LevelTransform, RigidTransform};
use crate::network::{Number, Pair, PerPair, PerStation};

/// The result of a joint estimate that converged.
#[derive(Clone, Debug)]
pub struct JointEstimate {
    /// Mean poses of the stations' level frames over the drive, in station 1's.
    pub station1_from_station: PerStation<LevelTransform>,
    /// Covariance of (x, y, z, yaw) of stations 2, 3, … (m, rad).
    pub covariance: DMatrix<f64>,
    /// Contribution of each source to these variances.
    pub budget: Vec<(&'static str, DVector<f64>)>,
    /// Least share of the information on a height that is not noise of the vehicle's tilts (27).
    pub height_share: f64,
    /// Reliability of each group of readings: the drive's by station, those of control points by station, the rig's distances.
    pub reliability: Vec<GroupReliability>,
    /// Time offsets from station 1 in the middle of the first drive (s); zero for station 1.
    pub clock_offsets_s: PerStation<Estimate>,
    /// Clock offsets of each drive, where several were solved together.
    pub drives: Vec<DriveClocks>,
    /// Estimates of the constants, by index.
    pub(super) constants: Vec<Estimate>,
    pub(super) prior_conflict: PriorConflict,
    /// Tests of error sizes that the user reduced below those of instruments in the field.
    pub(super) stated_size_conflicts: Vec<StatedSizeConflict>,
    pub levels: NoiseLevels,
    /// Slow errors of the ranges, of the sights across, and upward.
    pub slow_ranges: GaussMarkov,
    pub slow_across: GaussMarkov,
    pub slow_upward: GaussMarkov,
    /// Standard deviations of the priors.
    pub sizes: ErrorSizes,
    /// Poses at the survey, if control points are evidence.
    pub survey: Option<SurveyPoses>,
    /// Significant steps of stations and clocks, the most significant first.
    pub steps: Vec<StationStep>,
    /// Number of steps of the whole drive.
    pub iterations: usize,
    /// Trace of the iteration; without rows for a prediction.
    pub trace: Trace,
    /// The solution, from which the motion is evaluated.
    pub solution: Arc<Solution>,
}

/// Poses of the stations when they measured the control points.
#[derive(Clone, Debug, PartialEq)]
pub struct SurveyPoses {
    pub station1_from_station: PerStation<LevelTransform>,
    /// Covariance of (x, y, z, yaw) of stations 2, 3, … (m, rad).
    pub covariance: DMatrix<f64>,
    /// The significant change of a set-up until the drive.
    pub change: Option<SetUpChange>,
    /// True if a station may have moved since, but the difference is not significant.
    pub may_have_changed: bool,
}

impl SurveyPoses {
    /// Returns the transforms at the survey.
    pub fn transforms(&self) -> PerStation<RigidTransform> {
        self.station1_from_station.map(|level| RigidTransform::from(*level))
    }

    /// Returns the standard deviations of the transforms; zeros for station 1.
    pub fn sigma(&self) -> PerStation<TransformSigma> {
        TransformSigma::of_covariance(&self.covariance)
    }
}

/// The clock offsets of one drive.
#[derive(Clone, Debug, PartialEq)]
pub struct DriveClocks {
    /// Start and end of the drive (s).
    pub span_s: [f64; 2],
    /// Mean time offsets from station 1 (s); zero for station 1.
    pub offsets_s: PerStation<Estimate>,
}

/// The largest source of a standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LargestSource {
    pub name: &'static str,
    /// The source's standard deviation, and the total one (m, or rad).
    pub sigma: f64,
    pub total_sigma: f64,
}

impl JointEstimate {
    /// The network and its unknowns.
    pub fn layout(&self) -> &Layout {
        self.solution.layout()
    }

    /// Returns the estimates of an unknown, by owner.
    pub fn estimates(&self, unknown: &Unknown) -> impl Iterator<Item = Estimate> {
        self.layout().indices(unknown).map(|index| self.constants[index])
    }

    /// Returns the clock drifts; zero for station 1.
    pub fn clock_drifts(&self) -> PerStation<Estimate> {
        by_station(Estimate::ZERO, self.estimates(&CLOCK_DRIFT))
    }

    /// Returns the clock drifts by the readings alone, without their prior; with an infinite σ where the readings hardly determine one.
    pub fn clock_drifts_by_readings(&self) -> PerStation<Estimate> {
        let without_prior = |Estimate { value, sigma }: Estimate| {
            let share = 1.0 - (sigma / self.sizes.clock_drift).powi(2);
            if share > LEAST_INFORMATION {
                Estimate { value: value / share, sigma: sigma / share.sqrt() }
            } else {
                Estimate { value: 0.0, sigma: f64::INFINITY }
            }
        };
        by_station(Estimate::ZERO, self.estimates(&CLOCK_DRIFT).map(without_prior))
    }

    /// Returns the distances of the followed prisms (m); `None` for one prism.
    pub fn distances_m(&self) -> Option<PerPair<Estimate>> {
        Some(self.estimates(&DISTANCE).collect()).filter(|all: &PerPair<Estimate>| !all.is_empty())
    }

    /// Returns the distance of two prisms of the rig (m); `None` if it is not estimated.
    pub fn distance_m(&self, prisms: Pair) -> Option<Estimate> {
        let place = (0..self.layout().pairs()).find(|k| self.layout().pair(Pair::at(*k)) == prisms);
        place.and_then(|place| self.estimates(&DISTANCE).nth(place))
    }

    /// Returns the largest source of σ of a coordinate: (x, y, z, yaw) of station 2, then of the next ones.
    pub fn largest_source(&self, coordinate: usize) -> LargestSource {
        let by_variance = self.budget.iter();
        let largest = by_variance.max_by(|a, b| a.1[coordinate].total_cmp(&b.1[coordinate]));
        let (name, variance) = largest.map_or(("", 0.0), |(name, all)| (*name, all[coordinate]));
        let total_sigma = self.covariance[(coordinate, coordinate)].sqrt();
        LargestSource { name, sigma: variance.sqrt(), total_sigma }
    }

    /// Returns true for a step of the size that instruments in the field are expected to make.
    pub fn is_usual(&self, step: &StationStep) -> bool {
        is_usual(step, &self.sizes)
    }

    /// Time of a step (s, in the stations' clock).
    pub fn step_time_s(&self, step: &StationStep) -> f64 {
        self.drives.first().map_or(0.0, |drive| drive.span_s[0]) + step.after_s
    }

    /// Returns the time of a step in words: "about 200 s into the drive".
    pub fn describe_time(&self, step: &StationStep) -> String {
        if step.slowly {
            return "over the whole drive".to_owned();
        }
        let time_s = self.step_time_s(step);
        let begun = self.drives.iter().filter(|drive| drive.span_s[0] <= time_s).count();
        match (self.drives.get(begun.saturating_sub(1)), begun) {
            (Some(drive), _) if time_s > drive.span_s[1] => {
                format!("between drives {begun} and {}", begun + 1)
            }
            (Some(drive), 2..) => {
                format!("about {:.0} s into drive {begun}", time_s - drive.span_s[0])
            }
            _ => format!("about {:.0} s into the drive", step.after_s),
        }
    }

    /// Returns the adjustment of the control points; `None` if they are no evidence.
    pub fn control_points(&self) -> Option<&Survey> {
        self.solution.priors.survey.as_ref().map(SurveyEvidence::survey)
    }

    /// Returns the significant change of a set-up between the survey and the drive.
    pub fn set_up_change(&self) -> Option<&SetUpChange> {
        self.survey.as_ref()?.change.as_ref()
    }

    /// Standard deviations of the transforms; zeros for station 1.
    pub fn sigma(&self) -> PerStation<TransformSigma> {
        TransformSigma::of_covariance(&self.covariance)
    }
}
