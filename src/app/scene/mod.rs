//! The scene: tracks, stations and control points in 3D.
//!
//! [`content`] turns an analysis into points and lines in the stations' own frames, [`camera`] looks at them,
//! [`renderer`] draws them with wgpu into a texture of its own (depth, four samples), and [`view`] is the pane: it
//! shows that texture as an image, paints labels over it and turns the mouse into commands.
//!
//! Points stay in their station's frame on the GPU; the three transforms are uniforms. A new calibration of
//! the same triplets rewrites 192 bytes, and no vertex buffer.

mod camera;
mod content;
mod legend;
mod options;
mod overlays;
mod renderer;
mod station_uncertainty;
mod view;

pub use camera::{Camera, ViewPreset};
pub use content::SceneContent;
pub use options::{Colouring, Ruler, RulerEnd};
pub use renderer::SceneRenderer;
pub use view::SceneView;
