//! Disagreement of two methods: an answer is not trusted while another one differs from it by more than both σ allow.

use nalgebra::Vector3;

use super::{Calibration, Method};
use crate::deployment::findings::answers::{MethodDifference, methods_disagree};
use crate::deployment::{Deployment, Finding, TrackFrame};
use crate::geometry::{RigidTransform, wrap_to_pi};

/// Two answers disagree from this many standard deviations on.
const DISAGREEMENT_SIGMAS: f64 = 3.0;
/// Smallest rms difference in the working area that is reported (m): the resolution of the instruments.
const NOTABLE_M: f64 = 0.005;

/// A significant difference between the answers of two methods for one station.
#[derive(Clone, Debug, PartialEq)]
pub struct Disagreement {
    pub methods: [Method; 2],
    /// The station, from 2 on.
    pub station: usize,
    /// Second answer's translation minus the first's (m).
    pub translation_m: [f64; 3],
    pub yaw_rad: f64,
    /// The difference of yaw over the σ of both.
    pub yaw_sigmas: Option<f64>,
    /// The largest difference of (x, y, z, yaw), in σ.
    pub largest_sigmas: f64,
    /// Difference of the two positions of what the station measured (m, rms), and the mean range of that (m).
    pub moved_m: f64,
    pub range_m: f64,
}

impl Disagreement {
    /// Returns the finding that the two methods disagree, with the yaw if its difference is significant.
    pub fn finding(&self) -> Finding {
        let names = self
            .methods
            .map(|method| method.letter().map_or_else(|| method.to_string(), String::from));
        methods_disagree(&MethodDifference {
            methods: names.each_ref().map(String::as_str),
            station: self.station - 1,
            translation_m: self.translation_m,
            yaw_rad: self.yaw_rad,
            yaw_sigmas: self.yaw_sigmas.filter(|sigmas| *sigmas > DISAGREEMENT_SIGMAS),
            largest_sigmas: self.largest_sigmas,
            moved_m: self.moved_m,
            range_m: self.range_m,
        })
    }
}

/// Returns the significant differences of two answers; empty if they are about different frames, or if one uses the control points of
/// the other.
pub fn disagreements(
    a: &Calibration,
    b: &Calibration,
    deployment: &Deployment,
) -> Vec<Disagreement> {
    let from_tracks = [a, b].map(|answer| answer.method.is_from_tracks());
    if deployment.track_frame == TrackFrame::Common && from_tracks[0] != from_tracks[1] {
        return Vec::new();
    }
    // The joint estimate reports a change between its survey and the drive itself.
    if (a.survey().is_some() && !from_tracks[1]) || (b.survey().is_some() && !from_tracks[0]) {
        return Vec::new();
    }
    let at = |station| difference(deployment, [a, b], station);
    (1..a.station1_from_station.len()).filter_map(at).filter(|d| d.moved_m > NOTABLE_M).collect()
}

/// Returns the difference of two answers for a station (from 0); `None` if it is not significant, or if an answer has no σ.
fn difference(
    deployment: &Deployment,
    answers: [&Calibration; 2],
    station: usize,
) -> Option<Disagreement> {
    let [a, b] = answers.map(|answer| answer.station1_from_station[station]);
    let [Some(sigma_a), Some(sigma_b)] =
        answers.map(|answer| answer.sigma.as_ref().map(|sigma| sigma[station]))
    else {
        return None;
    };
    let off = b.translation_m - a.translation_m;
    let yaw_rad = wrap_to_pi(b.yaw_rad() - a.yaw_rad());
    let yaw_sigmas = yaw_rad.abs() / sigma_a.yaw_rad.hypot(sigma_b.yaw_rad);
    let axis_sigmas = (0..3).map(|axis| {
        off[axis].abs() / sigma_a.translation_m[axis].hypot(sigma_b.translation_m[axis])
    });
    let largest_sigmas = axis_sigmas.fold(yaw_sigmas, f64::max);
    // Most answers agree and need no working area.
    (largest_sigmas > DISAGREEMENT_SIGMAS).then(|| {
        let area_m = working_area_m(deployment, station);
        let count = area_m.len().max(1) as f64;
        Disagreement {
            methods: answers.map(Calibration::answered_by),
            station: station + 1,
            translation_m: off.into(),
            yaw_rad,
            yaw_sigmas: Some(yaw_sigmas),
            largest_sigmas,
            moved_m: apart_m(&a, &b, &area_m),
            range_m: area_m.iter().map(Vector3::norm).sum::<f64>() / count,
        }
    })
}

/// Returns the difference of two transforms at the points that a station (from 0) measured (m, rms). At the station itself the
/// difference may be much larger or smaller.
pub fn moved_m(
    deployment: &Deployment,
    station: usize,
    a: &RigidTransform,
    b: &RigidTransform,
) -> f64 {
    apart_m(a, b, &working_area_m(deployment, station))
}

/// Returns the difference of two transforms at some points (m, rms).
fn apart_m(a: &RigidTransform, b: &RigidTransform, points_m: &[Vector3<f64>]) -> f64 {
    let count = points_m.len().max(1) as f64;
    let squares = points_m.iter().map(|p| (b.apply(p) - a.apply(p)).norm_squared());
    (squares.sum::<f64>() / count).sqrt()
}

/// Returns the positions of a station's readings, about 500 of them (m, its own frame).
fn working_area_m(deployment: &Deployment, station: usize) -> Vec<Vector3<f64>> {
    let track = &deployment.tracks[station];
    let step = (track.measurements.len() / 500).max(1);
    track.measurements.iter().step_by(step).map(|m| track.position_m(m)).collect()
}
