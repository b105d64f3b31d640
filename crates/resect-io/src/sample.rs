//! The built-in deployments, written by `resect simulate` and read by the same readers as any other.

use std::sync::LazyLock;

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

/// Names and texts of the files of each sample, in the order of [`Sample::ALL`], as JSON compressed by zstd. The test of this file writes it from
/// `assets/samples`.
const PACKED: &[u8] = include_bytes!("../assets/samples.json.zst");

static FILES: LazyLock<Vec<Vec<(String, String)>>> = LazyLock::new(|| {
    let json = zstd::decode_all(PACKED).expect("a test reads it");
    serde_json::from_slice(&json).expect("a test reads it")
});

impl Sample {
    pub const ALL: [Self; 2] = [Self::Warthog, Self::Hd2Tunnel];

    pub fn title(self) -> &'static str {
        match self {
            Self::Warthog => "Warthog on uneven ground",
            Self::Hd2Tunnel => "HD2 in a tunnel",
        }
    }

    /// Returns the names and texts of its files.
    pub(super) fn files(self) -> Vec<(&'static str, &'static str)> {
        FILES[self as usize].iter().map(|(name, text)| (&**name, &**text)).collect()
    }

    pub fn open(self) -> Result<Deployment, OpenError> {
        open_files(self.title(), &self.files())
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;

    const WRITTEN: [(&str, &[&str]); 2] = [
        (
            "warthog",
            &[
                "inter_prism.csv",
                "GCP_raw_1.txt",
                "GCP_raw_2.txt",
                "Two_points.txt",
                "pillars.csv",
                "gnss_1.pos",
                "gnss_2.pos",
                "gnss_3.pos",
                "calibration_raw.csv",
                "calibration_results.csv",
                "deployment.toml",
            ],
        ),
        (
            "hd2-tunnel",
            &[
                "inter_prism.csv",
                "calibration_raw.csv",
                "calibration_results.csv",
                "deployment.toml",
            ],
        ),
    ];

    /// `UPDATE_GOLDEN=1 cargo test -p resect-io packed_samples` packs them again.
    #[test]
    fn packed_samples_are_those_of_the_folders() {
        let assets = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("assets");
        let samples: Vec<Vec<(String, String)>> = WRITTEN
            .iter()
            .map(|(folder, files)| {
                let text = |file: &str| {
                    let path = assets.join("samples").join(folder).join(file);
                    std::fs::read_to_string(path).expect("a sample's file")
                };
                files.iter().map(|file| ((*file).to_owned(), text(file))).collect()
            })
            .collect();
        if std::env::var_os("UPDATE_GOLDEN").is_some() {
            let json = serde_json::to_vec(&samples).expect("in memory");
            let packed = zstd::encode_all(&json[..], 19).expect("in memory");
            std::fs::write(assets.join("samples.json.zst"), packed).expect("writable");
        } else {
            assert!(*FILES == samples, "UPDATE_GOLDEN=1 cargo test -p resect-io packed_samples");
        }
    }
}
