//! The scene: tracks, stations and control points in 3D.
//!
//! [`view`] is the pane. It shows two kinds of content:
//! - readings and tracks, by the million: [`cloud`] uploads them to the GPU once (in the worker, before the frame that
//!   shows them), [`colouring`] computes their colours, and [`pick`] finds the one under the pointer;
//! - everything else, by the hundred: [`content`] with [`overlays`], [`vehicle`], [`station_uncertainty`], [`control_points`],
//!   [`cursor`] (with [`ghosts`] where there is no triplet) and [`grid`],
//!   built by [`refresh`] and [`rebuild`] when the state changes; [`extent`] computes the extent of all of it.
//!
//! [`camera`] defines the view ([`flight`] moves it, [`input`] steers it). [`renderer`] draws it with wgpu into a texture of its own
//! (depth, four samples). [`projection`] gives the positions on the screen of everything written over the picture: [`labels`], [`edge_marks`], the [`shown_point`] and the item
//! [`under_pointer`]. [`legend`] and [`controls`] lie over it and leave a [`free_part`]; the [`strip`] under it shows further text.
//!
//! The [`trail`] is a segment of the tracks, drawn a second time.
//!
//! Points stay in their station's frame on the GPU; the three transforms are uniforms. A
//! new calibration of the same triplets moves no point. No frame iterates over all points.

mod advised;
mod beside;
mod buffers;
mod colouring;
mod content;
mod control_points;
mod controls;
mod cursor;
mod edge_marks;
mod estimates;
mod extent;
mod free_part;
mod ghosts;
mod grid;
mod input;
mod labels;
mod legend;
mod legend_rows;
mod overlays;
mod pipelines;
mod projection;
mod rebuild;
mod refresh;
mod renderer;
mod ruler;
mod shown_point;
mod station_uncertainty;
mod strip;
mod strip_text;
mod trail;
mod tube;
mod under_pointer;
mod vehicle;
mod vertices;
mod view;

pub use content::SceneContent;
pub use renderer::SceneRenderer;
pub use view::SceneView;
