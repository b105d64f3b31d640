//! Findings of the live drive: one constructor for each warning, with its message.

use crate::kinds;
use resect_core::calibration::Estimate;
use resect_core::deployment::{Finding, Subject, Unit};
use resect_core::network::{Number, Station, StationPair};

pub fn no_connection(why: &str) -> Finding {
    Finding::new(kinds::LIVE_NO_CONNECTION, format!("no connection: {why}"))
}

/// `age_s` is the time since the last reading of the station.
pub fn lost_lock(station: usize, age_s: f64) -> Finding {
    Finding::new(
        kinds::LIVE_LOST_LOCK,
        format!(
            "station {} lost its prism: no reading for {age_s:.0} s; drive where it sees its prism, and lock it on \
             again",
            station + 1
        ),
    )
    .about(Subject::Station(station))
    .quantity("age", age_s, Unit::Second)
}

pub fn clock_jumped(station: usize, by_s: f64) -> Finding {
    Finding::new(
        kinds::LIVE_CLOCK_JUMPED,
        format!(
            "station {}'s clock jumped by {by_s:+.3} s; check its synchronisation, and begin the drive again",
            station + 1
        ),
    )
    .about(Subject::Station(station))
    .quantity("jump", by_s, Unit::Second)
}

/// A station that moved, by the joint estimate; `when` is the time of the step in words.
pub fn station_stepped(
    station: usize,
    moved_m: &Estimate,
    turned_rad: &Estimate,
    when: &str,
) -> Finding {
    stepped(
        station,
        &format!(
            "station {} moved {when} by {:.0} ± {:.0} mm and turned by {:+.2} ± {:.2} mrad",
            station + 1,
            moved_m.value * 1e3,
            moved_m.sigma * 1e3,
            turned_rad.value * 1e3,
            turned_rad.sigma * 1e3
        ),
    )
    .estimate("moved", moved_m, Unit::Metre)
    .estimate("turned", turned_rad, Unit::Radian)
}

/// A clock that jumped, by the joint estimate; `when` is the time of the step in words.
pub fn clock_stepped(station: usize, by_s: &Estimate, when: &str) -> Finding {
    stepped(
        station,
        &format!(
            "station {}'s clock jumped {when}: its stamps are {:+.0} ± {:.0} ms later",
            station + 1,
            by_s.value * 1e3,
            by_s.sigma * 1e3
        ),
    )
    .estimate("jump", by_s, Unit::Second)
}

fn stepped(station: usize, event: &str) -> Finding {
    let message = format!("{event}; check its tripod and its clock, and begin the drive again");
    Finding::new(kinds::LIVE_STEPPED, message).about(Subject::Station(station))
}

/// `station` follows a wrong prism, `None` if not determined; the distance between the prisms of `pair` deviates by `off_m` (m).
pub fn wrong_prism(station: Option<Station>, pair: StationPair, off_m: f64) -> Finding {
    let who = match station {
        Some(station) => format!("station {station} may track the wrong prism"),
        None => "a station may track the wrong prism".to_owned(),
    };
    let finding = Finding::new(
        kinds::LIVE_WRONG_PRISM,
        format!(
            "{who}: the distance between the prisms of stations {} and {} is off by {:.0} mm; check the prism that each \
             station points at",
            pair.first,
            pair.second,
            off_m * 1e3
        ),
    )
    .quantity("distance_error", off_m, Unit::Metre);
    match station {
        Some(station) => finding.about(Subject::Station(station.index())),
        None => finding,
    }
}

pub fn straight_line(length_m: f64) -> Finding {
    Finding::new(
        kinds::LIVE_STRAIGHT_LINE,
        format!(
            "some directions are unobservable: the drive so far is a straight line of {length_m:.0} m; turn once \
             around on the spot at both ends, or drive a figure-eight if the place allows"
        ),
    )
    .quantity("length", length_m, Unit::Metre)
}

pub fn no_rig() -> Finding {
    Finding::new(
        kinds::LIVE_NO_RIG,
        "no answer is possible: the inter-prism distances are unknown; give a file of the rig",
    )
}

/// `message` names the topics or instruments.
pub fn no_station(message: &str) -> Finding {
    Finding::new(kinds::LIVE_NO_STATION, message)
}

pub fn not_recorded(why: &str) -> Finding {
    Finding::new(kinds::LIVE_NOT_RECORDED, why)
}

/// An example of each kind of finding that this crate makes.
pub fn examples() -> Vec<Finding> {
    let moved_m = Estimate { value: 0.03, sigma: 0.002 };
    let turned_rad = Estimate { value: 2e-3, sigma: 1e-4 };
    vec![
        no_connection("refused"),
        lost_lock(1, 12.0),
        clock_jumped(2, -0.2),
        station_stepped(1, &moved_m, &turned_rad, "200 s into the drive"),
        clock_stepped(1, &moved_m, "200 s into the drive"),
        wrong_prism(Some(Station::at(2)), StationPair::at(1), 0.4),
        wrong_prism(None, StationPair::at(0), 0.4),
        straight_line(42.0),
        no_rig(),
        no_station("give the station of `/rts4`"),
        not_recorded("disk full"),
    ]
}
