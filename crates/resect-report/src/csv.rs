//! All results as tables for other programs: readings with their fates, triplets, distance errors, transforms, clocks,
//! and every number of the answer.
//!
//! Each table is a file with units in its column names, at full precision: reading it back gives the same values bit for bit.

use std::io::Write;
use std::path::{Path, PathBuf};

use super::summary::StationSummary;
use resect_core::analysis::{Analysis, Answer};
use resect_core::deployment::Deployment;
use resect_core::evaluation::answer_rows::AnswerRow;
use resect_core::network::Pair;
use resect_core::pipeline::SampleFate;
use resect_io::atomic;
use resect_io::atomic::{Ready, WriteError};

type Table<'a> = ::csv::Writer<&'a mut dyn Write>;

/// Files of the tables in a folder.
pub const TABLES: [&str; 6] =
    ["readings.csv", "triplets.csv", "residuals.csv", "transforms.csv", "clocks.csv", "answer.csv"];

/// Writes all [`TABLES`] into a folder, which is created if missing, and returns their paths. Without an answer it
/// writes readings and triplets only.
pub fn write_folder(
    deployment: &Deployment,
    analysis: &Analysis,
    folder: &Path,
) -> Result<Vec<PathBuf>, WriteError> {
    atomic::make_folder(folder)?;
    let mut ready = Vec::new();
    for (name, text) in tables(deployment, analysis) {
        ready.push(atomic::ready_with(&folder.join(name), |file| file.write_all(&text))?);
    }
    atomic::place_all(ready)
}

/// Returns the text of each of [`TABLES`], with its file name; without an answer, of readings and triplets only.
pub fn tables(deployment: &Deployment, analysis: &Analysis) -> Vec<(&'static str, Vec<u8>)> {
    let mut all = Vec::new();
    let [of_readings, of_triplets, of_residuals, of_transforms, of_clocks, of_rows] = TABLES;
    let mut table = |name: &'static str, fill: &dyn Fn(&mut Table) -> Result<(), ::csv::Error>| {
        let mut text: Vec<u8> = Vec::new();
        let into: &mut dyn Write = &mut text;
        let mut writer = ::csv::Writer::from_writer(into);
        fill(&mut writer).and_then(|()| Ok(writer.flush()?)).expect("memory has no disk errors");
        drop(writer);
        all.push((name, text));
    };
    table(of_readings, &|table| readings(deployment, analysis, table));
    table(of_triplets, &|table| triplets(analysis, table));
    if let Ok(answer) = &analysis.answer {
        table(of_residuals, &|table| residuals(analysis, answer, table));
        table(of_transforms, &|table| transforms(answer, table));
        table(of_clocks, &|table| clocks(answer, table));
        table(of_rows, &|table| rows(&analysis.rows(deployment), table));
    }
    all
}

/// Writes the triplets alone, as `triplets.csv` of [`write_folder`].
pub fn write_triplets(analysis: &Analysis, path: &Path) -> Result<(), WriteError> {
    ready_table(path, &|table| triplets(analysis, table))?.place().map(drop)
}

fn ready_table(
    path: &Path,
    fill: &dyn Fn(&mut Table) -> Result<(), ::csv::Error>,
) -> Result<Ready, WriteError> {
    atomic::ready_with(path, |file| {
        let mut table = ::csv::Writer::from_writer(file);
        fill(&mut table).map_err(io_error)?;
        table.flush()
    })
}

/// Writes every raw reading of every station: as measured, its position in the station's frame, and its fate.
fn readings(
    deployment: &Deployment,
    analysis: &Analysis,
    table: &mut Table,
) -> Result<(), ::csv::Error> {
    let mut header = vec!["station", "time_s", "range_m", "azimuth_rad", "zenith_rad"];
    header.extend(["x_m", "y_m", "z_m", "fate", "own_clock_s"]);
    table.write_record(header)?;
    for (station, track) in deployment.tracks.iter().enumerate() {
        let fates = &analysis.pipeline.fates[station].each;
        for (index, (measured, fate)) in track.measurements.iter().zip(fates).enumerate() {
            let position_m = track.position_m(measured);
            let mut row = vec![(station + 1).to_string()];
            row.extend(
                [measured.time_s, measured.range_m, measured.azimuth_rad, measured.zenith_rad]
                    .iter()
                    .chain(position_m.iter())
                    .map(ToString::to_string),
            );
            row.push(SampleFate::label(*fate).to_owned());
            let own_clock_s = track.own_clock_s.get(index).filter(|own| own.is_finite());
            row.push(optional(own_clock_s.copied()));
            table.write_record(row)?;
        }
    }
    Ok(())
}

