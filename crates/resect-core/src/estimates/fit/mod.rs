//! What an estimate and the ground truth do not share: the zero of their clocks, where the estimate's body is in the vehicle,
//! and the estimate's frame.
//!
//! Clocks and lever arm are found together with the frame, by Gauss & Newton with Huber's loss on the distances between the
//! two; their σ come from blocks of time ([`sandwich`]), because errors of estimates drift, and from the errors that the ground
//! truth has at all instants alike, which no estimate's errors tell of. Then the frame is aligned once more, by plain least
//! squares over all epochs, as evo does it.

mod body;
mod pieces;

use crate::deployment::findings::studies::{estimate_clock_far_off, estimate_scale_off};
use nalgebra::{DMatrix, DVector, Rotation3, UnitQuaternion, Vector3};

use self::body::turn_body;
use self::pieces::{Pieces, by_common};
use super::errors::matched;
use super::reference::{Reference, True, sound};
use super::time_offset;
use super::unfit::Unfit;
use super::{Alignment, Body, Estimate, EstimatedPose, Options, Unjudged};
use crate::deployment::Finding;
use crate::evaluation::vehicle::Instants;
use crate::geometry::{RigidTransform, align_rigid, align_similar};
use crate::statistics::{median, sandwich};

/// Fits take so many epochs at most, evenly spread.
const MOST_EPOCHS: usize = 4000;
const MOST_STEPS: usize = 40;
/// Clock and lever arm are refined until a step is smaller (s, m).
const SETTLED: f64 = 1e-5;
/// Beyond such a change of the offset the ground truth is asked again, and not moved along its velocity (s): on the way,
/// and before the end.
const LINEAR_S: f64 = 0.01;
const EXACT_S: f64 = 1e-4;
/// Bodies sit on vehicles: what is known of a lever arm without the data (m, 1 σ). It decides only where the drive does not
/// tell, as on level ground the height.
const LEVER_SIGMA_M: f64 = 1.0;
const FEWEST_EPOCHS: usize = 10;
/// Clocks further apart than this (s) have nothing in common, such as one since 1970 and one since the start.
const FAR_S: f64 = 60.0;

/// How an estimate lies in the ground truth.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// `station1 = R (scale · estimate) + t`.
    pub station1_from_estimate: RigidTransform,
    pub scale: f64,
    /// What is added to the estimate's times (s); its σ where it was found.
    pub time_offset_s: f64,
    pub time_offset_sigma_s: Option<f64>,
    /// Where the body's origin is in the vehicle's frame (m); of a ground truth of one prism, where the prism is in the
    /// body's frame. `None` where nothing has an orientation. Its σ where it was found.
    pub lever_arm_m: Option<Vector3<f64>>,
    pub lever_arm_sigma_m: Option<Vector3<f64>>,
    /// `vehicle_from_body`, and its σ where it was found (rad); `None` where one of the two has no orientation.
    pub body_rotation: Option<UnitQuaternion<f64>>,
    pub body_rotation_sigma_rad: Option<f64>,
    pub findings: Vec<Finding>,
}

impl Fit {
    /// Where the compared point is in station 1's frame, by the estimate and in truth (m).
    pub fn both_positions_m(&self, pose: &EstimatedPose, truth: &True) -> [Vector3<f64>; 2] {
        let lever_m = self.lever_arm_m.unwrap_or_default();
        let mut placed_m = self.station1_from_estimate.apply(&(self.scale * pose.position_m));
        let mut true_m = truth.position_m;
        match (&truth.turned, self.placed_orientation(pose)) {
            (Some(turned), _) => true_m += turned.orientation * lever_m,
            (None, Some(own)) => placed_m += own * lever_m,
            (None, None) => {}
        }
        [placed_m, true_m]
    }

    /// The body's orientation in station 1's frame, by the estimate.
    pub fn placed_orientation(&self, pose: &EstimatedPose) -> Option<UnitQuaternion<f64>> {
        Some(UnitQuaternion::from(self.station1_from_estimate.rotation) * pose.orientation?)
    }
}

