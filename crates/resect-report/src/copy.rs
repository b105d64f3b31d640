//! The transforms of an answer in the formats that other programs read from the clipboard.
//!
//! All map the frame of station 2, 3, … to station 1's: p₁ = R p₂ + t, lengths in m, angles in rad. Numbers have the
//! digits for 1 nm and 1 nrad. A copy states a verdict other than `good`, in a comment if the format has comments.

use std::fmt::Write;

use serde::Serialize;
use serde_json::json;

use super::json::{SCHEMA, transform_of};
use super::summary::{ResultSummary, StationSummary};
use resect_core::calibration::Verdict;

/// Format of a copy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CopyFormat {
    Toml,
    /// The transforms as in the output of `calibrate --json`.
    Json,
    /// Homogeneous matrices of four rows.
    Matrix,
    /// One line `x y z qx qy qz qw` for each transform.
    Quaternion,
    /// Homogeneous matrices in Python's syntax.
    Numpy,
    /// A shell command: `ros2 run tf2_ros static_transform_publisher`, with named arguments.
    Ros2,
    /// A shell command: `rosrun tf2_ros static_transform_publisher`, with arguments in order.
    Ros1,
    /// Fixed joints of a robot description (XML).
    Urdf,
}

impl CopyFormat {
    pub const ALL: [Self; 8] = [
        Self::Toml,
        Self::Json,
        Self::Matrix,
        Self::Quaternion,
        Self::Numpy,
        Self::Ros2,
        Self::Ros1,
        Self::Urdf,
    ];

    /// Returns the name of the format in a menu.
    pub fn title(self) -> &'static str {
        match self {
            Self::Toml => "TOML",
            Self::Json => "JSON",
            Self::Matrix => "4×4 matrix",
            Self::Quaternion => "x y z qx qy qz qw",
            Self::Numpy => "numpy",
            Self::Ros2 => "ROS 2 static_transform_publisher",
            Self::Ros1 => "ROS 1 static_transform_publisher",
            Self::Urdf => "URDF joints",
        }
    }
}

/// Transforms to copy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum CopiedTransforms {
    #[default]
    All,
    /// That of one station, from 2 on.
    Station(usize),
}

impl CopiedTransforms {
    /// Returns the choices for a result: all, then each.
    pub fn choices(summary: &ResultSummary) -> impl Iterator<Item = Self> {
        let each = summary.stations.iter().map(|one| Self::Station(one.station));
        std::iter::once(Self::All).chain(each)
    }

    /// Returns the name in a menu.
    pub fn title(self, summary: &ResultSummary) -> String {
        match (self, &summary.stations[..]) {
            (Self::Station(station), _) => format!("T1{station}"),
            (Self::All, [first, second]) => format!("{} and {}", first.name(), second.name()),
            (Self::All, _) => "all".to_owned(),
        }
    }

    fn of(self, summary: &ResultSummary) -> &[StationSummary] {
        let stations = &summary.stations;
        match self {
            Self::All => stations,
            Self::Station(number) => {
                let own = stations.iter().position(|one| one.station == number);
                own.map_or(&[], |own| &stations[own..=own])
            }
        }
    }
}

/// The parent of tf is the frame to which points are mapped.
const PARENT: &str = "Parent station1, lengths in m";

/// Returns the text for the clipboard.
pub fn text(format: CopyFormat, summary: &ResultSummary, copied: CopiedTransforms) -> String {
    let stations = copied.of(summary);
    match format {
        CopyFormat::Toml => toml(summary, stations),
        CopyFormat::Json => json(summary, stations),
        CopyFormat::Matrix => {
            commented(summary, "Rows of [R t; 0 1], t in m", stations, |text, station| {
                _ = writeln!(text, "# {}", maps(station));
                for row in matrix(station) {
                    _ = writeln!(text, "{}", row.map(|cell| format!("{cell:>15}")).join(" "));
                }
            })
        }
        CopyFormat::Quaternion => {
            commented(summary, "x y z (m) qx qy qz qw", stations, |text, station| {
                _ = writeln!(text, "# {}", maps(station));
                _ = writeln!(text, "{}", pose(station).join(" "));
            })
        }
        CopyFormat::Numpy => commented(summary, "[R t; 0 1], t in m", stations, |text, station| {
            _ = writeln!(text, "# {}", maps(station));
            _ = writeln!(text, "{} = np.array([", station.name());
            for row in matrix(station) {
                let cells = row.map(|cell| format!("{cell:>15}"));
                _ = writeln!(text, "    [{}],", cells.join(", "));
            }
            text.push_str("])\n");
        }),
        CopyFormat::Ros2 => commented(summary, PARENT, stations, |text, station| {
            let [x, y, z, qx, qy, qz, qw] = pose(station);
            _ = writeln!(
                text,
                "ros2 run tf2_ros static_transform_publisher --x {x} --y {y} --z {z} --qx {qx} --qy {qy} --qz {qz} \
                 --qw {qw} --frame-id station1 --child-frame-id station{}",
                station.station
            );
        }),
        CopyFormat::Ros1 => commented(summary, PARENT, stations, |text, station| {
            _ = writeln!(
                text,
                "rosrun tf2_ros static_transform_publisher {} station1 station{}",
                pose(station).join(" "),
                station.station
            );
        }),
        CopyFormat::Urdf => urdf(summary, stations),
    }
}

