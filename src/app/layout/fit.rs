//! Sizes that follow the window: lists get the width of their numbers, the scene and the plots the rest.

use std::collections::HashMap;

use egui::Vec2;
use egui_tiles::{Container, LinearDir, Tile, TileId, Tiles};

use crate::app::model::pane::Pane;

/// Widths of lists, sufficient for their numbers (points).
const LEFT_POINTS: f32 = 286.0;
const RIGHT_POINTS: f32 = 372.0;
/// Height of the list of stations (points).
const DEPLOYMENT_POINTS: f32 = 300.0;

/// Size that a tile needs along one direction.
#[derive(Clone, Copy)]
struct Need {
    points: f32,
    /// True if more is useful.
    grows: bool,
}

impl Need {
    const ANY: Self = Self { points: 0.0, grows: true };

    fn of_pane(pane: Pane, direction: LinearDir) -> Self {
        let fixed = |points| Self { points, grows: false };
        match (direction, pane) {
            (LinearDir::Horizontal, Pane::Deployment | Pane::Pipeline | Pane::Reading) => {
                fixed(LEFT_POINTS)
            }
            (LinearDir::Horizontal, Pane::Result | Pane::Runs | Pane::Findings | Pane::Guide) => {
                fixed(RIGHT_POINTS)
            }
            (LinearDir::Vertical, Pane::Deployment) => fixed(DEPLOYMENT_POINTS),
            _ => Self::ANY,
        }
    }

    /// Returns the need of both, shown in turn or across the direction.
    fn larger(self, other: Self) -> Self {
        Self { points: self.points.max(other.points), grows: self.grows || other.grows }
    }

    /// Returns the need of both, one after the other.
    fn sum(self, other: Self) -> Self {
        Self { points: self.points + other.points, grows: self.grows || other.grows }
    }
}

/// Smallest and largest share of a list.
fn limits(direction: LinearDir) -> (f32, f32) {
    match direction {
        LinearDir::Horizontal => (0.1, 0.32),
        LinearDir::Vertical => (0.2, 0.4),
    }
}

/// Sets all shares below a tile of this size; `base` has the shares in the description, by child.
pub fn fit(tiles: &mut Tiles<Pane>, base: &HashMap<TileId, f32>, tile: TileId, size: Vec2) {
    let Some(Tile::Container(container)) = tiles.get(tile) else { return };
    let children = container.children_vec();
    let Container::Linear(linear) = container else {
        for child in children {
            fit(tiles, base, child, size);
        }
        return;
    };
    let direction = linear.dir;
    let along = if direction == LinearDir::Horizontal { size.x } else { size.y };
    let asked: Vec<(Need, f32)> = children
        .iter()
        .map(|child| {
            let even = 1.0 / children.len() as f32;
            (need(tiles, *child, direction), base.get(child).copied().unwrap_or(even))
        })
        .collect();
    let shares = shares(&asked, along, limits(direction));
    if let Some(Tile::Container(Container::Linear(linear))) = tiles.get_mut(tile) {
        for (child, share) in children.iter().zip(&shares) {
            linear.shares.set_share(*child, *share);
        }
    }
    for (child, share) in children.into_iter().zip(shares) {
        let size = match direction {
            LinearDir::Horizontal => Vec2::new(size.x * share, size.y),
            LinearDir::Vertical => Vec2::new(size.x, size.y * share),
        };
        fit(tiles, base, child, size);
    }
}

fn need(tiles: &Tiles<Pane>, tile: TileId, direction: LinearDir) -> Need {
    let container = match tiles.get(tile) {
        Some(Tile::Pane(pane)) => return Need::of_pane(*pane, direction),
        Some(Tile::Container(container)) => container,
        None => return Need::ANY,
    };
    let needs = container.children().map(|child| need(tiles, *child, direction));
    let along = matches!(container, Container::Linear(linear) if linear.dir == direction);
    needs.reduce(if along { Need::sum } else { Need::larger }).unwrap_or(Need::ANY)
}

