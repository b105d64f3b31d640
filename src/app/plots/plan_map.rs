//! The plan from above: handles for stations and track, with the track coloured by the predicted σ of the vehicle's position.

use egui::accesskit::Role;
use egui::{Color32, Pos2, Rect, Sense, Shape, Stroke, Vec2, WidgetInfo};
use egui_plot::{Line, Plot, PlotBounds, PlotPoint, PlotPoints, PlotTransform, PlotUi};

use super::strips::{axis_below, bare_axis};
use super::{LABELS, round_marks, time_plot};
use crate::app::model::planning::{Addition, Handle, Planning};
use crate::app::model::{Commands, PlanCommand};
use crate::app::state::State;
use crate::app::theme;
use resect_core::calibration::inter_prism::observability::Hold;
use resect_core::deployment::Severity;
use resect_tools::palette;
use resect_tools::planning::{OnTheWay, Plan, Prediction};

/// Half the side of the square in which a handle reacts to the pointer (points).
const REACH: f32 = 9.0;
const RADIUS: f32 = 5.5;
/// Radius of the ring about the far end (points).
const FAR_END: f32 = 9.0;
/// Number of handles from which waypoints are drawn smaller.
const MANY: usize = 30;
/// Length of the arrows along weak directions (points).
const ARROW: f32 = 46.0;
/// Scroll distance that zooms by a factor of e (points).
const WHEEL: f32 = 240.0;
/// Magnification of the stations' σ.
const SIGMA_SCALE: f64 = 1000.0;
/// Height of the legend, and size of its colour scale (points).
const KEY: f32 = 30.0;
const SCALE: Vec2 = Vec2::new(60.0, 8.0);
/// Margin about the plan (share of its size).
const ROOM: f64 = 0.12;

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    let planning = &state.planning;
    let plan = &planning.plan;
    let fit_id = ui.scope_id().with("fit");
    let mut fit: bool = ui.data(|data| data.get_temp(fit_id)).unwrap_or(true);
    let middle_id = ui.scope_id().with("middle");
    let middle_m: [f64; 2] = ui.data(|data| data.get_temp(middle_id)).unwrap_or([40.0, 0.0]);
    if !state.workspace.picturing {
        time_plot::head(ui, |ui| head(ui, planning, middle_m, &mut fit, commands));
    }
    let foreseen = planning.foreseen.newest.as_deref().and_then(|found| found.as_ref().ok());
    let on_the_way = foreseen.map_or(&[][..], |foreseen| &foreseen.way);
    let bounds = bounds(plan);
    let height = ui.available_height() - KEY;
    let plot = Plot::new("plan")
        .height(height)
        .data_aspect(1.0)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .allow_double_click_reset(false)
        .show_crosshair(false)
        .custom_x_axes(vec![axis_below("x (m)")])
        .custom_y_axes(vec![
            bare_axis().label_spacing(LABELS).label(egui::RichText::new("y (m)").small()),
        ])
        .x_grid_spacer(round_marks)
        .y_grid_spacer(round_marks)
        .label_formatter(|_| None);
    let planned: Vec<[f64; 2]> = plan.waypoints().iter().map(|at| [at.x_m, at.y_m]).collect();
    let faint = theme::faint(ui.visuals().dark_mode);
    let margin = egui::Margin { left: 4, right: 4, ..Default::default() };
    let add = |plot_ui: &mut PlotUi<'_>| {
        if fit {
            plot_ui.set_plot_bounds(bounds);
        }
        let wheel = plot_ui.ctx().input(|input| input.smooth_scroll_delta().y);
        if wheel != 0.0 && plot_ui.response().hovered() {
            plot_ui.zoom_bounds_around_hovered(Vec2::splat((wheel / WHEEL).exp()));
        }
        let way = Line::new("", PlotPoints::from(planned)).color(faint).width(1.0);
        // Without this, `egui_plot` draws a track straight along y as a band.
        plot_ui.line(way.allow_band(false));
    };
    // The name of an axis extends a little beyond it.
    let shown = egui::Frame::new().inner_margin(margin).show(ui, |ui| plot.show(ui, add)).inner;
    let (response, transform) = (shown.response, shown.transform);
    response.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, "the plan from above"));
    if response.dragged() || response.hovered() && ui.input(|i| i.smooth_scroll_delta().y != 0.0) {
        fit = false;
    }
    if response.double_clicked() {
        fit = true;
    }
    let painter = ui.painter().with_clip_rect(*transform.frame());
    if !planning.is_foreseen() {
        ui.ctx().request_repaint_after(std::time::Duration::from_millis(30));
    }
    paint_way(&painter, &transform, on_the_way);
    if let Some(foreseen) = foreseen {
        paint_failures(&painter, &transform, foreseen);
        paint_stations_sigma(&painter, &transform, plan, foreseen);
        paint_weak(&painter, &transform, plan, foreseen);
        paint_far_end(ui, &painter, &transform, plan, foreseen);
    }
    for ramp in &plan.ground.ramps {
        let [x, y] = ramp.centre_m;
        let radius = (transform.dpos_dvalue_x() * ramp.radius_m).abs() as f32;
        painter.circle_stroke(at(&transform, [x, y]), radius, Stroke::new(1.0, faint));
    }
    handles(ui, state, &transform, commands);
    if response.clicked() {
        commands.push(PlanCommand::Select(None).into());
    }
    key(ui, on_the_way);
    let centre = transform.value_from_position(transform.frame().center());
    ui.data_mut(|data| {
        data.insert_temp(fit_id, fit);
        data.insert_temp(middle_id, [centre.x, centre.y]);
    });
}

