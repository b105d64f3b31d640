//! What has to be known in the field at once, as data: what it is, since when, and what helps.

use super::judged::{Judged, Outcome, station_in_common};
use super::status::StationStatus;
use resect_core::calibration::inter_prism::drive_shape::Plan;
use resect_core::deployment::station_clocks::ClockJump;
use resect_core::deployment::{Finding, pair_label};

/// A station that has had no reading for so long (s) is told.
const LOST_S: f64 = 10.0;
/// What has happened is told for so long (s of the drive), whatever comes after.
const TOLD_S: f64 = 60.0;

/// What is amiss.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Amiss {
    NoConnection,
    LostLock(usize),
    ClockJumped(usize),
    /// A station that moved, or its clock, by the joint estimate.
    Stepped(usize),
    /// A prism that is not its own; of which station, where that can be told.
    WrongPrism(Option<usize>),
    StraightLine,
    NoRig,
    /// Topics or instruments whose station nobody says.
    NoStation,
    NotRecorded,
}

impl Amiss {
    /// The name that scripts read.
    pub fn name(self) -> &'static str {
        match self {
            Self::NoConnection => "no-connection",
            Self::LostLock(_) => "lost-lock",
            Self::ClockJumped(_) => "clock-jumped",
            Self::Stepped(_) => "stepped",
            Self::WrongPrism(_) => "wrong-prism",
            Self::StraightLine => "straight-line",
            Self::NoRig => "no-rig",
            Self::NoStation => "no-station",
            Self::NotRecorded => "not-recorded",
        }
    }

    /// The station that it is about, 0 to 2.
    pub fn station(self) -> Option<usize> {
        match self {
            Self::LostLock(station) | Self::ClockJumped(station) | Self::Stepped(station) => {
                Some(station)
            }
            Self::WrongPrism(station) => station,
            _ => None,
        }
    }

    /// Whether it speaks against the readings, so that no answer is enough meanwhile.
    pub fn speaks_against_readings(self) -> bool {
        matches!(self, Self::ClockJumped(_) | Self::Stepped(_) | Self::WrongPrism(_))
    }

    /// Whether it is told for a while after it has happened.
    fn is_event(self) -> bool {
        matches!(self, Self::ClockJumped(_) | Self::WrongPrism(_))
    }
}

/// Something that is amiss, since when (s, the source's clock), and what helps.
#[derive(Clone, Debug, PartialEq)]
pub struct Warning {
    pub amiss: Amiss,
    pub since_s: f64,
    pub finding: Finding,
}

/// What the warnings are read off.
pub struct Seen<'a> {
    /// Why there is no connection.
    pub lost: Option<&'a str>,
    pub stations: &'a [StationStatus; 3],
    pub clock_jumps: [Option<ClockJump>; 3],
    pub deciding: Option<&'a Judged>,
    pub latest: Option<&'a Outcome>,
    pub has_rig: bool,
    /// What has no station, in one line.
    pub no_station: Option<&'a str>,
    /// Why nothing is recorded any more.
    pub not_recorded: Option<&'a str>,
}

