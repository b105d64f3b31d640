//! Conversion between descriptions and the tree of the docking library.

use std::collections::HashMap;

use egui_tiles::{Container, Linear, LinearDir, Tabs, Tile, TileId, Tiles, Tree};

use crate::app::model::layout_description::{Node, normalised};
use crate::app::model::pane::Pane;

/// Returns the tree of an arrangement, and each child's share of its row or column.
pub fn tree_of(root: &Node) -> (Tree<Pane>, HashMap<TileId, f32>) {
    let (mut tiles, mut shares) = (Tiles::default(), HashMap::new());
    let root = insert(&mut tiles, &mut shares, root);
    (Tree::new(egui::Id::unique("panes"), root, tiles), shares)
}

fn insert(tiles: &mut Tiles<Pane>, all: &mut HashMap<TileId, f32>, node: &Node) -> TileId {
    let mut linear = |direction, shares: &[f32], children: &[Node]| {
        let ids: Vec<TileId> = children.iter().map(|child| insert(tiles, all, child)).collect();
        let mut linear = Linear::new(direction, ids.clone());
        for (child, share) in ids.into_iter().zip(shares) {
            linear.shares.set_share(child, *share);
            all.insert(child, *share);
        }
        tiles.insert_container(linear)
    };
    match node {
        Node::Pane(pane) => tiles.insert_pane(*pane),
        Node::Row { shares, children } => linear(LinearDir::Horizontal, shares, children),
        Node::Column { shares, children } => linear(LinearDir::Vertical, shares, children),
        Node::Tabs { active, children } => {
            let ids: Vec<TileId> = children.iter().map(|child| insert(tiles, all, child)).collect();
            let active = usize::try_from(*active).ok().and_then(|at| ids.get(at).copied());
            let mut tabs = Tabs::new(ids);
            tabs.active = active.or(tabs.active);
            tiles.insert_container(tabs)
        }
    }
}

/// Returns the arrangement of a tree; `shares` has priority over the tree's own. `None` for an empty tree.
pub fn node_of(tree: &Tree<Pane>, shares: &HashMap<TileId, f32>) -> Option<Node> {
    node_at(&tree.tiles, shares, tree.root?)
}

fn node_at(tiles: &Tiles<Pane>, shares: &HashMap<TileId, f32>, tile: TileId) -> Option<Node> {
    let container = match tiles.get(tile)? {
        Tile::Pane(pane) => return Some(Node::Pane(*pane)),
        Tile::Container(container) => container,
    };
    let children: Vec<(TileId, Node)> = container
        .children()
        .filter_map(|child| Some((*child, node_at(tiles, shares, *child)?)))
        .collect();
    if children.is_empty() {
        return None;
    }
    let own_share = |child: &TileId| match container {
        Container::Linear(linear) => linear.shares[*child],
        Container::Tabs(_) | Container::Grid(_) => 1.0,
    };
    let shares: Vec<f32> = children
        .iter()
        .map(|(child, _)| shares.get(child).copied().unwrap_or_else(|| own_share(child)))
        .collect();
    let at = |tabs: &Tabs| children.iter().position(|(child, _)| tabs.active == Some(*child));
    let active = match container {
        Container::Tabs(tabs) => at(tabs).and_then(|at| i64::try_from(at).ok()).unwrap_or(0),
        Container::Linear(_) | Container::Grid(_) => 0,
    };
    let children = children.into_iter().map(|(_, node)| node).collect();
    Some(match container {
        Container::Tabs(_) => Node::Tabs { active, children },
        Container::Linear(Linear { dir: LinearDir::Vertical, .. }) => {
            Node::Column { shares: rounded(&shares), children }
        }
        // This program creates no grids.
        Container::Linear(_) | Container::Grid(_) => {
            Node::Row { shares: rounded(&shares), children }
        }
    })
}

/// Rounds shares to the resolution of a window. They still sum to one, so that reading and writing does not change them.
fn rounded(shares: &[f32]) -> Vec<f32> {
    const PARTS: f32 = 1e4;
    let mut parts: Vec<i32> =
        normalised(shares).into_iter().map(|share| (share * PARTS).round() as i32).collect();
    let rest = PARTS as i32 - parts.iter().sum::<i32>();
    if let Some(largest) = parts.iter_mut().max() {
        *largest += rest;
    }
    parts.into_iter().map(|part| part as f32 / PARTS).collect()
}
