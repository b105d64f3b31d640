//! Findings about files with trajectories.

use crate::findings::kinds;
use crate::skipped_rows::SkippedRows;
use resect_core::deployment::{Finding, Subject, Unit};

pub fn estimate_out_of_order(file: &str) -> Finding {
    Finding::new(
        kinds::ESTIMATE_OUT_OF_ORDER,
        format!("{file}: poses were not in time order and were sorted"),
    )
    .about(Subject::File(file.to_owned()))
}

pub fn estimate_times_repeated(file: &str, count: usize) -> Finding {
    let message = format!("{file}: {count} poses repeat a time; the first of each is kept");
    Finding::new(kinds::ESTIMATE_TIMES_REPEATED, message)
        .about(Subject::File(file.to_owned()))
        .count("poses", count)
}

/// `count` poses have no times; `is_given` is true if the user gave their rate.
pub fn estimate_times_by_number(file: &str, count: usize, rate_hz: f64, is_given: bool) -> Finding {
    let message = match is_given {
        true => format!("{file}: {count} poses without times have the given rate of {rate_hz} Hz"),
        false => format!(
            "{file}: {count} poses without times are compared by their numbers, because all files have as many; seconds are those of \
             {rate_hz} Hz (--rate gives another rate)"
        ),
    };
    Finding::new(kinds::ESTIMATE_TIMES_BY_NUMBER, message)
        .about(Subject::File(file.to_owned()))
        .count("poses", count)
}

/// `without` of `all` poses have no orientation.
pub fn estimate_orientations_missing(file: &str, without: usize, all: usize) -> Finding {
    let message =
        format!("{file}: {without} of {all} poses have no orientation; no orientation is used");
    Finding::new(kinds::ESTIMATE_ORIENTATIONS_MISSING, message)
        .about(Subject::File(file.to_owned()))
        .count("without_orientation", without)
        .count("poses", all)
}

/// All poses have the same orientation, although they move.
pub fn estimate_orientations_constant(file: &str) -> Finding {
    let message = format!("{file}: all orientations are equal and taken as unknown");
    Finding::new(kinds::ESTIMATE_ORIENTATIONS_CONSTANT, message)
        .about(Subject::File(file.to_owned()))
}

/// The coordinates of an axis have steps of `step_m`.
pub fn estimate_positions_rounded(file: &str, axis: &str, step_m: f64) -> Finding {
    let message = format!(
        "{file}: the positions are rounded to {step_m:.2} m in {axis}, and all errors are as large; write them with more digits"
    );
    Finding::new(kinds::ESTIMATE_POSITIONS_ROUNDED, message)
        .about(Subject::File(file.to_owned()))
        .quantity("step", step_m, Unit::Metre)
}

/// `without` of `all` poses have no covariance.
pub fn estimate_covariances_missing(file: &str, without: usize, all: usize) -> Finding {
    let message =
        format!("{file}: {without} of {all} poses have no valid covariance; no covariance is used");
    Finding::new(kinds::ESTIMATE_COVARIANCES_MISSING, message)
        .about(Subject::File(file.to_owned()))
        .count("without_covariance", without)
        .count("poses", all)
}

pub fn estimate_quaternions_normalised(file: &str, count: usize) -> Finding {
    let message = format!("{file}: {count} quaternions without unit length were normalised");
    Finding::new(kinds::ESTIMATE_QUATERNIONS_NORMALISED, message)
        .about(Subject::File(file.to_owned()))
        .count("poses", count)
}

/// The orientations of `body` are angles about axes in an unknown order.
pub fn estimate_angles_not_read(file: &str, body: &str) -> Finding {
    let message = format!(
        "{file}: the orientations of {body} are angles about axes in an unknown order and not read; export quaternions"
    );
    Finding::new(kinds::ESTIMATE_ANGLES_NOT_READ, message).about(Subject::Named(body.to_owned()))
}

