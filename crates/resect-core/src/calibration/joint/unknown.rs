//! The table of unknowns: one row for each kind of constant θ of the joint estimate.
//!
//! Indices in the state vector ([`super::state_vector`]), priors, the budget of σ, tests of priors, findings, tables and files follow from the
//! rows.

use nalgebra::Vector3;

use super::sight::{EARTH_RADIUS_M, Sight};
use crate::calibration::{ErrorSizes, Quantity};

/// A kind of unknown.
#[derive(Debug)]
pub struct Unknown {
    /// Name in tables.
    pub name: &'static str,
    /// Symbol in tables and files: that of the page [`super`].
    pub symbol: &'static str,
    pub quantity: Quantity,
    /// Name of the list of its estimates in files; unknowns with the same name stand together. `None` for those that other lists contain.
    pub key: Option<&'static str>,
    pub owner: Owner,
    /// Name of the source in the budget of σ.
    pub source: &'static str,
    /// `None` for transforms, which have no prior.
    pub prior: Option<PriorSize>,
    pub effect: Effect,
    /// Beginning of a sentence, with a place for the owner: "station {}'s ranges are off by".
    pub sentence: &'static str,
}

/// Owner of an unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Owner {
    /// Each station but the first: its frame in that of station 1.
    SetUp,
    /// Each station but the first: its clock against that of station 1.
    Clock,
    Station,
    /// Each pair of prisms.
    Pair,
}

/// Size of an error before a drive.
#[derive(Clone, Copy, Debug)]
pub struct PriorSize {
    /// Standard deviation of the prior.
    pub sigma: fn(&ErrorSizes) -> f64,
    /// Least standard deviation: a size of zero constrains an unknown almost exactly.
    pub least: f64,
}

/// Effect of an unknown on a sight.
#[derive(Clone, Copy, Debug)]
pub enum Effect {
    /// Displaces the station along an axis of station 1's frame.
    Place(usize),
    /// Rotates it about the vertical.
    Yaw,
    /// Rotates it about its own x (0) or y (1).
    Lean(usize),
    /// Makes its stamps late.
    ClockOffset,
    /// Makes them later per second.
    ClockDrift,
    /// Makes its angles older than its ranges.
    Latency,
    /// Displaces its readings.
    Reading(ReadingError),
    /// Extends the distance between two prisms.
    Distance,
}

/// An error that displaces the readings of a station.
#[derive(Clone, Copy, Debug)]
pub struct ReadingError {
    /// Correction of a point for an error of one (m, the station's own axes).
    pub correction_m: fn(&Sight) -> Vector3<f64>,
    /// True if a survey has an error of its own: a station points at another target than in the drive, and in another way.
    pub is_of_pointing: bool,
}

impl Unknown {
    /// Returns the beginning of a sentence about the unknown of an owner: "station 2's ranges are off by".
    pub fn sentence_of(&self, owner: &str) -> String {
        self.sentence.replace("{}", owner)
    }

    /// Returns the precision (1/σ²) of its prior; zero without one.
    pub fn precision(&self, sizes: &ErrorSizes) -> f64 {
        self.prior.map_or(0.0, |prior| (prior.sigma)(sizes).max(prior.least).powi(-2))
    }

    /// Returns true for an error of an instrument.
    pub fn is_of_instrument(&self) -> bool {
        self.owner == Owner::Station
    }
}

/// All unknowns, in the order of tables. Unknowns with the same source stand together.
pub static UNKNOWNS: [&Unknown; 16] = [
    &pose("x", "x", Quantity::Length, Effect::Place(0)),
    &pose("y", "y", Quantity::Length, Effect::Place(1)),
    &pose("z", "z", Quantity::Length, Effect::Place(2)),
    &pose("yaw", "ψ", Quantity::Angle, Effect::Yaw),
    &CLOCK_OFFSET,
    &CLOCK_DRIFT,
    &RANGE_OFFSET,
    &RANGE_SCALE,
    &VERTICAL_INDEX,
    &COLLIMATION,
    &REFRACTION_UPWARD,
    &REFRACTION_SIDEWAYS,
    &LATENCY,
    &LEAN_X,
    &LEAN_Y,
    &DISTANCE,
];

const fn pose(
    name: &'static str,
    symbol: &'static str,
    quantity: Quantity,
    effect: Effect,
) -> Unknown {
    let (source, sentence) = ("transforms", "station {}'s position is off by");
    let (owner, prior, key) = (Owner::SetUp, None, None);
    Unknown { name, symbol, quantity, key, owner, source, prior, effect, sentence }
}

pub static CLOCK_OFFSET: Unknown = Unknown {
    name: "clock offset",
    symbol: "Δt",
    quantity: Quantity::Time,
    key: None,
    owner: Owner::Clock,
    source: "clocks",
    prior: Some(PriorSize { sigma: |sizes| sizes.clock_offset_s, least: 1e-7 }),
    effect: Effect::ClockOffset,
    sentence: "station {}'s stamps are late by",
};

pub static CLOCK_DRIFT: Unknown = Unknown {
    name: "clock drift",
    symbol: "Δf",
    quantity: Quantity::Drift,
    key: Some("clock_drifts"),
    owner: Owner::Clock,
    source: "clocks",
    prior: Some(PriorSize { sigma: |sizes| sizes.clock_drift, least: 1e-9 }),
    effect: Effect::ClockDrift,
    sentence: "station {}'s clock drifts by",
};

