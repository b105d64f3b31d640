//! Findings about outlying triplets, and about the search of the prior.

use crate::deployment::kinds;
use crate::deployment::{Deployment, Finding, Overrides, Remedy, StatedPrismChange, Subject, Unit};

/// `count` of `all` triplets were left out; `is_many` is true if the rest may be wrong too.
pub fn outliers_left_out(count: usize, all: usize, is_many: bool) -> Finding {
    let share = count as f64 / all as f64;
    let line = match count {
        1 => "1 outlying triplet was left out".to_owned(),
        _ => format!("{count} outlying triplets were left out"),
    };
    let finding = if is_many {
        Finding::new(
            kinds::MANY_OUTLIERS_LEFT_OUT,
            format!(
                "{line}, {:.0} % of all: the rest may be wrong as well; check if a station followed another prism, or if the \
                 distances are those of another rig",
                1e2 * share
            ),
        )
    } else {
        Finding::new(kinds::OUTLIERS_LEFT_OUT, line)
    };
    finding.count("triplets", count).quantity("share", share, Unit::Ratio)
}

/// A span (s, in the stations' clock) of a drive that begins at `start_s`.
pub fn span_left_out(span_s: [f64; 2], start_s: f64) -> Finding {
    let [from_s, to_s] = span_s;
    Finding::new(
        kinds::SPAN_LEFT_OUT,
        format!(
            "most triplets from {:.0} to {:.0} s of the drive do not fit the rest and were left out: a station moved, or \
             followed another prism for that time; cut the recording there",
            from_s - start_s,
            to_s - start_s
        ),
    )
    .quantity("from", from_s, Unit::Second)
    .quantity("to", to_s, Unit::Second)
    .with(Remedy::ShowTimes(span_s))
}

/// Readings of a station (from 0) in a span (s) were left out: so many, off by so much (m). It may have followed another prism. The drive
/// begins at `start_s`; `others` further spans are like it.
pub fn station_left_out(
    (station, prism): (usize, Option<usize>),
    (span_s, start_s): ([f64; 2], f64),
    (readings, error_m): (usize, f64),
    others: usize,
) -> Finding {
    let [from_s, to_s] = span_s.map(|time_s| time_s - start_s);
    let what = prism.map_or_else(
        || "contradicts the other stations".to_owned(),
        |prism| format!("followed prism {prism} instead of its own"),
    );
    let off =
        if error_m < 0.1 { format!("{:.0} mm", error_m * 1e3) } else { format!("{error_m:.2} m") };
    let further = match others {
        0 => String::new(),
        1 => "; one further span is like it".to_owned(),
        _ => format!("; {others} further spans are like it"),
    };
    let finding = Finding::new(
        kinds::STATION_LEFT_OUT,
        format!(
            "station {} {what} from {from_s:.0} to {to_s:.0} s of the drive (off by {off}); its {readings} readings \
             there were left out{further}",
            station + 1
        ),
    )
    .about(Subject::Station(station))
    .quantity("from", span_s[0], Unit::Second)
    .quantity("to", span_s[1], Unit::Second)
    .quantity("error", error_m, Unit::Metre)
    .count("readings", readings)
    .with(Remedy::ShowTimes(span_s));
    match prism {
        Some(prism) => finding.count("prism", prism),
        None => finding,
    }
}

/// A station followed another prism from the first of `changes` on, and its own again from the second; the drive begins at `start_s`.
pub fn prism_changed(
    changes: &[StatedPrismChange],
    deployment: &Deployment,
    start_s: f64,
) -> Finding {
    let since_s = |change: &StatedPrismChange| change.time_s - start_s;
    let [first, rest @ ..] = changes else { return span_left_out([start_s; 2], start_s) };
    let to =
        rest.first().map_or_else(|| "its end".to_owned(), |back| format!("{:.0} s", since_s(back)));
    let in_toml = |change: &StatedPrismChange| {
        let StatedPrismChange { station, time_s, prism } = change;
        format!("{{ station = {station}, time_s = {time_s:.2}, prism = {prism} }}")
    };
    let list: Vec<String> = changes.iter().map(in_toml).collect();
    let stated = deployment.overrides.prism_changes.iter().flatten().chain(changes).copied();
    let overrides = Overrides { prism_changes: Some(stated.collect()), ..Overrides::default() };
    Finding::new(
        kinds::PRISM_CHANGED,
        format!(
            "station {} followed prism {} from {:.0} s of the drive to {to}; its readings were left out; to use them, set \
             prism_changes = [{}] in deployment.toml",
            first.station,
            first.prism,
            since_s(first),
            list.join(", ")
        ),
    )
    .about(Subject::Station(usize::from(first.station) - 1))
    .quantity("from", first.time_s, Unit::Second)
    .count("prism", usize::from(first.prism))
    .with(Remedy::ReadWith(Box::new(overrides)))
}

/// `largest_m` is the largest error of a distance; `None` if it is unknown.
pub fn outliers_shift_answer(count: usize, largest_m: Option<f64>, shift_m: f64) -> Finding {
    let message = match largest_m {
        Some(largest_m) => format!(
            "{count} outlying triplets shift this answer by {:.0} mm (their distances are off by up to {largest_m:.2} m): a \
             station lost its prism or followed another; the joint estimate leaves them out if it converges",
            shift_m * 1e3
        ),
        None => format!(
            "{count} outlying triplets shift this answer by {:.0} mm; the joint estimate leaves them out if it converges",
            shift_m * 1e3
        ),
    };
    Finding::new(kinds::OUTLIERS_SHIFT_ANSWER, message)
        .count("triplets", count)
        .quantity("shift", shift_m, Unit::Metre)
        .with(Remedy::JointEstimate)
}

pub fn prior_search_unconfirmed() -> Finding {
    Finding::new(
        kinds::PRIOR_SEARCH_UNCONFIRMED,
        "the search of the prior found no optimum that three other runs confirm; compare with the closed form",
    )
    .with(Remedy::ClosedFormPrior)
}

pub fn prior_search_elsewhere(apart_m: f64) -> Finding {
    Finding::new(
        kinds::PRIOR_SEARCH_ELSEWHERE,
        format!(
            "the search of the prior ended {apart_m:.2} m from this answer, in another minimum such as the mirrored solution; \
             the answer does not depend on it"
        ),
    )
    .quantity("apart", apart_m, Unit::Metre)
}

pub(super) fn examples() -> Vec<Finding> {
    vec![
        outliers_left_out(5, 1000, false),
        outliers_left_out(300, 1000, true),
        span_left_out([120.0, 160.0], 20.0),
        station_left_out((2, Some(2)), ([120.0, 124.0], 20.0), (12, 0.97), 0),
        station_left_out((1, None), ([120.0, 124.0], 20.0), (12, 0.4), 2),
        prism_changed(
            &[StatedPrismChange { station: 2, time_s: 120.0, prism: 3 }],
            &Deployment::default(),
            20.0,
        ),
        outliers_shift_answer(5, Some(2.0), 0.04),
        outliers_shift_answer(5, None, 0.04),
        prior_search_unconfirmed(),
        prior_search_elsewhere(0.8),
    ]
}
