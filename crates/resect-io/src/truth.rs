//! Opening of a ground truth: a deployment, or a trajectory of another system.

use std::path::Path;

use crate::error::OpenError;
use crate::estimate_file;
use crate::open::FoundFile;
use crate::source::{Extras, Source, TrajectoryFile};
use crate::what_is::{Dropped, what_is};
use resect_core::deployment::Deployment;
use resect_core::progress::Progress;

/// Opens a deployment, or a trajectory as the ground truth of one.
///
/// # Errors
/// If the file is neither, or a deployment and options are those of a trajectory.
pub fn open_truth(
    file: TrajectoryFile,
    extras: Extras,
    progress: &Progress,
) -> Result<Deployment, OpenError> {
    let path = file.path.clone();
    let (has_topic, has_convention) = (file.topic.is_some(), !file.convention.is_as_read());
    let truth = || Source::ground_truth(file).open(progress);
    if has_topic || matches!(what_is(&path), Dropped::Estimate | Dropped::Gnss) {
        return truth();
    }
    // Positions of one prism, or poses in a bag, are no deployment.
    match Source::at(&path).with(extras).open(progress) {
        Ok(_) if has_convention => {
            let remedy = "leave out the convention of the ground truth";
            Err(OpenError::file(
                &path.display().to_string(),
                "a deployment has its own units",
                remedy,
            ))
        }
        Ok(deployment) => Ok(deployment),
        Err(error) => truth().map_err(|why| match estimate_file::read(&path) {
            // Several trajectories: a topic must be chosen.
            Ok(_) => why,
            Err(_) => no_truth(&path).unwrap_or(error),
        }),
    }
}

/// Returns the error for a single file that has no tracks; `None` for others.
fn no_truth(path: &Path) -> Option<OpenError> {
    let name = path.file_name()?.to_string_lossy().into_owned();
    let file = FoundFile::at(path, name).ok().filter(|_| path.is_file())?;
    let what =
        format!("is neither tracks of stations nor a trajectory ({})", file.format.describe());
    let remedy = "give a deployment, a trajectory (TUM, EuRoC, CSV with a header, a bag), or positions of a GNSS receiver (.pos, \
                  NMEA, latitude and longitude)";
    (!file.format.may_be_track()).then(|| OpenError::file(&file.file, what, remedy))
}
