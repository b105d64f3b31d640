//! Content and camera of the scene.

use crate::app::model::{Colouring, PictureTo, Ruler, SceneOptions, View, Visibility};

#[derive(Default)]
pub struct SceneState {
    pub visibility: Visibility,
    pub colouring: Colouring,
    pub options: SceneOptions,
    pub view: View,
    pub ruler: Ruler,
    /// Requested in the last frame; taken in the next, when the menu of the request is gone.
    pub(super) wanted_picture: Option<PictureTo>,
    /// Whether this frame may become a picture: controls are not part of it.
    pub picturing: bool,
}
