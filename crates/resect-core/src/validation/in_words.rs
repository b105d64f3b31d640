//! A validation in words.

use std::fmt;

use super::metric::MetricThere;
use super::moved::{Difference, StationMove};
use super::outcome::{Cause, LEVEL, Outcome};
use super::validate::Validation;
use crate::deployment::{ToldAngle, ToldIn};

/// How an angle is worded: in which unit, with how many digits.
pub type Tell<'a> = dyn Fn(&ToldAngle) -> String + 'a;

/// Chance is not told smaller than this.
const SMALLEST_CHANCE: f64 = 1e-9;

/// "does not hold for run 2: station 2 turned by +0.310 ± 0.055 mrad …": one sentence.
impl fmt::Display for Validation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.in_words(&ToldAngle::to_string))
    }
}

impl Validation {
    /// The sentence with its angles in other words.
    pub fn in_words(&self, tell: &Tell<'_>) -> String {
        format!("{} for {}: {}", self.outcome.name(), self.deployment, self.why_with(tell))
    }

    /// Why the outcome is what it is.
    pub fn why(&self) -> String {
        self.why_with(&ToldAngle::to_string)
    }

    /// Puts the finding's angles in other words.
    pub fn why_with(&self, tell: &Tell<'_>) -> String {
        let metric = self.metric.as_ref().map_or(String::new(), |metric| format!("; {metric}"));
        match (&self.outcome, &self.difference) {
            (Outcome::CannotBeTold(why), _) => why.clone(),
            (Outcome::DoesNotHold(cause), Some(difference)) => {
                format!("{}{metric}", of_cause(cause, difference, tell))
            }
            (_, Some(difference)) => {
                format!(
                    "no station moved by more than σ allows ({}, tested at {:.0} % in all); {}{metric}",
                    chance(difference.p_value),
                    LEVEL * 100.0,
                    would_show(difference, tell)
                )
            }
            (_, None) => String::new(),
        }
    }
}

fn of_cause(cause: &Cause, difference: &Difference, tell: &Tell<'_>) -> String {
    let moved = |station: usize| {
        format!("station {} {}", station + 1, difference.stations[station].in_words(tell))
    };
    match cause {
        Cause::Station(station) => {
            let p_value = difference.stations[*station].p_value;
            format!("{} ({}), which explains the difference", moved(*station), chance(p_value))
        }
        Cause::OneOf(stations) => {
            let each: Vec<String> = stations.iter().map(|station| moved(*station)).collect();
            format!("either {}: which cannot be told", each.join(", or "))
        }
        Cause::NoneAlone => format!(
            "the answers differ by more than σ allows ({}), and no station explains it alone: several moved, or \
             something else is wrong",
            chance(difference.p_value)
        ),
        Cause::OtherSetUp => {
            let [second, third] = [0, 4].map(|slot| {
                let far_m = difference.values.fixed_rows::<3>(slot).norm();
                let turned = ToldAngle::signed(difference.values[slot + 3], ToldIn::Degrees, 2);
                format!("{far_m:.2} m and {}", tell(&turned))
            });
            format!(
                "this is another set-up: stations 2 and 3 stand {second}, and {third}, from where they stood"
            )
        }
        Cause::Metric => "no station moved by more than σ allows".to_owned(),
    }
}

/// What a run of this kind would have seen.
fn would_show(difference: &Difference, tell: &Tell<'_>) -> String {
    let seen = difference.stations.each_ref().map(StationMove::visible);
    let least = |of: &dyn Fn((f64, f64)) -> String| {
        seen.map(|seen| seen.map_or("–".to_owned(), of)).join(" / ")
    };
    format!(
        "moves of stations 1 / 2 / 3 alone would show from about {} mm on, turns from {} on",
        least(&|(moved_m, _)| format!("{:.2}", moved_m * 1e3)),
        least(&|(_, turned_rad)| tell(&ToldAngle::size(turned_rad, ToldIn::Milliradians, 2)))
    )
}

impl StationMove {
    /// "turned by +0.310 ± 0.055 mrad and moved by 1.2 ± 0.9 mm (x +0.8, y -0.7, z +0.5)".
    fn in_words(&self, tell: &Tell<'_>) -> String {
        let (turned, moved) = (self.turned_rad(), self.moved_m());
        let [x, y, z] = [0, 1, 2].map(|axis| self.by[axis] * 1e3);
        format!(
            "turned by {} and moved by {:.1} ± {:.1} mm (x {x:+.1}, y {y:+.1}, z {z:+.1})",
            tell(&ToldAngle::signed(turned.value, ToldIn::Milliradians, 3).sigma(turned.sigma)),
            moved.value * 1e3,
            moved.sigma * 1e3,
        )
    }

    /// What its move says about the difference.
    pub fn verdict(&self) -> &'static str {
        match (self.rejects(), self.explains_all()) {
            (false, _) => "need not have moved",
            (true, true) => "explains it alone",
            (true, false) => "does not explain it alone",
        }
    }
}

/// "prisms are off by 1.92 mm there (median; own answer 0.86), more than σ allows".
impl fmt::Display for MetricThere {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let than = if self.is_worse() { "more than" } else { "which" };
        write!(
            f,
            "distances between prisms are off by {:.2} mm there (median; {:.2} by the run's own answer), {than} σ allows",
            self.earlier_mm.median, self.own_mm.median
        )
    }
}

/// "p = 0.310", "p = 3e-6", "p < 1e-9".
pub fn chance(p_value: f64) -> String {
    if p_value < SMALLEST_CHANCE {
        format!("p < {SMALLEST_CHANCE:.0e}")
    } else if p_value < 1e-3 {
        format!("p = {p_value:.0e}")
    } else {
        format!("p = {p_value:.3}")
    }
}
