//! Changes of the time offset between an estimate and the ground truth during the drive.

use crate::estimates::matched_pose::MatchedPose;
use crate::estimates::pose_interpolation::PoseInterpolation;
use resect_core::deployment::EstimatedPose;
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
    /// It changes within minutes: size (s).
    Wander { sigma_s: f64 },
}

/// Smallest number of epochs, and time at either side of a step (s, share of the drive).
/// Effect: near the ends, errors of a few seconds are like a step.
const FEWEST: usize = 40;
const BESIDE_S: f64 = 5.0;
const BESIDE_SHARE: f64 = 0.05;
/// Smallest change that is said (s). Field: it moves a vehicle by a centimetre.
pub const LEAST_S: f64 = 0.01;

impl ClockChange {
    /// Returns the change of the offset at a time (s), apart from a constant.
    fn change_s(self, time_s: f64) -> f64 {
        match self {
            Self::Step { time_s: step_s, by_s } => f64::from(u8::from(time_s >= step_s)) * by_s,
            Self::Drift { per_s } => per_s * time_s,
            Self::Jitter { .. } | Self::Wander { .. } => 0.0,
        }
    }

    /// Returns the change times a factor.
    pub fn scaled(self, factor: f64) -> Self {
        match self {
            Self::Step { time_s, by_s } => Self::Step { time_s, by_s: factor * by_s },
            Self::Drift { per_s } => Self::Drift { per_s: factor * per_s },
            other => other,
        }
    }

    /// Returns the change with a step that is later by some time (s).
    pub fn later(self, later_s: f64) -> Self {
        match self {
            Self::Step { time_s, by_s } => Self::Step { time_s: time_s + later_s, by_s },
            other => other,
        }
    }

    /// Returns the largest change of the offset between two times of a drive of this duration (s).
    pub fn size_s(self, duration_s: f64) -> f64 {
        match self {
            Self::Step { by_s, .. } => by_s.abs(),
            Self::Drift { per_s } => per_s.abs() * duration_s,
            Self::Jitter { sigma_s } | Self::Wander { sigma_s } => sigma_s,
        }
    }

    /// Returns pairs as they would be matched with the change. The mean offset stays.
    pub fn applied(self, pairs: &[MatchedPose]) -> Vec<MatchedPose> {
        let change_s = |pair: &MatchedPose| self.change_s(pair.truth.time_s);
        let mean_s = pairs.iter().map(change_s).sum::<f64>() / pairs.len() as f64;
        // The one of the two that was interpolated.
        let other = |pair: &MatchedPose| EstimatedPose {
            time_s: pair.truth.time_s,
            position_m: match pair.pose_twist {
                Some(_) => pair.pose.position_m,
                None => pair.truth.position_m,
            },
            orientation: match (pair.pose_twist, &pair.truth.rotation) {
                (Some(_), _) => pair.pose.orientation,
                (None, rotation) => rotation.as_ref().map(|rotation| rotation.orientation),
            },
        };
        let others: Vec<EstimatedPose> = pairs.iter().map(other).collect();
        let curve = PoseInterpolation::new(&others);
        let changed = |pair: &MatchedPose| {
            let later_s = change_s(pair) - mean_s;
            let mut pair = pair.clone();
            // A later ground truth is an earlier estimate.
            let sign = if pair.pose_twist.is_some() { -1.0 } else { 1.0 };
            let Some(moved) = curve.pose_at(pair.truth.time_s + sign * later_s) else {
                return pair;
            };
            match &mut pair.truth.rotation {
                _ if pair.pose_twist.is_some() => {
                    pair.pose = EstimatedPose { time_s: pair.pose.time_s, ..moved };
                }
                Some(rotation) => {
                    pair.truth.position_m = moved.position_m;
                    rotation.orientation = moved.orientation.unwrap_or(rotation.orientation);
                }
                None => pair.truth.position_m = moved.position_m,
            }
            pair
        };
        pairs.iter().map(changed).collect()
    }
}

/// Returns the drift and the step that are nearest to the clock that the filter followed, as times and offsets (s). Smaller ones than can be
/// said are left out.
pub fn candidates(clock: &[(f64, f64)]) -> Vec<ClockChange> {
    if clock.len() < FEWEST {
        return Vec::new();
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
    let [mut product, mut spread] = [0.0; 2];
    for (time_s, offset_s) in clock {
        product += (time_s - middle_s) * (offset_s - mean_s);
        spread += (time_s - middle_s).powi(2);
    }
    let per_s = product / spread;
    let drift = (per_s * (to_s - from_s), ClockChange::Drift { per_s });
    let beside_s = BESIDE_S.max(BESIDE_SHARE * (to_s - from_s));
    let splits = (1..clock.len()).step_by(clock.len().div_ceil(500)).filter(|split| {
        let time_s = clock[*split].0;
        time_s - from_s >= beside_s && to_s - time_s >= beside_s
    });
    let best = splits
        .map(|split| clock.split_at(split))
        .min_by(|a, b| (squares(a.0) + squares(a.1)).total_cmp(&(squares(b.0) + squares(b.1))));
    let step = best.map(|(before, after)| {
        // The filter follows a step only after a while.
        let middle = |values: &[(f64, f64)]| median(values.iter().map(|(_, offset_s)| *offset_s));
        let by_s = middle(after).unwrap_or_default() - middle(before).unwrap_or_default();
        (by_s, ClockChange::Step { time_s: after[0].0, by_s })
    });
    // The filter follows a part of the change.
    let is_large = |(by_s, _): &(f64, ClockChange)| by_s.abs() > 0.5 * LEAST_S;
    std::iter::once(drift).chain(step).filter(is_large).map(|(_, change)| change).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_and_drifts_are_found_and_small_changes_are_none() {
        let all = |offset_s: &dyn Fn(f64) -> f64| {
            let times_s = (0..1000).map(|index| f64::from(index) * 0.2);
            candidates(&times_s.map(|time_s| (time_s, offset_s(time_s))).collect::<Vec<_>>())
        };
        let ripple = |time_s: f64| 0.002 * (3.0 * time_s).sin();
        let stepped = all(&|time_s| ripple(time_s) - if time_s > 120.0 { 0.7 } else { 0.0 });
        let is_step = |change: &ClockChange| {
            matches!(change, ClockChange::Step { time_s, by_s }
                if (time_s - 120.0).abs() < 0.5 && (by_s + 0.7).abs() < 0.01)
        };
        assert!(stepped.iter().any(is_step), "{stepped:?}");
        let drifted = all(&|time_s| ripple(time_s) + 1e-3 * time_s);
        let is_drift = |change: &ClockChange| matches!(change, ClockChange::Drift { per_s } if (per_s - 1e-3).abs() < 1e-5);
        assert!(drifted.iter().any(is_drift), "{drifted:?}");
        assert_eq!(all(&ripple), []);
    }
}