/// Returns shares of `size` (points) that sum to one, from each child's need and its share in the description.
fn shares(asked: &[(Need, f32)], size: f32, (least, most): (f32, f32)) -> Vec<f32> {
    let wanted = |need: Need| need.points / size.max(1.0);
    let grows = |(need, _): &&(Need, f32)| need.grows;
    if !asked.iter().any(|child| grows(&child)) {
        let sum: f32 = asked.iter().map(|(need, _)| need.points).sum();
        return asked.iter().map(|(need, _)| need.points / sum).collect();
    }
    let fixed = |need: Need| wanted(need).clamp(least, most);
    let taken: f32 = asked.iter().filter(|(n, _)| !n.grows).map(|(n, _)| fixed(*n)).sum();
    let base: f32 = asked.iter().filter(grows).map(|(_, base)| base).sum();
    let rest = (1.0 - taken).max(0.1);
    // Children below their need get the difference from those above it.
    let part = |need: Need, base_share: f32| base_share / base * rest - wanted(need).min(most);
    let growing = || asked.iter().filter(grows);
    let lacking: f32 = growing().map(|(need, share)| (-part(*need, *share)).max(0.0)).sum();
    let spare: f32 = growing().map(|(need, share)| part(*need, *share).max(0.0)).sum();
    let kept = if spare > 0.0 { (1.0 - lacking / spare).max(0.0) } else { 0.0 };
    let parts: Vec<f32> = asked
        .iter()
        .map(|(need, share)| {
            if need.grows {
                wanted(*need).min(most) + part(*need, *share).max(0.0) * kept
            } else {
                fixed(*need)
            }
        })
        .collect();
    let sum: f32 = parts.iter().sum();
    parts.into_iter().map(|part| part / sum).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIST: Need = Need { points: 300.0, grows: false };

    fn assert_close(found: &[f32], expected: &[f32]) {
        assert_eq!(found.len(), expected.len());
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-5, "{found} for {expected}");
        }
    }

    #[test]
    fn lists_get_their_points_and_the_rest_is_shared() {
        let asked = [(LIST, 0.5), (Need::ANY, 0.25), (Need::ANY, 0.75)];
        assert_close(&shares(&asked, 1500.0, (0.1, 0.32)), &[0.2, 0.2, 0.6]);
        // At most a third of a small window, at least a tenth of a large one.
        assert_close(&shares(&asked, 600.0, (0.1, 0.32)), &[0.32, 0.17, 0.51]);
        assert_close(&shares(&asked, 6000.0, (0.1, 0.32)), &[0.1, 0.225, 0.675]);
    }

    #[test]
    fn what_grows_never_gets_less_than_it_needs() {
        let needy = Need { points: 300.0, grows: true };
        let asked = [(Need::ANY, 0.9), (needy, 0.1)];
        assert_close(&shares(&asked, 1000.0, (0.1, 0.32)), &[0.7, 0.3]);
        assert_close(&shares(&asked, 6000.0, (0.1, 0.32)), &[0.9, 0.1]);
    }

    #[test]
    fn every_size_gives_shares_that_sum_to_one() {
        let needy = Need { points: 372.0, grows: true };
        let cases = [
            vec![(LIST, 1.0), (LIST, 1.0)],
            vec![(LIST, 0.3); 5],
            vec![(needy, 0.2), (LIST, 0.3), (needy, 0.2), (needy, 0.2)],
        ];
        for asked in cases {
            for size in [0.0, 1.0, 100.0, 900.0, 1100.0, 1920.0, 3840.0, f32::MAX] {
                let found = shares(&asked, size, (0.1, 0.32));
                assert!(found.iter().all(|s| s.is_finite() && *s > 0.0), "{size}: {found:?}");
                assert!((found.iter().sum::<f32>() - 1.0).abs() < 1e-4, "{size}: {found:?}");
            }
        }
    }
}
