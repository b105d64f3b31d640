//! Every minimum worth knowing: the lowest, its mirror twin, and what else fits.
//!
//! Besides the twin in height there can be minima with the rig turned or mirrored about the vertical (an L-shaped drive
//! has one that is turned by half a turn or so). The [`search`] finds them all on the compressed squared distances; the
//! exact cost of about a thousand triplets says which are worth listing; the lowest and its twin are finished on all.

use super::levenberg_marquardt::{FINE_M, ROUGH_M};
use super::search::search;
use super::{CentredTriplets, Minimum, Parameters, SquaredCost, minimise, same_solution};

/// The search, and what is listed beside the answer, see this many triplets, evenly spread: to compress all 20 000 of an
/// hour's drive would take as long as all the rest.
pub const THINNED: usize = 1024;
/// Minima that cost this many times the lowest fit thirty times worse and are no rivals of anything.
const HOPELESS: f64 = 1000.0;
/// The twin of prisms at equal heights is the answer itself.
const SAME_TWIN_M: f64 = 1e-3;

/// What was found.
pub struct Minima {
    /// On all triplets.
    pub lowest: Minimum,
    /// The lowest minimum with mirrored heights, on all triplets; `None` where it runs back into the lowest.
    pub twin: Option<Minimum>,
    /// All others in order of cost, and their cost over that of the lowest, both on thinned triplets.
    pub others: Vec<(Parameters, f64)>,
}

pub fn find(
    data: &CentredTriplets,
    thinned: &CentredTriplets,
    squared: &SquaredCost,
    priors: &[Parameters],
) -> Minima {
    let same =
        |a: &Parameters, b: &Parameters| same_solution(&data.transforms(a), &data.transforms(b));
    let candidates = search(squared, &with_all_heights(data, priors), same);
    let least = candidates[0].normal.cost;
    let mut minima: Vec<Minimum> = Vec::new();
    for candidate in candidates.iter().filter(|m| m.normal.cost <= HOPELESS * least) {
        let exact = minimise(thinned, candidate.parameters, ROUGH_M);
        // Two minima of the squared cost can be one of the exact cost.
        if !minima.iter().any(|known| same(&known.parameters, &exact.parameters)) {
            minima.push(exact);
        }
    }
    minima.sort_by(|a, b| a.normal.cost.total_cmp(&b.normal.cost));

    let lowest = minimise(data, minima[0].parameters, FINE_M);
    let heights = data.height_differences_m(&lowest.parameters);
    let opposite = |m: &&Minimum| {
        let other = data.height_differences_m(&m.parameters);
        heights[0] * other[0] + heights[1] * other[1] < 0.0
    };
    let mirrored = minima[1..].iter().find(opposite).map(|m| m.parameters);
    let twin_start =
        mirrored.unwrap_or_else(|| data.mirrored_in_height(&lowest.parameters, [true, true]));
    let twin = minimise(data, twin_start, ROUGH_M);
    let twin = ((twin.parameters - lowest.parameters).amax() > SAME_TWIN_M).then_some(twin);

    // Along a valley the same search ends elsewhere on other data, so what started the two is known as well.
    let known = |p: &Parameters| {
        Some(*p) == mirrored
            || same(p, &lowest.parameters)
            || twin.is_some_and(|twin| same(p, &twin.parameters))
    };
    let least = minima[0].normal.cost.max(f64::MIN_POSITIVE);
    let others = minima[1..]
        .iter()
        .filter(|m| !known(&m.parameters))
        .map(|m| (m.parameters, m.normal.cost / least))
        .collect();
    Minima { lowest, twin, others }
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
            let found = find(&data, &thinned, &SquaredCost::of(&thinned), &[prior]);
            let (rival, cost_ratio) = *found.others.first().expect("two legs");
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
