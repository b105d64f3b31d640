//! Search for all minima of the squared cost, from random starts.
//!
//! **Region of the minima.** If two poses of a pair both fit, their differences e and e′ of a triplet have the length d, and e − e′
//! = (R′ − R) q + t′ − t with q about its centroid. The mean of ‖e − e′‖² is at most 4d², and at least (2 sin(δ/2) · radius)² for
//! yaws that differ by δ. So all good yaws are within 2 asin(d / radius) of each other: a few degrees. The translation t is the
//! mean of e, thus within d of zero. It is the rig's triangle seen from prism 1, in any rotation, with the horizontal components
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
use super::valley::one_valley;
use super::{Minimum, Parameters, SquaredCost};

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
            Some(prior) => *prior,
            None => starts.draw(&basins[0].floor.parameters),
        };
        let found = descend(|p| cost.at(p), cost.radius_m, start, TOLERANCE_M, MOST_PASSES);
        if is_new(cost, &mut basins, found, &same) {
            quiet = 0;
        } else if count >= priors.len() {
            quiet += 1;
        }
        basins.sort_by(|a, b| a.floor.normal.cost.total_cmp(&b.floor.normal.cost));
        if quiet == QUIET || basins.len() == MOST_BASINS {
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
    let lower = |basin: &mut Valley| {
        if found.normal.cost < basin.floor.normal.cost {
            basin.floor = found;
        }
    };
    if let Some(basin) = basins.iter_mut().find(seen) {
        lower(basin);
        return false;
    }
    // Not converged, and not below the lowest.
    let least = basins.first().map_or(f64::INFINITY, |lowest| lowest.floor.normal.cost);
    if !found.converged && found.normal.cost >= least {
        return false;
    }
    if let Some(basin) = basins.iter_mut().find(|basin| one_valley(cost, &basin.floor, &found)) {
        lower(basin);
        basin.seen.push(found.parameters);
        return false;
    }
    basins.push(Valley { floor: found, seen: vec![found.parameters] });
    true
}

/// Generator of starts in the region of the minima.
struct Starts {
    random: ChaCha8Rng,
    /// Prisms 2 and 3 relative to prism 1 (m).
    prisms_m: [Vector3<f64>; 2],
    /// Largest difference of good yaws (rad).
    yaw_rad: [f64; 2],
}

impl Starts {
    fn new(cost: &SquaredCost) -> Self {
        let [d12, d13, d23] = cost.inter_prism_m;
        let cos = ((d12 * d12 + d13 * d13 - d23 * d23) / (2.0 * d12 * d13)).clamp(-1.0, 1.0);
        let prism_3 = d13 * Vector3::new(cos, (1.0 - cos * cos).sqrt(), 0.0);
        Self {
            random: ChaCha8Rng::seed_from_u64(SEED),
            prisms_m: [d12 * Vector3::x(), prism_3],
            yaw_rad: [d12, d13].map(|d| 2.0 * (d / cost.radius_m).min(1.0).asin()),
        }
    }

    /// Draws a random start with yaws near those of a solution that fits.
    fn draw(&mut self, fits: &Parameters) -> Parameters {
        let [w, i, j, k] = std::array::from_fn(|_| self.random.sample(StandardNormal));
        let turn = UnitQuaternion::new_normalize(Quaternion::new(w, i, j, k));
        let shrink = self.random.random_range(0.0..1.0);
        let mut start = Parameters::zeros();
        for slot in 0..2 {
            let t = turn * self.prisms_m[slot];
            start[4 * slot] = shrink * t.x;
            start[4 * slot + 1] = shrink * t.y;
            start[4 * slot + 2] = t.z;
            let off = self.random.random_range(-1.0..1.0) * self.yaw_rad[slot];
            start[4 * slot + 3] = (fits[4 * slot + 3] + off + PI).rem_euclid(TAU) - PI;
        }
        start
    }
}
