//! The readings themselves instead of triplets: the motion of the three prisms is estimated with everything else, as
//! cubic splines that keep the rig's distances, so that nothing is interpolated and each reading counts by its own noise.
//!
//! Gauss–Newton on normal equations whose local unknowns are eliminated ([`arrow`]). The noise of ranges and of angles
//! and the drive's smoothness are learned as Helmert's variance components, the redundancies by random probes (Girard
//! 1989). Continuous-time batch estimation: Furgale, Barfoot & Sibley 2012; Barfoot, Tong & Särkkä 2014.

mod arrow;
mod observations;
mod spline;

use std::collections::BTreeMap;

use self::arrow::{Arrow, Eliminated, Row};
pub use self::observations::NoiseLevels;
use self::observations::{Drive, Estimates, Kind};
use self::spline::PER_KNOT;
use super::model::{CLOCKS, DRIFTS, State, transforms};
use super::{Estimate, INSTRUMENT, Matrix, reduced, robust_weight, step};
use crate::calibration::Loss;
use crate::calibration::time_blocks::BLOCK_SECONDS;
use crate::pipeline::Triplets;
use crate::progress::Progress;

/// Noise levels and weights settle within this many steps; then they are held, and what is left is nearly linear.
const SETTLING_STEPS: usize = 14;
const MOST_STEPS: usize = 30;
/// A step whose square is this share of the answer's variances changes nothing that anyone can see.
const SMALL_STEP: f64 = 1e-6;
/// Probes for each redundancy: good to three per cent of it.
const PROBES: u64 = 2;
/// Errors that are together this many times what is usual count half under Cauchy's loss, and are where Huber's bends.
const LOSS_SCALE: f64 = 2.4;
/// What is learned begins here: what is stated, and a motion that is free to follow the readings.
const FIRST_NOISE: NoiseLevels =
    NoiseLevels { range: 1.0, angle_rad: INSTRUMENT.angle_rad, jerk_m_per_s3: 1.0 };
/// No vehicle is smoother than this (m/s³), and no instrument ten times as good as it says.
const LEAST_JERK_M_PER_S3: f64 = 0.01;
const LEAST_NOISE_FACTOR: f64 = 0.1;
/// Clocks are looked at in this many parts of the drive; a jump must be larger than the least, and explain it better than
/// a drift by this many σ.
const PARTS: usize = 12;
const JUMP_SIGMAS: f64 = 5.0;
const LEAST_JUMP_S: f64 = 0.002;

/// What was found.
pub struct Found {
    pub state: State,
    /// What the readings say of the global unknowns, without their priors, by their noise alone.
    pub information: Matrix,
    /// How much more they scatter than that: 1 or more.
    pub overdispersion: f64,
    pub noise: NoiseLevels,
    /// Of stations 2 and 3.
    pub clock_jumps: [Option<ClockJump>; 2],
    pub converged: bool,
}

/// Stamps of a station that shift in the middle of a drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClockJump {
    /// About when, from the first triplet on (s).
    pub at_s: f64,
    /// By how much later they are after it (s).
    pub by_s: Estimate,
}

