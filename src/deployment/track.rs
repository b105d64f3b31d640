//! What one station measured over time, cleaned of what cannot be a measurement.

use std::f64::consts::PI;

use nalgebra::Vector3;

use super::Finding;
use crate::geometry::Polar;

/// One reading of a station, as the instrument gave it (the prism constant is not in the range).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    pub time_s: f64,
    pub range_m: f64,
    /// Clockwise seen from above.
    pub azimuth_rad: f64,
    /// 0 straight up.
    pub zenith_rad: f64,
}

/// `P_i` of the paper: a station's readings in strictly increasing order of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Track {
    pub measurements: Vec<Measurement>,
    /// Added to every range on the way to coordinates, and nowhere else.
    pub prism_constant_m: f64,
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
}

/// A line or message of a file, before it is known to be a usable reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RawRecord {
    /// Station number as the file gives it (1, 2 or 3 when it is right).
    pub station: i64,
    /// 0 when the station had a valid reading.
    pub status: i64,
    /// Where it stands: line of a text file, running number of a message in a bag.
    pub place: usize,
    pub measurement: Measurement,
}

/// The year 5138 in Unix seconds; milliseconds and nanoseconds are beyond it.
const LATEST_STAMP_S: f64 = 1e11;

/// Sorts records into three tracks, leaving out what cannot be a reading and saying so.
///
/// `file` and `place_word` ("line", "message") are for the findings.
pub fn assemble_tracks(
    records: &[RawRecord],
    prism_constant_m: f64,
    file: &str,
    place_word: &str,
) -> ([Track; 3], Vec<Finding>) {
    let mut tracks: [Vec<(usize, Measurement)>; 3] = Default::default();
    let mut findings = Vec::new();
    let mut dropped = Dropped::default();
    for record in records {
        let m = record.measurement;
        let Some(station) = station_index(record.station) else {
            dropped.add("a station number other than 1, 2, 3".to_owned(), record);
            continue;
        };
        let whose = format!("station {}", station + 1);
        let polar = Polar {
            range_m: m.range_m + prism_constant_m,
            azimuth_rad: m.azimuth_rad,
            zenith_rad: m.zenith_rad,
        };
        if record.status != 0 {
            dropped.add(format!("{whose}: status {} (no valid reading)", record.status), record);
        } else if ![m.time_s, m.range_m, m.azimuth_rad, m.zenith_rad].iter().all(|v| v.is_finite())
        {
            dropped.add(format!("{whose}: not a number"), record);
        } else if !(0.0..=PI).contains(&m.zenith_rad) {
            dropped.add(format!("{whose}: zenith angle outside 0..π rad"), record);
        } else if !polar.is_plausible() {
            dropped.add(format!("{whose}: range outside 0..10 km"), record);
        } else if m.time_s.abs() > LATEST_STAMP_S {
            dropped.add(format!("{whose}: not a time stamp in seconds"), record);
        } else {
            tracks[station].push((record.place, m));
        }
    }
    findings.extend(dropped.into_findings(file, place_word));

    let tracks = std::array::from_fn(|station| {
        let readings = &mut tracks[station];
        let late = readings.windows(2).filter(|w| w[1].1.time_s < w[0].1.time_s).count();
        if late > 0 {
            readings.sort_by(|a, b| a.1.time_s.total_cmp(&b.1.time_s));
            findings.push(Finding::warning(format!(
                "station {}: {late} out-of-order stamps in {file}; the track was sorted by time",
                station + 1
            )));
        }
        let before = readings.len();
        let mut first_duplicate = None;
        readings.dedup_by(|later, kept| {
            let same = later.1.time_s == kept.1.time_s;
            if same {
                first_duplicate.get_or_insert(later.0);
            }
            same
        });
        if let Some(place) = first_duplicate {
            findings.push(Finding::warning(format!(
                "station {}: {} duplicate stamps dropped (first at {place_word} {place} of {file})",
                station + 1,
                before - readings.len()
            )));
        }
        if readings.is_empty() {
            findings.push(Finding::problem(format!(
                "station {} has no measurement in {file}; a calibration needs all three stations",
                station + 1
            )));
        }
        Track { measurements: readings.iter().map(|(_, m)| *m).collect(), prism_constant_m }
    });
    (tracks, findings)
}

/// 0, 1 or 2 for the station numbers 1, 2, 3 of the files.
pub fn station_index(number: i64) -> Option<usize> {
    match number {
        1..=3 => Some(number as usize - 1),
        _ => None,
    }
}

/// Counts of left-out records by reason, each with the first place it happened.
#[derive(Default)]
struct Dropped(Vec<(String, usize, usize)>);

impl Dropped {
    fn add(&mut self, reason: String, record: &RawRecord) {
        match self.0.iter_mut().find(|(known, _, _)| *known == reason) {
            Some((_, count, _)) => *count += 1,
            None => self.0.push((reason, 1, record.place)),
        }
    }

    fn into_findings(self, file: &str, place_word: &str) -> impl Iterator<Item = Finding> {
        self.0.into_iter().map(move |(reason, count, place)| {
            Finding::warning(format!(
                "{reason}: {count} dropped (first at {place_word} {place} of {file})"
            ))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(station: i64, place: usize, time_s: f64) -> RawRecord {
        let measurement = Measurement { time_s, range_m: 10.0, azimuth_rad: 0.1, zenith_rad: 1.5 };
        RawRecord { station, status: 0, place, measurement }
    }

    #[test]
    fn what_cannot_be_a_reading_is_left_out_and_said() {
        let mut records: Vec<_> =
            (0..9).map(|i| record(i % 3 + 1, i as usize + 2, i as f64)).collect();
        records.push(record(1, 11, 6.0)); // duplicate of the third reading of station 1
        records.push(record(2, 12, 0.5)); // late
        records.push(record(4, 13, 1.0));
        records.push(RawRecord { status: 3, ..record(3, 14, 9.0) });
        let mut broken = record(3, 15, 10.0);
        broken.measurement.range_m = f64::NAN;
        records.push(broken);
        let (tracks, findings) = assemble_tracks(&records, 0.010, "x.csv", "line");
        assert_eq!(tracks.each_ref().map(|t| t.measurements.len()), [3, 4, 3]);
        assert!(tracks[1].measurements.windows(2).all(|w| w[0].time_s < w[1].time_s));
        let text = findings.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n");
        for expected in [
            "status 3",
            "not a number",
            "duplicate",
            "out-of-order",
            "other than 1, 2, 3",
            "line 13 of x.csv",
        ] {
            assert!(text.contains(expected), "missing `{expected}` in:\n{text}");
        }
    }

    #[test]
    fn a_silent_station_is_a_problem() {
        let (_, findings) = assemble_tracks(&[record(1, 2, 0.0)], 0.0, "x.csv", "line");
        let problems =
            findings.iter().filter(|f| f.severity == crate::deployment::Severity::Problem);
        assert_eq!(problems.count(), 2);
    }
}
