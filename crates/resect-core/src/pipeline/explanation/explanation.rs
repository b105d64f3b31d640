//! Explanation of one reading: its step, rates, and interval.

use super::super::outlier_filter::rates;
use super::super::staged::used_readings;
use super::super::{
    FilteredTrack, Interval, OutlierReason, PipelineOutput, PipelineSettings, SampleFate,
};
use crate::deployment::{Deployment, Measurement};

/// All quantities that decided the fate of one raw reading. Times are in seconds of the stations' clock.
#[derive(Clone, Debug, PartialEq)]
pub struct Explanation {
    /// The station, 0 to 2.
    pub station: usize,
    /// Index of the reading in the station's raw track.
    pub index: usize,
    /// Raw reading of the instrument, without the prism constant.
    pub reading: Measurement,
    pub fate: SampleFate,
    /// Step that module 1 tests; `None` for the first reading of a station, which always passes.
    pub step: Option<Step>,
    /// Time since the station's previous raw reading, and until the next one (s).
    pub gap_before_s: Option<f64>,
    pub gap_after_s: Option<f64>,
    pub place: Place,
    /// Settings that produced the output.
    pub settings: PipelineSettings,
}

/// Step from the station's previous raw reading, kept or not, to this one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    pub elapsed_s: f64,
    /// Rates of range, azimuth and zenith angle, in this order.
    pub rates: [Rate; 3],
    /// True if module 1 rejected the previous reading; the return from a jump is a jump too.
    pub previous_rejected: bool,
}

/// A rate of change and its threshold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rate {
    pub of: OutlierReason,
    /// Signed rate.
    pub value: f64,
    /// Threshold τ_r, τ_a or τ_e in the same unit; `None` without module 1.
    pub threshold: Option<f64>,
    /// Unit of both rates: m/s for the range; for angles °/s, unless converted.
    pub unit: &'static str,
}

/// Position of a reading relative to the intervals.
#[derive(Clone, Debug, PartialEq)]
pub enum Place {
    /// Module 1 rejected the reading; intervals are built without it.
    Rejected,
    /// The reading is used for positions in this interval.
    In {
        interval: Interval,
        /// True if the reading lies just outside the interval, whose first or last position needs it.
        beside: bool,
        /// Index of the interval among those that module 3 kept; `None` if it was dropped.
        kept: Option<usize>,
    },
    /// The user excluded the reading, so it is in no interval.
    LeftOut,
    /// The reading is in no interval, because these stations were silent. Empty if all measured at this instant, but
    /// at no other around it.
    InNone(Vec<Silence>),
}

/// A gap longer than τ_s between accepted readings of one station, around the reading in question.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Silence {
    /// The station, 0 to 2.
    pub station: usize,
    /// Beginning of the gap (s); `None` before the first reading.
    pub from_s: Option<f64>,
    /// End of the gap (s); `None` after the last reading.
    pub to_s: Option<f64>,
    /// True for a single reading at the instant itself, with a gap before and after it.
    pub alone: bool,
    /// Number of raw readings in the gap that module 1 rejected.
    pub rejected: usize,
}

/// Explains one reading of a station (0 to 2). `settings` are those of the output. `None` without such a reading, or if the
/// output belongs to another deployment.
pub fn explain(
    deployment: &Deployment,
    output: &PipelineOutput,
    settings: &PipelineSettings,
    station: usize,
    index: usize,
) -> Option<Explanation> {
    let readings = &deployment.tracks.as_slice().get(station)?.measurements;
    let reading = *readings.get(index)?;
    let fate = *output.fates[station].each.get(index)?;
    let track = &deployment.tracks[station];
    // Readings that the user excluded do not count as the previous reading.
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
                (0..deployment.tracks.len())
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

/// Returns the interval that a raw reading is used for, its index in the list, and true if the reading lies outside it.
/// Intervals that contain the reading have priority over those that it brackets.
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

/// Returns the gap of a station around an instant, if there is one. A single reading between two gaps counts as silence
/// too, because it forms no interval.
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

    /// Converts angular rates to a unit, given its number per °/s; the rate of the range is unchanged.
    #[must_use]
    pub fn told_in(self, unit: &'static str, per_deg_per_s: f64) -> Self {
        if self.of == OutlierReason::Range {
            return self;
        }
        let threshold = self.threshold.map(|threshold| threshold * per_deg_per_s);
        Self { value: self.value * per_deg_per_s, threshold, unit, ..self }
    }

    /// Returns "range", "azimuth" or "zenith".
    pub fn name(&self) -> &'static str {
        match self.of {
            OutlierReason::Range => "range",
            OutlierReason::Azimuth => "azimuth",
            OutlierReason::Zenith => "zenith",
        }
    }

    /// Returns "τ_r", "τ_a" or "τ_e".
    pub fn threshold_name(&self) -> &'static str {
        match self.of {
            OutlierReason::Range => "τ_r",
            OutlierReason::Azimuth => "τ_a",
            OutlierReason::Zenith => "τ_e",
        }
    }
}

impl Silence {
    /// Returns the length of the gap (s); `None` without a beginning or an end.
    pub fn length_s(&self) -> Option<f64> {
        Some(self.to_s? - self.from_s?)
    }
}
