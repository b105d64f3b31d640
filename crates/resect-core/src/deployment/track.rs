//! What one station measured over time.

use nalgebra::Vector3;

use crate::geometry::Polar;

/// One reading of a station, as the instrument gave it (the prism constant is not in the range).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    pub time_s: f64,
    pub range_m: f64,
    /// Azimuth, clockwise seen from above (rad).
    pub azimuth_rad: f64,
    /// Zenith angle, 0 straight up (rad).
    pub zenith_rad: f64,
}

/// `P_i` of the paper: a station's readings in strictly increasing order of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Track {
    pub measurements: Vec<Measurement>,
    /// Added to every range on the way to coordinates, and nowhere else; 0 where the ranges contain it already.
    pub prism_constant_m: f64,
    /// What the station's own, unsynchronised clock said at each measurement (s); empty where no file tells.
    pub own_clock_s: Vec<f64>,
    /// Whether the user leaves each measurement out (a span of time, single readings); empty where none is.
    pub left_out: Vec<bool>,
}

impl Track {
    /// The reading with the prism constant added.
    pub fn polar(&self, measurement: &Measurement) -> Polar {
        Polar {
            range_m: measurement.range_m + self.prism_constant_m,
            azimuth_rad: measurement.azimuth_rad,
            zenith_rad: measurement.zenith_rad,
        }
    }

    /// Position in the station's frame (m).
    pub fn position_m(&self, measurement: &Measurement) -> Vector3<f64> {
        self.polar(measurement).to_cartesian()
    }

    /// Whether the user leaves this measurement out.
    pub fn is_left_out(&self, index: usize) -> bool {
        self.left_out.get(index).copied().unwrap_or(false)
    }
}

/// What a station's clock was corrected by at one moment, as the system that synchronises the stations said.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeCorrection {
    /// When the correction was said (s, synchronised time).
    pub time_s: f64,
    /// The station's own clock minus the synchronised time (s).
    pub offset_s: f64,
}

/// A line or message of a file, before it is known to be a usable reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RawRecord {
    /// Station number as the file gives it (1, 2 or 3 when it is right).
    pub station: i64,
    /// 0 when the station had a valid reading.
    pub status: i64,
    /// Line of a text file, or running number of a message in a bag.
    pub place: usize,
    pub measurement: Measurement,
    /// Time by the station's own clock (s), if the file has it beside the synchronised time.
    pub own_clock_s: Option<f64>,
}
