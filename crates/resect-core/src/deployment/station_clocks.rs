//! Comparison of the stations' own clocks with the stamps of the readings.
//!
//! A reading has a synchronised stamp, which the calibration uses, and a time by the unsynchronised clock of the station's
//! computer. Their difference is the station's correction. It is normal that the correction is not zero, and that it differs
//! between stations. A correction that jumps or drifts fast is not normal: one of the two clocks did so. The two times alone do
//! not show the wrong clock. The recorder's clock can show it, if messages arrive within a few milliseconds.

mod arrivals;
mod robust;

pub use self::arrivals::Arrivals;
use self::arrivals::{DOUBTED_S, FEWEST_READINGS};
use self::robust::{jumps, slope_of_neighbours, theil_sen};
use super::{Finding, TimeCorrection, Track};
use crate::deployment::findings::recordings::{
    self, ClockDifference, stamps_are_station_clocks, station_clock_drifts, station_clock_jumps,
    station_clocks_compared, time_corrections_contradict_stamps,
};
use crate::network::PerStation;
use crate::statistics::{median, sigma_of_errors};

/// Crystals of small computers are accurate to 20 to 50 ppm; a clock with a larger drift is being adjusted.
const ORDINARY_DRIFT_PPM: f64 = 100.0;

/// A station's own clock minus the stamps of its readings, over a recording.
#[derive(Clone, Debug, PartialEq)]
pub struct ClockComparison {
    /// Readings that have both times.
    pub readings: usize,
    /// Median of own clock minus stamp (s).
    pub median_s: f64,
    /// Drift of the own clock against the stamps between jumps (µs per s).
    pub drift_ppm: f64,
    pub jumps: Vec<ClockJump>,
    /// Robust σ of the remainder after level, drift and jumps (s).
    pub spread_s: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClockJump {
    /// Stamp of the first reading after it (s).
    pub time_s: f64,
    /// Increase of own clock minus stamp at the jump (s).
    pub by_s: f64,
}

/// Compares both times of a station's readings; `None` if fewer than ten have both.
pub fn compare(track: &Track) -> Option<ClockComparison> {
    let (times_s, apart_s): (Vec<f64>, Vec<f64>) = track
        .measurements
        .iter()
        .zip(&track.own_clock_s)
        .map(|(measurement, own_s)| (measurement.time_s, own_s - measurement.time_s))
        .filter(|(_, apart_s)| apart_s.is_finite())
        .unzip();
    if times_s.len() < FEWEST_READINGS {
        return None;
    }
    let slope = slope_of_neighbours(&times_s, &apart_s);
    let jumps = jumps(&times_s, &apart_s, slope);
    let ends = jumps.iter().map(|(index, _)| *index).chain([times_s.len()]);
    let starts = [0].into_iter().chain(jumps.iter().map(|(index, _)| *index));
    let segments: Vec<_> = starts.zip(ends).map(|(start, end)| start..end).collect();
    let longest = segments.iter().max_by_key(|segment| segment.len()).cloned().unwrap_or_default();
    let drift = theil_sen(&times_s[longest.clone()], &apart_s[longest]);
    let mut left_s = Vec::with_capacity(times_s.len());
    for segment in segments {
        let flat: Vec<f64> =
            segment.map(|k| apart_s[k] - drift * (times_s[k] - times_s[0])).collect();
        let level = median(flat.iter().copied()).unwrap_or(0.0);
        left_s.extend(flat.into_iter().map(|value| value - level));
    }
    Some(ClockComparison {
        readings: times_s.len(),
        median_s: median(apart_s.iter().copied())?,
        drift_ppm: drift * 1e6,
        jumps: jumps
            .into_iter()
            .map(|(index, by_s)| ClockJump { time_s: times_s[index], by_s })
            .collect(),
        spread_s: sigma_of_errors(left_s)?,
    })
}

/// Findings about both times of every station, and about the recorded corrections; empty if no station has both times.
pub fn findings(
    tracks: &PerStation<Track>,
    time_corrections: &PerStation<Vec<TimeCorrection>>,
) -> Vec<Finding> {
    let comparisons = tracks.map(compare);
    let mut findings = Vec::new();
    let both: Vec<(usize, &ClockComparison)> =
        comparisons.iter().enumerate().filter_map(|(k, c)| Some((k, c.as_ref()?))).collect();
    if both.is_empty() {
        return findings;
    }
    let same =
        both.iter().all(|(_, c)| c.median_s == 0.0 && c.spread_s == 0.0 && c.jumps.is_empty());
    if same {
        findings.push(stamps_are_station_clocks());
    } else {
        let each: Vec<_> = both
            .iter()
            .map(|(station, c)| ClockDifference {
                station: *station,
                offset_s: c.median_s,
                drift_ppm: c.drift_ppm,
                spread_s: c.spread_s,
            })
            .collect();
        findings.push(station_clocks_compared(&each));
    }
    let start_s = tracks.iter().filter_map(|t| Some(t.measurements.first()?.time_s));
    let start_s = start_s.fold(f64::INFINITY, f64::min);
    for (station, comparison) in both {
        if comparison.drift_ppm.abs() > ORDINARY_DRIFT_PPM {
            findings.push(station_clock_drifts(station, comparison.drift_ppm));
        }
        if let Some(first) = comparison.jumps.first() {
            let (after_s, count) = (first.time_s - start_s, comparison.jumps.len());
            findings.push(station_clock_jumps(station, first.by_s, after_s, count));
        }
        findings.extend(against_corrections(station, &tracks[station], &time_corrections[station]));
    }
    findings
}

/// Compares the published corrections with those that were applied; `None` without corrections.
fn against_corrections(
    station: usize,
    track: &Track,
    corrections: &[TimeCorrection],
) -> Option<Finding> {
    if corrections.is_empty() {
        return None;
    }
    let apart_s: Vec<f64> = track
        .measurements
        .iter()
        .zip(&track.own_clock_s)
        .filter_map(|(measurement, own_s)| {
            let next = corrections.partition_point(|c| c.time_s <= measurement.time_s);
            let applied = &corrections[next.checked_sub(1)?];
            Some(own_s - measurement.time_s - applied.offset_s)
        })
        .filter(|apart_s| apart_s.is_finite())
        .collect();
    let count = corrections.len();
    if apart_s.len() < FEWEST_READINGS {
        return Some(recordings::time_corrections(station, count, None));
    }
    let off_s = median(apart_s)?;
    Some(if off_s.abs() > DOUBTED_S {
        time_corrections_contradict_stamps(station, count, off_s)
    } else {
        recordings::time_corrections(station, count, Some(off_s))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deployment::Measurement;
    use crate::deployment::kinds;

    const START_S: f64 = 1_657_569_001.0;

    /// A reading every 0.4 s, with a jitter of 1 ms. The own clock is ahead by `ahead_s` (s), a function of the time since the
    /// start (s).
    fn track(ahead_s: impl Fn(f64) -> f64) -> Track {
        let since_s = (0..1000).map(|k| f64::from(k) * 0.4);
        let jitter_s = |t: f64| 1e-3 * (t * 91.7).sin();
        Track {
            measurements: since_s
                .clone()
                .map(|t| Measurement {
                    time_s: START_S + t,
                    range_m: 10.0,
                    azimuth_rad: 0.1,
                    zenith_rad: 1.5,
                })
                .collect(),
            own_clock_s: since_s.map(|t| START_S + t + ahead_s(t) + jitter_s(t)).collect(),
            ..Track::default()
        }
    }

    fn words(tracks: [Track; 3]) -> String {
        let corrections = PerStation::repeat(tracks.len(), Vec::new());
        let found = findings(&tracks.into(), &corrections);
        found.iter().map(|f| format!("{} {f}\n", f.severity.mark())).collect()
    }

    #[test]
    fn offset_drift_and_jump_are_told_apart() {
        let drifting = compare(&track(|t| 0.3 + 40e-6 * t)).expect("enough");
        assert!((drifting.median_s - 0.308).abs() < 1e-3, "{drifting:?}");
        assert!((drifting.drift_ppm - 40.0).abs() < 2.0, "{drifting:?}");
        assert!(drifting.jumps.is_empty() && drifting.spread_s < 1.5e-3, "{drifting:?}");

        let set = compare(&track(|t| if t < 200.0 { 30e-6 * t } else { -0.25 + 30e-6 * t }));
        let set = set.expect("enough");
        let [jump] = set.jumps[..] else { panic!("{set:?}") };
        assert!((jump.time_s - START_S - 200.0).abs() < 0.5, "{set:?}");
        assert!((jump.by_s + 0.25).abs() < 2e-3, "{set:?}");
        assert!((set.drift_ppm - 30.0).abs() < 3.0, "{set:?}");
        assert!(set.spread_s < 1.5e-3, "{set:?}");
    }

    #[test]
    fn an_offset_is_a_note_and_what_clocks_do_not_do_is_a_warning() {
        let steady = || track(|_| 3600.0);
        let said = words([steady(), track(|_| 0.3), track(|_| -0.2)]);
        assert!(said.starts_with("- own clocks minus") && !said.contains('!'), "{said}");
        assert!(said.contains("station 2 +0.300") && said.contains("station 3 -0.200"), "{said}");
        let said = words([steady(), track(|t| 150e-6 * t), steady()]);
        assert!(said.contains("! station 2: its own clock") && said.contains("+150 ppm"), "{said}");
        let said = words([steady(), steady(), track(|t| if t < 100.0 { 0.0 } else { 0.05 })]);
        assert!(said.contains("! station 3: own clock minus stamp jumps by +0.05"), "{said}");
        assert!(said.contains("at 100.0 s"), "{said}");
    }

    #[test]
    fn without_own_clocks_nothing_is_said() {
        let bare = || Track { own_clock_s: Vec::new(), ..track(|_| 0.0) };
        assert_eq!(words([bare(), bare(), bare()]), "");
        let same = || {
            let mut same = track(|_| 0.0);
            same.own_clock_s = same.measurements.iter().map(|m| m.time_s).collect();
            same
        };
        assert!(words([same(), same(), same()]).contains("are the stations' own clocks"));
    }

    #[test]
    fn corrections_that_were_not_applied_are_doubted() {
        let corrections = |offset_s| {
            let every = [START_S - 1.0, START_S + 100.0];
            every.map(|time_s| TimeCorrection { time_s, offset_s }).to_vec()
        };
        let tracks = [track(|_| 0.0), track(|_| 0.3), track(|_| 0.3)];
        let corrections = [vec![], corrections(0.3), corrections(0.0)];
        let found = findings(&tracks.into(), &corrections.into());
        let of = |station| found.iter().find(|f| f.is_about_station(station)).expect("said");
        assert_eq!(of(1).kind, kinds::TIME_CORRECTIONS, "{found:?}");
        assert_eq!(of(2).kind, kinds::TIME_CORRECTIONS_CONTRADICT_STAMPS, "{found:?}");
        let difference_s = of(2).value("difference").expect("a difference");
        assert!((difference_s - 0.3).abs() < 1e-4, "{found:?}");
    }
}
