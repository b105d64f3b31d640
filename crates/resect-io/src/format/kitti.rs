//! Poses of KITTI: twelve numbers a line, and their times in a separate file.

use std::path::{Path, PathBuf};

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::estimate::KITTI_FIELDS;
use super::table::CORRECT;
use crate::error::OpenError;
use resect_tools::estimates::EstimatedPose;

/// The first three rows of a 4×4 matrix.
pub type KittiRow = [f64; KITTI_FIELDS];

/// Reads the rows of a file.
pub fn rows(file: &str, text: &str) -> Result<Vec<KittiRow>, OpenError> {
    let lines = text.lines().enumerate().map(|(index, line)| (index + 1, line.trim()));
    let rows = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with(['#', '%']));
    let row = |(number, line): (usize, &str)| {
        let values: Option<Vec<f64>> =
            line.split_whitespace().map(|field| field.parse().ok()).collect();
        let row = values.and_then(|values| KittiRow::try_from(values).ok());
        row.filter(|row| row.iter().all(|value| value.is_finite()))
            .ok_or_else(|| OpenError::line(file, number, "not twelve numbers", CORRECT))
    };
    rows.map(row).collect()
}

/// Returns the pose of a row.
pub fn pose(time_s: f64, row: &KittiRow) -> EstimatedPose {
    let matrix = Matrix3::from_fn(|r, c| row[4 * r + c]);
    EstimatedPose {
        time_s,
        position_m: Vector3::new(row[3], row[7], row[11]),
        // Rows rounded to a few digits are not exactly a rotation.
        orientation: Some(UnitQuaternion::from(Rotation3::from_matrix(&matrix))),
    }
}

fn names_of_times(path: &Path) -> [String; 2] {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    [format!("{stem}_times.txt"), "times.txt".to_owned()]
}

/// Returns the file of times beside KITTI poses, if there is one.
pub fn times_beside(path: &Path) -> Option<PathBuf> {
    names_of_times(path).iter().map(|name| path.with_file_name(name)).find(|path| path.is_file())
}

/// Error of a file without times.
pub fn no_times(file: &str, path: &Path) -> OpenError {
    let [name, common] = names_of_times(path);
    let remedy = format!(
        "put {name} or {common} beside it, or evaluate it with the rate of its poses (--rate)"
    );
    OpenError::file(file, "KITTI poses have no times", remedy)
}

/// Reads the times of a file (s).
pub fn times_s(name: &str, text: &str) -> Result<Vec<f64>, OpenError> {
    let lines = text.lines().map(str::trim).enumerate();
    let stamps = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let time_s = |(index, line): (usize, &str)| match line.parse::<f64>() {
        Ok(time_s) if time_s.is_finite() => Ok(time_s),
        _ => Err(OpenError::line(name, index + 1, format!("`{line}` is not a time"), CORRECT)),
    };
    stamps.map(time_s).collect()
}
