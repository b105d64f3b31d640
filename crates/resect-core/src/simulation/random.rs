//! Random numbers: Gaussian ones, and streams that do not disturb each other.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

pub fn normal(rng: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(rng)
}

/// What draws from a stream of its own, so that an option never changes what others draw; the main stream is 0.
#[derive(Clone, Copy)]
pub enum Stream {
    /// The wandering ranges of a station (0 to 2).
    RangeWander(usize),
    /// The jittering stamps of a station (0 to 2).
    StampJitter(usize),
    /// The sizes of the errors of one kind, by its place among the kinds.
    ErrorKind(usize),
}

impl Stream {
    pub fn rng(self, seed: u64) -> ChaCha8Rng {
        let number = match self {
            Self::RangeWander(station) => 100 + station,
            Self::StampJitter(station) => 200 + station,
            Self::ErrorKind(kind) => 300 + kind,
        };
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(number as u64);
        rng
    }
}
