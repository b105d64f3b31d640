//! Test if two minima are ends of one valley of the cost, with no ridge between them.
//!
//! If a drive leaves a direction unobservable, the cost has a valley, and each start converges to another point of it. If noise
//! alone shapes the floor, the minima along it are meaningless. The test moves from one minimum to the other in steps. Each step
//! minimises the cost across the direction of travel and checks for a ridge.

use super::levenberg_marquardt::descend;
use super::prism_network::UNKNOWNS_PER_STATION;
use super::{Minimum, NormalEquations, Parameters, SquaredCost};
use crate::geometry::wrap_to_pi;

/// A ridge whose cost is below this many times the higher end is noise. Textbook: 10 % are one σ of 200 independent residuals.
const RIDGE: f64 = 1.1;
/// Number of steps along the line between two minima.
const STEPS: usize = 8;
/// Tolerance of each minimisation (m).
const TOLERANCE_M: f64 = 1e-3;
/// Most passes of each minimisation.
const MOST_PASSES: usize = 20;

pub fn one_valley(cost: &SquaredCost, a: &Minimum, b: &Minimum) -> bool {
    let ceiling = RIDGE * a.normal.cost.max(b.normal.cost);
    let mut at = a.parameters.clone();
    (1..STEPS).all(|step| {
        let mut ahead = &b.parameters - &at;
        for yaw in ahead.iter_mut().skip(3).step_by(UNKNOWNS_PER_STATION) {
            *yaw = wrap_to_pi(*yaw);
        }
        let start = &at + &ahead / (STEPS + 1 - step) as f64;
        at = floor_across(cost, start, &ahead).parameters;
        cost.at(&at).cost <= ceiling
    })
}

/// Returns the minimum in the plane through `start` across a direction. A stiff spring constrains the motion to the plane.
fn floor_across(cost: &SquaredCost, start: Parameters, direction: &Parameters) -> Minimum {
    // In metres: a radian of yaw moves the track by its radius.
    let metric = Parameters::from_fn(start.len(), |k, _| {
        if k % UNKNOWNS_PER_STATION == 3 { cost.radius_m.powi(2) } else { 1.0 }
    });
    let across = direction.component_mul(&metric);
    let across = &across / direction.dot(&across).sqrt();
    let stiffness = 1e3 * cost.at(&start).matrix.trace();
    let along_start = across.dot(&start);
    let held = |p: &Parameters, normal: &mut NormalEquations| {
        cost.evaluate(p, normal);
        let off = across.dot(p) - along_start;
        normal.matrix.ger(stiffness, &across, &across, 1.0);
        normal.gradient.axpy(stiffness * off, &across, 1.0);
        normal.cost += stiffness * off * off;
    };
    descend(held, cost.radius_m, start, TOLERANCE_M, MOST_PASSES)
}

#[cfg(test)]
mod tests {
    use super::super::levenberg_marquardt::descend;
    use super::super::minima::tests::two_legs;
    use super::*;
    use crate::geometry::LevelTransform;
    use nalgebra::{Rotation3, Vector3};

    fn minimum(cost: &SquaredCost, start: Parameters) -> Minimum {
        descend(|p, normal| cost.evaluate(p, normal), cost.radius_m, start, TOLERANCE_M, 40)
    }

    #[test]
    fn a_straight_drive_is_one_valley() {
        let data = two_legs(0.0);
        let cost = SquaredCost::of(&data);
        let truth = data.parameters(&[LevelTransform::IDENTITY; 3].into());
        // The rig can roll about the track: prisms 2 and 3 rotate about prism 1.
        let rolled = |angle: f64| {
            let roll = Rotation3::from_axis_angle(&Vector3::x_axis(), angle);
            let mut p = truth.clone();
            for at in [0, 4] {
                let t: Vector3<f64> = roll * truth.fixed_rows::<3>(at);
                p.fixed_rows_mut::<3>(at).copy_from(&t);
            }
            Minimum { normal: cost.at(&p), parameters: p, converged: true, passes: 0 }
        };
        for angle in [0.3, 1.0, -2.0] {
            assert!(one_valley(&cost, &rolled(0.0), &rolled(angle)), "{angle}");
        }
    }

    #[test]
    fn rivals_and_twins_have_a_ridge_between_them() {
        let data = two_legs(std::f64::consts::FRAC_PI_2);
        let cost = SquaredCost::of(&data);
        let truth = minimum(&cost, data.parameters(&[LevelTransform::IDENTITY; 3].into()));
        let twin = minimum(&cost, data.mirrored_in_height(&truth.parameters));
        let rival = minimum(&cost, data.turned(&truth.parameters, std::f64::consts::PI));
        for other in [twin, rival] {
            assert!(other.normal.cost < 2.0 * truth.normal.cost);
            assert!((&other.parameters - &truth.parameters).amax() > 0.3);
            assert!(!one_valley(&cost, &truth, &other));
            assert!(!one_valley(&cost, &other, &truth));
        }
    }
}
