//! Meaning of the columns of a table of measurements in a format that no reader knows, given by the user.

use serde::{Deserialize, Serialize};

/// Columns of a table of tracks by their names in the header, and the meaning of their numbers.
///
/// Either `range`, `azimuth` and `vertical`, or `x`, `y` and `z`. Without `station` each station has a file of its own,
/// and `tracks` of `deployment.toml` names them in order.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ColumnMapping {
    pub time: String,
    #[serde(skip_serializing_if = "is_default")]
    pub time_format: TimeFormat,
    /// UTC offset of calendar stamps without a zone (hours, positive ahead of UTC).
    #[serde(skip_serializing_if = "is_default")]
    pub utc_offset_hours: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub station: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub azimuth: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub vertical: Option<String>,
    /// Coordinates in the station's own frame, right-handed, z up.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub x: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub y: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub z: Option<String>,
    #[serde(skip_serializing_if = "is_default")]
    pub length_unit: TableLength,
    #[serde(skip_serializing_if = "is_default")]
    pub angle_unit: TableAngle,
    #[serde(skip_serializing_if = "is_default")]
    pub vertical_angle: VerticalAngle,
    /// A column whose value is 0 for valid readings.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub status: Option<String>,
}

impl ColumnMapping {
    /// Returns the names of the columns that are read, the time first.
    pub fn names(&self) -> Vec<&str> {
        let Self { time, station, range, azimuth, vertical, x, y, z, .. } = self;
        let others = [station, range, azimuth, vertical, x, y, z];
        std::iter::once(time).chain(others.into_iter().flatten()).map(String::as_str).collect()
    }
}

/// True for defaults, which are not written.
fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// Format of a table's stamps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TimeFormat {
    /// Seconds, since 1970 (Unix) or any other start.
    #[default]
    Seconds,
    Milliseconds,
    Microseconds,
    Nanoseconds,
    /// A date and a time of day: `2022-07-11T19:50:01.135Z`, or with a space, or without a zone.
    Calendar,
    /// A time of day alone: `19:50:01.135`.
    TimeOfDay,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TableLength {
    #[default]
    Metres,
    Millimetres,
    /// International feet, 0.3048 m.
    Feet,
    /// US survey feet, 1200/3937 m.
    UsSurveyFeet,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TableAngle {
    #[default]
    Radians,
    Degrees,
    Gon,
    /// Degrees, minutes, seconds: `272°23'19.4"`, `272 23 19.4`, `272-23-19.4`.
    DegreesMinutesSeconds,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum VerticalAngle {
    /// The vertical angle is 0 straight up.
    #[default]
    Zenith,
    /// The vertical angle is 0 on the horizon, positive upwards.
    Elevation,
}

impl TableLength {
    /// The unit of lengths in words, as in "range in metres".
    pub fn words(self) -> &'static str {
        match self {
            Self::Metres => "metres",
            Self::Millimetres => "millimetres",
            Self::Feet => "feet",
            Self::UsSurveyFeet => "US survey feet",
        }
    }
}

impl TableAngle {
    /// The unit of angles in words, as in "angles in radians".
    pub fn words(self) -> &'static str {
        match self {
            Self::Radians => "radians",
            Self::Degrees => "degrees",
            Self::Gon => "gon",
            Self::DegreesMinutesSeconds => "degrees, minutes, seconds",
        }
    }
}

impl VerticalAngle {
    /// The kind of angle in words, as in "zenith angle".
    pub fn words(self) -> &'static str {
        match self {
            Self::Zenith => "zenith",
            Self::Elevation => "elevation",
        }
    }
}
