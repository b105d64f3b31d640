//! Colouring of readings and tracks.

/// Quantity that colours readings and tracks.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize,
)]
#[serde(rename_all = "kebab-case")]
pub enum Colouring {
    /// Readings by fate, tracks by station: the default for a new deployment.
    #[default]
    Fate,
    Station,
    /// The intervals that the pipeline kept.
    Interval,
    /// Speed of prism 1.
    Speed,
    /// Distance error of the worse of a prism's two pairs.
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

    /// Returns a sentence that explains the choice.
    pub fn hint(self) -> &'static str {
        match self {
            Self::Fate => "Readings by fate (accepted, rejected), tracks by station",
            Self::Station => "Station that measured the reading",
            Self::Interval => "Interval of the reading; seven colours repeat",
            Self::Speed => "Speed of prism 1 at that time",
            Self::Residual => {
                "Distance error at that time of the prism's worse pair; grey: no value"
            }
            Self::Time => "Time since the first measurement",
        }
    }
}