/// Everything that is amiss now.
pub fn amiss(seen: &Seen<'_>) -> Vec<(Amiss, String)> {
    let mut all = Vec::new();
    if let Some(why) = seen.lost {
        all.push((Amiss::NoConnection, format!("no connection: {why}")));
    } else {
        for (station, status) in seen.stations.iter().enumerate() {
            if let Some(age_s) = status.age_s.filter(|age_s| *age_s > LOST_S) {
                let line = format!(
                    "station {} has had no reading for {age_s:.0} s; stand where it sees its prism, and lock it on again",
                    station + 1
                );
                all.push((Amiss::LostLock(station), line));
            }
        }
    }
    for (station, jump) in seen.clock_jumps.iter().enumerate() {
        if let Some(jump) = jump {
            let line = format!(
                "station {}'s clock jumped by {:+.3} s; look at its synchronisation, and begin the drive again",
                station + 1,
                jump.by_s
            );
            all.push((Amiss::ClockJumped(station), line));
        }
    }
    for (station, words) in seen.deciding.iter().flat_map(|judged| &judged.stepped) {
        if !all.iter().any(|(amiss, _)| *amiss == Amiss::Stepped(*station)) {
            let line =
                format!("{words}; look at its tripod and its clock, and begin the drive again");
            all.push((Amiss::Stepped(*station), line));
        }
    }
    if let Some((outcome, off_m)) = seen.latest.and_then(|one| Some((one, one.lately_off_m?))) {
        let is_off = outcome.wrong_pairs();
        if is_off.contains(&true) {
            let station = station_in_common(is_off);
            let who = match station {
                Some(station) => format!("station {} may follow another's prism", station + 1),
                None => "a station may follow another's prism".to_owned(),
            };
            let worst = (0..3).max_by(|a, b| off_m[*a].total_cmp(&off_m[*b])).unwrap_or(0);
            let line = format!(
                "{who}: the distance {} is off by {:.0} mm; look at which prism each station points at",
                pair_label(worst),
                off_m[worst] * 1e3
            );
            all.push((Amiss::WrongPrism(station), line));
        }
    }
    let judged = seen.deciding.or_else(|| seen.latest?.judged.as_ref().ok().map(AsRef::as_ref));
    if let Some(Plan::StraightLine { length_m, .. }) = judged.and_then(|judged| judged.plan) {
        let line = format!(
            "the drive is a straight line of {length_m:.0} m so far, which leaves directions free; {}",
            "leave the line: drive a figure-eight with turns to both sides"
        );
        all.push((Amiss::StraightLine, line));
    }
    if !seen.has_rig {
        let line = "the inter-prism distances are not known, and without them there is no answer; name a file of the rig";
        all.push((Amiss::NoRig, line.to_owned()));
    }
    if let Some(line) = seen.no_station {
        all.push((Amiss::NoStation, line.to_owned()));
    }
    if let Some(line) = seen.not_recorded {
        all.push((Amiss::NotRecorded, line.to_owned()));
    }
    all
}

/// What was told, and since when.
#[derive(Clone, Debug, Default)]
pub struct Told {
    warnings: Vec<(Warning, f64)>,
}

impl Told {
    /// What is to be told at an instant (s, the source's clock), of what is amiss then.
    pub fn update(&mut self, now_s: f64, amiss: Vec<(Amiss, String)>) -> Vec<Warning> {
        for (amiss, line) in amiss {
            let finding = Finding::warning(line);
            match self.warnings.iter_mut().find(|(known, _)| known.amiss == amiss) {
                Some((known, last_s)) => (known.finding, *last_s) = (finding, now_s),
                None => {
                    let warning = Warning { amiss, since_s: now_s, finding };
                    self.warnings.push((warning, now_s));
                }
            }
        }
        self.warnings.retain(|(warning, last_s)| {
            let told_s = if warning.amiss.is_event() { TOLD_S } else { 0.0 };
            now_s - last_s <= told_s
        });
        self.warnings.iter().map(|(warning, _)| warning.clone()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::judged::NoAnswer;

    fn seen<'a>(stations: &'a [StationStatus; 3]) -> Seen<'a> {
        Seen {
            lost: None,
            stations,
            clock_jumps: [None; 3],
            deciding: None,
            latest: None,
            has_rig: true,
            no_station: None,
            not_recorded: None,
        }
    }

    fn locked() -> [StationStatus; 3] {
        [0, 1, 2].map(|_| StationStatus { locked: true, age_s: Some(0.3), ..Default::default() })
    }

    fn names(seen: &Seen<'_>) -> Vec<(&'static str, Option<usize>)> {
        let all = amiss(seen);
        assert!(all.iter().all(|(_, line)| !line.contains('\n')), "{all:?}");
        all.into_iter().map(|(amiss, _)| (amiss.name(), amiss.station())).collect()
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
        // Without a connection nobody knows what the stations see.
        let lost = Seen { lost: Some("refused"), ..seen(&stations) };
        assert_eq!(names(&lost), [("no-connection", None)]);
    }

    #[test]
    fn a_clock_that_jumped_is_told_for_a_while() {
        let stations = locked();
        let jump = Some(ClockJump { time_s: 5.0, by_s: -0.2 });
        let jumped = Seen { clock_jumps: [None, None, jump], ..seen(&stations) };
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
        let off = |off_m| Outcome {
            is_first: true,
            judged: Err(NoAnswer { why: "no answer".to_owned(), drive: None }),
            lately_off_m: Some(off_m),
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
