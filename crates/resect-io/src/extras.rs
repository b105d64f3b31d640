//! Files and overrides that the user names beside a deployment.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use resect_core::deployment::Overrides;

/// What the user adds to what lies with the tracks: further files, and what is put right.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Extras {
    /// Folder or file that describes the rig, instead of what lies with the tracks and of `deployment.toml`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rig: Option<PathBuf>,
    /// Files of control points, of pillars, or of coordinates of control points.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub gcp: Vec<PathBuf>,
    /// Whether those of `gcp` are used instead of what lies with the tracks; otherwise they are added to it.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub gcp_instead: bool,
    /// RTKLIB solutions of antennas 1, 2, 3, instead of what lies with the tracks.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub gnss: Vec<PathBuf>,
    /// Folders or files of further drives, with stations that nobody moved: they are solved together, each with its own
    /// clocks. A rig that is named, and what is put right, is said of all drives.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub drives: Vec<PathBuf>,
    /// What the user says of the data, over what `deployment.toml` says.
    #[serde(skip_serializing_if = "Overrides::is_empty")]
    pub put_right: Overrides,
}

impl Extras {
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Takes further files in: control points beside those that are there, everything else instead.
    pub fn add(&mut self, other: Self) {
        if other.rig.is_some() {
            self.rig = other.rig;
        }
        if !other.gnss.is_empty() {
            self.gnss = other.gnss;
        }
        if !other.put_right.is_empty() {
            self.put_right = other.put_right.over(std::mem::take(&mut self.put_right));
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
