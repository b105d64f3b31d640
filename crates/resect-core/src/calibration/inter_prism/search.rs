//! Search for all minima of the squared cost, from random starts.
//!
//! **Region of the minima.** If two poses of a pair both fit, their differences e and e′ of a triplet have the length d, and e − e′
//! = (R′ − R) q + t′ − t with q about its centroid. The mean of ‖e − e′‖² is at most 4d², and at least (2 sin(δ/2) · radius)² for
//! yaws that differ by δ. So all good yaws are within 2 asin(d / radius) of each other: a few degrees. The translation t is the
//! mean of e, thus within d of zero. It is the rig seen from station 1's prism, in any rotation, with the horizontal components
//! reduced by the rotation of the vehicle. Starts are drawn from this small region, which includes mirrored heights and rotated or
//! mirrored rigs.
//!
//! **Stopping.** After [`QUIET`] starts in a row without a new minimum, the basins of all unknown minima together fill less than a
//! tenth of the region, with 95 % confidence (0.9³⁰ < 0.05). On simulated and field data the basin of every minimum below a
//! thousand times the lowest cost fills a fifth or more. Then 30 starts miss it with a probability of at most one in 800.

use std::f64::consts::{PI, TAU};

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

use super::levenberg_marquardt::descend;
use super::prism_network::UNKNOWNS_PER_STATION;
use super::valley::one_valley;
use super::{Minimum, NormalEquations, Parameters, PrismNetwork, SquaredCost};
use crate::network::Station;

/// Number of starts in a row without a new minimum that ends the search.
const QUIET: usize = 30;
/// Most starts: drives with unobservable directions have minima everywhere.
const MOST_STARTS: usize = 600;
/// Most minima that are listed; more would not be informative.
const MOST_BASINS: usize = 16;
/// Tolerance of a descent (m): enough to distinguish minima.
const TOLERANCE_M: f64 = 1e-3;
/// Most passes of a descent; a longer one creeps along a valley.
const MOST_PASSES: usize = 40;
/// Seed of the random starts, fixed for reproducible answers.
const SEED: u64 = 1;

/// Returns all minima of the squared cost, the lowest first; one for each valley.
pub fn search(
    cost: &SquaredCost,
    priors: &[Parameters],
    same: impl Fn(&Parameters, &Parameters) -> bool,
) -> Vec<Minimum> {
    let mut basins: Vec<Valley> = Vec::new();
    let mut starts = Starts::new(cost);
    let mut quiet = 0;
    for count in 0..MOST_STARTS {
        let start = match priors.get(count) {
            Some(prior) => prior.clone(),
            None => starts.draw(&basins[0].floor.parameters),
        };
        let evaluate = |p: &Parameters, normal: &mut NormalEquations| cost.evaluate(p, normal);
        let found = descend(evaluate, cost.radius_m, start, TOLERANCE_M, MOST_PASSES);
        if is_new(cost, &mut basins, found, &same) {
            quiet = 0;
        } else if count >= priors.len() {
            quiet += 1;
        }
        basins.sort_by(|a, b| a.floor.normal.cost.total_cmp(&b.floor.normal.cost));
        // A prior that is not tested could lead to the lowest minimum.
        if quiet == QUIET || (basins.len() >= MOST_BASINS && count + 1 >= priors.len()) {
            break;
        }
    }
    basins.into_iter().map(|basin| basin.floor).collect()
}

/// A basin: usually one point, a valley if a direction is unobservable.
struct Valley {
    floor: Minimum,
    /// End points of descents in the valley, so that none is tested for it twice.
    seen: Vec<Parameters>,
}

/// Adds a minimum, and returns true if its valley is new. Otherwise the lower of the two minima is kept.
fn is_new(
    cost: &SquaredCost,
    basins: &mut Vec<Valley>,
    found: Minimum,
    same: impl Fn(&Parameters, &Parameters) -> bool,
) -> bool {
    let seen = |basin: &&mut Valley| basin.seen.iter().any(|p| same(p, &found.parameters));
    let lower = |basin: &mut Valley, found: Minimum| {
        if found.normal.cost < basin.floor.normal.cost {
            basin.floor = found;
        }
    };
    if let Some(basin) = basins.iter_mut().find(seen) {
        lower(basin, found);
        return false;
    }
    // Not converged, and not below the lowest.
    let least = basins.first().map_or(f64::INFINITY, |lowest| lowest.floor.normal.cost);
    if !found.converged && found.normal.cost >= least {
        return false;
    }
    if let Some(basin) = basins.iter_mut().find(|basin| one_valley(cost, &basin.floor, &found)) {
        basin.seen.push(found.parameters.clone());
        lower(basin, found);
        return false;
    }
    basins.push(Valley { seen: vec![found.parameters.clone()], floor: found });
    true
}

