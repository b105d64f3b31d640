//! Channels: values over time, as series to be plotted against time or against each other.

use serde::{Deserialize, Serialize};

use super::dimension::Dimension;
use super::plots::PreparedPlots;
use super::series::{InstantValue, Series};
use super::way::{Instant, Way};
use resect_core::calibration::Estimate;

/// A value over time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Channel {
    VehicleHeight,
    VehicleSpeed,
    Heading,
    Roll,
    Pitch,
    PositionSigma,
    RotationSigma,
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

/// The subject of a channel: there is a series of each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// A station, or the prism that it tracks.
    Station,
    Pair,
    Prism1,
    /// The vehicle, with σ.
    Vehicle,
}

impl Subject {
    /// Returns true if there is one series instead of three.
    pub fn is_single(self) -> bool {
        matches!(self, Self::Prism1 | Self::Vehicle)
    }
}

/// The description of a channel.
#[derive(Clone, Copy, Debug)]
pub struct Description {
    pub name: &'static str,
    pub subject: Subject,
    pub dimension: Dimension,
    /// Name of its column in a file, with the unit that it is stored in.
    pub column: &'static str,
    pub hint: &'static str,
}

/// The data that channels are read from.
#[derive(Clone, Copy)]
pub struct Sources<'a> {
    pub plots: &'a PreparedPlots,
    /// Path of the vehicle by the calibration.
    pub way: Option<&'a Way>,
    /// Time of the first measurement (s).
    pub start_s: f64,
}

impl Channel {
    /// All channels in the order of the menus: first those of the vehicle.
    pub const ALL: [Self; 19] = [
        Self::VehicleHeight,
        Self::VehicleSpeed,
        Self::Heading,
        Self::Roll,
        Self::Pitch,
        Self::PositionSigma,
        Self::RotationSigma,
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
    /// The number of channels of the vehicle, which are the first.
    pub const OF_VEHICLE: usize = 7;

    /// Describes the channel; a new channel is added here.
    #[rustfmt::skip]
    pub fn describe(self) -> Description {
        use Dimension::{Angle, AngleRate, AngleSigma, Length, LengthSigma, Other};
        use Subject::{Pair, Prism1, Station, Vehicle};
        let row = |name, subject, dimension, column, hint| Description { name, subject, dimension, column, hint };
        match self {
            Self::VehicleHeight => row("height", Vehicle, Length, "vehicle_z_m",
                "z of the vehicle's origin in the frame of station 1, with ±1.96 σ"),
            Self::VehicleSpeed => row("speed", Vehicle, Other("m/s"), "vehicle_speed_m_per_s",
                "Speed of the vehicle's origin, with ±1.96 σ"),
            Self::Heading => row("heading", Vehicle, Angle, "heading_rad",
                "Rotation about z from the frame of station 1 to the vehicle's, with ±1.96 σ"),
            Self::Roll => row("roll", Vehicle, Angle, "roll_rad",
                "Rotation about the vehicle's own x, with ±1.96 σ"),
            Self::Pitch => row("pitch", Vehicle, Angle, "pitch_rad",
                "Rotation about y between heading and roll, with ±1.96 σ"),
            Self::PositionSigma => row("σ position", Vehicle, LengthSigma, "position_sigma_m",
                "Root of the mean variance of the position's three axes, from readings, calibration, clocks and rig"),
            Self::RotationSigma => row("σ rotation", Vehicle, AngleSigma, "rotation_sigma_rad",
                "Root of the mean variance of the orientation about the three axes"),
            Self::Range => row("range", Station, Length, "range_m", "Range of each raw reading"),
            Self::HorizontalAngle => row("azimuth", Station, Angle, "azimuth_rad",
                "Azimuth of each raw reading, clockwise"),
            Self::VerticalAngle => row("zenith angle", Station, Angle, "zenith_rad",
                "Zenith angle of each raw reading: zero is straight up"),
            Self::RangeRate => row("range rate", Station, Other("m/s"), "range_rate_m_per_s",
                "Absolute rate of change of the range between consecutive raw readings"),
            Self::HorizontalRate => row("azimuth rate", Station, AngleRate, "azimuth_rate_deg_per_s",
                "Absolute rate of change of the azimuth between consecutive raw readings"),
            Self::VerticalRate => row("zenith rate", Station, AngleRate, "zenith_rate_deg_per_s",
                "Absolute rate of change of the zenith angle between consecutive raw readings"),
            Self::OwnClock => row("clock offset", Station, Other("ms"), "clock_offset_ms",
                "A station's own clock minus the synchronised time, less the median"),
            Self::X => row("prism x", Station, Length, "x_m", "x of each prism in the frame of station 1"),
            Self::Y => row("prism y", Station, Length, "y_m", "y of each prism in the frame of station 1"),
            Self::Height => row("prism height", Station, Length, "z_m",
                "z of each prism in the frame of station 1"),
            Self::Speed => row("prism speed", Prism1, Other("m/s"), "speed_m_per_s",
                "Speed of prism 1 at each triplet"),
            Self::DistanceError => row("distance error", Pair, Other("mm"), "distance_error_mm",
                "Apparent minus known distance of each pair of prisms at each triplet"),
        }
    }

    pub fn name(self) -> &'static str {
        self.describe().name
    }

