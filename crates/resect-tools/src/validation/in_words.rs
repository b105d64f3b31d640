//! Text of a validation.

use std::fmt;

use super::metric::MetricThere;
use super::moved::{Difference, StationMove};
use super::outcome::{Cause, Outcome, level};
use super::validate::Validation;
use resect_core::deployment::{AngleFormat, MessageAngle};

/// Formatter of an angle, with its unit and number of digits.
pub type Tell<'a> = dyn Fn(&MessageAngle) -> String + 'a;

/// Smallest p-value that is printed.
const SMALLEST_CHANCE: f64 = 1e-9;

/// One sentence: "does not hold for run 2: station 2 turned by +0.310 ± 0.055 mrad …".
impl fmt::Display for Validation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.in_words(&MessageAngle::to_string))
    }
}

impl Validation {
    /// Returns the sentence with angles formatted by `tell`.
    pub fn in_words(&self, tell: &Tell<'_>) -> String {
        format!("{} for {}: {}", self.outcome.name(), self.deployment, self.why_with(tell))
    }

    /// Returns the reason for the outcome.
    pub fn why(&self) -> String {
        self.why_with(&MessageAngle::to_string)
    }

    /// Returns the reason for the outcome, with angles formatted by `tell`.
    pub fn why_with(&self, tell: &Tell<'_>) -> String {
        let metric = self.metric.as_ref().map_or(String::new(), |metric| format!("; {metric}"));
        match (&self.outcome, &self.difference) {
            (Outcome::CannotBeTold(why), _) => why.clone(),
            (Outcome::DoesNotHold(cause), Some(difference)) => {
                format!("{}{metric}", of_cause(cause, difference, tell))
            }
            (_, Some(difference)) => {
                format!(
                    "no station moved significantly ({}, level {:.0} %); {}{metric}",
                    chance(difference.p_value),
                    level(difference.stations.len()) * 100.0,
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
            format!("{} ({}); this explains the difference", moved(*station), chance(p_value))
        }
        Cause::OneOf(stations) => {
            let each: Vec<String> = stations.iter().map(|station| moved(*station)).collect();
            format!("one station moved, not determined which: {}", each.join(", or "))
        }
        Cause::NoneAlone => format!(
            "the calibrations differ significantly ({}), and no single station explains it: several moved, or something \
             else is wrong",
            chance(difference.p_value)
        ),
        Cause::OtherSetUp => {
            let others = difference.stations.numbers().filter_map(|station| {
                let row = 4 * station.slot()?;
                let far_m = difference.values.fixed_rows::<3>(row).norm();
                let turned =
                    MessageAngle::signed(difference.values[row + 3], AngleFormat::Degrees, 2);
                let verb = if row == 0 { " differs" } else { "" };
                Some(format!("station {station}{verb} by {far_m:.2} m and {}", tell(&turned)))
            });
            format!("this is another set-up: {}", others.collect::<Vec<_>>().join(", "))
        }
        Cause::Metric => "no station moved significantly".to_owned(),
    }
}

/// States the minimal detectable moves.
fn would_show(difference: &Difference, tell: &Tell<'_>) -> String {
    let seen = difference.stations.map(StationMove::visible);
    let least = |of: &dyn Fn((f64, f64)) -> String| {
        let each = seen.iter().map(|seen| seen.map_or("–".to_owned(), of));
        each.collect::<Vec<_>>().join(" / ")
    };
    let stations: Vec<String> = seen.numbers().map(|station| station.to_string()).collect();
    format!(
        "minimal detectable displacement of station {}: {} mm; minimal detectable rotation: {}",
        stations.join(" / "),
        least(&|(moved_m, _)| format!("{:.2}", moved_m * 1e3)),
        least(&|(_, turned_rad)| tell(&MessageAngle::size(
            turned_rad,
            AngleFormat::Milliradians,
            2
        )))
    )
}

impl StationMove {
    /// Formats the move: "turned by +0.310 ± 0.055 mrad and moved by 1.2 ± 0.9 mm (x +0.8, y -0.7, z +0.5)".
    fn in_words(&self, tell: &Tell<'_>) -> String {
        let (turned, moved) = (self.turned_rad(), self.moved_m());
        let [x, y, z] = [0, 1, 2].map(|axis| self.by[axis] * 1e3);
        format!(
            "turned by {} and moved by {:.1} ± {:.1} mm (x {x:+.1}, y {y:+.1}, z {z:+.1})",
            tell(
                &MessageAngle::signed(turned.value, AngleFormat::Milliradians, 3)
                    .sigma(turned.sigma)
            ),
            moved.value * 1e3,
            moved.sigma * 1e3,
        )
    }

    /// Returns the verdict on this station as a cause of the difference.
    pub fn verdict(&self) -> &'static str {
        match (self.rejects(), self.explains_all()) {
            (false, _) => "no evidence of movement",
            (true, true) => "explains it alone",
            (true, false) => "does not explain it alone",
        }
    }
}

/// "median inter-prism error 1.92 mm with the earlier calibration, 0.86 mm with the run's own: the difference is
/// significant".
impl fmt::Display for MetricThere {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let significance = if self.is_worse() { "significant" } else { "not significant" };
        write!(
            f,
            "median inter-prism error {:.2} mm with the earlier calibration, {:.2} mm with the run's own: the difference \
             is {significance}",
            self.earlier_mm.median, self.own_mm.median
        )
    }
}

/// Formats a p-value: "p = 0.310", "p = 3e-6", "p < 1e-9".
pub fn chance(p_value: f64) -> String {
    if p_value < SMALLEST_CHANCE {
        format!("p < {SMALLEST_CHANCE:.0e}")
    } else if p_value < 1e-3 {
        format!("p = {p_value:.0e}")
    } else {
        format!("p = {p_value:.3}")
    }
}