/// `None` without readings, or where they leave the motion free. Each iteration takes up to a second for hours of
/// data, so that between them `progress` is asked whether anyone still waits; if not, the answer is `None` as well.
pub fn estimate(
    triplets: &Triplets,
    start: &State,
    places: &[usize],
    precision: &State,
    loss: Loss,
    progress: &Progress,
) -> Option<Found> {
    let drive = Drive::new(triplets)?;
    let mut at =
        Estimates { coefficients_m: drive.start(triplets, &transforms(start)), global: *start };
    let mut by = Weighing { noise: FIRST_NOISE, loss, redundancy: 0.5, held: None };
    let mut converged = false;
    for iteration in 0..MOST_STEPS {
        progress.check().ok()?;
        if iteration == SETTLING_STEPS {
            by.held = Some(weights(&drive, &at, &by));
        }
        let eliminated = normal_equations(&drive, &at, &by).eliminate()?;
        let gradient = eliminated.global_gradient + precision.component_mul(&(at.global - start));
        let global = step(&eliminated.information, precision, 1.0, &gradient, places)?;
        let local = eliminated.local_step(&global);
        at.global -= global;
        at.coefficients_m.iter_mut().zip(&local).for_each(|(value, step)| *value -= step);
        let moved = (global.transpose() * eliminated.information * global)[0];
        if by.held.is_some() && moved < SMALL_STEP {
            converged = true;
            break;
        }
        // The first steps bring the motion to the readings; only then do errors tell of noise.
        if (2..SETTLING_STEPS).contains(&iteration) {
            (by.noise, by.redundancy) = learn(&drive, &at, &by, &eliminated);
        }
    }
    let eliminated = normal_equations(&drive, &at, &by).eliminate()?;
    let scatter = scatter(&drive, &at, &by, &eliminated, places)?;
    Some(Found {
        state: at.global,
        information: eliminated.information,
        overdispersion: scatter.overdispersion.max(1.0),
        noise: by.noise,
        clock_jumps: scatter.clock_jumps,
        converged,
    })
}

/// What equations count by.
struct Weighing {
    noise: NoiseLevels,
    loss: Loss,
    /// The share of a reading's errors that the motion does not take up.
    redundancy: f64,
    /// The weights of readings and of knots in their order, once they have settled.
    held: Option<Vec<f64>>,
}

/// Every equation with its weight; a reading's three share theirs, and so do a knot's.
fn each_equation(
    drive: &Drive,
    at: &Estimates,
    by: &Weighing,
    mut each: impl FnMut(Kind, f64, &Row, f64),
) {
    let transforms = transforms(&at.global);
    let mut rows = [Row::default(), Row::default(), Row::default()];
    let mut held = by.held.iter().flatten();
    let mut weight_of = |loss: Loss, rows: &[Row], redundancy: f64| match held.next() {
        Some(weight) => *weight,
        None => {
            let square: f64 = rows.iter().map(|row| row.error * row.error).sum();
            let size = (square / (rows.len() as f64 * redundancy)).sqrt();
            robust_weight(loss, size, Some(LOSS_SCALE)).0
        }
    };
    for (station, readings) in drive.readings.iter().enumerate() {
        for reading in readings {
            drive.reading(station, reading, at, &transforms, &by.noise, &mut rows);
            let weight = weight_of(by.loss, &rows, by.redundancy);
            for (row, kind) in rows.iter().zip([Kind::Range, Kind::Across, Kind::Across]) {
                each(kind, reading.time_s, row, weight);
            }
        }
    }
    drive.distances(at, |time_s, row| each(Kind::Distance, time_s, row, 1.0));
    drive.jerks(at, &by.noise, |time_s, rows| {
        // Vehicles start and stop, whatever the readings are like.
        let weight = weight_of(Loss::Cauchy, rows, 1.0);
        rows.iter().for_each(|row| each(Kind::Jerk, time_s, row, weight));
    });
}

/// The weights of readings and of knots, in their order.
fn weights(drive: &Drive, at: &Estimates, by: &Weighing) -> Vec<f64> {
    let (mut weights, mut count) = (Vec::new(), 0);
    each_equation(drive, at, by, |kind, _, _, weight| {
        let together = match kind {
            Kind::Range | Kind::Across => 3,
            Kind::Jerk => PER_KNOT,
            Kind::Distance => return,
        };
        if count == 0 {
            weights.push(weight);
        }
        count = (count + 1) % together;
    });
    weights
}

fn normal_equations(drive: &Drive, at: &Estimates, by: &Weighing) -> Arrow {
    let mut arrow = Arrow::new(at.coefficients_m.len());
    each_equation(drive, at, by, |_, _, row, weight| arrow.add(row, weight));
    arrow
}

