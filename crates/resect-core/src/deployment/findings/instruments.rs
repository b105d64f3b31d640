//! Findings of the joint estimate: noise, errors of instruments, distances, steps.

use crate::deployment::kinds;
use crate::deployment::{
    AngleFormat, Finding, FindingKind, Message, MessageAngle, Remedy, Severity, Subject, Unit,
};
use crate::network::{Number, Pair};
use crate::statistics::estimate::{
    Estimate, Quantity, SUPPORTED_SIGMAS, decimals_of, sigmas_in_words,
};

/// Noise of the readings about the motion, one standard deviation each.
#[derive(Clone, Copy)]
pub struct ReadingNoise {
    pub range_m: f64,
    pub horizontal_rad: f64,
    pub vertical_rad: f64,
    pub stamp_s: f64,
    /// Slow errors of the ranges, across the sights and upward.
    pub slow_range_m: f64,
    pub slow_across_m: f64,
    pub slow_upward_m: f64,
}

pub fn noise_levels(noise: ReadingNoise) -> Finding {
    let ReadingNoise { range_m, horizontal_rad, vertical_rad, stamp_s, .. } = noise;
    let ReadingNoise { slow_range_m, slow_across_m, slow_upward_m, .. } = noise;
    let angle = |angle_rad: f64| MessageAngle::size(angle_rad, AngleFormat::Arcseconds, 1);
    let message =
        Message::from(format!("noise of the readings (1 σ): {:.1} mm in range, ", range_m * 1e3))
            .angle(angle(horizontal_rad))
            .text(" in horizontal and ")
            .angle(angle(vertical_rad))
            .text(format!(
                " in vertical angles, {:.1} ms in time; slow errors (1 σ): {:.1} mm in range, {:.1} mm across the sights, {:.1} mm upward",
                stamp_s * 1e3,
                slow_range_m * 1e3,
                slow_across_m * 1e3,
                slow_upward_m * 1e3
            ));
    Finding::new(kinds::NOISE_LEVELS, message)
        .quantity("range", range_m, Unit::Metre)
        .quantity("horizontal_angle", horizontal_rad, Unit::Radian)
        .quantity("vertical_angle", vertical_rad, Unit::Radian)
        .quantity("stamp", stamp_s, Unit::Second)
        .quantity("range_wander", slow_range_m, Unit::Metre)
        .quantity("slow_across", slow_across_m, Unit::Metre)
        .quantity("slow_upward", slow_upward_m, Unit::Metre)
}

/// Share of information by the readings below which a value without the prior would be arbitrary.
const LEAST_SHARE_OF_READINGS: f64 = 1e-3;

/// An estimated error with its description: "station 2's ranges are off by".
#[derive(Clone, Copy)]
pub struct NamedError<'a> {
    pub sentence: &'a str,
    /// The station (0 to 2) of an instrument error; `None` for other errors.
    pub station: Option<usize>,
    pub quantity: Quantity,
    pub estimate: Estimate,
    /// The prior standard deviation.
    pub prior_sigma: f64,
}

