//! Every minimum worth knowing: enough starts to be sure of the lowest, its mirror twin, and what else fits.
//!
//! Besides the twin in height there can be minima with the rig turned or mirrored about the vertical (an L-shaped drive
//! has one that is turned by half a turn or so). So the search starts from the priors with every sign of their heights,
//! and then from the best so far with its rig turned and mirrored all around, until nothing lower comes up. All that
//! runs on a small sample; what is distinct there is followed up.

use super::levenberg_marquardt::{FINE_M, ROUGH_M};
use super::{CentredTriplets, Minimum, Parameters, minimise, same_solution};

/// Starts are tried on about this many triplets, evenly spread, to a tenth of a millimetre.
const SAMPLE: usize = 96;
const SAMPLE_TOLERANCE_M: f64 = 1e-4;
/// What is distinct there is followed up on this many.
pub const THINNED: usize = 1024;
/// Minima that cost this many times the lowest are no rivals of anything.
const HOPELESS: f64 = 100.0;
/// Turns of the rig about the vertical, and mirror images of it, that are tried from the best minimum so far.
const TURNS: usize = 12;
const PLANES: usize = 6;
/// Rounds of that; the second already finds nothing new unless the prior was poor.
const MOST_ROUNDS: usize = 4;
/// The twin of prisms at equal heights is the answer itself.
const SAME_TWIN_M: f64 = 1e-3;

/// What was found.
pub struct Minima {
    /// On all triplets.
    pub lowest: Minimum,
    /// The lowest minimum with mirrored heights, on all triplets; `None` where it runs back into the lowest.
    pub twin: Option<Minimum>,
    /// The best of the others, and its cost over that of the lowest, both on thinned triplets.
    pub rival: Option<(Parameters, f64)>,
}

pub fn find(data: &CentredTriplets, thinned: &CentredTriplets, priors: &[Parameters]) -> Minima {
    let sample = thinned.thinned(SAMPLE);
    let mut candidates: Vec<Minimum> = Vec::new();
    let mut starts = with_all_heights(data, priors);
    let mut least = f64::INFINITY;
    for _ in 0..MOST_ROUNDS {
        for start in starts {
            keep_if_new(data, &mut candidates, minimise(&sample, start, SAMPLE_TOLERANCE_M));
        }
        candidates.sort_by(|a, b| a.normal.cost.total_cmp(&b.normal.cost));
        if candidates[0].normal.cost > 0.999 * least {
            break;
        }
        least = candidates[0].normal.cost;
        starts = turned_all_around(data, &candidates[0].parameters);
    }
    let least = candidates[0].normal.cost;
    let mut minima: Vec<Minimum> = Vec::new();
    for candidate in candidates.iter().filter(|m| m.normal.cost <= HOPELESS * least) {
        keep_if_new(data, &mut minima, minimise(thinned, candidate.parameters, ROUGH_M));
    }
    minima.sort_by(|a, b| a.normal.cost.total_cmp(&b.normal.cost));

    let lowest = minimise(data, minima[0].parameters, FINE_M);
    let heights = data.height_differences_m(&lowest.parameters);
    let opposite = |p: &Parameters| {
        let other = data.height_differences_m(p);
        heights[0] * other[0] + heights[1] * other[1] < 0.0
    };
    let twin_start = minima[1..].iter().map(|m| m.parameters).find(opposite);
    let twin_start =
        twin_start.unwrap_or_else(|| data.mirrored_in_height(&lowest.parameters, [true, true]));
    let twin = minimise(data, twin_start, ROUGH_M);
    let twin = ((twin.parameters - lowest.parameters).amax() > SAME_TWIN_M).then_some(twin);

    let known = |m: &&Minimum| {
        let same =
            |p: &Parameters| same_solution(&data.transforms(p), &data.transforms(&m.parameters));
        same(&lowest.parameters) || twin.is_some_and(|twin| same(&twin.parameters))
    };
    let rival = minima
        .iter()
        .find(|m| !known(m))
        .map(|m| (m.parameters, m.normal.cost / minima[0].normal.cost.max(f64::MIN_POSITIVE)));
    Minima { lowest, twin, rival }
}

