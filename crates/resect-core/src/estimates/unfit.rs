//! Reasons why an estimate cannot be aligned with the ground truth.

/// Reason why an estimate cannot be aligned with the ground truth.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Unfit {
    #[error(
        "its times have nothing in common with the readings, and its speeds are like those of no part of the drive; check \
         that both are of one drive, or say by how much its clock is off"
    )]
    NoOverlap,
    #[error(
        "at fewer than ten of its times there is ground truth; check that both are of one drive, and the time offset if it was \
         given"
    )]
    FewEpochs,
    #[error("it has only {0} poses; ten are the least")]
    FewPoses(usize),
    #[error(
        "its positions lie on a line, which leaves its frame open; align it by nothing if it is in station 1's frame"
    )]
    OnALine,
    #[error(
        "clock, lever arm and frame cannot be told apart by this drive, or it is not in station 1's frame; take \
         its body for the vehicle's frame, or align it by turn and shift"
    )]
    Undetermined,
    #[error(
        "its ways are {0:.3} times as long as the ground truth's; check that both are in metres (a factor of 3.281 is that of \
         feet), or align it with a scale"
    )]
    OtherScale(f64),
    #[error(
        "a lever arm needs orientations, of the estimate or of the ground truth; there are none"
    )]
    NoOrientation,
}
