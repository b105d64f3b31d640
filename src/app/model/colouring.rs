//! What readings and tracks are coloured by.

/// What readings and tracks are coloured by.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize,
)]
#[serde(rename_all = "kebab-case")]
pub enum Colouring {
    /// Readings by what became of them, tracks by their station: what is asked first of a new deployment.
    #[default]
    Fate,
    Station,
    /// The intervals that were kept.
    Interval,
    /// How fast prism 1 moves.
    Speed,
    /// The distance error of the worse of the two pairs that a prism is part of.
    Residual,
    Time,
}

impl Colouring {
    pub const ALL: [Self; 6] =
        [Self::Fate, Self::Station, Self::Interval, Self::Speed, Self::Residual, Self::Time];

    pub fn title(self) -> &'static str {
        match self {
            Self::Fate => "Fate",
            Self::Station => "Station",
            Self::Interval => "Interval",
            Self::Speed => "Speed",
            Self::Residual => "Residual",
            Self::Time => "Time",
        }
    }

    /// One sentence for who chooses.
    pub fn hint(self) -> &'static str {
        match self {
            Self::Fate => "Readings by what became of them, tracks by station",
            Self::Station => "The station that measured it",
            Self::Interval => "The interval it is in; seven colours that repeat",
            Self::Speed => "How fast prism 1 moves at that time",
            Self::Residual => {
                "Distance error at that time, of the worse of the prism's two pairs: grey where there is none"
            }
            Self::Time => "Time since the first measurement",
        }
    }
}
