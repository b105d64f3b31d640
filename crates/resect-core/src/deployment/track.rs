//! Measurements of one station over time.

use nalgebra::Vector3;

use crate::geometry::Polar;
use crate::network::{Prism, PrismChange};

/// One raw reading of a station; the range does not contain the prism constant.
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
    /// Name by which the user or the files call the station (a topic, a file, a number); `None` if it is its number.
    pub name: Option<String>,
    pub measurements: Vec<Measurement>,
    /// Added to every range in the conversion to coordinates, and nowhere else (m); 0 if the ranges contain it already.
    pub prism_constant_m: f64,
    /// Time of each measurement by the station's own, unsynchronised clock (s); empty if no file has it.
    pub own_clock_s: Vec<f64>,
    /// True for measurements that the user leaves out (a span of time, single readings); empty if there are none.
    pub left_out: Vec<bool>,
    /// The prism that the station follows; `None` if nothing states it.
    pub prism: Option<Prism>,
    /// Changes to other prisms.
    pub prism_changes: Vec<PrismChange>,
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

    /// Returns true if the user leaves this measurement out.
    pub fn is_left_out(&self, index: usize) -> bool {
        self.left_out.get(index).copied().unwrap_or(false)
    }
}

/// Correction of a station's clock at one moment, as published by the system that synchronises the stations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeCorrection {
    /// Time of publication (s, synchronised time).
    pub time_s: f64,
    /// The station's own clock minus the synchronised time (s).
    pub offset_s: f64,
}

/// A line or message of a file, not yet checked to be a usable reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RawRecord {
    /// Station number in the file.
    pub station: i64,
    /// 0 for a valid reading.
    pub status: i64,
    /// Line of a text file, or sequence number of a message in a bag.
    pub place: usize,
    pub measurement: Measurement,
    /// Time by the station's own clock (s); `None` if the file has the synchronised time only.
    pub own_clock_s: Option<f64>,
}
