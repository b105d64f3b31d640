//! Linear interpolation between neighbouring readings, as in the paper's best pipeline.

use nalgebra::Vector3;

use crate::pipeline::FilteredTrack;

/// Returns positions (m) at increasing instants (s) within the span of the track.
pub fn at(track: &FilteredTrack, time_s: &[f64]) -> Vec<Vector3<f64>> {
    let mut next = 1;
    time_s
        .iter()
        .map(|&t| {
            while next + 1 < track.time_s.len() && track.time_s[next] < t {
                next += 1;
            }
            let (t0, t1) = (track.time_s[next - 1], track.time_s[next]);
            let weight = (t - t0) / (t1 - t0);
            track.position_m[next - 1].lerp(&track.position_m[next], weight)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_drive_is_exact_and_readings_are_met() {
        let time_s = vec![0.0, 0.4, 0.9, 1.2];
        let position = |t: f64| Vector3::new(3.0 * t - 1.0, 2.0, -t);
        let position_m = time_s.iter().map(|t| position(*t)).collect();
        let track = FilteredTrack { time_s, position_m, ..Default::default() };
        let instants = [0.0, 0.1, 0.4, 0.7, 1.0, 1.2];
        for (found, t) in at(&track, &instants).iter().zip(instants) {
            assert!((found - position(t)).norm() < 1e-12, "at {t}");
        }
    }
}
