//! The scene pane: the picture, what is written over it, and what the mouse does.

use eframe::egui::{self, Align2, Color32, FontId, Key, Pos2, Rect, Sense, Vec2};
use nalgebra::Vector4;

use super::{Camera, SceneContent, SceneRenderer, ViewPreset, legend};
use crate::app::state::{Command, Commands, State};
use crate::app::theme;
use crate::geometry::RigidTransform;

/// A click this close (points) to a prism's track moves the cursor there.
const CLICK_REACH: f32 = 14.0;

/// Camera and buffers of the scene.
pub struct SceneView {
    renderer: Option<SceneRenderer>,
    content: SceneContent,
    camera: Camera,
    /// To be done at the next frame.
    pending_look: Option<ViewPreset>,
    /// What the content was made from.
    built: Option<Built>,
    cursor: Option<(u64, usize)>,
    place: Rect,
}

#[derive(PartialEq)]
struct Built {
    deployment: u64,
    analysis: u64,
    visibility: crate::app::state::Visibility,
    dark: bool,
}

impl SceneView {
    pub fn new(render_state: Option<&eframe::egui_wgpu::RenderState>) -> Self {
        Self {
            renderer: render_state.map(SceneRenderer::new),
            content: SceneContent::default(),
            camera: Camera::default(),
            pending_look: None,
            built: None,
            cursor: None,
            place: Rect::NOTHING,
        }
    }

    /// Turns or moves the camera at the next frame.
    pub fn look(&mut self, preset: ViewPreset) {
        self.pending_look = Some(preset);
    }

    /// Where the scene was drawn last, in the window (points).
    pub fn place(&self) -> Rect {
        self.place
    }

