//! The legend of the scene, with counts; a click on a row shows or hides its subject.

use egui::{Color32, Rect, RichText, Role, Sense, Vec2, WidgetInfo};

use super::SceneContent;
use super::legend_rows::{self, LegendRow, Swatch};
use crate::app::model::{
    Added, Commands, JudgingCommand, OpenDeployment, SceneCommand, SceneOptions,
};
use crate::app::short;
use crate::app::state::State;
use crate::app::theme;
use crate::app::words;
use resect_core::analysis::Analysis;
use resect_report::glossary;
use resect_report::glossary::Term;

/// Size of the picture below which the legend starts folded (points).
const ROOM: Vec2 = Vec2::new(700.0, 420.0);
/// Constant width for any counts, since the camera looks beside the legend (points).
const WIDTH: f32 = 206.0;
const ROW: f32 = 18.0;
const MARGIN: f32 = 8.0;

/// Shows the legend in the upper left corner; returns its rectangle.
pub fn ui(
    ui: &mut egui::Ui,
    picture: Rect,
    (open, analysis): (&OpenDeployment, &Analysis),
    state: &State,
    content: &SceneContent,
    commands: &mut Commands,
) -> Option<Rect> {
    let unfolded = is_open(&state.scene.options, picture.size());
    if state.workspace.picturing && !unfolded {
        return None;
    }
    let width = if unfolded { WIDTH } else { picture.width() - 2.0 * MARGIN };
    let size = Vec2::new(width, (picture.height() - 2.0 * MARGIN).max(ROW));
    let room = Rect::from_min_size(picture.min + Vec2::splat(MARGIN), size);
    // Clicks and drags between the rows must not reach the scene below.
    let builder =
        egui::UiBuilder::new().max_rect(room).sense(Sense::CLICK | Sense::DRAG).id_salt("legend");
    let response = ui.scope_builder(builder, |ui| {
        let ground = ui.painter().add(egui::Shape::Noop);
        let inside = egui::Frame::new().inner_margin(egui::Margin::symmetric(6, 3));
        let inside = inside.show(ui, |ui| {
            ui.spacing_mut().item_spacing = Vec2::new(6.0, 1.0);
            if !state.workspace.picturing {
                header(ui, open, analysis, state, unfolded, commands);
            }
            if unfolded {
                ui.set_width(WIDTH - 12.0);
                egui::ScrollArea::vertical().show(ui, |ui| {
                    rows(ui, open, analysis, state, content, commands);
                });
            }
        });
        let place = inside.response.rect;
        // A frame shows that the lines of the scene go on below.
        let (fill, line) = (ui.visuals().panel_fill, ui.visuals().window_stroke);
        let frame = egui::epaint::RectShape::new(place, 4.0, fill, line, egui::StrokeKind::Inside);
        ui.painter().set(ground, frame);
        place
    });
    response.response.widget_info(|| WidgetInfo::labeled(Role::Group, true, "Key of the scene"));
    Some(response.inner)
}

/// Returns true if the legend is unfolded in a picture of this size.
pub fn is_open(options: &SceneOptions, size: Vec2) -> bool {
    options.legend_open.unwrap_or(size.x >= ROOM.x && size.y >= ROOM.y)
}

