//! Clock offsets of the stations relative to station 1 from tracks of one prism.
//!
//! A late stamp shifts a track along itself. No rotation or translation of the whole track does so where the drive turns.

use nalgebra::{DMatrix, DVector, Vector3};

use super::time_blocks;
use crate::calibration::{Clock, Estimate, with_clocks};
use crate::geometry::RigidTransform;
use crate::network::PerStation;
use crate::pipeline::Triplets;
use crate::statistics::sandwich;
use crate::statistics::sandwich::Block;

/// Unknowns of each station but the first: (x, y, z, yaw), clock offset (s), clock drift (s per s).
const PER_STATION: usize = 6;
/// Time shift from which the velocity of a prism is computed (s).
const STEP_S: f64 = 1e-3;

/// Clocks estimated by one step of least squares from a level alignment.
#[derive(Clone, Debug)]
pub struct TrackClocks {
    /// Zeros for station 1, the reference.
    pub offsets_s: PerStation<Estimate>,
    pub drifts: PerStation<Estimate>,
    /// Changes of (x, y, z, yaw) of stations 2, 3, … by the estimated clocks (m, rad).
    pub moves: DVector<f64>,
    /// Covariance of (x, y, z, yaw) of stations 2, 3, … with the clocks estimated: the sandwich by blocks of time (m, rad).
    pub covariance: DMatrix<f64>,
}

impl TrackClocks {
    pub fn clocks(&self) -> PerStation<Clock> {
        self.offsets_s.zip(&self.drifts, |offset_s, drift| Clock {
            offset_s: offset_s.value,
            drift: drift.value,
        })
    }
}

/// Estimates clocks and changes of the transforms; `None` if the drive does not separate clocks from transforms.
pub fn estimate(
    triplets: &Triplets,
    station1_from_station: &PerStation<RigidTransform>,
) -> Option<TrackClocks> {
    let late = Clock { offset_s: STEP_S, drift: 0.0 };
    let moved = with_clocks(triplets, &PerStation::repeat(station1_from_station.len(), late));
    let slots = station1_from_station.len() - 1;
    let unknowns = PER_STATION * slots;
    let middle_s = 0.5 * (triplets.time_s.first()? + triplets.time_s.last()?);
    let equations = |index: usize, slot: usize| {
        let (station, transform) = (slot + 1, &station1_from_station[slot + 1]);
        let point = &triplets.points_m[station][index];
        let turned = transform.rotate(point);
        let velocity = transform.rotate(&(moved.points_m[station][index] - point)) / STEP_S;
        let since_s = triplets.time_s[index] - middle_s;
        let columns = [
            Vector3::x(),
            Vector3::y(),
            Vector3::z(),
            Vector3::z().cross(&turned),
            velocity,
            velocity * since_s,
        ];
        let error = triplets.points_m[0][index] - turned - transform.translation_m;
        (columns, error)
    };
    let blocks = time_blocks::of(&triplets.time_s, &triplets.interval);
    let mut blocks: Vec<Block> = blocks
        .into_iter()
        .map(|block| {
            let mut information = DMatrix::zeros(unknowns, unknowns);
            let mut gradient = DVector::zeros(unknowns);
            for index in block {
                for slot in 0..slots {
                    let (columns, error) = equations(index, slot);
                    let at = PER_STATION * slot;
                    for (i, a) in columns.iter().enumerate() {
                        gradient[at + i] += a.dot(&error);
                        for (j, b) in columns.iter().enumerate() {
                            information[(at + i, at + j)] += a.dot(b);
                        }
                    }
                }
            }
            Block { information, gradient }
        })
        .collect();
    let normal: DMatrix<f64> = blocks.iter().map(|block| &block.information).sum();
    let right: DVector<f64> = blocks.iter().map(|block| &block.gradient).sum();
    let step = normal.cholesky()?.solve(&right);
    // The gradients after the step.
    for block in &mut blocks {
        block.gradient -= &block.information * &step;
    }
    let covariance = sandwich::covariance(&blocks, None)?;
    if step.iter().any(|entry| !entry.is_finite()) {
        return None;
    }
    let estimate = |place: usize| Estimate {
        value: step[place],
        sigma: covariance[(place, place)].max(0.0).sqrt(),
    };
    let by_station = |unknown: usize| {
        let others = (0..slots).map(|slot| estimate(PER_STATION * slot + unknown));
        std::iter::once(Estimate::ZERO).chain(others).collect()
    };
    let place = |k: usize| PER_STATION * (k / 4) + k % 4;
    Some(TrackClocks {
        offsets_s: by_station(4),
        drifts: by_station(5),
        moves: DVector::from_fn(4 * slots, |k, _| step[place(k)]),
        covariance: DMatrix::from_fn(4 * slots, 4 * slots, |i, j| covariance[(place(i), place(j))]),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, Normal};

    /// Simulates readings of one winding track by three stations without clock offsets, in this number of blocks of time.
    fn triplets(blocks: usize, rng: &mut ChaCha8Rng) -> Triplets {
        let noise = Normal::new(0.0, 0.002).expect("a σ");
        let time_s: Vec<f64> = (0..10 * blocks).map(|k| 0.5 * k as f64).collect();
        let points_m = [0, 1, 2].map(|_| -> Vec<Vector3<f64>> {
            let at = |t: &f64| {
                let (x, y) = (20.0 * (0.13 * t).sin(), 15.0 * (0.29 * t + 1.0).cos());
                Vector3::new(x, y, 0.3 * (0.2 * t).sin()).map(|axis| axis + noise.sample(rng))
            };
            time_s.iter().map(at).collect()
        });
        let interval = vec![0; time_s.len()];
        Triplets::new(time_s, interval, points_m)
    }

    #[test]
    fn stated_variances_are_the_true_ones_from_8_to_60_blocks() {
        const DRAWS: usize = 300;
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        for blocks in [8, 12, 16, 20, 40, 60] {
            let (mut stated, mut truth) = ([0.0; 12], [0.0; 12]);
            for _ in 0..DRAWS {
                let triplets = triplets(blocks, &mut rng);
                let found = estimate(&triplets, &PerStation::repeat(3, RigidTransform::IDENTITY))
                    .expect("held");
                let clocks =
                    found.offsets_s.into_iter().skip(1).chain(found.drifts.into_iter().skip(1));
                let moves = (0..8).map(|k| Estimate {
                    value: found.moves[k],
                    sigma: found.covariance[(k, k)].sqrt(),
                });
                for (k, estimate) in moves.chain(clocks).enumerate() {
                    stated[k] += estimate.sigma.powi(2);
                    truth[k] += estimate.value.powi(2);
                }
            }
            // The mean over the twelve unknowns has a σ of 3 %.
            let ratio = stated.iter().zip(truth).map(|(s, t)| s / t).sum::<f64>() / 12.0;
            assert!((0.93..1.1).contains(&ratio), "{blocks} blocks: {ratio:.3}");
        }
    }
}
