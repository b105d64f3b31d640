//! Kinds of systematic errors of a simulated drive.

use rand_chacha::ChaCha8Rng;

use super::random::Stream;

/// A kind of errors of instruments and rig, which are drawn or omitted together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorKind {
    /// Rotation, displacement and tilt of tripods during the drive.
    Settling,
    /// Additive range errors of each station and of each prism.
    RangeOffset,
    /// Scale errors of ranges.
    RangeScale,
    /// Range errors correlated over seconds to minutes.
    RangeWander,
    /// Latency of angles relative to ranges.
    Latency,
    /// Independent errors of stamps.
    StampJitter,
    /// Offsets and drifts of clocks.
    ClockOffset,
    /// Steps of clocks, and pauses of the recording.
    ClockJumps,
    /// Vertical index errors.
    Index,
    /// Collimation errors.
    Collimation,
    /// Tilts of vertical axes.
    Tilt,
    /// Curvature of the earth and refraction of light.
    Curvature,
    /// Errors of the written distances between prisms.
    Distances,
    /// Error of the prism constant, the same for all ranges.
    PrismConstant,
    /// Errors of readings that repeat with the incidence on a prism.
    Facets,
    /// Positions of targets beside their markers.
    Centring,
    /// Changes of set-ups between the survey of the control points and the drive.
    SetUpChange,
}

impl ErrorKind {
    pub const ALL: [Self; 17] = [
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
        Self::Facets,
        Self::Centring,
        Self::SetUpChange,
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
            Self::Facets => "facets of prisms",
            Self::Centring => "centring of targets",
            Self::SetUpChange => "set-up change",
        }
    }

    /// Returns the random number generator of this kind. Omitting one kind does not change the others.
    pub fn rng(self, seed: u64) -> ChaCha8Rng {
        Stream::ErrorKind(self as usize).rng(seed)
    }
}
