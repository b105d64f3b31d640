//! Columns of orientations: quaternions, and roll, pitch and yaw.

use nalgebra::{UnitQuaternion, Vector3};

use super::column_units::angle_unit_rad;

/// Columns of an orientation.
#[derive(Clone, Debug, PartialEq)]
pub enum OrientationColumns {
    /// x, y, z, w.
    Quaternion([usize; 4]),
    /// Angle of one unit (rad); `None` if no name states it.
    RollPitchYaw([usize; 3], Option<f64>),
    /// The yaw alone, with its unit as above.
    Yaw(usize, Option<f64>),
}

impl OrientationColumns {
    pub fn indices(&self) -> Vec<usize> {
        match self {
            Self::Quaternion(columns) => columns.to_vec(),
            Self::RollPitchYaw(columns, _) => columns.to_vec(),
            Self::Yaw(column, _) => vec![*column],
        }
    }
}

/// Orientation columns of a header, and their convention if it is a guess.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedOrientation {
    pub columns: OrientationColumns,
    pub guess: Option<&'static str>,
}

const QUATERNIONS: [&str; 10] = [
    "q",
    "q_",
    "q_rs_",
    "quat_",
    "orientation_",
    "rotation_",
    "pose_orientation_",
    "pose_pose_orientation_",
    "transform_rotation_",
    "quaternion_",
];
/// Prefixes of q0 to q3 that have no letters.
const NUMBERED: [&str; 4] = ["q", "quat", "quaternion", "orientation"];
const ROLL_PITCH_YAW: [&str; 8] =
    ["", "rot_", "euler_", "orientation_", "rpy_", "att_", "attitude_", "pose_"];
const YAWS: [&str; 2] = ["yaw", "theta"];
const W_FIRST: &str =
    "q0 is read as w, and q1, q2, q3 as x, y, z; name the columns qx, qy, qz, qw to be sure";

/// Finds the columns of orientations; names are in lower case without units. `has_position` is true for the columns of positions. In a
/// plane, the yaw alone is an orientation.
///
/// # Errors
/// If roll, pitch and yaw have an unknown unit, or different ones.
pub fn named_orientation(
    names: &[String],
    headers: &[&str],
    has_position: &dyn Fn(usize) -> bool,
    is_plane: bool,
) -> Result<Option<NamedOrientation>, String> {
    let find = |name: String| names.iter().position(|known| *known == name);
    let all = |prefixes: &[&str], axes: [&str; 4]| {
        prefixes.iter().find_map(|prefix| {
            let columns = axes.map(|axis| find(format!("{prefix}{axis}")));
            let [Some(x), Some(y), Some(z), Some(w)] = columns else { return None };
            Some([x, y, z, w])
        })
    };
    let quaternion = |columns, guess| {
        Some(NamedOrientation { columns: OrientationColumns::Quaternion(columns), guess })
    };
    if let Some(columns) = all(&QUATERNIONS, ["x", "y", "z", "w"]) {
        return Ok(quaternion(columns, None));
    }
    // Plain letters are a quaternion if they are not the position: `tx ty tz x y z w`.
    let last = ["x", "y", "z", "w"].map(|name| names.iter().rposition(|known| known == name));
    if let [Some(x), Some(y), Some(z), Some(w)] = last
        && ![x, y, z].into_iter().any(has_position)
    {
        return Ok(quaternion([x, y, z, w], None));
    }
    let prefixes: Vec<String> =
        NUMBERED.iter().flat_map(|prefix| [(*prefix).to_owned(), format!("{prefix}_")]).collect();
    let prefixes: Vec<&str> = prefixes.iter().map(String::as_str).collect();
    if let Some(columns) = all(&prefixes, ["1", "2", "3", "0"]) {
        return Ok(quaternion(columns, Some(W_FIRST)));
    }
    let angles = ROLL_PITCH_YAW.iter().find_map(|prefix| {
        let columns = ["roll", "pitch", "yaw"].map(|axis| find(format!("{prefix}{axis}")));
        let [Some(roll), Some(pitch), Some(yaw)] = columns else { return None };
        Some([roll, pitch, yaw])
    });
    let Some(columns) = angles else {
        let yaw = ROLL_PITCH_YAW
            .iter()
            .find_map(|prefix| YAWS.iter().find_map(|yaw| find(format!("{prefix}{yaw}"))));
        return yaw
            .filter(|_| is_plane)
            .map(|yaw| {
                let columns = OrientationColumns::Yaw(yaw, angle_unit_rad(headers[yaw])?);
                Ok(NamedOrientation { columns, guess: None })
            })
            .transpose();
    };
    let mut unit_rad = None;
    for column in columns {
        let stated = angle_unit_rad(headers[column])?;
        if unit_rad.is_some_and(|unit_rad| stated.is_some() && stated != Some(unit_rad)) {
            return Err("roll, pitch and yaw have different units".to_owned());
        }
        unit_rad = unit_rad.or(stated);
    }
    let columns = OrientationColumns::RollPitchYaw(columns, unit_rad);
    Ok(Some(NamedOrientation { columns, guess: None }))
}

