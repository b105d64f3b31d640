//! Measurements of one station, in the download format of Bonn's robotic total station network.
//!
//! Columns: `ref_time, ts_time, h_angle, v_angle, distance, num_chars, geocom_return_code, rpc_return_code`. Source:
//! `rts-api/rtsapi/services/measurement_service.py` and `rts_observations.py` of Engineering-Geodesy-Bonn/rts-network. There is one
//! file for each job of one station, named by identifiers that do not number the stations. Angles are radians, clockwise and from the
//! zenith. The range is the instrument's own slope distance, including the prism constant set on it. A reading is valid if both return
//! codes are 0. `ref_time` is the arrival of the instrument's answer at the computer (Unix s). `ts_time` is the instrument's clock.
//! In a raw download it counts from power-on (s; ms in records older than the program's conversion). In a corrected one it is
//! converted to the computer's clock (s).
//!
//! Written from that source; not tested on a real recording.

use crate::findings::tracks::{rows_skipped, table_clock};
use std::io::Read;

use super::{polar_csv, table};
use crate::error::OpenError;
use crate::recording::Recording;
use resect_core::deployment::{Measurement, RawRecord};
use resect_core::progress::Progress;
use resect_core::statistics::median;

pub const COLUMNS: [&str; 7] = [
    "ref_time",
    "ts_time",
    "h_angle",
    "v_angle",
    "distance",
    "geocom_return_code",
    "rpc_return_code",
];

/// Largest median difference between corrected stamps and arrivals of the answers (s).
const NEAR_S: f64 = 60.0;

struct BonnReading {
    line: usize,
    arrived_s: f64,
    instrument: f64,
    status: i64,
    range_m: f64,
    azimuth_rad: f64,
    zenith_rad: f64,
}

/// Reads all lines, as readings of the given station. `progress` counts bytes.
pub fn read(
    file: &str,
    reader: impl Read,
    station: i64,
    progress: &Progress,
    into: &mut Recording,
) -> Result<(), OpenError> {
    into.begin_file(file, "line");
    let mut readings = Vec::new();
    let skipped = table::for_each_row(file, reader, &COLUMNS, progress, |row| {
        let [arrived_s, instrument, azimuth_rad, zenith_rad, range_m, _, _] = row.values;
        let codes = [row.whole(5, COLUMNS[5])?, row.whole(6, COLUMNS[6])?];
        let status = codes.into_iter().find(|code| *code != 0).unwrap_or(0);
        let line = row.line;
        readings.push(BonnReading {
            line,
            arrived_s,
            instrument,
            status,
            range_m,
            azimuth_rad,
            zenith_rad,
        });
        Ok(())
    })?;
    if readings.is_empty() {
        return Err(polar_csv::no_measurement(file));
    }
    into.findings.extend(rows_skipped(file, &skipped));
    let clock = Clock::of(&readings);
    into.findings.push(table_clock(file, &clock.said()));
    into.ranges_include_prism_constant = true;
    for reading in readings {
        let BonnReading { line, status, range_m, azimuth_rad, zenith_rad, .. } = reading;
        let time_s = clock.time_s(&reading);
        let measurement = Measurement { time_s, range_m, azimuth_rad, zenith_rad };
        into.push(&RawRecord { station, status, place: line, measurement, own_clock_s: None });
    }
    Ok(())
}

/// Source of the stamps.
enum Clock {
    /// The instrument's stamps are already on the computer's clock.
    Corrected,
    /// The instrument's clock, fitted by a straight line to the computer's time.
    Line { unit: &'static str, per_second: f64, drift: f64, at: [f64; 2], scatter_s: f64 },
    /// The reading's arrival: there are too few readings for a line, or they do not fit one.
    Arrival { too_few: bool },
}

impl Clock {
    fn of(readings: &[BonnReading]) -> Self {
        let valid =
            |r: &&BonnReading| r.status == 0 && r.arrived_s.is_finite() && r.instrument.is_finite();
        let pairs: Vec<_> =
            readings.iter().filter(valid).map(|r| [r.instrument, r.arrived_s]).collect();
        let apart_s = median(pairs.iter().map(|[own, arrived]| (arrived - own).abs()));
        if apart_s.is_some_and(|apart_s| apart_s < NEAR_S) {
            return Self::Corrected;
        }
        let count = pairs.len() as f64;
        let mean: [f64; 2] = [0, 1].map(|k| pairs.iter().map(|pair| pair[k]).sum::<f64>() / count);
        let moment = |a: usize, b: usize| {
            pairs.iter().map(|pair| (pair[a] - mean[a]) * (pair[b] - mean[b])).sum::<f64>()
        };
        let slope = moment(0, 1) / moment(0, 0);
        // A quartz clock is wrong by parts per million; milliseconds differ from seconds by a factor of a thousand.
        let (unit, per_second) = if slope > 0.5 { ("seconds", 1.0) } else { ("milliseconds", 1e3) };
        let drift = slope * per_second - 1.0;
        let too_few = pairs.len() < 10;
        if too_few || drift.is_nan() || drift.abs() > 0.01 {
            return Self::Arrival { too_few };
        }
        let off = |[own, arrived]: &[f64; 2]| arrived - mean[1] - slope * (own - mean[0]);
        let scatter_s = (pairs.iter().map(|pair| off(pair).powi(2)).sum::<f64>() / count).sqrt();
        Self::Line { unit, per_second, drift, at: mean, scatter_s }
    }

