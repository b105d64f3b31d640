//! Absolute and relative errors as evo defines them (Grupp 2017, "evo: Python package for the evaluation of odometry and
//! SLAM"; after Sturm et al. 2012, "A benchmark for the evaluation of RGB-D SLAM systems").

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use super::fit::Fit;
use super::matched_pose::MatchedPose;
use resect_core::statistics::median;

/// Lengths of the paths of relative errors (m).
pub const RELATIVE_M: [f64; 4] = [1.0, 5.0, 20.0, 100.0];

/// Summary of error sizes as printed by `evo_ape` and `evo_rpe`, in the errors' own unit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ape {
    pub count: usize,
    pub rmse: f64,
    pub mean: f64,
    pub median: f64,
    /// Standard deviation about the mean, normalised by the count.
    pub std: f64,
    pub min: f64,
    pub max: f64,
}

impl Ape {
    pub fn of(sizes: impl Iterator<Item = f64>) -> Self {
        let sizes: Vec<f64> = sizes.collect();
        if sizes.is_empty() {
            return Self::default();
        }
        let count = sizes.len() as f64;
        let mean = sizes.iter().sum::<f64>() / count;
        let mean_of = |of: &dyn Fn(f64) -> f64| sizes.iter().map(|s| of(*s)).sum::<f64>() / count;
        Self {
            count: sizes.len(),
            rmse: mean_of(&|size| size * size).sqrt(),
            mean,
            median: median(sizes.iter().copied()).unwrap_or_default(),
            std: mean_of(&|size| (size - mean).powi(2)).sqrt(),
            min: sizes.iter().copied().fold(f64::INFINITY, f64::min),
            max: sizes.iter().copied().fold(0.0, f64::max),
        }
    }
}

/// Errors of the relative motion over paths of one length.
#[derive(Clone, Debug, PartialEq)]
pub struct RelativeErrors {
    pub path_m: f64,
    /// Median length of the paths (m): they end at the first pose behind `path_m`.
    pub length_m: f64,
    /// Errors in metres: of the relative position, or, without orientations, of the distance between both ends.
    pub position: Ape,
    /// Errors in radians; `None` without orientations.
    pub rotation: Option<Ape>,
    /// Each path, in order of time.
    pub paths: Vec<RelativeError>,
}

/// Error of the relative motion over one path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelativeError {
    /// Time of its end (s, in the ground truth's time).
    pub time_s: f64,
    /// In the body's frame at the start of the path. Without orientations, the first component is the error of the distance.
    pub position_m: Vector3<f64>,
    pub rotation_rad: Option<Vector3<f64>>,
    /// Length of the path along the estimate (m).
    pub length_m: f64,
}

impl RelativeErrors {
    /// Returns true if there are enough paths of about this length for a comparison. Errors of few paths are mostly chance, and
    /// sparse points are further apart than short paths.
    pub fn are_conclusive(&self) -> bool {
        const FEWEST: usize = 10;
        const LONGER: f64 = 1.5;
        self.position.count >= FEWEST && self.length_m < LONGER * self.path_m
    }
}

/// Poses of the body at one instant, in the ground truth's frame.
struct BothPoses {
    time_s: f64,
    estimate_m: Vector3<f64>,
    truth_m: Vector3<f64>,
    /// Orientations by the estimate and by the ground truth; `None` if one of the two has no orientation.
    orientations: Option<[UnitQuaternion<f64>; 2]>,
}

/// Relative errors over consecutive paths of each length (m) along the estimate: `evo_rpe --delta LENGTH --delta_unit m`, and
/// without orientations with `--pose_relation point_distance`. Lengths without a complete path are left out.
pub fn relative(matched: &[MatchedPose], fit: &Fit, lengths_m: &[f64]) -> Vec<RelativeErrors> {
    let poses: Vec<BothPoses> = matched.iter().map(|pair| both(pair, fit)).collect();
    let each = lengths_m.iter().filter_map(|&path_m| {
        let (ends, lengths_m) = ends_of_paths(&poses, path_m);
        let paths: Vec<RelativeError> = ends
            .windows(2)
            .zip(lengths_m)
            .map(|(ends, length_m)| relative_error(&poses[ends[0]], &poses[ends[1]], length_m))
            .collect();
        let rotations: Option<Vec<f64>> =
            paths.iter().map(|path| Some(path.rotation_rad?.norm())).collect();
        (!paths.is_empty()).then(|| RelativeErrors {
            path_m,
            length_m: median(paths.iter().map(|path| path.length_m)).unwrap_or_default(),
            position: Ape::of(paths.iter().map(|path| path.position_m.norm())),
            rotation: rotations.map(|sizes| Ape::of(sizes.into_iter())),
            paths,
        })
    });
    each.collect()
}

fn relative_error(start: &BothPoses, end: &BothPoses, length_m: f64) -> RelativeError {
    let isometry = |at: &BothPoses, which: usize| {
        let position_m = [at.estimate_m, at.truth_m][which];
        Some(Isometry3::from_parts(Translation3::from(position_m), at.orientations?[which]))
    };
    let motion = |which: usize| Some(isometry(start, which)?.inverse() * isometry(end, which)?);
    match motion(0).zip(motion(1)) {
        Some((estimated, true_motion)) => {
            let error = true_motion.inverse() * estimated;
            RelativeError {
                time_s: end.time_s,
                position_m: error.translation.vector,
                rotation_rad: Some(error.rotation.scaled_axis()),
                length_m,
            }
        }
        None => {
            let estimated_m = (end.estimate_m - start.estimate_m).norm();
            let true_m = (end.truth_m - start.truth_m).norm();
            RelativeError {
                time_s: end.time_s,
                position_m: Vector3::x() * (estimated_m - true_m),
                rotation_rad: None,
                length_m,
            }
        }
    }
}

fn both(MatchedPose { pose, truth, .. }: &MatchedPose, fit: &Fit) -> BothPoses {
    let [estimate_m, truth_m] = fit.both_positions_m(pose, truth);
    let true_orientation = truth.rotation.as_ref().zip(fit.body_rotation);
    let true_orientation = true_orientation.map(|(rotation, body)| rotation.orientation * body);
    BothPoses {
        time_s: truth.time_s,
        estimate_m,
        truth_m,
        orientations: fit.placed_orientation(pose).zip(true_orientation).map(|(a, b)| [a, b]),
    }
}

/// Indices of the ends of consecutive paths, and the length of each path (m).
fn ends_of_paths(poses: &[BothPoses], path_m: f64) -> (Vec<usize>, Vec<f64>) {
    let (mut ends, mut lengths_m) = (vec![0], Vec::new());
    let mut along_m = 0.0;
    for (before, step) in poses.windows(2).enumerate() {
        along_m += (step[1].estimate_m - step[0].estimate_m).norm();
        if along_m >= path_m {
            ends.push(before + 1);
            lengths_m.push(along_m);
            along_m = 0.0;
        }
    }
    (ends, lengths_m)
}
