//! Choice of the ground truth among trajectories that come without a deployment.

use resect_core::deployment::EstimatedTrajectory;

/// Words of a file name that mark a ground truth.
const TRUTH_WORDS: [&str; 13] = [
    "gt",
    "groundtruth",
    "truth",
    "reference",
    "ref",
    "leica",
    "prism",
    "rtk",
    "vicon",
    "mocap",
    "optitrack",
    "ms60",
    "ts16",
];

/// Evidence by which a trajectory is the ground truth of the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TruthReason {
    /// There is no other trajectory.
    Alone,
    /// The only name with a word for a ground truth.
    Name,
    /// It alone has positions only.
    PositionsOnly,
    /// The only file that states covariances.
    StatedSigma,
    /// Nothing distinguishes it; it was given last.
    Last,
    /// The user chose it.
    Chosen,
}

impl TruthReason {
    /// Returns the evidence as words in brackets; empty for a trajectory alone.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Alone => "",
            Self::Name => "by its name",
            Self::PositionsOnly => "the only one of positions without orientations",
            Self::StatedSigma => "the only one that states σ",
            Self::Last => "the last one given",
            Self::Chosen => "as chosen",
        }
    }
}

/// Returns the index of the ground truth and the evidence; `None` without trajectories.
pub fn choose_truth(all: &[&EstimatedTrajectory]) -> Option<(usize, TruthReason)> {
    let last = all.len().checked_sub(1)?;
    if last == 0 {
        return Some((0, TruthReason::Alone));
    }
    for reason in [TruthReason::Name, TruthReason::PositionsOnly, TruthReason::StatedSigma] {
        let mut matching = (0..all.len()).filter(|index| applies(reason, all[*index]));
        if let (Some(only), None) = (matching.next(), matching.next()) {
            return Some((only, reason));
        }
    }
    Some((last, TruthReason::Last))
}

/// Returns true if a trajectory has the evidence of this reason.
fn applies(reason: TruthReason, trajectory: &EstimatedTrajectory) -> bool {
    match reason {
        TruthReason::Name => is_named_truth(trajectory),
        TruthReason::PositionsOnly => !trajectory.has_orientations(),
        TruthReason::StatedSigma => !trajectory.covariances.is_empty(),
        TruthReason::Alone | TruthReason::Last | TruthReason::Chosen => false,
    }
}

/// Returns true if the name of the file or topic has a word for a ground truth.
fn is_named_truth(trajectory: &EstimatedTrajectory) -> bool {
    let stem = trajectory.path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    // A bag's name is that of all its trajectories.
    let name = trajectory.topic.as_ref().unwrap_or(&stem).to_lowercase();
    name.contains("groundtruth")
        || name.split(|c: char| !c.is_alphanumeric()).any(|word| TRUTH_WORDS.contains(&word))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{UnitQuaternion, Vector3};
    use resect_core::deployment::{EstimatedPose, PoseCovariance};

    fn trajectory(name: &str, has_orientations: bool, states_sigma: bool) -> EstimatedTrajectory {
        let orientation = has_orientations.then(UnitQuaternion::identity);
        let covariance = PoseCovariance::of_position(&Vector3::repeat(0.01));
        EstimatedTrajectory {
            name: name.to_owned(),
            path: format!("/data/{name}.tum").into(),
            topic: None,
            frames: None,
            poses: vec![EstimatedPose { time_s: 0.0, position_m: Vector3::zeros(), orientation }],
            covariances: if states_sigma { vec![covariance] } else { Vec::new() },
            origin: None,
            findings: Vec::new(),
        }
    }

    #[test]
    fn the_truth_is_the_one_that_differs_and_else_the_last() {
        let poses = |name: &str| trajectory(name, true, false);
        let points = |name: &str| trajectory(name, false, false);
        let sigma = |name: &str| trajectory(name, true, true);
        for (all, expected) in [
            (vec![], None),
            (vec![poses("slam")], Some((0, TruthReason::Alone))),
            (vec![poses("MH_05_groundtruth"), poses("MH_05_svo")], Some((0, TruthReason::Name))),
            (vec![points("room_PRISM"), poses("fastlio2")], Some((0, TruthReason::Name))),
            (vec![points("x"), poses("y"), poses("z")], Some((0, TruthReason::PositionsOnly))),
            (vec![sigma("x"), poses("y")], Some((0, TruthReason::StatedSigma))),
            (vec![poses("x"), poses("y")], Some((1, TruthReason::Last))),
            // Words of a name count as a whole, and two names with one decide nothing.
            (vec![poses("drift"), poses("gtsam")], Some((1, TruthReason::Last))),
            (vec![sigma("gt_1"), poses("gt_2")], Some((0, TruthReason::StatedSigma))),
        ] {
            let all: Vec<&EstimatedTrajectory> = all.iter().collect();
            let names: Vec<&str> = all.iter().map(|one| &*one.name).collect();
            assert_eq!(choose_truth(&all), expected, "{names:?}");
        }
    }
}
