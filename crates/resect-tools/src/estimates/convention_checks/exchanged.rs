//! Estimate and ground truth that seem to be exchanged, by their names.

use std::path::Path;

use resect_core::deployment::EstimatedTrajectory;

/// Words in the names of ground truths and of estimates. They count between letters of another kind, so that `gt` is not in `length`.
const OF_TRUTHS: [&str; 12] = [
    "gt",
    "groundtruth",
    "ground",
    "truth",
    "reference",
    "ref",
    "prism",
    "leica",
    "vicon",
    "mocap",
    "optitrack",
    "rtk",
];
const OF_ESTIMATES: [&str; 20] = [
    "slam",
    "odom",
    "odometry",
    "est",
    "estimate",
    "estimated",
    "vio",
    "lio",
    "orb",
    "orbslam",
    "orbslam2",
    "orbslam3",
    "fastlio",
    "fastlio2",
    "vins",
    "kiss",
    "icp",
    "rtabmap",
    "cartographer",
    "rgbdslam",
];

/// Returns true if the estimate has the name of a ground truth and the ground truth that of an estimate.
pub fn exchanged(estimate: &EstimatedTrajectory, truth: &EstimatedTrajectory) -> bool {
    let [estimate, truth] =
        [estimate, truth].map(|trajectory| words(&trajectory.path, trajectory.topic.as_deref()));
    let has = |words: &[String], known: &[&str]| words.iter().any(|word| known.contains(&&**word));
    has(&estimate, &OF_TRUTHS)
        && has(&truth, &OF_ESTIMATES)
        && !has(&estimate, &OF_ESTIMATES)
        && !has(&truth, &OF_TRUTHS)
}

fn words(path: &Path, topic: Option<&str>) -> Vec<String> {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let name = format!("{stem} {}", topic.unwrap_or_default()).to_lowercase();
    let words = name.split(|letter: char| !letter.is_alphanumeric());
    words.filter(|word| !word.is_empty()).map(str::to_owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(path: &str) -> EstimatedTrajectory {
        EstimatedTrajectory {
            name: path.to_owned(),
            path: path.into(),
            topic: None,
            frames: None,
            poses: Vec::new(),
            covariances: Vec::new(),
            origin: None,
            findings: Vec::new(),
        }
    }

    #[test]
    fn names_of_both_show_an_exchange() {
        let is = |estimate: &str, truth: &str| exchanged(&named(estimate), &named(truth));
        assert!(is("freiburg1_xyz-groundtruth.txt", "freiburg1_xyz-rgbdslam.txt"));
        assert!(is("room00_gt.tum", "room00_fast-lio.tum") || is("gt.tum", "FAST-LIO2_odom.tum"));
        assert!(!is("freiburg1_xyz-rgbdslam.txt", "freiburg1_xyz-groundtruth.txt"));
        assert!(!is("length.tum", "odom.tum"), "gt within a word");
        assert!(!is("gt.tum", "other_gt.tum"));
        assert!(!is("gt_odom.tum", "slam.tum"));
    }
}
