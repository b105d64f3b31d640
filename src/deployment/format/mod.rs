//! The file formats: one file each, and [`recognise`], the one place that tells them apart.
//!
//! Readers take text (or, for bags, a path) and give data plus findings; which file plays which part in
//! a deployment is decided in [`super::open`].

pub mod control_points;
pub mod deployment_toml;
pub mod pillars;
pub mod polar_csv;
pub mod rig_files;
pub mod ros1_bag;
pub mod rtklib_pos;
pub mod surveyed_points;
mod table;

use std::path::PathBuf;

use crate::progress::Cancelled;

/// Why a file or folder did not become a deployment: what, where, and what to do about it.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    #[error("{}: {error}; check the path and its permissions", path.display())]
    Io { path: PathBuf, error: std::io::Error },
    #[error("{file}: {what}; {remedy}")]
    File { file: String, what: String, remedy: String },
    #[error("{file}:{line}: {what}; {remedy}")]
    Line { file: String, line: usize, what: String, remedy: String },
    /// By who asked for it: not to be shown as an error.
    #[error("cancelled")]
    Cancelled,
}

impl From<Cancelled> for OpenError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl OpenError {
    pub fn file(file: &str, what: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self::File { file: file.to_owned(), what: what.into(), remedy: remedy.into() }
    }

    pub fn line(
        file: &str,
        line: usize,
        what: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        Self::Line { file: file.to_owned(), line, what: what.into(), remedy: remedy.into() }
    }
}

/// What some editors put before UTF-8 text.
pub const BYTE_ORDER_MARK: char = '\u{feff}';

/// What a file holds, judged by its content.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    PolarCsv,
    Ros1Bag,
    ControlPoints,
    Pillars,
    SurveyedPoints,
    RigReading,
    RigDistances,
    RtklibPos,
    DeploymentToml,
    /// A known kind of file that is not read, and why.
    Ignored(&'static str),
}

impl Format {
    /// The part it plays, in words.
    pub fn describe(self) -> &'static str {
        match self {
            Self::PolarCsv => "polar measurements of the three stations (CSV)",
            Self::Ros1Bag => "polar measurements of the three stations (ROS 1 bag)",
            Self::ControlPoints => "control points",
            Self::Pillars => "surveyed pillars",
            Self::SurveyedPoints => "coordinates of control points",
            Self::RigReading => "a static station's reading of the rig",
            Self::RigDistances => "inter-prism distances",
            Self::RtklibPos => "positions of a GNSS antenna (RTKLIB)",
            Self::DeploymentToml => "overrides",
            Self::Ignored(why) => why,
        }
    }

    /// Whether it holds the stations' tracks.
    pub fn is_track(self) -> bool {
        matches!(self, Self::PolarCsv | Self::Ros1Bag)
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
    if head.starts_with(b"#ROSBAG") {
        return Format::Ros1Bag;
    }
    if head.starts_with(b"SQLite format 3\0") || head.starts_with(b"\x89MCAP0") {
        return Format::Ignored(
            "ROS 2 bag: not read yet; convert it to a ROS 1 bag or to polar CSV",
        );
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
    if table::header_has(first, &polar_csv::COLUMNS) {
        Format::PolarCsv
    } else if table::header_has(first, &control_points::COLUMNS[..2]) {
        Format::ControlPoints
    } else if table::header_has(first, &pillars::COLUMNS) {
        Format::Pillars
    } else if table::header_has(first, &surveyed_points::COLUMNS) {
        Format::SurveyedPoints
    } else {
        match (numeric_fields(first), lines.next()) {
            (Some(15), _) => Format::RigReading,
            (Some(3 | 6), None) => Format::RigDistances,
            (Some(4), _) => Format::Ignored(
                "Cartesian track, already turned into another frame: not read; use the polar measurements",
            ),
            _ => Format::Ignored("not recognised"),
        }
    }
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
        assert!(matches!(recognise("x.csv", b"1657 1.0 2.0 3.0\n"), Format::Ignored(_)));
        assert!(matches!(
            recognise("notes.txt", b"it rained\n"),
            Format::Ignored("not recognised")
        ));
    }
}
