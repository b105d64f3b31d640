//! All settings of the processing chain.

use serde::{Deserialize, Serialize};

use crate::calibration::CalibrationSettings;
use crate::pipeline::PipelineSettings;

/// All settings of the user, as in a `--config` file and in the window's sliders.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    pub pipeline: PipelineSettings,
    pub calibration: CalibrationSettings,
}

impl Settings {
    /// Checks all settings; the error is the first invalid one, as one line.
    pub fn check(&self) -> Result<(), String> {
        self.pipeline.check()?;
        self.calibration.check()
    }
}
