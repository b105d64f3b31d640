//! The result of a study: boxes of errors in groups and series.

use crate::analysis::Settings;
use crate::deployment::Finding;
use crate::palette::Rgb;
use crate::statistics::quantiles;

/// One box: sizes of errors, summed up (mm).
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
    /// Quantiles of the sizes of errors (mm) of either sign, in any order; `None` of nothing.
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

/// Boxes side by side, one of each series.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    pub label: String,
    /// A second line: how much data stands behind it.
    pub note: String,
    /// One box of each series, or why there is none, in a few words.
    pub boxes: Vec<Result<Quantiles, String>>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    pub name: String,
    pub rgb: Rgb,
}

/// A value (mm) to compare with.
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
    /// What everything that the study does not vary was set to.
    pub settings: Settings,
}
