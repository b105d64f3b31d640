//! Picking among millions of points without a search of all.
//!
//! Points are grouped in boxes, boxes in larger boxes; the search opens a box only if its projection reaches the pointer.

use egui::{Pos2, Rect};
use nalgebra::{Matrix4, Vector3, Vector4};
use rayon::prelude::*;

/// A point in its station's frame, as the GPU stores it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct TimedPoint {
    pub position_m: [f32; 3],
    /// Time since [`super::time_origin_s`] (s).
    pub time_s: f32,
}

/// Points in the smallest boxes, and boxes in each larger one.
const LEAF: usize = 64;
const BRANCH: usize = 8;
/// Steps along each axis in the order of the points: 21 bits each for three axes.
const STEPS: f32 = 2_097_151.0;
/// Distance within which all points count as under the pointer; the one nearest to the eye is chosen (points).
const UNDER_POINTS: f32 = 2.0;

#[derive(Clone, Copy, Debug)]
struct Aabb {
    low: Vector3<f32>,
    high: Vector3<f32>,
}

/// One station's points, grouped in boxes.
#[derive(Clone, Debug, Default)]
pub struct PointTree {
    /// The points in the order of the boxes; empty for their own order.
    order: Vec<u32>,
    /// Boxes by level, from the smallest to the largest.
    levels: Vec<Vec<Aabb>>,
}

/// A point under the pointer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Index of the point among its station's points.
    pub index: usize,
    /// Distance from the pointer on the screen (points), at least [`UNDER_POINTS`].
    pub distance_points: f32,
    /// Depth from the eye (clip z): increases with the distance, in parallel projection too.
    pub depth: f32,
}

impl Hit {
    /// Returns true if it is nearer to the pointer, or as near and in front.
    pub fn beats(&self, other: Option<&Self>) -> bool {
        other.is_none_or(|other| {
            (self.distance_points, self.depth) < (other.distance_points, other.depth)
        })
    }
}

/// The view for picking.
pub struct PickView {
    /// Transform from the frame of the points to clip coordinates.
    pub clip_from_points: Matrix4<f32>,
    pub rect: Rect,
    pub pointer: Pos2,
    /// Greatest distance of a point from the pointer (egui's points).
    pub reach_points: f32,
}

impl PickView {
    /// Projects a point; `None` in front of the near plane or beyond the far one, where nothing is drawn.
    fn see(&self, index: usize, position_m: [f32; 3]) -> Option<Hit> {
        let [x, y, z] = position_m;
        let clip = self.clip_from_points * Vector4::new(x, y, z, 1.0);
        if clip.w <= 0.0 || clip.z < 0.0 || clip.z > clip.w {
            return None;
        }
        let distance_points = self.on_screen(&clip).distance(self.pointer);
        let hit = Hit { index, distance_points: distance_points.max(UNDER_POINTS), depth: clip.z };
        (distance_points <= self.reach_points).then_some(hit)
    }

    fn on_screen(&self, clip: &Vector4<f32>) -> Pos2 {
        let half = 0.5 * self.rect.size();
        self.rect.center() + egui::vec2(clip.x / clip.w * half.x, -clip.y / clip.w * half.y)
    }

    /// Returns a lower bound of the distance from the pointer to a box's points; `None` if none is visible.
    fn least_distance(&self, aabb: &Aabb) -> Option<f32> {
        let mut seen = Rect::NOTHING;
        let (mut before, mut behind) = (false, false);
        for corner in 0..8_u8 {
            let side = |axis: usize| if corner >> axis & 1 == 0 { aabb.low } else { aabb.high };
            let corner = Vector4::new(side(0).x, side(1).y, side(2).z, 1.0);
            let clip = self.clip_from_points * corner;
            if clip.w > 1e-6 {
                before = true;
                seen.extend_with(self.on_screen(&clip));
            } else {
                behind = true;
            }
        }
        match (before, behind) {
            (false, _) => None,
            // A box on both sides of the eye may be visible anywhere.
            (true, true) => Some(0.0),
            // Rounding must not lose a point on the edge.
            (true, false) => Some((seen.distance_to_pos(self.pointer) - 0.5).max(0.0)),
        }
    }
}

impl PointTree {
    /// Groups points in the given order.
    pub fn by_time(points: &[TimedPoint]) -> Self {
        Self::grouped(points, Vec::new())
    }

    /// Groups neighbouring points: along the curve that interleaves the bits of
    /// their coordinates (Morton 1966, "A computer oriented geodetic data base").
    pub fn by_place(points: &[TimedPoint]) -> Self {
        let Some(all) = Aabb::around(points.iter()) else { return Self::default() };
        let size = (all.high - all.low).map(|side| side.max(1e-3));
        let mut keys: Vec<(u64, u32)> = points
            .par_iter()
            .enumerate()
            .map(|(index, point)| {
                let share = (Vector3::from(point.position_m) - all.low).component_div(&size);
                let [x, y, z] = share.map(|share| spread((share * STEPS) as u64)).into();
                (x | y << 1 | z << 2, index as u32)
            })
            .collect();
        keys.par_sort_unstable();
        Self::grouped(points, keys.into_iter().map(|(_, index)| index).collect())
    }

