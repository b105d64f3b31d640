//! The plots over time, driven by the names of their widgets.

mod common;

use std::path::Path;

use eframe::egui::{Event, Key, Modifiers, MouseWheelUnit, PointerButton, Pos2, Rect, Theme, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use resect::analysis::Settings;
use resect::app::{Command, Pane, ResectWindow, Start, offscreen_renderer};
use resect::deployment::{Deployment, Sample};

const LARGE: Vec2 = Vec2::new(1600.0, 1000.0);
const SMALL: Vec2 = Vec2::new(1100.0, 700.0);

type Window = Harness<'static, ResectWindow>;

fn window(size: Vec2, theme: Theme, pane: Pane) -> Window {
    let mut harness = Harness::builder()
        .with_size(size)
        .with_theme(theme)
        .with_render_cursor(false)
        .renderer(offscreen_renderer().expect("Mesa is installed by tests/run"))
        .build_eframe(|creation| {
            ResectWindow::new(creation, &Start::Sample(Sample::Warthog), Settings::default())
        });
    settle(&mut harness);
    send(&mut harness, Command::ShowPane(pane));
    harness
}

/// Lets commands reach the worker, its answers come back, and the panes be drawn with them.
fn settle(harness: &mut Window) {
    for _ in 0..2 {
        harness.run_steps(2);
        harness.state_mut().settle();
    }
    harness.run_steps(3);
}

fn send(harness: &mut Window, command: Command) {
    let ctx = harness.ctx.clone();
    harness.state_mut().send(command, &ctx);
    settle(harness);
}

fn open(harness: &mut Window, deployment: Deployment) {
    harness.state_mut().state.add(deployment.into(), None);
    settle(harness);
}

fn save(harness: &mut Window, name: &str) {
    let folder = Path::new("/tmp/wt/plots-pictures");
    harness.render().expect("a picture").save(folder.join(format!("{name}.png"))).expect("written");
}

#[test]
#[ignore = "pictures to look at"]
fn pictures() {
    for (size, theme, name) in
        [(LARGE, Theme::Dark, "large-dark"), (SMALL, Theme::Light, "small-light")]
    {
        for (pane, pane_name) in
            [(Pane::Rates, "rates"), (Pane::Intervals, "intervals"), (Pane::Residuals, "residuals")]
        {
            let mut harness = window(size, theme, pane);
            save(&mut harness, &format!("{pane_name}-{name}"));
            if let Some(folder) = common::field_data("2022-07-11-2") {
                open(&mut harness, resect::deployment::open(&folder).expect("field data"));
                save(&mut harness, &format!("{pane_name}-field-{name}"));
            }
        }
    }
}
