//! The source of a deployment: everything needed to open it again.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::error::OpenError;
use crate::estimate_file;
pub use crate::extras::Extras;
use crate::gnss_solution::SolutionChoice;
use crate::open;
use crate::sample::Sample;
use resect_core::deployment::{Deployment, EstimatedTrajectory};
use resect_core::progress::Progress;
use resect_tools::estimates::add_findings_of_truth;
use resect_tools::estimates::conventions::Convention;

/// Place of a deployment, and the files that the user named in addition. Plain data, stored in sessions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Source {
    #[serde(flatten)]
    pub place: Place,
    #[serde(flatten)]
    pub extras: Extras,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Place {
    /// A folder, or a file of tracks with the rest of its folder.
    Path(PathBuf),
    Sample(Sample),
    /// A trajectory of another system that is the ground truth.
    #[serde(rename = "ground-truth")]
    GroundTruth(TrajectoryFile),
}

/// A file with a trajectory.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TrajectoryFile {
    pub path: PathBuf,
    /// Topic in a bag of several trajectories.
    pub topic: Option<String>,
    /// Solutions of a GNSS receiver that are used.
    #[serde(default, skip_serializing_if = "is_default")]
    pub solutions: SolutionChoice,
    #[serde(default, skip_serializing_if = "is_default")]
    pub convention: Convention,
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

impl TrajectoryFile {
    /// Returns a file as it is read without options.
    pub fn at(path: impl Into<PathBuf>, topic: Option<String>) -> Self {
        let (solutions, convention) = (SolutionChoice::default(), Convention::AS_READ);
        Self { path: path.into(), topic, solutions, convention }
    }

    fn read(&self) -> Result<EstimatedTrajectory, OpenError> {
        let topic = self.topic.as_deref();
        let mut truth = estimate_file::read_truth(&self.path, topic, self.solutions)?;
        self.convention.apply(&mut truth);
        add_findings_of_truth(&mut truth, &self.convention);
        Ok(truth)
    }
}

impl Source {
    pub fn at(path: impl Into<PathBuf>) -> Self {
        Self { place: Place::Path(path.into()), extras: Extras::default() }
    }

    pub fn sample(sample: Sample) -> Self {
        Self { place: Place::Sample(sample), extras: Extras::default() }
    }

    pub fn ground_truth(file: TrajectoryFile) -> Self {
        Self { place: Place::GroundTruth(file), extras: Extras::default() }
    }

    pub fn with(self, extras: Extras) -> Self {
        Self { extras, ..self }
    }

    /// Returns the file or folder of the tracks; `None` for a sample.
    pub fn path(&self) -> Option<&Path> {
        match &self.place {
            Place::Path(path) | Place::GroundTruth(TrajectoryFile { path, .. }) => Some(path),
            Place::Sample(_) => None,
        }
    }

    /// Title before the deployment is open.
    pub fn title(&self) -> String {
        match &self.place {
            Place::Path(path) | Place::GroundTruth(TrajectoryFile { path, .. }) => {
                path.file_name().map_or_else(
                    || path.display().to_string(),
                    |name| name.to_string_lossy().into_owned(),
                )
            }
            Place::Sample(sample) => sample.title().to_owned(),
        }
    }

    /// Reads everything. `progress` counts bytes of files; cancelling it returns [`OpenError::Cancelled`].
    pub fn open(&self, progress: &Progress) -> Result<Deployment, OpenError> {
        let mut found = match &self.place {
            Place::GroundTruth(file) => {
                return Ok(Deployment::of_ground_truth(Arc::new(file.read()?)));
            }
            Place::Path(path) => open::find(path, progress)?,
            Place::Sample(sample) => open::in_memory(sample.title(), &sample.files()),
        };
        found.add(&self.extras)?;
        let mut deployment = open::combine(&found, progress)?;
        for ingredient in &mut deployment.ingredients {
            ingredient.path = self.place_of(&ingredient.file);
        }
        let of_drive = |path: &PathBuf| {
            let corrections = self.extras.corrections.of_any_drive();
            let rig = self.extras.rig.clone();
            Self::at(path).with(Extras { rig, corrections, ..Extras::default() }).open(progress)
        };
        let drives: Result<Vec<_>, _> = self.extras.drives.iter().map(of_drive).collect();
        deployment.take_in(drives?)?;
        Ok(deployment)
    }

    /// Returns the path of a file by its name in the deployment.
    fn place_of(&self, file: &str) -> Option<PathBuf> {
        let path = self.path()?;
        let folder = if path.is_dir() { path } else { path.parent().unwrap_or(Path::new("")) };
        let own = folder.join(file);
        if own.is_file() {
            return Some(own);
        }
        // A file that the user named is listed under the path given, or relative to the folder given.
        let Extras { rig, gcp, gnss, .. } = &self.extras;
        let named = rig.iter().chain(gcp).chain(gnss);
        let places = named.map(|named| match named.is_dir() {
            true => named.join(file),
            false => named.clone(),
        });
        places.into_iter().find(|path| path.ends_with(file) && path.is_file())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_source_is_a_few_lines_of_toml() {
        let extras = Extras { rig: Some("rig".into()), gcp_instead: true, ..Extras::default() };
        for (source, expected) in [
            (
                Source::at("/data/d").with(extras),
                "path = \"/data/d\"\nrig = \"rig\"\ngcp_instead = true\n",
            ),
            (Source::sample(Sample::Hd2Tunnel), "sample = \"hd2-tunnel\"\n"),
        ] {
            let text = toml::to_string(&source).expect("plain data");
            assert_eq!(text, expected);
            assert_eq!(toml::from_str::<Source>(&text).expect("own text"), source);
        }
    }

    #[test]
    fn control_points_add_up_and_a_rig_replaces_the_last() {
        let named = |rig: &str, gcp: &str| Extras {
            rig: Some(rig.into()),
            gcp: vec![gcp.into()],
            ..Extras::default()
        };
        let mut extras = named("old", "a.txt");
        extras.add(named("new", "b.txt"));
        extras.add(named("new", "a.txt"));
        assert_eq!(extras.rig, Some("new".into()));
        assert_eq!(extras.gcp, [PathBuf::from("a.txt"), PathBuf::from("b.txt")]);
    }
}
