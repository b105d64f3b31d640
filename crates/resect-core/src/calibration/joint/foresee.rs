//! What readings that are not taken yet will leave open: one pass about the truth, where nothing has to be found.

use std::sync::Arc;

use super::band_rows::{BORDER, MOTION_BORDER, TIED};
use super::drive::{Drive, PARTS_S};
use super::joint_estimate::JointEstimate;
use super::noise::FIRST_LEVELS;
use super::observed::Levels;
use super::pass::{Estimates, Model, Spare, Weigh, move_motion, pass};
use super::prisms::Solution;
use super::slow_changes;
use super::slow_priors::Wander;
use super::unknowns::{Constants, precisions, start};
use crate::calibration::ErrorSizes;
use crate::geometry::LevelTransform;
use crate::pipeline::Triplets;
use crate::progress::{Cancelled, Progress};

/// Steps that bring the motion to the readings.
const STEPS: usize = 2;
/// The share of a reading's errors that its motion does not take up, on drives of all kinds.
const REDUNDANCY: f64 = 0.6;

/// What an estimate would learn from the readings themselves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Expected {
    pub levels: Levels,
    /// How ranges wander, where [`ErrorSizes::ranges_wander`] says so.
    pub wander: Wander,
}

impl Default for Expected {
    fn default() -> Self {
        let wander = Wander { sigma_m: 1e-3, correlation_s: 12.0 };
        Self { levels: FIRST_LEVELS, wander }
    }
}

/// The joint estimate that such readings would have, as far as it does not depend on what is in them: its σ, and what they
/// are made of.
///
/// `station1_from_station` is where the stations are, or are taken to be, and the readings may have noise or none. Nothing is
/// learned, and no steps of stations or clocks are looked for. `Ok(None)` without readings, or where a direction is free.
pub fn foresee(
    triplets: &Triplets,
    station1_from_station: &[LevelTransform; 3],
    inter_prism_m: Option<&[f64; 3]>,
    sizes: &ErrorSizes,
    expected: &Expected,
    progress: &Progress,
) -> Result<Option<JointEstimate>, Cancelled> {
    const RIG: usize = 9;
    const PRISM: usize = 3;
    let start = start(station1_from_station, inter_prism_m);
    for part_s in PARTS_S {
        let Some(drive) = Drive::new(triplets, part_s) else { return Ok(None) };
        let drive = Arc::new(drive);
        let found = match inter_prism_m {
            Some(_) => {
                const ROW: usize = TIED * RIG;
                one_pass::<RIG, { ROW + BORDER }, { ROW + MOTION_BORDER }>(
                    drive, triplets, &start, sizes, expected, progress,
                )
            }
            None => {
                const ROW: usize = TIED * PRISM;
                one_pass::<PRISM, { ROW + BORDER }, { ROW + MOTION_BORDER }>(
                    drive, triplets, &start, sizes, expected, progress,
                )
            }
        }?;
        if found.is_some() {
            return Ok(found);
        }
    }
    Ok(None)
}

fn one_pass<const LOCAL: usize, const ROW: usize, const MOTION: usize>(
    drive: Arc<Drive>,
    triplets: &Triplets,
    start: &Constants,
    sizes: &ErrorSizes,
    expected: &Expected,
    progress: &Progress,
) -> Result<Option<JointEstimate>, Cancelled> {
    let mut priors = slow_changes::priors(sizes, start, &triplets.restarts_s);
    if sizes.ranges_wander {
        priors.wander = expected.wander;
    }
    let model = Model { precision: precisions(sizes), start: *start, priors };
    let by = Weigh { levels: expected.levels, redundancy: REDUNDANCY, held: None };
    let mut at = Estimates::start(&drive, triplets, start, LOCAL / 3);
    for _ in 0..STEPS {
        if move_motion::<LOCAL, MOTION>(&drive, &mut at, &by, progress)?.is_none() {
            return Ok(None);
        }
    }
    let pass = pass::<LOCAL, ROW>(&drive, &at, &by, &model, &mut Spare::default(), progress)?;
    Ok(pass.map(|pass| {
        let solution = Solution { drive, at, by, model, sizes: *sizes, prisms: LOCAL / 3 };
        JointEstimate { converged: true, ..pass.summary(solution) }
    }))
}
