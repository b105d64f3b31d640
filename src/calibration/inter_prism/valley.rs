//! Whether two minima are ends of one valley, with no ridge between them.
//!
//! Where a drive leaves a direction free, the cost has a valley, and each start ends somewhere else in it; where noise
//! alone shapes its floor, there are minima along it that mean nothing. So one walks from one to the other, going down
//! to the floor at every step but not along it, and looks for a ridge.

use super::levenberg_marquardt::descend;
use super::{Minimum, NormalEquations, Parameters, SquaredCost};
use crate::geometry::wrap_to_pi;

/// A ridge that costs less than this many times the higher end is noise: 10 % are one σ of 200 independent residuals.
const RIDGE: f64 = 1.1;
const STEPS: usize = 8;
/// To the floor at every step.
const TOLERANCE_M: f64 = 1e-3;
const MOST_PASSES: usize = 20;

pub fn one_valley(cost: &SquaredCost, a: &Minimum, b: &Minimum) -> bool {
    let ceiling = RIDGE * a.normal.cost.max(b.normal.cost);
    let mut at = a.parameters;
    (1..STEPS).all(|step| {
        let mut ahead = b.parameters - at;
        for yaw in [3, 7] {
            ahead[yaw] = wrap_to_pi(ahead[yaw]);
        }
        let start = at + ahead / (STEPS + 1 - step) as f64;
        let floor = floor_across(cost, start, &ahead);
        at = floor.parameters;
        cost.at(&at).cost <= ceiling
    })
}

/// The lowest point of the plane through `start` across a direction: a stiff spring holds it there.
fn floor_across(cost: &SquaredCost, start: Parameters, direction: &Parameters) -> Minimum {
    // Metres: a radian of yaw moves the track by its radius.
    let metric = Parameters::from_fn(|k, _| if k % 4 == 3 { cost.radius_m.powi(2) } else { 1.0 });
    let across = direction.component_mul(&metric);
    let across = across / direction.dot(&across).sqrt();
    let stiffness = 1e3 * cost.at(&start).matrix.trace();
    let held = |p: &Parameters| {
        let NormalEquations { matrix, gradient, cost } = cost.at(p);
        let off = across.dot(&(p - start));
        NormalEquations {
            matrix: matrix + stiffness * across * across.transpose(),
            gradient: gradient + stiffness * off * across,
            cost: cost + stiffness * off * off,
        }
    };
    descend(held, cost.radius_m, start, TOLERANCE_M, MOST_PASSES)
}
