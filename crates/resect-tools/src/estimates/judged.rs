//! An estimate compared with the ground truth.

use super::delta::Delta;
use super::errors::{AgainstSigma, EpochError};
use super::fit::Fit;
use super::metrics::{Ape, RelativeErrors};
use super::motion_pairs::NoMotions;
use super::odd::OddSpan;
use super::options::{Options, TrajectoryAlignment};
use super::varied_errors::ErrorChange;
use resect_core::deployment::EstimatedTrajectory;

/// An estimate compared with the ground truth.
#[derive(Clone, Debug)]
pub struct Judged {
    pub estimate: EstimatedTrajectory,
    pub alignment: TrajectoryAlignment,
    pub options: Options,
    pub fit: Fit,
    /// Errors at the times at which both are known, in order of time.
    pub errors: Vec<EpochError>,
    /// Changes of the errors by one σ of each independent combination of clock, lever arm and body.
    pub changes: Vec<Vec<ErrorChange>>,
    pub coverage: Coverage,
    pub position: Ape,
    /// The same errors under other alignments.
    pub unaligned: UnalignedErrors,
    /// Angles between orientations (rad); `None` without orientations.
    pub rotation: Option<Ape>,
    /// Relative errors over motions of each size in the order of the options, or the reason why there are none.
    pub relative: Vec<Result<RelativeErrors, (Delta, NoMotions)>>,
    /// `None` if the ground truth states no uncertainty.
    pub against_sigma: Option<AgainstSigma>,
    /// Spans in which the estimate and the ground truth contradict each other, in order of time.
    pub odd: Vec<OddSpan>,
}

/// The part of the estimate or of the ground truth that was compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coverage {
    /// The ground truth was computed at the times of the estimate: number of poses without it, before, after, and in its gaps.
    PosesWithoutTruth(usize),
    /// The estimate was interpolated at the times of a sparser ground truth: number of times without a pose.
    TruthsWithoutPose(usize),
}

/// Absolute errors of positions without the alignment, which hides errors of the frame. Time offset and lever arm are corrected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnalignedErrors {
    /// In the frames as they are.
    pub in_own_frame: Ape,
    /// With the frames aligned by the first pose (evo's `--align_origin`); `None` without orientations.
    pub at_first_pose: Option<Ape>,
}

impl Judged {
    /// Times of poses without ground truth (s, in the ground truth's time).
    pub fn times_without_truth_s(&self) -> Vec<f64> {
        let all_s = self.estimate.poses.iter().map(|pose| pose.time_s + self.fit.time_offset_s);
        let mut with = self.errors.iter().map(|error| error.time_s).peekable();
        all_s.filter(|time_s| with.next_if(|with_s| with_s <= time_s).is_none()).collect()
    }
}
