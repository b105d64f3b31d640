//! What a refinement says: the refined transforms, what was estimated beside them, and how certain all of it is.

use std::borrow::Cow;

use nalgebra::{SMatrix, Vector3};

use super::model::{CLOCKS, CONSTANT, DISTANCES, DRIFTS, Matrix, State, TILTS, transforms};
use super::support::{Support, support};
use crate::calibration::inter_prism::used::Used;
use crate::calibration::joint::JointEstimate;
use crate::calibration::{CalibrationSettings, Clock, Estimate, TransformSigma, with_clocks};
use crate::geometry::{LevelTransform, RigidTransform, wrap_to_pi};
use crate::pipeline::Triplets;

/// The refined answer.
#[derive(Clone, Debug)]
pub struct Refinement {
    pub station1_from_station: [RigidTransform; 3],
    pub sigma: [TransformSigma; 2],
    /// Covariance of (x, y, z, yaw) of station 2, then of station 3 (m, rad).
    pub covariance: SMatrix<f64, 8, 8>,
    /// How late the stamps of stations 2 and 3 are against station 1's (s).
    pub clock_offsets_s: Option<[Estimate; 2]>,
    /// How much later these stamps get each second (s per s).
    pub clock_drifts: Option<[Estimate; 2]>,
    /// How much too long the prism constant makes all ranges (m); estimated with the distances.
    pub prism_constant_error_m: Option<Estimate>,
    /// Estimated inter-prism distances (m).
    pub distances_m: Option<[Estimate; 3]>,
    /// Tilts of stations 2 and 3 about their own x and y (rad).
    pub tilts_rad: Option<[[Estimate; 2]; 2]>,
    /// (x, y, z, yaw) of stations 2 and 3: refined minus plain, over the refined σ.
    pub moves_sigmas: [f64; 8],
    /// The joint estimate that this is of, where the readings themselves were used.
    pub joint: Option<Box<JointEstimate>>,
    /// Whether the data supports each group of estimates.
    pub support: Vec<Support>,
    pub converged: bool,
}

impl Refinement {
    /// The joint estimate in the place of a refinement of `plain`.
    pub fn from_joint(joint: JointEstimate, plain: &[LevelTransform; 3]) -> Self {
        let sigma = joint.sigma();
        let moves_sigmas = std::array::from_fn(|place| {
            let (now, before) =
                (&joint.station1_from_station[place / 4 + 1], &plain[place / 4 + 1]);
            match place % 4 {
                3 => wrap_to_pi(now.yaw_rad - before.yaw_rad) / sigma[place / 4].yaw_rad,
                axis => {
                    let moved_m = now.translation_m[axis] - before.translation_m[axis];
                    moved_m / sigma[place / 4].translation_m[axis]
                }
            }
        });
        Self {
            station1_from_station: joint.station1_from_station.map(RigidTransform::from),
            sigma,
            covariance: joint.covariance,
            clock_offsets_s: Some(joint.clock_offsets_s),
            clock_drifts: Some(joint.clock_drifts),
            prism_constant_error_m: None,
            distances_m: joint.distances_m,
            tilts_rad: None,
            moves_sigmas,
            support: Vec::new(),
            converged: joint.converged,
            joint: Some(Box::new(joint)),
        }
    }

    /// The triplets with all that was estimated of instruments put right, but for tilts of triplets.
    pub fn corrected(&self, triplets: Cow<'_, Triplets>) -> Triplets {
        if let Some(joint) = &self.joint {
            return joint.corrected(triplets);
        }
        let mut corrected = match self.clocks() {
            Some(clocks) => with_clocks(&triplets, clocks),
            None => triplets.into_owned(),
        };
        if let Some(longer_m) = self.prism_constant_error_m {
            for point in corrected.points_m.iter_mut().flatten() {
                *point -= longer_m.value * point.normalize();
            }
        }
        corrected
    }

    /// The points of [`Self::corrected`] by station (m), of triplets that are not copied whole where that can be.
    pub fn corrected_points_m(&self, used: &Used<'_>) -> [Vec<Vector3<f64>>; 3] {
        let Some(joint) = &self.joint else { return self.corrected(used.triplets()).points_m };
        let (time_s, interval) = used.instants();
        let mut points_m = used.points_m();
        joint.put_right(&time_s, &interval, &mut points_m);
        points_m
    }

    /// How late the stamps of stations 2 and 3 are, where that was estimated.
    pub fn clocks(&self) -> Option<[Clock; 2]> {
        let (offsets_s, drifts) = (self.clock_offsets_s?, self.clock_drifts?);
        let clock =
            |slot: usize| Clock { offset_s: offsets_s[slot].value, drift: drifts[slot].value };
        Some([clock(0), clock(1)])
    }
}

/// The refined answer at a state, against what the plain one starts with.
pub fn summary(
    state: &State,
    start: &State,
    covariance: &Matrix,
    settings: &CalibrationSettings,
    converged: bool,
) -> Refinement {
    let sigma = |place: usize| covariance[(place, place)].max(0.0).sqrt();
    let estimate = |place: usize| Estimate { value: state[place], sigma: sigma(place) };
    let chosen = settings.estimate;
    Refinement {
        station1_from_station: transforms(state),
        sigma: [0, 4].map(|at| TransformSigma {
            translation_m: Vector3::new(sigma(at), sigma(at + 1), sigma(at + 2)),
            yaw_rad: sigma(at + 3),
        }),
        covariance: covariance.fixed_view::<8, 8>(0, 0).into_owned(),
        clock_offsets_s: chosen.clocks.then(|| [0, 1].map(|slot| estimate(CLOCKS + slot))),
        prism_constant_error_m: chosen.distances.then(|| estimate(CONSTANT)),
        clock_drifts: chosen.clocks.then(|| [0, 1].map(|slot| estimate(DRIFTS + slot))),
        distances_m: chosen.distances.then(|| [0, 1, 2].map(|pair| estimate(DISTANCES + pair))),
        tilts_rad: chosen
            .tilt
            .then(|| [0, 1].map(|slot| [0, 1].map(|axis| estimate(TILTS + 2 * slot + axis)))),
        moves_sigmas: std::array::from_fn(|place| estimate(place).sigmas_from(start[place])),
        joint: None,
        support: support(state, start, covariance, chosen),
        converged,
    }
}
