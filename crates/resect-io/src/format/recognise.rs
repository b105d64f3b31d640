//! Telling formats apart, by content.

use super::{
    applied_transforms, bag, bonn_csv, cartesian_tracks, control_points, estimate, gsi, jobxml,
    mapped_csv, pillars, polar_csv, rig_files, rtklib_pos, surveyed_points, table,
};

/// The key that a session begins with; its value is the version of the format.
pub const SESSION_KEY: &str = "resect_session";
/// What some editors put before UTF-8 text.
pub const BYTE_ORDER_MARK: char = '\u{feff}';

/// What a file holds, judged by its content.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    PolarCsv,
    /// Cartesian track of one station; three make a deployment.
    CartesianTrack,
    /// What Cartesian tracks were turned with.
    AppliedTransforms,
    /// Track of one station of Bonn's network.
    BonnCsv,
    /// A header that no reader knows above numbers: tracks, once the user says which column is what.
    UnknownTable,
    Ros1Bag,
    Ros2Sqlite,
    Mcap,
    /// `metadata.yaml` of a ROS 2 bag, which stands for its folder.
    RosbagMetadata,
    ControlPoints,
    /// Readings of one instrument.
    Gsi,
    /// Readings of one instrument, as JobXML.
    JobXml,
    Pillars,
    SurveyedPoints,
    RigReading,
    SensorPositions,
    RigDistances,
    RtklibPos,
    DeploymentToml,
    /// A trajectory that another system estimated: no part of a deployment, but judged by one.
    Estimate,
    /// A file or folder that its permissions or the disk keep from being read.
    Unreadable,
    /// A known kind of file that is not read, and why.
    Ignored(&'static str),
}

impl Format {
    /// The part it plays, in words.
    pub fn describe(self) -> &'static str {
        match self {
            Self::PolarCsv => "polar measurements of the three stations (CSV)",
            Self::BonnCsv => "polar measurements of one station (CSV of Bonn's rts-network)",
            Self::UnknownTable => "a table whose columns no reader knows",
            Self::CartesianTrack => "positions of one station's prism",
            Self::AppliedTransforms => "transforms applied to positions",
            Self::Ros1Bag => "measurements of the three stations (ROS 1 bag)",
            Self::Ros2Sqlite => "measurements of the three stations (ROS 2 bag, SQLite)",
            Self::Mcap => "measurements of the three stations (MCAP bag)",
            Self::RosbagMetadata => "what a ROS 2 bag says of its files",
            Self::ControlPoints => "control points",
            Self::Gsi => {
                "one instrument's readings of points (Leica GSI); its stamps are whole seconds, so no track"
            }
            Self::JobXml => {
                "one instrument's readings of points (JobXML); its stamps are whole seconds, so no track"
            }
            Self::Pillars => "surveyed pillars",
            Self::SurveyedPoints => "coordinates of control points",
            Self::RigReading => "a static station's reading of the rig",
            Self::SensorPositions => "positions of the prisms and sensors on the vehicle",
            Self::RigDistances => "inter-prism distances",
            Self::RtklibPos => "positions of a GNSS antenna (RTKLIB)",
            Self::DeploymentToml => "overrides",
            Self::Estimate => "a trajectory of another system; `resect evaluate` judges it",
            Self::Unreadable => "cannot be read",
            Self::Ignored(why) => why,
        }
    }

    /// Whether it holds the stations' tracks.
    pub fn is_track(self) -> bool {
        matches!(self, Self::PolarCsv | Self::BonnCsv | Self::CartesianTrack) || self.is_bag()
    }

    /// Whether it is a recording of ROS 1 or ROS 2.
    pub fn is_bag(self) -> bool {
        matches!(self, Self::Ros1Bag | Self::Ros2Sqlite | Self::Mcap)
    }

    /// Whether it holds tracks, or may do so once the user says which column is what.
    pub fn may_be_track(self) -> bool {
        self.is_track() || self == Self::UnknownTable
    }
}

