//! Files and overrides that the user names beside a deployment.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use resect_core::deployment::Overrides;

/// Additions of the user to a deployment's folder: further files, and overrides.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Extras {
    /// Folder or file that describes the rig, replacing the folder's own description and that of `deployment.toml`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rig: Option<PathBuf>,
    /// Files of control points, of pillars, or of coordinates of control points.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub gcp: Vec<PathBuf>,
    /// True if the files in `gcp` replace those of the folder; otherwise they are added.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub gcp_instead: bool,
    /// RTKLIB solutions of antennas 1, 2, 3, replacing those of the folder.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub gnss: Vec<PathBuf>,
    /// Folders or files of further drives with unmoved stations: all are solved together, each with its own clocks. A rig and
    /// overrides named here apply to all drives.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub drives: Vec<PathBuf>,
    /// Overrides of the user, which take precedence over `deployment.toml`.
    #[serde(skip_serializing_if = "Overrides::is_empty")]
    pub corrections: Overrides,
}

impl Extras {
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Merges further extras: control points are added, everything else is replaced.
    pub fn add(&mut self, other: Self) {
        if other.rig.is_some() {
            self.rig = other.rig;
        }
        if !other.gnss.is_empty() {
            self.gnss = other.gnss;
        }
        if !other.corrections.is_empty() {
            self.corrections = other.corrections.over(std::mem::take(&mut self.corrections));
        }
        if other.gcp_instead {
            self.gcp.clear();
            self.gcp_instead = true;
        }
        for (own, others) in [(&mut self.gcp, other.gcp), (&mut self.drives, other.drives)] {
            for path in others {
                if !own.contains(&path) {
                    own.push(path);
                }
            }
        }
    }
}
