//! Minimisation, for the most likely hyper-parameters.

use nalgebra::{Matrix2, Vector2};

/// Longest step along either coordinate (both are logarithms).
const LONGEST_STEP: f64 = 2.0;
/// Smallest predicted decrease (in nats) that is worth a step; the readings do not distinguish smaller ones.
const NEGLIGIBLE: f64 = 1e-3;

/// Minimises a smooth function in a box by BFGS (Nocedal & Wright 2006, ch. 6), with steps clipped to the box.
///
/// `curvature` is the size of a second derivative, for the first step. `evaluate` returns value, gradient and further
/// results, which are returned with the minimum.
pub fn in_box<More>(
    start: Vector2<f64>,
    (low, high): (Vector2<f64>, Vector2<f64>),
    curvature: f64,
    evaluate: impl Fn(&Vector2<f64>) -> (f64, Vector2<f64>, More),
) -> (Vector2<f64>, More) {
    let clip = |place: Vector2<f64>| place.sup(&low).inf(&high);
    let mut place = clip(start);
    let (mut value, mut slope, mut more) = evaluate(&place);
    let fresh = Matrix2::identity() / curvature;
    let mut inverse_hessian = fresh;
    for _ in 0..50 {
        // A coordinate at its bound is fixed if the function decreases outward.
        let free = Vector2::from_fn(|i, _| {
            let held =
                place[i] <= low[i] && slope[i] > 0.0 || place[i] >= high[i] && slope[i] < 0.0;
            if held { 0.0 } else { 1.0 }
        });
        let downhill = -slope.component_mul(&free);
        let mut step = (inverse_hessian * downhill).component_mul(&free);
        if step.dot(&downhill) <= 0.0 {
            step = fresh * downhill;
        }
        step *= (LONGEST_STEP / step.amax()).min(1.0);
        if step.dot(&downhill) < NEGLIGIBLE {
            break;
        }
        let accepted = (0..12).find_map(|halvings| {
            let trial = clip(place + step * 0.5_f64.powi(halvings));
            let found = evaluate(&trial);
            let promised = downhill.dot(&(trial - place));
            (found.0 <= value - 1e-4 * promised).then_some((trial, found))
        });
        let Some((trial, (trial_value, trial_slope, trial_more))) = accepted else { break };
        let (moved, turned) = (trial - place, trial_slope - slope);
        let bend = moved.dot(&turned);
        if bend > 1e-9 {
            let flatten = Matrix2::identity() - moved * turned.transpose() / bend;
            inverse_hessian =
                flatten * inverse_hessian * flatten.transpose() + moved * moved.transpose() / bend;
        }
        (place, value, slope, more) = (trial, trial_value, trial_slope, trial_more);
    }
    (place, more)
}

/// Returns the point with the smallest value, after one evaluation of each.
pub fn least<Place>(
    places: impl Iterator<Item = Place>,
    evaluate: impl Fn(&Place) -> f64,
) -> Option<Place> {
    let values = places.map(|place| (evaluate(&place), place));
    values.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, place)| place)
}

/// Minimises a function of one variable: the best of evenly spaced points, because there may be several minima, then a
/// golden-section search around it.
pub fn on_line(low: f64, high: f64, places: usize, evaluate: impl Fn(f64) -> f64) -> f64 {
    let spacing = (high - low) / (places - 1) as f64;
    let spread = (0..places).map(|k| low + spacing * k as f64);
    let best = least(spread, |place| evaluate(*place)).unwrap_or(low);
    let golden = (5.0_f64.sqrt() - 1.0) / 2.0;
    let (mut left, mut right) = ((best - spacing).max(low), (best + spacing).min(high));
    let mut inner = [right - golden * (right - left), left + golden * (right - left)];
    let mut found = inner.map(&evaluate);
    while right - left > 0.05 {
        if found[0] <= found[1] {
            right = inner[1];
            inner = [right - golden * (right - left), inner[0]];
            found = [evaluate(inner[0]), found[0]];
        } else {
            left = inner[0];
            inner = [inner[1], left + golden * (right - left)];
            found = [found[1], evaluate(inner[1])];
        }
    }
    (left + right) / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curved_valley_is_followed_to_its_end() {
        let rosenbrock = |p: &Vector2<f64>| {
            let (a, b) = (1.0 - p.x, p.y - p.x * p.x);
            let slope = Vector2::new(-2.0 * a - 400.0 * p.x * b, 200.0 * b);
            (a * a + 100.0 * b * b, slope, ())
        };
        let open = (Vector2::repeat(-5.0), Vector2::repeat(5.0));
        let (found, ()) = in_box(Vector2::new(-1.2, 1.0), open, 100.0, rosenbrock);
        assert!((found - Vector2::repeat(1.0)).norm() < 0.1, "{found}");
        // With a bound in between, the minimum lies on it, where y = x².
        let walled = (Vector2::repeat(-5.0), Vector2::new(0.5, 5.0));
        let (found, ()) = in_box(Vector2::new(-1.2, 1.0), walled, 100.0, rosenbrock);
        assert!((found - Vector2::new(0.5, 0.25)).norm() < 0.02, "{found}");
    }

    #[test]
    fn the_deeper_of_two_valleys_is_found() {
        let waves = |x: f64| (3.0 * x).cos() + 0.1 * x;
        let found = on_line(-2.0, 3.0, 11, waves);
        assert!((found + 1.0583).abs() < 0.03, "{found}");
    }
}
