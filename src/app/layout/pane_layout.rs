//! The layout: a tree of panes, made from a description and described again.

use std::collections::HashMap;

use egui_tiles::{Tile, TileId, Tree};

use super::behaviour::{Edits, PaneBehaviour};
use super::{fit, reopen, tree};
use crate::app::model::layout_description::Node;
use crate::app::model::{LayoutDescription, LayoutPreset, Pane, layout_presets};
use resect_core::deployment::Finding;

/// The tree of panes.
pub struct Layout {
    tree: Tree<Pane>,
    /// Shares of rows and columns as described, by child; what the window's size makes of them is in the tree.
    shares: HashMap<TileId, f32>,
    /// Whether sizes follow the window: until the user moves something.
    follows_window: bool,
    /// The ready-made layout that it came from; closed panes come back to where that has them.
    preset: Option<LayoutPreset>,
}

impl Default for Layout {
    /// What the first window shows.
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
    /// A layout without any pane: what is left while the panes are drawn.
    pub fn empty() -> Self {
        let tree = Tree::empty(egui::Id::unique("panes"));
        Self { tree, shares: HashMap::new(), follows_window: true, preset: None }
    }

    fn of_root(root: &Node, follows_window: bool) -> Self {
        let (tree, shares) = tree::tree_of(root);
        Self { tree, shares, follows_window, preset: None }
    }

    /// The layout as described, with what is wrong put right; the first window's where no pane is left.
    pub fn of_description(description: &LayoutDescription) -> (Self, Vec<Finding>) {
        let (root, findings) = description.arrangement();
        let layout = root
            .map_or_else(Self::default, |root| Self::of_root(&root, description.follows_window));
        (layout, findings)
    }

    /// The layout as plain data, to be kept.
    pub fn describe(&self) -> LayoutDescription {
        let none = HashMap::new();
        let shares = if self.follows_window { &self.shares } else { &none };
        let root = tree::node_of(&self.tree, shares).unwrap_or_else(layout_presets::first);
        LayoutDescription::new(&root, self.follows_window)
    }

    /// Draws the panes where they are.
    pub fn ui(&mut self, ui: &mut egui::Ui, draw: &mut dyn FnMut(Pane, &mut egui::Ui)) {
        if let (true, Some(root)) = (self.follows_window, self.tree.root) {
            fit::fit(&mut self.tree.tiles, &self.shares, root, ui.available_size());
        }
        let mut edits = Edits::default();
        self.tree.ui(&mut PaneBehaviour { draw, edits: &mut edits }, ui);
        self.follows_window &= !edits.moved;
    }

    /// Brings a pane to the front of its tabs; back into the window where it was closed.
    pub fn show(&mut self, pane: Pane) {
        if !self.holds(pane) {
            let mut layouts: Vec<Node> = self.preset.map(LayoutPreset::root).into_iter().collect();
            layouts.push(layout_presets::first());
            // Panes before and during a drive are not in the first layout.
            layouts.extend([LayoutPreset::Plan, LayoutPreset::Live].map(LayoutPreset::root));
            reopen::reopen(&mut self.tree, &mut self.shares, pane, &layouts);
        }
        self.tree.make_active(|_, tile| matches!(tile, Tile::Pane(p) if *p == pane));
    }

    /// Where a pane was drawn in the last frame, in the window (points).
    pub fn place(&self, pane: Pane) -> Option<egui::Rect> {
        self.tree.tiles.find_pane(&pane).and_then(|tile| self.tree.tiles.rect(tile))
    }

    /// Whether the user moved nothing since the layout was chosen.
    pub fn is_as_chosen(&self) -> bool {
        self.follows_window
    }

    /// Whether a pane is in the window, in front or behind others.
    pub fn holds(&self, pane: Pane) -> bool {
        self.tree.tiles.find_pane(&pane).is_some()
    }
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
