//! Findings about tracks given as positions, and the transforms that were applied to them.

use crate::findings::kinds;
use resect_core::deployment::{AngleFormat, Finding, Message, MessageAngle, Subject, Unit};

pub fn tracks_in_station_frames() -> Finding {
    Finding::new(
        kinds::TRACKS_IN_STATION_FRAMES,
        "the tracks are positions in each station's own frame and include the prism constants",
    )
}

pub fn tracks_in_common_frame() -> Finding {
    Finding::new(
        kinds::TRACKS_IN_COMMON_FRAME,
        "the tracks were transformed into one frame with unknown transforms before they were written. C and D \
         estimate the remaining transforms in that frame; compose them with the applied ones for the stations' own. A \
         and B refer to the stations' own frames and are not compared with the drive. The outlier filter uses rates \
         about the origin of that frame, not about the instruments 2, 3, …. A rigid transform may have tilted a station \
         beyond the accuracy of its compensator",
    )
}

/// `line` is the first line of the set of transforms.
pub fn track_transform_inverted(file: &str, line: usize) -> Finding {
    Finding::new(
        kinds::TRACK_TRANSFORM_INVERTED,
        format!(
            "the tracks were written in one frame, and the transforms of {file} (from line {line}) are undone: ranges \
             and angles are the instruments' again. The ranges then have the instruments' step size, which confirms \
             the transforms to about half a millimetre"
        ),
    )
    .about(Subject::File(file.to_owned()))
}

pub fn transforms_unreadable(file: &str, error: &str) -> Finding {
    Finding::new(kinds::TRANSFORMS_UNREADABLE, error).about(Subject::File(file.to_owned()))
}

/// `sets` is the number of sets tried; `first` is the first of the `files` that contain them.
pub fn transforms_not_confirmed(first: &str, files: usize, sets: usize) -> Finding {
    let more = match files - 1 {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    Finding::new(
        kinds::TRANSFORMS_NOT_CONFIRMED,
        format!(
            "none of the {sets} sets of transforms in {first}{more} is confirmed as the applied one: undoing it gives \
             ranges without an instrument's step size"
        ),
    )
    .about(Subject::File(first.to_owned()))
    .count("sets", sets)
}

pub fn transform_tilts_station(file: &str, station: usize, tilt_rad: f64) -> Finding {
    let message = Message::from(format!("{file} tilts station {} by ", station + 1))
        .angle(MessageAngle::size(tilt_rad, AngleFormat::Arcseconds, 0))
        .text(", beyond the accuracy of a compensator; the published tracks contain this tilt");
    Finding::new(kinds::TRANSFORM_TILTS_STATION, message).about(Subject::Station(station)).quantity(
        "tilt",
        tilt_rad,
        Unit::Radian,
    )
}

pub(super) fn examples() -> Vec<Finding> {
    vec![
        tracks_in_station_frames(),
        tracks_in_common_frame(),
        track_transform_inverted("transforms.csv", 3),
        transforms_unreadable("transforms.csv", "transforms.csv:3: not a number"),
        transforms_not_confirmed("transforms.csv", 2, 4),
        transform_tilts_station("transforms.csv", 1, 2e-4),
    ]
}
