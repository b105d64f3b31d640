//! The outcome of a validation, and the level of its tests.

/// How often a calibration that holds is said not to, at most.
pub const LEVEL: f64 = 0.01;
/// How often each of the five tests may say so by chance.
pub const LEVEL_OF_ONE: f64 = LEVEL / 5.0;

/// Whether a calibration holds for another run.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    Holds,
    DoesNotHold(Cause),
    /// The data cannot tell, for this reason.
    CannotBeTold(String),
}

impl Outcome {
    pub fn name(&self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::DoesNotHold(_) => "does not hold",
            Self::CannotBeTold(_) => "cannot be told",
        }
    }
}

/// Why a calibration does not hold.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Cause {
    /// This station alone (0 to 2) moved or turned, which explains the whole difference.
    Station(usize),
    /// One of these stations (0 to 2) moved or turned, which explain it alike.
    OneOf(Vec<usize>),
    /// No station explains it alone.
    NoneAlone,
    /// The stations stand elsewhere altogether.
    OtherSetUp,
    /// No test of a station rejects, but the metric is worse than σ allows.
    Metric,
}