/// Writes joints whose origin is the pose of the child's frame in the parent's. `rpy` are rotations about the parent's
/// fixed x, y and z axes in that order (URDF specification, element `origin`).
fn urdf(summary: &ResultSummary, stations: &[StationSummary]) -> String {
    let mut text = String::new();
    for line in origin(summary).lines() {
        // Two hyphens would end the comment, so a space separates them. A single one, as in a date, stays.
        let mut said = line.trim_start_matches(['#', ' ']).to_owned();
        while said.contains("--") {
            said = said.replace("--", "- -");
        }
        _ = writeln!(text, "<!-- {said} -->");
    }
    for station in stations {
        let transform = station.station1_from_station();
        let [x, y, z] = station.translation_m.map(digits);
        let (roll, pitch, yaw) = transform.rotation.euler_angles();
        let [roll, pitch, yaw] = [roll, pitch, yaw].map(digits);
        let number = station.station;
        _ = write!(
            text,
            "<joint name=\"station1_station{number}\" type=\"fixed\">\n  <parent link=\"station1\"/>\n  \
             <child link=\"station{number}\"/>\n  <origin xyz=\"{x} {y} {z}\" rpy=\"{roll} {pitch} {yaw}\"/>\n</joint>\n"
        );
    }
    text
}

/// Writes the common comments, then each transform.
fn commented(
    summary: &ResultSummary,
    what: &str,
    stations: &[StationSummary],
    write: impl Fn(&mut String, &StationSummary),
) -> String {
    let mut text = origin(summary);
    _ = writeln!(text, "# {what}");
    stations.iter().for_each(|station| write(&mut text, station));
    text
}

/// Returns comments with the origin of the numbers and the doubts about them.
fn origin(summary: &ResultSummary) -> String {
    let ResultSummary { deployment, verdict, doubts, .. } = summary;
    let mut text = format!(
        "# {}: {}, verdict {}\n",
        one_line(deployment),
        summary.answered_by().in_words(),
        summary.verdict_in_words()
    );
    if *verdict != Verdict::Good {
        _ = writeln!(text, "# WARNING: verdict {}", verdict.name().to_uppercase());
        for doubt in doubts {
            _ = writeln!(text, "#   {}", one_line(doubt));
        }
    }
    text
}

/// Replaces control characters: copies are pasted into shells, where a name must not begin a line of its own.
fn one_line(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

fn maps(station: &StationSummary) -> String {
    format!("{}: station {} into station 1", station.name(), station.station)
}

/// Formats a value to 1e-9, without negative zeros.
fn digits(value: f64) -> String {
    let text = format!("{value:.9}");
    if text == "-0.000000000" { "0.000000000".to_owned() } else { text }
}

fn matrix(station: &StationSummary) -> [[String; 4]; 4] {
    let matrix = station.station1_from_station().matrix();
    std::array::from_fn(|row| std::array::from_fn(|column| digits(matrix[(row, column)])))
}

/// Returns the numbers x, y, z, qx, qy, qz, qw of a transform.
fn pose(station: &StationSummary) -> [String; 7] {
    let ([x, y, z], [qx, qy, qz, qw]) = (station.translation_m, station.quaternion_xyzw);
    [x, y, z, qx, qy, qz, qw].map(digits)
}

fn json(summary: &ResultSummary, stations: &[StationSummary]) -> String {
    let transforms: Vec<_> = stations
        .iter()
        .map(|one| transform_of(one.station, &one.station1_from_station(), one.transform_sigma()))
        .collect();
    let value = json!({
        "schema": SCHEMA,
        "deployment": summary.deployment,
        "method": summary.answered_by().name(),
        "transforms": transforms,
        "diagnosis": {
            "verdict": summary.verdict,
            "independently_checked": summary.independently_checked,
            // A summary has only the messages of its findings.
            "findings": summary.doubts.iter().map(|doubt| json!({ "message": doubt })).collect::<Vec<_>>(),
        },
    });
    format!("{value:#}\n")
}

#[derive(Serialize)]
struct TomlCopy<'a> {
    deployment: &'a str,
    method: &'a str,
    verdict: Verdict,
    independently_checked: bool,
    transforms: Vec<TomlTransform>,
}

#[derive(Serialize)]
struct TomlTransform {
    from: usize,
    to: usize,
    translation_m: [f64; 3],
    yaw_rad: f64,
    quaternion_xyzw: [f64; 4],
    sigma: Option<TomlSigma>,
}

#[derive(Serialize)]
struct TomlSigma {
    translation_m: [f64; 3],
    yaw_rad: f64,
}

fn toml(summary: &ResultSummary, stations: &[StationSummary]) -> String {
    let copy = TomlCopy {
        deployment: &summary.deployment,
        method: summary.answered_by().name(),
        verdict: summary.verdict,
        independently_checked: summary.independently_checked,
        transforms: stations
            .iter()
            .map(|one| TomlTransform {
                from: one.station,
                to: 1,
                translation_m: one.translation_m,
                yaw_rad: one.yaw_rad(),
                quaternion_xyzw: one.quaternion_xyzw,
                sigma: one
                    .sigma
                    .map(|[x, y, z, yaw_rad]| TomlSigma { translation_m: [x, y, z], yaw_rad }),
            })
            .collect(),
    };
    // TOML can represent plain strings and numbers, so this does not fail.
    let body = toml::to_string(&copy).unwrap_or_else(|error| format!("# {error}\n"));
    format!("{}# Lengths in m, angles in rad; p1 = R p + t\n{body}", origin(summary))
}

#[cfg(test)]
mod tests;