/// Writes time, interval, and the positions by station, each in its station's frame (m).
fn triplets(analysis: &Analysis, table: &mut Table) -> Result<(), ::csv::Error> {
    let triplets = analysis.triplets();
    let mut header = vec!["time_s".to_owned(), "interval".to_owned()];
    for station in triplets.points_m.numbers() {
        header.extend(["x", "y", "z"].map(|axis| format!("{axis}{station}_m")));
    }
    table.write_record(header)?;
    for index in 0..triplets.len() {
        let mut row = at(analysis, index);
        for point in triplets.triplet_m(index) {
            row.extend(point.iter().map(ToString::to_string));
        }
        table.write_record(row)?;
    }
    Ok(())
}

/// Writes the distance errors of every triplet, one for each pair (mm): apparent minus known.
fn residuals(analysis: &Analysis, answer: &Answer, table: &mut Table) -> Result<(), ::csv::Error> {
    let errors = &answer.evaluation.distance_errors_mm;
    let mut header = vec!["time_s".to_owned(), "interval".to_owned()];
    let name = |Pair { first, second }| format!("error_{first}{second}_mm");
    header.extend(errors.numbers().map(name));
    table.write_record(header)?;
    for index in 0..analysis.triplets().len() {
        let mut row = at(analysis, index);
        row.extend(errors.iter().map(|pair| optional(pair.get(index).copied())));
        table.write_record(row)?;
    }
    Ok(())
}

/// Returns the first cells of a triplet's row: time and interval.
fn at(analysis: &Analysis, index: usize) -> Vec<String> {
    let triplets = analysis.triplets();
    vec![triplets.time_s[index].to_string(), triplets.interval[index].to_string()]
}

/// Writes the transforms from the other stations to station 1, with σ of each number if known.
fn transforms(answer: &Answer, table: &mut Table) -> Result<(), ::csv::Error> {
    let mut header = vec!["from", "to", "x_m", "y_m", "z_m", "yaw_rad", "qx", "qy", "qz", "qw"];
    header.extend(["sigma_x_m", "sigma_y_m", "sigma_z_m", "sigma_yaw_rad", "verdict"]);
    table.write_record(header)?;
    let calibration = &answer.calibration;
    for one in StationSummary::of(calibration) {
        let mut row = vec![one.station.to_string(), "1".to_owned()];
        row.extend(one.translation_m.map(|value| value.to_string()));
        row.push(one.yaw_rad().to_string());
        row.extend(one.quaternion_xyzw.map(|value| value.to_string()));
        row.extend((0..4).map(|place| optional(one.sigma.map(|sigma| sigma[place]))));
        row.push(calibration.verdict.name().to_owned());
        table.write_record(row)?;
    }
    Ok(())
}

/// Writes clock offsets and drifts of the other stations against station 1, if the calibration estimated them.
fn clocks(answer: &Answer, table: &mut Table) -> Result<(), ::csv::Error> {
    let mut header = vec!["station", "offset_s", "sigma_offset_s"];
    header.extend(["drift_s_per_s", "sigma_drift_s_per_s"]);
    table.write_record(header)?;
    let Some(clocks) = answer.calibration.clock_estimates() else { return Ok(()) };
    for (station, (offset_s, drift)) in clocks.each().skip(1) {
        let mut row = vec![station.to_string()];
        let numbers = [offset_s.value, offset_s.sigma, drift.value, drift.sigma];
        row.extend(numbers.map(|value| value.to_string()));
        table.write_record(row)?;
    }
    Ok(())
}

/// Writes every number of the answer, in SI units; a number without a reference is compared with zero.
fn rows(rows: &[AnswerRow], table: &mut Table) -> Result<(), ::csv::Error> {
    let mut header = vec!["group", "subject", "name", "symbol", "unit", "value", "sigma"];
    header.extend(["prior_sigma", "reference", "reference_value", "significant"]);
    table.write_record(header)?;
    for row in rows {
        let reference = row.reference.as_ref();
        table.write_record([
            row.group.name().to_owned(),
            row.subject.clone(),
            row.name.clone(),
            row.symbol.clone(),
            row.quantity.si_unit().to_owned(),
            row.value.to_string(),
            optional(row.sigma),
            optional(row.prior),
            reference.map_or_else(String::new, |reference| reference.name.clone()),
            optional(reference.map(|reference| reference.value)),
            row.is_significant.to_string(),
        ])?;
    }
    Ok(())
}

/// Returns the disk's error, the only kind that these tables can cause; any other kind would lose the remedy.
pub fn io_error(error: ::csv::Error) -> std::io::Error {
    match error.into_kind() {
        ::csv::ErrorKind::Io(error) => error,
        other => std::io::Error::other(format!("{other:?}")),
    }
}

/// Formats an optional number; an absent one is an empty cell.
fn optional(value: Option<f64>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}
