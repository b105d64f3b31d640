//! Urgent warnings in the field, as data: finding, time of onset, remedy.

use super::findings::{
    clock_jumped, lost_lock, no_connection, no_rig, no_station, not_recorded, straight_line,
    wrong_prism,
};
use super::judged::{Judged, Outcome, station_in_common};
use super::status::StationStatus;
use crate::kinds;
use resect_core::calibration::inter_prism::drive_shape::PlanView;
use resect_core::deployment::station_clocks::ClockJump;
use resect_core::deployment::{Finding, FindingKind};
use resect_core::network::PerStation;

/// Time without a reading after which a station gets a warning (s).
const LOST_S: f64 = 10.0;
/// Time for which an event remains on display, whatever follows (s of the drive).
const TOLD_S: f64 = 60.0;

/// Returns true if a warning contradicts the readings, so that no answer is enough meanwhile.
pub fn speaks_against_readings(kind: FindingKind) -> bool {
    matches!(kind, kinds::LIVE_CLOCK_JUMPED | kinds::LIVE_STEPPED | kinds::LIVE_WRONG_PRISM)
}

/// Returns true if a warning is shown for a while after it has happened.
fn is_event(kind: FindingKind) -> bool {
    matches!(kind, kinds::LIVE_CLOCK_JUMPED | kinds::LIVE_WRONG_PRISM)
}

/// A finding of the live drive, with its onset (s, the source's clock).
#[derive(Clone, Debug, PartialEq)]
pub struct Warning {
    pub since_s: f64,
    pub finding: Finding,
}

/// Input of the warnings.
pub struct Seen<'a> {
    /// Reason for a lost connection.
    pub lost: Option<&'a str>,
    pub stations: &'a PerStation<StationStatus>,
    pub clock_jumps: PerStation<Option<ClockJump>>,
    pub deciding: Option<&'a Judged>,
    pub latest: Option<&'a Outcome>,
    pub has_rig: bool,
    /// Topics or instruments without a station, in one line.
    pub no_station: Option<&'a str>,
    /// Reason why the recording stopped.
    pub not_recorded: Option<&'a str>,
}

/// Returns all present findings.
pub fn amiss(seen: &Seen<'_>) -> Vec<Finding> {
    let mut all = Vec::new();
    if let Some(why) = seen.lost {
        all.push(no_connection(why));
    } else {
        for (station, status) in seen.stations.iter().enumerate() {
            if let Some(age_s) = status.age_s.filter(|age_s| *age_s > LOST_S) {
                all.push(lost_lock(station, age_s));
            }
        }
    }
    for (station, jump) in seen.clock_jumps.iter().enumerate() {
        all.extend(jump.map(|jump| clock_jumped(station, jump.by_s)));
    }
    for stepped in seen.deciding.iter().flat_map(|judged| &judged.stepped) {
        if !all.iter().any(|known| known.identity() == stepped.identity()) {
            all.push(stepped.clone());
        }
    }
    if let Some((outcome, off_m)) =
        seen.latest.and_then(|one| Some((one, one.lately_off_m.as_ref()?)))
    {
        let is_off = outcome.wrong_pairs();
        if is_off.iter().any(|is_off| *is_off) {
            let worst = off_m.each().max_by(|(_, a), (_, b)| a.total_cmp(b));
            all.extend(worst.map(|(pair, m)| wrong_prism(station_in_common(&is_off), pair, *m)));
        }
    }
    let judged = seen.deciding.or_else(|| seen.latest?.judged.as_ref().ok().map(AsRef::as_ref));
    if let Some(PlanView::StraightLine { length_m, .. }) = judged.and_then(|judged| judged.plan) {
        all.push(straight_line(length_m));
    }
    if !seen.has_rig {
        all.push(no_rig());
    }
    all.extend(seen.no_station.map(no_station));
    all.extend(seen.not_recorded.map(not_recorded));
    all
}

/// The warnings on display, each with the last time at which its condition was met.
#[derive(Clone, Debug, Default)]
pub struct Told {
    warnings: Vec<(Warning, f64)>,
}