/// Shows the header: it folds and unfolds, counts the hidden items, and shows them again.
fn header(
    ui: &mut egui::Ui,
    open: &OpenDeployment,
    analysis: &Analysis,
    state: &State,
    unfolded: bool,
    commands: &mut Commands,
) {
    ui.horizontal(|ui| {
        let (icon, response) = ui.allocate_exact_size(Vec2::new(62.0, ROW), Sense::click());
        response.widget_info(|| {
            WidgetInfo::selected(Role::DisclosureTriangle, true, unfolded, "Legend")
        });
        let sign =
            Rect::from_center_size(icon.left_center() + Vec2::new(7.0, 0.0), Vec2::splat(9.0));
        let sign = response.clone().with_new_rect(sign);
        egui::collapsing_header::paint_default_icon(ui, f32::from(unfolded), &sign);
        let colour = ui.style().interact(&response).text_color();
        let (at, align) = (icon.left_center() + Vec2::new(17.0, 0.0), egui::Align2::LEFT_CENTER);
        ui.painter().text(at, align, "Legend", egui::FontId::proportional(12.0), colour);
        let hint = if unfolded { "Fold the legend" } else { "Unfold the legend" };
        if response.on_hover_text(hint).clicked() {
            let options = SceneOptions { legend_open: Some(!unfolded), ..state.scene.options };
            commands.push(SceneCommand::SetOptions(options).into());
        }
        let hidden = legend_rows::hidden(open, analysis, &state.scene.visibility);
        if hidden.is_empty() {
            return;
        }
        let button = egui::Button::new(RichText::new(format!("{} hidden", hidden.len())).small());
        let hint = format!("Hidden: {}. Click to show everything", hidden.join(", "));
        let button = ui.add(button.small());
        button.widget_info(|| WidgetInfo::labeled(Role::Button, true, "Show everything"));
        if button.on_hover_text(hint).clicked() {
            commands.push(SceneCommand::Show(state.scene.visibility.with_the_whole_scene()).into());
            let added = &open.judging.added;
            if added.iter().any(|one| !one.shown) {
                let shown = added.iter().map(|one| Added { shown: true, ..one.clone() });
                commands.push(JudgingCommand::Set(shown.collect()).into());
            }
        }
    });
}

fn rows(
    ui: &mut egui::Ui,
    open: &OpenDeployment,
    analysis: &Analysis,
    state: &State,
    content: &SceneContent,
    commands: &mut Commands,
) {
    let faint = theme::faint(ui.visuals().dark_mode);
    for group in legend_rows::groups(open, analysis, state, content, faint) {
        if group.chips {
            ui.horizontal(|ui| {
                ui.add_sized(
                    Vec2::new(52.0, ROW),
                    egui::Label::new(small(group.title)).halign(egui::Align::Min),
                );
                for chip in &group.rows {
                    row(ui, chip, Vec2::new(42.0, ROW), commands);
                }
            });
            continue;
        }
        if !group.title.is_empty() {
            ui.label(small(group.title));
        }
        // A picture lists only what it shows.
        for one in group.rows.iter().filter(|row| row.shown || !state.workspace.picturing) {
            row(ui, one, Vec2::new(ui.available_width(), ROW), commands);
        }
    }
    // The line below the scene states these factors, too.
    if state.workspace.picturing {
        return;
    }
    let scene = state.scene.options;
    if legend_rows::states_errors(analysis) {
        let set = |scale: Option<u32>| SceneOptions {
            ellipsoid_scale: scale.unwrap_or(scene.ellipsoid_scale),
            ..scene
        };
        let names = ("ellipsoids", "Scale of the ellipsoids");
        scale(ui, names, (Some(scene.ellipsoid_scale), None), set, commands);
    }
    if legend_rows::has_residuals(open, analysis) {
        let set = |scale| SceneOptions { residual_scale: scale, ..scene };
        let names = ("arrows", "Scale of the residuals");
        let drawn = content.arrows.map(|arrows| arrows.scale);
        scale(ui, names, (scene.residual_scale, drawn), set, commands);
    }
}

/// Returns the glossary terms of a row for F1: its subject, and the words in its name.
fn terms(name: &str) -> Vec<&'static Term> {
    let what: Option<&'static Term> = match name {
        name if name.starts_with("Show readings") => Some(&glossary::FATE),
        name if name.starts_with("Show station") => Some(&glossary::STATION),
        name if name.starts_with("Show the track of") => Some(&glossary::TRIPLET),
        name if name.contains("tube") => Some(&glossary::TRAJECTORY),
        _ => None,
    };
    let mut terms: Vec<&'static Term> = what.into_iter().collect();
    terms.extend(glossary::in_text(name).into_iter().filter(|term| what != Some(*term)));
    terms
}

fn small(text: &str) -> RichText {
    RichText::new(text).size(11.5).weak()
}

