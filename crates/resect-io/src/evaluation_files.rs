//! Trajectories without a deployment: one of them is the ground truth, the others are evaluated against it.

use std::sync::Arc;

use crate::error::OpenError;
use crate::estimate_file;
use crate::findings::kinds;
use crate::source::{Source, TrajectoryFile};
use resect_core::deployment::Deployment;
use resect_core::progress::Progress;
use resect_tools::estimates::conventions::Convention;
use resect_tools::estimates::{
    EstimatedTrajectory, TruthReason, add_findings_of_truth, choose_truth,
};

/// Trajectories, and the ground truth among them.
#[derive(Clone, Debug)]
pub struct EvaluationFiles {
    pub truth: Arc<Deployment>,
    pub source: Source,
    pub estimates: Vec<EstimatedTrajectory>,
    pub reason: TruthReason,
}

impl EvaluationFiles {
    /// Chooses the ground truth; returns `None` without trajectories.
    ///
    /// # Errors
    /// If the file of the ground truth cannot be read again.
    pub fn of(all: Vec<EstimatedTrajectory>) -> Result<Option<Self>, OpenError> {
        let each: Vec<&EstimatedTrajectory> = all.iter().collect();
        let Some((index, reason)) = choose_truth(&each) else { return Ok(None) };
        Self::with_truth(all, index, reason).map(Some)
    }

    /// Reads the ground truth again, with other options of its file.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn with_file(
        file: TrajectoryFile,
        estimates: Vec<EstimatedTrajectory>,
    ) -> Result<Self, OpenError> {
        let source = Source::ground_truth(file);
        let truth = Arc::new(source.open(&Progress::default())?);
        Ok(Self { truth, source, estimates, reason: TruthReason::Chosen })
    }

    /// Makes the trajectory of this index the ground truth.
    ///
    /// # Errors
    /// If a file cannot be read again.
    pub fn with_truth(
        mut all: Vec<EstimatedTrajectory>,
        index: usize,
        reason: TruthReason,
    ) -> Result<Self, OpenError> {
        let truth = all.remove(index);
        let source = Source::ground_truth(TrajectoryFile::at(&truth.path, truth.topic.clone()));
        // An estimate has all solutions of a receiver, a ground truth the most accurate ones.
        let is_mixed =
            truth.findings.iter().any(|finding| finding.kind == kinds::GNSS_SOLUTIONS_MIXED);
        let truth = match is_mixed {
            true => source.open(&Progress::default())?,
            false => {
                let mut truth = truth;
                add_findings_of_truth(&mut truth, &Convention::AS_READ);
                Deployment::of_ground_truth(Arc::new(truth))
            }
        };
        for estimate in &mut all {
            let findings = &estimate.findings;
            if findings.iter().any(|finding| finding.kind == kinds::GNSS_SOLUTIONS_LEFT_OUT)
                && let Some(complete) = estimate_file::read(&estimate.path)?
                    .into_iter()
                    .find(|complete| complete.is_same(estimate))
            {
                *estimate = complete;
            }
        }
        Ok(Self { truth: Arc::new(truth), source, estimates: all, reason })
    }
}