/// Draws the buttons that add and remove items and fit the view, and the hint for the pointer.
fn head(
    ui: &mut egui::Ui,
    planning: &Planning,
    middle_m: [f64; 2],
    fit: &mut bool,
    commands: &mut Commands,
) {
    ui.menu_button("Add…", |ui| {
        for addition in Addition::ALL {
            if ui.button(addition.name()).clicked() {
                let plan = addition.put(&planning.plan, middle_m);
                commands.push(PlanCommand::Set(plan.into(), "an item of the plan added").into());
            }
        }
    })
    .response
    .on_hover_text("Adds it at the view centre; drag it into place");
    let without = planning.selected.and_then(|handle| handle.taken_out(&planning.plan));
    let remove = ui.add_enabled(without.is_some(), egui::Button::new("Remove"));
    let remove = remove.on_disabled_hover_text(
        "Select a waypoint, manoeuvre or ramp first. Stations cannot be removed; a path keeps two waypoints",
    );
    let by_key = planning.selected.is_some()
        && !ui.ctx().egui_wants_keyboard_input()
        && ui.input(|input| input.key_pressed(egui::Key::Delete));
    if let Some(plan) = without.filter(|_| remove.clicked() || by_key) {
        commands.push(PlanCommand::Set(plan.into(), "an item of the plan removed").into());
    }
    if ui.button("Fit").on_hover_text("Shows the whole plan (or double-click)").clicked() {
        *fit = true;
    }
    let hint = "drag an item: move it · scroll: zoom · drag the ground: pan";
    ui.add(egui::Label::new(egui::RichText::new(hint).small().weak()).truncate());
}

/// Bounds of the whole plan, with a margin.
fn bounds(plan: &Plan) -> PlotBounds {
    let places = Handle::all(plan).into_iter().filter_map(|handle| handle.place_m(plan));
    let waypoints = plan.waypoints();
    let all = places.chain(waypoints.iter().map(|at| [at.x_m, at.y_m]));
    let (mut min, mut max) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for place in all {
        for axis in 0..2 {
            min[axis] = min[axis].min(place[axis]);
            max[axis] = max[axis].max(place[axis]);
        }
    }
    for axis in 0..2 {
        let room = (ROOM * (max[axis] - min[axis])).max(1.0);
        (min[axis], max[axis]) = (min[axis] - room, max[axis] + room);
    }
    PlotBounds::from_min_max(min, max)
}

fn at(transform: &PlotTransform, [x, y]: [f64; 2]) -> Pos2 {
    transform.position_from_point(&PlotPoint::new(x, y))
}

