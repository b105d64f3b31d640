//! Triplets, the output of the pipeline.

use std::sync::Arc;

use nalgebra::Vector3;

use super::FilteredTrack;
use crate::network::{PerStation, Prism, PrismSchedule, Station};

/// Tolerance of time comparisons (s); Unix times are stored to a quarter of a microsecond.
const STAMP_ERROR_S: f64 = 1e-6;

/// `Q_1, Q_2, Q_3` of the paper: positions of the stations' prisms at common instants.
///
/// All lists have the same length, in order of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Triplets {
    pub time_s: Vec<f64>,
    /// The interval each instant belongs to, numbered from 0.
    pub interval: Vec<u32>,
    /// Positions of each station's prism (m), in the station's own frame.
    pub points_m: PerStation<Vec<Vector3<f64>>>,
    /// Speed of prism 1 (m/s), by differences with the neighbouring instants.
    pub speed_m_per_s: Vec<f64>,
    /// Standard deviation of each station's positions along each axis (m); `None` if the interpolation gives none.
    pub sigma_m: Option<PerStation<Vec<Vector3<f64>>>>,
    /// Start of each further drive (s), as [`crate::deployment::Deployment::restarts_s`].
    pub restarts_s: Vec<f64>,
    /// Filtered readings from which the positions are interpolated; empty without readings.
    pub readings: Arc<PerStation<FilteredTrack>>,
    /// Triplets of the spans in which stations follow other prisms. The joint estimate uses them, the paper's methods do not.
    pub of_other_prisms: Option<Arc<Self>>,
    /// Triplets of all readings, from which the joint estimate starts; `None` if it takes the readings of these intervals.
    pub of_all_readings: Option<Arc<Self>>,
}

impl Triplets {
    pub fn new(
        time_s: Vec<f64>,
        interval: Vec<u32>,
        points_m: impl Into<PerStation<Vec<Vector3<f64>>>>,
    ) -> Self {
        let points_m = points_m.into();
        let first = points_m.iter().next();
        let speed_m_per_s =
            first.map_or_else(Vec::new, |points_m| speeds(&time_s, &interval, points_m));
        let readings = Arc::default();
        Self {
            time_s,
            interval,
            points_m,
            speed_m_per_s,
            sigma_m: None,
            restarts_s: Vec::new(),
            readings,
            of_other_prisms: None,
            of_all_readings: None,
        }
    }

    pub fn len(&self) -> usize {
        self.time_s.len()
    }

    /// Returns some of the instants, in the order given, for an estimate from them alone.
    pub fn select(&self, indices: &[usize]) -> Self {
        let points = |all: &Vec<Vector3<f64>>| indices.iter().map(|i| all[*i]).collect();
        Self {
            time_s: indices.iter().map(|i| self.time_s[*i]).collect(),
            interval: indices.iter().map(|i| self.interval[*i]).collect(),
            points_m: self.points_m.map(points),
            speed_m_per_s: indices.iter().map(|i| self.speed_m_per_s[*i]).collect(),
            restarts_s: self.restarts_s.clone(),
            readings: Arc::clone(&self.readings),
            of_other_prisms: self.of_other_prisms.clone(),
            of_all_readings: None,
            sigma_m: self.sigma_m.as_ref().map(|all| all.map(points)),
        }
    }

    /// Returns the triplets of the prisms that the stations follow most, with those of other prisms beside them.
    pub fn of_most_followed(self, schedule: &PrismSchedule) -> Self {
        let followed = |index: &usize| schedule.at(self.time_s[*index]);
        let mut indices: Vec<(&PerStation<Prism>, Vec<usize>)> = Vec::new();
        for index in 0..self.len() {
            match indices.iter_mut().find(|(known, _)| *known == followed(&index)) {
                Some((_, indices)) => indices.push(index),
                None => indices.push((followed(&index), vec![index])),
            }
        }
        let largest = indices.iter().max_by_key(|(_, indices)| indices.len());
        let Some((most, of_most)) = largest else { return self };
        if of_most.len() == self.len() {
            return self;
        }
        let is_other = |index: &usize| followed(index) != *most;
        let others: Vec<usize> = (0..self.len()).filter(is_other).collect();
        let of_other_prisms = Some(Arc::new(self.select(&others)));
        Self {
            of_other_prisms,
            of_all_readings: self.of_all_readings.clone(),
            ..self.select(of_most)
        }
    }

