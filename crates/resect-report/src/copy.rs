//! The transforms of an answer in the formats that other programs read from the clipboard.
//!
//! All map the frame of station 2, 3, … to station 1's: p₁ = R p₂ + t, lengths in m, angles in rad. Numbers have the
//! digits for 1 nm and 1 nrad. A copy states a verdict other than `good`, in a comment if the format has comments.

use std::fmt::Write;

use serde::Serialize;
use serde_json::json;

use super::json::{SCHEMA, transform_of};
use super::named_transform::{NamedTransform, TransformFormat, one_line, transforms_text};
use super::summary::{ResultSummary, StationSummary};
use resect_core::calibration::Verdict;

/// Format of a copy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CopyFormat {
    Toml,
    /// The transforms as in the output of `calibrate --json`.
    Json,
    Transforms(TransformFormat),
}

impl CopyFormat {
    pub const ALL: [Self; 8] = [
        Self::Toml,
        Self::Json,
        Self::Transforms(TransformFormat::Matrix),
        Self::Transforms(TransformFormat::Quaternion),
        Self::Transforms(TransformFormat::Numpy),
        Self::Transforms(TransformFormat::Ros2),
        Self::Transforms(TransformFormat::Ros1),
        Self::Transforms(TransformFormat::Urdf),
    ];

    /// Returns the name of the format in a menu.
    pub fn title(self) -> &'static str {
        match self {
            Self::Toml => "TOML",
            Self::Json => "JSON",
            Self::Transforms(format) => format.title(),
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

/// Returns the text for the clipboard.
pub fn text(format: CopyFormat, summary: &ResultSummary, copied: CopiedTransforms) -> String {
    let stations = copied.of(summary);
    match format {
        CopyFormat::Toml => toml(summary, stations),
        CopyFormat::Json => json(summary, stations),
        CopyFormat::Transforms(format) => {
            let transforms: Vec<NamedTransform> = stations.iter().map(named).collect();
            transforms_text(format, &origin(summary), &transforms)
        }
    }
}

fn named(station: &StationSummary) -> NamedTransform {
    NamedTransform {
        name: station.name(),
        maps: format!("station {} into station 1", station.station),
        parent: "station1".to_owned(),
        child: format!("station{}", station.station),
        parent_from_child: station.station1_from_station(),
    }
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
