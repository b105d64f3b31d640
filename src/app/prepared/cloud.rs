//! Clouds of millions of points: their positions never change, their colours and visibility do.

use std::ops::Range;
use std::sync::Arc;

use super::pick::{PointTree, TimedPoint};
use resect_core::analysis::Analysis;
use resect_core::deployment::{Deployment, Track};
use resect_core::network::PerStation;
use resect_core::pipeline::Triplets;

/// Returns the origin of the GPU's time (s, in the stations' clock): a reading in the middle of the drive. Single precision needs short
/// numbers: counted from the first reading, one stray stamp years before the drive would reduce the resolution to minutes.
pub fn time_origin_s(deployment: &Deployment) -> f64 {
    let middle = |track: &Track| track.measurements.get(track.measurements.len() / 2).copied();
    deployment.tracks.iter().find_map(middle).map_or(0.0, |reading| reading.time_s)
}

/// Points of the stations, one station after the other, each in order of time.
#[derive(Clone, Debug, Default)]
pub struct Cloud {
    pub points: Vec<TimedPoint>,
    /// Range of each station's points.
    pub ranges: PerStation<Range<usize>>,
    /// Trees of each station's points, for picking.
    pub trees: PerStation<PointTree>,
}

impl Cloud {
    /// Returns the cloud of all raw readings. Outliers may be at any position, so their trees are sorted by position.
    pub fn of_readings(deployment: &Deployment) -> Self {
        let origin_s = time_origin_s(deployment);
        let stations = deployment.tracks.map(|track| {
            let point = |m| {
                let p = track.position_m(m).cast::<f32>();
                TimedPoint { position_m: p.into(), time_s: (m.time_s - origin_s) as f32 }
            };
            track.measurements.iter().map(point).collect::<Vec<_>>()
        });
        Self::of(&stations, PointTree::by_place)
    }

    /// Returns the cloud of the interpolated tracks. Neighbours in time are neighbours in space.
    pub fn of_triplets(triplets: &Triplets, origin_s: f64) -> Self {
        let stations = triplets.points_m.map(|points_m| {
            let point = |(p, time_s): (&nalgebra::Vector3<f64>, &f64)| TimedPoint {
                position_m: p.cast::<f32>().into(),
                time_s: (time_s - origin_s) as f32,
            };
            points_m.iter().zip(&triplets.time_s).map(point).collect::<Vec<_>>()
        });
        Self::of(&stations, PointTree::by_time)
    }

    fn of(
        stations: &PerStation<Vec<TimedPoint>>,
        tree: impl Fn(&[TimedPoint]) -> PointTree,
    ) -> Self {
        let mut end = 0;
        let ranges = stations.map(|points| {
            let start = end;
            end += points.len();
            start..end
        });
        let trees = stations.map(|points| tree(points));
        Self { points: stations.as_slice().concat(), ranges, trees }
    }

    pub fn station(&self, station: usize) -> &[TimedPoint] {
        &self.points[self.ranges[station].clone()]
    }

    /// Returns the range of a station's points whose line covers a span (s, in
    /// the time of the points): from the last before it to the first after it.
    pub fn along(&self, station: usize, [from_s, to_s]: [f32; 2]) -> Range<usize> {
        let points = self.station(station);
        let first = points.partition_point(|point| point.time_s <= from_s).saturating_sub(1);
        let end = (points.partition_point(|point| point.time_s < to_s) + 1).min(points.len());
        let start = self.ranges[station].start;
        start + first..start + end.max(first)
    }
}

/// The clouds of one analysis.
#[derive(Clone, Debug, Default)]
pub struct Clouds {
    pub raw: Arc<Cloud>,
    pub tracks: Arc<Cloud>,
}

/// Builds the clouds of one deployment, and rebuilds only those that changed.
#[derive(Default)]
pub struct CloudMaker {
    raw: Option<Arc<Cloud>>,
    tracks: Option<(Arc<Triplets>, Arc<Cloud>)>,
}

impl CloudMaker {
    /// Builds the clouds. The first call transforms and sorts every reading: too slow for the thread that draws.
    pub fn make(&mut self, deployment: &Deployment, analysis: &Analysis) -> Clouds {
        let raw = self.raw.get_or_insert_with(|| Arc::new(Cloud::of_readings(deployment)));
        let triplets = analysis.triplets();
        let known = self.tracks.take().filter(|(of, _)| Arc::ptr_eq(of, triplets));
        let (_, tracks) = self.tracks.insert(known.unwrap_or_else(|| {
            let origin_s = time_origin_s(deployment);
            (Arc::clone(triplets), Arc::new(Cloud::of_triplets(triplets, origin_s)))
        }));
        Clouds { raw: Arc::clone(raw), tracks: Arc::clone(tracks) }
    }
}

/// Returns the nearest triplet in time for each reading of a station; `None` if none is within half a second.
pub fn nearest_triplets<'a>(
    deployment: &'a Deployment,
    analysis: &'a Analysis,
    station: usize,
) -> impl Iterator<Item = Option<usize>> + 'a {
    let time_s = &analysis.triplets().time_s;
    let mut next = 0;
    deployment.tracks[station].measurements.iter().map(move |m| {
        // Readings are in order of time: the search continues from the last one.
        while next < time_s.len() && time_s[next] < m.time_s {
            next += 1;
        }
        let away = |index: usize| (time_s[index] - m.time_s).abs();
        let candidates = [next.checked_sub(1), (next < time_s.len()).then_some(next)];
        let nearest =
            candidates.into_iter().flatten().min_by(|a, b| away(*a).total_cmp(&away(*b)))?;
        (away(nearest) < NEAR_S).then_some(nearest)
    })
}

/// Greatest difference in time between a reading and its triplet (s), as in [`Triplets::nearest`].
const NEAR_S: f64 = 0.5;

#[cfg(test)]
mod tests {
    use super::*;
    use resect_core::analysis::{Analyst, Settings};
    use resect_io::sample::Sample;

    #[test]
    fn the_walk_finds_what_the_search_finds() {
        let deployment = Sample::Warthog.open().expect("built in");
        let analysis = Analyst::new(deployment.clone().into()).run(&Settings::default());
        for station in 0..3 {
            let walked: Vec<_> = nearest_triplets(&deployment, &analysis, station).collect();
            let measurements = &deployment.tracks[station].measurements;
            assert!(walked.iter().any(Option::is_none) && walked.iter().any(Option::is_some));
            for (m, walked) in measurements.iter().zip(walked) {
                let searched = analysis.triplets().nearest(m.time_s);
                let away = |index: usize| (analysis.triplets().time_s[index] - m.time_s).abs();
                assert_eq!(walked.map(away), searched.map(away));
            }
        }
    }
}
