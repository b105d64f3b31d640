//! Changes of the time offset between an estimate and the ground truth during the drive.

use resect_core::statistics::median;

/// A change of the time offset that is added to the estimate's times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ClockChange {
    /// It changes by a step (s) at a time of the ground truth (s).
    Step { time_s: f64, by_s: f64 },
    /// It changes steadily (s of change for each second).
    Drift { per_s: f64 },
    /// It changes to and fro from stamp to stamp: size (s).
    Jitter { sigma_s: f64 },
}

/// Smallest number of epochs, and time at either side of a step (s).
const FEWEST: usize = 40;
const BESIDE_S: f64 = 5.0;
/// Smallest change that is said (s). Field: it moves a vehicle by a centimetre.
const LEAST_S: f64 = 0.01;
/// Longest time within which a wander changes that is said (s).
/// Effect: a slower one cannot be told from lasting errors along the motion. Field: jitter of stamps changes from reading to reading.
const LONGEST_JITTER_S: f64 = 2.0;
/// A step or a drift explains all but this share of the clock's variance.
/// Effect: a larger share takes wander for a step. Simulated: wander leaves more than half of it.
const LEFT: f64 = 0.15;

/// Returns the change by the clock that the filter followed, as times and offsets (s); `None` if it is constant. `sigma_s` is the size of
/// its wander, which changes within `within_s`.
pub fn clock_change(clock: &[(f64, f64)], [sigma_s, within_s]: [f64; 2]) -> Option<ClockChange> {
    if clock.len() < FEWEST {
        return None;
    }
    let mean = |values: &[(f64, f64)]| {
        values.iter().map(|(_, offset_s)| offset_s).sum::<f64>() / values.len() as f64
    };
    let squares = |values: &[(f64, f64)]| {
        let mean_s = mean(values);
        values.iter().map(|(_, offset_s)| (offset_s - mean_s).powi(2)).sum::<f64>()
    };
    let (from_s, to_s) = (clock[0].0, clock[clock.len() - 1].0);
    let (middle_s, mean_s) =
        (clock.iter().map(|(time_s, _)| time_s).sum::<f64>() / clock.len() as f64, mean(clock));
    let total = squares(clock);
    let [mut product, mut spread] = [0.0; 2];
    for (time_s, offset_s) in clock {
        product += (time_s - middle_s) * (offset_s - mean_s);
        spread += (time_s - middle_s).powi(2);
    }
    let per_s = product / spread;
    let drift = (total - product * per_s, ClockChange::Drift { per_s }, per_s * (to_s - from_s));
    let splits = (1..clock.len()).step_by(clock.len().div_ceil(500)).filter(|split| {
        let time_s = clock[*split].0;
        time_s - from_s >= BESIDE_S && to_s - time_s >= BESIDE_S
    });
    let steps = splits.map(|split| {
        let (before, after) = clock.split_at(split);
        // The filter follows a step only after a while.
        let middle = |values: &[(f64, f64)]| median(values.iter().map(|(_, offset_s)| *offset_s));
        let by_s = middle(after).unwrap_or_default() - middle(before).unwrap_or_default();
        let step = ClockChange::Step { time_s: clock[split].0, by_s };
        (squares(before) + squares(after), step, by_s)
    });
    let best = steps.chain([drift]).min_by(|a, b| a.0.total_cmp(&b.0));
    let change = best.filter(|(left, _, by_s)| *left < LEFT * total && by_s.abs() > LEAST_S);
    let is_jitter = sigma_s > LEAST_S && within_s < LONGEST_JITTER_S;
    change.map(|(_, change, _)| change).or(is_jitter.then_some(ClockChange::Jitter { sigma_s }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn change(offset_s: impl Fn(f64) -> f64) -> Option<ClockChange> {
        let times_s = (0..1000).map(|index| f64::from(index) * 0.2);
        let clock: Vec<(f64, f64)> = times_s.map(|time_s| (time_s, offset_s(time_s))).collect();
        clock_change(&clock, [1e-3, 3.0])
    }

    #[test]
    fn steps_and_drifts_are_told_apart_and_small_changes_are_none() {
        let ripple = |time_s: f64| 0.002 * (3.0 * time_s).sin();
        let stepped = change(|time_s| ripple(time_s) - if time_s > 120.0 { 0.7 } else { 0.0 });
        let Some(ClockChange::Step { time_s, by_s }) = stepped else { panic!("{stepped:?}") };
        assert!((time_s - 120.0).abs() < 0.5 && (by_s + 0.7).abs() < 0.01, "{stepped:?}");
        let drifted = change(|time_s| ripple(time_s) + 1e-3 * time_s);
        let Some(ClockChange::Drift { per_s }) = drifted else { panic!("{drifted:?}") };
        assert!((per_s - 1e-3).abs() < 1e-5, "{per_s}");
        assert_eq!(change(ripple), None);
        assert_eq!(change(|time_s| 0.1 * (0.2 * time_s).sin()), None);
    }
}
