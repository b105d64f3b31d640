//! Random numbers: Gaussian ones, and streams that do not disturb each other.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

pub fn normal(rng: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(rng)
}

/// What draws from a stream of its own, so that an option never changes what others draw. The main one is 0.
#[derive(Clone, Copy)]
pub enum Stream {
    /// The wandering ranges of a station (0 to 2).
    RangeWander(usize),
    /// The jittering stamps of a station (0 to 2).
    StampJitter(usize),
}

impl Stream {
    pub fn rng(self, seed: u64) -> ChaCha8Rng {
        let number = match self {
            Self::RangeWander(station) => 100 + station,
            Self::StampJitter(station) => 200 + station,
        };
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(number as u64);
        rng
    }
}