impl NamedError<'_> {
    fn finding(&self, kind: FindingKind, message: Message) -> Finding {
        let part = self.sentence.to_owned();
        let subject = match self.station {
            Some(station) => Subject::OfStation { station, part },
            None => Subject::Named(part),
        };
        let unit = match self.quantity {
            Quantity::Length => Unit::Metre,
            Quantity::Angle => Unit::Radian,
            Quantity::Time => Unit::Second,
            Quantity::Drift | Quantity::Share | Quantity::Coefficient => Unit::Ratio,
        };
        Finding::new(kind, message).about(subject).estimate("error", &self.estimate, unit).quantity(
            "prior_sigma",
            self.prior_sigma,
            unit,
        )
    }

    /// Sentence with value and σ: "station 2's ranges are off by +1.2 ± 0.3 mm".
    fn in_words(&self, decimals: usize) -> Message {
        let Estimate { value, sigma } = self.estimate;
        let sentence = Message::from(format!("{} ", self.sentence));
        if self.quantity == Quantity::Angle {
            let angle = MessageAngle::signed(value, AngleFormat::Arcseconds, 1).sigma(sigma);
            return sentence.angle(angle);
        }
        let (scale, unit) = self.quantity.told();
        sentence.text(format!(
            "{:+.decimals$} ± {:.decimals$} {unit}",
            value * scale,
            sigma * scale
        ))
    }

    /// Estimate without the prior: information is additive. Returns `None` if the readings have hardly any.
    fn without_prior(&self, prior_mean: f64) -> Option<Self> {
        let Estimate { value, sigma } = self.estimate;
        let share = 1.0 - (sigma / self.prior_sigma).powi(2);
        let estimate = Estimate {
            value: prior_mean + (value - prior_mean) / share,
            sigma: sigma / share.sqrt(),
        };
        (share > LEAST_SHARE_OF_READINGS).then_some(Self { estimate, ..*self })
    }

    /// Prior σ with its unit: "0.3 mm".
    fn prior_in_words(&self, decimals: usize) -> Message {
        if self.quantity == Quantity::Angle {
            return MessageAngle::size(self.prior_sigma, AngleFormat::Arcseconds, 1).into();
        }
        let (scale, unit) = self.quantity.told();
        format!("{:.decimals$} {unit}", self.prior_sigma * scale).into()
    }
}

pub fn instrument_error(error: &NamedError<'_>) -> Finding {
    error.finding(kinds::INSTRUMENT_ERROR, error.in_words(1))
}

/// `sigmas` is the distance from the prior in standard deviations. The message states the value without the prior, because the
/// estimate lies between the two and may look insignificant.
pub fn instrument_error_implausible(
    error: &NamedError<'_>,
    prior_mean: f64,
    sigmas: f64,
) -> Finding {
    let (stated, source) = match error.without_prior(prior_mean) {
        Some(without_prior) => (without_prior, " without its prior"),
        None => (*error, ""),
    };
    let message = stated
        .in_words(1)
        .text(format!("{source}: implausible at {sigmas:.1} σ, sound instruments have "))
        .message(error.prior_in_words(1))
        .text(" (1 σ); probably another error, which this estimate does not model, is the cause");
    error.finding(kinds::INSTRUMENT_ERROR_IMPLAUSIBLE, message).quantity(
        "sigmas",
        sigmas,
        Unit::Ratio,
    )
}

/// The data contradicts the stated size of an error; `sigmas` is its distance from zero, in σ of data and stated size.
pub fn stated_error_contradicted(error: &NamedError<'_>, sigmas: f64) -> Finding {
    let decimals = if error.station.is_some() { 1 } else { 2 };
    let message = error
        .in_words(decimals)
        .text(format!(" by the data: {:.1} σ beyond the stated ", sigmas.abs()))
        .message(error.prior_in_words(decimals))
        .text(" (1 σ), so this answer is biased; restore the usual size of this error");
    error.finding(kinds::STATED_ERROR_CONTRADICTED, message).quantity("sigmas", sigmas, Unit::Ratio)
}

/// An estimated distance.
pub fn distance_estimated(pair: usize, measured_m: f64, distance_m: &Estimate) -> Finding {
    let off_m = Estimate { value: distance_m.value - measured_m, ..*distance_m };
    let line = format!(
        "prisms {}: {:+.1} ± {:.1} mm against the measured distance{}",
        Pair::at(pair),
        off_m.value * 1e3,
        off_m.sigma * 1e3,
        sigmas_in_words(off_m.sigmas_from(0.0)),
    );
    Finding::new(kinds::DISTANCE_ESTIMATED, line).about(Subject::Pair(pair)).estimate(
        "error",
        &off_m,
        Unit::Metre,
    )
}

