//! Content of one trajectory, without a ground truth: length, rate, gaps, jumps, and the quantities that it states.

use nalgebra::Vector3;

use resect_core::deployment::{EstimatedPose, EstimatedTrajectory};
use resect_core::statistics::{median, quantiles};

/// An interval longer than this multiple of the median is a gap.
const GAP: f64 = 5.0;
/// Number of steps that are listed, the fastest first.
const LISTED_STEPS: usize = 3;
/// Share of the steps that have a usual speed.
const USUAL: f64 = 0.95;

/// Content of a trajectory.
#[derive(Clone, Debug, PartialEq)]
pub struct TrajectorySummary {
    pub poses: usize,
    /// First and last time (s).
    pub span_s: [f64; 2],
    pub path_m: f64,
    /// Poses per second by the median interval; `None` for a single pose.
    pub rate_hz: Option<f64>,
    pub longest_interval: Option<Step>,
    /// Intervals that are longer than five times the median.
    pub gaps: Vec<Step>,
    /// Speed that 95 % of the steps do not exceed (m/s).
    pub usual_speed_m_per_s: Option<f64>,
    /// Steps with the largest speeds.
    pub fastest: Vec<Step>,
    /// Corners of the box around all positions (m).
    pub low_m: Vector3<f64>,
    pub high_m: Vector3<f64>,
    pub has_orientations: bool,
    /// Median of σ along an axis (m); `None` without covariances.
    pub sigma_m: Option<f64>,
}

/// Step from one pose to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Step {
    /// Time of its start (s).
    pub time_s: f64,
    pub lasts_s: f64,
    pub length_m: f64,
}

impl Step {
    pub fn speed_m_per_s(&self) -> f64 {
        self.length_m / self.lasts_s
    }
}

/// Summarises a trajectory, which has at least one pose.
pub fn summarise(trajectory: &EstimatedTrajectory) -> TrajectorySummary {
    let poses = &trajectory.poses;
    let steps: Vec<Step> = poses
        .windows(2)
        .map(|two| Step {
            time_s: two[0].time_s,
            lasts_s: two[1].time_s - two[0].time_s,
            length_m: (two[1].position_m - two[0].position_m).norm(),
        })
        .collect();
    let usual_s = median(steps.iter().map(|step| step.lasts_s));
    let gap_s = usual_s.map_or(f64::INFINITY, |usual_s| GAP * usual_s);
    let mut fastest = steps.clone();
    fastest.sort_by(|a, b| b.speed_m_per_s().total_cmp(&a.speed_m_per_s()));
    fastest.truncate(LISTED_STEPS);
    let corner = |choose: fn(f64, f64) -> f64| {
        let positions_m = poses.iter().map(|pose| pose.position_m);
        positions_m.reduce(|a, b| a.zip_map(&b, choose)).unwrap_or_default()
    };
    let sigmas_m = trajectory
        .covariances
        .iter()
        .map(|covariance| (covariance.position_m2.trace() / 3.0).max(0.0).sqrt());
    TrajectorySummary {
        poses: poses.len(),
        span_s: [poses.first(), poses.last()].map(|pose| pose.map_or(0.0, |pose| pose.time_s)),
        path_m: steps.iter().map(|step| step.length_m).sum(),
        rate_hz: usual_s.map(f64::recip),
        longest_interval: steps.iter().copied().max_by(|a, b| a.lasts_s.total_cmp(&b.lasts_s)),
        usual_speed_m_per_s: quantiles(steps.iter().map(Step::speed_m_per_s), [USUAL])
            .map(|[speed]| speed),
        gaps: steps.into_iter().filter(|step| step.lasts_s > gap_s).collect(),
        fastest,
        low_m: corner(f64::min),
        high_m: corner(f64::max),
        has_orientations: trajectory.has_orientations(),
        sigma_m: median(sigmas_m),
    }
}

/// Root mean square distance of poses from their mean (m); 0 without any.
pub fn extent_m(poses: &[EstimatedPose]) -> f64 {
    let count = poses.len().max(1) as f64;
    let mean_m = poses.iter().map(|pose| pose.position_m).sum::<Vector3<f64>>() / count;
    let squares = poses.iter().map(|pose| (pose.position_m - mean_m).norm_squared());
    (squares.sum::<f64>() / count).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_and_jumps_have_their_times() {
        // 10 Hz at 1 m/s, a gap of 2 s after the 50th pose, and a jump of 3 m after the 80th.
        let pose = |index: usize| EstimatedPose {
            time_s: 0.1 * index as f64 + if index > 50 { 2.0 } else { 0.0 },
            position_m: Vector3::new(0.1 * index as f64, if index > 80 { 3.0 } else { 0.0 }, -1.0),
            orientation: None,
        };
        let trajectory = EstimatedTrajectory {
            name: "slam".to_owned(),
            path: "slam.tum".into(),
            topic: None,
            frames: None,
            poses: (0..=100).map(pose).collect(),
            covariances: Vec::new(),
            origin: None,
            findings: Vec::new(),
        };
        let summary = summarise(&trajectory);
        assert_eq!(summary.poses, 101);
        assert!((summary.span_s[1] - 12.0).abs() < 1e-9, "{summary:?}");
        assert!((summary.rate_hz.expect("many") - 10.0).abs() < 1e-6, "{summary:?}");
        assert!((summary.path_m - 12.9).abs() < 0.2, "{summary:?}");
        let [gap] = summary.gaps[..] else { panic!("{summary:?}") };
        assert!((gap.time_s - 5.0).abs() < 1e-9 && (gap.lasts_s - 2.1).abs() < 1e-9, "{gap:?}");
        assert_eq!(summary.longest_interval, Some(gap));
        assert!((summary.fastest[0].time_s - 10.0).abs() < 1e-9, "{summary:?}");
        assert!((summary.fastest[0].length_m - 3.0).abs() < 0.01, "{summary:?}");
        assert!((summary.usual_speed_m_per_s.expect("many") - 1.0).abs() < 1e-6, "{summary:?}");
        assert_eq!((summary.low_m.z, summary.high_m.y), (-1.0, 3.0));
        assert!(!summary.has_orientations && summary.sigma_m.is_none());
    }
}
