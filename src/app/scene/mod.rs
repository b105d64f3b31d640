//! The scene: tracks, stations and control points in 3D.
//!
//! [`view`] is the pane. What it shows comes in two kinds:
//! - readings and tracks, by the million: [`cloud`] puts them on the GPU once (in the worker, before the frame that
//!   shows them), [`colouring`] gives them colours, and [`pick`] finds the one under the pointer;
//! - everything else, by the hundred: [`content`] with [`overlays`], [`vehicle`], [`station_uncertainty`], [`control_points`],
//!   [`cursor`] (with [`ghosts`] where there is no triplet) and [`grid`],
//!   made by [`refresh`] and [`rebuild`] when the state changes; [`extent`] says how far all of it reaches.
//!
//! [`camera`] looks at them ([`flight`] moves it, [`input`] steers it), [`renderer`] draws them with wgpu into a texture of
//! its own (depth, four samples), and [`projection`] tells where on the screen a place is, for what is written over the
//! picture: [`labels`] and what is [`under_pointer`]. [`legend`] and [`controls`] lie over it and leave a [`free_part`];
//! the [`strip`] under it says the rest.
//!
//! The [`trail`] is part of the tracks, drawn once more.
//!
//! Points stay in their station's frame on the GPU; the three transforms are uniforms. A new calibration of
//! the same triplets moves no point. No frame goes through all points.

mod advised;
mod beside;
mod buffers;
mod colouring;
mod content;
mod control_points;
mod controls;
mod cursor;
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
