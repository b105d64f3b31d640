//! The outcome of a validation, and the level of its tests.

/// Significance level of each test.
pub const LEVEL_OF_ONE: f64 = 0.002;

/// Significance level of all tests together: largest probability of rejecting a valid calibration (Bonferroni). There is a test of
/// the whole difference, of each station, and of the metric.
pub fn level(stations: usize) -> f64 {
    LEVEL_OF_ONE * (stations + 2) as f64
}

/// Outcome of the validation of a calibration by another run.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    Holds,
    DoesNotHold(Cause),
    /// Inconclusive, for this reason.
    CannotBeTold(String),
}

impl Outcome {
    pub fn name(&self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::DoesNotHold(_) => "does not hold",
            Self::CannotBeTold(_) => "inconclusive",
        }
    }
}

/// Cause for which a calibration does not hold.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Cause {
    /// Only this station (0 to 2) moved or turned; that explains the whole difference.
    Station(usize),
    /// One of these stations (0 to 2) moved or turned; they explain the difference equally well.
    OneOf(Vec<usize>),
    /// No single station explains the difference.
    NoneAlone,
    /// The stations were set up elsewhere.
    OtherSetUp,
    /// No test of a station is significant, but the metric is significantly worse.
    Metric,
}
