//! Everything that is measured or computed over time, as series to be plotted against time or against each other.

use serde::{Deserialize, Serialize};

use super::dimension::Dimension;
use super::plots::PreparedPlots;
use super::series::Series;

/// What can be plotted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Channel {
    #[default]
    Range,
    HorizontalAngle,
    VerticalAngle,
    RangeRate,
    HorizontalRate,
    VerticalRate,
    OwnClock,
    X,
    Y,
    Height,
    Speed,
    DistanceError,
}

/// What the series of a channel are of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Of {
    /// A station, or the prism that it follows.
    Station,
    Pair,
    Vehicle,
}

impl Channel {
    pub const ALL: [Self; 12] = [
        Self::Range,
        Self::HorizontalAngle,
        Self::VerticalAngle,
        Self::RangeRate,
        Self::HorizontalRate,
        Self::VerticalRate,
        Self::OwnClock,
        Self::X,
        Self::Y,
        Self::Height,
        Self::Speed,
        Self::DistanceError,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Self::Range => "range",
            Self::HorizontalAngle => "horizontal angle",
            Self::VerticalAngle => "vertical angle",
            Self::RangeRate => "range rate",
            Self::HorizontalRate => "horizontal rate",
            Self::VerticalRate => "vertical rate",
            Self::OwnClock => "clock offset",
            Self::X => "prism x",
            Self::Y => "prism y",
            Self::Height => "prism height",
            Self::Speed => "speed",
            Self::DistanceError => "distance error",
        }
    }

    /// What it is, in a sentence.
    pub fn hint(self) -> &'static str {
        match self {
            Self::Range => "The range of each raw reading",
            Self::HorizontalAngle => "The azimuth of each raw reading, clockwise",
            Self::VerticalAngle => "The zenith angle of each raw reading: zero is straight up",
            Self::RangeRate => {
                "How fast the range changes from one raw reading to the next, without its sign"
            }
            Self::HorizontalRate => {
                "How fast the azimuth changes from one raw reading to the next, without its sign"
            }
            Self::VerticalRate => {
                "How fast the zenith angle changes from one raw reading to the next, without its sign"
            }
            Self::OwnClock => "A station's own clock minus the synchronised time, less the median",
            Self::X => "x of each prism in station 1's frame, by the answer",
            Self::Y => "y of each prism in station 1's frame, by the answer",
            Self::Height => "z of each prism in station 1's frame, by the answer",
            Self::Speed => "How fast prism 1 moves, of each triplet",
            Self::DistanceError => {
                "Apparent minus known distance of each pair of prisms, of each triplet"
            }
        }
    }

    pub fn of(self) -> Of {
        match self {
            Self::Speed => Of::Vehicle,
            Self::DistanceError => Of::Pair,
            _ => Of::Station,
        }
    }

    pub fn dimension(self) -> Dimension {
        match self {
            Self::Range | Self::X | Self::Y | Self::Height => Dimension::Length,
            Self::HorizontalAngle | Self::VerticalAngle => Dimension::Angle,
            Self::RangeRate | Self::Speed => Dimension::Other("m/s"),
            Self::HorizontalRate | Self::VerticalRate => Dimension::AngleRate,
            Self::OwnClock => Dimension::Other("ms"),
            Self::DistanceError => Dimension::Other("mm"),
        }
    }

    /// The name of its column in a file, with the unit that it is stored in.
    pub fn column(self) -> &'static str {
        match self {
            Self::Range => "range_m",
            Self::HorizontalAngle => "azimuth_rad",
            Self::VerticalAngle => "zenith_rad",
            Self::RangeRate => "range_rate_m_per_s",
            Self::HorizontalRate => "azimuth_rate_deg_per_s",
            Self::VerticalRate => "zenith_rate_deg_per_s",
            Self::OwnClock => "clock_offset_ms",
            Self::X => "x_m",
            Self::Y => "y_m",
            Self::Height => "z_m",
            Self::Speed => "speed_m_per_s",
            Self::DistanceError => "distance_error_mm",
        }
    }

    /// Whether each of its series has one of the other to stand against.
    pub fn goes_with(self, other: Self) -> bool {
        self.of() == other.of() || self.of() == Of::Vehicle || other.of() == Of::Vehicle
    }

    /// The series of a station or a pair, from 0; none where the data has none.
    pub fn series(self, plots: &PreparedPlots, index: usize) -> Option<Series<'_>> {
        let readings = plots.readings.stations.get(index)?;
        let place = |first: Self| self as usize - first as usize;
        let track = &plots.track;
        match self {
            Self::Range | Self::HorizontalAngle | Self::VerticalAngle => {
                let of = &readings.measured[place(Self::Range)];
                Series::of(&readings.time_s, of, self == Self::HorizontalAngle)
            }
            Self::RangeRate | Self::HorizontalRate | Self::VerticalRate => {
                let of = &readings.rates[place(Self::RangeRate)].values;
                Series::of(&readings.time_s, of, false)
            }
            Self::X | Self::Y | Self::Height => {
                Series::of(&track.since_s, &track.places_m[index][place(Self::X)], false)
            }
            Self::Speed => Series::of(&track.since_s, &track.speed_m_per_s, false),
            Self::OwnClock => {
                let dots = &plots.readings.clocks[index].readings;
                Series::of_dots(&dots.all, dots.pyramid())
            }
            Self::DistanceError => {
                let residuals = &plots.residuals[index];
                Series::of_dots(&residuals.dots, &residuals.pyramid)
            }
        }
    }
}
