//! The scene pane: the picture, its overlays and its hovered item.

use std::sync::Arc;

use nalgebra::Vector2;

use egui::{Align2, Color32, FontId, Pos2, Rect, Sense, StrokeKind, Vec2};

use super::input::{click, move_camera, take_keys};
use super::labels::{self, Placer};
use super::projection::Projection;
use super::under_pointer::{self, UnderPointer};
use super::{
    SceneContent, SceneRenderer, controls, edge_marks, free_part, ghosts, legend, shown_point,
    strip,
};
use crate::app::model::follow::Follow;
use crate::app::model::{
    Camera, Colouring, Commands, Frame, Look, OpenDeployment, Picked, SceneCommand, SceneOptions,
    TimeCommand, View, ViewPreset, Visibility,
};
use crate::app::prepared::beside::RunBeside;
use crate::app::prepared::way::Way;
use crate::app::state::State;
use crate::app::theme;
use resect_core::analysis::Analysis;
use resect_core::network::{Number, Station};
use resect_tools::estimates::EstimatesJudgement;

/// Width of the folded legend with the margins of both sides (points).
const LEGEND_FOLDED: f32 = 116.0;
/// Radius of the ring around the picked item, and around the hovered one (points).
const PICKED_RING: f32 = 9.0;
const HOVERED_RING: f32 = 6.0;

const NOTHING_IN_SIGHT: &str = "Nothing in view. Fit (F) shows the whole scene";

/// State of the pane: renderer, content, and the keys from which each was built.
pub struct SceneView {
    renderer: Option<SceneRenderer>,
    pub(super) content: SceneContent,
    /// Key of the state from which the content was built.
    pub(super) built: Option<Built>,
    pub(super) coloured: Option<(u64, u64, Colouring)>,
    pub(super) cursor: Option<(u64, f64)>,
    pub(super) hover: Option<(u64, usize)>,
    /// Path of the drawn tube, and its enlargement.
    pub(super) tube: Option<(Arc<Way>, u32)>,
    /// The advised path, and the analysis whose last height it is drawn at.
    pub(super) advised: (Vec<Vector2<f64>>, u64),
    /// The drawn paths of other runs.
    pub(super) beside: Option<Arc<Vec<RunBeside>>>,
    /// Colour number of each drawn trajectory of another system, and their evaluation.
    pub(super) judgement: Option<(Vec<Option<usize>>, Arc<EstimatesJudgement>)>,
    /// Size of the controls in the last frame.
    controls_size: Vec2,
}

/// Key of the state from which the content was built.
#[derive(PartialEq)]
pub struct Built {
    pub(super) deployment: u64,
    pub(super) analysis: u64,
    pub(super) visibility: Visibility,
    /// Enlargement of ellipsoids, and the chosen one of residual arrows.
    pub(super) scales: (u32, Option<u32>),
    pub(super) dark: bool,
}

impl SceneView {
    pub fn new(render_state: Option<&eframe::egui_wgpu::RenderState>) -> Self {
        Self {
            renderer: render_state.map(SceneRenderer::new),
            content: SceneContent::default(),
            built: None,
            coloured: None,
            cursor: None,
            hover: None,
            judgement: None,
            tube: None,
            beside: None,
            advised: Default::default(),
            controls_size: Vec2::ZERO,
        }
    }

