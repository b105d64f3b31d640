//! Positions of the prisms and speed by a calibration, ready to be plotted.

use super::placing::placed_tracks;
use super::pyramid::Values;
use resect_core::analysis::Analysis;
use resect_core::deployment::Deployment;
use resect_core::network::PerStation;

/// Positions of the prisms at each triplet, and speed; lists are empty without a calibration.
#[derive(Clone, Debug, Default)]
pub struct TrackSeries {
    /// Times since the first measurement (s).
    pub since_s: Vec<f64>,
    /// x, y and z of each prism (m, station 1's frame).
    pub places_m: PerStation<[Values; 3]>,
    /// Speed of prism 1.
    pub speed_m_per_s: Values,
}

impl TrackSeries {
    pub fn of(deployment: &Deployment, analysis: &Analysis, start_s: f64) -> Self {
        let triplets = analysis.triplets();
        let placed = placed_tracks(deployment, analysis);
        Self {
            since_s: triplets.time_s.iter().map(|time_s| time_s - start_s).collect(),
            places_m: placed.map_each(|station, placed| {
                let Some(placed) = placed else { return Default::default() };
                let mut places_m: [Vec<f64>; 3] = Default::default();
                for point_m in &triplets.points_m[station] {
                    let place_m = placed.apply(point_m);
                    for (axis, values) in places_m.iter_mut().enumerate() {
                        values.push(place_m[axis]);
                    }
                }
                places_m.map(Values::of)
            }),
            speed_m_per_s: Values::of(triplets.speed_m_per_s.clone()),
        }
    }
}
