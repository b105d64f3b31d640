//! The window itself: layout, units and colours.

use crate::app::layout::Layout;
use crate::app::model::{PictureOrder, PictureTo, SettingFocus, Units};

#[derive(Default)]
pub struct Workspace {
    pub layout: Layout,
    pub units: Units,
    pub theme: egui::ThemePreference,
    /// True for large type and full contrast.
    pub in_the_sun: bool,
    /// The number that gets the focus, by its key.
    pub focused_setting: Option<SettingFocus>,
    /// True if the window asks before it closes with an unsaved session.
    pub asks_before_closing: bool,
    /// True once the user has answered that question.
    pub closes: bool,
    /// The picture to draw after this frame.
    pub(super) wanted_picture: Option<(PictureOrder, PictureTo)>,
    /// True while a picture is drawn, without controls.
    pub picturing: bool,
    /// Fixed computation time (ms), displayed in pictures that are compared byte for byte.
    pub fixed_elapsed_ms: Option<f64>,
}
