//! The item under the pointer, and its tooltip.

use egui::{Align2, FontId, Painter, Pos2, Rect, Stroke, Vec2};
use nalgebra::Vector3;

use super::SceneContent;
use super::labels;
use super::projection::Projection;
use crate::app::model::{OpenDeployment, Picked, RulerEnd, Units};
use crate::app::prepared::Cloud;
use crate::app::prepared::pick::Hit;
use crate::app::theme;
use resect_core::analysis::Analysis;
use resect_core::network::PerStation;

/// Distance on the screen within which the pointer is on a reading, and on a track (points).
const READING_REACH: f32 = 7.0;
const TRACK_REACH: f32 = 14.0;

/// A reading, or a point interpolated between readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum UnderPointer {
    Reading(Picked),
    /// The point of a triplet.
    Track {
        station: usize,
        index: usize,
    },
}

impl UnderPointer {
    /// Finds the visible item under the pointer. A reading takes precedence over a track.
    pub fn find(content: &SceneContent, projection: &Projection, at: Pos2) -> Option<Self> {
        let raw = nearest_reading(content, projection, at, READING_REACH);
        let track = || nearest_on_tracks(content, projection, at, TRACK_REACH);
        raw.map(Self::Reading)
            .or_else(|| track().map(|(station, index)| Self::Track { station, index }))
    }

    /// Returns the time of the item (s, in the stations' clock).
    pub fn time_s(&self, open: &OpenDeployment, analysis: &Analysis) -> Option<f64> {
        match self {
            Self::Reading(picked) => picked.time_s(&open.deployment),
            Self::Track { index, .. } => analysis.triplets().time_s.get(*index).copied(),
        }
    }

    /// Returns the position of the item (m, station 1's frame).
    pub fn position_m(
        &self,
        open: &OpenDeployment,
        analysis: &Analysis,
        content: &SceneContent,
    ) -> Option<Vector3<f64>> {
        match *self {
            Self::Reading(picked) => picked.place_m(&open.deployment, analysis),
            Self::Track { station, index } => {
                let point_m = analysis.triplets().points_m[station].get(index)?;
                Some(content.station1_from_tracks[station]?.apply(point_m))
            }
        }
    }

    /// Returns the reading or track point as an end of the ruler.
    pub fn ruler_end(
        &self,
        open: &OpenDeployment,
        analysis: &Analysis,
        content: &SceneContent,
    ) -> Option<RulerEnd> {
        let since_s = self.time_s(open, analysis)? - open.start_s();
        let what = match self {
            Self::Reading(picked) => {
                format!("station {}, reading at {since_s:.2} s", picked.station + 1)
            }
            Self::Track { station, .. } => format!("prism {} at {since_s:.2} s", station + 1),
        };
        Some(RulerEnd { position_m: self.position_m(open, analysis, content)?, what, prism: None })
    }
}

/// Returns the visible reading nearest to a position on the screen, within a distance (points).
fn nearest_reading(
    content: &SceneContent,
    projection: &Projection,
    at: Pos2,
    reach: f32,
) -> Option<Picked> {
    let shown = |station, index| content.shows_reading(Picked { station, index });
    let cloud = &content.clouds.raw;
    nearest(content, cloud, &content.raw_shown, projection, (at, reach), shown)
        .map(|(station, index)| Picked { station, index })
}

/// Returns the nearest point of the tracks.
fn nearest_on_tracks(
    content: &SceneContent,
    projection: &Projection,
    at: Pos2,
    reach: f32,
) -> Option<(usize, usize)> {
    let cloud = &content.clouds.tracks;
    nearest(content, cloud, &content.tracks_shown, projection, (at, reach), |_, _| true)
}

fn nearest(
    content: &SceneContent,
    cloud: &Cloud,
    stations: &PerStation<bool>,
    projection: &Projection,
    (at, reach): (Pos2, f32),
    shown: impl Fn(usize, usize) -> bool,
) -> Option<(usize, usize)> {
    let mut best: Option<(usize, Hit)> = None;
    for station in (0..stations.len()).filter(|station| stations[*station]) {
        let Some(transform) = &content.station1_from_tracks[station] else { continue };
        let view = projection.pick_view(transform, at, reach);
        let points = cloud.station(station);
        let hit = cloud.trees[station].nearest(points, &view, |index| shown(station, index));
        if let Some(hit) = hit.filter(|hit| hit.beats(best.as_ref().map(|(_, best)| best))) {
            best = Some((station, hit));
        }
    }
    best.map(|(station, hit)| (station, hit.index))
}

/// Returns true if anything visible is in the picture.
pub fn is_anything_in_sight(content: &SceneContent, projection: &Projection) -> bool {
    let visible = |p: &Vector3<f32>| projection.visible(&p.cast::<f64>()).is_some();
    // The outline is a sample; all points are searched only if none of the sample is in the picture.
    content.outline_m.iter().any(visible) || {
        let (middle, reach) = (projection.rect.center(), 0.5 * projection.rect.size().min_elem());
        nearest_reading(content, projection, middle, reach).is_some()
            || nearest_on_tracks(content, projection, middle, reach).is_some()
    }
}

/// Returns the lines of a reading's tooltip.
pub fn reading_lines(
    open: &OpenDeployment,
    analysis: &Analysis,
    picked: Picked,
    units: Units,
) -> Vec<String> {
    let track = &open.deployment.tracks[picked.station];
    let fate = analysis.pipeline.fates[picked.station].each.get(picked.index);
    let (Some(m), Some(fate)) = (track.measurements.get(picked.index), fate) else {
        return Vec::new();
    };
    vec![
        format!(
            "Station {}, {:.3} s after the start",
            picked.station + 1,
            m.time_s - open.start_s()
        ),
        format!(
            "range {}  azimuth {}  zenith {}",
            units.length_with_unit(m.range_m),
            units.angle_with_unit(m.azimuth_rad),
            units.angle_with_unit(m.zenith_rad)
        ),
        fate.label().to_owned(),
    ]
}

/// Paints a ring around the picked or the hovered position.
pub fn ring(painter: &Painter, at: Pos2, radius: f32, dark: bool) {
    let (inner, outer) = (theme::rgb(theme::cursor(dark)), theme::scene_background(dark));
    painter.circle_stroke(at, radius, Stroke::new(4.0, outer.gamma_multiply(0.8)));
    painter.circle_stroke(at, radius, Stroke::new(2.0, inner));
}

/// Paints a tooltip beside the pointer, inside of the picture.
pub fn tooltip(painter: &Painter, rect: Rect, at: Pos2, lines: &[String], dark: bool) {
    let colour = theme::rgb(theme::cursor(dark));
    let galley = painter.layout_no_wrap(lines.join("\n"), FontId::proportional(11.5), colour);
    let size = galley.size() + Vec2::splat(10.0);
    let place = Align2::LEFT_TOP.anchor_size(at + Vec2::new(14.0, 14.0), size);
    let place = labels::inside(place, rect.shrink(4.0));
    painter.add(labels::ground_shape(place, dark));
    painter.galley(place.min + Vec2::splat(5.0), galley, colour);
}
