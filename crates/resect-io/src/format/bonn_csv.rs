//! Measurements of one station as the robotic total station network of Bonn lets them be downloaded.
//!
//! `ref_time, ts_time, h_angle, v_angle, distance, num_chars, geocom_return_code, rpc_return_code`, from
//! `rts-api/rtsapi/services/measurement_service.py` and `rts_observations.py` of Engineering-Geodesy-Bonn/rts-network: a file
//! for each job of one station, named by identifiers that do not number the stations. Angles are radians, clockwise and
//! from the zenith; the range is the instrument's own slope distance, which contains the constant of the prism that was set
//! on it; a reading is valid where both return codes are 0. `ref_time` is when the answer of the instrument had arrived at
//! the computer (Unix s). `ts_time` is the instrument's clock: since it was switched on in a raw download (s; ms in records
//! from before that program divides it), brought to the computer's clock in a corrected one (s).
//!
//! Written from that source: no real recording was at hand to try it on.

use crate::findings::tracks::table_clock;
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

/// A corrected stamp and the arrival of its answer are closer than this (s).
const NEAR_S: f64 = 60.0;

struct Reading {
    line: usize,
    arrived_s: f64,
    instrument: f64,
    status: i64,
    range_m: f64,
    azimuth_rad: f64,
    zenith_rad: f64,
}

/// Every line, of the given station. `progress` counts its bytes.
pub fn read(
    file: &str,
    reader: impl Read,
    station: i64,
    progress: &Progress,
    into: &mut Recording,
) -> Result<(), OpenError> {
    into.begin_file(file, "line");
    let mut readings = Vec::new();
    table::for_each_row(file, reader, &COLUMNS, progress, |row| {
        let [arrived_s, instrument, azimuth_rad, zenith_rad, range_m, _, _] = row.values;
        let codes = [row.whole(file, 5, COLUMNS[5])?, row.whole(file, 6, COLUMNS[6])?];
        let status = codes.into_iter().find(|code| *code != 0).unwrap_or(0);
        let line = row.line;
        readings.push(Reading {
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
    let clock = Clock::of(&readings);
    into.findings.push(table_clock(file, &clock.said()));
    into.ranges_include_prism_constant = true;
    for reading in readings {
        let Reading { line, status, range_m, azimuth_rad, zenith_rad, .. } = reading;
        let time_s = clock.time_s(&reading);
        let measurement = Measurement { time_s, range_m, azimuth_rad, zenith_rad };
        into.push(&RawRecord { station, status, place: line, measurement, own_clock_s: None });
    }
    Ok(())
}

/// How a reading's stamp is found.
enum Clock {
    /// The instrument's stamps are those of the computer already.
    Corrected,
    /// The instrument's own count, on a straight line of the computer's time.
    Line { unit: &'static str, per_second: f64, drift: f64, at: [f64; 2], scatter_s: f64 },
    /// The reading's arrival: there is too little to put a line through.
    Arrival,
}

impl Clock {
    fn of(readings: &[Reading]) -> Self {
        let valid =
            |r: &&Reading| r.status == 0 && r.arrived_s.is_finite() && r.instrument.is_finite();
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
        // A clock of quartz is off by parts per million; a count of milliseconds by a thousand.
        let (unit, per_second) = if slope > 0.5 { ("seconds", 1.0) } else { ("milliseconds", 1e3) };
        let drift = slope * per_second - 1.0;
        if pairs.len() < 10 || drift.is_nan() || drift.abs() > 0.01 {
            return Self::Arrival;
        }
        let off = |[own, arrived]: &[f64; 2]| arrived - mean[1] - slope * (own - mean[0]);
        let scatter_s = (pairs.iter().map(|pair| off(pair).powi(2)).sum::<f64>() / count).sqrt();
        Self::Line { unit, per_second, drift, at: mean, scatter_s }
    }

    fn time_s(&self, reading: &Reading) -> f64 {
        match self {
            Self::Corrected => reading.instrument,
            Self::Arrival => reading.arrived_s,
            Self::Line { per_second, drift, at: [own, arrived_s], .. } => {
                arrived_s + (1.0 + drift) / per_second * (reading.instrument - own)
            }
        }
    }

    fn said(&self) -> String {
        match self {
            Self::Corrected => {
                "stamps are ts_time, which is brought to ref_time already".to_owned()
            }
            Self::Arrival => {
                "stamps are ref_time, when each answer arrived: ts_time fits no line of it"
                    .to_owned()
            }
            Self::Line { unit, drift, scatter_s, .. } => format!(
                "a raw download: stamps are ts_time ({unit} since the instrument was switched on) on a straight line of \
                 ref_time (drift {:.1} ppm, answers scatter by {:.1} ms), the delay of transmission still in them",
                drift * 1e6,
                scatter_s * 1e3
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file as the program writes it: readings every 50 ms, answers late by up to 8 ms, one in ten without a reading.
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
        let mut recording = Recording::default();
        read("b.csv", text.as_bytes(), 2, &Progress::default(), &mut recording).expect("readable");
        let included = recording.ranges_include_prism_constant;
        let ([_, track, _], findings) = recording.finish("b.csv").expect("readings");
        let said = findings.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n");
        (track.measurements, said, included)
    }

    #[test]
    fn clocks_of_every_download_give_the_same_stamps() {
        let power_on_s = 1.7e9 - 4321.0;
        let cases: [(String, &str); 3] = [
            (file(|time_s| time_s), "brought to ref_time already"),
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
            // The mean delay of the answers stays in a raw download.
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
