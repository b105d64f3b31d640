//! Recordings whose clock jumped.

use crate::findings::tracks::{ClockJump, stamps_jumped};
use resect_core::deployment::{Finding, Measurement, Track};
use resect_core::network::PerStation;

/// Pause of all stations (s) behind which stamps are of another clock or another drive.
const JUMP_S: f64 = 12.0 * 3600.0;

/// Removes the readings before or behind a jump of the stamps from tracks in order of time: all but the part with the most readings.
/// Leaves tracks unchanged if no part has readings of all stations, because then the clocks of the stations differ.
pub fn keep_longest_part(tracks: &mut PerStation<Track>) -> Option<Finding> {
    let mut times_s: Vec<f64> =
        tracks.iter().flat_map(|track| track.measurements.iter().map(|m| m.time_s)).collect();
    times_s.sort_by(f64::total_cmp);
    let jumps: Vec<usize> =
        (1..times_s.len()).filter(|index| times_s[*index] - times_s[index - 1] > JUMP_S).collect();
    let gap_s = jumps.iter().map(|index| times_s[*index] - times_s[index - 1]).fold(0.0, f64::max);
    let starts = std::iter::once(0).chain(jumps.iter().copied());
    let ends = jumps.iter().copied().chain([times_s.len()]);
    let longest = starts.zip(ends).max_by_key(|(start, end)| end - start)?;
    let (from_s, to_s) = (*times_s.get(longest.0)?, times_s[longest.1 - 1]);
    let is_used = |m: &Measurement| (from_s..=to_s).contains(&m.time_s);
    let is_complete =
        |track: &Track| track.measurements.is_empty() || track.measurements.iter().any(is_used);
    if jumps.is_empty() || !tracks.iter().all(is_complete) {
        return None;
    }
    for track in tracks.iter_mut() {
        let used: Vec<bool> = track.measurements.iter().map(is_used).collect();
        let mut is_kept = used.iter();
        track.measurements.retain(|_| is_kept.next() == Some(&true));
        if !track.own_clock_s.is_empty() {
            let mut is_kept = used.iter();
            track.own_clock_s.retain(|_| is_kept.next() == Some(&true));
        }
    }
    let used = longest.1 - longest.0;
    Some(stamps_jumped(&ClockJump { gap_s, used, unused: times_s.len() - used }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(times_s: &[f64]) -> Track {
        let reading = |time_s: &f64| Measurement {
            time_s: *time_s,
            range_m: 10.0,
            azimuth_rad: 0.0,
            zenith_rad: 1.5,
        };
        Track { measurements: times_s.iter().map(reading).collect(), ..Track::default() }
    }

    #[test]
    fn the_longest_part_is_kept() {
        let days_s = 40.0 * 86_400.0;
        let times_s: Vec<f64> =
            (0..10).map(|k| f64::from(k) + if k < 3 { 0.0 } else { days_s }).collect();
        let mut tracks = PerStation::repeat(3, track(&times_s));
        let finding = keep_longest_part(&mut tracks).expect("a jump").to_string();
        assert!(
            finding.contains("40.0 days") && finding.contains("(21 readings); 9 readings"),
            "{finding}"
        );
        assert!(tracks.iter().all(|track| track.measurements.len() == 7));
        assert_eq!(keep_longest_part(&mut tracks), None);
    }

    #[test]
    fn a_station_with_another_clock_is_kept() {
        let mut tracks =
            [track(&[0.0, 1.0]), track(&[0.0, 1.0]), track(&[90_000.0, 90_001.0])].into();
        assert_eq!(keep_longest_part(&mut tracks), None);
        assert_eq!(tracks[2].measurements.len(), 2);
    }
}
