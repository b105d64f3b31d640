//! Incremental pipeline: a change of a setting re-runs its stage and those after it.

use std::ops::RangeInclusive;
use std::sync::Arc;

use nalgebra::Vector3;

use super::all_readings::triplets_of_all_readings;
use super::interval_split::Interval;
use super::outlier_filter::{FilteredTrack, OutlierReason};
use super::settings::{Interpolation, PipelineSettings, Thresholds};
use super::triplets::Triplets;
use super::{interpolation, interval_filter, interval_split, outlier_filter};
use crate::deployment::Deployment;
use crate::network::{Number, PerStation};
use crate::progress::{Cancelled, Progress};

/// Fate of a raw reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SampleFate {
    /// The reading is used for interpolation.
    Kept,
    Rejected(OutlierReason),
    /// Another station, or this one, was silent for longer than τ_s.
    InNoInterval,
    /// The reading's interval is not longer than τ_l.
    IntervalTooShort,
    /// The user excluded it.
    LeftOut,
}

impl SampleFate {
    pub const ALL: [Self; 7] = [
        Self::Kept,
        Self::Rejected(OutlierReason::Range),
        Self::Rejected(OutlierReason::Azimuth),
        Self::Rejected(OutlierReason::Zenith),
        Self::InNoInterval,
        Self::IntervalTooShort,
        Self::LeftOut,
    ];

    /// Returns the fate in words, for legends and exports.
    pub fn label(self) -> &'static str {
        match self {
            Self::Kept => "kept",
            Self::Rejected(OutlierReason::Range) => "rejected: range rate",
            Self::Rejected(OutlierReason::Azimuth) => "rejected: azimuth rate",
            Self::Rejected(OutlierReason::Zenith) => "rejected: zenith rate",
            Self::LeftOut => "left out by hand",
            Self::InNoInterval => "in no interval",
            Self::IntervalTooShort => "interval too short",
        }
    }
}

/// Output of all stages; cheap to clone.
#[derive(Clone, Debug)]
pub struct PipelineOutput {
    pub filtered: Arc<PerStation<FilteredTrack>>,
    /// The intervals after the split.
    pub intervals: Arc<Vec<Interval>>,
    /// The intervals after the interval filter; [`Triplets::interval`] counts these.
    pub kept_intervals: Arc<Vec<Interval>>,
    pub triplets: Arc<Triplets>,
    pub fates: Arc<PerStation<Fates>>,
}

/// Fates of the readings of one station.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Fates {
    /// Fate of each raw reading.
    pub each: Vec<SampleFate>,
    /// Number of readings of each fate, in the order of [`SampleFate::ALL`]; stored because the window reads it in every
    /// frame.
    counts: [usize; 7],
}

impl PipelineOutput {
    /// Returns the number of a station's readings with this fate.
    pub fn count(&self, station: usize, fate: SampleFate) -> usize {
        let place = SampleFate::ALL.iter().position(|f| *f == fate);
        place.map_or(0, |place| self.fates[station].counts[place])
    }

    /// Returns the number of readings of each station with this fate.
    pub fn counts(&self, fate: SampleFate) -> PerStation<usize> {
        self.fates.map_each(|station, _| self.count(station.index(), fate))
    }
}

type Memory<Key, Output> = Option<(Key, Arc<Output>)>;

/// Stores the last output of each stage with the settings that it depends on. Use one for each deployment: it does not
/// check that the deployment is the same. [`crate::analysis::Analyst`] keeps the two together.
#[derive(Default)]
pub struct StagedPipeline {
    positions_m: Memory<(), PerStation<Vec<Vector3<f64>>>>,
    filtered: Memory<Option<RateThresholds>, PerStation<FilteredTrack>>,
    intervals: Memory<f64, Vec<Interval>>,
    kept: Memory<Option<f64>, Vec<Interval>>,
    triplets: Memory<(Interpolation, f64, bool), Triplets>,
    fates: Memory<(), PerStation<Fates>>,
    of_all_readings: Memory<(), Triplets>,
}

/// Settings of module 1.
#[derive(Clone, Copy, PartialEq)]
struct RateThresholds(f64, f64, f64);

impl StagedPipeline {
    /// Runs the stages whose settings, or whose input, changed since the last call.
    pub fn run(&mut self, deployment: &Deployment, settings: &PipelineSettings) -> PipelineOutput {
        self.run_while(deployment, settings, &Progress::default())
            .expect("nobody else can cancel it")
    }

