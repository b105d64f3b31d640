//! Plans from earlier drives: presets and past deployments.

use nalgebra::{Matrix3, Vector2, Vector3};

use super::way::{Piece, waypoints_along};
use super::{Plan, PlannedInstrument, PlannedRig};
use crate::simulation::{Ground, Preset, Scenario, simulate_scenario};
use resect_core::analysis::Analysis;
use resect_core::calibration::Verdict;
use resect_core::calibration::joint::JointEstimate;
use resect_core::deployment::Deployment;
use resect_core::evaluation::rig_layout::prisms_in_vehicle;
use resect_core::geometry::ARCSECOND_RAD;
use resect_core::geometry::{RigidTransform, align_level, align_rigid};
use resect_core::network::{PerStation, Prism};
use resect_core::pipeline::Thresholds;

/// Spacing of the waypoints along a recorded path (m).
const APART_M: f64 = 2.0;
/// Sampling interval of a vehicle's position (s).
const STEP_S: f64 = 0.2;

/// Largest median error of the distances (mm); above it the readings contradict each other and the calibration is not
/// usable.
const MOST_MISFIT_MM: f64 = 100.0;

/// Reason for which a deployment gives no plan.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{deployment}: {why}; choose a deployment whose stations are determined")]
pub struct NoPlan {
    deployment: String,
    why: String,
}

impl Plan {
    /// Returns the plan of a preset's drive with a seed, at its own positions.
    pub fn from_preset(preset: Preset, seed: u64) -> Self {
        let scenario = preset.scenario();
        let noiseless = Scenario { control_point_sets: 0, pillars: false, ..scenario.clone() };
        let motion = simulate_scenario(&noiseless, seed).truth.motion;
        let steps = (scenario.duration_s / STEP_S) as usize;
        let time_s: Vec<f64> = (0..=steps).map(|step| step as f64 * STEP_S).collect();
        let places_m: Vec<Vector2<f64>> =
            time_s.iter().map(|t| motion.position_m(&Vector3::zeros(), *t).xy()).collect();
        let noise = scenario.noise;
        let prisms_m = scenario.prisms_m.clone();
        Self {
            name: preset.name().to_owned(),
            stations_m: stations_m(&scenario),
            speed_m_per_s: scenario.cruise_m_per_s,
            turn_radius_m: 1.0,
            ground: scenario.ground,
            rig: PlannedRig { prisms_m, ..PlannedRig::default() },
            instrument: PlannedInstrument {
                range_mm: 1e3 * noise.range_sigma_m,
                range_ppm: 0.0,
                angle_arcsec: noise.angle_sigma_rad / ARCSECOND_RAD,
                rate_hz: scenario.rate_hz,
                lost_locks_per_minute: noise.lost_locks_per_minute,
                outlier_share: noise.outlier_share,
                ..PlannedInstrument::default()
            },
            way: vec![Piece::Waypoints(waypoints_along(&time_s, &places_m, APART_M))],
            ..Self::default()
        }
    }

