//! Normal random numbers, and independent random streams.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

pub fn normal(rng: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(rng)
}

/// An independent random stream, so that an option never changes other random numbers; the main stream is 0.
#[derive(Clone, Copy)]
pub enum Stream {
    /// Time-correlated range errors of a station (0 to 2).
    RangeWander(usize),
    /// Stamp errors of a station (0 to 2).
    StampJitter(usize),
    /// Sizes of the errors of one kind, by its index among the kinds.
    ErrorKind(usize),
    /// Positions of the targets of one set of control points.
    Centring(usize),
}

impl Stream {
    pub fn rng(self, seed: u64) -> ChaCha8Rng {
        let number = match self {
            Self::RangeWander(station) => 100 + station,
            Self::StampJitter(station) => 200 + station,
            Self::ErrorKind(kind) => 300 + kind,
            Self::Centring(set) => 400 + set,
        };
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(number as u64);
        rng
    }
}
