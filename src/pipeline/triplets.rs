//! The pipeline's product.

use std::sync::Arc;

use nalgebra::Vector3;

use super::FilteredTrack;

/// `Q_1, Q_2, Q_3` of the paper: positions of the three prisms at common instants.
///
/// All lists have the same length, in order of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Triplets {
    pub time_s: Vec<f64>,
    /// The interval each instant belongs to, numbered from 0.
    pub interval: Vec<u32>,
    /// Positions of each station's prism (m), in the station's own frame.
    pub points_m: [Vec<Vector3<f64>>; 3],
    /// How fast prism 1 moves (m/s), by differences with the neighbouring instants.
    pub speed_m_per_s: Vec<f64>,
    /// One standard deviation of each station's positions on each axis (m), where the interpolation says.
    pub sigma_m: Option<[Vec<Vector3<f64>>; 3]>,
    /// Start of each further drive (s), as [`crate::deployment::Deployment::restarts_s`].
    pub restarts_s: Vec<f64>,
    /// The filtered readings that they were interpolated from; empty where there were none.
    pub readings: Arc<[FilteredTrack; 3]>,
}

impl Triplets {
    pub fn new(time_s: Vec<f64>, interval: Vec<u32>, points_m: [Vec<Vector3<f64>>; 3]) -> Self {
        let speed_m_per_s = speeds(&time_s, &interval, &points_m[0]);
        let readings = Arc::default();
        Self {
            time_s,
            interval,
            points_m,
            speed_m_per_s,
            sigma_m: None,
            restarts_s: Vec::new(),
            readings,
        }
    }

    pub fn len(&self) -> usize {
        self.time_s.len()
    }

    /// Some of the instants, in the order given.
    pub fn select(&self, indices: &[usize]) -> Self {
        let points = |all: &Vec<Vector3<f64>>| indices.iter().map(|i| all[*i]).collect();
        Self {
            time_s: indices.iter().map(|i| self.time_s[*i]).collect(),
            interval: indices.iter().map(|i| self.interval[*i]).collect(),
            points_m: self.points_m.each_ref().map(points),
            speed_m_per_s: indices.iter().map(|i| self.speed_m_per_s[*i]).collect(),
            restarts_s: self.restarts_s.clone(),
            readings: Arc::clone(&self.readings),
            sigma_m: self.sigma_m.as_ref().map(|all| all.each_ref().map(points)),
        }
    }

    pub fn is_empty(&self) -> bool {
        self.time_s.is_empty()
    }

    /// The three positions at one instant (m), each in its station's frame.
    pub fn triplet_m(&self, index: usize) -> [Vector3<f64>; 3] {
        std::array::from_fn(|station| self.points_m[station][index])
    }

    /// Index of the instant nearest in time; `None` where no interval is within half a second.
    pub fn nearest(&self, time_s: f64) -> Option<usize> {
        let after = self.time_s.partition_point(|t| *t < time_s);
        [after.checked_sub(1), Some(after)]
            .into_iter()
            .flatten()
            .filter(|index| *index < self.len() && (self.time_s[*index] - time_s).abs() < 0.5)
            .min_by(|a, b| {
                (self.time_s[*a] - time_s).abs().total_cmp(&(self.time_s[*b] - time_s).abs())
            })
    }
}

fn speeds(time_s: &[f64], interval: &[u32], points_m: &[Vector3<f64>]) -> Vec<f64> {
    let last = time_s.len().saturating_sub(1);
    (0..time_s.len())
        .map(|i| {
            let same = |j: usize| interval[j] == interval[i];
            let before = if i > 0 && same(i - 1) { i - 1 } else { i };
            let after = if i < last && same(i + 1) { i + 1 } else { i };
            if before == after {
                return 0.0;
            }
            (points_m[after] - points_m[before]).norm() / (time_s[after] - time_s[before])
        })
        .collect()
}
