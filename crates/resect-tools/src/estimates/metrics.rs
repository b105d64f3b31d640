//! Absolute and relative errors as evo defines them (Grupp 2017, "evo: Python package for the evaluation of odometry and
//! SLAM"; after Sturm et al. 2012, "A benchmark for the evaluation of RGB-D SLAM systems").

use nalgebra::{Isometry3, Translation3};

use super::delta::{Delta, RelativeOptions};
use super::fit::Fit;
use super::matched_pose::MatchedPose;
use super::motion_pairs::{BothPoses, MotionPair, NoMotions, motion_pairs};
use resect_core::statistics::median;

/// Summary of error sizes as printed by `evo_ape` and `evo_rpe`, in the errors' own unit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ape {
    pub count: usize,
    pub rmse: f64,
    /// σ of the root mean square by chance, and by those of clock, lever arm and body; `None` with too few errors.
    pub rmse_sigma: Option<f64>,
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
            rmse_sigma: None,
            mean,
            median: median(sizes.iter().copied()).unwrap_or_default(),
            std: mean_of(&|size| (size - mean).powi(2)).sqrt(),
            min: sizes.iter().copied().fold(f64::INFINITY, f64::min),
            max: sizes.iter().copied().fold(0.0, f64::max),
        }
    }

    /// Summarises errors at ascending times (s), with σ of the root mean square by the scatter of the squares of blocks of time. Errors of
    /// neighbouring blocks may be correlated.
    pub fn over_time(errors: &[(f64, f64)]) -> Self {
        let ape = Self::of(errors.iter().map(|(_, size)| *size));
        Self { rmse_sigma: sigma_by_chance(errors, ape.rmse), ..ape }
    }

    /// Adds the variance of an independent change, with which the errors are others.
    pub fn add_change(&mut self, changed: &Self) {
        if let Some(sigma) = &mut self.rmse_sigma {
            *sigma = sigma.hypot(changed.rmse - self.rmse);
        }
    }
}

/// Number of blocks of time for σ by chance, as for verdicts, and the fewest that show a scatter.
const BLOCKS: f64 = 24.0;
const FEWEST_BLOCKS: usize = 4;

fn sigma_by_chance(errors: &[(f64, f64)], rmse: f64) -> Option<f64> {
    let ([(first_s, _), ..], [.., (last_s, _)]) = (errors, errors) else { return None };
    let block_s = (last_s - first_s) / BLOCKS;
    let block = |time_s: f64| ((time_s - first_s) / block_s).floor().min(BLOCKS - 1.0);
    // By how much each block's squares differ from the mean of all.
    let blocks: Vec<f64> = errors
        .chunk_by(|a, b| block(a.0) == block(b.0))
        .map(|block| block.iter().map(|(_, size)| size * size - rmse * rmse).sum())
        .collect();
    if blocks.len() < FEWEST_BLOCKS || rmse == 0.0 {
        return None;
    }
    let count = blocks.len() as f64;
    let square: f64 = blocks.iter().map(|off| off * off).sum();
    let product: f64 = blocks.windows(2).map(|two| two[0] * two[1]).sum();
    // As in the verdicts, the correlation of few values is too small.
    let correlation = if square > 0.0 { product / square + 2.0 / count } else { 0.0 };
    let correlation = correlation.clamp(0.0, LARGEST_CORRELATION);
    let repeats = (1.0 + correlation) / (1.0 - correlation);
    let of_sum = square * count / (count - 1.0) * repeats;
    let of_mean_square = of_sum.sqrt() / errors.len() as f64;
    Some(of_mean_square / (2.0 * rmse))
}

/// Largest correlation of neighbouring blocks: the mean of 24 blocks then counts as that of two or three.
const LARGEST_CORRELATION: f64 = 0.8;

/// Errors of the relative motion over motions of one size.
#[derive(Clone, Debug, PartialEq)]
pub struct RelativeErrors {
    pub delta: Delta,
    /// Median size of the motions, in the unit of `delta`: they end at the first pose that is far enough.
    pub size: f64,
    /// Errors in metres: of the relative position, or, without orientations, of the distance between both ends.
    pub position: Ape,
    /// Errors in radians; `None` without orientations.
    pub rotation: Option<Ape>,
}