/// A distance that differs by `off_m` from its measurement, whose prior standard deviation is `prior_sigma_m`.
pub fn distance_implausible(pair: usize, off_m: f64, prior_sigma_m: f64, sigmas: f64) -> Finding {
    Finding::new(
        kinds::DISTANCE_IMPLAUSIBLE,
        format!(
            "prisms {} would be {:+.1} mm from their measured distance (σ {:.1} mm), implausible at {sigmas:.1} σ: the rig, its \
             units or the station numbers are wrong",
            Pair::at(pair),
            off_m * 1e3,
            prior_sigma_m * 1e3
        ),
    )
    .about(Subject::Pair(pair))
    .quantity("error", off_m, Unit::Metre)
    .quantity("sigmas", sigmas, Unit::Ratio)
    .with(Remedy::Corrections)
}

pub fn distances_implausible(off_m: &[(Pair, f64)], sigmas: f64) -> Finding {
    let pairs: Vec<String> = off_m.iter().map(|(pair, _)| pair.to_string()).collect();
    let off_mm: Vec<String> = off_m.iter().map(|(_, m)| format!("{:+.1}", m * 1e3)).collect();
    let mut finding = Finding::new(
        kinds::DISTANCES_IMPLAUSIBLE,
        format!(
            "prisms {} would be {} mm from their measured distances, together implausible at {sigmas:.1} σ: a station \
             followed another prism for a while, or the rig has changed since it was measured",
            pairs.join(", "),
            off_mm.join(", ")
        ),
    );
    for (Pair { first, second }, off_m) in off_m {
        let name = format!("error_{first}{second}");
        finding = finding.quantity(name, *off_m, Unit::Metre);
    }
    finding.quantity("sigmas", sigmas, Unit::Ratio).with(Remedy::Corrections)
}

pub fn station_errors_implausible(station: usize, sigmas: f64) -> Finding {
    Finding::new(
        kinds::STATION_ERRORS_IMPLAUSIBLE,
        format!(
            "station {}'s errors of ranges, angles and tilt are together implausible at {sigmas:.1} σ: it was knocked, or \
             another error biases the answer",
            station + 1
        ),
    )
    .about(Subject::Station(station))
    .quantity("sigmas", sigmas, Unit::Ratio)
}

pub fn errors_implausible(sigmas: f64) -> Finding {
    Finding::new(
        kinds::ERRORS_IMPLAUSIBLE,
        format!(
            "the errors of all stations and distances are together implausible at {sigmas:.1} σ: an error that this estimate \
             does not model biases the answer"
        ),
    )
    .quantity("sigmas", sigmas, Unit::Ratio)
}

pub fn range_wander_implausible(sigma_m: f64) -> Finding {
    Finding::new(
        kinds::RANGE_WANDER_IMPLAUSIBLE,
        format!(
            "slow range errors of {:.0} mm are larger than any prism causes: find the cause",
            sigma_m * 1e3
        ),
    )
    .quantity("range_wander", sigma_m, Unit::Metre)
}

/// The time of a step, and its consequence.
#[derive(Clone, Copy)]
pub struct StepContext<'a> {
    /// The station, from 0.
    pub station: usize,
    /// The other station, if there are two: they show their difference alone.
    pub other: Option<usize>,
    /// The time in words: "about 200 s into the drive".
    pub when: &'a str,
    /// True if the standard deviations include the step; the finding is a note then.
    pub is_usual: bool,
    /// Span around a sudden step (s, in the stations' clock); `None` for a slow change.
    pub span_s: Option<[f64; 2]>,
}

impl StepContext<'_> {
    /// Returns " (or station 2 the other way: two stations do not show which)"; nothing for further stations.
    fn or_other(&self) -> String {
        let in_words = |other: usize| {
            format!(" (or station {} the other way: two stations do not show which)", other + 1)
        };
        self.other.map_or_else(String::new, in_words)
    }

    fn finding(self, kind: FindingKind, event: impl Into<Message>) -> Finding {
        let Self { station, is_usual, span_s, .. } = self;
        let consequence = match (is_usual, span_s) {
            (true, _) => "σ includes it",
            (false, None) => {
                "the estimate models it, but no single answer fits the whole drive: find the cause"
            }
            (false, Some(_)) => {
                "the estimate models it, but no single answer fits the whole drive: cut the recording there"
            }
        };
        let message = event.into().text(format!("; {consequence}"));
        let finding = Finding::new(kind, message).about(Subject::Station(station));
        match (is_usual, span_s) {
            (true, _) => finding.with_severity(Severity::Note),
            (false, Some(span_s)) => finding.with(Remedy::ShowTimes(span_s)),
            (false, None) => finding,
        }
    }
}

