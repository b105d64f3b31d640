//! Reads a format that resect does not know, and calibrates its readings: `cargo run --release --example add_a_format -- FILE`.
//!
//! The format is a toy, with one reading a line: `station 2 at 12.400: 31.4159 m, 123.4567 gon, 99.8765 gon` (seconds, range without the
//! prism constant, azimuth and zenith angle). Without a file the built-in sample is written in it first.
//!
//! To add a real one, put [`read`] into a file of `crates/resect-io/src/format/`. Then add a variant to `Format` in `format.rs` and a line
//! to `recognise.rs`, and call it in `open/tracks.rs`: folders, the window and every command then open it.

#![allow(clippy::print_stdout, reason = "an example prints")]

use std::f64::consts::PI;
use std::fmt::Write;

use resect_core::analysis::{Analyst, Settings};
use resect_core::deployment::{Deployment, Measurement, RawRecord, Track};
use resect_core::network::PerStation;
use resect_io::error::OpenError;
use resect_io::recording::Recording;
use resect_io::sample::Sample;

const GON_RAD: f64 = PI / 200.0;

/// Adds every line to a [`Recording`], which sorts the stamps, and counts and reports dropped lines.
fn read(file: &str, text: &str) -> Result<Recording, OpenError> {
    let mut recording = Recording::new(None, false);
    recording.begin_file(file, "line");
    for (index, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
        let (station, measurement) = reading(line).ok_or_else(|| OpenError::Line {
            file: file.to_owned(),
            line: index + 1,
            what: format!("`{line}` is no reading"),
            remedy: "correct or delete the line".to_owned(),
        })?;
        recording.push(&RawRecord {
            station,
            status: 0,
            place: index + 1,
            measurement,
            own_clock_s: None,
        });
    }
    Ok(recording)
}

fn reading(line: &str) -> Option<(i64, Measurement)> {
    let (station, rest) = line.strip_prefix("station ")?.split_once(" at ")?;
    let (time_s, rest) = rest.split_once(": ")?;
    let mut numbers = rest.split(", ");
    let mut next = |unit: &str| numbers.next()?.strip_suffix(unit)?.trim().parse::<f64>().ok();
    let measurement = Measurement {
        time_s: time_s.parse().ok()?,
        range_m: next("m")?,
        azimuth_rad: next("gon")? * GON_RAD,
        zenith_rad: next("gon")? * GON_RAD,
    };
    Some((station.parse().ok()?, measurement))
}

fn write(tracks: &PerStation<Track>) -> String {
    let mut text = String::new();
    for (station, track) in tracks.iter().enumerate() {
        for m in &track.measurements {
            let (azimuth, zenith) = (m.azimuth_rad / GON_RAD, m.zenith_rad / GON_RAD);
            let (station, time_s, range_m) = (station + 1, m.time_s, m.range_m);
            _ = writeln!(
                text,
                "station {station} at {time_s:.4}: {range_m:.5} m, {azimuth:.6} gon, {zenith:.6} gon"
            );
        }
    }
    text
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let sample = Sample::Warthog.open()?;
    let (file, text) = match std::env::args().nth(1) {
        Some(path) => (path.clone(), std::fs::read_to_string(&path)?),
        None => ("the sample".to_owned(), write(&sample.tracks)),
    };
    let (mut tracks, findings) = read(&file, &text)?.finish(&file)?;
    for track in &mut tracks {
        // Constant of the MT1000's prism, which the format does not include in its ranges.
        track.prism_constant_m = 0.010;
    }
    // The rig is the sample's; for your own use the distances that you measured between the prisms.
    let deployment =
        Deployment { name: file, tracks, findings, control_points: Vec::new(), ..sample };
    let analysis = Analyst::new(deployment.into()).run(&Settings::default());
    let calibration = &analysis.answer?.calibration;
    println!("{}: {}", calibration.answered_by().label(), calibration.verdict_in_words());
    for (station, transform) in calibration.station1_from_station.iter().enumerate().skip(1) {
        let [x, y, z] = transform.translation_m.into();
        println!("  station {}: {x:.4} {y:.4} {z:.4} m", station + 1);
    }
    Ok(())
}