/// Brings an estimate together with the ground truth; gives the truth at its times as well.
pub fn fit(
    reference: &Reference<'_>,
    estimate: &Estimate,
    options: &Options,
) -> Result<(Fit, Vec<True>), Unjudged> {
    let unfit = |why| Unjudged::Unfit { name: estimate.name.clone(), why };
    let poses = &estimate.poses;
    if poses.len() < FEWEST_EPOCHS {
        return Err(unfit(Unfit::FewPoses(poses.len())));
    }
    let turning =
        reference.has_orientation() || poses.iter().all(|pose| pose.orientation.is_some());
    if matches!(options.body, Body::Lever(_)) && !turning {
        return Err(unfit(Unfit::NoOrientation));
    }
    let offset_s = match options.time_offset_s {
        Some(given_s) => given_s,
        None => {
            let truths = reference.at(Instants::Rate(time_offset::RATE_HZ))?;
            time_offset::coarse(poses, &truths).ok_or_else(|| unfit(Unfit::NoOverlap))?
        }
    };
    let mut sought = Sought {
        frame: options.alignment,
        clock: options.time_offset_s.is_none(),
        lever: options.body == Body::Found && turning,
    };
    let mut state = State {
        fit: Fit {
            station1_from_estimate: RigidTransform {
                rotation: Rotation3::identity(),
                translation_m: Vector3::zeros(),
            },
            scale: 1.0,
            time_offset_s: offset_s,
            time_offset_sigma_s: None,
            lever_arm_m: turning.then(|| match options.body {
                Body::Lever(lever_m) => lever_m,
                Body::Found | Body::Same => Vector3::zeros(),
            }),
            lever_arm_sigma_m: None,
            body_rotation: None,
            body_rotation_sigma_rad: None,
            findings: Vec::new(),
        },
        later_s: 0.0,
    };
    let thinned = thinned(poses);
    if sought.clock || sought.lever {
        let truths = at(reference, &thinned, offset_s)?;
        // Once and for all: a set that changes with the clock would not let it settle.
        let sound = sound(&matched(&thinned, &truths, offset_s));
        align(&mut state.fit, &sound, sought.frame).map_err(unfit)?;
        let poses: Vec<EstimatedPose> = sound.iter().map(|(pose, _)| **pose).collect();
        let longer = times_longer(&sound).filter(|_| sought.frame == Alignment::Rigid);
        refine(&mut state, reference, &poses, &mut sought, estimate).map_err(|why| {
            match (&why, longer) {
                (Unjudged::Unfit { why: Unfit::Undetermined, .. }, Some(longer)) => {
                    unfit(Unfit::OtherScale(longer))
                }
                _ => why,
            }
        })?;
    }
    let mut fit = state.fit;
    if options.time_offset_s.is_none() && fit.time_offset_s.abs() > FAR_S {
        fit.findings.push(estimate_clock_far_off(&estimate.name, -fit.time_offset_s));
    }
    let truths = at(reference, poses, fit.time_offset_s)?;
    let pairs = matched(poses, &truths, fit.time_offset_s);
    align(&mut fit, &pairs, options.alignment).map_err(unfit)?;
    if let Some(longer) = times_longer(&pairs).filter(|_| options.alignment == Alignment::Rigid) {
        let why = Unfit::OtherScale(longer).to_string();
        fit.findings.push(estimate_scale_off(&estimate.name, longer, &why));
    }
    turn_body(&mut fit, &pairs, options.body == Body::Same);
    Ok((fit, truths))
}

/// What is to be found.
struct Sought {
    frame: Alignment,
    clock: bool,
    lever: bool,
}

/// Where the search is: what the fit says, and how much later than when the ground truth was asked (s).
struct State {
    fit: Fit,
    later_s: f64,
}