pub fn clock_stepped(context: StepContext<'_>, by_s: &Estimate) -> Finding {
    let event = format!(
        "station {}'s stamps jump by {:+.1} ± {:.1} ms {}{}, which no constant offset corrects",
        context.station + 1,
        by_s.value * 1e3,
        by_s.sigma * 1e3,
        context.when,
        context.or_other()
    );
    context.finding(kinds::CLOCK_STEPPED, event).estimate("jump", by_s, Unit::Second)
}

pub fn station_moved(
    context: StepContext<'_>,
    turned_rad: &Estimate,
    moved_m: &Estimate,
) -> Finding {
    let turned = MessageAngle::signed(turned_rad.value, AngleFormat::Milliradians, 3)
        .sigma(turned_rad.sigma);
    let event = Message::from(format!("station {} turned by ", context.station + 1))
        .angle(turned)
        .text(format!(
            " and moved by {:.1} ± {:.1} mm {}{}",
            moved_m.value * 1e3,
            moved_m.sigma * 1e3,
            context.when,
            context.or_other()
        ));
    context
        .finding(kinds::STATION_MOVED, event)
        .estimate("turned", turned_rad, Unit::Radian)
        .estimate("moved", moved_m, Unit::Metre)
}

/// A change of a station's set-up (0 to 2) between the survey and the drive: rotation about z, and length of the displacement.
///
/// States the significant ones; both if only the change as a whole is significant.
pub fn set_up_changed(station: usize, turned_rad: &Estimate, moved_m: &Estimate) -> Finding {
    let is_significant = |change: &Estimate| change.sigmas_from(0.0).abs() >= SUPPORTED_SIGMAS;
    let (has_turned, has_moved) = (is_significant(turned_rad), is_significant(moved_m));
    let is_neither = !has_turned && !has_moved;
    let mut event = Message::from(format!("Station {}", station + 1));
    if has_turned || is_neither {
        let decimals = decimals_of(turned_rad.sigma * 1e3).unwrap_or(3);
        let turned = MessageAngle::signed(turned_rad.value, AngleFormat::Milliradians, decimals)
            .sigma(turned_rad.sigma);
        event = event.text(" turned by ").angle(turned);
    }
    if is_neither || (has_turned && has_moved) {
        event = event.text(" and");
    }
    if has_moved || is_neither {
        let decimals = decimals_of(moved_m.sigma * 1e3).unwrap_or(1);
        let (value_mm, sigma_mm) = (moved_m.value * 1e3, moved_m.sigma * 1e3);
        event = event.text(format!(" moved by {value_mm:.decimals$} ± {sigma_mm:.decimals$} mm"));
    }
    let message =
        event.text(" between the survey and the drive. Use the joint estimate for this drive.");
    Finding::new(kinds::SET_UP_CHANGED, message)
        .about(Subject::Station(station))
        .estimate("turned", turned_rad, Unit::Radian)
        .estimate("moved", moved_m, Unit::Metre)
}

/// A question about a change between the survey and the drive that the data leaves open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UndecidedChange {
    /// If a station moved.
    Whether,
    WhichStation,
    /// If a station moved or the distances of the rig are wrong.
    StationOrRig,
}

pub fn set_up_change_undecided(undecided: UndecidedChange) -> Finding {
    let message = match undecided {
        UndecidedChange::Whether => {
            "A station may have moved between the survey and the drive. The difference is nearly significant. Measure the control \
             points again from every station."
        }
        UndecidedChange::WhichStation => {
            "A station moved between the survey and the drive. The data does not decide which one. Measure the control points \
             again from every station."
        }
        UndecidedChange::StationOrRig => {
            "A station moved between the survey and the drive, or the distances of the rig are wrong. The data does not decide. \
             Measure the rig again."
        }
    };
    Finding::new(kinds::SET_UP_CHANGE_UNDECIDED, message)
}

