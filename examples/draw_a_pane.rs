//! Draws a pane of the window without a display: `cargo run --release --example draw_a_pane -- intervals pane.png [FOLDER]`.
//!
//! The window is the real one, driven by the [`Command`]s that its menus send: change a
//! setting, pick a reading or choose colours the same way before the picture is taken.

#![allow(clippy::print_stdout, reason = "an example prints")]

use std::sync::Arc;

use egui_kittest::Harness;
use resect::app::{Pane, ResectWindow, Start, WorkspaceCommand, offscreen_renderer};
use resect_core::analysis::Settings;
use resect_core::progress::Progress;
use resect_io::sample::Sample;
use resect_io::source::Source;

const SIZE: [f32; 2] = [1600.0, 1000.0];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().unwrap_or_else(|| "intervals".to_owned());
    let file = arguments.next().unwrap_or_else(|| "pane.png".to_owned());
    let known = || Pane::ALL.map(Pane::name).join(", ");
    let pane =
        Pane::of_name(&name).ok_or_else(|| format!("no pane {name}; there are {}", known()))?;
    let source = arguments.next().map_or(Source::sample(Sample::Warthog), Source::at);
    let deployment = Arc::new(source.open(&Progress::default())?);

    let start = Start::Deployments(vec![(deployment, source)]);
    let mut window = Harness::builder()
        .with_size(SIZE)
        .renderer(offscreen_renderer()?)
        .build_eframe(|creation| ResectWindow::new(creation, &start, Settings::default()));
    window.run_steps(1);
    let ctx = window.ctx.clone();
    window.state_mut().send(WorkspaceCommand::ShowPane(pane), &ctx);
    // A background thread computes the calibration; then the panes are drawn with it.
    window.state_mut().settle();
    window.run_steps(4);
    let whole = window.render()?;
    let place = window.state().layout().place(pane).ok_or("the pane has no place")?;
    let [left, top, width, height] =
        [place.left(), place.top(), place.width(), place.height()].map(|points| points as u32);
    image::imageops::crop_imm(&whole, left, top, width, height).to_image().save(&file)?;
    println!("{file}: {width}×{height}");
    Ok(())
}