    fn time_s(&self, reading: &BonnReading) -> f64 {
        match self {
            Self::Corrected => reading.instrument,
            Self::Arrival { .. } => reading.arrived_s,
            Self::Line { per_second, drift, at: [own, arrived_s], .. } => {
                arrived_s + (1.0 + drift) / per_second * (reading.instrument - own)
            }
        }
    }

    fn said(&self) -> String {
        match self {
            Self::Corrected => {
                "stamps are ts_time, already corrected to ref_time".to_owned()
            }
            Self::Arrival { too_few: true } => {
                "stamps are ref_time, the time of arrival: there are too few readings to fit ts_time to it"
                    .to_owned()
            }
            Self::Arrival { too_few: false } => {
                "stamps are ref_time, the time of arrival: ts_time is not a linear function of it"
                    .to_owned()
            }
            Self::Line { unit, drift, scatter_s, .. } => format!(
                "a raw download: stamps are ts_time ({unit} since the instrument was switched on), fitted to ref_time \
                 by a straight line (drift {:.1} ppm, scatter {:.1} ms); they still contain the transmission latency",
                drift * 1e6,
                scatter_s * 1e3
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file as the program writes it: readings every 50 ms, answers delayed by up to 8 ms, one record in ten without a reading.
    fn file(instrument: impl Fn(f64) -> f64) -> String {
        let mut text = "ref_time, ts_time, h_angle, v_angle, distance, num_chars, geocom_return_code, rpc_return_code\n".to_owned();
        for k in 0..200 {
            let time_s = 1.7e9 + f64::from(k) * 0.05;
            let late_s = 0.004 + 0.004 * (f64::from(k) * 2.4).sin();
            let code = if k % 10 == 9 { 1284 } else { 0 };
            text +=
                &format!("{},{},0.5,1.55,20.25,87,0,{code}\n", time_s + late_s, instrument(time_s));
        }
        text
    }

    fn read_all(text: &str) -> (Vec<Measurement>, String, bool) {
        let mut recording = Recording::new(None, false);
        read("b.csv", text.as_bytes(), 2, &Progress::default(), &mut recording).expect("readable");
        let included = recording.ranges_include_prism_constant;
        let (tracks, findings) = recording.finish("b.csv").expect("readings");
        let said = findings.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n");
        (tracks[1].measurements.clone(), said, included)
    }

    #[test]
    fn clocks_of_every_download_give_the_same_stamps() {
        let power_on_s = 1.7e9 - 4321.0;
        let cases: [(String, &str); 3] = [
            (file(|time_s| time_s), "already corrected to ref_time"),
            (file(|time_s| (time_s - power_on_s) * (1.0 + 20e-6)), "seconds since the instrument"),
            (
                file(|time_s| (time_s - power_on_s) * (1.0 + 20e-6) * 1e3),
                "milliseconds since the instrument",
            ),
        ];
        for (text, expected) in cases {
            let (readings, said, included) = read_all(&text);
            assert!(said.contains(expected) && said.contains("status 1284"), "{said}");
            assert!(included);
            assert_eq!(readings.len(), 180);
            // The mean delay of the answers remains in a raw download.
            let late_s = readings[0].time_s - 1.7e9;
            assert!((-0.001..0.006).contains(&late_s), "{late_s}");
            let off_s = |k: usize| (readings[k].time_s - readings[0].time_s) - k as f64 / 9.0 * 0.5;
            assert!(off_s(171).abs() < 2e-3, "{}", off_s(171));
        }
    }

    #[test]
    fn a_clock_that_fits_nothing_is_not_used() {
        let (readings, said, _) = read_all(&file(|_| 5.0));
        assert!(said.contains("stamps are ref_time"), "{said}");
        assert!((readings[0].time_s - 1.7e9).abs() < 0.01);
    }
}
