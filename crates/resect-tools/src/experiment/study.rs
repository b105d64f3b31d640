//! Result of a study: boxes of errors in groups and series.

use crate::palette::Rgb;
use resect_core::analysis::Settings;
use resect_core::deployment::Finding;
use resect_core::statistics::quantiles;

/// Range accuracy of the Trimble S7 (mm), the paper's line for the instruments' own noise.
pub const INSTRUMENT_NOISE_MM: f64 = 2.0;

/// One box: quantiles of absolute errors (mm).
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Quantiles {
    pub q05: f64,
    pub q25: f64,
    pub median: f64,
    pub q75: f64,
    pub q95: f64,
    pub n: usize,
}

impl Quantiles {
    /// Quantiles of absolute errors (mm), in any order; `None` without errors.
    pub fn of(errors_mm: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut n = 0;
        let sizes_mm = errors_mm.into_iter().inspect(|_| n += 1).map(f64::abs);
        let [q05, q25, median, q75, q95] = quantiles(sizes_mm, [0.05, 0.25, 0.5, 0.75, 0.95])?;
        Some(Self { q05, q25, median, q75, q95, n })
    }

    pub fn values(&self) -> [f64; 5] {
        [self.q05, self.q25, self.median, self.q75, self.q95]
    }

    pub fn iqr(&self) -> f64 {
        self.q75 - self.q25
    }
}

/// Boxes side by side, one for each series.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    pub label: String,
    /// Second line of the label: the amount of data.
    pub note: String,
    /// One box for each series, or the reason why there is none, in a few words.
    pub boxes: Vec<Result<Quantiles, String>>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    pub name: String,
    pub rgb: Rgb,
}

/// A reference value (mm).
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    pub label: String,
    pub value: f64,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// The name in file names: "ablation".
    pub name: String,
    pub title: String,
    pub subtitle: String,
    pub value_label: String,
    pub group_label: String,
    pub series: Vec<Series>,
    pub groups: Vec<Group>,
    pub levels: Vec<Level>,
    pub findings: Vec<Finding>,
    /// Settings that the study does not vary.
    pub settings: Settings,
}

impl Study {
    /// Returns a box that can be drawn, or the reason why there is none.
    pub fn quantiles(&self, group: usize, series: usize) -> Result<&Quantiles, &str> {
        match self.groups[group].boxes.get(series) {
            Some(Ok(quantiles)) if quantiles.values().into_iter().all(can_be_shown) => {
                Ok(quantiles)
            }
            Some(Ok(_)) => Err("not a number"),
            Some(Err(why)) => Err(why),
            None => Err(""),
        }
    }

    /// All boxes that can be drawn, group by group.
    pub fn all_quantiles(&self) -> impl Iterator<Item = &Quantiles> {
        let series = 0..self.series.len();
        (0..self.groups.len())
            .flat_map(move |group| series.clone().map(move |series| (group, series)))
            .filter_map(|(group, series)| self.quantiles(group, series).ok())
    }

    /// Levels that can be drawn.
    pub fn shown_levels(&self) -> impl Iterator<Item = &Level> {
        self.levels.iter().filter(|level| can_be_shown(level.value))
    }

    /// Returns true if the smallest boxes would be flat on a linear axis.
    pub fn needs_log(&self) -> bool {
        let medians = self.all_quantiles().map(|quantiles| quantiles.median);
        let smallest = medians.fold(f64::INFINITY, f64::min);
        let largest = self.values().fold(0.0, f64::max);
        smallest > 0.0 && largest > 25.0 * smallest
    }

    /// All values that are drawn (mm).
    pub fn values(&self) -> impl Iterator<Item = f64> {
        let levels = self.shown_levels().map(|level| level.value);
        self.all_quantiles().flat_map(Quantiles::values).chain(levels)
    }
}

/// Returns true if a value is finite and not so large that pixels overflow.
fn can_be_shown(value: f64) -> bool {
    value.abs() < 1e15
}
