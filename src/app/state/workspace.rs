//! The window itself: layout, units and colours.

use crate::app::layout::Layout;
use crate::app::model::Units;

#[derive(Default)]
pub struct Workspace {
    pub layout: Layout,
    pub units: Units,
    pub theme: egui::ThemePreference,
    /// True for large type and full contrast.
    pub in_the_sun: bool,
    /// Fixed computation time (ms), displayed in pictures that are compared byte for byte.
    pub fixed_elapsed_ms: Option<f64>,
}
