//! Transforms applied to tracks, to bring them into one frame: `list_tf/*.csv` of the authors' repository.
//!
//! Written by `save_tf` of its scripts: twelve numbers a line, the first three rows of a homogeneous 4×4 matrix `common_from_station`
//! in row-major order (m). A line for each station forms one set. A file with several sets has one for each random split
//! of the control points.

use nalgebra::{Matrix3, Rotation3, Vector3};

use crate::error::OpenError;
use resect_core::geometry::RigidTransform;
use resect_core::network::PerStation;

/// Numbers on a line.
pub const FIELDS: usize = 12;
/// Largest deviation of a rotation matrix from orthogonality.
const ORTHOGONAL: f64 = 1e-6;

/// `common_from_station` of the stations, and the first line of the set.
#[derive(Clone, Debug, PartialEq)]
pub struct AppliedTransforms {
    pub line: usize,
    pub common_from_station: PerStation<RigidTransform>,
}

/// Returns true if a line is a rigid transform.
pub fn looks_like(line: &str) -> bool {
    let values: Result<Vec<f64>, _> = line.split_whitespace().map(str::parse).collect();
    values.is_ok_and(|values| transform(&values).is_some())
}

/// Reads all sets of a file, each of this number of stations.
pub fn read(file: &str, text: &str, stations: usize) -> Result<Vec<AppliedTransforms>, OpenError> {
    let remedy = "a line has the first three rows of a 4×4 matrix";
    let mut transforms = Vec::new();
    for (index, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
        let fields: Result<Vec<f64>, _> = line.split_whitespace().map(str::parse).collect();
        let Some(transform) = fields.ok().as_deref().and_then(transform) else {
            return Err(OpenError::line(file, index + 1, "not a rigid transform", remedy));
        };
        transforms.push((index + 1, transform));
    }
    if transforms.is_empty() || transforms.len() % stations != 0 {
        let what = format!("{} transforms", transforms.len());
        let remedy = format!("each set has {stations} lines, one for each station");
        return Err(OpenError::file(file, what, remedy));
    }
    let set = |set: &[(usize, RigidTransform)]| AppliedTransforms {
        line: set[0].0,
        common_from_station: set.iter().map(|(_, transform)| *transform).collect(),
    };
    Ok(transforms.chunks_exact(stations).map(set).collect())
}

fn transform(values: &[f64]) -> Option<RigidTransform> {
    if values.len() != FIELDS || values.iter().any(|value| !value.is_finite()) {
        return None;
    }
    let rows = nalgebra::Matrix3x4::from_row_slice(values);
    let matrix: Matrix3<f64> = rows.fixed_columns::<3>(0).into();
    let off = (matrix * matrix.transpose() - Matrix3::identity()).abs().max();
    (off < ORTHOGONAL && matrix.determinant() > 0.0).then(|| RigidTransform {
        rotation: Rotation3::from_matrix_unchecked(matrix),
        translation_m: Vector3::from(rows.column(3)),
    })
}

/// Returns a text that [`read`] reads.
pub fn write(sets: &[PerStation<RigidTransform>]) -> String {
    let line = |transform: &RigidTransform| {
        let rows = transform.matrix().fixed_rows::<3>(0).transpose();
        rows.iter().map(f64::to_string).collect::<Vec<_>>().join(" ") + "\n"
    };
    sets.iter().flatten().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_reads_back_and_mistakes_are_said() {
        let transform = RigidTransform {
            rotation: Rotation3::from_euler_angles(1e-5, -2e-5, 0.4),
            translation_m: Vector3::new(2.5, 5.3, -0.3),
        };
        let set = PerStation::from([RigidTransform::IDENTITY, transform, transform.inverse()]);
        let read_back = read("t.csv", &write(&[set.clone(), set.clone()]), 3).expect("own text");
        assert_eq!(read_back.len(), 2);
        assert_eq!(read_back[1].line, 4);
        let off = read_back[1].common_from_station[1].matrix() - transform.matrix();
        assert!(off.abs().max() < 1e-12, "{off}");
        let error = read("t.csv", &write(&[set])[..40], 3).expect_err("cut").to_string();
        // The first line, 24 characters, is complete.
        assert!(error.starts_with("t.csv:2: not a rigid"), "{error}");
        let mirrored = "1 0 0 0 0 1 0 0 0 0 -1 0\n";
        assert!(read("t.csv", mirrored, 3).expect_err("mirrored").to_string().contains("t.csv:1"));
        let two = "1 0 0 0 0 1 0 0 0 0 1 0\n".repeat(2);
        assert!(read("t.csv", &two, 3).expect_err("two").to_string().contains("2 transforms"));
    }
}
