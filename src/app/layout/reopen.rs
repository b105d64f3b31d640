//! Reopens a closed pane at its place in a layout preset, as far as that place still exists.

use std::collections::HashMap;

use egui_tiles::{Container, Linear, LinearDir, Tabs, Tile, TileId, Tiles, Tree};

use crate::app::model::layout_description::Node;
use crate::app::model::pane::Pane;

/// A place relative to panes that the tree still has.
enum Place {
    /// Among the tabs of these panes.
    With(Vec<Pane>),
    /// In tabs of its own, before or after the smallest container of these panes.
    Beside { panes: Vec<Pane>, direction: LinearDir, before: bool, share: f32 },
}

/// Inserts a pane that the tree lacks, at its place in the first of these layouts that has one.
pub fn reopen(
    tree: &mut Tree<Pane>,
    shares: &mut HashMap<TileId, f32>,
    pane: Pane,
    layouts: &[Node],
) {
    let present = |panes: Vec<Pane>| -> Vec<Pane> {
        panes.into_iter().filter(|pane| tree.tiles.find_pane(pane).is_some()).collect()
    };
    let place = layouts.iter().find_map(|layout| place_in(layout, pane, &present));
    let new = tree.tiles.insert_pane(pane);
    let Some(root) = tree.root else {
        tree.root = Some(tree.tiles.insert_tab_tile(vec![new]));
        return;
    };
    match place {
        Some(Place::With(panes)) => {
            let neighbour = panes.iter().find_map(|pane| tree.tiles.find_pane(pane));
            add_tab(tree, neighbour.unwrap_or(root), new);
        }
        Some(Place::Beside { panes, direction, before, share }) => {
            let held: Vec<TileId> =
                panes.iter().filter_map(|pane| tree.tiles.find_pane(pane)).collect();
            let part = common_part(&tree.tiles, &held).unwrap_or(root);
            let new = tree.tiles.insert_tab_tile(vec![new]);
            shares.insert(new, share);
            split(tree, part, new, direction, before, share);
        }
        None => add_tab(tree, root, new),
    }
}

fn place_in(node: &Node, pane: Pane, present: &impl Fn(Vec<Pane>) -> Vec<Pane>) -> Option<Place> {
    let (direction, shares, children) = match node {
        Node::Pane(_) => return None,
        Node::Tabs { .. } => {
            let panes = node.panes();
            let neighbours = present(panes.clone());
            let found = panes.contains(&pane) && !neighbours.is_empty();
            return found.then_some(Place::With(neighbours));
        }
        Node::Row { shares, children } => (LinearDir::Horizontal, shares, children),
        Node::Column { shares, children } => (LinearDir::Vertical, shares, children),
    };
    let at = children.iter().position(|child| child.panes().contains(&pane))?;
    place_in(&children[at], pane, present).or_else(|| {
        // The nearest child that still exists: the one after it, or else those before it.
        let after = children[at + 1..].iter().map(|child| (child, true));
        let before = children[..at].iter().rev().map(|child| (child, false));
        after.chain(before).find_map(|(child, before)| {
            let panes = present(child.panes());
            let share = shares.get(at).copied().unwrap_or(0.5);
            (!panes.is_empty()).then_some(Place::Beside { panes, direction, before, share })
        })
    })
}

/// Returns the smallest container of all these panes.
fn common_part(tiles: &Tiles<Pane>, panes: &[TileId]) -> Option<TileId> {
    let ancestors = |pane: TileId| std::iter::successors(Some(pane), |tile| tiles.parent_of(*tile));
    let (first, others) = panes.split_first()?;
    ancestors(*first)
        .skip(1)
        .find(|part| others.iter().all(|pane| ancestors(*pane).any(|tile| tile == *part)))
}

/// Adds a tab beside a tile: to the tabs that contain it, or to the first ones inside it.
fn add_tab(tree: &mut Tree<Pane>, beside: TileId, new: TileId) {
    let holder = tree.tiles.parent_of(beside).unwrap_or(beside);
    let mut at = holder;
    loop {
        match tree.tiles.get_mut(at) {
            Some(Tile::Container(Container::Tabs(tabs))) => {
                tabs.add_child(new);
                return;
            }
            Some(Tile::Container(container)) => {
                let first = container.children().next().copied();
                let Some(child) = first else {
                    container.add_child(new);
                    return;
                };
                at = child;
            }
            Some(Tile::Pane(_)) | None => break,
        }
    }
    // A pane without tabs, which exists only before the first frame.
    let tabs = tree.tiles.insert_container(Tabs::new(vec![at, new]));
    replace(tree, at, tabs);
}

/// Inserts `new` before or after `part`, with this share of both.
fn split(
    tree: &mut Tree<Pane>,
    part: TileId,
    new: TileId,
    direction: LinearDir,
    before: bool,
    share: f32,
) {
    let parent = tree.tiles.parent_of(part);
    // Inserts into an existing row or column: `part` itself, or its parent.
    for (holder, at) in [(Some(part), None), (parent, Some(part))] {
        let Some(holder) = holder else { continue };
        if let Some(Tile::Container(Container::Linear(linear))) = tree.tiles.get_mut(holder)
            && linear.dir == direction
        {
            let place = at.and_then(|part| linear.children.iter().position(|c| *c == part));
            let (first, last) = (place.unwrap_or(0), place.unwrap_or(linear.children.len() - 1));
            let sum: f32 = linear.children.iter().map(|child| linear.shares[*child]).sum();
            let share = share.clamp(0.1, 0.9);
            linear.shares.set_share(new, sum * share / (1.0 - share));
            linear.children.insert(if before { first } else { last + 1 }, new);
            return;
        }
    }
    let children = if before { vec![new, part] } else { vec![part, new] };
    let mut linear = Linear::new(direction, children);
    linear.shares.set_share(new, share);
    linear.shares.set_share(part, 1.0 - share);
    let both = tree.tiles.insert_container(linear);
    replace(tree, part, both);
}

/// Replaces `tile` by `by`, which contains it.
fn replace(tree: &mut Tree<Pane>, tile: TileId, by: TileId) {
    let parents: Vec<TileId> = tree.tiles.tile_ids().filter(|id| *id != by).collect();
    for parent in parents {
        if let Some(Tile::Container(container)) = tree.tiles.get_mut(parent)
            && container.replace_child(tile, by).is_some()
        {
            return;
        }
    }
    if tree.root == Some(tile) {
        tree.root = Some(by);
    }
}
