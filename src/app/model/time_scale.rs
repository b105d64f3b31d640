//! Display of times: since the first measurement, in hours, minutes and seconds or in seconds, or as the time of day.

use super::units::{TimeUnit, without_negative_zero};

/// Display of a deployment's times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeScale {
    unit: TimeUnit,
    /// Time of the first measurement (s, the stations' clock).
    start_s: f64,
}

const DAY_S: f64 = 86_400.0;
/// Stamps of the Unix epoch from 2001 to 2096; other stamps count from an unknown epoch.
const UNIX_S: std::ops::Range<f64> = 1e9..4e9;
/// Round steps of at least a second (s), each with its number of subdivisions.
const STEPS: [(f64, u32); 18] = [
    (1.0, 5),
    (2.0, 4),
    (5.0, 5),
    (10.0, 5),
    (15.0, 3),
    (30.0, 3),
    (60.0, 4),
    (120.0, 4),
    (300.0, 5),
    (600.0, 5),
    (900.0, 3),
    (1800.0, 3),
    (3600.0, 4),
    (7200.0, 4),
    (10_800.0, 3),
    (21_600.0, 3),
    (43_200.0, 4),
    (DAY_S, 4),
];

/// A round time on an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoundTime {
    /// Time since the first measurement (s).
    pub since_s: f64,
    /// Distance to the next mark of the same level (s).
    pub step_s: f64,
}

impl TimeScale {
    /// Creates a scale; times count from the first measurement if the stamps do not contain the time of day.
    pub fn new(unit: TimeUnit, start_s: f64) -> Self {
        let unit = if tells_time_of_day(start_s) || unit != TimeUnit::Utc {
            unit
        } else {
            TimeUnit::Elapsed
        };
        Self { unit, start_s }
    }

    /// Returns the title of an axis with its unit, and with the date for times of day.
    pub fn title(&self, short: bool) -> String {
        let what = if short { "time" } else { "time since the first measurement" };
        match self.unit {
            TimeUnit::Elapsed | TimeUnit::Seconds => format!("{what} ({})", self.unit.name()),
            TimeUnit::Utc => format!("time (UTC, {})", self.date()),
        }
    }

    /// Formats a time without its unit, for a mark on an axis.
    pub fn number(&self, since_s: f64, decimals: usize) -> String {
        match self.unit {
            TimeUnit::Seconds => without_negative_zero(since_s, decimals),
            TimeUnit::Elapsed => hours(since_s, decimals, 1),
            TimeUnit::Utc => hours((self.start_s + since_s).rem_euclid(DAY_S), decimals, 2),
        }
    }

    /// Formats a time for running text; only seconds need a unit, the other formats have colons.
    pub fn text(&self, since_s: f64, decimals: usize) -> String {
        let number = self.number(since_s, decimals);
        match self.unit {
            TimeUnit::Seconds => number + " s",
            TimeUnit::Elapsed => number,
            TimeUnit::Utc => number + " UTC",
        }
    }

    /// Formats a time for running text, followed by seconds as in findings and files.
    pub fn text_and_seconds(&self, since_s: f64, decimals: usize) -> String {
        match self.unit {
            TimeUnit::Seconds => self.text(since_s, decimals),
            _ => format!("{} ({since_s:.decimals$} s)", self.text(since_s, decimals)),
        }
    }

    /// Returns round times within bounds (s since the first measurement). Major marks are at least `least_s` apart, with
    /// minor marks between them.
    pub fn round_times(&self, [low_s, high_s]: [f64; 2], least_s: f64) -> Vec<RoundTime> {
        let (step_s, parts) = self.step(least_s);
        let fine_s = step_s / f64::from(parts);
        // Times of day are round in UTC.
        let from_s = if self.unit == TimeUnit::Utc { self.start_s.rem_euclid(DAY_S) } else { 0.0 };
        let index = |time_s: f64| (time_s + from_s) / fine_s;
        (index(low_s).ceil() as i64..=index(high_s).floor() as i64)
            .map(|index| {
                let strong = index.rem_euclid(i64::from(parts)) == 0;
                let since_s = index as f64 * fine_s - from_s;
                RoundTime { since_s, step_s: if strong { step_s } else { fine_s } }
            })
            .collect()
    }