/// Returns the names of columns that are part of an orientation or of a covariance, but are not used.
pub fn unread_columns(
    headers: &[&str],
    names: &[String],
    used: &[usize],
    has_quaternion: bool,
) -> Vec<String> {
    const ANGLES: [&str; 8] =
        ["roll", "pitch", "yaw", "heading", "azimuth", "euler", "rotvec", "angle_axis"];
    let is_quaternion = |name: &str| {
        let axis = name.strip_prefix('q').map(|rest| rest.trim_start_matches('_'));
        axis.is_some_and(|axis| ["w", "x", "y", "z", "0", "1", "2", "3", "4"].contains(&axis))
            || (name.starts_with("quat") && !name.contains("std"))
    };
    let is_covariance = |name: &str| {
        ["sigma_", "std_", "stddev_", "sd_", "cov_"].iter().any(|prefix| name.starts_with(prefix))
    };
    let is_rate =
        |name: &str| ["rate", "vel", "dot", "std", "sigma"].iter().any(|word| name.contains(word));
    let is_part = |(index, name): &(usize, &String)| {
        let is_angle = ANGLES.iter().any(|angle| name.contains(angle)) && !is_rate(name);
        !used.contains(index)
            && (is_covariance(name) || !has_quaternion && (is_angle || is_quaternion(name)))
    };
    names
        .iter()
        .enumerate()
        .filter(is_part)
        .map(|(index, _)| headers[index].trim().to_owned())
        .collect()
}

/// Angles up to a full turn are radians if no name states the unit; larger ones are degrees (rad).
const FULL_TURN_RAD: f64 = 6.3;

/// The unit of angles that no name states.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GuessedAngleUnit {
    pub unit_rad: f64,
    /// Largest angle as it stands in the file.
    pub largest: f64,
}

/// Guesses the unit of angles by the largest of them.
pub fn guessed_angle_unit(angles: impl Iterator<Item = Vector3<f64>>) -> GuessedAngleUnit {
    let largest = angles.map(|angles| angles.amax()).fold(0.0, f64::max);
    let unit_rad = if largest > FULL_TURN_RAD { 1_f64.to_radians() } else { 1.0 };
    GuessedAngleUnit { unit_rad, largest }
}

/// Difference from a full turn within which a step of an angle is one, as a share of it.
const WRAPS: f64 = 0.1;
/// Largest pitch of roll, pitch and yaw (rad), with an allowance for another order of rotations.
const LARGEST_PITCH_RAD: f64 = 1.7;

/// Returns the unit that angles contradict (rad), and the one that they have: steps from one end of the range to the other are full turns
/// in the right one. `None` if nothing contradicts the stated unit.
pub fn contradicted_angle_unit(stated_rad: f64, angles: &[Vector3<f64>]) -> Option<f64> {
    let largest = angles.iter().map(Vector3::amax).fold(0.0, f64::max);
    let turns_at = |full_turn: f64| {
        largest < (1.0 + WRAPS) * full_turn
            && angles
                .windows(2)
                .any(|two| ((two[1] - two[0]).amax() / full_turn - 1.0).abs() < WRAPS)
    };
    let degree_rad = 1_f64.to_radians();
    let pitches = angles.iter().map(|angles| angles.y.abs());
    if stated_rad == 1.0 {
        let is_steep = pitches.fold(0.0, f64::max) > LARGEST_PITCH_RAD;
        (is_steep || turns_at(360.0)).then_some(degree_rad)
    } else {
        turns_at(std::f64::consts::TAU).then_some(1.0)
    }
}

/// Returns the orientation of roll, pitch and yaw (rad): rotations about the fixed axes x, then y, then z.
pub fn from_roll_pitch_yaw(angles_rad: &Vector3<f64>) -> UnitQuaternion<f64> {
    UnitQuaternion::from_euler_angles(angles_rad.x, angles_rad.y, angles_rad.z)
}
