//! Pictures of panes, drawn off screen at their own size and scale.
//!
//! | module | content |
//! |---|---|
//! | [`pane_picture`] | one pane drawn by a context of its own, as pixels or as SVG |
//! | [`svg_of_shapes`] | egui's shapes as SVG |

pub mod pane_picture;
mod svg_of_shapes;
