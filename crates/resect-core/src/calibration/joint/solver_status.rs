//! Outcome of the Gauss–Newton iteration.

/// Outcome of the Gauss–Newton iteration of the joint estimate. A cancelled iteration has none: its calculation ends with
/// [`Cancelled`](crate::progress::Cancelled).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SolverStatus {
    /// The last step was short, so the estimate is at a minimum.
    #[default]
    Converged,
    /// The last step was short, but its normal matrix is positive definite only with tighter priors of slow changes, with which σ is too
    /// small.
    StifferPriors,
    /// The iteration ended at its largest number of steps, before a step was short.
    TooManySteps,
    /// A step moved a station 30 m or more away from its initial position.
    Diverged,
    /// A normal matrix is not positive definite, even with tighter priors.
    NotDefinite,
    /// The drive has no span in which each prism is read at least every 2 s.
    NoReadings,
    /// The published answer, from which the iteration starts, has an unobservable direction.
    UnobservableStart,
}

impl SolverStatus {
    /// Returns the stable name in JSON.
    pub fn code(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::StifferPriors => "stiffer-priors",
            Self::TooManySteps => "too-many-steps",
            Self::Diverged => "diverged",
            Self::NotDefinite => "not-definite",
            Self::NoReadings => "no-readings",
            Self::UnobservableStart => "unobservable-start",
        }
    }

    /// Returns the status in words, after "the joint estimate": "did not converge in 40 steps".
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::StifferPriors => "converged only with tighter priors",
            Self::TooManySteps => "did not converge",
            Self::Diverged => "diverged",
            Self::NotDefinite | Self::UnobservableStart => "is not determined",
            Self::NoReadings => "has no span in which each prism is read at least every 2 s",
        }
    }
}