/// Noise levels out of the errors and their redundancies, and the mean redundancy of readings.
fn learn(
    drive: &Drive,
    at: &Estimates,
    by: &Weighing,
    eliminated: &Eliminated,
) -> (NoiseLevels, f64) {
    let kinds = [Kind::Range, Kind::Across, Kind::Jerk];
    let (mut squares, mut counts) = ([0.0; 3], [0.0; 3]);
    let mut probes = vec![vec![0.0; at.coefficients_m.len()]; kinds.len() * PROBES as usize];
    let mut number = 0_u64;
    each_equation(drive, at, by, |kind, _, row, weight| {
        let Some(group) = kinds.iter().position(|other| *other == kind) else { return };
        squares[group] += weight * row.error * row.error;
        counts[group] += weight;
        for probe in 0..PROBES {
            number += 1;
            let right = &mut probes[group * PROBES as usize + probe as usize];
            let sign = weight.sqrt() * random_sign(number);
            row.local.iter().for_each(|(at, factor)| right[*at] += sign * factor);
        }
    });
    let mut taken_up = [0.0; 3];
    for (number, probe) in probes.iter_mut().enumerate() {
        let right = probe.clone();
        eliminated.solve_local(probe);
        let product: f64 = right.iter().zip(probe.iter()).map(|(a, b)| a * b).sum();
        taken_up[number / PROBES as usize] += product / PROBES as f64;
    }
    let [range, across, jerk] = [0, 1, 2];
    let left = |group: usize| (counts[group] - taken_up[group]).max(0.02 * counts[group]);
    let by_redundancy = |group: usize| (squares[group] / left(group)).sqrt();
    // The motion is hardly redundant where it is loosely held: expectation maximisation is slower and never astray.
    let jerk_factor = ((squares[jerk] + taken_up[jerk]) / counts[jerk].max(1.0)).sqrt();
    let least_rad = LEAST_NOISE_FACTOR * INSTRUMENT.angle_rad;
    let known = &by.noise;
    let learned = NoiseLevels {
        range: (known.range * by_redundancy(range)).max(LEAST_NOISE_FACTOR),
        angle_rad: (known.angle_rad * by_redundancy(across)).max(least_rad),
        jerk_m_per_s3: (known.jerk_m_per_s3 * jerk_factor).max(LEAST_JERK_M_PER_S3),
    };
    (learned, (left(range) + left(across)) / (counts[range] + counts[across]).max(1.0))
}

/// What the errors show over time.
struct Scatter {
    /// How much more the gradients of blocks of time scatter than the noise explains, on average over the unknowns: 1
    /// where the model holds, more where errors are correlated in time.
    overdispersion: f64,
    clock_jumps: [Option<ClockJump>; 2],
}

fn scatter(
    drive: &Drive,
    at: &Estimates,
    by: &Weighing,
    eliminated: &Eliminated,
    places: &[usize],
) -> Option<Scatter> {
    let followed = eliminated.followed();
    let (start_s, end_s) = (drive.spans.spans.first()?.start_s, drive.spans.spans.last()?.end_s);
    let part_s = ((end_s - start_s) / PARTS as f64).max(1e-3);
    let mut blocks: BTreeMap<i64, State> = BTreeMap::new();
    // Gradient and information of each clock by parts of the drive.
    let mut clocks = [[(0.0, 0.0); PARTS]; 2];
    each_equation(drive, at, by, |_, time_s, row, weight| {
        let mut effective = row.global;
        for (index, factor) in &row.local {
            effective.axpy(-factor, &followed[*index], 1.0);
        }
        let block = ((time_s - start_s) / BLOCK_SECONDS).floor() as i64;
        *blocks.entry(block).or_insert_with(State::zeros) += effective * (weight * row.error);
        let part = (((time_s - start_s) / part_s).max(0.0) as usize).min(PARTS - 1);
        for (slot, parts) in clocks.iter_mut().enumerate() {
            let by_clock = effective[CLOCKS + slot];
            parts[part].0 += weight * by_clock * row.error;
            parts[part].1 += weight * by_clock * by_clock;
        }
    });
    let middle: Matrix = blocks.values().map(|pull| pull * pull.transpose()).sum();
    let inverse = reduced(&eliminated.information, places).cholesky()?.inverse();
    let count = blocks.len() as f64;
    let freedom = (count - places.len() as f64).max(1.0) / count;
    let overdispersion =
        (inverse * reduced(&middle, places)).trace() / places.len() as f64 / freedom;
    let drifts = [at.global[DRIFTS], at.global[DRIFTS + 1]];
    let clock_jumps = std::array::from_fn(|slot| {
        jump(&clocks[slot], part_s, drifts[slot], overdispersion.max(1.0))
    });
    Some(Scatter { overdispersion, clock_jumps })
}

