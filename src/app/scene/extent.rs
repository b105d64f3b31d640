//! Extent of the scene, and the sample of it to which the camera fits.

use nalgebra::Vector3;

use super::content::SceneContent;
use crate::app::model::{Picked, Visibility};
use resect_core::analysis::Analysis;
use resect_core::pipeline::SampleFate;

/// Number of points to which the camera fits, and number of points sampled from a station.
const OUTLINE_POINTS: usize = 2000;
const ASKED_POINTS: usize = 4000;

impl SceneContent {
    /// Computes the bounding box of stations and readings, shown or not, so that
    /// hiding something moves neither the grid nor the limits of the camera.
    pub fn find_bounds(&mut self, analysis: &Analysis) {
        let stations = self.station1_from_station.iter().flatten();
        let mut all: Vec<Vector3<f32>> = stations.map(|t| t.translation_m.cast::<f32>()).collect();
        let none_kept = analysis.triplets().is_empty();
        for station in 0..self.station1_from_tracks.len() {
            let sane = |index: usize| none_kept || !self.is_wild(analysis, station, index);
            all.extend(self.readings_m(station, sane));
        }
        all.extend(&self.truth_m);
        let corners = all.into_iter().map(|p| (p, p));
        self.bounds_m = corners.reduce(|a, b| (a.0.inf(&b.0), a.1.sup(&b.1)));
    }

    /// Samples the outline of the visible points; of all points if none is visible.
    pub fn find_outline(&mut self, analysis: &Analysis, visibility: &Visibility) {
        // Control points are far from some drives, and would make the rest small.
        let shown = |station: &usize| visibility.stations[*station];
        let stations = 0..self.station1_from_station.len();
        let placed = stations.filter(shown).filter_map(|k| self.station1_from_station[k]);
        let mut seen: Vec<Vector3<f32>> =
            placed.map(|transform| transform.translation_m.cast::<f32>()).collect();
        let stations = seen.len();
        seen.extend(&self.truth_m);
        let mut wild = Vec::new();
        for station in 0..self.tracks_shown.len() {
            if self.tracks_shown[station] {
                seen.extend(self.track_m(station));
            }
            let shown =
                |index| self.shows_reading_of(analysis, visibility, Picked { station, index });
            let is_wild = |index| self.is_wild(analysis, station, index);
            seen.extend(self.readings_m(station, |index| shown(index) && !is_wild(index)));
            wild.extend(self.readings_m(station, |index| shown(index) && is_wild(index)));
        }
        // Outliers may be at any position; they count only if there is nothing else.
        if seen.len() == stations {
            seen.append(&mut wild);
        }
        if seen.len() == stations {
            seen.extend(self.landmarks.iter().map(|landmark| landmark.position_m.cast::<f32>()));
        }
        if seen.is_empty() {
            seen.extend(self.bounds_m.iter().flat_map(|(low, high)| [*low, *high]));
        }
        let step = seen.len().div_ceil(OUTLINE_POINTS).max(1);
        // Thinning must keep every station: they come first.
        let (stations, points) = seen.split_at(stations);
        self.outline_m = stations.iter().chain(points.iter().step_by(step)).copied().collect();
    }

    fn shows_reading_of(&self, analysis: &Analysis, visibility: &Visibility, at: Picked) -> bool {
        let fate = analysis.pipeline.fates[at.station].each.get(at.index);
        let place = fate.and_then(|fate| SampleFate::ALL.iter().position(|one| one == fate));
        self.raw_shown[at.station] && place.is_some_and(|place| visibility.shows_fate(place))
    }

    fn is_wild(&self, analysis: &Analysis, station: usize, index: usize) -> bool {
        let fate = analysis.pipeline.fates[station].each.get(index);
        matches!(fate, Some(SampleFate::Rejected(_) | SampleFate::LeftOut))
    }

    /// Returns some of a station's readings in station 1's frame; empty if the station has no pose.
    fn readings_m(&self, station: usize, wanted: impl Fn(usize) -> bool) -> Vec<Vector3<f32>> {
        let Some(transform) = self.station1_from_tracks[station] else { return Vec::new() };
        let points = self.clouds.raw.station(station);
        let step = points.len().div_ceil(ASKED_POINTS).max(1);
        (points.iter().enumerate().step_by(step))
            .filter(|(index, _)| wanted(*index))
            .map(|(_, point)| Vector3::from(point.position_m).cast::<f64>())
            .map(|position_m| transform.apply(&position_m).cast::<f32>())
            .collect()
    }

    fn track_m(&self, station: usize) -> Vec<Vector3<f32>> {
        let Some(transform) = self.station1_from_tracks[station] else { return Vec::new() };
        let points = self.clouds.tracks.station(station);
        let step = points.len().div_ceil(ASKED_POINTS).max(1);
        let places = points.iter().step_by(step).map(|p| Vector3::from(p.position_m).cast::<f64>());
        places.map(|position_m| transform.apply(&position_m).cast::<f32>()).collect()
    }
}
