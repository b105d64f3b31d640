//! Where the panes are: docked, split and tabbed by the user, sized by the window until then.

use eframe::egui;
use egui_tiles::{
    Behavior, Container, Linear, LinearDir, SimplificationOptions, TileId, Tiles, Tree, UiResponse,
};

use super::scene::SceneView;
use super::state::{Commands, State};

/// The panes there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pane {
    Deployment,
    Pipeline,
    Scene,
    Result,
    Findings,
    Residuals,
    Histogram,
    PriorSearch,
    SideBySide,
    Studies,
    Reading,
    Runs,
}

impl Pane {
    pub const ALL: [Self; 12] = [
        Self::Deployment,
        Self::Pipeline,
        Self::Scene,
        Self::Studies,
        Self::SideBySide,
        Self::Result,
        Self::Residuals,
        Self::Findings,
        Self::PriorSearch,
        Self::Histogram,
        Self::Reading,
        Self::Runs,
    ];

    pub fn title(self) -> &'static str {
        match self {
            Self::Deployment => "Deployment",
            Self::Pipeline => "Pipeline",
            Self::Scene => "Scene",
            Self::Result => "Result",
            Self::Findings => "Findings",
            Self::Residuals => "Distance errors over time",
            Self::Histogram => "Histogram",
            Self::PriorSearch => "Prior search",
            Self::SideBySide => "Side by side",
            Self::Studies => "Studies",
            Self::Reading => "Reading",
            Self::Runs => "Runs",
        }
    }
}

/// What a pane is drawn from.
pub struct Panes<'a> {
    pub state: &'a State,
    pub commands: &'a mut Commands,
    pub scene: &'a mut SceneView,
}

/// The tree of panes.
pub struct Layout {
    tree: Tree<Pane>,
    /// Columns and rows whose shares follow the window until the user moves something.
    root: TileId,
    columns: [TileId; 3],
    left_rows: (TileId, [TileId; 2]),
    centre_rows: (TileId, [TileId; 2]),
    touched: bool,
}

/// Widths that the side columns need for their numbers (points).
const LEFT_POINTS: f32 = 286.0;
const RIGHT_POINTS: f32 = 372.0;
/// The part of the height that the plots get, and the deployment pane.
const PLOTS_SHARE: f32 = 0.32;
const DEPLOYMENT_POINTS: f32 = 300.0;

impl Default for Layout {
    fn default() -> Self {
        let mut tiles = Tiles::default();
        // Each a group of tabs, of which the first is shown.
        let groups: [&[Pane]; 6] = [
            &[Pane::Deployment],
            &[Pane::Pipeline, Pane::Reading],
            &[Pane::Scene, Pane::Studies, Pane::SideBySide],
            &[Pane::Result, Pane::Runs],
            &[Pane::Residuals, Pane::Findings, Pane::PriorSearch],
            &[Pane::Histogram],
        ];
        let [deployment, pipeline, scene, result, residuals, histogram] = groups.map(|panes| {
            let panes = panes.iter().map(|pane| tiles.insert_pane(*pane)).collect();
            tiles.insert_tab_tile(panes)
        });
        let linear = |tiles: &mut Tiles<Pane>, direction, children: &[TileId]| {
            tiles.insert_container(Linear::new(direction, children.to_vec()))
        };
        let left = linear(&mut tiles, LinearDir::Vertical, &[deployment, pipeline]);
        let plots = tiles.insert_container(Linear::new_binary(
            LinearDir::Horizontal,
            [residuals, histogram],
            0.66,
        ));
        let centre = linear(&mut tiles, LinearDir::Vertical, &[scene, plots]);
        let root = linear(&mut tiles, LinearDir::Horizontal, &[left, centre, result]);
        Self {
            tree: Tree::new(egui::Id::unique("panes"), root, tiles),
            root,
            columns: [left, centre, result],
            left_rows: (left, [deployment, pipeline]),
            centre_rows: (centre, [scene, plots]),
            touched: false,
        }
    }
}

impl Layout {
    pub fn ui(&mut self, ui: &mut egui::Ui, panes: &mut Panes<'_>) {
        if !self.touched {
            self.fit(ui.available_size());
        }
        let mut behaviour = PaneBehaviour { panes, edited: false };
        self.tree.ui(&mut behaviour, ui);
        self.touched |= behaviour.edited;
    }

    /// Brings a pane to the front of its tabs.
    pub fn show(&mut self, pane: Pane) {
        self.tree.make_active(|_, tile| matches!(tile, egui_tiles::Tile::Pane(p) if *p == pane));
    }

    /// Side columns as wide as their numbers need, the scene takes the rest.
    fn fit(&mut self, size: egui::Vec2) {
        let side = |points: f32| (points / size.x).clamp(0.1, 0.32);
        let (left, right) = (side(LEFT_POINTS), side(RIGHT_POINTS));
        self.share(
            self.root,
            &[
                (self.columns[0], left),
                (self.columns[1], 1.0 - left - right),
                (self.columns[2], right),
            ],
        );
        let top = (DEPLOYMENT_POINTS / size.y).clamp(0.2, 0.4);
        let (rows, [deployment, pipeline]) = self.left_rows;
        self.share(rows, &[(deployment, top), (pipeline, 1.0 - top)]);
        let (rows, [scene, plots]) = self.centre_rows;
        self.share(rows, &[(scene, 1.0 - PLOTS_SHARE), (plots, PLOTS_SHARE)]);
    }

    fn share(&mut self, container: TileId, shares: &[(TileId, f32)]) {
        if let Some(egui_tiles::Tile::Container(Container::Linear(linear))) =
            self.tree.tiles.get_mut(container)
        {
            for (child, share) in shares {
                linear.shares.set_share(*child, *share);
            }
        }
    }
}

struct PaneBehaviour<'a, 'b> {
    panes: &'a mut Panes<'b>,
    edited: bool,
}

impl Behavior<Pane> for PaneBehaviour<'_, '_> {
    fn pane_ui(&mut self, ui: &mut egui::Ui, _tile: TileId, pane: &mut Pane) -> UiResponse {
        ui.painter().rect_filled(ui.max_rect(), 0.0, ui.visuals().panel_fill);
        self.panes.pane(*pane, ui);
        UiResponse::None
    }

    fn tab_title_for_pane(&mut self, pane: &Pane) -> egui::WidgetText {
        pane.title().into()
    }

    fn simplification_options(&self) -> SimplificationOptions {
        SimplificationOptions { all_panes_must_have_tabs: true, ..Default::default() }
    }

    fn gap_width(&self, _style: &egui::Style) -> f32 {
        3.0
    }

    fn on_edit(&mut self, edit: egui_tiles::EditAction) {
        use egui_tiles::EditAction::{TileDropped, TileResized};
        self.edited |= matches!(edit, TileResized | TileDropped);
    }
}
