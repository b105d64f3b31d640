//! Simulation of a plan, without noise and without errors.

use super::locks::{self, Lock};
use super::plan::PlannedInstrument;
use super::prediction::PlanError;
use super::{Plan, way};
use crate::simulation::{
    Ground, Motion, Noise, Path, Preset, Ramp, Scenario, Simulated, Waypoint, simulate_scenario,
};
use resect_core::deployment::Deployment;
use resect_core::geometry::ARCSECOND_RAD;
use resect_core::network::{Number, PerStation, Station};
use resect_core::pipeline;
use resect_core::pipeline::{PipelineOutput, PipelineSettings};

/// Seed of the ground's bumps, the same for all predictions.
const SEED: u64 = 1;
/// Stop of the vehicle after its arrival (s).
const AFTER_S: f64 = 1.0;
/// Upper limit of the duration: this multiple of length over slowest speed plus stops, and a constant (s) for turns and
/// braking.
const LONGER: f64 = 3.0;
const LONGER_BY_S: f64 = 120.0;

/// A simulated plan.
pub struct Driven {
    pub simulated: Simulated,
    pub deployment: Deployment,
    pub pipeline: PipelineOutput,
    pub locks: PerStation<Lock>,
}

impl Plan {
    /// Returns the plan as a scenario, with the noise of its instruments and without systematic errors. The frame is that
    /// of station 1, with the axes of the plan.
    pub fn scenario(&self) -> Result<Scenario, PlanError> {
        self.check().map_err(|(what, remedy)| PlanError::Senseless { what, remedy })?;
        let first_m = self.stations_m[Station::FIRST];
        let moved =
            |at: Waypoint| Waypoint { x_m: at.x_m - first_m.x, y_m: at.y_m - first_m.y, ..at };
        let waypoints: Vec<_> = self.waypoints().into_iter().map(moved).collect();
        let ramps = self.ground.ramps.iter().map(|ramp| Ramp {
            centre_m: [ramp.centre_m[0] - first_m.x, ramp.centre_m[1] - first_m.y],
            ..*ramp
        });
        let mean_range_m = waypoints.iter().map(|at| at.place_m().norm()).sum::<f64>()
            / waypoints.len().max(1) as f64;
        let PlannedInstrument { range_mm, range_ppm, angle_arcsec, .. } = self.instrument;
        let mut scenario = Scenario {
            name: "plan",
            duration_s: AFTER_S + duration_s(&waypoints, self.turn_radius_m, self.speed_m_per_s),
            cruise_m_per_s: self.speed_m_per_s,
            ground: Ground {
                height_m: self.ground.height_m - first_m.z,
                ramps: ramps.collect(),
                ..self.ground
            },
            path: Path::Waypoints { waypoints, turn_radius_m: self.turn_radius_m },
            noise: Noise {
                range_sigma_m: 1e-3 * range_mm + 1e-6 * range_ppm * mean_range_m,
                angle_sigma_rad: angle_arcsec * ARCSECOND_RAD,
                outlier_share: self.instrument.outlier_share,
                lost_locks_per_minute: self.instrument.lost_locks_per_minute,
                wrong_targets_per_minute: 0.0,
            },
            rate_hz: self.instrument.rate_hz,
            prisms_m: self.rig.prisms_m.clone(),
            antennas_m: None,
            stations_m: self.stations_m.iter().skip(1).map(|other_m| other_m - first_m).collect(),
            control_point_sets: 0,
            pillars: false,
            ..Preset::Warthog.scenario()
        };
        scenario.errors.resize(self.stations_m.len(), self.rig.prisms_m.len());
        Ok(scenario)
    }
}

/// Returns the duration of a drive through waypoints (s), at the cruising speed for those without a speed.
fn duration_s(waypoints: &[Waypoint], turn_radius_m: f64, cruise_m_per_s: f64) -> f64 {
    let speed_m_per_s = |at: &Waypoint| at.speed_m_per_s.unwrap_or(cruise_m_per_s);
    let slowest = waypoints.iter().map(speed_m_per_s).fold(f64::INFINITY, f64::min);
    let standing_s: f64 = waypoints.iter().map(|at| at.stand_s).sum();
    let latest_s = LONGER * (way::length_m(waypoints) / slowest + standing_s) + LONGER_BY_S;
    Motion::arrival_s(waypoints, turn_radius_m, cruise_m_per_s, latest_s)
}

/// Simulates a plan and the noise-free readings of its stations.
pub fn drive(plan: &Plan) -> Result<Driven, PlanError> {
    drive_with(plan, &vec![0.0; plan.stations_m.len().saturating_sub(1)])
}

/// Simulates a plan like [`drive`], with yaws of stations 2, 3, … against the axes of the plan.
pub fn drive_with(plan: &Plan, yaws_rad: &[f64]) -> Result<Driven, PlanError> {
    let scenario = plan.scenario()?;
    let period_s = 1.0 / scenario.rate_hz;
    let stations = scenario.stations();
    let stagger_s = |station: Station| station.index() as f64 * period_s / stations as f64;
    let scenario = Scenario {
        noise: Noise {
            range_sigma_m: 0.0,
            angle_sigma_rad: 0.0,
            outlier_share: 0.0,
            lost_locks_per_minute: 0.0,
            wrong_targets_per_minute: 0.0,
        },
        // Stations read in turn, which is neither the best nor the worst case.
        stagger_s: Some(PerStation::from_fn(stations, stagger_s)),
        yaws_rad: Some(yaws_rad.to_vec()),
        ..scenario
    };
    let simulated = simulate_scenario(&scenario, SEED);
    let mut deployment = Deployment { name: plan.name.clone(), ..simulated.readings() };
    let locks = locks::held(&mut deployment.tracks, &simulated, plan);
    let settings = PipelineSettings { thresholds: plan.thresholds, ..PipelineSettings::default() };
    let pipeline = pipeline::run(&deployment, &settings);
    if pipeline.triplets.is_empty() {
        let tau_l_s = plan.thresholds.tau_l_seconds;
        let remedy = "plan the path within reach of all stations, or drive more slowly";
        return Err(PlanError::NothingRead { tau_l_s, remedy });
    }
    Ok(Driven { simulated, deployment, pipeline, locks })
}