/// The priors, and the first one with the signs of heights that none of them has.
fn with_all_heights(data: &CentredTriplets, priors: &[Parameters]) -> Vec<Parameters> {
    let signs = |p: &Parameters| data.height_differences_m(p).map(|h| h < 0.0);
    let mut starts = priors.to_vec();
    for flips in [[true, true], [true, false], [false, true]] {
        let mirrored = data.mirrored_in_height(&priors[0], flips);
        if !priors.iter().any(|prior| signs(prior) == signs(&mirrored)) {
            starts.push(mirrored);
        }
    }
    starts
}

/// A solution with its rig turned about the vertical, and mirrored in vertical planes.
fn turned_all_around(data: &CentredTriplets, solution: &Parameters) -> Vec<Parameters> {
    let turn = |k: usize, steps: usize, whole_rad: f64| whole_rad * k as f64 / steps as f64;
    let turned = (1..TURNS).map(|k| data.turned(solution, turn(k, TURNS, std::f64::consts::TAU)));
    let mirrored = (0..PLANES)
        .map(|k| data.mirrored_in_plane(solution, turn(k, PLANES, std::f64::consts::PI)));
    turned.chain(mirrored).collect()
}

fn keep_if_new(data: &CentredTriplets, minima: &mut Vec<Minimum>, found: Minimum) {
    let transforms = data.transforms(&found.parameters);
    let known = minima
        .iter_mut()
        .find(|known| same_solution(&data.transforms(&known.parameters), &transforms));
    match known {
        Some(known) if known.normal.cost > found.normal.cost => *known = found,
        Some(_) => {}
        None => minima.push(found),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::LevelTransform;
    use crate::pipeline::Triplets;
    use nalgebra::{Rotation3, Vector3};

    /// Two straight legs with a right angle between them and nothing measured in the turn. Turning the rig by −90° and
    /// shifting the stations to match fits exactly as well: i + e^{iφ} − 1 has size 1 for φ = 0 and for φ = −π/2.
    #[test]
    fn two_legs_have_a_rival_that_is_found_from_any_prior() {
        let rig = [
            Vector3::new(0.4, 0.0, 0.4),
            Vector3::new(-0.3, 0.5, 0.0),
            Vector3::new(-0.1, -0.5, 0.2),
        ];
        let noise = |i: usize, k: f64| 0.001 * ((i as f64 * 12.9898 + k) * 78.233).sin();
        let points: [Vec<Vector3<f64>>; 3] = std::array::from_fn(|prism| {
            (0..400)
                .map(|i| {
                    let along = 0.1 * (i % 200) as f64;
                    let (at, heading) = if i < 200 {
                        (Vector3::new(40.0 + along, 5.0, 0.0), 0.0)
                    } else {
                        (Vector3::new(60.0, 5.0 + along, 0.0), std::f64::consts::FRAC_PI_2)
                    };
                    let k = prism as f64;
                    let error = Vector3::new(noise(i, k), noise(i, k + 5.0), noise(i, k + 9.0));
                    at + Rotation3::from_axis_angle(&Vector3::z_axis(), heading) * rig[prism]
                        + error
                })
                .collect()
        });
        let distances = crate::deployment::PAIRS.map(|(a, b)| (rig[a] - rig[b]).norm());
        let triplets =
            Triplets::new((0..400).map(|i| f64::from(i) * 0.1).collect(), vec![0; 400], points);
        let data = CentredTriplets::new(&triplets, distances);
        let truth = data.parameters(&[LevelTransform::IDENTITY; 3]);
        let thinned = data.thinned(THINNED);
        let poor = Parameters::from_column_slice(&[0.5, 0.3, 0.2, 0.1, -0.4, 0.6, 0.1, -0.1]);
        for prior in [truth, data.mirrored_in_plane(&truth, 1.0), poor] {
            let found = find(&data, &thinned, &[prior]);
            let (rival, cost_ratio) = found.rival.expect("two legs");
            assert!(cost_ratio < 2.0, "{cost_ratio}");
            let twin = found.twin.expect("level ground").parameters;
            let near = |p: &Parameters| {
                let flipped = data.mirrored_in_height(p, [true, true]);
                (p - truth).amax().min((flipped - truth).amax()) < 0.02
            };
            let candidates = [found.lowest.parameters, twin, rival];
            assert!(candidates.iter().any(near), "{candidates:?}");
        }
    }
}
