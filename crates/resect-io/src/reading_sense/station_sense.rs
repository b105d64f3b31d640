//! A sample of the readings of a station, and counts of those that are impossible.

use super::impossible::Impossible;
use crate::findings::readings::readings_implausible;
use resect_core::deployment::{Finding, Measurement};
use resect_core::statistics::median;

/// Fewest readings for a statement about a column.
pub const FEWEST: usize = 10;
/// Resolutions of stamps that are too coarse (s), and the largest difference of a stamp from a multiple, as a share of it.
const COARSE_STAMPS_S: [f64; 2] = [1.0, 0.1];
const ROUNDED_STAMP: f64 = 1e-5;
/// Number of coarse stamps above which chance is excluded.
const MANY: usize = 50;
/// Share of impossible readings from which on the recorder is doubted.
const DOUBTFUL_SHARE: f64 = 0.01;
pub const LARGEST_SAMPLE: usize = 4096;

/// Statistics of a station's readings with a valid status: counts of impossible ones, and an evenly spread sample.
#[derive(Clone, Debug, Default)]
pub struct StationSense {
    valid: u64,
    impossible: [u64; Impossible::DOUBTFUL.len()],
    pub sample: Vec<Sampled>,
    /// Readings between two of the sample.
    skipped: u64,
    seen: u64,
    last_s: Option<f64>,
    pub span_s: Option<[f64; 2]>,
}

#[derive(Clone, Copy, Debug)]
pub struct Sampled {
    pub measurement: Measurement,
    /// Time since the previous reading (s); `None` without one.
    pub step_s: Option<f64>,
}

impl StationSense {
    /// Adds a reading with a valid status, and the reason if it is impossible.
    pub fn take(&mut self, m: &Measurement, impossible: Option<Impossible>) {
        self.valid += 1;
        if let Some(kind) = Impossible::DOUBTFUL.iter().position(|own| Some(*own) == impossible) {
            self.impossible[kind] += 1;
        }
        // Without a range, the angles and the stamp are no reading either.
        if matches!(impossible, Some(Impossible::NotANumber | Impossible::ZeroRange)) {
            return;
        }
        let step_s = self.last_s.map(|last_s| m.time_s - last_s).filter(|step_s| *step_s > 0.0);
        self.last_s = Some(m.time_s);
        let [first_s, last_s] = self.span_s.get_or_insert([m.time_s; 2]);
        (*first_s, *last_s) = (first_s.min(m.time_s), last_s.max(m.time_s));
        if self.seen.is_multiple_of(self.skipped + 1) {
            self.sample.push(Sampled { measurement: *m, step_s });
            if self.sample.len() == LARGEST_SAMPLE {
                let mut index = 0;
                self.sample.retain(|_| {
                    index += 1;
                    index % 2 == 1
                });
                self.skipped = 2 * self.skipped + 1;
            }
        }
        self.seen += 1;
    }

    pub fn column(&self, of: impl Fn(&Sampled) -> f64) -> Column {
        Column(self.sample.iter().map(of).collect())
    }

    /// Returns the resolution of the stamps (s) if it is too coarse for a moving prism.
    pub fn coarse_stamps_s(&self) -> Option<f64> {
        let stamps = self.column(|s| s.measurement.time_s);
        let is_multiple = |stamp_s: f64, of_s: f64| {
            let count = stamp_s / of_s;
            (count - count.round()).abs() < ROUNDED_STAMP
        };
        let fits = |of_s: &f64| stamps.0.iter().all(|stamp_s| is_multiple(*stamp_s, *of_s));
        COARSE_STAMPS_S.into_iter().find(fits).filter(|_| stamps.0.len() >= MANY)
    }

    /// Returns a finding if the share of impossible readings is too large.
    pub fn doubt(&self, station: usize) -> Option<Finding> {
        let impossible: u64 = self.impossible.iter().sum();
        let share = impossible as f64 / self.valid.max(1) as f64;
        if share < DOUBTFUL_SHARE {
            return None;
        }
        let counts =
            Impossible::DOUBTFUL.iter().zip(self.impossible).filter(|(_, count)| *count > 0);
        let counts: Vec<_> = counts.map(|(kind, count)| (kind.short(), count as usize)).collect();
        let (impossible, valid) = (impossible as usize, self.valid as usize);
        Some(readings_implausible(station, impossible, valid, &counts))
    }
}

/// One column of the sample.
pub struct Column(pub Vec<f64>);

impl Column {
    pub fn median(&self) -> Option<f64> {
        if self.0.len() < FEWEST {
            return None;
        }
        median(self.0.iter().copied())
    }

    pub fn share(&self, is: impl Fn(f64) -> bool) -> f64 {
        if self.0.len() < FEWEST {
            return 0.0;
        }
        self.0.iter().filter(|value| is(**value)).count() as f64 / self.0.len() as f64
    }
}
