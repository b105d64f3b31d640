//! Options of the ground truth: of a trajectory, or of one station of a deployment.

use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;
use nalgebra::Vector3;

use super::Failure;
use super::choice::{SOLUTIONS, choice};
use super::judging_args::convention;
use super::progress_line::with_progress;
use super::settings_args::metres;
use resect_core::analysis::Analysis;
use resect_core::deployment::{Deployment, EstimatedTrajectory, PoseCovariance};
use resect_core::network::MOST_STATIONS;
use resect_io::antenna_poses::read_antennas;
use resect_io::estimate_file::{NumberedTimes, poses_without_times, read_frames};
use resect_io::gnss_solution::SolutionChoice;
use resect_io::source::{Extras, TrajectoryFile};
use resect_io::truth::open_truth;
use resect_tools::estimates::conventions::Convention;
use resect_tools::estimates::{GroundTruth, add_findings_of_truth, station_index};

#[derive(Args)]
pub struct TruthArguments {
    /// Standard deviation of the positions of a trajectory that is the ground truth (m), along each axis or along x, y, z. It replaces
    /// the covariances in the file
    #[arg(long, value_name = "S|X,Y,Z", value_parser = sigma)]
    truth_sigma: Option<Vector3<f64>>,
    /// Topic of the ground truth in a bag of several trajectories
    #[arg(long, value_name = "TOPIC")]
    truth_topic: Option<String>,
    /// Position of a GNSS antenna in the body (m), once for each file of --against. Three or more antennas give poses; without positions,
    /// the distances of three antennas are the medians of their solutions
    #[arg(long = "antenna", value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = metres)]
    antennas_m: Vec<Vector3<f64>>,
    /// Solutions of a GNSS receiver that are the ground truth
    #[arg(long, value_name = "KIND", value_parser = choice(SOLUTIONS), default_value = "best")]
    truth_solutions: SolutionChoice,
    /// Convention of the file of a trajectory that is the ground truth, in the words of --convention
    #[arg(long, value_name = "WORDS", default_value = "xyzw", value_parser = convention)]
    truth_convention: Convention,
    /// Only this station of a deployment is the ground truth: the positions of its prism in its own frame
    #[arg(long, value_name = "NUMBER", value_parser = clap::value_parser!(u8).range(1..=MOST_STATIONS as i64))]
    truth_station: Option<u8>,
}

impl TruthArguments {
    /// Returns true if the flags ask for anything but the defaults.
    pub fn are_given(&self) -> bool {
        self.truth_sigma.is_some()
            || self.truth_topic.is_some()
            || !self.antennas_m.is_empty()
            || self.truth_solutions != SolutionChoice::default()
            || !self.truth_convention.is_as_read()
            || self.truth_station.is_some()
    }

    /// Returns the ground truth of an opened deployment, by the chosen station if there is one.
    ///
    /// # Errors
    /// If the station is none of the deployment, or if a deployment that is the ground truth has no answer.
    pub fn ground_truth<'a>(
        &self,
        deployment: &'a Deployment,
        analysis: &'a Analysis,
    ) -> Result<GroundTruth<'a>, Failure> {
        let station = self.truth_station.map(|number| station_index(deployment, number.into()));
        let truth = GroundTruth::of(deployment, analysis, station.transpose()?);
        if let GroundTruth::Deployment { .. } = truth {
            analysis.answer.clone()?;
        }
        Ok(truth)
    }

    /// Returns a deployment whose ground truth is a trajectory with the stated convention.
    fn converted(&self, mut truth: EstimatedTrajectory) -> Deployment {
        self.truth_convention.apply(&mut truth);
        add_findings_of_truth(&mut truth, &self.truth_convention);
        Deployment::of_ground_truth(Arc::new(truth))
    }

    /// Opens a deployment, or a trajectory as the ground truth of one; several files are those of antennas. `frames` are the times of
    /// KITTI poses without any.
    ///
    /// # Errors
    /// If the paths are neither, or if an option does not apply to them.
    pub fn open(
        &self,
        paths: &[PathBuf],
        extras: Extras,
        frames: Option<NumberedTimes>,
    ) -> Result<Arc<Deployment>, Failure> {
        let topic = &self.truth_topic;
        let without_times = frames.filter(|_| poses_without_times(&paths[0]).is_some());
        let opened = match (paths, without_times) {
            ([path], Some(frames)) => read_frames(path, frames).map(|truth| self.converted(truth)),
            ([path], None) if self.antennas_m.is_empty() => {
                let file = TrajectoryFile {
                    solutions: self.truth_solutions,
                    convention: self.truth_convention,
                    ..TrajectoryFile::at(path, topic.clone())
                };
                with_progress(&format!("reading {}", path.display()), |progress| {
                    open_truth(file, extras, progress)
                })
            }
            _ if topic.is_some() => {
                let line = "--truth-topic is for one bag, and several files are antennas";
                return Err(Failure::Usage(line.to_owned()));
            }
            (paths, _) => read_antennas(paths, &self.antennas_m, self.truth_solutions)
                .map(|truth| self.converted(truth)),
        };
        let mut deployment = Arc::new(opened?);
        match (&mut Arc::make_mut(&mut deployment).ground_truth, &self.truth_sigma) {
            (Some(truth), Some(sigma_m)) => {
                let truth = Arc::make_mut(truth);
                let covariance = PoseCovariance::of_position(sigma_m);
                truth.covariances = vec![covariance; truth.poses.len()];
            }
            (None, Some(_)) => {
                let line = "--truth-sigma is for a trajectory; a deployment estimates its own σ";
                return Err(Failure::Usage(line.to_owned()));
            }
            (Some(_), None) if self.truth_station.is_some() => {
                let line =
                    "--truth-station is for a deployment, and the ground truth is a trajectory";
                return Err(Failure::Usage(line.to_owned()));
            }
            _ => {}
        }
        Ok(deployment)
    }
}

fn sigma(text: &str) -> Result<Vector3<f64>, String> {
    const ASKED: &str = "give a positive number of metres, or three separated by commas";
    let sigma_m = match text.trim().parse() {
        Ok(sigma_m) => Vector3::repeat(sigma_m),
        Err(_) => metres(text).map_err(|_| ASKED.to_owned())?,
    };
    let is_valid = sigma_m.iter().all(|sigma_m| sigma_m.is_finite() && *sigma_m > 0.0);
    is_valid.then_some(sigma_m).ok_or_else(|| ASKED.to_owned())
}
