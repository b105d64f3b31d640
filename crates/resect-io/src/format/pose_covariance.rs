//! Covariances of poses: columns of a table, a file beside the table, and matrices of messages.
//!
//! All are those of (x, y, z, rotation about x, y, z) in the frame of the trajectory, as in `geometry_msgs/PoseWithCovariance`.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use nalgebra::{Matrix3, Matrix6};

use super::column_units::{angle_unit_rad, length_unit_m, square_unit};
use super::table::{self, CORRECT, number};
use crate::error::OpenError;
use resect_tools::estimates::{EstimatedPose, PoseCovariance};

/// Names of the parts of a pose in columns such as `cov_x_rx`.
const PARTS: [&str; 6] = ["x", "y", "z", "rx", "ry", "rz"];
/// Largest difference of the stamps of a pose and of its covariance (s).
const SAME_STAMP_S: f64 = 1e-4;

/// Columns of a pose's covariance.
#[derive(Clone, Debug, PartialEq)]
pub struct CovarianceColumns {
    elements: CovarianceElements,
    columns: Vec<usize>,
    /// Factor of each column from its unit to metres and radians.
    factors: Vec<f64>,
}

/// Elements that the columns have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum CovarianceElements {
    /// Standard deviations of the parts; without those of the rotation, three.
    Sigmas,
    /// The upper triangle, row by row, of three or six parts.
    Triangle,
    /// The 36 elements of a message's matrix, row by row.
    Message,
}

impl CovarianceColumns {
    fn new(elements: CovarianceElements, columns: Vec<usize>) -> Self {
        let factors = vec![1.0; columns.len()];
        Self { elements, columns, factors }
    }

    pub fn indices(&self) -> Vec<usize> {
        self.columns.clone()
    }

    /// Reads the units of the columns in their names.
    ///
    /// # Errors
    /// If a unit is unknown.
    pub fn with_units(mut self, headers: &[&str]) -> Result<Self, String> {
        for (index, column) in self.columns.iter().enumerate() {
            let name = headers[*column];
            self.factors[index] = match self.elements {
                CovarianceElements::Sigmas if index < 3 => length_unit_m(name)?,
                CovarianceElements::Sigmas => angle_unit_rad(name)?.unwrap_or(1.0),
                CovarianceElements::Triangle => {
                    let parts = if self.columns.len() == 6 { 3 } else { 6 };
                    let (row, column) = upper_triangle(parts).nth(index).unwrap_or_default();
                    square_unit(name, [row >= 3, column >= 3])?
                }
                CovarianceElements::Message => square_unit(name, [index / 6 >= 3, index % 6 >= 3])?,
            };
        }
        Ok(self)
    }

    /// Finds the columns by their names without units, in lower case; the full covariance precedes standard deviations.
    pub fn named(find: &dyn Fn(&str) -> Option<usize>) -> Option<Self> {
        let all = |names: &[String]| -> Option<Vec<usize>> {
            names.iter().map(|name| find(name)).collect()
        };
        for prefix in ["pose_covariance", "pose_covariance_", "covariance", "covariance_"] {
            let names: Vec<String> = (0..36).map(|index| format!("{prefix}{index}")).collect();
            if let Some(columns) = all(&names) {
                return Some(Self::new(CovarianceElements::Message, columns));
            }
        }
        for count in [6, 3] {
            for between in ["_", ""] {
                let names: Vec<String> = upper_triangle(count)
                    .map(|(row, column)| format!("cov_{}{between}{}", PARTS[row], PARTS[column]))
                    .collect();
                if let Some(columns) = all(&names) {
                    return Some(Self::new(CovarianceElements::Triangle, columns));
                }
            }
        }
        for count in [6, 3] {
            for prefix in ["sigma_", "std_", "stddev_", "sd_"] {
                let names: Vec<String> =
                    PARTS[..count].iter().map(|part| format!("{prefix}{part}")).collect();
                if let Some(columns) = all(&names) {
                    return Some(Self::new(CovarianceElements::Sigmas, columns));
                }
            }
        }
        None
    }

    /// Returns the covariance in a row; `None` if it is unknown there, or the reason why it is not one.
    pub fn covariance(
        &self,
        fields: &[Cow<'_, str>],
        separator: char,
    ) -> Result<Option<PoseCovariance>, String> {
        let value = |(column, factor): (&usize, &f64)| {
            let field = fields.get(*column).map_or("", AsRef::as_ref);
            number(field, separator != ',')
                .map(|value| factor * value)
                .map_err(|what| format!("covariance `{}` {what}", table::shown(field)))
        };
        let values: Result<Vec<f64>, String> =
            self.columns.iter().zip(&self.factors).map(value).collect();
        let values = values?;
        let mut matrix = Matrix6::zeros();
        let parts = match self.elements {
            CovarianceElements::Sigmas => {
                for (part, sigma) in values.iter().enumerate() {
                    matrix[(part, part)] = sigma * sigma;
                }
                values.len()
            }
            CovarianceElements::Triangle => {
                let parts = if values.len() == 6 { 3 } else { 6 };
                for ((row, column), value) in upper_triangle(parts).zip(values) {
                    matrix[(row, column)] = value;
                    matrix[(column, row)] = value;
                }
                parts
            }
            CovarianceElements::Message => return Ok(of_message(&values)),
        };
        Ok(of_matrix(&matrix, parts))
    }
}

fn upper_triangle(count: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..count).flat_map(move |row| (row..count).map(move |column| (row, column)))
}