fn at(
    reference: &Reference<'_>,
    poses: &[EstimatedPose],
    offset_s: f64,
) -> Result<Vec<True>, Unjudged> {
    let times_s: Vec<f64> = poses.iter().map(|pose| pose.time_s + offset_s).collect();
    Ok(reference.at(Instants::At(&times_s))?)
}

/// Tells how many times as long as the ground truth's the estimate's ways are, where that is no drift but another unit, or one
/// camera alone: the median over ways of some metres, whatever the two frames and errors are.
fn times_longer(pairs: &[(&EstimatedPose, &True)]) -> Option<f64> {
    const WAY_M: f64 = 2.0;
    const DRIFT: f64 = 1.1;
    let (mut from, mut ratios) = (0, Vec::new());
    for (to, (pose, truth)) in pairs.iter().enumerate() {
        let (first, first_true) = pairs[from];
        let true_m = (truth.position_m - first_true.position_m).norm();
        if true_m >= WAY_M {
            ratios.push((pose.position_m - first.position_m).norm() / true_m);
            from = to;
        }
    }
    median(ratios).filter(|longer| *longer > 0.0 && !(DRIFT.recip()..DRIFT).contains(longer))
}

fn thinned(poses: &[EstimatedPose]) -> Vec<EstimatedPose> {
    poses.iter().step_by(poses.len().div_ceil(MOST_EPOCHS).max(1)).copied().collect()
}

/// The frame by plain least squares, clock and lever arm as they are.
pub fn align(
    fit: &mut Fit,
    pairs: &[(&EstimatedPose, &True)],
    alignment: Alignment,
) -> Result<(), Unfit> {
    if pairs.len() < FEWEST_EPOCHS {
        return Err(Unfit::FewEpochs);
    }
    if alignment == Alignment::None {
        return Ok(());
    }
    let lever_m = fit.lever_arm_m.unwrap_or_default();
    let of_truth: Vec<Vector3<f64>> = pairs
        .iter()
        .map(|(_, truth)| match &truth.turned {
            Some(turned) => truth.position_m + turned.orientation * lever_m,
            None => truth.position_m,
        })
        .collect();
    let own: Vec<Vector3<f64>> = pairs
        .iter()
        .map(|(pose, truth)| match (&truth.turned, pose.orientation) {
            // The lever is as long whatever the scale.
            (None, Some(own)) => pose.position_m + own * lever_m / fit.scale,
            _ => pose.position_m,
        })
        .collect();
    let found = match alignment {
        Alignment::Similarity => align_similar(&of_truth, &own),
        _ => align_rigid(&of_truth, &own).map(|transform| (transform, 1.0)),
    };
    (fit.station1_from_estimate, fit.scale) = found.ok_or(Unfit::OnALine)?;
    Ok(())
}

const UNKNOWNS: usize = 11;
const TRANSLATION: usize = 3;
const SCALE: usize = 6;
const LEVER: usize = 7;
const CLOCK: usize = 10;