/// Draws the track, coloured by the predicted σ from the best place to the worst; grey where no motion is predicted.
fn paint_way(painter: &egui::Painter, transform: &PlotTransform, way: &[OnTheWay]) {
    let Some([least, most]) = sigma_range_m(way) else { return };
    for pair in way.windows(2) {
        let ends = [0, 1].map(|k| at(transform, [pair[k].position_m.x, pair[k].position_m.y]));
        let colour = match pair[1].position_sigma_m {
            Some(sigma_m) => sigma_colour(sigma_m, [least, most]),
            None => theme::rgb(palette::NO_VALUE).gamma_multiply(0.5),
        };
        painter.line_segment(ends, Stroke::new(3.0, colour));
    }
}

/// Draws the legend of colours and signs.
fn key(ui: &mut egui::Ui, way: &[OnTheWay]) {
    ui.horizontal(|ui| {
        ui.add_space(6.0);
        if let Some([least_m, most_m]) = sigma_range_m(way) {
            ui.small(format!("vehicle σ: {:.1}", 1e3 * least_m));
            let (place, _) = ui.allocate_exact_size(SCALE, Sense::hover());
            let width = place.width() / 24.0;
            for step in 0..24 {
                let left = place.left() + width * step as f32;
                let part = Rect::from_x_y_ranges(left..=left + width + 0.5, place.y_range());
                let colour = theme::rgb(palette::continuous(step as f32 / 23.0));
                ui.painter().rect_filled(part, 0.0, colour);
            }
            ui.small(format!("{:.1} mm (1 σ)", 1e3 * most_m));
        }
        let signs =
            format!("ellipses: stations, 95 %, ×{SIGMA_SCALE} · ×: readings that will be unusable");
        ui.add(egui::Label::new(egui::RichText::new(signs).small().weak()).truncate());
    });
}

/// Least and greatest σ of the vehicle's position along the track (m); `None` without any.
fn sigma_range_m(way: &[OnTheWay]) -> Option<[f64; 2]> {
    let all = || way.iter().filter_map(|at| at.position_sigma_m);
    let (least, most) = (all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max));
    (least <= most).then_some([least, most])
}

fn sigma_colour(sigma_m: f64, [least, most]: [f64; 2]) -> Color32 {
    let share = (sigma_m - least) / (most - least).max(1e-12);
    theme::rgb(palette::continuous(share as f32))
}

/// Draws crosses where readings will be missing or rejected.
fn paint_failures(painter: &egui::Painter, transform: &PlotTransform, foreseen: &Prediction) {
    for (station, lock) in foreseen.locks.iter().enumerate() {
        let stroke = Stroke::new(1.6, theme::rgb(palette::station(station)));
        for failure in &lock.failures {
            let middle = at(transform, [failure.position_m.x, failure.position_m.y]);
            for turn in [Vec2::splat(4.0), Vec2::new(4.0, -4.0)] {
                painter.line_segment([middle - turn, middle + turn], stroke);
            }
        }
    }
}

/// Draws magnified 95 % ellipses of the predicted positions of the other stations.
fn paint_stations_sigma(
    painter: &egui::Painter,
    transform: &PlotTransform,
    plan: &Plan,
    foreseen: &Prediction,
) {
    const SIGMAS_95: f64 = 2.4477;
    const CORNERS: usize = 48;
    let Some(held) = &foreseen.held else { return };
    // The prediction may be of an earlier plan, with other stations.
    for (slot, middle) in plan.stations_m.iter().skip(1).enumerate() {
        if held.covariance.nrows() < 4 * (slot + 1) {
            break;
        }
        let of_station = held.covariance.fixed_view::<2, 2>(4 * slot, 4 * slot).into_owned();
        let Some(root) = of_station.cholesky() else { continue };
        let corner = |k: usize| {
            let (sin, cos) = (std::f64::consts::TAU * k as f64 / CORNERS as f64).sin_cos();
            let out = root.l() * nalgebra::Vector2::new(cos, sin) * SIGMAS_95 * SIGMA_SCALE;
            at(transform, [middle.x + out.x, middle.y + out.y])
        };
        let colour = theme::rgb(palette::station(slot + 1));
        let outline = Stroke::new(1.2, colour.gamma_multiply(0.8));
        painter.add(Shape::closed_line((0..CORNERS).map(corner).collect(), outline));
    }
}

