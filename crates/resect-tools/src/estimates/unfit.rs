//! Reasons why an estimate cannot be aligned with the ground truth.

use crate::estimates::conventions::Convention;

/// Reason why an estimate cannot be aligned with the ground truth.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Unfit {
    #[error(
        "its times do not overlap those of the ground truth, and its speeds match no part of them; check that both are of one \
         drive, or give its time offset"
    )]
    NoOverlap,
    #[error(
        "its times do not overlap those of the ground truth, and its best alignment by speeds is off by {0:.0} % of the size of the \
         drive; check that both are of one drive, or give its time offset"
    )]
    OtherDrive(f64),
    #[error(
        "its speeds and positions fit the ground truth with a time offset of {second_s:+.1} s as well as with {best_s:+.1} s; give its \
         time offset"
    )]
    AmbiguousOffset { best_s: f64, second_s: f64 },
    #[error(
        "fewer than ten of its times have ground truth; check that both are of one drive, and check a given time offset"
    )]
    FewEpochs,
    #[error("it has too few poses ({0}); at least ten are needed")]
    FewPoses(usize),
    #[error(
        "its positions lie on a line, so the alignment is not determined; align it by nothing if it is in the ground truth's frame"
    )]
    OnALine,
    #[error(
        "its first {0} poses lie on a line or at one point, so the alignment by them is not determined; align it by more poses"
    )]
    FirstOnALine(usize),
    #[error(
        "only {0} of its poses with ground truth are in the span, and four are needed; check the span, in seconds since the start of \
         the ground truth"
    )]
    EmptySpan(usize),
    #[error(
        "this drive does not determine time offset, lever arm and frame, or the estimate is not in the ground truth's frame; \
         take both bodies as one, or align it by rotation and translation"
    )]
    Undetermined,
    #[error(
        "its best alignment with a scale is off by {0:.0} % of the size of the drive; check that both are of one drive, and the convention \
         of its file"
    )]
    OtherShape(f64),
    #[error(
        "its distances are {0:.3} times those of the ground truth; check that both are in metres (a factor of 3.281 means \
         feet), or align it with a scale"
    )]
    OtherScale(f64),
    #[error(
        "its poses are inverse: those of the world in the body fit {times_better:.0} times better; write the poses of the body in the world \
         (--convention {convention})"
    )]
    Inverse { times_better: f64, convention: Convention },
    #[error(
        "the ground truth's poses are inverse: those of the world in the body fit {times_better:.0} times better; write the poses of the \
         body in the world (--truth-convention inverse-poses)"
    )]
    TruthInverse { times_better: f64 },
    #[error("a lever arm needs orientations; neither the estimate nor the ground truth has any")]
    NoOrientation,
}
