//! A layout as plain data: what files hold and what the ready-made layouts are written in.
//!
//! The docking library has a format of its own, which changes with its versions; this one is resect's.

use serde::{Deserialize, Serialize};

use super::findings::layout_invalid;
use super::pane::Pane;
use resect_core::deployment::Finding;

/// Version of the format that this program writes.
const VERSION: u32 = 1;
/// No part of a row or column is smaller than this part of it: what is too narrow to be seen cannot be dragged open.
const SMALLEST_SHARE: f32 = 0.02;

/// A layout as it lies in a file; nothing about it is trusted until [`LayoutDescription::arrangement`] has read it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LayoutDescription {
    pub version: u32,
    /// Whether sizes follow the window, as they do until the user moves something.
    #[serde(default)]
    pub follows_window: bool,
    pub root: Node<String>,
}

/// A pane, or what holds panes. `P` is how panes are told: by name in files, checked inside the program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
pub enum Node<P = Pane> {
    Pane(P),
    /// Tabs: one of the children is seen, the others are hidden behind it.
    Tabs {
        /// Index of the child that is seen.
        #[serde(default)]
        active: i64,
        children: Vec<Node<P>>,
    },
    /// The children side by side, from left to right.
    Row {
        /// The part of the width that each child has; any unit.
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
    /// All panes in it, from left to right and top to bottom.
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

/// Tabs, of which the first is seen.
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

    /// The layout with everything wrong put right, or none where no pane is left; and what was wrong.
    ///
    /// Every pane of it is in tabs and there once, no container is empty or superfluous, and shares are above zero
    /// and sum to one.
    pub fn arrangement(&self) -> (Option<Node>, Vec<Finding>) {
        let mut reader = Reader::default();
        if self.version > VERSION {
            reader.finding(&format!(
                "the layout was written by a newer resect (its version {}, this one knows {VERSION}); what is known \
                 of it is used",
                self.version
            ));
        }
        let root = reader.read(&self.root).map(in_tabs);
        if root.is_none() {
            reader.finding("the layout holds no pane; the ready-made one is used");
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

/// A pane that stands alone gets tabs, to be moved and closed by.
fn in_tabs(node: Node) -> Node {
    match node {
        Node::Pane(pane) => tabs(&[pane]),
        other => other,
    }
}

/// Reads a description, collecting what is wrong with it.
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

    /// What is left of a node, and at which of its parent's places it stood.
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
            self.finding(&format!("the layout names a pane `{name}` that there is not; left out"));
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
                // Tabs of tabs are tabs.
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
                "the layout has sizes that are none (negative, zero, not a number, or too few); middling ones are used",
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
                // A row in a row is part of it.
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

/// Shares above zero made to sum to one, none too small to be seen; what is so already stays as it is.
pub fn normalised(shares: &[f32]) -> Vec<f32> {
    // By the largest first: a sum of very large ones is infinite.
    let largest = shares.iter().copied().fold(f32::MIN_POSITIVE, f32::max);
    let relative: Vec<f32> = shares.iter().map(|share| share / largest).collect();
    let smallest = SMALLEST_SHARE.min(0.5 / shares.len().max(1) as f32);
    let mut small = vec![false; shares.len()];
    // What too small ones get is taken from the others, which may make more of them too small.
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