/// The likeliest jump of a clock, where it explains the parts of a drive clearly better than the drift that was found.
/// Parts have their gradient and information; each one's own offset is one step of Gauss–Newton away.
fn jump(
    parts: &[(f64, f64); PARTS],
    part_s: f64,
    drift: f64,
    overdispersion: f64,
) -> Option<ClockJump> {
    // Offset (s) without the common one, information, and the part's place in the drive: pauses have none.
    let offsets: Vec<(f64, f64, usize)> = parts
        .iter()
        .enumerate()
        .filter(|(_, (_, information))| *information > 0.0)
        .map(|(part, (pull, information))| {
            let drifted_s = drift * (part as f64 + 0.5 - 0.5 * PARTS as f64) * part_s;
            (drifted_s - pull / information, *information, part)
        })
        .collect();
    let by_drift: f64 = parts.iter().filter(|p| p.1 > 0.0).map(|(g, i)| g * g / i).sum();
    let level = |offsets: &[(f64, f64, usize)]| {
        let information: f64 = offsets.iter().map(|(_, i, _)| i).sum();
        let mean_s = offsets.iter().map(|(o, i, _)| o * i).sum::<f64>() / information;
        let squares: f64 = offsets.iter().map(|(o, i, _)| i * (o - mean_s).powi(2)).sum();
        (mean_s, information, squares)
    };
    (1..offsets.len().saturating_sub(1))
        .map(|first| {
            let (before, after) = (level(&offsets[..first]), level(&offsets[first..]));
            let sigma = (overdispersion * (1.0 / before.1 + 1.0 / after.1)).sqrt();
            let by_s = Estimate { value: after.0 - before.0, sigma };
            let better = (by_drift - before.2 - after.2) / overdispersion;
            // Somewhere between the last part before it and the first after it.
            let at_parts = 0.5 * (offsets[first - 1].2 + 1 + offsets[first].2) as f64;
            (better, ClockJump { at_s: at_parts * part_s, by_s })
        })
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .filter(|(better, jump)| {
            *better > JUMP_SIGMAS.powi(2) && jump.by_s.value.abs() > LEAST_JUMP_S
        })
        .map(|(_, jump)| jump)
}

/// +1 or −1; the same for the same number.
fn random_sign(number: u64) -> f64 {
    // Steele, Lea & Flood 2014, "splitmix64".
    let mut z = number.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    if (z ^ (z >> 31)) & 1 == 0 { 1.0 } else { -1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_jump_is_where_it_was_also_after_a_pause() {
        // Nothing was recorded in parts 2 to 6; the clock jumps by 10 ms between parts 8 and 9.
        let mut parts = [(0.0, 0.0); PARTS];
        for (part, own) in parts.iter_mut().enumerate().filter(|(part, _)| !(2..7).contains(part)) {
            let information = 1e8;
            let late_s = if part < 9 { -0.004 } else { 0.006 };
            *own = (-late_s * information, information);
        }
        let found = jump(&parts, 30.0, 0.0, 1.0).expect("a jump");
        assert_eq!(found.at_s, 270.0);
        assert!((found.by_s.value - 0.010).abs() < 1e-9, "{found:?}");
    }
}