/// Recognises a file from its name's last part (only for TOML, which says what it is by name) and its first
/// bytes; a few hundred are enough.
pub fn recognise(file_name: &str, head: &[u8]) -> Format {
    match file_name {
        "deployment.toml" => return Format::DeploymentToml,
        "truth.toml" => return Format::Ignored("truth of a simulation: never read to calibrate"),
        _ => {}
    }
    if let Some(format) = bag::recognise(head) {
        return format;
    }
    let text = String::from_utf8_lossy(head);
    let text = text.trim_start_matches(BYTE_ORDER_MARK);
    if rtklib_pos::looks_like(text) {
        return Format::RtklibPos;
    }
    let mut lines = text.lines().filter(|line| !line.trim().is_empty());
    let Some(first) = lines.next() else {
        return Format::Ignored("empty");
    };
    if first.starts_with(SESSION_KEY) {
        return Format::Ignored("a session: `resect FILE` opens it");
    }
    if jobxml::looks_like(text) {
        Format::JobXml
    } else if gsi::looks_like(first) {
        Format::Gsi
    } else if table::header_has(first, &polar_csv::COLUMNS) {
        Format::PolarCsv
    } else if table::header_has(first, &bonn_csv::COLUMNS) {
        Format::BonnCsv
    } else if table::header_has(first, &control_points::COLUMNS[..2]) {
        Format::ControlPoints
    } else if table::header_has(first, &pillars::COLUMNS) {
        Format::Pillars
    } else if table::header_has(first, &surveyed_points::COLUMNS) {
        Format::SurveyedPoints
    } else if !is_applied_transforms(first) && estimate::looks_like(text) {
        Format::Estimate
    } else if mapped_csv::looks_like(text) {
        Format::UnknownTable
    } else {
        match (numeric_fields(first), lines.next()) {
            (Some(15), _) => Format::RigReading,
            (Some(3 | 6), None) => Format::RigDistances,
            (Some(4), _) if cartesian_tracks::evenly_spaced(text) => {
                Format::Ignored("positions at even steps of time: interpolated, not measured")
            }
            (Some(4), _) => Format::CartesianTrack,
            _ if is_applied_transforms(first) => Format::AppliedTransforms,
            (Some(13), _) if rig_files::is_sensor_position(first) => Format::SensorPositions,
            _ => Format::Ignored("not recognised"),
        }
    }
}

/// Whether a line is what Cartesian tracks were turned with, which are rows of matrices as KITTI's poses are.
fn is_applied_transforms(line: &str) -> bool {
    numeric_fields(line) == Some(applied_transforms::FIELDS) && applied_transforms::looks_like(line)
}

/// Number of white-space separated fields, if all are numbers.
fn numeric_fields(line: &str) -> Option<usize> {
    let fields: Vec<_> = line.split_whitespace().collect();
    fields.iter().all(|field| field.parse::<f64>().is_ok()).then_some(fields.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_told_apart_by_content() {
        let polar = b"timestamp,id,distance,ha,va\n1,1,2,3,1.5\n";
        assert_eq!(recognise("anything.txt", polar), Format::PolarCsv);
        assert_eq!(recognise("x", b"timestamp;id;distance;ha;va\n"), Format::PolarCsv);
        assert_eq!(
            recognise("x", b"theodolite_number , marker_number , status\n"),
            Format::ControlPoints
        );
        assert_eq!(recognise("x", b"0.7 0.9 1.0 0.7 0.8 0.5\n"), Format::RigDistances);
        assert_eq!(recognise("x", b"#ROSBAG V2.0\n"), Format::Ros1Bag);
        assert_eq!(recognise("x", b""), Format::Ignored("empty"));
        assert_eq!(recognise("x.csv", b"1657 1.0 2.0 3.0\n"), Format::CartesianTrack);
        assert!(matches!(
            recognise("notes.txt", b"it rained\n"),
            Format::Ignored("not recognised")
        ));
    }
}