/// Shows a dot, filled if the subject is shown, and its name, struck through if hidden.
fn row(ui: &mut egui::Ui, row: &LegendRow, size: Vec2, commands: &mut Commands) {
    let clickable = row.click.is_some();
    let sense = if clickable { Sense::click() } else { Sense::hover() };
    let (rect, response) = ui.allocate_exact_size(size, sense);
    if clickable {
        response.widget_info(|| WidgetInfo::selected(Role::CheckBox, true, row.shown, &row.name));
        if response.hovered() || response.has_focus() {
            let fill = ui.visuals().widgets.hovered.weak_bg_fill;
            ui.painter().rect_filled(rect, 3.0, fill);
        }
    }
    if words::is_looked_at(&response) {
        words::mark(&response, &terms(&row.name));
    }
    if !clickable {
        response.widget_info(|| WidgetInfo::labeled(Role::Label, true, &row.name));
    }
    let middle = rect.left_center() + Vec2::new(8.0, 0.0);
    match row.swatch {
        Swatch::Colour(colour) if row.shown => {
            ui.painter().circle_filled(middle, 4.0, colour);
        }
        Swatch::Colour(colour) => {
            ui.painter().circle_stroke(middle, 3.5, (1.2, colour));
        }
        Swatch::Outlined(colour, outline) => {
            if row.shown {
                ui.painter().circle_filled(middle, 3.5, colour);
            }
            ui.painter().circle_stroke(middle, 4.5, (1.5, outline));
        }
        Swatch::None => {}
    }
    let text = ui.visuals().text_color();
    let colour = if row.shown { text } else { text.lerp_to_gamma(Color32::GRAY, 0.6) };
    let font = egui::FontId::proportional(11.5);
    let shown = short::in_the_middle(ui, &row.text, &font, rect.width() - 18.0);
    let mut format = egui::TextFormat::simple(font, colour);
    if !row.shown {
        format.strikethrough = egui::Stroke::new(1.0, colour);
    }
    let job = egui::text::LayoutJob::single_section(shown.clone(), format);
    let galley = ui.painter().layout_job(job);
    let at = rect.left_center() + Vec2::new(18.0, -0.5 * galley.size().y);
    ui.painter().galley(at, galley, colour);
    if let Some(click) = &row.click {
        let verb = if row.shown { "hide" } else { "show" };
        let subject = row.name.strip_prefix("Show ").unwrap_or(&row.name);
        let hint = format!("{subject}: click to {verb}");
        if words::on_hover_beside(response, &hint).clicked() {
            commands.push(click.clone());
        }
    } else {
        short::whole_on_hover(response, &shown, &row.name);
    }
}

/// Lets the user choose the enlargement of the drawn errors: the chosen one, and the drawn one where the program may choose.
fn scale(
    ui: &mut egui::Ui,
    (what, name): (&str, &str),
    (now, drawn): (Option<u32>, Option<u32>),
    set: impl Fn(Option<u32>) -> SceneOptions,
    commands: &mut Commands,
) {
    ui.horizontal(|ui| {
        ui.add_sized(Vec2::new(92.0, ROW), egui::Label::new(small(&format!("{what} drawn"))));
        let mut scale = now;
        let shown = now.or(drawn).map_or("–".to_owned(), |scale| format!("×{scale}"));
        let combo =
            egui::ComboBox::from_id_salt(name).width(72.0).selected_text(shown).show_ui(ui, |ui| {
                if drawn.is_some() {
                    ui.selectable_value(&mut scale, None, "to fit the view");
                }
                for choice in SceneOptions::ERROR_SCALES {
                    ui.selectable_value(&mut scale, Some(choice), format!("×{choice}"));
                }
            });
        combo.response.widget_info(|| WidgetInfo::labeled(Role::ComboBox, true, name));
        combo.response.on_hover_text("Magnification of the drawing; results do not change it");
        if scale != now {
            commands.push(SceneCommand::SetOptions(set(scale)).into());
        }
    });
}
