//! The triplets that an answer uses: all, or those without gross outliers.

use std::borrow::Cow;

use nalgebra::Vector3;

use super::{CentredTriplets, PrismNetwork};
use crate::network::PerStation;
use crate::pipeline::Triplets;

/// The triplets that an answer uses, by their indices: a copy would need as much memory as everything computed from them.
#[derive(Clone)]
pub struct Used<'a> {
    all: &'a Triplets,
    /// Indices of the kept triplets; `None` for all.
    kept: Option<Vec<usize>>,
}

impl<'a> Used<'a> {
    pub fn all(all: &'a Triplets) -> Self {
        Self { all, kept: None }
    }

    pub fn some(all: &'a Triplets, kept: Vec<usize>) -> Self {
        Self { all, kept: Some(kept) }
    }

    pub fn len(&self) -> usize {
        self.kept.as_ref().map_or(self.all.len(), Vec::len)
    }

    pub fn triplets(&self) -> Cow<'a, Triplets> {
        match &self.kept {
            Some(kept) => Cow::Owned(self.all.select(kept)),
            None => Cow::Borrowed(self.all),
        }
    }

    pub fn centred(&self, network: &PrismNetwork) -> CentredTriplets {
        match &self.kept {
            Some(kept) => CentredTriplets::some(self.all, kept, network),
            None => CentredTriplets::new(self.all, network),
        }
    }

    /// Returns the points by station (m, each in its station's frame).
    pub fn points_m(&self) -> PerStation<Vec<Vector3<f64>>> {
        self.all.points_m.map(|points| match &self.kept {
            Some(kept) => kept.iter().map(|i| points[*i]).collect(),
            None => points.clone(),
        })
    }

    /// Returns the times of the triplets (s), and their intervals.
    pub fn instants(&self) -> (Cow<'a, [f64]>, Cow<'a, [u32]>) {
        let Triplets { time_s, interval, .. } = self.all;
        match &self.kept {
            Some(kept) => (
                kept.iter().map(|i| time_s[*i]).collect(),
                kept.iter().map(|i| interval[*i]).collect(),
            ),
            None => (Cow::Borrowed(time_s), Cow::Borrowed(interval)),
        }
    }
}
