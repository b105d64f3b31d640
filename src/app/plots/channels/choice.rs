//! Choice of the channels, of their horizontal axis, and of the plot that each is in.

use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{Popup, PopupCloseBehavior, Rect, Sense, Vec2, WidgetInfo};

use crate::app::model::channel_plots::{APART, Horizontal, UNITS, subject_name};
use crate::app::model::{ChannelPlots, Commands, TimeCommand};
use crate::app::plots::strips::Strip;
use crate::app::prepared::channels::Channel;
use crate::app::words;

/// Side of the button of a plot (points).
pub const BUTTON: f32 = 16.0;

/// Lets the user choose the channels, their horizontal axis, and the plots of errors.
pub fn choice(ui: &mut egui::Ui, plots: &ChannelPlots, can_judge: bool, commands: &mut Commands) {
    let mut chosen = plots.clone();
    let stays = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    MenuButton::new("Show…").config(stays).ui(ui, |ui| {
        if can_judge {
            error_switches(ui, &mut chosen);
            ui.separator();
        }
        for (index, channel) in Channel::ALL.into_iter().enumerate() {
            if index == Channel::OF_VEHICLE {
                ui.separator();
                ui.checkbox(&mut chosen.fates, "fates of readings").on_hover_text(
                    "Readings that are not used have crosses, in the colours of the scene",
                );
            }
            let mut on = plots.shows(channel);
            let name = if index < Channel::OF_VEHICLE {
                format!("vehicle: {}", channel.name())
            } else {
                channel.name().to_owned()
            };
            let row = ui.checkbox(&mut on, name);
            if words::on_hover_beside(row, channel.describe().hint).clicked() {
                chosen = chosen.toggled(channel);
            }
        }
    });
    if plots.channels().next().is_some() {
        against(ui, plots, &mut chosen);
    }
    if chosen != *plots {
        commands.push(TimeCommand::Plot(chosen).into());
    }
}

/// Lets the user choose the channel on the horizontal axis of all plots.
fn against(ui: &mut egui::Ui, plots: &ChannelPlots, chosen: &mut ChannelPlots) {
    ui.small("against");
    let shown = plots.against.map_or_else(|| "time".to_owned(), Horizontal::name);
    let menu = MenuButton::new(format!("{shown} ▼")).ui(ui, |ui| {
        if ui.selectable_label(plots.against.is_none(), "time").clicked() {
            chosen.against = None;
        }
        for channel in Channel::ALL {
            if channel.subject().is_single() {
                horizontal(ui, plots, chosen, Horizontal::own(channel), channel.name());
                continue;
            }
            ui.menu_button(channel.name(), |ui| {
                horizontal(ui, plots, chosen, Horizontal::own(channel), "each its own");
                for index in 0..3 {
                    let other = Horizontal { channel, index: Some(index) };
                    horizontal(ui, plots, chosen, other, &subject_name(channel.subject(), index));
                }
            });
        }
    });
    let name = "Plotted against";
    let role = egui::accesskit::Role::ComboBox;
    menu.0.widget_info(|| WidgetInfo::labeled(role, true, name));
}

/// An entry of the menu of horizontal axes.
fn horizontal(
    ui: &mut egui::Ui,
    plots: &ChannelPlots,
    chosen: &mut ChannelPlots,
    other: Horizontal,
    name: &str,
) {
    let on = plots.against == Some(other);
    let entry = egui::Button::selectable(on, name);
    let possible = plots.goes_against(other);
    let entry = ui.add_enabled(possible, entry);
    let hint = if possible { other.channel.describe().hint } else { APART };
    if words::on_hover_beside(entry, hint).clicked() {
        chosen.against = Some(other);
    }
}

fn error_switches(ui: &mut egui::Ui, chosen: &mut ChannelPlots) {
    ui.checkbox(&mut chosen.errors, "errors")
        .on_hover_text("Errors of each added trajectory, with the σ of the ground truth");
    ui.add_enabled_ui(chosen.errors, |ui| {
        ui.checkbox(&mut chosen.by_distance, "by distance")
            .on_hover_text("Errors over the driven distance instead of time");
        ui.checkbox(&mut chosen.one_scale, "one scale")
            .on_hover_text("All errors on the same scale");
    });
}