    /// Returns the smallest round step that is not shorter, and its number of subdivisions.
    fn step(&self, least_s: f64) -> (f64, u32) {
        let sixties = self.unit != TimeUnit::Seconds && least_s > 0.5;
        let found = STEPS.into_iter().find(|(step_s, _)| *step_s >= least_s);
        if let Some(step) = found.filter(|_| sixties) {
            return step;
        }
        let decade = 10_f64.powf(least_s.max(1e-9).log10().floor());
        [(1.0, 5), (2.0, 4), (5.0, 5)]
            .into_iter()
            .map(|(times, parts)| (times * decade, parts))
            .find(|(step_s, _)| *step_s >= least_s)
            .unwrap_or((10.0 * decade, 5))
    }

    fn date(&self) -> String {
        let day = jiff::Timestamp::from_second(self.start_s as i64)
            .map(|stamp| jiff::tz::Offset::UTC.to_datetime(stamp).date());
        day.map_or_else(|_| "unknown day".to_owned(), |day| day.to_string())
    }
}

/// Returns true if stamps (s) count from 1970, and so contain the time of day.
pub fn tells_time_of_day(start_s: f64) -> bool {
    UNIX_S.contains(&start_s)
}

/// Returns the decimals of a second that resolve times at this distance.
pub fn decimals(step_s: f64) -> usize {
    (-step_s.max(1e-9).log10() - 1e-9).ceil().max(0.0) as usize
}

/// Formats a time as "1:02:03.4"; hours have at least this many digits.
fn hours(time_s: f64, decimals: usize, digits: usize) -> String {
    let parts = 10_i64.pow(decimals as u32);
    let ticks = (time_s.abs() * parts as f64).round() as i64;
    let (seconds, part) = (ticks / parts, ticks % parts);
    let sign = if time_s < 0.0 && ticks > 0 { "-" } else { "" };
    let [h, m, s] = [seconds / 3600, seconds / 60 % 60, seconds % 60];
    let part = if decimals > 0 { format!(".{part:0decimals$}") } else { String::new() };
    format!("{sign}{h:0digits$}:{m:02}:{s:02}{part}")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2022-05-03 14:30:07.5 UTC.
    const START_S: f64 = 1_651_588_207.5;

    #[test]
    fn one_moment_in_each_unit() {
        let text = |unit| TimeScale::new(unit, START_S).text(3725.26, 1);
        assert_eq!(TimeUnit::ALL.map(text), ["1:02:05.3", "3725.3 s", "15:32:12.8 UTC"]);
        let title = TimeScale::new(TimeUnit::Utc, START_S).title(true);
        assert_eq!(title, "time (UTC, 2022-05-03)");
        // A time that rounds up to a minute is shown as one.
        let elapsed = TimeScale::new(TimeUnit::Elapsed, START_S);
        assert_eq!(
            [59.97, -59.97, -0.01].map(|t| elapsed.number(t, 1)),
            ["0:01:00.0", "-0:01:00.0", "0:00:00.0"]
        );
    }

    #[test]
    fn stamps_that_do_not_tell_the_time_of_day_count_from_the_first_measurement() {
        let scale = TimeScale::new(TimeUnit::Utc, 12.0);
        assert_eq!(scale, TimeScale::new(TimeUnit::Elapsed, 12.0));
        assert_eq!(scale.text(61.0, 0), "0:01:01");
    }

    #[test]
    fn marks_are_round_in_their_unit_and_have_room() {
        for (unit, least_s, step_s, first) in [
            (TimeUnit::Elapsed, 40.0, 60.0, "0:00:00"),
            (TimeUnit::Seconds, 40.0, 50.0, "0"),
            (TimeUnit::Utc, 40.0, 60.0, "14:31:00"),
            (TimeUnit::Elapsed, 0.04, 0.05, "0:00:00.00"),
            (TimeUnit::Elapsed, 0.7, 1.0, "0:00:00"),
        ] {
            let scale = TimeScale::new(unit, START_S);
            let times = scale.round_times([0.0, 12.0 * least_s], least_s);
            let strong: Vec<f64> = (times.iter())
                .filter(|time| time.step_s == step_s)
                .map(|time| time.since_s)
                .collect();
            assert!(strong.len() >= 8 && times.len() > 2 * strong.len(), "{unit:?} {times:?}");
            assert!(strong.windows(2).all(|pair| (pair[1] - pair[0] - step_s).abs() < 1e-6));
            assert_eq!(scale.number(strong[0], decimals(step_s)), first);
        }
    }
}
