//! The window itself: arrangement of the panes, units and colours.

use crate::app::layout::Layout;
use crate::app::model::Units;

#[derive(Default)]
pub struct Workspace {
    pub layout: Layout,
    pub units: Units,
    pub theme: egui::ThemePreference,
    /// Whether type is large and contrast full.
    pub in_the_sun: bool,
    /// Pictures that are compared byte for byte show this instead of the measured time (ms).
    pub fixed_elapsed_ms: Option<f64>,
}
