//! Findings about surveys: GSI and JobXML files of total stations.

use resect_core::deployment::{Finding, FindingKind, Subject};

fn about(kind: FindingKind, file: &str, message: impl AsRef<str>) -> Finding {
    Finding::new(kind, format!("{file}: {}", message.as_ref()))
        .about(Subject::File(file.to_owned()))
}

/// `first` are the first of them in words.
pub fn survey_readings_unusable(file: &str, count: usize, first: &str) -> Finding {
    let message = format!("{count} readings without a usable range or angle left out ({first})");
    about(FindingKind::SurveyReadingsUnusable, file, message).count("readings", count)
}

/// `first` are the first of them in words.
pub fn survey_points_inconsistent(file: &str, count: usize, first: &str) -> Finding {
    let message = format!(
        "{count} points left out, whose readings are not of one point ({first}); give different points different names, and \
         each set-up a file of its own"
    );
    about(FindingKind::SurveyPointsInconsistent, file, message).count("points", count)
}

pub fn survey_angles_seem_elevations(file: &str) -> Finding {
    let message = "half of the points would be within 30° of the zenith; its vertical angles seem to count from the horizon, \
                   but are read as zenith angles";
    about(FindingKind::SurveyAnglesSeemElevations, file, message)
}

/// `lines` names what the file has of further set-ups: "lines", "readings".
pub fn survey_other_set_ups(file: &str, count: usize, lines: &str) -> Finding {
    let message = format!(
        "{count} {lines} of further set-ups of the instrument left out; a file is one station in one place, so give each \
         set-up its own"
    );
    about(FindingKind::SurveyOtherSetUps, file, message).count("readings", count)
}

/// `missing` names what the readings lack.
pub fn survey_readings_incomplete(file: &str, count: usize, missing: &str) -> Finding {
    let message = format!("{count} readings without {missing} left out");
    about(FindingKind::SurveyReadingsIncomplete, file, message).count("readings", count)
}

pub fn survey_points_deleted(file: &str, count: usize) -> Finding {
    let message = format!("{count} points that were deleted in the job left out");
    about(FindingKind::SurveyPointsDeleted, file, message).count("points", count)
}

pub fn survey_prism_constant_missing(file: &str, count: usize) -> Finding {
    let message = format!(
        "{count} readings without a prism constant of their target; the deployment's is added"
    );
    about(FindingKind::SurveyPrismConstantMissing, file, message).count("readings", count)
}

/// `constants_m` are the different constants that the file states (m).
pub fn survey_prism_constant_included(file: &str, constants_m: &[f64]) -> Finding {
    let stated: Vec<String> = constants_m.iter().map(|m| format!("{:+.1}", m * 1e3)).collect();
    let stated = if stated.is_empty() {
        "which it does not state".to_owned()
    } else {
        format!("{} mm by words 51 and 58", stated.join(", "))
    };
    let message = format!(
        "the instrument added its prism constant ({stated}) to the slope distances; nothing is added to them again"
    );
    about(FindingKind::SurveyPrismConstantIncluded, file, message)
}

/// `constants` are the different constants (mm).
pub fn survey_prism_constants_added(file: &str, constants: &[String]) -> Finding {
    let message = format!(
        "the prism constants of its targets ({} mm) are added to its distances, and no other",
        constants.join(", ")
    );
    about(FindingKind::SurveyPrismConstantsAdded, file, message)
}

pub fn survey_prism_constant_kept(file: &str) -> Finding {
    let message = "prism_constant_m is not added to its ranges, which have their own";
    about(FindingKind::SurveyPrismConstantKept, file, message)
}

pub fn survey_empty(file: &str) -> Finding {
    about(FindingKind::SurveyEmpty, file, "no usable reading")
}

pub fn survey_coordinates_left_out(file: &str) -> Finding {
    let message = "coordinates without readings are left out; where they are surveyed ones, name it in control_points of \
                   deployment.toml";
    about(FindingKind::SurveyCoordinatesLeftOut, file, message)
}

pub fn survey_station_unknown(file: &str) -> Finding {
    let message = "left out, because it is not known which station read it; let its name end with the number of the station, \
                   or name the files of stations 1, 2, 3 in deployment.toml: surveys = [\"…\", \"…\", \"…\"]";
    about(FindingKind::SurveyStationUnknown, file, message)
}

pub fn survey_station_repeated(file: &str, other: &str) -> Finding {
    let message = format!("left out, because {other} is of the same station as well");
    about(FindingKind::SurveyStationRepeated, file, message)
}

/// `names` are the first names in their order; `more` follow them or not.
pub fn survey_points_numbered(file: &str, names: &[&str], more: bool) -> Finding {
    let more = if more { ", …" } else { "" };
    let message = format!("points are numbered in order of appearance: {}{more}", names.join(", "));
    about(FindingKind::SurveyPointsNumbered, file, message)
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
