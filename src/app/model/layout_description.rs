//! A layout as plain data, for files and for the presets.
//!
//! The docking library's own format changes with its versions; this one belongs to resect.

use serde::{Deserialize, Serialize};

use super::findings::layout_invalid;
use super::pane::Pane;
use resect_core::deployment::Finding;

/// Version of the format that this program writes.
const VERSION: u32 = 1;
/// Smallest share of a child in a row or column; a narrower one could not be dragged open.
const SMALLEST_SHARE: f32 = 0.02;

/// A layout as read from a file, unchecked until [`LayoutDescription::arrangement`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LayoutDescription {
    pub version: u32,
    /// True if sizes follow the window; false after the user moved or resized a pane.
    #[serde(default)]
    pub follows_window: bool,
    pub root: Node<String>,
}

/// A pane, or a container of panes. `P` identifies panes: by name in files, by checked value inside the program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
pub enum Node<P = Pane> {
    Pane(P),
    /// Tabs: the active child is visible, the others are hidden behind it.
    Tabs {
        /// Index of the visible child.
        #[serde(default)]
        active: i64,
        children: Vec<Node<P>>,
    },
    /// The children side by side, from left to right.
    Row {
        /// Share of the width of each child; any unit.
        #[serde(default)]
        shares: Vec<f32>,
        children: Vec<Node<P>>,
    },
    /// The children one under the other, from top to bottom.
    Column {
        #[serde(default)]
        shares: Vec<f32>,
        children: Vec<Node<P>>,
    },
}

impl<P: Clone> Node<P> {
    /// Returns all panes of the node, from left to right and top to bottom.
    pub fn panes(&self) -> Vec<P> {
        match self {
            Self::Pane(pane) => vec![pane.clone()],
            Self::Tabs { children, .. }
            | Self::Row { children, .. }
            | Self::Column { children, .. } => children.iter().flat_map(Self::panes).collect(),
        }
    }

    fn is_row(&self) -> bool {
        matches!(self, Self::Row { .. })
    }
}

/// Returns tabs with the first pane active.
pub fn tabs(panes: &[Pane]) -> Node {
    Node::Tabs { active: 0, children: panes.iter().map(|pane| Node::Pane(*pane)).collect() }
}

pub fn row<const N: usize>(parts: [(f32, Node); N]) -> Node {
    let (shares, children) = parts.into_iter().unzip();
    Node::Row { shares, children }
}

pub fn column<const N: usize>(parts: [(f32, Node); N]) -> Node {
    let (shares, children) = parts.into_iter().unzip();
    Node::Column { shares, children }
}

impl LayoutDescription {
    pub fn new(root: &Node, follows_window: bool) -> Self {
        Self { version: VERSION, follows_window, root: named(root) }
    }

    /// Returns the corrected layout, `None` if no pane is left, and the findings about its errors.
    ///
    /// Every pane of it is in tabs and occurs once. No container is empty or superfluous. Shares are positive and sum to one.
    pub fn arrangement(&self) -> (Option<Node>, Vec<Finding>) {
        let mut reader = Reader::default();
        if self.version > VERSION {
            reader.finding(&format!(
                "the layout was written by a newer resect (version {}, supported: {VERSION}); unknown parts \
                 are ignored",
                self.version
            ));
        }
        let root = reader.read(&self.root).map(in_tabs);
        if root.is_none() {
            reader.finding("the layout contains no pane; the default layout is used");
        }
        (root, reader.findings)
    }
}

fn named(node: &Node) -> Node<String> {
    let all = |children: &[Node]| children.iter().map(named).collect();
    match node {
        Node::Pane(pane) => Node::Pane(pane.name().to_owned()),
        Node::Tabs { active, children } => Node::Tabs { active: *active, children: all(children) },
        Node::Row { shares, children } => {
            Node::Row { shares: shares.clone(), children: all(children) }
        }
        Node::Column { shares, children } => {
            Node::Column { shares: shares.clone(), children: all(children) }
        }
    }
}

/// Wraps a single pane in tabs, by which it can be moved and closed.
fn in_tabs(node: Node) -> Node {
    match node {
        Node::Pane(pane) => tabs(&[pane]),
        other => other,
    }
}

/// Reads a description and collects its errors.
#[derive(Default)]
struct Reader {
    seen: Vec<Pane>,
    findings: Vec<Finding>,
}

impl Reader {
    fn finding(&mut self, message: &str) {
        let finding = layout_invalid(message);
        if !self.findings.contains(&finding) {
            self.findings.push(finding);
        }
    }

    /// Returns the valid children, each with its index in the parent.
    fn read_all(&mut self, children: &[Node<String>]) -> Vec<(usize, Node)> {
        let read = |(at, child)| self.read(child).map(|node| (at, node));
        children.iter().enumerate().filter_map(read).collect()
    }