/// The largest source of a standard deviation.
#[derive(Clone, Copy)]
pub struct UncertaintySource<'a> {
    pub source: &'a str,
    /// Standard deviation by this source alone, and by all sources (m or rad).
    pub part: f64,
    pub whole: f64,
}

/// Largest sources of the standard deviations of x, y, z (m) and yaw (rad) of a station.
pub fn uncertainty_sources(station: usize, sources: [UncertaintySource<'_>; 4]) -> Finding {
    let [x, y, z, yaw] = sources;
    let mut message = Message::from(format!("largest part of σ of station {}: ", station + 1));
    for (axis, UncertaintySource { source, part, whole }) in [("x", x), ("y", y), ("z", z)] {
        message =
            message.text(format!("{axis} {source} ({:.1} of {:.1} mm), ", part * 1e3, whole * 1e3));
    }
    let [part, whole] =
        [yaw.part, yaw.whole].map(|rad| MessageAngle::size(rad, AngleFormat::Milliradians, 3));
    let message = message
        .text(format!("yaw {} (", yaw.source))
        .angle(part)
        .text(" of ")
        .angle(whole)
        .text(")");
    Finding::new(kinds::UNCERTAINTY_SOURCES, message)
        .about(Subject::Station(station))
        .quantity("x", x.part, Unit::Metre)
        .quantity("y", y.part, Unit::Metre)
        .quantity("z", z.part, Unit::Metre)
        .quantity("yaw", yaw.part, Unit::Radian)
}

pub(super) fn examples() -> Vec<Finding> {
    let estimate = |value, sigma| Estimate { value, sigma };
    let error = NamedError {
        sentence: "station 2's ranges are off by",
        station: Some(1),
        quantity: Quantity::Length,
        estimate: estimate(0.0012, 0.0003),
        prior_sigma: 0.001,
    };
    let clock = NamedError {
        sentence: "station 2's stamps are late by",
        station: None,
        quantity: Quantity::Time,
        ..error
    };
    let angle = NamedError {
        sentence: "station 2's zenith angles are off by",
        quantity: Quantity::Angle,
        estimate: estimate(1e-4, 1e-5),
        ..error
    };
    let step = StepContext {
        other: None,
        station: 1,
        when: "about 200 s into the drive",
        is_usual: false,
        span_s: None,
    };
    let source = UncertaintySource { source: "settling", part: 0.0006, whole: 0.0009 };
    vec![
        noise_levels(ReadingNoise {
            range_m: 0.001,
            horizontal_rad: 1.5e-5,
            vertical_rad: 1e-5,
            stamp_s: 0.001,
            slow_range_m: 0.001,
            slow_across_m: 0.001,
            slow_upward_m: 0.002,
        }),
        instrument_error(&error),
        instrument_error_implausible(&angle, 0.0, 6.0),
        stated_error_contradicted(&clock, 7.0),
        distance_estimated(0, 0.9, &estimate(0.9005, 0.0003)),
        distance_implausible(0, 0.02, 0.001, 6.0),
        distances_implausible(
            &Pair::among(3).zip([0.01, 0.01, -0.01]).collect::<Vec<(Pair, f64)>>(),
            4.0,
        ),
        station_errors_implausible(1, 4.0),
        errors_implausible(4.0),
        range_wander_implausible(0.007),
        clock_stepped(StepContext { span_s: Some([180.0, 220.0]), ..step }, &estimate(0.1, 0.001)),
        station_moved(step, &estimate(8.5e-4, 4e-5), &estimate(0.004, 0.001)),
        set_up_changed(1, &estimate(8.5e-4, 5e-5), &estimate(0.004, 0.001)),
        set_up_change_undecided(UndecidedChange::Whether),
        set_up_change_undecided(UndecidedChange::WhichStation),
        set_up_change_undecided(UndecidedChange::StationOrRig),
        uncertainty_sources(1, [source; 4]),
    ]
}

#[cfg(test)]
mod tests;
