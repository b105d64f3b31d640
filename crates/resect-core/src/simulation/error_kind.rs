//! Kinds of errors that a simulated drive can have.

use rand_chacha::ChaCha8Rng;

use super::random::Stream;

/// A kind of errors that instruments and rig make: what is drawn together, or left out together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorKind {
    /// Tripods turn, move and lean during the drive.
    Settling,
    /// Ranges are off by a constant of each station, and one of each prism.
    RangeOffset,
    /// Ranges are off by a share of themselves.
    RangeScale,
    /// Ranges are off by what changes within seconds to minutes.
    RangeWander,
    /// The angles of a reading are of an earlier moment than its range.
    Latency,
    /// Every stamp is off on its own.
    StampJitter,
    /// Clocks are off by a constant, and drift.
    ClockOffset,
    /// Clocks jump, and the recording pauses.
    ClockJumps,
    /// Zenith angles are off by a constant.
    Index,
    /// Lines of sight are not square to their horizontal axes.
    Collimation,
    /// Vertical axes are not upright.
    Tilt,
    /// The earth is round, and light bends.
    Curvature,
    /// The distances between prisms that are written are wrong.
    Distances,
    /// All ranges are off by the same constant.
    PrismConstant,
}

impl ErrorKind {
    pub const ALL: [Self; 14] = [
        Self::Settling,
        Self::RangeOffset,
        Self::RangeScale,
        Self::RangeWander,
        Self::Latency,
        Self::StampJitter,
        Self::ClockOffset,
        Self::ClockJumps,
        Self::Index,
        Self::Collimation,
        Self::Tilt,
        Self::Curvature,
        Self::Distances,
        Self::PrismConstant,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Self::Settling => "settling",
            Self::RangeOffset => "range offset",
            Self::RangeScale => "range scale",
            Self::RangeWander => "range wander",
            Self::Latency => "latency",
            Self::StampJitter => "stamp jitter",
            Self::ClockOffset => "clock offset and drift",
            Self::ClockJumps => "clock jumps and pauses",
            Self::Index => "vertical index",
            Self::Collimation => "collimation",
            Self::Tilt => "tilt",
            Self::Curvature => "curvature and refraction",
            Self::Distances => "inter-prism distances",
            Self::PrismConstant => "prism constant",
        }
    }

    /// The random numbers of this kind alone, so that leaving it out leaves the others as they are.
    pub fn rng(self, seed: u64) -> ChaCha8Rng {
        Stream::ErrorKind(self as usize).rng(seed)
    }
}
