//! Absolute and relative errors as evo defines them (Grupp 2017, "evo: Python package for the evaluation of odometry and
//! SLAM"; after Sturm et al. 2012, "A benchmark for the evaluation of RGB-D SLAM systems").

use nalgebra::{Isometry3, Translation3};

use super::estimate::EstimatedPose;
use super::fit::Fit;
use super::reference::True;
use crate::statistics::median;

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
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelativeErrors {
    pub path_m: f64,
    /// Errors in metres, and in radians.
    pub position: Ape,
    pub rotation: Ape,
}

/// Relative errors over consecutive paths of each length (m) along the estimate: `evo_rpe --delta LENGTH --delta_unit m`.
/// Lengths without a complete path are left out. Empty without orientations.
pub fn relative(
    matched: &[(&EstimatedPose, &True)],
    fit: &Fit,
    lengths_m: &[f64],
) -> Vec<RelativeErrors> {
    let poses: Option<Vec<[Isometry3<f64>; 2]>> =
        matched.iter().map(|(pose, truth)| both(pose, truth, fit)).collect();
    let Some(poses) = poses else { return Vec::new() };
    let each = lengths_m.iter().filter_map(|&path_m| {
        let errors: Vec<Isometry3<f64>> = pairs(&poses, path_m)
            .into_iter()
            .map(|[from, to]| {
                let ([of_estimate, of_truth], [then, true_then]) = (&poses[from], &poses[to]);
                (of_truth.inverse() * true_then).inverse() * (of_estimate.inverse() * then)
            })
            .collect();
        (!errors.is_empty()).then(|| RelativeErrors {
            path_m,
            position: Ape::of(errors.iter().map(|error| error.translation.vector.norm())),
            rotation: Ape::of(errors.iter().map(|error| error.rotation.angle())),
        })
    });
    each.collect()
}

/// Body's pose by the estimate and by the ground truth, in station 1's frame.
fn both(pose: &EstimatedPose, truth: &True, fit: &Fit) -> Option<[Isometry3<f64>; 2]> {
    let (own, turned) = (fit.placed_orientation(pose)?, truth.turned.as_ref()?);
    let [placed_m, true_m] = fit.both_positions_m(pose, truth);
    Some([
        Isometry3::from_parts(Translation3::from(placed_m), own),
        Isometry3::from_parts(Translation3::from(true_m), turned.orientation * fit.body_rotation?),
    ])
}

/// Indices of the first and last pose of each path.
fn pairs(poses: &[[Isometry3<f64>; 2]], path_m: f64) -> Vec<[usize; 2]> {
    let mut ends = vec![0];
    let mut along_m = 0.0;
    for (before, step) in poses.windows(2).enumerate() {
        along_m += (step[1][0].translation.vector - step[0][0].translation.vector).norm();
        if along_m >= path_m {
            ends.push(before + 1);
            along_m = 0.0;
        }
    }
    ends.windows(2).map(|pair| [pair[0], pair[1]]).collect()
}