    /// Returns the plan of a deployment's drive, in the frame of its station 1.
    ///
    /// # Errors
    /// [`NoPlan`] without a usable calibration or a known rig, or if the tracks are not in the frames of the stations.
    pub fn from_analysis(deployment: &Deployment, analysis: &Analysis) -> Result<Self, NoPlan> {
        let lacking = |why: String| NoPlan { deployment: deployment.name.clone(), why };
        let answer = analysis.answer.as_ref().map_err(|error| {
            let why = error.to_string();
            let named = format!("{}: ", deployment.name);
            lacking(why.strip_prefix(&named).unwrap_or(&why).to_owned())
        })?;
        let (calibration, triplets) = (&answer.calibration, &answer.triplets);
        let verdict = calibration.verdict;
        if verdict > Verdict::Weak {
            let verdict = verdict.name();
            return Err(lacking(format!(
                "its calibration is {verdict}, so the station positions are unknown"
            )));
        }
        let misfit_mm = answer.evaluation.inter_prism_mm.map_or(0.0, |spread| spread.median);
        if misfit_mm > MOST_MISFIT_MM {
            return Err(lacking(format!(
                "its inter-prism distances are off by {misfit_mm:.0} mm (median), so the station positions are unknown"
            )));
        }
        let transforms = calibration
            .placing_tracks(deployment)
            .filter(|_| !triplets.is_empty())
            .ok_or_else(|| lacking("its tracks are not in the stations' own frames".to_owned()))?;
        let placed = |index: usize| -> PerStation<Vector3<f64>> {
            triplets
                .points_m
                .zip(transforms, |points_m, transform| transform.apply(&points_m[index]))
        };
        let places_m: Vec<PerStation<Vector3<f64>>> = (0..triplets.len()).map(placed).collect();
        let level_m: Vec<Vector2<f64>> = places_m.iter().map(|at| middle_m(at).xy()).collect();
        let height_m =
            places_m.iter().map(|at| middle_m(at).z).sum::<f64>() / places_m.len() as f64;
        let followed = &analysis.offer.followed;
        let as_driven = as_driven(deployment, followed, &triplets.time_s, &places_m)
            .ok_or_else(|| lacking("the prism positions of its rig are unknown".to_owned()))?;
        let waypoints = waypoints_along(&triplets.time_s, &level_m, APART_M);
        let inter_prism_sigma_m = analysis.settings.calibration.inter_prism_sigma_m;
        let joint = calibration.joint();
        Ok(Self {
            // The name shows the quality of the calibration behind the plan.
            name: match verdict {
                Verdict::Good => deployment.name.clone(),
                _ => format!("{} (from a {} calibration)", deployment.name, verdict.name()),
            },
            // Numbers are rounded to the digits that matter in a plan.
            stations_m: transforms.map(|at| at.translation_m.map(|m| rounded(m, 3))),
            turn_radius_m: 1.0,
            // The height of the prisms above the ground is unknown, so the ground is placed at their mean height.
            ground: Ground {
                height_m: rounded(height_m, 2),
                slope_rms_rad: rounded(as_driven.slope_rms_rad.to_degrees(), 2).to_radians(),
                ..Ground::default()
            },
            rig: PlannedRig {
                prisms_m: as_driven
                    .prisms_m
                    .iter()
                    .map(|prism_m| prism_m.map(|m| rounded(m, 4)))
                    .collect(),
                inter_prism_sigma_m,
                ..PlannedRig::default()
            },
            instrument: joint
                .map_or_else(PlannedInstrument::default, PlannedInstrument::from_estimate),
            thresholds: analysis.settings.pipeline.thresholds,
            errors: analysis.settings.calibration.errors,
            is_driven: true,
            way: vec![Piece::Waypoints(waypoints)],
            ..Self::default()
        })
    }
}

/// Returns the attitude of the rig during a drive; `None` if the positions of its prisms are unknown.
fn as_driven(
    deployment: &Deployment,
    followed: &PerStation<Prism>,
    time_s: &[f64],
    places_m: &[PerStation<Vector3<f64>>],
) -> Option<AsDriven> {
    let given = deployment.rig.as_ref().and_then(prisms_in_vehicle);
    let as_driven = given.and_then(|(prisms_m, _)| {
        let of_each = |prism: &Prism| prisms_m.get(*prism).copied();
        let prisms_m: PerStation<_> = followed.iter().map(of_each).collect::<Option<_>>()?;
        AsDriven::of(&prisms_m, time_s, places_m)
    });
    as_driven.or_else(|| {
        Prism::is_one(followed).then(|| AsDriven {
            prisms_m: followed.map(|_| Vector3::zeros()),
            slope_rms_rad: Ground::default().slope_rms_rad,
        })
    })
}

impl PlannedInstrument {
    /// Returns an instrument with the precision and rate of an estimate.
    pub fn from_estimate(joint: &JointEstimate) -> Self {
        let levels = &joint.levels;
        // A plan has one precision of angles.
        let angle_rad = levels.horizontal_rad.hypot(levels.vertical_rad) / 2_f64.sqrt();
        Self {
            range_mm: rounded(1e3 * levels.range_m(), 2),
            // The estimated level scales the stated noise, its constant and its ppm term alike.
            range_ppm: rounded(1e3 * levels.range_m(), 2),
            angle_arcsec: rounded(angle_rad / ARCSECOND_RAD, 2),
            rate_hz: rounded(joint.solution.readings_hz(), 2),
            stamp_jitter_ms: rounded(1e3 * levels.jitter_s, 2),
            range_wander_mm: rounded(1e3 * joint.slow_ranges.sigma_m, 3),
            ..Self::default()
        }
    }
}

fn rounded(value: f64, decimals: i32) -> f64 {
    let scale = 10_f64.powi(decimals);
    (value * scale).round() / scale
}

/// Attitude of the rig on the vehicle during a drive.
pub(super) struct AsDriven {
    /// Prisms of the stations relative to their mean: x ahead, y left, z up (m).
    pub prisms_m: PerStation<Vector3<f64>>,
    /// Pitch and roll of the vehicle (rad, root mean square).
    pub slope_rms_rad: f64,
}