/// Draws arrows at the stations along unobservable or weakly observable directions.
fn paint_weak(
    painter: &egui::Painter,
    transform: &PlotTransform,
    plan: &Plan,
    foreseen: &Prediction,
) {
    let directions = foreseen.observability.iter().flat_map(|observed| &observed.directions);
    for direction in directions.filter(|direction| direction.hold != Hold::Held) {
        let stroke = Stroke::new(2.0, theme::rgb(palette::hold(direction.hold)));
        for (station, motion) in direction.motion.each().skip(1) {
            let level = motion.translation_m.xy();
            let Some(station_m) = plan.stations_m.get(station) else { continue };
            let start = at(transform, [station_m.x, station_m.y]);
            if level.norm() > 1e-3 {
                let along = Vec2::new(level.x as f32, -level.y as f32).normalized();
                painter.arrow(start, ARROW * along, stroke);
                painter.arrow(start, -ARROW * along, stroke);
            }
        }
    }
}

fn paint_far_end(
    ui: &egui::Ui,
    painter: &egui::Painter,
    transform: &PlotTransform,
    plan: &Plan,
    foreseen: &Prediction,
) {
    let Some(held) = &foreseen.held else { return };
    let place = held.far_end.position_m;
    let middle = at(transform, [place.x, place.y]);
    let sigma_mm = 1e3 * held.far_end.sigma_m;
    let dark = ui.visuals().dark_mode;
    let colour = match sigma_mm <= plan.target_mm {
        true => theme::readable(palette::DONE, dark),
        false => theme::severity(Severity::Warning, dark).0,
    };
    painter.circle_stroke(middle, FAR_END, Stroke::new(1.6, colour));
    let text = format!("far end, prism {}: {sigma_mm:.1} mm", held.far_end.station + 1);
    let font = egui::FontId::proportional(12.0);
    let galley = painter.layout_no_wrap(text, font, colour);
    let way: Vec<Pos2> = (foreseen.way.iter())
        .map(|on_it| at(transform, [on_it.position_m.x, on_it.position_m.y]))
        .collect();
    let ground = beside_the_way(middle, galley.size(), *transform.frame(), &way);
    // A line connects a label with its place if the label had to move away.
    let towards = ground.clamp(middle) - middle;
    if towards.length() > 2.0 * FAR_END {
        let from = middle + towards.normalized() * FAR_END;
        painter.line_segment([from, middle + towards], Stroke::new(1.0, colour));
    }
    painter.rect_filled(ground, 2.0, ui.visuals().panel_fill.gamma_multiply(0.8));
    painter.galley(ground.min + Vec2::splat(2.0), galley, colour);
}