    /// Runs like [`Self::run`] until `progress` is cancelled; completed stages are stored.
    pub fn run_while(
        &mut self,
        deployment: &Deployment,
        settings: &PipelineSettings,
        progress: &Progress,
    ) -> Result<PipelineOutput, Cancelled> {
        let thresholds = &settings.thresholds;
        let outliers = settings.outlier_filter.then_some(thresholds);
        let key = outliers.map(
            |Thresholds { tau_r_m_per_s, tau_a_deg_per_s, tau_e_deg_per_s, .. }| {
                RateThresholds(*tau_r_m_per_s, *tau_a_deg_per_s, *tau_e_deg_per_s)
            },
        );
        let mut stale = false;
        let positions_m = remember(&mut self.positions_m, (), &mut false, || {
            outlier_filter::positions_m(deployment)
        });
        let filtered = remember(&mut self.filtered, key, &mut stale, || {
            outlier_filter::filter(deployment, &positions_m, outliers)
        });
        let intervals = remember(&mut self.intervals, thresholds.tau_s_seconds, &mut stale, || {
            interval_split::split(&filtered, thresholds.tau_s_seconds)
        });
        let tau_l = settings.interval_filter.then_some(thresholds.tau_l_seconds);
        let kept_intervals = remember(&mut self.kept, tau_l, &mut stale, || {
            interval_filter::filter(&intervals, tau_l)
        });
        // Fates depend on the intervals alone, not on the interpolation.
        let mut fates_stale = stale;
        let fates = remember(&mut self.fates, (), &mut fates_stale, || {
            filtered.map(|track| fates(track, &intervals, &kept_intervals))
        });
        let of_all_readings = settings.all_readings.then(|| {
            remember(&mut self.of_all_readings, (), &mut false, || {
                triplets_of_all_readings(deployment, &positions_m)
            })
        });
        // Stations that read more rarely than its limits allow have their triplets by the settings alone.
        let of_all_readings = of_all_readings.filter(|all| !all.is_empty());
        let key = (settings.interpolation, settings.rate_hz, settings.all_readings);
        // Removed before the computation, so that cancelled triplets are not replaced by those of other readings.
        let known = self.triplets.take_if(|(known, _)| *known == key && !stale);
        let triplets = match known {
            Some((_, triplets)) => triplets,
            None => {
                self.triplets = None;
                let triplets = interpolation::interpolate(
                    &filtered,
                    &kept_intervals,
                    settings.interpolation,
                    settings.rate_hz,
                    progress,
                )?;
                let all = Triplets {
                    readings: Arc::clone(&filtered),
                    restarts_s: deployment.restarts_s.clone(),
                    of_all_readings,
                    ..triplets
                };
                Arc::new(match deployment.prism_schedule() {
                    schedule if schedule.is_constant() => all,
                    schedule => all.of_most_followed(&schedule),
                })
            }
        };
        self.triplets = Some((key, Arc::clone(&triplets)));
        Ok(PipelineOutput { filtered, intervals, kept_intervals, triplets, fates })
    }
}

fn remember<Key: PartialEq, Output>(
    memory: &mut Memory<Key, Output>,
    key: Key,
    stale: &mut bool,
    run: impl FnOnce() -> Output,
) -> Arc<Output> {
    match memory {
        Some((known, output)) if *known == key && !*stale => Arc::clone(output),
        _ => {
            *stale = true;
            let output = Arc::new(run());
            *memory = Some((key, Arc::clone(&output)));
            output
        }
    }
}

/// Returns the range of readings that positions in an interval are interpolated from. It includes those that bracket the
/// interval, which its first and last positions need.
pub(super) fn used_readings(track: &FilteredTrack, interval: &Interval) -> RangeInclusive<usize> {
    let from = track.time_s.partition_point(|t| *t <= interval.start_s).saturating_sub(1);
    let to = track.time_s.partition_point(|t| *t < interval.end_s);
    from..=to.min(track.time_s.len().saturating_sub(1))
}

