//! Checks of complete tracks against physics: repeated ranges, origins of coordinates, and clocks that differ by seconds.

use nalgebra::Vector3;

use crate::findings::tracks::{cartesian_origin_doubtful, ranges_repeated, station_clock_off};
use resect_core::deployment::{EstimatedPose, Finding, Measurement, Track};
use resect_core::network::PerStation;
use resect_core::statistics::quantiles;
use resect_tools::estimates::offset_by_speeds_s;

/// Ranges repeat if so many consecutive ones are equal although the prism moves across the sight by this length (m).
const FEWEST_REPEATED: usize = 5;
const LEAST_MOTION_M: f64 = 0.25;
/// The origin of Cartesian positions is doubtful if the nearest is further away than this (m), and than this multiple of their
/// extent: total stations stand at the site.
const FAR_M: f64 = 50.0;
const FAR_EXTENTS: f64 = 2.0;
/// Shortest offset between clocks that is reported (s); the joint estimate corrects shorter ones.
const LEAST_OFFSET_S: f64 = 1.0;

/// Leaves out readings whose range is that of an earlier one, and returns findings about them.
pub fn leave_out_repeated_ranges(tracks: &mut PerStation<Track>) -> Vec<Finding> {
    let mut findings = Vec::new();
    for (station, track) in tracks.iter_mut().enumerate() {
        let runs: Vec<std::ops::Range<usize>> = repeated_ranges(&track.measurements);
        let count: usize = runs.iter().map(|run| run.len() - 1).sum();
        let Some(first) = runs.first() else { continue };
        let first_s = track.measurements[first.start].time_s;
        track.left_out.resize(track.measurements.len(), false);
        for run in &runs {
            track.left_out[run.start + 1..run.end].fill(true);
        }
        findings.push(ranges_repeated(station, count, first_s));
    }
    findings
}

/// Returns the runs of equal ranges during which the prism moves across the sight.
fn repeated_ranges(readings: &[Measurement]) -> Vec<std::ops::Range<usize>> {
    let mut runs = Vec::new();
    let mut start = 0;
    for run in readings.chunk_by(|a, b| a.range_m == b.range_m) {
        let end = start + run.len();
        let moved_m: f64 = run.windows(2).map(|pair| across_m(&pair[0], &pair[1])).sum();
        if run.len() >= FEWEST_REPEATED && moved_m > LEAST_MOTION_M {
            runs.push(start..end);
        }
        start = end;
    }
    runs
}

/// Length of the arc between two sights at equal range (m).
fn across_m(a: &Measurement, b: &Measurement) -> f64 {
    let level = (b.azimuth_rad - a.azimuth_rad).sin() * a.zenith_rad.sin();
    a.range_m * level.hypot(b.zenith_rad - a.zenith_rad)
}

/// Returns a finding if Cartesian positions of most stations are far from their origin, compared with their extent.
pub fn cartesian_origins(tracks: &PerStation<Track>) -> Option<Finding> {
    let far: Vec<(usize, [f64; 2], f64)> = (tracks.iter().enumerate())
        .filter_map(|(station, track)| {
            let [near_m, far_m] =
                quantiles(track.measurements.iter().map(|m| m.range_m), [0.02, 0.98])?;
            let extent_m = extent_m(track);
            (near_m > FAR_M && near_m > FAR_EXTENTS * extent_m).then_some((
                station,
                [near_m, far_m],
                extent_m,
            ))
        })
        .collect();
    let measuring = tracks.iter().filter(|track| !track.measurements.is_empty()).count();
    let (station, ranges_m, extent_m) = far.first()?;
    (2 * far.len() > measuring).then(|| cartesian_origin_doubtful(*station, *ranges_m, *extent_m))
}

/// Diagonal of the box around all but the outermost positions (m).
fn extent_m(track: &Track) -> f64 {
    let axis = |axis: usize| {
        let values = track.measurements.iter().map(|m| track.position_m(m)[axis]);
        quantiles(values, [0.02, 0.98]).map_or(0.0, |[low, high]| high - low)
    };
    Vector3::new(axis(0), axis(1), axis(2)).norm()
}

/// Returns findings about stations whose speeds match those of the others at another time.
pub fn clock_offsets(tracks: &PerStation<Track>) -> Vec<Finding> {
    let poses = tracks.map(poses);
    let Some((first, others)) = poses.as_slice().split_first() else { return Vec::new() };
    // Positive if the station's stamps are later than station 1's.
    let late_s = others.iter().map(|own| offset_by_speeds_s(own, first).map(|s| -s));
    let is_large = |late_s: &f64| late_s.abs() >= LEAST_OFFSET_S;
    let late_s: Vec<Option<f64>> = late_s.map(|late_s| late_s.filter(is_large)).collect();
    let all_s: Vec<f64> = late_s.iter().copied().flatten().collect();
    let least_s = all_s.iter().copied().fold(f64::INFINITY, f64::min);
    let most_s = all_s.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if all_s.len() > 1 && all_s.len() == late_s.len() && most_s - least_s < LEAST_OFFSET_S {
        // The others agree with each other, so station 1 is off.
        let mean_s = all_s.iter().sum::<f64>() / all_s.len() as f64;
        return vec![station_clock_off(0, -mean_s)];
    }
    let off = late_s.into_iter().zip(1..);
    off.filter_map(|(late_s, station)| Some(station_clock_off(station, late_s?))).collect()
}

fn poses(track: &Track) -> Vec<EstimatedPose> {
    let pose = |m: &Measurement| EstimatedPose {
        time_s: m.time_s,
        position_m: track.position_m(m),
        orientation: None,
    };
    track.measurements.iter().map(pose).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A prism that circles a station at 20 m and 1 m/s, read 2.5 times a second; its range swings by centimetres.
    fn circling() -> Track {
        let reading = |i: i32| {
            let time_s = 0.4 * f64::from(i);
            Measurement {
                time_s,
                azimuth_rad: time_s / 20.0,
                zenith_rad: 1.55,
                range_m: 20.0 + 0.05 * time_s.sin(),
            }
        };
        Track { measurements: (0..500).map(reading).collect(), ..Track::default() }
    }

    #[test]
    fn repeated_ranges_of_a_moving_prism_are_left_out_and_those_at_rest_are_not() {
        let mut frozen = circling();
        let range_m = frozen.measurements[100].range_m;
        frozen.measurements[101..120].iter_mut().for_each(|m| m.range_m = range_m);
        let mut resting = circling();
        let at = resting.measurements[100];
        resting.measurements[101..200].iter_mut().for_each(|m| {
            (m.azimuth_rad, m.zenith_rad, m.range_m) = (at.azimuth_rad, at.zenith_rad, at.range_m);
        });
        let mut tracks = [circling(), frozen, resting].into();
        let findings = leave_out_repeated_ranges(&mut tracks);
        assert_eq!(findings.len(), 1, "{findings:?}");
        let left_out: Vec<usize> = (0..500).filter(|i| tracks[1].left_out[*i]).collect();
        assert_eq!(left_out, (101..120).collect::<Vec<_>>());
        assert!(tracks[0].left_out.is_empty() && tracks[2].left_out.is_empty());
    }
}
