//! Findings about tracks that are positions, and the transforms that were applied to them.

use resect_core::deployment::{Finding, FindingKind, Message, Subject, ToldAngle, ToldIn, Unit};

pub fn tracks_in_station_frames() -> Finding {
    Finding::new(
        FindingKind::TracksInStationFrames,
        "the tracks are positions, each in its station's own frame; prism constants are in them",
    )
}

pub fn tracks_in_common_frame() -> Finding {
    Finding::new(
        FindingKind::TracksInCommonFrame,
        "the tracks were turned into one frame before they were written, and what turned them is not known: C and D give \
         what is left to turn in that frame (compose it with what was applied for the stations' own), A and B are about \
         the stations' own frames and are not compared with the drive; the outlier filter sees rates about the origin of \
         that frame, which for stations 2 and 3 is not the instrument; and a rigid transform may have tilted a station by \
         more than its compensator leaves",
    )
}

/// `line` is where the set of transforms begins.
pub fn track_transform_inverted(file: &str, line: usize) -> Finding {
    Finding::new(
        FindingKind::TrackTransformInverted,
        format!(
            "the tracks were turned into one frame with the transforms of {file} (from line {line}) before they were written; \
             this is undone, so ranges and angles are the instruments' again. That their ranges then come in steps shows them \
             to be the ones, to about half a millimetre"
        ),
    )
    .about(Subject::File(file.to_owned()))
}

pub fn transforms_unreadable(file: &str, error: &str) -> Finding {
    Finding::new(FindingKind::TransformsUnreadable, error).about(Subject::File(file.to_owned()))
}

/// `sets` of transforms were tried, the first in `first`.
pub fn transforms_not_confirmed(first: &str, files: usize, sets: usize) -> Finding {
    let more = match files - 1 {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    Finding::new(
        FindingKind::TransformsNotConfirmed,
        format!(
            "none of the {sets} sets of transforms in {first}{more} is shown to be the one that was applied: undone, the \
             ranges do not come in the steps of an instrument"
        ),
    )
    .about(Subject::File(first.to_owned()))
    .count("sets", sets)
}

pub fn transform_tilts_station(file: &str, station: usize, tilt_rad: f64) -> Finding {
    let message = Message::from(format!("{file} tilts station {} by ", station + 1))
        .angle(ToldAngle::size(tilt_rad, ToldIn::Arcseconds, 0))
        .text(
            ", more than a compensator leaves; whoever uses the tracks as published has that in them",
        );
    Finding::new(FindingKind::TransformTiltsStation, message)
        .about(Subject::Station(station))
        .quantity("tilt", tilt_rad, Unit::Radian)
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
