//! Appearance and interaction of tabs.

use egui::style::ScrollAnimation;
use egui::{Align2, Rect, Sense, Stroke, TextStyle, WidgetInfo, vec2};
use egui_tiles::{
    Behavior, Container, EditAction, SimplificationOptions, TabState, Tile, TileId, Tiles,
    UiResponse,
};

use crate::app::model::pane::Pane;
use crate::app::words;
use resect_report::glossary;

/// Side of the cross that closes a tab, and its distance from the title (points).
const CROSS_POINTS: f32 = 12.0;
const CROSS_GAP_POINTS: f32 = 4.0;
/// Smallest size of a pane (points); below it nothing is legible, and margins would leave a negative size.
const LEAST_PANE: egui::Vec2 = vec2(64.0, 32.0);

/// Changes of the layout by the user in a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Edits {
    /// A border or a tab was dragged.
    pub moved: bool,
    /// A picture of a pane was asked for: to be copied, or with choices first.
    pub picture: Option<(Pane, PictureWish)>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureWish {
    Copy,
    Choose,
}

/// Draws panes with `draw`, and records the changes by the user.
pub struct PaneBehaviour<'a> {
    pub draw: &'a mut dyn FnMut(Pane, &mut egui::Ui),
    pub edits: &'a mut Edits,
}

/// Keeps the tree in the shape of the descriptions.
pub const SIMPLIFICATION: SimplificationOptions = SimplificationOptions {
    prune_empty_tabs: true,
    prune_empty_containers: true,
    prune_single_child_tabs: true,
    prune_single_child_containers: true,
    all_panes_must_have_tabs: true,
    join_nested_linear_containers: true,
    flatten_tabs_in_tabs: true,
};

