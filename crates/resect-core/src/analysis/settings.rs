//! All settings of the one path.

use serde::{Deserialize, Serialize};

use crate::calibration::CalibrationSettings;
use crate::pipeline::PipelineSettings;

/// Everything a user can set; a `--config` file and the window's sliders are this.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    pub pipeline: PipelineSettings,
    pub calibration: CalibrationSettings,
}

impl Settings {
    /// The first setting that makes no sense, as one line.
    pub fn check(&self) -> Result<(), String> {
        self.pipeline.check()?;
        self.calibration.check()
    }
}
