//! Content and camera of the scene.

use crate::app::model::{Colouring, PictureTo, Ruler, SceneOptions, View, Visibility};

#[derive(Default)]
pub struct SceneState {
    pub visibility: Visibility,
    pub colouring: Colouring,
    pub options: SceneOptions,
    pub view: View,
    pub ruler: Ruler,
    /// Set by the request in one frame and used in the next, in which the menu is closed.
    pub(super) wanted_picture: Option<PictureTo>,
    /// True if this frame may become a picture, in which controls are not drawn.
    pub picturing: bool,
}
