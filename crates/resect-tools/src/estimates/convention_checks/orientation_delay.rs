//! Orientations that are later or earlier than the positions of the same poses.

use nalgebra::Vector3;

use super::block_comparison::{BLOCKS, SIGNIFICANT};
use super::lever_equations::{
    FURTHER, LeverNormal, LeverRows, LeverVector, TIME_OFFSET, motion, position_rows, solve,
};
use crate::estimates::fit::Fit;
use crate::estimates::matched_pose::MatchedPose;
use resect_core::calibration::Estimate;

/// Smallest delay that is reported (s), and the least ratio of the squared errors without it to those with it.
/// Effect: a smaller ratio reports a delay of an estimate whose errors are of another kind.
const SHORTEST_S: f64 = 0.01;
const TIMES_BETTER: f64 = 1.3;
const FEWEST: usize = 10 * BLOCKS;
/// The further unknown is the time offset of the orientations.
const OF_ORIENTATIONS: usize = FURTHER;
/// Weight that makes both time offsets one, relative to the information on them.
const ONE_OFFSET: f64 = 1e3;

/// Normal equations of a block of the drive.
#[derive(Clone)]
struct BlockEquations {
    normal: LeverNormal,
    right: LeverVector,
    squares: f64,
}

/// Returns the time by which the orientations follow the positions (s), with σ by the jackknife over blocks of the drive; `None` if it is
/// not significant, or without orientations of both.
///
/// Positions and orientations have a time offset each. The lever arm is estimated with them, because a delay of the positions of a steady
/// drive is like one.
pub fn orientation_delay_s(pairs: &[MatchedPose], fit: &Fit) -> Option<Estimate> {
    if pairs.len() < FEWEST {
        return None;
    }
    let centre_m =
        pairs.iter().map(|pair| pair.truth.position_m).sum::<Vector3<f64>>() / pairs.len() as f64;
    let blocks: Option<Vec<BlockEquations>> = pairs
        .chunks(pairs.len().div_ceil(BLOCKS))
        .map(|block| equations(block, fit, centre_m))
        .collect();
    let blocks = blocks?;
    let all = BlockEquations {
        normal: blocks.iter().map(|block| block.normal).sum(),
        right: blocks.iter().map(|block| block.right).sum(),
        squares: blocks.iter().map(|block| block.squares).sum(),
    };
    let (value, squares) = delay_s(&all)?;
    if squares_without_delay(&all)? < TIMES_BETTER * squares {
        return None;
    }
    let without: Option<Vec<f64>> = blocks
        .iter()
        .map(|block| {
            let others = BlockEquations {
                normal: all.normal - block.normal,
                right: all.right - block.right,
                squares: all.squares - block.squares,
            };
            delay_s(&others).map(|(delay_s, _)| delay_s)
        })
        .collect();
    let without = without?;
    let count = without.len() as f64;
    let mean = without.iter().sum::<f64>() / count;
    let scatter: f64 = without.iter().map(|value| (value - mean).powi(2)).sum();
    let sigma = (scatter * (count - 1.0) / count).sqrt();
    (value.abs() > SHORTEST_S.max(SIGNIFICANT * sigma)).then_some(Estimate { value, sigma })
}

/// Normal equations of positions (m) and orientations (rad) of equal weight for each of the two.
fn equations(pairs: &[MatchedPose], fit: &Fit, centre_m: Vector3<f64>) -> Option<BlockEquations> {
    let mut equations =
        BlockEquations { normal: LeverNormal::zeros(), right: LeverVector::zeros(), squares: 0.0 };
    for pair in pairs {
        let [placed_m, true_m] = fit.both_positions_m(&pair.pose, &pair.truth);
        let [placed, true_orientation] = fit.both_orientations(&pair.pose, &pair.truth)?;
        let axes = -pair.truth.rotation.as_ref()?.orientation.to_rotation_matrix().into_inner();
        let [velocity, rate] = motion(pair, &fit.truth_from_estimate, fit.scale);
        let of_position = position_rows(&axes, &(placed_m - centre_m), &velocity);
        let mut of_orientation = LeverRows::zeros();
        of_orientation.set_column(OF_ORIENTATIONS, &rate);
        let turn = (true_orientation * placed.inverse()).scaled_axis();
        for (rows, error) in [(of_position, true_m - placed_m), (of_orientation, turn)] {
            equations.normal += rows.transpose() * rows;
            equations.right += rows.transpose() * error;
            equations.squares += error.norm_squared();
        }
    }
    Some(equations)
}

/// Returns the delay of the orientations after the positions (s), and the squared errors that it leaves.
fn delay_s(equations: &BlockEquations) -> Option<(f64, f64)> {
    let solution = solve(equations.normal, &equations.right)?;
    // Each is the time by which the estimate is behind: late orientations belong to an earlier time than late positions.
    let delay_s = solution[OF_ORIENTATIONS] - solution[TIME_OFFSET];
    Some((delay_s, equations.squares - solution.dot(&equations.right)))
}

/// Returns the squared errors that one time offset of both leaves.
fn squares_without_delay(equations: &BlockEquations) -> Option<f64> {
    let mut normal = equations.normal;
    let weight = ONE_OFFSET * normal[(TIME_OFFSET, TIME_OFFSET)];
    for (row, column, sign) in [
        (TIME_OFFSET, TIME_OFFSET, 1.0),
        (OF_ORIENTATIONS, OF_ORIENTATIONS, 1.0),
        (TIME_OFFSET, OF_ORIENTATIONS, -1.0),
        (OF_ORIENTATIONS, TIME_OFFSET, -1.0),
    ] {
        normal[(row, column)] += sign * weight;
    }
    Some(equations.squares - solve(normal, &equations.right)?.dot(&equations.right))
}