/// Returns the nearest rectangle beside a place, within a frame, that covers the least of the track.
fn beside_the_way(middle: Pos2, size: Vec2, frame: Rect, way: &[Pos2]) -> Rect {
    const OUT: f32 = 14.0;
    let half = 0.5 * size + Vec2::splat(2.0);
    let sides = [[1.0, 0.0], [-1.0, 0.0], [0.0, -1.0], [0.0, 1.0]];
    let corners = [[1.0, -1.0], [-1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let places = [1.0, 1.7, 2.5].into_iter().flat_map(|times| {
        sides.into_iter().chain(corners).map(move |[x, y]: [f32; 2]| {
            let out = Vec2::new(x * (OUT + half.x), y * (OUT + half.y)) * times;
            let place = Rect::from_center_size(middle + out, 2.0 * half);
            let back =
                (frame.min - place.min).max(Vec2::ZERO) + (frame.max - place.max).min(Vec2::ZERO);
            place.translate(back)
        })
    });
    let covered = |place: &Rect| {
        let on_it = way.iter().chain([&middle]).filter(|at| place.expand(4.0).contains(**at));
        (on_it.count(), place.distance_to_pos(middle) as i32)
    };
    places.min_by_key(covered).expect("there are places")
}

/// Handles drags and clicks of all handles, and draws them above all else.
fn handles(ui: &mut egui::Ui, state: &State, transform: &PlotTransform, commands: &mut Commands) {
    let plan = &state.planning.plan;
    let all = Handle::all(plan);
    let radius = if all.len() > MANY { 0.25 * RADIUS } else { RADIUS };
    let dark = ui.visuals().dark_mode;
    let frame = *transform.frame();
    for handle in all {
        let Some(place_m) = handle.place_m(plan) else { continue };
        let middle = at(transform, place_m);
        if !frame.contains(middle) {
            continue;
        }
        let place = Rect::from_center_size(middle, Vec2::splat(2.0 * REACH));
        let response = ui.interact(place, ui.scope_id().with(handle), Sense::click_and_drag());
        let name = handle.name(plan);
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
        if let Some(pointer) = response.interact_pointer_pos().filter(|_| response.dragged()) {
            let to = transform.value_from_position(pointer.clamp(frame.min, frame.max));
            // Rounds to centimetres: nobody sets up a tripod more precisely on purpose.
            let to_m = [to.x, to.y].map(|value| (1e2 * value).round() / 1e2);
            let plan = handle.moved(plan, to_m);
            commands.push(PlanCommand::Set(plan.into(), words(handle)).into());
        }
        if response.clicked() || response.drag_started() {
            commands.push(PlanCommand::Select(Some(handle)).into());
        }
        let selected = state.planning.selected == Some(handle);
        let lit = selected || response.hovered() || response.dragged();
        paint_handle(ui, handle, middle, radius, lit, dark);
        let said = match handle {
            Handle::Station(station) => {
                let z_m = plan.stations_m[station].z;
                format!("{name}: x {:.2}  y {:.2}  z {z_m:.2} m", place_m[0], place_m[1])
            }
            _ => format!("{name}: x {:.2}  y {:.2} m", place_m[0], place_m[1]),
        };
        response.on_hover_text(said);
    }
}

fn words(handle: Handle) -> &'static str {
    match handle {
        Handle::Station(_) => "a station of the plan moved",
        Handle::Waypoint { .. } => "a waypoint of the plan moved",
        Handle::Middle(_) | Handle::Tip(_) => "a manoeuvre of the plan moved",
        Handle::Ramp(_) => "a ramp of the plan moved",
    }
}

fn paint_handle(ui: &egui::Ui, handle: Handle, middle: Pos2, radius: f32, lit: bool, dark: bool) {
    let painter = ui.painter();
    let ink = theme::rgb(theme::cursor(dark));
    let ring = Stroke::new(if lit { 2.5 } else { 1.2 }, if lit { ink } else { theme::faint(dark) });
    match handle {
        Handle::Station(station) => {
            let colour = theme::rgb(palette::station(station));
            let corners = [0, 1, 2].map(|k| {
                let angle = std::f32::consts::TAU * k as f32 / 3.0;
                middle + 1.6 * RADIUS * Vec2::new(angle.sin(), -angle.cos())
            });
            let fill = Shape::convex_polygon(corners.to_vec(), colour, ring);
            painter.add(fill);
            // Stations are close to each other, so only the number is drawn; hovering shows the rest.
            let font = egui::FontId::proportional(13.0);
            let above = middle - Vec2::new(0.0, 11.0);
            let ink = theme::readable(palette::station(station), dark);
            let number = (station + 1).to_string();
            painter.text(above, egui::Align2::CENTER_BOTTOM, number, font, ink);
        }
        Handle::Waypoint { .. } => {
            // Many waypoints must not hide the colours of the track.
            let radius = if lit { radius.max(0.6 * RADIUS) } else { radius };
            painter.circle(middle, 0.8 * radius, ui.visuals().panel_fill, ring);
        }
        Handle::Middle(_) | Handle::Ramp(_) => {
            let square = Rect::from_center_size(middle, Vec2::splat(1.8 * radius));
            painter.rect_filled(square, 1.0, ui.visuals().panel_fill);
            painter.rect_stroke(square, 1.0, ring, egui::StrokeKind::Middle);
        }
        Handle::Tip(_) => {
            painter.circle(middle, 0.8 * radius, theme::faint(dark), ring);
        }
    }
}