    pub fn subject(self) -> Subject {
        self.describe().subject
    }

    pub fn dimension(self) -> Dimension {
        self.describe().dimension
    }

    /// Returns true if each series of one can be plotted against a series of the other.
    pub fn goes_with(self, other: Self) -> bool {
        let [own, other] = [self, other].map(Self::subject);
        own == other || own.is_single() || other.is_single()
    }

    /// Returns true if its values are those of the raw readings, which have fates.
    pub fn is_of_readings(self) -> bool {
        (Self::Range as usize..=Self::VerticalRate as usize).contains(&(self as usize))
    }

    /// Returns the function that reads a channel of the vehicle at an instant (m, m/s, rad); the σ of a σ is zero.
    fn of_instant(self) -> Option<InstantValue> {
        match self {
            Self::VehicleHeight => Some(|at| Some(at.height_m())),
            Self::VehicleSpeed => Some(|at| at.speed_m_per_s),
            Self::Heading => Some(|at| Some(at.attitude?.yaw_rad)),
            Self::Roll => Some(|at| Some(at.attitude?.roll_rad)),
            Self::Pitch => Some(|at| Some(at.attitude?.pitch_rad)),
            Self::PositionSigma => {
                Some(|at| Some(Estimate { value: at.position_sigma_m(), sigma: 0.0 }))
            }
            Self::RotationSigma => {
                Some(|at| at.turn_sigma_rad.map(|value| Estimate { value, sigma: 0.0 }))
            }
            _ => None,
        }
    }

    /// Returns the vehicle's value at an instant; `None` for other channels, or if it is not determined.
    pub fn of_vehicle(self, instant: &Instant) -> Option<Estimate> {
        self.of_instant()?(instant)
    }

    /// Returns the series of a station or a pair, from 0; `None` without data.
    pub fn series(self, sources: Sources<'_>, index: usize) -> Option<Series<'_>> {
        let Sources { plots, way, start_s } = sources;
        if let Some(value) = self.of_instant() {
            return Series::of_vehicle(way?, start_s, value, self.dimension() == Dimension::Angle);
        }
        let readings = plots.readings.stations.as_slice().get(index)?;
        let place = |first: Self| self as usize - first as usize;
        let track = &plots.track;
        match self {
            Self::Range | Self::HorizontalAngle | Self::VerticalAngle => {
                let measured = &readings.measured[place(Self::Range)];
                Series::of(&readings.time_s, measured, self == Self::HorizontalAngle)
            }
            Self::RangeRate | Self::HorizontalRate | Self::VerticalRate => {
                let rates = &readings.rates[place(Self::RangeRate)].values;
                Series::of(&readings.time_s, rates, false)
            }
            Self::X | Self::Y | Self::Height => Series::of(
                &track.since_s,
                &track.places_m.as_slice().get(index)?[place(Self::X)],
                false,
            ),
            Self::Speed => Series::of(&track.since_s, &track.speed_m_per_s, false),
            Self::OwnClock => {
                let dots = &plots.readings.clocks.as_slice().get(index)?.readings;
                Series::of_dots(&dots.all, dots.pyramid())
            }
            Self::DistanceError => {
                let residuals = plots.residuals.as_slice().get(index)?;
                Series::of_dots(&residuals.dots, &residuals.pyramid)
            }
            _ => None,
        }
    }
}
