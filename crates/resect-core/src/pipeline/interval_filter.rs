//! Module 3: drops intervals that are too short to interpolate well.

use super::Interval;

/// Returns the intervals longer than τ_l, in order; `None` keeps all.
pub fn filter(intervals: &[Interval], tau_l_seconds: Option<f64>) -> Vec<Interval> {
    let shortest_s = tau_l_seconds.unwrap_or(0.0);
    intervals.iter().copied().filter(|interval| interval.length_s() > shortest_s).collect()
}