impl Told {
    /// Returns the warnings on display at an instant (s, the source's clock), given the findings present then.
    pub fn update(&mut self, now_s: f64, amiss: Vec<Finding>) -> Vec<Warning> {
        for finding in amiss {
            let is_same = |known: &Warning| known.finding.identity() == finding.identity();
            match self.warnings.iter_mut().find(|(known, _)| is_same(known)) {
                Some((known, last_s)) => (known.finding, *last_s) = (finding, now_s),
                None => self.warnings.push((Warning { since_s: now_s, finding }, now_s)),
            }
        }
        self.warnings.retain(|(warning, last_s)| {
            let told_s = if is_event(warning.finding.kind) { TOLD_S } else { 0.0 };
            now_s - last_s <= told_s
        });
        self.warnings.iter().map(|(warning, _)| warning.clone()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::judged::NoAnswer;

    fn seen<'a>(stations: &'a PerStation<StationStatus>) -> Seen<'a> {
        Seen {
            lost: None,
            stations,
            clock_jumps: PerStation::repeat(3, None),
            deciding: None,
            latest: None,
            has_rig: true,
            no_station: None,
            not_recorded: None,
        }
    }

    fn locked() -> PerStation<StationStatus> {
        let locked = StationStatus { locked: true, age_s: Some(0.3), ..Default::default() };
        PerStation::repeat(3, locked)
    }

    fn names(seen: &Seen<'_>) -> Vec<(&'static str, Option<usize>)> {
        let all = amiss(seen);
        let station = |finding: &Finding| (0..3).find(|k| finding.is_about_station(*k));
        all.iter().map(|finding| (finding.kind.code, station(finding))).collect()
    }

    #[test]
    fn nothing_is_said_where_nothing_is_amiss() {
        assert_eq!(names(&seen(&locked())), []);
    }

    #[test]
    fn a_station_without_a_reading_for_ten_seconds_is_told() {
        let mut stations = locked();
        stations[1].age_s = Some(9.9);
        assert_eq!(names(&seen(&stations)), []);
        stations[1].age_s = Some(10.1);
        assert_eq!(names(&seen(&stations)), [("lost-lock", Some(1))]);
        // Without a connection the state of the stations is unknown.
        let lost = Seen { lost: Some("refused"), ..seen(&stations) };
        assert_eq!(names(&lost), [("no-connection", None)]);
    }

    #[test]
    fn a_clock_that_jumped_is_told_for_a_while() {
        let stations = locked();
        let jump = Some(ClockJump { time_s: 5.0, by_s: -0.2 });
        let jumped = Seen { clock_jumps: [None, None, jump].into(), ..seen(&stations) };
        assert_eq!(names(&jumped), [("clock-jumped", Some(2))]);
        let mut told = Told::default();
        assert_eq!(told.update(100.0, amiss(&jumped)).len(), 1);
        let later = told.update(150.0, Vec::new());
        assert_eq!((later.len(), later[0].since_s), (1, 100.0));
        assert_eq!(told.update(161.0, Vec::new()), []);
    }

    #[test]
    fn a_wrong_prism_is_told_with_its_station() {
        let stations = locked();
        let off = |off_m: [f64; 3]| Outcome {
            is_first: true,
            judged: Err(NoAnswer { why: "no answer".to_owned(), drive: None }),
            lately_off_m: Some(off_m.into()),
        };
        let right = off([0.002, 0.04, 0.001]);
        assert_eq!(names(&Seen { latest: Some(&right), ..seen(&stations) }), []);
        let wrong = off([0.3, 0.002, 0.4]);
        assert_eq!(
            names(&Seen { latest: Some(&wrong), ..seen(&stations) }),
            [("wrong-prism", Some(1))]
        );
    }

    #[test]
    fn what_nobody_said_beforehand_is_asked_for() {
        let stations = locked();
        assert_eq!(names(&Seen { has_rig: false, ..seen(&stations) }), [("no-rig", None)]);
        let no_station = Seen { no_station: Some("say which"), ..seen(&stations) };
        assert_eq!(names(&no_station), [("no-station", None)]);
        let not_recorded = Seen { not_recorded: Some("disk full"), ..seen(&stations) };
        assert_eq!(names(&not_recorded), [("not-recorded", None)]);
    }
}
