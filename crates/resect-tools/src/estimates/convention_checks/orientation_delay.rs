//! Orientations that are later or earlier than the positions of the same poses.

use nalgebra::{SMatrix, SVector, Vector3};

use super::block_comparison::{BLOCKS, SIGNIFICANT};
use super::lever_equations::{LEVER_UNKNOWNS, TIME_OFFSET, motion, position_rows, solve};
use crate::estimates::fit::Fit;
use crate::estimates::matched_pose::MatchedPose;
use resect_core::calibration::Estimate;

/// Smallest delay that is reported (s), and the least ratio of the squared errors without it to those with it.
/// Effect: a smaller ratio reports a delay of an estimate whose errors are of another kind.
const SHORTEST_S: f64 = 0.01;
const TIMES_BETTER: f64 = 1.3;
const FEWEST: usize = 10 * BLOCKS;
/// Unknowns of the positions, and the time offset of the orientations.
const UNKNOWNS: usize = LEVER_UNKNOWNS + 1;

/// Normal equations of a block of the drive.
#[derive(Clone)]
struct BlockEquations {
    normal: SMatrix<f64, UNKNOWNS, UNKNOWNS>,
    right: SVector<f64, UNKNOWNS>,
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
        BlockEquations { normal: SMatrix::zeros(), right: SVector::zeros(), squares: 0.0 };
    for pair in pairs {
        let [placed_m, true_m] = fit.both_positions_m(&pair.pose, &pair.truth);
        let [placed, true_orientation] = fit.both_orientations(&pair.pose, &pair.truth)?;
        let axes = -pair.truth.rotation.as_ref()?.orientation.to_rotation_matrix().into_inner();
        let [velocity, rate] = motion(pair, &fit.truth_from_estimate, fit.scale);
        let mut rows = SMatrix::<f64, 6, UNKNOWNS>::zeros();
        let of_position = position_rows(&axes, &(placed_m - centre_m), &velocity);
        rows.fixed_view_mut::<3, LEVER_UNKNOWNS>(0, 0).copy_from(&of_position);
        rows.fixed_view_mut::<3, 1>(3, LEVER_UNKNOWNS).copy_from(&rate);
        let mut error = SVector::<f64, 6>::zeros();
        error.fixed_rows_mut::<3>(0).copy_from(&(true_m - placed_m));
        let turn = (true_orientation * placed.inverse()).scaled_axis();
        error.fixed_rows_mut::<3>(3).copy_from(&turn);
        equations.normal += rows.transpose() * rows;
        equations.right += rows.transpose() * error;
        equations.squares += error.norm_squared();
    }
    Some(equations)
}

/// Returns the delay of the orientations after the positions (s), and the squared errors that it leaves.
fn delay_s(equations: &BlockEquations) -> Option<(f64, f64)> {
    let solution = solve(equations.normal, &equations.right)?;
    // Each is the time by which the estimate is behind: late orientations belong to an earlier time than late positions.
    let delay_s = solution[LEVER_UNKNOWNS] - solution[TIME_OFFSET];
    Some((delay_s, equations.squares - solution.dot(&equations.right)))
}

/// Returns the squared errors that one time offset of both leaves.
fn squares_without_delay(equations: &BlockEquations) -> Option<f64> {
    let mut common = SMatrix::<f64, UNKNOWNS, LEVER_UNKNOWNS>::zeros();
    common.fixed_view_mut::<LEVER_UNKNOWNS, LEVER_UNKNOWNS>(0, 0).fill_with_identity();
    common[(LEVER_UNKNOWNS, TIME_OFFSET)] = 1.0;
    let right = common.transpose() * equations.right;
    let solution = solve(common.transpose() * equations.normal * common, &right)?;
    Some(equations.squares - solution.dot(&right))
}