    pub fn ui(&mut self, ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
        let rect = ui.available_rect_before_wrap();
        self.place = rect;
        let id = ui.scope_id().with("scene");
        let response = ui.interact(rect, id, Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Scene"));
        self.refresh(ui, state);
        self.move_camera(ui, &response, rect);
        if let Some(preset) = self.pending_look
            && !self.content.outline_m.is_empty()
        {
            self.camera.look(
                preset,
                &self.content.outline_m,
                rect.width() / rect.height().max(1.0),
            );
            self.pending_look = None;
        }
        let background = theme::scene_background(ui.visuals().dark_mode);
        let painter = ui.painter_at(rect);
        match &mut self.renderer {
            Some(renderer) => {
                let pixels_per_point = ui.ctx().pixels_per_point();
                let texture = renderer.draw(
                    &self.content,
                    &self.camera,
                    rect.size(),
                    pixels_per_point,
                    background,
                );
                let whole = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
                painter.image(texture, rect, whole, Color32::WHITE);
            }
            None => {
                painter.rect_filled(rect, 0.0, background);
                let text = "no GPU: the scene needs Vulkan, Metal, DX12 or OpenGL";
                painter.text(
                    rect.center(),
                    Align2::CENTER_CENTER,
                    text,
                    FontId::default(),
                    ui.visuals().text_color(),
                );
            }
        }
        self.paint_labels(&painter, rect, ui.visuals().dark_mode);
        self.click(&response, rect, state, commands);
        if state.analysed().is_some() {
            legend::paint(ui, rect, state, &self.content);
        }
        view_buttons(ui, rect, commands);
    }

    /// Rebuilds what the state has changed.
    fn refresh(&mut self, ui: &egui::Ui, state: &State) {
        let dark = ui.visuals().dark_mode;
        let Some((open, analysis)) = state.analysed() else {
            if self.built.take().is_some() {
                self.content = SceneContent::default();
            }
            return;
        };
        let run = open.analysis_run;
        let wanted =
            Built { deployment: open.id, analysis: run, visibility: state.visibility, dark };
        let rebuilt = self.built.as_ref() != Some(&wanted);
        if rebuilt {
            if self.built.as_ref().map(|built| built.deployment) != Some(open.id) {
                self.pending_look = Some(ViewPreset::Fit);
            }
            let grid = theme::scene_grid(dark).to_array();
            self.content.rebuild(&open.deployment, analysis, &state.visibility, grid);
            self.built = Some(wanted);
        }
        let instant = open.timeline.cursor_s.and_then(|t| analysis.triplets().nearest(t));
        let wanted = instant.map(|instant| (run, instant));
        if rebuilt || self.cursor != wanted {
            self.content.set_cursor(&open.deployment, analysis, instant, theme::cursor(dark));
            self.cursor = wanted;
        }
    }

    fn move_camera(&mut self, ui: &egui::Ui, response: &egui::Response, rect: Rect) {
        let drag: [f32; 2] = response.drag_delta().into();
        let shift = ui.input(|i| i.modifiers.shift);
        use egui::PointerButton::{Middle, Primary, Secondary};
        if response.dragged_by(Secondary)
            || response.dragged_by(Middle)
            || (shift && response.dragged_by(Primary))
        {
            self.camera.pan(drag, rect.height());
        } else if response.dragged_by(Primary) {
            self.camera.orbit(drag);
        }
        if response.hovered() {
            let (scroll, pinch) = ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta()));
            if scroll != 0.0 || pinch != 1.0 {
                let factor = (-0.004 * scroll).exp() / pinch;
                self.camera.zoom(factor);
                // What is under the pointer stays there.
                if let Some(pointer) = response.hover_pos() {
                    let shift = (pointer - rect.center()) * (1.0 - 1.0 / factor);
                    self.camera.pan(shift.into(), rect.height());
                }
            }
        }
        let typing = ui.ctx().egui_wants_keyboard_input();
        if !typing && ui.input(|i| i.key_pressed(Key::F)) {
            self.pending_look = Some(ViewPreset::Fit);
        }
        if response.double_clicked() {
            self.pending_look = Some(ViewPreset::Fit);
        }
    }

    /// Screen position of a place, if it is in front of the camera.
    fn project(&self, rect: Rect, p: &nalgebra::Vector3<f32>) -> Option<Pos2> {
        let clip = self.camera.clip_from_world(rect.width() / rect.height().max(1.0))
            * Vector4::new(p.x, p.y, p.z, 1.0);
        if clip.w <= 1e-3 {
            return None;
        }
        let ndc = Vec2::new(clip.x / clip.w, -clip.y / clip.w);
        Some(rect.center() + 0.5 * ndc * rect.size())
    }

    /// Labels in order of importance; one that would lie on another is left out.
    fn paint_labels(&self, painter: &egui::Painter, rect: Rect, dark: bool) {
        let mut taken: Vec<Rect> = Vec::new();
        let stations_first = self.content.labels.iter().rev();
        for label in stations_first {
            let Some(at) = self.project(rect, &label.position_m) else { continue };
            if !rect.shrink(4.0).contains(at) {
                continue;
            }
            let station = label.text.starts_with("Station");
            let font = FontId::proportional(if station { 13.0 } else { 10.5 });
            let colour = theme::readable(label.colour, dark);
            let galley = painter.layout_no_wrap(label.text.clone(), font, colour);
            let places = [
                (Align2::CENTER_BOTTOM, Vec2::new(0.0, -6.0)),
                (Align2::CENTER_TOP, Vec2::new(0.0, 14.0)),
                (Align2::LEFT_CENTER, Vec2::new(10.0, 0.0)),
                (Align2::RIGHT_CENTER, Vec2::new(-10.0, 0.0)),
                (Align2::CENTER_BOTTOM, Vec2::new(0.0, -22.0)),
                (Align2::CENTER_TOP, Vec2::new(0.0, 30.0)),
            ]
            .map(|(align, offset)| inside(align.anchor_size(at + offset, galley.size()), rect));
            let free = |place: &&Rect| !taken.iter().any(|other| other.intersects(**place));
            let Some(place) = places.iter().find(free).copied() else { continue };
            painter.galley(place.min, galley, colour);
            taken.push(place);
        }
        if self.content.bounds_m.is_some() {
            painter.text(
                rect.right_bottom() - Vec2::new(8.0, 6.0),
                Align2::RIGHT_BOTTOM,
                self.scale(),
                FontId::proportional(11.0),
                theme::faint(dark),
            );
        }
    }

    /// What the lengths in the picture mean.
    fn scale(&self) -> String {
        let grid = format!("grid {} m · frame of station 1, z up", self.content.grid_spacing_m);
        match self.content.exaggeration {
            Some(factor) => format!("ellipsoids 2σ of the interpolation, ×{factor} · {grid}"),
            None => grid,
        }
    }

    /// A click on a track moves the time cursor to that instant.
    fn click(&self, response: &egui::Response, rect: Rect, state: &State, commands: &mut Commands) {
        let Some(at) = response.interact_pointer_pos().filter(|_| response.clicked()) else {
            return;
        };
        let Some((_, analysis)) = state.analysed() else { return };
        let triplets = analysis.triplets();
        let mut nearest: Option<(f32, usize)> = None;
        for station in 0..3 {
            let Some(transform) = self.content.station1_from_station[station] else { continue };
            let transform: RigidTransform = transform;
            for (index, point) in triplets.points_m[station].iter().enumerate() {
                let place = transform.apply(point).cast::<f32>();
                let Some(screen) = self.project(rect, &place) else { continue };
                let distance = screen.distance(at);
                if distance < CLICK_REACH && nearest.is_none_or(|(best, _)| distance < best) {
                    nearest = Some((distance, index));
                }
            }
        }
        if let Some((_, index)) = nearest {
            commands.push(Command::MoveCursor(triplets.time_s[index]));
        }
    }
}

/// A label's place, moved so that nothing of it is cut off.
fn inside(place: Rect, rect: Rect) -> Rect {
    let rect = rect.shrink(4.0);
    let over = (rect.min - place.min).max(Vec2::ZERO) + (rect.max - place.max).min(Vec2::ZERO);
    place.translate(over)
}

/// Ways to look, in the corner.
fn view_buttons(ui: &mut egui::Ui, rect: Rect, commands: &mut Commands) {
    let corner = Rect::from_min_max(
        Pos2::new(rect.right() - 190.0, rect.top() + 6.0),
        Pos2::new(rect.right() - 8.0, rect.top() + 30.0),
    );
    let layout = egui::Layout::right_to_left(egui::Align::Center);
    ui.scope_builder(egui::UiBuilder::new().max_rect(corner).layout(layout), |ui| {
        for (name, preset, hint) in [
            ("Side", ViewPreset::Side, "Look along the ground"),
            ("Top", ViewPreset::Top, "Look down, x to the right"),
            ("Fit", ViewPreset::Fit, "Show everything (F, or double-click)"),
        ] {
            if ui.button(name).on_hover_text(hint).clicked() {
                commands.push(Command::Look(preset));
            }
        }
    });
}