    fn read(&mut self, node: &Node<String>) -> Option<Node> {
        match node {
            Node::Pane(name) => self.pane(name).map(Node::Pane),
            Node::Tabs { active, children } => self.tabs(*active, children),
            Node::Row { shares, children } | Node::Column { shares, children } => {
                self.linear(node.is_row(), shares, children)
            }
        }
    }

    fn pane(&mut self, name: &str) -> Option<Pane> {
        let Some(pane) = Pane::of_name(name) else {
            self.finding(&format!("the layout names an unknown pane `{name}`; ignored"));
            return None;
        };
        if self.seen.contains(&pane) {
            self.finding(&format!("the layout has the pane `{name}` twice; the first is kept"));
            return None;
        }
        self.seen.push(pane);
        Some(pane)
    }

    fn tabs(&mut self, active: i64, children: &[Node<String>]) -> Option<Node> {
        let mut kept = Vec::new();
        let mut seen_child = 0;
        for (at, child) in self.read_all(children) {
            if i64::try_from(at) == Ok(active) {
                seen_child = kept.len();
            }
            match child {
                // Flattens tabs in tabs.
                Node::Tabs { active: inner, children } => {
                    if i64::try_from(at) == Ok(active) {
                        seen_child += usize::try_from(inner).unwrap_or(0);
                    }
                    kept.extend(children);
                }
                other => kept.push(other),
            }
        }
        match kept.len() {
            0 => None,
            1 if !matches!(kept[0], Node::Pane(_)) => kept.pop(),
            _ => {
                Some(Node::Tabs { active: i64::try_from(seen_child).unwrap_or(0), children: kept })
            }
        }
    }

    fn linear(&mut self, is_row: bool, shares: &[f32], children: &[Node<String>]) -> Option<Node> {
        let good = |share: &f32| share.is_finite() && *share > 0.0;
        let wrong = shares.len() != children.len() || !shares.iter().all(good);
        if wrong && !shares.is_empty() {
            self.finding(
                "the layout has invalid sizes (negative, zero, not a number, or too few); the mean size is used instead",
            );
        }
        let (sum, count) = shares
            .iter()
            .filter(|share| good(share))
            .fold((0.0, 0), |(sum, count), share| (sum + f64::from(*share), count + 1));
        let middling = if count == 0 { 1.0 } else { (sum / f64::from(count)) as f32 };
        let share_of = |at: usize| shares.get(at).copied().filter(good).unwrap_or(middling);
        let read = self.read_all(children);
        let kept = normalised(&read.iter().map(|(at, _)| share_of(*at)).collect::<Vec<_>>());
        let mut flat_shares = Vec::new();
        let mut flat = Vec::new();
        for ((_, child), share) in read.into_iter().zip(kept) {
            match child {
                // Flattens a row in a row, or a column in a column.
                Node::Row { shares, children } if is_row => {
                    flat_shares.extend(shares.iter().map(|inner| inner * share));
                    flat.extend(children);
                }
                Node::Column { shares, children } if !is_row => {
                    flat_shares.extend(shares.iter().map(|inner| inner * share));
                    flat.extend(children);
                }
                other => {
                    flat_shares.push(share);
                    flat.push(in_tabs(other));
                }
            }
        }
        match flat.len() {
            0 => None,
            1 => flat.pop(),
            _ => {
                let shares = normalised(&flat_shares);
                Some(if is_row {
                    Node::Row { shares, children: flat }
                } else {
                    Node::Column { shares, children: flat }
                })
            }
        }
    }
}

/// Normalises positive shares to sum 1, each large enough to be visible; valid shares do not change.
pub fn normalised(shares: &[f32]) -> Vec<f32> {
    // Divides by the largest first, as the sum of very large shares is infinite.
    let largest = shares.iter().copied().fold(f32::MIN_POSITIVE, f32::max);
    let relative: Vec<f32> = shares.iter().map(|share| share / largest).collect();
    let smallest = SMALLEST_SHARE.min(0.5 / shares.len().max(1) as f32);
    let mut small = vec![false; shares.len()];
    // Enlarging the small shares reduces the others, some of which may then become too small.
    loop {
        let room = 1.0 - smallest * small.iter().filter(|small| **small).count() as f32;
        let others = relative.iter().zip(&small).filter(|(_, small)| !**small);
        let sum: f32 = others.map(|(share, _)| share).sum();
        let share_of = |(share, small): (&f32, &bool)| {
            if *small { smallest } else { share / sum * room }
        };
        let visible: Vec<f32> = relative.iter().zip(&small).map(share_of).collect();
        if visible.iter().all(|share| *share >= smallest) {
            return visible;
        }
        small = visible.iter().map(|share| *share <= smallest).collect();
    }
}
