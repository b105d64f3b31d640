//! Tracking of the prisms along a path: range limits, rates, and prisms that hide each other.

use nalgebra::Vector3;

use super::Plan;
use crate::simulation::{EPOCH_S, Simulated};
use resect_core::deployment::{Measurement, Track};
use resect_core::network::{PerPrism, PerStation, Prism};
use resect_core::pipeline::OutlierReason;
use resect_core::pipeline::outlier_filter::{rates, too_fast};

/// Largest gap between failures that count as one (s).
const PAUSE_S: f64 = 2.0;

/// Ranges, rates and failures of one station's tracking. Times are seconds of the drive.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lock {
    /// Shortest and longest range.
    pub range_m: [f64; 2],
    /// Largest absolute rates of range, azimuth and zenith angle between readings.
    pub fastest_range_m_per_s: f64,
    pub fastest_azimuth_deg_per_s: f64,
    pub fastest_zenith_deg_per_s: f64,
    /// Spans without usable readings, in order of time.
    pub failures: Vec<LockFailure>,
}

/// A span of the drive in which a station has no usable readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LockFailure {
    pub span_s: [f64; 2],
    pub readings: usize,
    pub why: WhyNotRead,
    /// Position of the prism at its last reading (m, frame of the plan).
    pub position_m: Vector3<f64>,
}

/// Reason for which a reading is unusable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WhyNotRead {
    TooNear,
    TooFar,
    /// Another prism obstructs the line of sight.
    Hidden(Prism),
    /// The outlier filter mistakes the vehicle's motion for a gross error.
    TooFast(OutlierReason),
}

/// Evaluates the tracking of the stations, and removes readings that are impossible.
pub fn held(
    tracks: &mut PerStation<Track>,
    simulated: &Simulated,
    plan: &Plan,
) -> PerStation<Lock> {
    let of_each = tracks.iter_mut().enumerate().map(|(station, track)| {
        let lock = of_station(station, track, simulated, plan);
        let unread = |m: &Measurement| {
            let time_s = m.time_s - EPOCH_S;
            lock.failures.iter().any(|failure| {
                !matches!(failure.why, WhyNotRead::TooFast(_))
                    && (failure.span_s[0]..=failure.span_s[1]).contains(&time_s)
            })
        };
        track.measurements.retain(|m| !unread(m));
        lock
    });
    of_each.collect()
}

fn of_station(station: usize, track: &Track, simulated: &Simulated, plan: &Plan) -> Lock {
    let mut lock = Lock { range_m: [f64::INFINITY, 0.0], ..Lock::default() };
    let mut before: Option<&Measurement> = None;
    let (followed, prisms_m) = plan.rig.followed(plan.stations_m.len());
    let own = followed[station];
    for reading in &track.measurements {
        let time_s = reading.time_s - EPOCH_S;
        let at = prisms_m.map(|prism_m| simulated.truth.motion.position_m(prism_m, time_s));
        let instrument_m = simulated.truth.station1_from_station[station].translation_m;
        let range_m = (at[own] - instrument_m).norm();
        lock.range_m = [lock.range_m[0].min(range_m), lock.range_m[1].max(range_m)];
        let fast = before.and_then(|before| {
            let rates = rates(before, reading);
            let raise = |most: &mut f64, rate: f64| *most = most.max(rate.abs());
            raise(&mut lock.fastest_range_m_per_s, rates.range_m_per_s);
            raise(&mut lock.fastest_azimuth_deg_per_s, rates.azimuth_deg_per_s);
            raise(&mut lock.fastest_zenith_deg_per_s, rates.zenith_deg_per_s);
            too_fast(&rates, &plan.thresholds)
        });
        before = Some(reading);
        let hiding = hidden_by(&at, own, &instrument_m, plan.rig.clearance_m);
        let [nearest_m, furthest_m] = plan.instrument.reach_m;
        let why = match (hiding, fast) {
            _ if range_m < nearest_m => WhyNotRead::TooNear,
            _ if range_m > furthest_m => WhyNotRead::TooFar,
            (Some(prism), _) => WhyNotRead::Hidden(prism),
            (_, Some(reason)) => WhyNotRead::TooFast(reason),
            _ => continue,
        };
        let position_m = plan.stations_m[0] + at[own];
        match lock.failures.last_mut() {
            Some(last) if last.why == why && time_s - last.span_s[1] < PAUSE_S => {
                last.span_s[1] = time_s;
                last.readings += 1;
                last.position_m = position_m;
            }
            _ => lock.failures.push(LockFailure {
                span_s: [time_s; 2],
                readings: 1,
                why,
                position_m,
            }),
        }
    }
    lock
}

/// Returns another prism that is nearer than the target and close to the line of sight.
fn hidden_by(
    at: &PerPrism<Vector3<f64>>,
    followed: Prism,
    instrument_m: &Vector3<f64>,
    clearance_m: f64,
) -> Option<Prism> {
    let sight_m = at[followed] - instrument_m;
    let length_m = sight_m.norm();
    let along = sight_m.try_normalize(1e-9)?;
    at.numbers().filter(|prism| *prism != followed).find(|prism| {
        let other_m = at[*prism] - instrument_m;
        let depth_m = other_m.dot(&along);
        (0.0..length_m).contains(&depth_m) && (other_m - along * depth_m).norm() < clearance_m
    })
}
