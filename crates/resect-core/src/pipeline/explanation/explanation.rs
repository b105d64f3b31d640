//! The explanation of one reading: its step, its rates, and its place among the intervals.

use super::super::outlier_filter::rates;
use super::super::staged::used_readings;
use super::super::{
    FilteredTrack, Interval, OutlierReason, PipelineOutput, PipelineSettings, SampleFate,
};
use crate::deployment::{Deployment, Measurement};

/// Everything that decided the fate of one raw reading. Times are in s of the stations' clock.
#[derive(Clone, Debug, PartialEq)]
pub struct Explanation {
    /// The station, 0 to 2.
    pub station: usize,
    /// Index of the reading in the station's raw track.
    pub index: usize,
    /// The reading as the instrument gave it, without the prism constant.
    pub reading: Measurement,
    pub fate: SampleFate,
    /// What module 1 looks at; `None` for the first reading of a station, which it always lets pass.
    pub step: Option<Step>,
    /// Time since the station's raw reading before, and until the next (s).
    pub gap_before_s: Option<f64>,
    pub gap_after_s: Option<f64>,
    pub place: Place,
    /// The settings that made it so.
    pub settings: PipelineSettings,
}

/// The way from the station's previous raw reading, kept or not, to this one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    pub elapsed_s: f64,
    /// Rates of range, azimuth and zenith angle, in this order.
    pub rates: [Rate; 3],
    /// What module 1 did to the previous reading: after a jump, the way back is a jump too.
    pub previous_rejected: bool,
}

/// A rate of change against its threshold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rate {
    pub of: OutlierReason,
    /// The rate with its sign.
    pub value: f64,
    /// τ_r, τ_a or τ_e, in the same unit; `None` while module 1 is off.
    pub threshold: Option<f64>,
    /// The unit of both rates: m/s for the range, °/s for the angles unless it is told in another.
    pub unit: &'static str,
}

/// Where a reading stands among the intervals.
#[derive(Clone, Debug, PartialEq)]
pub enum Place {
    /// Module 1 rejected it, so the intervals are made without it.
    Rejected,
    /// Positions in this interval are interpolated from it.
    In {
        interval: Interval,
        /// The reading itself stands just outside, and the interval's first or last position needs it.
        beside: bool,
        /// Number of the interval among those that module 3 kept, from 0; `None` for one that it dropped.
        kept: Option<usize>,
    },
    /// The reading is in no interval: the user left it out.
    LeftOut,
    /// The reading is in no interval, because these stations were silent; empty where all three measured at this
    /// instant, and at no other around it.
    InNone(Vec<Silence>),
}

/// A gap longer than τ_s between readings of one station that module 1 let pass, around the reading in question.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Silence {
    /// The station, 0 to 2.
    pub station: usize,
    /// `None`: from the beginning.
    pub from_s: Option<f64>,
    /// `None`: to the end.
    pub to_s: Option<f64>,
    /// Whether it has one reading in between, at the instant itself, with a gap before and a gap after it.
    pub alone: bool,
    /// How many of its raw readings in this time module 1 rejected.
    pub rejected: usize,
}

/// Explains one reading of a station (0 to 2); `None` where there is no such reading, or where the output is of
/// another deployment. `settings` are those that made the output.
pub fn explain(
    deployment: &Deployment,
    output: &PipelineOutput,
    settings: &PipelineSettings,
    station: usize,
    index: usize,
) -> Option<Explanation> {
    let readings = &deployment.tracks.get(station)?.measurements;
    let reading = *readings.get(index)?;
    let fate = *output.fates[station].each.get(index)?;
    let track = &deployment.tracks[station];
    // What the user left out does not count as the reading before.
    let before_index = (0..index).rev().find(|before| !track.is_left_out(*before));
    let before = before_index.map(|before| readings[before]);
    Some(Explanation {
        station,
        index,
        reading,
        fate,
        step: before.map(|before| Step {
            elapsed_s: reading.time_s - before.time_s,
            rates: checked_rates(&before, &reading, settings),
            previous_rejected: before_index
                .is_some_and(|before| output.filtered[station].rejected[before].is_some()),
        }),
        gap_before_s: before.map(|before| reading.time_s - before.time_s),
        gap_after_s: readings.get(index + 1).map(|after| after.time_s - reading.time_s),
        place: match fate {
            SampleFate::Rejected(_) => Place::Rejected,
            SampleFate::LeftOut => Place::LeftOut,
            SampleFate::Kept => {
                place_in(&output.filtered[station], &output.kept_intervals, index).map(
                    |(number, interval, beside)| Place::In { interval, beside, kept: Some(number) },
                )?
            }
            SampleFate::IntervalTooShort => {
                place_in(&output.filtered[station], &output.intervals, index)
                    .map(|(_, interval, beside)| Place::In { interval, beside, kept: None })?
            }
            SampleFate::InNoInterval => Place::InNone(
                (0..3)
                    .filter_map(|other| {
                        let tau_s = settings.thresholds.tau_s_seconds;
                        silence(deployment, output, other, reading.time_s, tau_s)
                    })
                    .collect(),
            ),
        },
        settings: *settings,
    })
}