    /// Returns these triplets with those of the spans in which stations follow other prisms, in order of time, with positions alone.
    pub fn with_other_prisms(&self) -> Option<Self> {
        let others = self.of_other_prisms.as_deref()?;
        let indexed = |triplets| (0..Self::len(triplets)).map(move |k| (triplets, k));
        let mut all: Vec<(&Self, usize)> = indexed(self).chain(indexed(others)).collect();
        all.sort_by(|(a, i), (b, k)| a.time_s[*i].total_cmp(&b.time_s[*k]));
        let of_station =
            |station: Station| all.iter().map(move |(triplets, k)| triplets.points_m[station][*k]);
        let points_m: PerStation<Vec<Vector3<f64>>> =
            self.points_m.map_each(|station, _| of_station(station).collect());
        let (time_s, interval) =
            all.iter().map(|(triplets, k)| (triplets.time_s[*k], triplets.interval[*k])).unzip();
        let (restarts_s, readings) = (self.restarts_s.clone(), Arc::clone(&self.readings));
        Some(Self { restarts_s, readings, ..Self::new(time_s, interval, points_m) })
    }

    pub fn is_empty(&self) -> bool {
        self.time_s.is_empty()
    }

    /// Returns the positions at one instant (m), each in its station's frame.
    pub fn triplet_m(&self, index: usize) -> PerStation<Vector3<f64>> {
        self.points_m.map(|points_m| points_m[index])
    }

    /// Returns the prisms at any time, as a single instant. Between triplets of one interval at most `longest_s` (s) apart,
    /// positions are interpolated linearly. `None` elsewhere: positions are not extrapolated.
    pub fn at(&self, time_s: f64, longest_s: f64) -> Option<Self> {
        let after = self.time_s.partition_point(|t| *t < time_s);
        if self.time_s.get(after) == Some(&time_s) {
            return Some(self.select(&[after]));
        }
        let before = after.checked_sub(1)?;
        let (from_s, to_s) = (self.time_s[before], *self.time_s.get(after)?);
        let apart_s = to_s - from_s;
        if self.interval[before] != self.interval[after] || apart_s > longest_s + STAMP_ERROR_S {
            return None;
        }
        let share = (time_s - from_s) / apart_s;
        let between = |all: &Vec<Vector3<f64>>| vec![all[before].lerp(&all[after], share)];
        let speeds = [before, after].map(|index| self.speed_m_per_s[index]);
        Some(Self {
            time_s: vec![time_s],
            interval: vec![self.interval[before]],
            points_m: self.points_m.map(between),
            speed_m_per_s: vec![speeds[0] + share * (speeds[1] - speeds[0])],
            sigma_m: self.sigma_m.as_ref().map(|all| all.map(between)),
            ..self.select(&[])
        })
    }

    /// Returns the index of the nearest instant in time; `None` if none is within half a second.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Two intervals of 2 Hz at 1 m/s along x, with a gap of three seconds between them.
    fn triplets() -> Triplets {
        let time_s = vec![10.0, 10.5, 11.0, 14.0, 14.5];
        let points_m = [0.0, 1.0, 2.0]
            .map(|y| time_s.iter().map(|t| Vector3::new(t - 10.0, y, 0.0)).collect::<Vec<_>>());
        let sigma_m = points_m.each_ref().map(|p| vec![Vector3::repeat(1e-3); p.len()]);
        let interval = vec![0, 0, 0, 1, 1];
        Triplets { sigma_m: Some(sigma_m.into()), ..Triplets::new(time_s, interval, points_m) }
    }

    #[test]
    fn prisms_stand_on_a_triplet_and_between_two_of_an_interval() {
        for time_s in [10.0, 10.2, 10.5, 10.9, 11.0, 14.25] {
            let at = triplets().at(time_s, 1.0).expect("in an interval");
            assert_eq!((at.len(), at.time_s[0]), (1, time_s));
            for (station, p) in at.triplet_m(0).iter().enumerate() {
                let expected = Vector3::new(time_s - 10.0, station as f64, 0.0);
                assert!((p - expected).norm() < 1e-12, "{time_s}: {p}");
            }
            assert!((at.speed_m_per_s[0] - 1.0).abs() < 1e-12);
            assert_eq!(at.sigma_m.expect("stated")[0], [Vector3::repeat(1e-3)]);
            assert_eq!(at.interval[0], u32::from(time_s > 12.0));
        }
    }

    #[test]
    fn there_are_none_in_a_gap_nor_before_the_first_and_after_the_last() {
        for time_s in [9.99, 11.01, 12.5, 13.99, 14.51] {
            // No interval continues across a gap, for any `longest_s`.
            assert_eq!(triplets().at(time_s, 60.0), None, "{time_s}");
        }
        assert_eq!(Triplets::default().at(10.0, 1.0), None);
        // Triplets too far apart are not interpolated.
        assert_eq!(triplets().at(10.2, 0.4), None);
        assert!(triplets().at(10.5, 0.4).is_some());
    }
}
