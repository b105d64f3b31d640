//! State of each station: lock, rate of readings, age of the last one, latency.

use std::collections::VecDeque;

use super::event::Sent;
use resect_core::deployment::station_clocks;
use resect_core::deployment::station_clocks::ClockJump;
use resect_core::deployment::{Measurement, RawRecord, Track};
use resect_core::statistics::median;

/// Time without a reading after which a station has lost its prism (s).
pub const LOCKED_S: f64 = 2.0;
/// Number of readings kept for the rate, the latency and clock jumps.
const KEPT: usize = 200;
/// Span of the last readings that define the rate (s).
const RATE_OVER_S: f64 = 10.0;
/// Number of readings that define the latency.
const LATENCY_OVER: usize = 50;
/// Difference between a stamp and this computer's clock (s) above which the stamp is of another day, and gives no latency.
const LATEST_S: f64 = 300.0;
/// Smallest clock jump that is reported (s). Networks delay by as much, so smaller ones are left to the joint estimate.
const LEAST_JUMP_S: f64 = 0.05;
/// Number of readings required after a jump before it is reported: delayed readings catch up by then.
const AFTER_JUMP: usize = 20;

/// State of one station, for display.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StationStatus {
    pub locked: bool,
    /// Number of different readings so far.
    pub readings: u64,
    /// Number of the station's records without a reading.
    pub without_reading: u64,
    pub rate_hz: Option<f64>,
    /// Time since the last reading was sent (s, the source's clock).
    pub age_s: Option<f64>,
    /// Median time from the stamp of a reading to its arrival here (s), over the last ones. `None` for a replay.
    pub latency_s: Option<f64>,
    /// Number of losses of lock.
    pub lock_losses: u64,
    /// Last reported correction of its clock (s).
    pub correction_s: Option<f64>,
    /// Clock offset against station 1 with σ (s), by the joint estimate; positive if its stamps are late.
    pub late_s: Option<[f64; 2]>,
}

/// One reading, as it arrived.
#[derive(Clone, Copy, Debug)]
struct Arrived {
    measurement: Measurement,
    sent_s: f64,
    received_s: f64,
}

/// The last readings of one station.
#[derive(Clone, Debug, Default)]
pub struct Watch {
    last: VecDeque<Arrived>,
    readings: u64,
    without_reading: u64,
    lock_losses: u64,
    newest_sent_s: Option<f64>,
    correction_s: Option<f64>,
}

impl Watch {
    /// Adds a record of the station.
    pub fn take(&mut self, record: &RawRecord, sent: &Sent) {
        if record.status != 0 {
            self.without_reading += 1;
            return;
        }
        let measurement = record.measurement;
        if self.last.iter().any(|known| known.measurement.time_s == measurement.time_s) {
            return;
        }
        self.readings += 1;
        let sent_s = sent.sent_ns as f64 * 1e-9;
        let newest_s = self.newest_sent_s.get_or_insert(sent_s);
        if sent_s - *newest_s > LOCKED_S {
            self.lock_losses += 1;
        }
        *newest_s = newest_s.max(sent_s);
        self.last.push_back(Arrived { measurement, sent_s, received_s: sent.received_s });
        if self.last.len() > KEPT {
            self.last.pop_front();
        }
    }

    /// Stores the reported offset of the station's clock.
    pub fn correct(&mut self, offset_s: f64) {
        self.correction_s = Some(offset_s);
    }

    /// Returns the time at which the newest reading was sent (s, the source's clock).
    pub fn newest_sent_s(&self) -> Option<f64> {
        self.newest_sent_s
    }

    /// Returns the state of the station at an instant of the source's clock (s).
    pub fn status(&self, now_s: f64, is_live: bool) -> StationStatus {
        let age_s = self.newest_sent_s.map(|sent_s| (now_s - sent_s).max(0.0));
        let locked = age_s.is_some_and(|age_s| age_s <= LOCKED_S);
        // A loss that has not ended yet counts too.
        let losing = u64::from(age_s.is_some() && !locked);
        StationStatus {
            locked,
            readings: self.readings,
            without_reading: self.without_reading,
            rate_hz: self.rate_hz(now_s),
            age_s,
            latency_s: self.latency_s().filter(|_| is_live),
            lock_losses: self.lock_losses + losing,
            correction_s: self.correction_s,
            late_s: None,
        }
    }

    fn rate_hz(&self, now_s: f64) -> Option<f64> {
        let within = self.last.iter().filter(|one| now_s - one.sent_s <= RATE_OVER_S);
        let times_s: Vec<f64> = within.map(|one| one.measurement.time_s).collect();
        let first_s = times_s.iter().copied().min_by(f64::total_cmp)?;
        let last_s = times_s.iter().copied().max_by(f64::total_cmp)?;
        (last_s > first_s).then(|| (times_s.len() - 1) as f64 / (last_s - first_s))
    }

    fn latency_s(&self) -> Option<f64> {
        let late_s = |one: &Arrived| one.received_s - one.measurement.time_s;
        let late_s = median(self.last.iter().rev().take(LATENCY_OVER).map(late_s))?;
        (late_s.abs() < LATEST_S).then_some(late_s)
    }

