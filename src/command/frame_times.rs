//! Times of KITTI poses without a file of times: by the number of the pose, or by a rate.

use std::path::{Path, PathBuf};

use super::Failure;
use resect_io::error::OpenError;
use resect_io::estimate_file::{NumberedTimes, poses_without_times, read_frames};
use resect_tools::estimates::EstimatedTrajectory;

/// Rate of poses that are compared by their numbers (Hz): that of the cameras of KITTI.
const USUAL_RATE_HZ: f64 = 10.0;

/// Parses a rate (Hz).
pub fn rate(text: &str) -> Result<f64, String> {
    let rate_hz = text.trim().parse().ok().filter(|rate_hz: &f64| (1e-3..=1e6).contains(rate_hz));
    rate_hz.ok_or_else(|| "give a positive number of Hz".to_owned())
}

/// Reads KITTI poses without times at the rate of KITTI's cameras; `None` for other files.
pub fn numbered_poses(path: &Path) -> Option<Result<EstimatedTrajectory, OpenError>> {
    poses_without_times(path)?;
    Some(read_frames(path, NumberedTimes { rate_hz: USUAL_RATE_HZ, is_given: false }))
}

/// Returns the times of files without any; `None` if all files have times.
///
/// # Errors
/// If a rate is given and all files have times, or if no rate is given and the poses cannot be compared by their numbers.
pub fn frame_times(
    estimates: &[PathBuf],
    truths: &[PathBuf],
    rate_hz: Option<f64>,
) -> Result<Option<NumberedTimes>, Failure> {
    let files: Vec<&PathBuf> = estimates.iter().chain(truths).collect();
    let counts: Vec<Option<usize>> = files.iter().map(|path| poses_without_times(path)).collect();
    let without = counts.iter().position(Option::is_some);
    match (without, rate_hz) {
        (None, None) => Ok(None),
        (None, Some(_)) => Err(Failure::Usage(
            "--rate is for KITTI poses without times, and all files have times".to_owned(),
        )),
        (Some(_), Some(rate_hz)) => Ok(Some(NumberedTimes { rate_hz, is_given: true })),
        (Some(_), None) if counts.windows(2).all(|two| two[0] == two[1]) => {
            Ok(Some(NumberedTimes { rate_hz: USUAL_RATE_HZ, is_given: false }))
        }
        (Some(first), None) => Err(Failure::Input(anyhow::anyhow!(
            "{}: KITTI poses have no times, and not all files have the same number of poses without times; put times.txt beside it, or \
             give the rate of its poses (--rate)",
            files[first].display()
        ))),
    }
}
