//! All relevant minima: the lowest, its mirror twin, and others that fit.
//!
//! Besides the twin in height there can be minima with the rig rotated or mirrored about the vertical. An L-shaped drive has one
//! that is rotated by about half a turn. The [`search`] finds all minima of the compressed squared distances. The exact cost of
//! about a thousand triplets decides which are listed. The lowest minimum and its twin are refined on all triplets.

use super::levenberg_marquardt::{FINE_M, ROUGH_M};
use super::search::search;
use super::{CentredTriplets, Minimum, Parameters, PrismNetwork, SquaredCost, basin, minimise};
use crate::calibration::Basin;
use crate::network::{PerStation, Prism, Station};

/// Number of triplets, evenly spread, for the search and the list of minima. Compressing all 20 000 triplets of an hour's drive
/// would take as long as all other computations.
pub const THINNED: usize = 1024;
/// Minima with more than this many times the lowest cost fit thirty times worse and are not rivals.
const HOPELESS: f64 = 1000.0;
/// Most priors of the search. Three stations have at most seven. More stations have up to two to the power of their number, of which
/// only those with the lowest cost can lead to the lowest minimum and its twin.
const MOST_PRIORS: usize = 16;
/// A twin within this is the answer itself (m): prisms at equal heights.
pub const SAME_TWIN_M: f64 = 1e-3;

/// Minima of the cost.
pub struct Minima {
    /// The lowest minimum on all triplets.
    pub lowest: Minimum,
    /// The lowest minimum with mirrored heights, on all triplets; `None` if its descent converges to the lowest.
    pub twin: Option<Minimum>,
    /// All others in order of cost, with their cost over the lowest; both on thinned triplets.
    pub others: Vec<(Parameters, f64)>,
}

impl Minima {
    /// Returns all minima in order of cost. The mean squares of the others are extrapolated to all triplets from the cost ratios on
    /// the thinned ones.
    pub fn basins(&self, data: &CentredTriplets) -> Vec<Basin> {
        let lowest = basin(data, &self.lowest);
        let least_m2 = lowest.mean_square_m2;
        let others = self.others.iter().map(|(parameters, cost_ratio)| Basin {
            station1_from_station: data.transforms(parameters),
            mean_square_m2: cost_ratio * least_m2,
            height_differences_m: data.height_differences_m(parameters),
        });
        let twin = self.twin.as_ref().map(|twin| basin(data, twin));
        let mut all: Vec<Basin> = [lowest].into_iter().chain(twin).chain(others).collect();
        all.sort_by(|a, b| a.mean_square_m2.total_cmp(&b.mean_square_m2));
        all
    }
}

pub fn find(
    data: &CentredTriplets,
    thinned: &CentredTriplets,
    squared: &SquaredCost,
    priors: &[Parameters],
) -> Minima {
    let same = |a: &Parameters, b: &Parameters| data.are_same(a, b);
    let candidates = search(squared, &with_all_heights(data, squared, priors), same);
    let least = candidates[0].normal.cost;
    let mut minima: Vec<Minimum> = Vec::new();
    for candidate in candidates.iter().filter(|m| m.normal.cost <= HOPELESS * least) {
        let exact = minimise(thinned, candidate.parameters.clone(), ROUGH_M);
        // Two minima of the squared cost can converge to one of the exact cost.
        if !minima.iter().any(|known| same(&known.parameters, &exact.parameters)) {
            minima.push(exact);
        }
    }
    minima.sort_by(|a, b| a.normal.cost.total_cmp(&b.normal.cost));

    let lowest = minimise(data, minima[0].parameters.clone(), FINE_M);
    let heights = data.height_differences_m(&lowest.parameters);
    let opposite = |m: &&Minimum| {
        let other = data.height_differences_m(&m.parameters);
        heights.iter().zip(&other).map(|(own, other)| own * other).sum::<f64>() < 0.0
    };
    let mirrored = minima[1..].iter().find(opposite).map(|m| m.parameters.clone());
    let twin_start =
        mirrored.clone().unwrap_or_else(|| data.mirrored_in_height(&lowest.parameters));
    let twin = minimise(data, twin_start, ROUGH_M);
    let twin = ((&twin.parameters - &lowest.parameters).amax() > SAME_TWIN_M).then_some(twin);

    // In a valley, the same descent converges to another point on other data, so the start of the twin is excluded as well.
    let known = |p: &Parameters| {
        Some(p) == mirrored.as_ref()
            || same(p, &lowest.parameters)
            || twin.as_ref().is_some_and(|twin| same(p, &twin.parameters))
    };
    let least = minima[0].normal.cost.max(f64::MIN_POSITIVE);
    let others = minima[1..]
        .iter()
        .filter(|m| !known(&m.parameters))
        .map(|m| (m.parameters.clone(), m.normal.cost / least))
        .collect();
    Minima { lowest, twin, others }
}