/// Fates of one station's raw readings.
fn fates(track: &FilteredTrack, intervals: &[Interval], kept: &[Interval]) -> Fates {
    let used_by = |intervals: &[Interval]| {
        let mut used = vec![false; track.time_s.len()];
        for interval in intervals {
            used[used_readings(track, interval)].fill(true);
        }
        used
    };
    let (in_kept, in_any) = (used_by(kept), used_by(intervals));
    let mut fates: Vec<_> = track
        .rejected
        .iter()
        .map(|reason| reason.map_or(SampleFate::InNoInterval, SampleFate::Rejected))
        .collect();
    for (fate, left_out) in fates.iter_mut().zip(&track.left_out) {
        if *left_out {
            *fate = SampleFate::LeftOut;
        }
    }
    for (index, source) in track.source.iter().enumerate() {
        fates[*source as usize] = match (in_kept[index], in_any[index]) {
            (true, _) => SampleFate::Kept,
            (false, true) => SampleFate::IntervalTooShort,
            (false, false) => SampleFate::InNoInterval,
        };
    }
    let counts = SampleFate::ALL.map(|fate| fates.iter().filter(|own| **own == fate).count());
    Fates { each: fates, counts }
}

/// Runs all stages.
pub fn run(deployment: &Deployment, settings: &PipelineSettings) -> PipelineOutput {
    StagedPipeline::default().run(deployment, settings)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulated_drives::{Preset, simulated};

    #[test]
    fn a_change_reruns_only_what_depends_on_it() {
        let deployment = simulated(Preset::Warthog, 1);
        let mut pipeline = StagedPipeline::default();
        let mut settings = PipelineSettings::default();
        let first = pipeline.run(&deployment, &settings);
        settings.thresholds.tau_l_seconds = 20.0;
        let longer = pipeline.run(&deployment, &settings);
        assert!(Arc::ptr_eq(&first.filtered, &longer.filtered));
        assert!(Arc::ptr_eq(&first.intervals, &longer.intervals));
        assert!(!Arc::ptr_eq(&first.triplets, &longer.triplets));
        settings.rate_hz = 5.0;
        let coarser = pipeline.run(&deployment, &settings);
        assert!(Arc::ptr_eq(&longer.kept_intervals, &coarser.kept_intervals));
        assert!(Arc::ptr_eq(&longer.fates, &coarser.fates));
        settings.thresholds.tau_a_deg_per_s = 0.5;
        let stricter = pipeline.run(&deployment, &settings);
        assert!(!Arc::ptr_eq(&coarser.filtered, &stricter.filtered));
        // The result is that of a fresh run, for any sequence of changes.
        let fresh = run(&deployment, &settings);
        assert_eq!(*fresh.triplets, *stricter.triplets);
        assert_eq!(*fresh.fates, *stricter.fates);
    }

    #[test]
    fn what_was_cancelled_is_not_answered_by_what_was_before() {
        let deployment = simulated(Preset::Warthog, 1);
        let mut pipeline = StagedPipeline::default();
        let mut settings =
            PipelineSettings { interpolation: Interpolation::Wnoa, ..PipelineSettings::default() };
        pipeline.run(&deployment, &settings);
        settings.thresholds.tau_l_seconds = 20.0;
        let progress = Progress::default();
        progress.cancel();
        assert!(pipeline.run_while(&deployment, &settings, &progress).is_err());
        let again = pipeline.run(&deployment, &settings);
        let fresh = run(&deployment, &settings);
        assert_eq!(*again.triplets, *fresh.triplets);
    }

    #[test]
    fn every_reading_has_one_fate() {
        let deployment = simulated(Preset::Warthog, 1);
        let out = run(&deployment, &PipelineSettings::default());
        for station in 0..3 {
            let total: usize = SampleFate::ALL.iter().map(|fate| out.count(station, *fate)).sum();
            assert_eq!(total, deployment.tracks[station].measurements.len());
        }
        assert!(out.counts(SampleFate::Kept).iter().all(|kept| *kept > 0));
    }

    #[test]
    fn any_number_of_stations_has_common_instants() {
        let three = simulated(Preset::Warthog, 1);
        let of_three = run(&three, &PipelineSettings::default());
        let with_tracks = |tracks: &[usize]| {
            let tracks = tracks.iter().map(|station| three.tracks[*station].clone()).collect();
            let deployment = Deployment { tracks, ..three.clone() };
            run(&deployment, &PipelineSettings::default())
        };
        // A station that is there twice interrupts no interval.
        let of_four = with_tracks(&[0, 1, 2, 1]);
        assert_eq!(of_four.triplets.time_s, of_three.triplets.time_s);
        assert_eq!(of_four.triplets.points_m[3], of_three.triplets.points_m[1]);
        // Two stations have more instants in common than three.
        let of_two = with_tracks(&[0, 2]);
        assert_eq!((of_two.triplets.points_m.len(), of_two.fates.len()), (2, 2));
        assert!(of_two.triplets.len() > of_three.triplets.len());
        assert!(with_tracks(&[]).triplets.is_empty());
    }
}
