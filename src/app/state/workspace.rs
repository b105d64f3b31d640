//! The window itself: layout, units and colours.

use crate::app::layout::Layout;
use crate::app::model::{LayoutPreset, Pane, PictureOrder, PictureTo, SettingFocus, Units};

#[derive(Default)]
pub struct Workspace {
    pub layout: Layout,
    /// The layout before that for trajectories without a deployment, which the program chose.
    pub before_evaluation: Option<Layout>,
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

impl Workspace {
    /// Uses the layout for trajectories, unless the user has arranged the panes; these are then shown.
    pub(super) fn show_evaluation(&mut self) {
        if self.layout.is_as_chosen() {
            let earlier = std::mem::replace(&mut self.layout, LayoutPreset::Evaluate.into());
            self.before_evaluation.get_or_insert(earlier);
            return;
        }
        [Pane::Scene, Pane::Channels, Pane::Evaluation]
            .into_iter()
            .for_each(|pane| self.layout.show(pane));
    }

    /// Returns to the layout before that for trajectories, unless the user has chosen or moved anything since.
    pub(super) fn leave_evaluation(&mut self) {
        if let Some(earlier) = self.before_evaluation.take()
            && self.layout.is_as_chosen()
        {
            self.layout = earlier;
        }
    }

    /// Returns the layout for the next window: not one that the program chose for trajectories.
    pub fn lasting_layout(&self) -> &Layout {
        let earlier = self.before_evaluation.as_ref();
        earlier.filter(|_| self.layout.is_as_chosen()).unwrap_or(&self.layout)
    }
}