/// Returns the priors, and copies of the first one with the signs of heights that none of them has.
fn with_all_heights(
    data: &CentredTriplets,
    squared: &SquaredCost,
    priors: &[Parameters],
) -> Vec<Parameters> {
    let signs = |p: &Parameters| data.height_differences_m(p).map(|h| *h < 0.0);
    let mut starts = priors.to_vec();
    for flips in height_flips(&data.network) {
        let mirrored = data.flipped(&priors[0], &flips);
        if !priors.iter().any(|prior| signs(prior) == signs(&mirrored)) {
            starts.push(mirrored);
        }
    }
    if starts.len() > MOST_PRIORS {
        let costs_m2 = starts.into_iter().map(|start| (squared.at(&start).cost, start));
        let mut by_cost: Vec<(f64, Parameters)> = costs_m2.collect();
        by_cost.sort_by(|a, b| a.0.total_cmp(&b.0));
        starts = by_cost.into_iter().take(MOST_PRIORS).map(|(_, start)| start).collect();
    }
    starts
}

/// Returns all choices of prisms whose heights are flipped, all of them first. Stations that follow the same prism flip together, and
/// those that follow the prism of station 1 do not flip.
fn height_flips(network: &PrismNetwork) -> Vec<PerStation<bool>> {
    let prisms = &network.prism_of_station;
    let mut flipped: Vec<Prism> = Vec::new();
    for prism in prisms {
        if *prism != prisms[Station::FIRST] && !flipped.contains(prism) {
            flipped.push(*prism);
        }
    }
    let choice = |bits: usize| {
        prisms.map(|prism| {
            let place = flipped.iter().position(|other| other == prism);
            place.is_some_and(|place| bits >> (flipped.len() - 1 - place) & 1 == 1)
        })
    };
    (1..1_usize << flipped.len()).rev().map(choice).collect()
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::{closed_form_priors, same_solution};
    use super::*;
    use crate::geometry::LevelTransform;
    use crate::network::{Number, PerPair};
    use crate::pipeline::{PipelineSettings, Triplets};
    use crate::simulated_drives::{self, Preset};
    use nalgebra::{Rotation3, Vector3};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// Two straight legs at an angle, without measurements in the turn, with noise of a millimetre; all stations have the same
    /// frame.
    pub fn two_legs(angle_rad: f64) -> CentredTriplets {
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
                    let corner = Vector3::new(60.0, 5.0, 0.0);
                    let (from_corner, heading) =
                        if i < 200 { (along - 20.0, 0.0) } else { (along, angle_rad) };
                    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), heading);
                    let k = prism as f64;
                    let error = Vector3::new(noise(i, k), noise(i, k + 5.0), noise(i, k + 9.0));
                    corner + turn * (from_corner * Vector3::x() + rig[prism]) + error
                })
                .collect()
        });
        let distances = crate::deployment::pairwise_distances(&rig);
        let triplets =
            Triplets::new((0..400).map(|i| f64::from(i) * 0.1).collect(), vec![0; 400], points);
        CentredTriplets::new(&triplets, &PrismNetwork::of_own_prisms(distances))
    }

    fn simulated(preset: Preset, seed: u64) -> CentredTriplets {
        let deployment = simulated_drives::simulated(preset, seed);
        let triplets = crate::pipeline::run(&deployment, &PipelineSettings::default()).triplets;
        let rig = deployment.rig.expect("simulated");
        CentredTriplets::new(&triplets, &PrismNetwork::of_own_prisms(rig.inter_prism_m))
    }

    #[test]
    fn stations_of_one_prism_flip_together() {
        let network = |prisms: &[usize]| {
            let prisms = prisms.iter().map(|prism| Prism::at(*prism)).collect();
            PrismNetwork::new(prisms, &PerPair::repeat(6, 1.0))
        };
        let bits = |prisms: &[usize]| -> Vec<Vec<bool>> {
            height_flips(&network(prisms)).iter().map(|flips| flips.as_slice().to_vec()).collect()
        };
        assert_eq!(
            bits(&[0, 1, 2]),
            [[false, true, true], [false, true, false], [false, false, true]]
        );
        assert_eq!(bits(&[1, 0, 1, 0]), [[false, true, false, true]]);
        assert!(bits(&[0, 0]).is_empty());
    }

    /// Rotating the rig by −90° and shifting the stations to match fits two legs at a right angle as well. The reason is that
    /// i + e^{iφ} − 1 has size 1 for φ = 0 and for φ = −π/2.
    #[test]
    fn two_legs_have_a_rival_that_is_found_from_any_prior() {
        let data = two_legs(std::f64::consts::FRAC_PI_2);
        let truth = data.parameters(&[LevelTransform::IDENTITY; 3].into());
        let thinned = data.thinned(THINNED);
        let squared = SquaredCost::of(&thinned);
        let poor = Parameters::from_column_slice(&[0.5, 0.3, 0.2, 0.1, -0.4, 0.6, 0.1, -0.1]);
        for prior in [truth.clone(), data.mirrored_in_plane(&truth, 1.0), poor] {
            let found = find(&data, &thinned, &squared, &[prior]);
            let (rival, cost_ratio) = found.others.first().expect("two legs").clone();
            assert!(cost_ratio < 2.0, "{cost_ratio}");
            let twin = found.twin.expect("level ground").parameters;
            let near = |p: &Parameters| {
                let flipped = data.mirrored_in_height(p);
                (p - &truth).amax().min((flipped - &truth).amax()) < 0.02
            };
            let candidates = [found.lowest.parameters, twin, rival];
            assert!(candidates.iter().any(near), "{candidates:?}");
        }
    }

    #[test]
    fn a_poor_prior_leads_to_the_same_minima() {
        for preset in [Preset::Warthog, Preset::Hd2Tunnel, Preset::FigureEight, Preset::LShape] {
            let data = simulated(preset, 4);
            let thinned = data.thinned(THINNED);
            let squared = SquaredCost::of(&thinned);
            let good = find(&data, &thinned, &squared, &closed_form_priors(&squared));
            for yaws in [[0.0, 0.0], [2.0, -2.0], [-1.5, 3.0]] {
                let poor = [3.0, -2.0, 1.0, yaws[0], -1.0, 4.0, -2.0, yaws[1]];
                let prior = Parameters::from_column_slice(&poor);
                let found = find(&data, &thinned, &squared, &[prior]);
                assert!((&found.lowest.parameters - &good.lowest.parameters).amax() < 1e-6);
                assert_eq!(found.others.len(), good.others.len(), "{preset:?}");
                for (a, b) in found.others.iter().zip(&good.others) {
                    assert!((&a.0 - &b.0).amax() < 1e-3, "{preset:?}: {a:?} {b:?}");
                }
            }
        }
    }

    /// Random starts on the exact cost find no minimum with less than ten times the lowest cost that is not listed.
    #[test]
    fn brute_force_finds_nothing_that_is_not_listed() {
        for preset in [Preset::Warthog, Preset::Hd2Tunnel, Preset::FigureEight, Preset::LShape] {
            let data = simulated(preset, 5).thinned(100);
            let squared = SquaredCost::of(&data);
            let minima = find(&data, &data, &squared, &closed_form_priors(&squared));
            let listed = minima.basins(&data);
            let mut random = ChaCha8Rng::seed_from_u64(9);
            let mut ended = 0;
            for _ in 0..2000 {
                let start = Parameters::from_fn(data.network.unknowns(), |k, _| {
                    let within = if k % 4 == 3 { std::f64::consts::PI } else { 2.0 };
                    random.random_range(-within..within)
                });
                let found = minimise(&data, start, 1e-4);
                if !found.converged || found.normal.cost > 10.0 * minima.lowest.normal.cost {
                    continue;
                }
                ended += 1;
                let found = data.transforms(&found.parameters);
                let known = listed.iter().any(|b| same_solution(&b.station1_from_station, &found));
                assert!(known, "{preset:?}: {found:?}");
            }
            assert!(ended > 200, "{preset:?}: only {ended} of 2000 starts ended anywhere");
        }
    }
}
