//! `deployment.toml`: what the user knows better than any guess.

use serde::Deserialize;

use super::OpenError;

/// Overrides; a key that is absent leaves the guess alone.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Overrides {
    pub name: Option<String>,
    /// The file with the stations' tracks, where a folder holds several.
    pub tracks: Option<String>,
    /// Added to every range of tracks, control points and rig reading (m).
    pub prism_constant_m: Option<f64>,
    /// α, β, γ (m).
    pub inter_prism_m: Option<[f64; 3]>,
    /// How many prisms the stations follow: 1 (all the same) or 3 (each its own); recognised if absent.
    pub prisms: Option<u8>,
    /// Prisms 1, 2, 3 in the vehicle's frame (m): what a trajectory is the trajectory of.
    pub prisms_m: Option<[[f64; 3]; 3]>,
    /// RTKLIB solution files of antennas 1, 2, 3, where their names do not tell.
    pub gnss: Option<[String; 3]>,
    /// The control-point files to use.
    pub control_points: Option<Vec<String>>,
}

pub fn read(file: &str, text: &str) -> Result<Overrides, OpenError> {
    parse_toml(file, text)
}

/// Any TOML file of the program, with the line of its first mistake.
pub fn parse_toml<T: serde::de::DeserializeOwned>(file: &str, text: &str) -> Result<T, OpenError> {
    toml::from_str(text).map_err(|error| {
        let line = error.span().map_or(1, |span| text[..span.start].matches('\n').count() + 1);
        let what = error.message().lines().next().unwrap_or("not valid TOML");
        OpenError::line(file, line, what, "correct the line")
    })
}
