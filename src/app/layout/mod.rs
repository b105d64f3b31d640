//! Layout of the panes: docked, split, tabbed and closed by the user, sized by the window until then.
//!
//! Layouts are plain data in [`layout_description`](super::model::layout_description), the presets in
//! [`layout_presets`](super::model::layout_presets). [`tree`] converts between descriptions and the docking library, [`fit`]
//! adapts sizes to the window, and [`reopen`] restores closed panes.

mod behaviour;
mod fit;
mod pane_layout;
mod reopen;
mod tree;

pub use behaviour::PictureWish;
pub use pane_layout::Layout;