    pub fn ui(
        &mut self,
        ui: &mut egui::Ui,
        state: &State,
        view: &mut View,
        commands: &mut Commands,
    ) {
        let pane = ui.available_rect_before_wrap();
        let (rect, strip) = pane.split_top_bottom_at_y(pane.bottom() - strip::height(pane.size()));
        let id = ui.scope_id().with("scene");
        let response = ui.interact(rect, id, Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Scene"));
        self.refresh(ui, state, view);
        let before = view.camera;
        move_camera(view, ui, &response, rect, state);
        take_keys(view, ui, &response, rect, state, commands);
        // A user who moves the camera away from the rig stops following it.
        let following = state.scene.options.follow && view.camera.target_m == before.target_m;
        if following != state.scene.options.follow {
            commands.push(
                SceneCommand::SetOptions(SceneOptions { follow: false, ..state.scene.options })
                    .into(),
            );
        }
        if let Some((low_m, high_m)) = self.content.bounds_m.filter(|_| view.camera != before) {
            view.camera.stay_near([low_m, high_m]);
        }
        let painter = ui.painter_at(rect);
        // The picture lies under the controls, whose rectangles determine its content.
        let picture = painter.add(egui::Shape::Noop);
        let over = self.overlays(ui, rect, state, commands);
        let frame = free_part::frame(rect, free_part::free_part(rect, &over));
        self.look_and_fly(view, ui, frame, state);
        self.follow(view, ui, following);
        let grid = theme::scene_grid(ui.visuals().dark_mode).to_array();
        self.content.set_grid(&view.camera, rect.height(), grid);
        self.paint_picture(&view.camera, ui, &painter, picture, rect);
        let projection = Projection::new(&view.camera, rect);
        if let Some((open, analysis)) = state.analysed() {
            let dark = ui.visuals().dark_mode;
            let mut placer = Placer::new(rect, over);
            let eye_m = view.camera.eye_m();
            labels::paint(&painter, &projection, &eye_m, &self.content, &mut placer, dark);
            edge_marks::paint(&painter, &projection, &self.content, &mut placer, dark);
            ghosts::paint(&painter, &projection, &self.content.ghosts, dark);
            self.paint_picked(&painter, &projection, open, analysis, dark);
            shown_point::paint(&painter, &projection, (open, analysis), state, dark);
            self.show_hovered(ui, &response, &projection, state, commands);
            click(&self.content, &response, &projection, state, commands);
            if !under_pointer::is_anything_in_sight(&self.content, &projection) {
                labels::paint_in_the_middle(&painter, rect, NOTHING_IN_SIGHT, dark);
            }
        }
        strip::ui(ui, strip, state, &self.content, &projection);
        if response.has_focus() {
            let stroke = ui.visuals().selection.stroke;
            painter.rect_stroke(rect.shrink(1.0), 0.0, stroke, StrokeKind::Inside);
        }
    }

    /// Shows the overlays on the picture; returns their rectangles.
    fn overlays(
        &mut self,
        ui: &mut egui::Ui,
        rect: Rect,
        state: &State,
        commands: &mut Commands,
    ) -> Vec<Rect> {
        let Some((open, analysis)) = state.analysed() else { return Vec::new() };
        let mut over = Vec::new();
        // The legend comes first for Tab; folded it leaves room for the controls beside it, or is below them.
        let is_beside = rect.width() - self.controls_size.x > LEGEND_FOLDED;
        let below = if is_beside || state.workspace.picturing { 0.0 } else { self.controls_size.y };
        let picture = rect.with_min_y(rect.top() + below);
        over.extend(legend::ui(ui, picture, (open, analysis), state, &self.content, commands));
        if !state.workspace.picturing {
            over.insert(0, controls::ui(ui, rect, &mut self.controls_size, state, commands));
        }
        over
    }

    /// Executes the camera commands since the last frame.
    fn look_and_fly(&self, view: &mut View, ui: &egui::Ui, frame: Frame, state: &State) {
        let vertical = state.scene.options.height_scale.max(1) as f32;
        if view.camera.vertical != vertical {
            view.last_look.into_iter().for_each(|look| view.look_again(look));
            view.camera.vertical = vertical;
        }
        if let Some(look) = view.last_look.filter(|look| look.frame != frame) {
            view.look_again(look);
        }
        if let Some(preset) = view.wanted.filter(|_| !self.content.outline_m.is_empty()) {
            view.flight = None;
            view.wanted = None;
            match (preset, self.content.bounds_m, state.analysed()) {
                (ViewPreset::Station(station), Some((low, high)), Some(_)) => {
                    let middle = self.content.middle_of_prisms_m();
                    let target = middle.unwrap_or((low + high) / 2.0);
                    let station = Station::at(station);
                    let transforms = &self.content.station1_from_station;
                    if let Some(Some(transform)) = transforms.get(station) {
                        view.camera.stand(&transform.translation_m.cast::<f32>(), &target);
                    }
                }
                _ => view.camera.look(preset, &self.content.outline_m, &frame),
            }
            let early = state.active().is_some_and(OpenDeployment::joint_follows);
            view.last_look = Some(Look { preset, camera: view.camera, frame, early });
        }
        if let Some(flight) = &mut view.flight {
            if flight.advance(&mut view.camera, ui.input(|i| i.time)) {
                view.flight = None;
            } else {
                ui.ctx().request_repaint();
            }
        }
    }

    /// Follows the rig, as far as its position is known.
    fn follow(&self, view: &mut View, ui: &egui::Ui, following: bool) {
        if !following {
            view.follow = Follow::default();
            return;
        }
        let middle_m = self.content.middle_m.map(nalgebra::Matrix::cast::<f32>);
        if !view.follow.advance(&mut view.camera, middle_m, ui.input(|i| i.time)) {
            ui.ctx().request_repaint();
        }
    }

    fn paint_picture(
        &mut self,
        camera: &Camera,
        ui: &egui::Ui,
        painter: &egui::Painter,
        picture: egui::layers::ShapeIdx,
        rect: Rect,
    ) {
        let background = theme::scene_background(ui.visuals().dark_mode);
        match &mut self.renderer {
            Some(renderer) => {
                let pixels_per_point = ui.ctx().pixels_per_point();
                let texture =
                    renderer.draw(&self.content, camera, rect.size(), pixels_per_point, background);
                let whole = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
                painter.set(picture, egui::Shape::image(texture, rect, whole, Color32::WHITE));
            }
            None => {
                painter.set(picture, egui::Shape::rect_filled(rect, 0.0, background));
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

    fn paint_picked(
        &self,
        painter: &egui::Painter,
        projection: &Projection,
        open: &OpenDeployment,
        analysis: &Analysis,
        dark: bool,
    ) {
        let shown = |picked: &Picked| self.content.shows_reading(*picked);
        let Some(picked) = open.timeline.picked.filter(shown) else { return };
        let position_m = picked.place_m(&open.deployment, analysis);
        if let Some(at) = position_m.and_then(|p| projection.visible(&p)) {
            under_pointer::ring(painter, at, PICKED_RING, dark);
        }
    }

    /// Shows the hovered item here, and reports it to the other panes.
    fn show_hovered(
        &self,
        ui: &egui::Ui,
        response: &egui::Response,
        projection: &Projection,
        state: &State,
        commands: &mut Commands,
    ) {
        let Some((open, analysis)) = state.analysed() else { return };
        // No item is hovered while the camera moves.
        let Some(pointer) = response.hover_pos().filter(|_| !response.dragged()) else { return };
        let Some(under) = UnderPointer::find(&self.content, projection, pointer) else { return };
        commands
            .extend(under.time_s(open, analysis).map(|time_s| TimeCommand::Hover(time_s).into()));
        let UnderPointer::Reading(picked) = under else { return };
        let (painter, dark) = (ui.painter_at(projection.rect), ui.visuals().dark_mode);
        let position_m = under.position_m(open, analysis, &self.content);
        if let Some(at) = position_m.and_then(|p| projection.visible(&p)) {
            under_pointer::ring(&painter, at, HOVERED_RING, dark);
        }
        let lines = under_pointer::reading_lines(open, analysis, picked, state.workspace.units);
        under_pointer::tooltip(&painter, projection.rect, pointer, &lines, dark);
    }
}