    /// Returns a jump of the station's clock against the source's among the last readings; `None` if it did not last.
    pub fn clock_jump(&self) -> Option<ClockJump> {
        let mut last: Vec<&Arrived> = self.last.iter().collect();
        last.sort_by(|a, b| a.measurement.time_s.total_cmp(&b.measurement.time_s));
        // Equal offsets at both ends exclude a jump.
        let level_s =
            |of: &[&Arrived]| median(of.iter().map(|one| one.sent_s - one.measurement.time_s));
        let (first, rest) = last.split_at_checked(AFTER_JUMP)?;
        let end = rest.get(rest.len().checked_sub(AFTER_JUMP)?..)?;
        if (level_s(end)? - level_s(first)?).abs() < LEAST_JUMP_S {
            return None;
        }
        // Compares the stamps with the times of sending, as elsewhere with the stations' own clocks.
        let track = Track {
            measurements: last.iter().map(|one| one.measurement).collect(),
            own_clock_s: last.iter().map(|one| one.sent_s).collect(),
            ..Track::default()
        };
        let jumps = station_clocks::compare(&track)?.jumps;
        let net_s: f64 = jumps.iter().map(|jump| jump.by_s).sum();
        let jump = jumps.into_iter().max_by(|a, b| a.by_s.abs().total_cmp(&b.by_s.abs()))?;
        let after = track.measurements.iter().filter(|m| m.time_s >= jump.time_s).count();
        let lasts = net_s.abs() > LEAST_JUMP_S && after >= AFTER_JUMP;
        // An increase of the time from stamp to sending means that the stamps jumped back.
        lasts.then_some(ClockJump { by_s: -net_s, ..jump })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const START_S: f64 = 1_657_569_001.0;

    fn take(watch: &mut Watch, stamp_s: f64, sent_s: f64, status: i64) {
        let measurement =
            Measurement { time_s: stamp_s, range_m: 10.0, azimuth_rad: 0.1, zenith_rad: 1.5 };
        let record = RawRecord { station: 1, status, place: 1, measurement, own_clock_s: None };
        let sent_ns = (sent_s * 1e9) as u64;
        watch.take(
            &record,
            &Sent { channel: 1, sent_ns, received_s: sent_s + 0.02, payload: vec![] },
        );
    }

    #[test]
    fn lock_rate_age_and_latency_are_those_of_the_last_readings() {
        let mut watch = Watch::default();
        for k in 0..100 {
            let stamp_s = START_S + f64::from(k) * 0.4;
            take(&mut watch, stamp_s, stamp_s + 0.01, 0);
            // The same reading again, and a record without a reading.
            take(&mut watch, stamp_s, stamp_s + 0.02, 0);
            take(&mut watch, stamp_s, stamp_s + 0.02, 3);
        }
        let end_s = START_S + 99.0 * 0.4 + 0.01;
        let status = watch.status(end_s + 1.0, true);
        assert!(status.locked && status.lock_losses == 0, "{status:?}");
        assert_eq!((status.readings, status.without_reading), (100, 100));
        assert!((status.rate_hz.expect("a rate") - 2.5).abs() < 1e-6, "{status:?}");
        assert!((status.age_s.expect("an age") - 1.0).abs() < 1e-6, "{status:?}");
        assert!((status.latency_s.expect("live") - 0.03).abs() < 1e-6, "{status:?}");
        assert_eq!(watch.status(end_s, false).latency_s, None);
        let lost = watch.status(end_s + 11.0, true);
        assert!(!lost.locked && lost.lock_losses == 1 && lost.rate_hz.is_none(), "{lost:?}");
        take(&mut watch, end_s + 20.0, end_s + 20.0, 0);
        let back = watch.status(end_s + 20.0, true);
        assert!(back.locked && back.lock_losses == 1, "{back:?}");
    }

    #[test]
    fn a_clock_that_jumps_is_told_and_a_network_that_holds_up_is_not() {
        let jump = |late_s: &dyn Fn(f64) -> f64, ahead_s: &dyn Fn(f64) -> f64| {
            let mut watch = Watch::default();
            for k in 0..150 {
                let (t, jitter_s) = (f64::from(k) * 0.4, 2e-3 * (f64::from(k) * 2.4).sin());
                take(
                    &mut watch,
                    START_S + t + ahead_s(t),
                    START_S + t + 0.01 + jitter_s + late_s(t),
                    0,
                );
            }
            watch.clock_jump()
        };
        assert_eq!(jump(&|_| 0.0, &|_| 0.0), None);
        let told = jump(&|_| 0.0, &|t| if t < 30.0 { 0.0 } else { 0.2 }).expect("it jumped");
        assert!((told.by_s - 0.2).abs() < 0.005, "{told:?}");
        assert!((told.time_s - START_S - 30.2).abs() < 0.5, "{told:?}");
        // Readings of three seconds arrive all at once, 3 s to 0 s late.
        let held_up = |t: f64| if (30.0..33.0).contains(&t) { 33.0 - t } else { 0.0 };
        assert_eq!(jump(&held_up, &|_| 0.0), None);
    }
}
