//! The built-in deployments, written by `resect simulate` and read by the same readers as any other.

use serde::{Deserialize, Serialize};

use crate::error::OpenError;
use crate::open::open_files;
use resect_core::deployment::Deployment;

/// A built-in deployment. Regenerate with `crates/resect-io/assets/samples/regenerate`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sample {
    /// A Warthog-like rig on uneven ground, with control points.
    Warthog,
    /// A small HD2-like rig (0.35 m) in a tunnel.
    Hd2Tunnel,
}

macro_rules! sample_files {
    ($folder:literal: $($file:literal),+ $(,)?) => {
        &[$(($file, include_str!(concat!("../assets/samples/", $folder, "/", $file)))),+]
    };
}

impl Sample {
    pub const ALL: [Self; 2] = [Self::Warthog, Self::Hd2Tunnel];

    pub fn title(self) -> &'static str {
        match self {
            Self::Warthog => "Warthog on uneven ground",
            Self::Hd2Tunnel => "HD2 in a tunnel",
        }
    }

    pub(super) fn files(self) -> &'static [(&'static str, &'static str)] {
        match self {
            Self::Warthog => sample_files!("warthog":
                "inter_prism.csv", "GCP_raw_1.txt", "GCP_raw_2.txt", "Two_points.txt", "pillars.csv",
                "gnss_1.pos", "gnss_2.pos", "gnss_3.pos",
                "calibration_raw.csv", "calibration_results.csv", "deployment.toml"),
            Self::Hd2Tunnel => sample_files!("hd2-tunnel":
                "inter_prism.csv", "calibration_raw.csv", "calibration_results.csv", "deployment.toml"),
        }
    }

    pub fn open(self) -> Result<Deployment, OpenError> {
        open_files(self.title(), self.files())
    }
}