impl Behavior<Pane> for PaneBehaviour<'_> {
    fn pane_ui(&mut self, ui: &mut egui::Ui, _tile: TileId, pane: &mut Pane) -> UiResponse {
        let room = ui.available_size();
        if room.x >= LEAST_PANE.x && room.y >= LEAST_PANE.y {
            (self.draw)(*pane, ui);
        } else {
            let (place, colour) = (ui.max_rect(), ui.visuals().weak_text_color());
            let font = TextStyle::Body.resolve(ui.style());
            ui.painter().text(place.center(), Align2::CENTER_CENTER, "…", font, colour);
        }
        UiResponse::None
    }

    fn tab_title_for_pane(&mut self, pane: &Pane) -> egui::WidgetText {
        pane.title().into()
    }

    /// A row or column that was dropped among tabs is named after its content.
    fn tab_title_for_tile(&mut self, tiles: &Tiles<Pane>, tile: TileId) -> egui::WidgetText {
        title(tiles, tile).into()
    }

    /// All panes but the last of the window can be closed.
    fn is_tab_closable(&self, tiles: &Tiles<Pane>, _tile: TileId) -> bool {
        tiles.tiles().filter(|tile| tile.is_pane()).count() > 1
    }

    fn tab_ui(
        &mut self,
        tiles: &mut Tiles<Pane>,
        ui: &mut egui::Ui,
        id: egui::Id,
        tile: TileId,
        state: &TabState,
    ) -> egui::Response {
        let title = title(tiles, tile);
        // Only the active tab has a cross; the others need their width for their titles.
        let closable = state.closable && state.active;
        let font = TextStyle::Button.resolve(ui.style());
        let text = egui::WidgetText::from(title.as_str());
        let galley = text.into_galley(ui, Some(egui::TextWrapMode::Extend), f32::INFINITY, font);
        let margin = self.tab_title_spacing(ui.visuals());
        let cross = if closable { CROSS_GAP_POINTS + CROSS_POINTS } else { 0.0 };
        let size = vec2(galley.size().x + 2.0 * margin + cross, ui.available_height());
        let (_, rect) = ui.allocate_space(size);
        let tab = ui
            .interact(rect, id, Sense::click_and_drag())
            .on_hover_cursor(self.tab_hover_cursor_icon());
        tab.widget_info(|| {
            WidgetInfo::selected(egui::Role::Button, ui.is_enabled(), state.active, &title)
        });
        match tiles.get(tile) {
            Some(Tile::Pane(Pane::Clocks)) => {
                words::mark(&tab, &[&glossary::OWN_CLOCK, &glossary::CLOCK_OFFSET]);
            }
            Some(Tile::Pane(Pane::PriorSearch)) => {
                words::mark(&tab, &[&glossary::PRIOR, &glossary::TAU_V]);
            }
            Some(Tile::Pane(Pane::Channels)) => words::mark(&tab, &[&glossary::READING]),
            Some(Tile::Pane(Pane::Rates)) => {
                words::mark(&tab, &[&glossary::OUTLIER_FILTER, &glossary::TAU_R]);
            }
            _ => words::mark_text(&tab, &title),
        }
        if state.active && comes_to_front(ui, id) {
            // The bar may be scrolled to other tabs.
            ui.scroll_to_rect_animation(rect, None, ScrollAnimation::none());
        }
        // During a drag, the gap marks the tab's origin.
        if ui.is_rect_visible(rect) && !state.is_being_dragged {
            let ground = self.tab_bg_color(ui.visuals(), tiles, tile, state);
            let outline = self.tab_outline_stroke(ui.visuals(), tiles, tile, state);
            let outline = if tab.has_focus() { ui.visuals().selection.stroke } else { outline };
            let inside = egui::StrokeKind::Inside;
            ui.painter().rect(rect.shrink(0.5), 0.0, ground, outline, inside);
            if state.active {
                // Joins the tab to its content.
                let line = Stroke::new(outline.width + 1.0, ground);
                ui.painter().hline(rect.x_range(), rect.bottom(), line);
            }
            let colour = self.tab_text_color(ui.visuals(), tiles, tile, state);
            let place =
                Align2::LEFT_CENTER.align_size_within_rect(galley.size(), rect.shrink(margin));
            ui.painter().galley(place.min, galley, colour);
        }
        if let Some(Tile::Pane(pane)) = tiles.get(tile) {
            tab.context_menu(|ui| {
                for (name, wish) in
                    [("Copy picture", PictureWish::Copy), ("Picture…", PictureWish::Choose)]
                {
                    if ui.button(name).clicked() {
                        self.edits.picture = Some((*pane, wish));
                    }
                }
            });
        }
        let mut close = state.closable && tab.clicked_by(egui::PointerButton::Middle);
        if closable {
            let square = egui::Vec2::splat(CROSS_POINTS);
            let place = Align2::RIGHT_CENTER.align_size_within_rect(square, rect.shrink(margin));
            close |= close_button(ui, id.with("close"), place, &format!("Close {title}"));
        }
        if close {
            tiles.remove(tile);
        }
        tab
    }

    fn simplification_options(&self) -> SimplificationOptions {
        SIMPLIFICATION
    }

    fn gap_width(&self, _style: &egui::Style) -> f32 {
        3.0
    }

    fn on_edit(&mut self, edit: EditAction) {
        use EditAction::{TileDropped, TileResized};
        self.edits.moved |= matches!(edit, TileResized | TileDropped);
    }
}

/// Returns true if an active tab was not active in the previous pass.
fn comes_to_front(ui: &egui::Ui, id: egui::Id) -> bool {
    let (id, now) = (id.with("in front"), ui.ctx().cumulative_pass_nr());
    let last: Option<u64> = ui.data(|data| data.get_temp(id));
    ui.data_mut(|data| data.insert_temp(id, now));
    last.is_none_or(|last| last + 1 < now)
}

/// Draws a cross with a name; returns true if it was clicked.
fn close_button(ui: &egui::Ui, id: egui::Id, place: Rect, name: &str) -> bool {
    let response = ui.interact(place, id, Sense::click()).on_hover_text(name);
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, ui.is_enabled(), name));
    let visuals = ui.style().interact(&response);
    let cross = place.shrink(2.5).expand(visuals.expansion);
    let stroke =
        if response.has_focus() { ui.visuals().selection.stroke } else { visuals.fg_stroke };
    ui.painter().line_segment([cross.left_top(), cross.right_bottom()], stroke);
    ui.painter().line_segment([cross.right_top(), cross.left_bottom()], stroke);
    response.clicked()
}

fn title(tiles: &Tiles<Pane>, tile: TileId) -> String {
    match tiles.get(tile) {
        Some(Tile::Pane(pane)) => pane.title().to_owned(),
        Some(Tile::Container(Container::Tabs(tabs))) => {
            tabs.active.map_or_else(String::new, |active| title(tiles, active))
        }
        Some(Tile::Container(container)) => {
            let titles: Vec<String> =
                container.children().map(|child| title(tiles, *child)).collect();
            titles.join(" + ")
        }
        None => String::new(),
    }
}
