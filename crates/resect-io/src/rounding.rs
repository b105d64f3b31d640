//! Coordinates that are rounded too much.

use nalgebra::Vector3;

/// Smallest step of rounded coordinates that is reported (m), and the fewest positions that reveal it.
const LEAST_STEP_M: f64 = 0.02;
const FEWEST_ROUNDED: usize = 50;

/// Returns the axis whose coordinates are rounded most, and their step (m); `None` if none is rounded to centimetres.
pub fn rounded_axis(positions_m: &[Vector3<f64>]) -> Option<(usize, f64)> {
    if positions_m.len() < FEWEST_ROUNDED {
        return None;
    }
    let step_m = |axis: usize| {
        let mut values: Vec<f64> = positions_m.iter().map(|position_m| position_m[axis]).collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        let step_m = values.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
        // Measured coordinates hardly ever repeat.
        let repeat = values.len() > 1 && 2 * values.len() < positions_m.len();
        (repeat && step_m >= LEAST_STEP_M).then_some((axis, step_m))
    };
    (0..3).filter_map(step_m).max_by(|a, b| a.1.total_cmp(&b.1))
}