/// Frame, lever arm and clock together, with the σ of the latter two.
fn refine(
    state: &mut State,
    reference: &Reference<'_>,
    poses: &[EstimatedPose],
    sought: &mut Sought,
    estimate: &Estimate,
) -> Result<(), Unjudged> {
    let unfit = |why| Unjudged::Unfit { name: estimate.name.clone(), why };
    let open = |sought: &Sought| -> Vec<usize> {
        let frame = match sought.frame {
            Alignment::None => 0..0,
            Alignment::Rigid => 0..SCALE,
            Alignment::Similarity => 0..SCALE + 1,
        };
        let lever = if sought.lever { LEVER..CLOCK } else { 0..0 };
        let clock = if sought.clock { CLOCK..UNKNOWNS } else { 0..0 };
        frame.chain(lever).chain(clock).collect()
    };
    let open = open(sought);
    let mut asked_s = state.fit.time_offset_s;
    let mut truths = at(reference, poses, asked_s)?;
    for _ in 0..MOST_STEPS {
        let pairs = matched(poses, &truths, asked_s);
        if pairs.len() < FEWEST_EPOCHS {
            return Err(unfit(Unfit::FewEpochs));
        }
        let pieces = Pieces::of(&pairs, state);
        let (blocks, prior) = (pieces.blocks(&open), prior_of(&open));
        let mut information = DMatrix::from_diagonal(&prior);
        let mut gradient = DVector::zeros(open.len());
        for block in &blocks {
            information += &block.information;
            gradient += &block.gradient;
        }
        let now = DVector::from_iterator(open.len(), open.iter().map(|k| state.value(*k)));
        gradient -= prior.component_mul(&now);
        let root = information.cholesky().ok_or_else(|| unfit(Unfit::Undetermined))?;
        let step = root.solve(&gradient);
        let change = state.step(&open, &step);
        let settled = change < SETTLED;
        if state.later_s.abs() > if settled { EXACT_S } else { LINEAR_S } {
            state.later_s = 0.0;
            asked_s = state.fit.time_offset_s;
            truths = at(reference, poses, asked_s)?;
        } else if settled {
            let prior = sandwich::Prior { precision: prior, weight: 1.0 };
            let mut covariance = sandwich::covariance(&blocks, Some(&prior))
                .ok_or_else(|| unfit(Unfit::Undetermined))?;
            let times_s: Vec<f64> = pairs.iter().map(|(_, truth)| truth.time_s).collect();
            if let Some(common) = reference.common_errors(&times_s) {
                let moved = root.solve(&by_common(&pieces, &open, state, &common));
                covariance += &moved * &common.covariance * moved.transpose();
            }
            state.take_sigmas(&open, &covariance);
            return Ok(());
        }
    }
    Err(unfit(Unfit::Undetermined))
}

impl State {
    /// What the prior is about.
    fn value(&self, unknown: usize) -> f64 {
        match unknown {
            LEVER..CLOCK => self.fit.lever_arm_m.unwrap_or_default()[unknown - LEVER],
            _ => 0.0,
        }
    }

    /// Takes a step; gives how large it was, in metres or seconds.
    fn step(&mut self, open: &[usize], step: &DVector<f64>) -> f64 {
        let mut turn = Vector3::zeros();
        let mut change: f64 = 0.0;
        for (k, by) in open.iter().zip(step.iter()) {
            match *k {
                0..TRANSLATION => turn[*k] = *by,
                TRANSLATION..SCALE => {
                    self.fit.station1_from_estimate.translation_m[k - TRANSLATION] += by;
                }
                SCALE => self.fit.scale *= by.exp(),
                LEVER..CLOCK => {
                    if let Some(lever_m) = &mut self.fit.lever_arm_m {
                        lever_m[k - LEVER] += by;
                    }
                    change = change.max(by.abs());
                }
                _ => {
                    self.fit.time_offset_s += by;
                    self.later_s += by;
                    change = change.max(by.abs());
                }
            }
        }
        let rotation = &mut self.fit.station1_from_estimate.rotation;
        *rotation = Rotation3::new(turn) * *rotation;
        change
    }

    fn take_sigmas(&mut self, open: &[usize], covariance: &DMatrix<f64>) {
        let sigma = |unknown: usize| {
            let at = open.iter().position(|k| *k == unknown)?;
            Some(covariance[(at, at)].max(0.0).sqrt())
        };
        self.fit.time_offset_sigma_s = sigma(CLOCK);
        let lever = [0, 1, 2].map(|axis| sigma(LEVER + axis));
        if let [Some(x), Some(y), Some(z)] = lever {
            self.fit.lever_arm_sigma_m = Some(Vector3::new(x, y, z));
        }
    }
}

/// 1/σ² of what is known of the unknowns without the data.
fn prior_of(open: &[usize]) -> DVector<f64> {
    let precision = |unknown: &usize| match *unknown {
        LEVER..CLOCK => LEVER_SIGMA_M.powi(-2),
        _ => 0.0,
    };
    DVector::from_iterator(open.len(), open.iter().map(precision))
}