/// Returns a finding about the messages of a topic that are not poses; `None` without any.
pub fn estimate_poses_skipped(file: &str, topic: &str, skipped: &SkippedRows) -> Option<Finding> {
    let (message, reason) = skipped.first.as_ref()?;
    let text =
        format!("{file}: {} poses of {topic} skipped (message {message} {reason})", skipped.count);
    let finding = Finding::new(kinds::ROWS_SKIPPED, text);
    Some(finding.about(Subject::File(file.to_owned())).count("poses", skipped.count))
}

pub fn estimate_stamps_joined(file: &str) -> Finding {
    let message = format!(
        "{file}: the stamps join seconds and nanoseconds without leading zeros and are read so, because the poses are in \
         order only then"
    );
    Finding::new(kinds::ESTIMATE_STAMPS_JOINED, message).about(Subject::File(file.to_owned()))
}

/// `layout` names the columns in their order.
pub fn estimate_columns_guessed(file: &str, layout: &str) -> Finding {
    let message = format!("{file}: no header; read as {layout}");
    Finding::new(kinds::ESTIMATE_COLUMNS_GUESSED, message).about(Subject::File(file.to_owned()))
}

/// `meaning` states how columns are read that their names leave open, and the names that would state it.
pub fn estimate_columns_named(file: &str, meaning: &str) -> Finding {
    let message = format!("{file}: {meaning}");
    Finding::new(kinds::ESTIMATE_COLUMNS_GUESSED, message).about(Subject::File(file.to_owned()))
}

/// The unit of roll, pitch and yaw (rad), guessed by the largest of them as it stands in the file.
pub fn estimate_angle_unit_guessed(file: &str, unit_rad: f64, largest: f64) -> Finding {
    let unit = if unit_rad == 1.0 { "radians" } else { "degrees" };
    let message = format!(
        "{file}: roll, pitch and yaw are read as {unit}, because the largest is {largest:.2}; name the columns roll_deg or roll_rad \
         to be sure"
    );
    Finding::new(kinds::ESTIMATE_ANGLE_UNIT_GUESSED, message)
        .about(Subject::File(file.to_owned()))
        .quantity("largest", largest, Unit::Ratio)
}

/// `names` are columns of an orientation or a covariance.
pub fn estimate_columns_unread(file: &str, names: &[String]) -> Finding {
    let message = format!(
        "{file}: {} not read: an orientation needs qx, qy, qz, qw or roll, pitch, yaw; a covariance needs sigma_x, sigma_y, sigma_z \
         or cov_x_x to cov_z_z",
        match names {
            [only] => format!("column {only} is"),
            _ => format!("columns {} are", names.join(", ")),
        }
    );
    Finding::new(kinds::ESTIMATE_COLUMNS_UNREAD, message)
        .about(Subject::File(file.to_owned()))
        .count("columns", names.len())
}

pub(super) fn examples() -> Vec<Finding> {
    vec![
        estimate_out_of_order("slam.tum"),
        estimate_times_repeated("slam.tum", 3),
        estimate_times_by_number("00.txt", 1101, 10.0, false),
        estimate_orientations_missing("slam.tum", 3, 90),
        estimate_orientations_constant("gt.txt"),
        estimate_covariances_missing("gt.csv", 3, 90),
        estimate_positions_rounded("slam.tum", "y", 10.0),
        estimate_quaternions_normalised("slam.tum", 7),
        estimate_angles_not_read("take.csv", "Robot"),
        estimate_stamps_joined("slam.csv"),
        estimate_columns_guessed("slam.csv", "EuRoC: time, x, y, z, qw, qx, qy, qz"),
        estimate_columns_named(
            "slam.csv",
            "q0 is read as w, and q1, q2, q3 as x, y, z; name the columns qx, qy, qz, qw to be sure",
        ),
        estimate_angle_unit_guessed("slam.csv", 1.0, 3.1),
        estimate_columns_unread("slam.csv", &["yaw".to_owned()]),
    ]
}
