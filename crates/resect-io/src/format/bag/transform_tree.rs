//! Trajectories in the transforms of ROS (`/tf`, `/tf_static`): the pose of each moving frame in the root of its tree.

use resect_core::deployment::FrameNames;
use std::collections::BTreeMap;

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};

use super::messages::{StampedPose, StampedTransform};

/// Fewest transforms of a frame that moves; static ones are published once, or now and then.
const FEWEST_OF_A_MOVING_FRAME: usize = 10;
/// Frames that move less than this share of the widest motion are corrections, such as from `map` to `odom`.
const LEAST_SHARE_OF_MOTION: f64 = 0.1;
/// Longest chain of frames; a longer one is a loop.
const LONGEST_CHAIN: usize = 50;

/// Name of a trajectory, and its poses.
pub type NamedPoses = (String, Vec<StampedPose>);

/// Transforms of a recording, by child frame.
#[derive(Debug, Default)]
pub struct TransformTree(BTreeMap<String, Edge>);

#[derive(Debug)]
struct Edge {
    parent: String,
    /// Time (s) and `parent_from_child`.
    poses: Vec<(f64, Isometry3<f64>)>,
}

impl TransformTree {
    /// Adds a transform; `recorded_s` is its time if it has no stamp (s). Transforms without finite numbers or a rotation are skipped.
    pub fn add(&mut self, transform: StampedTransform, recorded_s: f64) {
        let StampedTransform { parent, child, pose } = transform;
        let [x, y, z, w] = pose.orientation;
        let rotation = Quaternion::new(w, x, y, z);
        let position_m = Vector3::from(pose.position_m);
        if !position_m.iter().all(|value| value.is_finite())
            || !(0.9..1.1).contains(&rotation.norm())
        {
            return;
        }
        let rotation = UnitQuaternion::from_quaternion(rotation);
        let parent_from_child = Isometry3::from_parts(Translation3::from(position_m), rotation);
        let edge = self.0.entry(child).or_insert_with(|| Edge { parent, poses: Vec::new() });
        edge.poses.push((pose.stamp_s.unwrap_or(recorded_s), parent_from_child));
    }

    /// Returns the poses of the frames that move, each in the root of its tree and at its own times, with a name.
    pub fn into_poses(mut self) -> Vec<NamedPoses> {
        for edge in self.0.values_mut() {
            edge.poses.sort_by(|a, b| a.0.total_cmp(&b.0));
        }
        let is_moving = |edge: &Edge| edge.poses.len() >= FEWEST_OF_A_MOVING_FRAME;
        let moving = self.0.iter().filter(|(_, edge)| is_moving(edge));
        let all: Vec<(NamedPoses, f64)> =
            moving.filter_map(|(child, _)| self.in_root(child)).collect();
        let widest_m = all.iter().map(|(_, wide_m)| *wide_m).fold(0.0, f64::max);
        let moves = |(_, wide_m): &(NamedPoses, f64)| *wide_m >= LEAST_SHARE_OF_MOTION * widest_m;
        all.into_iter().filter(moves).map(|(named, _)| named).collect()
    }

    /// Returns the poses of a frame in the root, and the diagonal of the box around its positions (m).
    fn in_root(&self, child: &str) -> Option<(NamedPoses, f64)> {
        let own = self.0.get(child)?;
        let (mut chain, mut root) = (Vec::new(), own.parent.as_str());
        while let Some(edge) = self.0.get(root) {
            chain.push(edge);
            root = &edge.parent;
            if chain.len() > LONGEST_CHAIN {
                return None;
            }
        }
        let (mut low_m, mut high_m) =
            (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
        let poses = own.poses.iter().map(|(time_s, parent_from_child)| {
            let compose = |pose: Isometry3<f64>, edge: &&Edge| edge.at(*time_s) * pose;
            let root_from_child = chain.iter().fold(*parent_from_child, compose);
            let position_m = root_from_child.translation.vector;
            (low_m, high_m) = (low_m.inf(&position_m), high_m.sup(&position_m));
            let [x, y, z, w] = root_from_child.rotation.coords.into();
            StampedPose {
                stamp_s: Some(*time_s),
                position_m: position_m.into(),
                orientation: [x, y, z, w],
                covariance: None,
                frames: Some(FrameNames { parent: root.to_owned(), child: Some(child.to_owned()) }),
            }
        });
        let poses: Vec<StampedPose> = poses.collect();
        Some(((format!("/tf {root} → {child}"), poses), (high_m - low_m).norm()))
    }
}

impl Edge {
    /// Returns the transform at a time, interpolated; that of the first or last stamp outside of them.
    fn at(&self, time_s: f64) -> Isometry3<f64> {
        let next = self.poses.partition_point(|(stamp_s, _)| *stamp_s < time_s);
        match (next.checked_sub(1).and_then(|before| self.poses.get(before)), self.poses.get(next))
        {
            (Some((before_s, before)), Some((after_s, after))) => {
                let share = (time_s - before_s) / (after_s - before_s);
                before.try_lerp_slerp(after, share, 1e-9).unwrap_or(*before)
            }
            (Some((_, only)), None) | (None, Some((_, only))) => *only,
            (None, None) => Isometry3::identity(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn transform(parent: &str, child: &str, time_s: f64, position_m: [f64; 3]) -> StampedTransform {
        let pose = StampedPose {
            stamp_s: Some(time_s),
            position_m,
            orientation: [0.0, 0.0, 0.0, 1.0],
            covariance: None,
            frames: None,
        };
        StampedTransform { parent: parent.to_owned(), child: child.to_owned(), pose }
    }

    #[test]
    fn frames_are_chained_to_the_root_and_corrections_are_none() {
        let mut tree = TransformTree::default();
        for k in 0..40 {
            let time_s = f64::from(k);
            tree.add(transform("odom", "base_link", time_s + 0.5, [time_s, 0.0, 0.0]), 0.0);
            tree.add(transform("map", "odom", time_s, [0.01 * time_s, 5.0, 0.0]), 0.0);
        }
        tree.add(transform("base_link", "prism", 0.0, [0.0, 0.0, 1.0]), 0.0);
        let all = tree.into_poses();
        let [(name, poses)] = &all[..] else { panic!("{all:?}") };
        assert_eq!(name, "/tf map → base_link");
        let [x, y, _] = poses[10].position_m;
        assert!((x - 10.105).abs() < 1e-12 && (y - 5.0).abs() < 1e-12, "{x} {y}");
    }

    #[test]
    fn a_loop_and_broken_numbers_do_no_harm() {
        let mut tree = TransformTree::default();
        for k in 0..20 {
            tree.add(transform("a", "b", f64::from(k), [f64::from(k), 0.0, 0.0]), 0.0);
            tree.add(transform("b", "a", f64::from(k), [f64::NAN, 0.0, 0.0]), 0.0);
            tree.add(transform("b", "a", f64::from(k), [1.0, 0.0, 0.0]), 0.0);
        }
        assert_eq!(tree.into_poses(), []);
    }
}
