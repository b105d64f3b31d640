//! The scene pane: the picture, what is written over it, and what was hovered.

use eframe::egui::{self, Align2, Color32, FontId, Pos2, Rect, Sense, StrokeKind, Vec2};

use super::input::{click, move_camera, take_keys};
use super::labels::{self, Placer};
use super::projection::Projection;
use super::under_pointer::{self, UnderPointer};
use super::{SceneContent, SceneRenderer, controls, legend, readout};
use crate::analysis::Analysis;
use crate::app::model::{
    Camera, Colouring, Command, Commands, Look, OpenDeployment, Picked, View, ViewPreset,
    Visibility,
};
use crate::app::prepared::time_origin_s;
use crate::app::state::State;
use crate::app::theme;

/// Radius of the ring around what was picked, and around what would be (points).
const PICKED_RING: f32 = 9.0;
const HOVERED_RING: f32 = 6.0;

/// What the scene is drawn from, and what was under the pointer.
pub struct SceneView {
    renderer: Option<SceneRenderer>,
    pub(super) content: SceneContent,
    /// What the content was made from.
    built: Option<Built>,
    coloured: Option<(u64, u64, Colouring)>,
    cursor: Option<(u64, usize)>,
    place: Option<Rect>,
    hover: Option<(u64, usize)>,
    /// What the controls took in the last frame.
    controls_size: Vec2,
}

#[derive(PartialEq)]
struct Built {
    deployment: u64,
    analysis: u64,
    visibility: Visibility,
    dark: bool,
}

impl SceneView {
    pub fn new(render_state: Option<&eframe::egui_wgpu::RenderState>) -> Self {
        Self {
            renderer: render_state.map(SceneRenderer::new),
            content: SceneContent::default(),
            built: None,
            coloured: None,
            cursor: None,
            place: None,
            hover: None,
            controls_size: Vec2::ZERO,
        }
    }

    /// Where the scene was drawn since this was asked last, in the window (points).
    pub fn take_place(&mut self) -> Option<Rect> {
        self.place.take()
    }