/// The plot that is dragged onto another, by its index.
#[derive(Clone, Copy)]
struct DraggedPlot(usize);

/// Shows the button of a plot beside it. Its menu joins and separates channels; dragging it onto another plot joins both.
pub fn plot_button(
    ui: &mut egui::Ui,
    strip: &Strip,
    plots: &ChannelPlots,
    index: usize,
    commands: &mut Commands,
) {
    let plot = &plots.shown[index];
    let corner = strip.words.right_top() - Vec2::new(BUTTON, 0.0);
    let id = ui.scope_id().with(("plot", index));
    let whole = strip.plot.union(strip.words);
    let target = ui.interact(whole, id.with("target"), Sense::hover());
    let button =
        ui.interact(Rect::from_min_size(corner, Vec2::splat(BUTTON)), id, Sense::click_and_drag());
    let name = format!("Axes of {}", plot.name());
    button.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, &name));
    let colour = ui.style().interact(&button).text_color();
    for offset in [-4.0, 0.0, 4.0] {
        ui.painter().circle_filled(button.rect.center() + Vec2::new(0.0, offset), 1.3, colour);
    }
    if button.has_focus() {
        let stroke = ui.visuals().selection.stroke;
        ui.painter().rect_stroke(button.rect, 2.0, stroke, egui::StrokeKind::Inside);
    }
    button.dnd_set_drag_payload(DraggedPlot(index));
    let mut chosen = None;
    Popup::menu(&button).show(|ui| entries(ui, plots, index, &mut chosen));
    if !button.dragged() {
        button.on_hover_text(
            "Axes and channels of this plot. Drag it onto another plot to join both",
        );
    }
    if let Some(dragged) = target.dnd_hover_payload::<DraggedPlot>().filter(|it| it.0 != index) {
        let possible = plots.joined(dragged.0, index).is_some();
        let colour =
            if possible { ui.visuals().selection.stroke.color } else { egui::Color32::RED };
        ui.painter().rect_stroke(whole, 3.0, (2.0, colour), egui::StrokeKind::Inside);
    }
    if let Some(dragged) = target.dnd_release_payload::<DraggedPlot>() {
        chosen = plots.joined(dragged.0, index);
    }
    commands.extend(chosen.map(|chosen| TimeCommand::Plot(chosen).into()));
}

/// Entries of a plot's menu: join with another plot; for each channel, its axis and a plot of its own.
fn entries(
    ui: &mut egui::Ui,
    plots: &ChannelPlots,
    index: usize,
    chosen: &mut Option<ChannelPlots>,
) {
    let plot = &plots.shown[index];
    let mut offer = |ui: &mut egui::Ui, name: String, to: Option<ChannelPlots>, why: &str| {
        let entry = ui.add_enabled(to.is_some(), egui::Button::new(name));
        if entry.on_disabled_hover_text(why).clicked() {
            *chosen = to;
        }
    };
    for (other, host) in plots.shown.iter().enumerate().filter(|(other, _)| *other != index) {
        offer(ui, format!("Join with {}", host.name()), plots.joined(index, other), UNITS);
    }
    let is_shared = plot.channels().count() > 1;
    for (channel, right) in plot.channels() {
        let name = channel.name();
        if is_shared {
            let side = if right { "left" } else { "right" };
            let to = plot.with_other_axis(channel).map(|changed| {
                let mut plots = plots.clone();
                plots.shown[index] = changed;
                plots
            });
            let why = "That axis has another unit, or this one would be empty";
            offer(ui, format!("{name}: {side} axis"), to, why);
            offer(ui, format!("{name}: own plot"), Some(plots.separated(channel)), "");
        }
        offer(ui, format!("Remove {name}"), Some(plots.toggled(channel)), "");
    }
}