fn checked_rates(
    before: &Measurement,
    reading: &Measurement,
    settings: &PipelineSettings,
) -> [Rate; 3] {
    let rates = rates(before, reading);
    let thresholds = &settings.thresholds;
    let rate = |of, value, threshold| Rate {
        of,
        value,
        threshold: settings.outlier_filter.then_some(threshold),
        unit: match of {
            OutlierReason::Range => "m/s",
            OutlierReason::Azimuth | OutlierReason::Zenith => "°/s",
        },
    };
    [
        rate(OutlierReason::Range, rates.range_m_per_s, thresholds.tau_r_m_per_s),
        rate(OutlierReason::Azimuth, rates.azimuth_deg_per_s, thresholds.tau_a_deg_per_s),
        rate(OutlierReason::Zenith, rates.zenith_deg_per_s, thresholds.tau_e_deg_per_s),
    ]
}

/// The interval that a raw reading is used for, its number in the list, and whether the reading is outside of it. One
/// that it lies in goes before one that it brackets.
fn place_in(
    track: &FilteredTrack,
    intervals: &[Interval],
    index: usize,
) -> Option<(usize, Interval, bool)> {
    let at = track.source.binary_search(&u32::try_from(index).ok()?).ok()?;
    let time_s = track.time_s[at];
    let outside = |interval: &Interval| !(interval.start_s..=interval.end_s).contains(&time_s);
    intervals
        .iter()
        .enumerate()
        .filter(|(_, interval)| used_readings(track, interval).contains(&at))
        .map(|(number, interval)| (number, *interval, outside(interval)))
        .min_by_key(|(_, _, outside)| *outside)
}

/// The silence of a station around an instant, if there is one. One reading alone between two gaps is silence too: it
/// makes no interval.
fn silence(
    deployment: &Deployment,
    output: &PipelineOutput,
    station: usize,
    time_s: f64,
    tau_s_seconds: f64,
) -> Option<Silence> {
    let times_s = &output.filtered[station].time_s;
    let before = times_s.partition_point(|t| *t < time_s);
    let after = times_s.partition_point(|t| *t <= time_s);
    let from_s = before.checked_sub(1).map(|last| times_s[last]);
    let to_s = times_s.get(after).copied();
    let is_gap = |from_s: Option<f64>, to_s: Option<f64>| {
        from_s.zip(to_s).is_none_or(|(from_s, to_s)| to_s - from_s > tau_s_seconds)
    };
    let measured = before < after;
    let silent = if measured {
        is_gap(from_s, Some(time_s)) && is_gap(Some(time_s), to_s)
    } else {
        is_gap(from_s, to_s)
    };
    silent.then(|| {
        let readings = &deployment.tracks[station].measurements;
        let from = from_s.map_or(0, |t| readings.partition_point(|m| m.time_s <= t));
        let to = to_s.map_or(readings.len(), |t| readings.partition_point(|m| m.time_s < t));
        let rejected = &output.filtered[station].rejected[from..to];
        let rejected = rejected.iter().filter(|reason| reason.is_some()).count();
        Silence { station, from_s, to_s, alone: measured, rejected }
    })
}

impl Rate {
    pub fn exceeds(&self) -> bool {
        self.threshold.is_some_and(|threshold| self.value.abs() > threshold)
    }

    /// Gives the rates in a unit of which °/s has so many; the range's rate stays as it is.
    #[must_use]
    pub fn told_in(self, unit: &'static str, per_deg_per_s: f64) -> Self {
        if self.of == OutlierReason::Range {
            return self;
        }
        let threshold = self.threshold.map(|threshold| threshold * per_deg_per_s);
        Self { value: self.value * per_deg_per_s, threshold, unit, ..self }
    }

    /// "range", "azimuth" or "zenith".
    pub fn name(&self) -> &'static str {
        match self.of {
            OutlierReason::Range => "range",
            OutlierReason::Azimuth => "azimuth",
            OutlierReason::Zenith => "zenith",
        }
    }

    /// "τ_r", "τ_a" or "τ_e".
    pub fn threshold_name(&self) -> &'static str {
        match self.of {
            OutlierReason::Range => "τ_r",
            OutlierReason::Azimuth => "τ_a",
            OutlierReason::Zenith => "τ_e",
        }
    }
}

impl Silence {
    /// `None` where it has no beginning or no end.
    pub fn length_s(&self) -> Option<f64> {
        Some(self.to_s? - self.from_s?)
    }
}
