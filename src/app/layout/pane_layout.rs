//! The layout: a tree of panes, created from a description and convertible to one.

use std::collections::HashMap;

use egui_tiles::{Tile, TileId, Tree};

use super::behaviour::{Edits, PaneBehaviour, PictureWish};
use super::{fit, reopen, tree};
use crate::app::model::layout_description::Node;
use crate::app::model::{LayoutDescription, LayoutPreset, Pane, layout_presets};
use resect_core::deployment::Finding;

/// The tree of panes.
pub struct Layout {
    tree: Tree<Pane>,
    /// Shares of rows and columns in the description, by child; the tree has those adapted to the window's size.
    shares: HashMap<TileId, f32>,
    /// True if sizes follow the window, which ends once the user moves something.
    follows_window: bool,
    /// The preset of the layout, which determines the position of reopened panes.
    preset: Option<LayoutPreset>,
}

impl Default for Layout {
    /// The layout of the first window.
    fn default() -> Self {
        Self::of_root(&layout_presets::first(), true)
    }
}

impl From<LayoutPreset> for Layout {
    fn from(preset: LayoutPreset) -> Self {
        Self { preset: Some(preset), ..Self::of_root(&preset.root(), true) }
    }
}

impl Layout {
    /// A layout without any pane, a substitute while the panes are drawn.
    pub fn empty() -> Self {
        let tree = Tree::empty(egui::Id::unique("panes"));
        Self { tree, shares: HashMap::new(), follows_window: true, preset: None }
    }

    fn of_root(root: &Node, follows_window: bool) -> Self {
        let (tree, shares) = tree::tree_of(root);
        Self { tree, shares, follows_window, preset: None }
    }

    /// Creates the layout of a description, corrected, with the findings about it; that of the first window if no pane is left.
    pub fn of_description(description: &LayoutDescription) -> (Self, Vec<Finding>) {
        let (root, findings) = description.arrangement();
        let layout = root
            .map_or_else(Self::default, |root| Self::of_root(&root, description.follows_window));
        (layout, findings)
    }

    /// Returns the layout as plain data, for saving.
    pub fn describe(&self) -> LayoutDescription {
        let none = HashMap::new();
        let shares = if self.follows_window { &self.shares } else { &none };
        let root = tree::node_of(&self.tree, shares).unwrap_or_else(layout_presets::first);
        LayoutDescription::new(&root, self.follows_window)
    }

    /// Draws the panes; returns the picture of a pane that the user asks for.
    pub fn ui(
        &mut self,
        ui: &mut egui::Ui,
        draw: &mut dyn FnMut(Pane, &mut egui::Ui),
    ) -> Option<(Pane, PictureWish)> {
        if let (true, Some(root)) = (self.follows_window, self.tree.root) {
            fit::fit(&mut self.tree.tiles, &self.shares, root, ui.available_size());
        }
        let mut edits = Edits::default();
        self.tree.ui(&mut PaneBehaviour { draw, edits: &mut edits }, ui);
        self.follows_window &= !edits.moved;
        edits.picture
    }

    /// Activates a pane; reopens it if it was closed.
    pub fn show(&mut self, pane: Pane) {
        if !self.holds(pane) {
            let mut layouts: Vec<Node> = self.preset.map(LayoutPreset::root).into_iter().collect();
            layouts.push(layout_presets::first());
            // Panes of tuning, planning and live deployments are not in the first layout.
            layouts.extend(LayoutPreset::ALL.map(LayoutPreset::root));
            reopen::reopen(&mut self.tree, &mut self.shares, pane, &layouts);
        }
        self.tree.make_active(|_, tile| matches!(tile, Tile::Pane(p) if *p == pane));
    }

    /// Activates a pane, unless the user closed it.
    pub fn bring_forward(&mut self, pane: Pane) {
        if self.holds(pane) {
            self.show(pane);
        }
    }

    /// Returns the rectangle of a pane in the last frame (points, in the window); `None` if it was not drawn.
    pub fn place(&self, pane: Pane) -> Option<egui::Rect> {
        self.tree.tiles.find_pane(&pane).and_then(|tile| self.tree.tiles.rect(tile))
    }

    /// Returns true if the user moved nothing since the layout was chosen.
    pub fn is_as_chosen(&self) -> bool {
        self.follows_window
    }

    /// Returns true if a pane is in the window, active or not.
    pub fn holds(&self, pane: Pane) -> bool {
        self.tree.tiles.find_pane(&pane).is_some()
    }
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