impl RelativeErrors {
    /// Returns the reason why the errors say little: errors of few motions are mostly chance, and sparse points are further apart
    /// than short motions.
    pub fn why_inconclusive(&self) -> Option<String> {
        const FEWEST: usize = 10;
        const LONGER: f64 = 1.5;
        let (count, delta) = (self.position.count, self.delta);
        if self.size >= LONGER * delta.value() {
            return Some(format!("the compared poses are too sparse for {delta}"));
        }
        (count < FEWEST).then(|| {
            let plural = if count == 1 { "" } else { "s" };
            format!("only {count} motion{plural} of {delta} in this drive; a value needs {FEWEST}")
        })
    }
}

/// Motions of one size, or the reason why there are none.
pub type Motions = Result<(Delta, Vec<MotionPair>), (Delta, NoMotions)>;

/// Returns the motions of each size along the estimate.
pub fn motions(matched: &[MatchedPose], fit: &Fit, options: &RelativeOptions) -> Vec<Motions> {
    let poses: Vec<BothPoses> = matched.iter().map(|pair| both(pair, fit)).collect();
    let of_delta = |delta: &Delta| match motion_pairs(&poses, *delta, options.all_pairs) {
        Ok(pairs) => Ok((*delta, pairs)),
        Err(why) => Err((*delta, why)),
    };
    options.deltas.iter().map(of_delta).collect()
}

/// Relative errors over motions: `evo_rpe --delta NUMBER --delta_unit m`, and without orientations with `--pose_relation point_distance`.
pub fn relative(
    matched: &[MatchedPose],
    fit: &Fit,
    motions: &[Motions],
) -> Vec<Result<RelativeErrors, (Delta, NoMotions)>> {
    let poses: Vec<BothPoses> = matched.iter().map(|pair| both(pair, fit)).collect();
    let of_motions = |motions: &Motions| {
        let (delta, pairs) = motions.as_ref().map_err(Clone::clone)?;
        let errors: Vec<RelativeError> =
            pairs.iter().map(|pair| relative_error(&poses, pair)).collect();
        let with_time = |sizes: &mut dyn Iterator<Item = f64>| -> Vec<(f64, f64)> {
            pairs.iter().map(|pair| poses[pair.ends[0]].time_s).zip(sizes).collect()
        };
        let rotations: Option<Vec<f64>> = errors.iter().map(|error| error.rotation_rad).collect();
        Ok(RelativeErrors {
            delta: *delta,
            size: median(pairs.iter().map(|pair| pair.size)).unwrap_or_default(),
            position: Ape::over_time(&with_time(&mut errors.iter().map(|error| error.position_m))),
            rotation: rotations.map(|sizes| Ape::over_time(&with_time(&mut sizes.into_iter()))),
        })
    };
    motions.iter().map(of_motions).collect()
}

/// Size of the error of the relative motion between two poses.
struct RelativeError {
    /// Without orientations, the error of the distance.
    position_m: f64,
    rotation_rad: Option<f64>,
}

fn relative_error(poses: &[BothPoses], pair: &MotionPair) -> RelativeError {
    let [start, end] = pair.ends.map(|index| &poses[index]);
    let isometry = |pose: &BothPoses, which: usize| {
        let position_m = [pose.estimate_m, pose.truth_m][which];
        Some(Isometry3::from_parts(Translation3::from(position_m), pose.orientations?[which]))
    };
    let motion = |which: usize| Some(isometry(start, which)?.inverse() * isometry(end, which)?);
    match motion(0).zip(motion(1)) {
        Some((estimated, true_motion)) => {
            let error = true_motion.inverse() * estimated;
            RelativeError {
                position_m: error.translation.vector.norm(),
                rotation_rad: Some(error.rotation.angle()),
            }
        }
        None => {
            let estimated_m = (end.estimate_m - start.estimate_m).norm();
            let true_m = (end.truth_m - start.truth_m).norm();
            RelativeError { position_m: (estimated_m - true_m).abs(), rotation_rad: None }
        }
    }
}

fn both(MatchedPose { pose, truth, .. }: &MatchedPose, fit: &Fit) -> BothPoses {
    let [estimate_m, truth_m] = fit.both_positions_m(pose, truth);
    let orientations = fit.both_orientations(pose, truth);
    BothPoses { time_s: truth.time_s, estimate_m, truth_m, orientations }
}