impl AsDriven {
    /// Estimates the attitude from positions of the stations' prisms; `None` for prisms on a line or a vehicle that never moves.
    pub fn of(
        prisms_m: &PerStation<Vector3<f64>>,
        time_s: &[f64],
        places_m: &[PerStation<Vector3<f64>>],
    ) -> Option<Self> {
        /// Distance between two positions that determines the heading (m).
        const HEADING_M: f64 = 0.5;
        let middle_m = middle_m(prisms_m);
        // The poses of two prisms have a heading, and no slope.
        let pose = |at: &PerStation<_>| {
            let (at, prisms_m) = (at.as_slice(), prisms_m.as_slice());
            align_rigid(at, prisms_m).or_else(|| Some(align_level(at, prisms_m)?.into()))
        };
        let poses: Vec<RigidTransform> = places_m.iter().map(pose).collect::<Option<_>>()?;
        let up = |pose: &RigidTransform| pose.rotation.inverse() * Vector3::z();
        let mean_up = poses.iter().map(up).sum::<Vector3<f64>>().try_normalize(1e-9)?;
        let squares: f64 = poses.iter().map(|pose| up(pose).angle(&mean_up).powi(2)).sum();
        let of_poses_rad = (squares / poses.len() as f64).sqrt();
        let slope_rms_rad = axis_slope_rms_rad(prisms_m, places_m).unwrap_or(of_poses_rad);
        let (mut ahead, mut from) = (Vector3::zeros(), 0);
        for now in 1..poses.len() {
            let gone_m = poses[now].apply(&middle_m) - poses[from].apply(&middle_m);
            // The path across a gap is unknown.
            if time_s[now] - time_s[now - 1] > 1.0 {
                from = now;
            } else if gone_m.norm() > HEADING_M {
                ahead += poses[(now + from) / 2].rotation.inverse() * gone_m.normalize();
                from = now;
            }
        }
        let ahead = (ahead - mean_up * mean_up.dot(&ahead)).try_normalize(1e-6)?;
        let left = mean_up.cross(&ahead);
        let vehicle = Matrix3::from_columns(&[ahead, left, mean_up]).transpose();
        Some(Self { prisms_m: prisms_m.map(|at| vehicle * (at - middle_m)), slope_rms_rad })
    }
}

/// Returns the slope by the elevations of the axis of two prisms (rad, root mean square); `None` for further prisms.
///
/// The axis shows one of pitch and roll; the other is taken to be as large.
fn axis_slope_rms_rad(
    prisms_m: &PerStation<Vector3<f64>>,
    places_m: &[PerStation<Vector3<f64>>],
) -> Option<f64> {
    let first_m = *prisms_m.iter().next()?;
    let second = prisms_m.iter().position(|prism_m| *prism_m != first_m)?;
    let both = [first_m, prisms_m[second]];
    if !prisms_m.iter().all(|prism_m| both.contains(prism_m)) {
        return None;
    }
    let elevation_rad = |prisms_m: &PerStation<Vector3<f64>>| {
        let axis_m = prisms_m[second] - prisms_m[0];
        axis_m.z.atan2(axis_m.xy().norm())
    };
    let count = places_m.len() as f64;
    let mean_rad = places_m.iter().map(elevation_rad).sum::<f64>() / count;
    let squares: f64 = places_m.iter().map(elevation_rad).map(|rad| (rad - mean_rad).powi(2)).sum();
    Some((2.0 * squares / count).sqrt())
}

/// Returns the positions of a scenario's stations (m).
fn stations_m(scenario: &Scenario) -> PerStation<Vector3<f64>> {
    std::iter::once(Vector3::zeros()).chain(scenario.stations_m.iter().copied()).collect()
}

/// Returns the mean of the stations' prisms.
pub(super) fn middle_m(prisms_m: &PerStation<Vector3<f64>>) -> Vector3<f64> {
    prisms_m.iter().sum::<Vector3<f64>>() / prisms_m.len() as f64
}

impl Default for Plan {
    /// The stations, rig and instruments of the preset warthog, without a path.
    fn default() -> Self {
        let scenario = Preset::Warthog.scenario();
        Self {
            name: String::new(),
            target_mm: 2.0,
            speed_m_per_s: 0.8,
            turn_radius_m: 3.5,
            stations_m: stations_m(&scenario),
            ground: Ground::default(),
            rig: PlannedRig::default(),
            instrument: PlannedInstrument::default(),
            thresholds: Thresholds::default(),
            errors: resect_core::calibration::ErrorSizes::default(),
            is_driven: false,
            way: Vec::new(),
        }
    }
}