/// Generator of starts in the region of the minima.
struct Starts {
    random: ChaCha8Rng,
    /// Prism of each station but the first relative to station 1's prism (m).
    prisms_m: Vec<Vector3<f64>>,
    /// True if the prisms are not in one plane. Then the distances do not exclude the mirrored rig.
    is_spatial: bool,
    /// Largest difference of good yaws of each of these stations (rad).
    yaw_rad: Vec<f64>,
}

impl Starts {
    fn new(cost: &SquaredCost) -> Self {
        let prisms_m = placed_prisms_m(&cost.network);
        let yaw_rad = |station: Station| {
            2.0 * (cost.network.from_station1_m(station) / cost.radius_m).min(1.0).asin()
        };
        Self {
            random: ChaCha8Rng::seed_from_u64(SEED),
            is_spatial: prisms_m.iter().any(|prism_m| prism_m.z > 0.0),
            prisms_m,
            yaw_rad: cost.network.unknown_stations().map(yaw_rad).collect(),
        }
    }

    /// Draws a random start with yaws near those of a solution that fits.
    fn draw(&mut self, fits: &Parameters) -> Parameters {
        let [w, i, j, k] = std::array::from_fn(|_| self.random.sample(StandardNormal));
        let turn = UnitQuaternion::new_normalize(Quaternion::new(w, i, j, k));
        let shrink = self.random.random_range(0.0..1.0);
        let is_mirrored = self.is_spatial && self.random.random_bool(0.5);
        let mut start = Parameters::zeros(fits.len());
        for (slot, prism_m) in self.prisms_m.iter().enumerate() {
            let first = UNKNOWNS_PER_STATION * slot;
            let t = turn * prism_m;
            let t = if is_mirrored { -t } else { t };
            start[first] = shrink * t.x;
            start[first + 1] = shrink * t.y;
            start[first + 2] = t.z;
            let off = self.random.random_range(-1.0..1.0) * self.yaw_rad[slot];
            start[first + 3] = (fits[first + 3] + off + PI).rem_euclid(TAU) - PI;
        }
        start
    }
}

/// Smallest share of its squared distance that a prism has outside of the space of those before it.
const LEAST_NEW_SHARE: f64 = 1e-4;

/// Returns positions with the network's distances: of the prism of each station but the first, relative to station 1's prism (m).
///
/// The scalar products of these positions follow from the distances; their Cholesky factor has the positions as rows. The first one
/// is on the x axis, and the next one that is not on it is in the xy plane. A pair without a distance is at a right angle.
fn placed_prisms_m(network: &PrismNetwork) -> Vec<Vector3<f64>> {
    let mut prisms_m: Vec<Vector3<f64>> = Vec::with_capacity(network.stations());
    // The stations whose prisms span the axes so far.
    let mut axes: Vec<Station> = Vec::with_capacity(3);
    for station in network.unknown_stations() {
        let squared_m2 = network.from_station1_m(station).powi(2);
        let mut prism_m = Vector3::zeros();
        for (axis, spanning) in axes.iter().enumerate() {
            let product_m2 = network.index_of(*spanning, station).map_or(0.0, |pair| {
                let spanning_m2 = network.from_station1_m(*spanning).powi(2);
                0.5 * (spanning_m2 + squared_m2 - network.pairs[pair].distance_m.powi(2))
            });
            let other_m = prisms_m[spanning.slot().expect("not station 1")];
            prism_m[axis] = (product_m2 - prism_m.dot(&other_m)) / other_m[axis];
        }
        let rest_m2 = squared_m2 - prism_m.norm_squared();
        if rest_m2 > LEAST_NEW_SHARE * squared_m2 && axes.len() < 3 {
            prism_m[axes.len()] = rest_m2.sqrt();
            axes.push(station);
        }
        prisms_m.push(prism_m);
    }
    prisms_m
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::{Number, Pair, PerPair, PerStation, Prism};

    #[test]
    fn placed_prisms_have_the_distances_of_the_rig() {
        let rig_m = [
            Vector3::new(0.1, 0.2, 0.4),
            Vector3::new(0.6, 0.3, 0.0),
            Vector3::new(-0.1, 0.8, 0.1),
            Vector3::new(-0.6, -0.2, 0.7),
            Vector3::new(0.3, -0.5, -0.3),
        ];
        for stations in 2..=5 {
            let prisms = PerStation::from_fn(stations, |s: Station| Prism::at(s.index()));
            let distance_m =
                |pair: Pair| (rig_m[pair.first.index()] - rig_m[pair.second.index()]).norm();
            let network =
                PrismNetwork::new(prisms, &PerPair::from_fn(Pair::count(stations), distance_m));
            let placed_m = [vec![Vector3::zeros()], placed_prisms_m(&network)].concat();
            let worst_m = network.errors_m(&placed_m).fold(0.0, |w: f64, e| w.max(e.abs()));
            assert!(worst_m < 1e-12, "{stations}: {worst_m}");
        }
    }
}