    fn grouped(points: &[TimedPoint], order: Vec<u32>) -> Self {
        let mut tree = Self { order, levels: Vec::new() };
        let boxes = (0..points.len().div_ceil(LEAF))
            .filter_map(|leaf| {
                Aabb::around(tree.leaf(leaf, points.len()).map(|index| &points[index]))
            })
            .collect::<Vec<_>>();
        if boxes.is_empty() {
            return tree;
        }
        tree.levels.push(boxes);
        while let Some(last) = tree.levels.last().filter(|last| last.len() > 1) {
            let joined = last.chunks(BRANCH).map(Aabb::joined).collect();
            tree.levels.push(joined);
        }
        tree
    }

    /// Returns the indices of the points in one of the smallest boxes.
    fn leaf(&self, leaf: usize, count: usize) -> impl Iterator<Item = usize> + '_ {
        let range = leaf * LEAF..((leaf + 1) * LEAF).min(count);
        range.map(|place| self.order.get(place).map_or(place, |index| *index as usize))
    }

    /// Returns the visible point under the pointer; `points` are those from which the tree was built.
    pub fn nearest(
        &self,
        points: &[TimedPoint],
        view: &PickView,
        shown: impl Fn(usize) -> bool,
    ) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        let top = self.levels.len().checked_sub(1)?;
        let mut open: Vec<(usize, usize)> = vec![(top, 0)];
        while let Some((level, node)) = open.pop() {
            let Some(distance) = view.least_distance(&self.levels[level][node]) else { continue };
            let reach = best.map_or(view.reach_points, |best| best.distance_points);
            if distance > reach {
                continue;
            }
            if level > 0 {
                let children =
                    node * BRANCH..((node + 1) * BRANCH).min(self.levels[level - 1].len());
                open.extend(children.map(|child| (level - 1, child)));
                continue;
            }
            for index in self.leaf(node, points.len()) {
                if let Some(hit) = view.see(index, points[index].position_m)
                    && hit.beats(best.as_ref())
                    && shown(index)
                {
                    best = Some(hit);
                }
            }
        }
        best
    }
}

impl Aabb {
    fn around<'a>(points: impl Iterator<Item = &'a TimedPoint>) -> Option<Self> {
        points
            .map(|point| Vector3::from(point.position_m))
            .map(|p| Self { low: p, high: p })
            .reduce(|a, b| Self { low: a.low.inf(&b.low), high: a.high.sup(&b.high) })
    }

    fn joined(boxes: &[Self]) -> Self {
        let join = |a: Self, b: &Self| Self { low: a.low.inf(&b.low), high: a.high.sup(&b.high) };
        boxes[1..].iter().fold(boxes[0], join)
    }
}

/// Inserts two zero bits after each of the lowest 21.
fn spread(bits: u64) -> u64 {
    [
        (32, 0x001f_0000_0000_ffff),
        (16, 0x001f_0000_ff00_00ff),
        (8, 0x100f_00f0_0f00_f00f),
        (4, 0x10c3_0c30_c30c_30c3),
        (2, 0x1249_2492_4924_9249),
    ]
    .into_iter()
    .fold(bits & 0x001f_ffff, |bits, (shift, mask)| (bits | bits << shift) & mask)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::Camera;
    use proptest::prelude::*;

    /// A drive of loops with some outliers.
    fn drive(count: usize) -> Vec<TimedPoint> {
        (0..count)
            .map(|i| {
                let s = i as f32 * 0.02;
                let jump = if i % 50 == 7 { 40.0 * (3.7 * s).sin() } else { 0.0 };
                let p =
                    [30.0 + 20.0 * s.sin(), 15.0 * (1.3 * s).cos() + jump, 0.4 * (0.3 * s).sin()];
                TimedPoint { position_m: p, time_s: s }
            })
            .collect()
    }

    #[test]
    fn the_bits_are_interleaved() {
        assert_eq!(spread(0b1011), 0b1_000_001_001);
        assert_eq!(spread(0x001f_ffff), 0x1249_2492_4924_9249);
    }

    proptest! {
        #[test]
        fn the_trees_find_what_a_look_at_every_point_finds(
            count in 0..3000_usize,
            (yaw_rad, pitch_rad) in (-3.0..3.0_f32, -1.5..1.5_f32),
            // From among the points to far away.
            distance_m in 0.2..150.0_f32,
            (parallel, vertical) in (proptest::bool::ANY, 1.0..10.0_f32),
            at in 0..3000_usize,
            (x, y) in (-20.0..20.0_f32, -20.0..20.0_f32),
            // Every third point is hidden, or none.
            hidden in 0..4_usize,
        ) {
            let points = drive(count);
            let target_m = points.get(at).map_or(Vector3::zeros(), |p| p.position_m.into());
            let camera = Camera { target_m, distance_m, yaw_rad, pitch_rad, parallel, vertical };
            let rect = Rect::from_min_max(Pos2::new(200.0, 50.0), Pos2::new(900.0, 550.0));
            let view = PickView {
                clip_from_points: camera.clip_from_world(rect.aspect_ratio()),
                rect,
                pointer: rect.center() + egui::vec2(x, y),
                reach_points: 12.0,
            };
            let shown = |index: usize| index % 3 != hidden;
            let mut brute: Option<Hit> = None;
            for (index, point) in points.iter().enumerate().filter(|(index, _)| shown(*index)) {
                if let Some(hit) = view.see(index, point.position_m) && hit.beats(brute.as_ref()) {
                    brute = Some(hit);
                }
            }
            for tree in [PointTree::by_place(&points), PointTree::by_time(&points)] {
                let found = tree.nearest(&points, &view, shown);
                // Either of two points at the same position is correct.
                let place = |hit: Option<Hit>| hit.map(|hit| (hit.distance_points, hit.depth));
                prop_assert_eq!(place(found), place(brute));
            }
        }
    }
}