    pub fn ui(
        &mut self,
        ui: &mut egui::Ui,
        state: &State,
        view: &mut View,
        commands: &mut Commands,
    ) {
        let rect = ui.available_rect_before_wrap();
        self.place = Some(rect);
        let id = ui.scope_id().with("scene");
        let response = ui.interact(rect, id, Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Scene"));
        self.refresh(ui, state, view);
        move_camera(view, ui, &response, rect);
        take_keys(view, ui, &response, rect, state, commands);
        self.look_and_fly(view, ui, rect, state);
        let painter = ui.painter_at(rect);
        self.paint_picture(&view.camera, ui, &painter, rect);
        let projection = Projection::new(&view.camera, rect);
        if let Some((open, analysis)) = state.analysed() {
            let mut taken = Vec::new();
            if !state.picturing {
                taken.push(controls::ui(ui, rect, &mut self.controls_size, state, commands));
            }
            taken.extend(legend::paint(ui, rect, state, &self.content));
            let cursor = readout::paint_cursor(ui, rect, state, &self.content);
            taken.extend(cursor);
            let dark = ui.visuals().dark_mode;
            let scale = readout::paint_scale(&painter, &projection, &self.content, cursor, dark);
            taken.extend(scale);
            let mut placer = Placer::new(rect, taken);
            self.paint_ruler(&painter, &projection, open, state, &mut placer, dark);
            let eye_m = view.camera.eye_m();
            labels::paint(&painter, &projection, &eye_m, &self.content, &mut placer, dark);
            self.paint_picked(&painter, &projection, open, analysis, dark);
            self.show_hovered(ui, &response, &projection, state, commands);
            click(&self.content, &response, &projection, state, commands);
        }
        if response.has_focus() {
            let stroke = ui.visuals().selection.stroke;
            painter.rect_stroke(rect.shrink(1.0), 0.0, stroke, StrokeKind::Inside);
        }
    }

    /// Rebuilds what the state has changed.
    fn refresh(&mut self, ui: &egui::Ui, state: &State, view: &mut View) {
        let dark = ui.visuals().dark_mode;
        let Some((open, analysis)) = state.analysed() else {
            if self.built.take().is_some() {
                self.content = SceneContent::default();
                (self.coloured, self.cursor, self.hover) = (None, None, None);
            }
            return;
        };
        let run = open.analysis_run;
        let wanted =
            Built { deployment: open.id, analysis: run, visibility: state.visibility, dark };
        let rebuilt = self.built.as_ref() != Some(&wanted);
        if rebuilt {
            let before = self.built.as_ref().map(|built| built.deployment);
            if before != Some(open.id) {
                view.look(ViewPreset::Slanted);
                view.flight = None;
            }
            if let Some(look) = view.last_look.filter(|look| look.early) {
                view.look_again(look);
            }
            self.content.set_clouds(&open.clouds);
            let grid = theme::scene_grid(dark).to_array();
            self.content.rebuild(&open.deployment, analysis, &state.visibility, grid);
            self.built = Some(wanted);
        }
        let wanted = Some((open.id, run, state.colouring));
        if self.coloured != wanted {
            self.content.colour(&open.deployment, analysis, state.colouring);
            self.coloured = wanted;
        }
        let origin_s = time_origin_s(&open.deployment);
        self.content.set_selection(open.timeline.selection_s, origin_s);
        let instant = |time_s: Option<f64>| time_s.and_then(|t| analysis.triplets().nearest(t));
        let colour = theme::cursor(dark);
        let at = instant(open.timeline.cursor_s);
        let wanted = at.map(|instant| (run, instant));
        if rebuilt || self.cursor != wanted {
            self.content.set_cursor(&open.deployment, analysis, at, colour);
            self.cursor = wanted;
        }
        // At the cursor itself there is a triangle already.
        let at = instant(state.hover_s).filter(|hovered| Some(*hovered) != at);
        let wanted = at.map(|instant| (run, instant));
        if rebuilt || self.hover != wanted {
            self.content.set_hover(analysis, at, colour);
            self.hover = wanted;
        }
        self.content.set_ruler(&state.ruler, colour);
    }

    /// Does what was asked of the camera since the last frame.
    fn look_and_fly(&self, view: &mut View, ui: &egui::Ui, rect: Rect, state: &State) {
        if let Some(look) = view.last_look.filter(|look| look.size != rect.size()) {
            view.look_again(look);
        }
        if let Some(preset) = view.wanted.filter(|_| !self.content.outline_m.is_empty()) {
            view.flight = None;
            view.wanted = None;
            match (preset, self.content.bounds_m, state.analysed()) {
                (ViewPreset::Station(station), Some((low, high)), Some(_)) => {
                    let prisms = self.content.prisms_m;
                    let middle = prisms.map(|p| ((p[0] + p[1] + p[2]) / 3.0).cast::<f32>());
                    let target = middle.unwrap_or((low + high) / 2.0);
                    if let Some(transform) = self.content.station1_from_station[station] {
                        view.camera.stand(&transform.translation_m.cast::<f32>(), &target);
                    }
                }
                _ => {
                    let aspect = rect.width() / rect.height().max(1.0);
                    view.camera.look(preset, &self.content.outline_m, aspect);
                }
            }
            let early = state.active().is_some_and(OpenDeployment::joint_follows);
            view.last_look = Some(Look { preset, camera: view.camera, size: rect.size(), early });
        }
        if let Some(flight) = &mut view.flight {
            if flight.advance(&mut view.camera, ui.input(|i| i.time)) {
                view.flight = None;
            } else {
                ui.ctx().request_repaint();
            }
        }
    }

    fn paint_picture(
        &mut self,
        camera: &Camera,
        ui: &egui::Ui,
        painter: &egui::Painter,
        rect: Rect,
    ) {
        let background = theme::scene_background(ui.visuals().dark_mode);
        match &mut self.renderer {
            Some(renderer) => {
                let pixels_per_point = ui.ctx().pixels_per_point();
                let texture =
                    renderer.draw(&self.content, camera, rect.size(), pixels_per_point, background);
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
    }

    /// Writes the ruler's numbers beside its middle.
    fn paint_ruler(
        &self,
        painter: &egui::Painter,
        projection: &Projection,
        open: &OpenDeployment,
        state: &State,
        placer: &mut Placer,
        dark: bool,
    ) {
        let inter_prism_m = open.deployment.rig.as_ref().map(|rig| &rig.inter_prism_m);
        let Some(text) =
            self.content.ruler_text(&state.ruler, inter_prism_m, projection, state.units)
        else {
            return;
        };
        let colour = theme::rgb(theme::cursor(dark));
        let font = FontId::proportional(12.0);
        let galley = painter.layout_no_wrap(text.lines.join("\n"), font, colour);
        let size = galley.size() + Vec2::splat(8.0);
        // Neither on the ends nor on the line between them.
        for at in text.ends.into_iter().flatten().chain([text.at]) {
            placer.keep_free(at, 9.0);
        }
        if let Some(place) = placer.near(text.at, size) {
            labels::ground(painter, place, dark);
            painter.galley(place.min + Vec2::splat(4.0), galley, colour);
        }
    }

    fn paint_picked(
        &self,
        painter: &egui::Painter,
        projection: &Projection,
        open: &OpenDeployment,
        analysis: &Analysis,
        dark: bool,
    ) {
        let shown = |picked: &Picked| under_pointer::is_shown(&self.content, *picked);
        let Some(picked) = open.timeline.picked.filter(shown) else { return };
        let position_m = picked.place_m(&open.deployment, analysis);
        if let Some(at) = position_m.and_then(|p| projection.visible(&p)) {
            under_pointer::ring(painter, at, PICKED_RING, dark);
        }
    }

    /// Says what is under the pointer, here and to the other panes.
    fn show_hovered(
        &self,
        ui: &egui::Ui,
        response: &egui::Response,
        projection: &Projection,
        state: &State,
        commands: &mut Commands,
    ) {
        let Some((open, analysis)) = state.analysed() else { return };
        // While the camera is turned nothing is meant.
        let Some(pointer) = response.hover_pos().filter(|_| !response.dragged()) else { return };
        let Some(under) = UnderPointer::find(&self.content, projection, pointer) else { return };
        commands.extend(under.time_s(open, analysis).map(Command::Hover));
        let UnderPointer::Reading(picked) = under else { return };
        let (painter, dark) = (ui.painter_at(projection.rect), ui.visuals().dark_mode);
        let position_m = under.position_m(open, analysis, &self.content);
        if let Some(at) = position_m.and_then(|p| projection.visible(&p)) {
            under_pointer::ring(&painter, at, HOVERED_RING, dark);
        }
        let lines = under_pointer::reading_lines(open, analysis, picked, state.units);
        under_pointer::tooltip(&painter, projection.rect, pointer, &lines, dark);
    }
}
