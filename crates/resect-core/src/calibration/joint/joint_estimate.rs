//! The result of the joint estimate.

use std::sync::Arc;

use nalgebra::{SMatrix, SVector};

use super::contradiction::Contradiction;
use super::observed::Levels;
use super::prisms::Solution;
use super::slow_changes::is_usual;
use super::slow_priors::Wander;
use super::stability::Step;
use super::strain::Strain;
use crate::calibration::{ErrorSizes, Estimate, TransformSigma};
use crate::geometry::LevelTransform;

/// The result of the joint estimate.
#[derive(Clone, Debug)]
pub struct JointEstimate {
    /// Level frames of the stations into station 1's, as they stood on average.
    pub station1_from_station: [LevelTransform; 3],
    /// Covariance of (x, y, z, yaw) of stations 2 and 3 (m, rad).
    pub covariance: SMatrix<f64, 8, 8>,
    /// Contributions to each of these variances.
    pub budget: Vec<(&'static str, SVector<f64, 8>)>,
    /// Time offsets of stations 2 and 3 against station 1 in the middle of the first drive (s).
    pub clock_offsets_s: [Estimate; 2],
    /// The clocks of each drive, where several were solved together.
    pub drives: Vec<DriveClocks>,
    pub clock_drifts: [Estimate; 2],
    pub latencies_s: [Estimate; 3],
    pub distances_m: Option<[Estimate; 3]>,
    pub leans_rad: [[Estimate; 2]; 3],
    pub range_offsets_m: [Estimate; 3],
    pub range_scales: [Estimate; 3],
    pub indices_rad: [Estimate; 3],
    pub collimations_rad: [Estimate; 3],
    pub(super) strain: Strain,
    /// Sizes that the user reduced below those of instruments, with their tests against the data.
    pub(super) contradictions: Vec<Contradiction>,
    pub levels: Levels,
    pub wander: Wander,
    /// Standard deviations of the priors.
    pub sizes: ErrorSizes,
    /// Stations and clocks that did not stay as they were, the clearest first.
    pub stepped: Vec<Step>,
    pub converged: bool,
    pub steps: usize,
    /// From which the motion can be had.
    pub solution: Arc<Solution>,
}

/// The clocks of one drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveClocks {
    /// Start and end of the drive (s).
    pub span_s: [f64; 2],
    /// Time offsets of stations 2 and 3 against station 1 in its middle.
    pub late_s: [Estimate; 2],
}

/// The largest part of one of the σ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dominant {
    pub what: &'static str,
    /// The part's σ, and the whole (m, or rad).
    pub part: f64,
    pub whole: f64,
}

impl JointEstimate {
    /// The largest contribution to a σ; `place` counts (x, y, z, yaw) of station 2, then of station 3.
    pub fn dominant(&self, place: usize) -> Dominant {
        let largest = self.budget.iter().max_by(|a, b| a.1[place].total_cmp(&b.1[place]));
        let (what, variance) = largest.map_or(("", 0.0), |(what, all)| (*what, all[place]));
        let whole = self.covariance[(place, place)].sqrt();
        Dominant { what, part: variance.sqrt(), whole }
    }

    /// Returns true for a step that instruments in the field are expected to make.
    pub fn is_usual(&self, step: &Step) -> bool {
        is_usual(step, &self.sizes)
    }

    /// Time of a step (s, in the stations' clock).
    pub fn at_s(&self, step: &Step) -> f64 {
        self.drives.first().map_or(0.0, |drive| drive.span_s[0]) + step.after_s
    }

    /// "about 200 s into the drive".
    pub fn when(&self, step: &Step) -> String {
        if step.slowly {
            return "over the whole drive".to_owned();
        }
        let at_s = self.at_s(step);
        let begun = self.drives.iter().filter(|drive| drive.span_s[0] <= at_s).count();
        match (self.drives.get(begun.saturating_sub(1)), begun) {
            (Some(drive), _) if at_s > drive.span_s[1] => {
                format!("between drives {begun} and {}", begun + 1)
            }
            (Some(drive), 2..) => {
                format!("about {:.0} s into drive {begun}", at_s - drive.span_s[0])
            }
            _ => format!("about {:.0} s into the drive", step.after_s),
        }
    }

    pub fn sigma(&self) -> [TransformSigma; 2] {
        let sigma = self.covariance.diagonal().map(f64::sqrt);
        [0, 1].map(|slot| TransformSigma {
            translation_m: sigma.fixed_rows::<3>(4 * slot).into(),
            yaw_rad: sigma[4 * slot + 3],
        })
    }
}