/// Returns the covariance of the 36 elements of a message; `None` if it is unset (zero) or unknown (negative).
pub fn of_message(elements: &[f64]) -> Option<PoseCovariance> {
    of_matrix(&Matrix6::from_row_iterator(elements.iter().copied()), 6)
}

/// Returns the covariance of a matrix with so many known parts; `None` if the position's is not one.
fn of_matrix(matrix: &Matrix6<f64>, parts: usize) -> Option<PoseCovariance> {
    let block =
        |row, column| -> Matrix3<f64> { matrix.fixed_view::<3, 3>(row, column).into_owned() };
    let is_covariance = |block: &Matrix3<f64>| {
        block.iter().all(|value| value.is_finite())
            && block.diagonal().iter().all(|variance| *variance > 0.0)
            && block.symmetric_eigenvalues().iter().all(|value| *value > -1e-6 * block.trace())
    };
    let position_m2 = Some(block(0, 0)).filter(is_covariance)?;
    let rotation_rad2 = Some(block(3, 3)).filter(|block| parts == 6 && is_covariance(block));
    let rotation_with_position =
        if rotation_rad2.is_some() { block(3, 0) } else { Matrix3::zeros() };
    Some(PoseCovariance { position_m2, rotation_rad2, rotation_with_position })
}

/// Returns the file of covariances beside a table of poses, if there is one: `gt_covariance.csv` for `gt.txt`.
pub fn file_beside(path: &Path) -> Option<PathBuf> {
    let stem = path.file_stem()?.to_string_lossy();
    ["csv", "txt"]
        .map(|extension| path.with_file_name(format!("{stem}_covariance.{extension}")))
        .into_iter()
        .find(|beside| beside.is_file())
}

/// Reads a file of covariances, a line for each pose: its stamp, and 9 or 36 elements row by row.
///
/// # Errors
/// If a line is not one, or a pose has none.
pub fn read_beside(
    file: &str,
    text: &str,
    poses: &[EstimatedPose],
) -> Result<Vec<Option<PoseCovariance>>, OpenError> {
    let lines = text.lines().enumerate().map(|(index, line)| (index + 1, line.trim()));
    let is_row = |line: &str| line.starts_with(|first: char| first.is_ascii_digit());
    let mut rows: Vec<(f64, Option<PoseCovariance>)> = Vec::with_capacity(poses.len());
    for (number, line) in lines.filter(|(_, line)| is_row(line)) {
        let row = stamped_covariance(line);
        rows.push(row.map_err(|what| OpenError::line(file, number, what, CORRECT))?);
    }
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let of_pose = |pose: &EstimatedPose| {
        let after = rows.partition_point(|(stamp_s, _)| *stamp_s < pose.time_s - SAME_STAMP_S);
        let (stamp_s, covariance) = rows.get(after)?;
        ((stamp_s - pose.time_s).abs() <= SAME_STAMP_S).then_some(*covariance)
    };
    let covariances: Vec<Option<Option<PoseCovariance>>> = poses.iter().map(of_pose).collect();
    let missing = covariances.iter().filter(|covariance| covariance.is_none()).count();
    if missing > 0 {
        let what = format!("no covariance for {missing} of {} poses", poses.len());
        return Err(OpenError::file(file, what, "give each pose one, or rename the file"));
    }
    Ok(covariances.into_iter().flatten().collect())
}

fn stamped_covariance(line: &str) -> Result<(f64, Option<PoseCovariance>), String> {
    let separator = table::separator(line);
    let numbers: Result<Vec<f64>, String> = table::fields(line, separator)?
        .iter()
        .map(|field| {
            number(field, separator != ',')
                .map_err(|what| format!("`{}` {what}", table::shown(field)))
        })
        .collect();
    let numbers = numbers?;
    let mut matrix = Matrix6::zeros();
    let parts = match numbers.len() {
        10 => 3,
        37 => 6,
        count => {
            return Err(format!("{count} fields where a stamp and 9 or 36 elements are expected"));
        }
    };
    for (index, value) in numbers[1..].iter().enumerate() {
        matrix[(index / parts, index % parts)] = *value;
    }
    Ok((numbers[0], of_matrix(&matrix, parts)))
}