pub static RANGE_OFFSET: Unknown = Unknown {
    name: "range offset",
    symbol: "a",
    quantity: Quantity::Length,
    key: Some("range_offsets_m"),
    owner: Owner::Station,
    source: "range offsets",
    prior: Some(PriorSize { sigma: |sizes| sizes.range_offset_m, least: 1e-6 }),
    effect: Effect::Reading(ReadingError {
        correction_m: |sight| -sight.along,
        is_of_pointing: true,
    }),
    sentence: "station {}'s ranges are off by",
};

pub static RANGE_SCALE: Unknown = Unknown {
    name: "range scale",
    symbol: "k",
    quantity: Quantity::Share,
    key: Some("range_scales"),
    owner: Owner::Station,
    source: "range scales",
    prior: Some(PriorSize { sigma: |sizes| sizes.range_scale, least: 1e-8 }),
    effect: Effect::Reading(ReadingError {
        correction_m: |sight| -sight.along * sight.range_m,
        is_of_pointing: false,
    }),
    sentence: "station {}'s ranges are off by",
};

pub static VERTICAL_INDEX: Unknown = Unknown {
    name: "vertical index",
    symbol: "ι",
    quantity: Quantity::Angle,
    key: Some("indices_rad"),
    owner: Owner::Station,
    source: "vertical indices",
    prior: Some(PriorSize { sigma: |sizes| sizes.index_rad, least: 1e-9 }),
    effect: Effect::Reading(ReadingError {
        correction_m: |sight| sight.up * sight.range_m,
        is_of_pointing: true,
    }),
    sentence: "station {}'s vertical index error is",
};

pub static COLLIMATION: Unknown = Unknown {
    name: "collimation",
    symbol: "κ",
    quantity: Quantity::Angle,
    key: Some("collimations_rad"),
    owner: Owner::Station,
    source: "collimations",
    prior: Some(PriorSize { sigma: |sizes| sizes.collimation_rad, least: 1e-9 }),
    effect: Effect::Reading(ReadingError {
        correction_m: |sight| -sight.side * sight.range_m,
        is_of_pointing: true,
    }),
    sentence: "station {}'s collimation error is",
};

pub static REFRACTION_UPWARD: Unknown = refraction(
    ("refraction upward", "β"),
    // The line of sight is bent as the earth is curved.
    |sight| -sight.up * (0.5 * sight.range_m.powi(2) / EARTH_RADIUS_M),
    |sizes| sizes.refraction,
    "station {}'s refraction upward differs by",
);
pub static REFRACTION_SIDEWAYS: Unknown = refraction(
    ("refraction sideways", "ζ"),
    |sight| -sight.side * (0.5 * sight.range_m.powi(2) / EARTH_RADIUS_M),
    // Temperature changes less sideways than upward from the ground.
    |sizes| 0.25 * sizes.refraction,
    "station {}'s refraction sideways is",
);

const fn refraction(
    (name, symbol): (&'static str, &'static str),
    correction_m: fn(&Sight) -> Vector3<f64>,
    sigma: fn(&ErrorSizes) -> f64,
    sentence: &'static str,
) -> Unknown {
    Unknown {
        name,
        symbol,
        quantity: Quantity::Coefficient,
        key: Some("refractions"),
        owner: Owner::Station,
        source: "refraction",
        prior: Some(PriorSize { sigma, least: 1e-3 }),
        effect: Effect::Reading(ReadingError { correction_m, is_of_pointing: false }),
        sentence,
    }
}

pub static LATENCY: Unknown = Unknown {
    name: "latency",
    symbol: "λ",
    quantity: Quantity::Time,
    key: Some("latencies_s"),
    owner: Owner::Station,
    source: "latencies",
    prior: Some(PriorSize { sigma: |sizes| sizes.latency_s, least: 1e-7 }),
    effect: Effect::Latency,
    sentence: "station {}'s angles are older than its ranges by",
};

pub static LEAN_X: Unknown =
    lean("lean about x", "η", Effect::Lean(0), "station {} leans about x by");
pub static LEAN_Y: Unknown =
    lean("lean about y", "ξ", Effect::Lean(1), "station {} leans about y by");

const fn lean(
    name: &'static str,
    symbol: &'static str,
    effect: Effect,
    sentence: &'static str,
) -> Unknown {
    Unknown {
        name,
        symbol,
        quantity: Quantity::Angle,
        key: Some("leans_rad"),
        owner: Owner::Station,
        source: "leans",
        prior: Some(PriorSize { sigma: |sizes| sizes.lean_rad, least: 1e-9 }),
        effect,
        sentence,
    }
}

pub static DISTANCE: Unknown = Unknown {
    name: "distance",
    symbol: "d",
    quantity: Quantity::Length,
    key: Some("inter_prism_m"),
    owner: Owner::Pair,
    source: "inter-prism distances",
    prior: Some(PriorSize { sigma: |sizes| sizes.inter_prism_m, least: 1e-6 }),
    effect: Effect::Distance,
    sentence: "the distance between prisms {} is off by",
};
