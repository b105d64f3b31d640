//! Findings about surveys: GSI and JobXML files of total stations.

use crate::findings::kinds;
use resect_core::deployment::{Finding, FindingKind, Subject};

fn about(kind: FindingKind, file: &str, message: impl AsRef<str>) -> Finding {
    Finding::new(kind, format!("{file}: {}", message.as_ref()))
        .about(Subject::File(file.to_owned()))
}

/// `first` describes the first of them.
pub fn survey_readings_unusable(file: &str, count: usize, first: &str) -> Finding {
    let message = format!("{count} readings left out: no usable range or angle ({first})");
    about(kinds::SURVEY_READINGS_UNUSABLE, file, message).count("readings", count)
}

/// `first` describes the first of them.
pub fn survey_points_inconsistent(file: &str, count: usize, first: &str) -> Finding {
    let message = format!(
        "{count} points left out: their readings are of different points ({first}); give each point its own name, and \
         each set-up its own file"
    );
    about(kinds::SURVEY_POINTS_INCONSISTENT, file, message).count("points", count)
}

pub fn survey_angles_seem_elevations(file: &str) -> Finding {
    let message = "the vertical angles seem to be elevations, but are read as zenith angles: half of the points would \
                   be within 30° of the zenith";
    about(kinds::SURVEY_ANGLES_SEEM_ELEVATIONS, file, message)
}

/// `lines` names the records of further set-ups: "lines" or "readings".
pub fn survey_other_set_ups(file: &str, count: usize, lines: &str) -> Finding {
    let message = format!(
        "{count} {lines} of further set-ups left out: a file may hold one set-up of one station; save each set-up in \
         its own file"
    );
    about(kinds::SURVEY_OTHER_SET_UPS, file, message).count("readings", count)
}

/// `missing` names what the readings lack.
pub fn survey_readings_incomplete(file: &str, count: usize, missing: &str) -> Finding {
    let message = format!("{count} readings without {missing} left out");
    about(kinds::SURVEY_READINGS_INCOMPLETE, file, message).count("readings", count)
}

pub fn survey_points_deleted(file: &str, count: usize) -> Finding {
    let message = format!("{count} points left out: deleted in the job");
    about(kinds::SURVEY_POINTS_DELETED, file, message).count("points", count)
}

pub fn survey_prism_constant_missing(file: &str, count: usize) -> Finding {
    let message = format!("{count} readings without a prism constant; the deployment's is added");
    about(kinds::SURVEY_PRISM_CONSTANT_MISSING, file, message).count("readings", count)
}

/// `constants_m` are the different constants that the file states (m).
pub fn survey_prism_constant_included(file: &str, constants_m: &[f64]) -> Finding {
    let stated: Vec<String> = constants_m.iter().map(|m| format!("{:+.1}", m * 1e3)).collect();
    let stated = if stated.is_empty() {
        "not stated in the file".to_owned()
    } else {
        format!("{} mm by words 51 and 58", stated.join(", "))
    };
    let message = format!(
        "the slope distances already include the instrument's prism constant ({stated}); nothing is added"
    );
    about(kinds::SURVEY_PRISM_CONSTANT_INCLUDED, file, message)
}

/// `constants` are the different constants (mm).
pub fn survey_prism_constants_added(file: &str, constants: &[String]) -> Finding {
    let message = format!(
        "the targets' prism constants ({} mm) are added to the distances; no other constant is added",
        constants.join(", ")
    );
    about(kinds::SURVEY_PRISM_CONSTANTS_ADDED, file, message)
}

pub fn survey_prism_constant_kept(file: &str) -> Finding {
    let message = "prism_constant_m is not added: the ranges have their own prism constants";
    about(kinds::SURVEY_PRISM_CONSTANT_KEPT, file, message)
}

pub fn survey_empty(file: &str) -> Finding {
    about(kinds::SURVEY_EMPTY, file, "no usable reading")
}

pub fn survey_coordinates_left_out(file: &str) -> Finding {
    let message = "coordinates without readings are left out; if they are surveyed, add this file to control_points \
                   in deployment.toml";
    about(kinds::SURVEY_COORDINATES_LEFT_OUT, file, message)
}

pub fn survey_station_unknown(file: &str) -> Finding {
    let message = "left out: its station is unknown; end the file name with the station number, or list the files of \
                   stations 1, 2, … in deployment.toml: surveys = [\"…\", \"…\", …]";
    about(kinds::SURVEY_STATION_UNKNOWN, file, message)
}

pub fn survey_station_repeated(file: &str, other: &str) -> Finding {
    let message = format!("left out: {other} is of the same station");
    about(kinds::SURVEY_STATION_REPEATED, file, message)
}

/// `names` are the first names in order; `more` is true if further names follow.
pub fn survey_points_numbered(file: &str, names: &[&str], more: bool) -> Finding {
    let more = if more { ", …" } else { "" };
    let message = format!("points are numbered in order of appearance: {}{more}", names.join(", "));
    about(kinds::SURVEY_POINTS_NUMBERED, file, message)
}

pub(super) fn examples() -> Vec<Finding> {
    let file = "station1.gsi";
    vec![
        survey_readings_unusable(file, 2, "P1: 0 m"),
        survey_points_inconsistent(file, 1, "P1: 2 up to 1.99 m apart"),
        survey_angles_seem_elevations(file),
        survey_other_set_ups(file, 2, "lines"),
        survey_readings_incomplete(file, 3, "a distance or an angle"),
        survey_points_deleted(file, 1),
        survey_prism_constant_missing(file, 4),
        survey_prism_constant_included(file, &[0.0175]),
        survey_prism_constants_added(file, &["+17.5".to_owned()]),
        survey_prism_constant_kept(file),
        survey_empty(file),
        survey_coordinates_left_out(file),
        survey_station_unknown("points.gsi"),
        survey_station_repeated(file, "station1b.gsi"),
        survey_points_numbered(file, &["A", "B"], false),
    ]
}
