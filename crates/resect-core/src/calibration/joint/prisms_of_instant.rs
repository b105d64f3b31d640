//! The prisms whose motion is evaluated at an instant: those that are read around it.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use super::segment_prisms::SegmentPrisms;

/// Longest time before the first reading of a prism in a segment, or after its last one, at which its motion is evaluated (s). Beyond it the spline
/// is an extrapolation that nothing checks.
const LONGEST_EXTRAPOLATION_S: f64 = 0.5;

/// The prisms of a segment that are followed at an instant.
pub struct PrismsOfInstant {
    /// Their places among the prisms of the drive, in order.
    pub in_drive: Arc<[usize]>,
    /// Their coordinates among those of the segment; `None` if all prisms of the segment are followed.
    coordinates: Option<Vec<usize>>,
}

impl PrismsOfInstant {
    /// The prisms at an instant (s), by the first and last reading of each in the segment (s).
    pub fn at(time_s: f64, read_spans_s: &[Option<[f64; 2]>], all: &SegmentPrisms) -> Self {
        let is_followed = |prism: &usize| {
            read_spans_s[*prism].is_some_and(|[first_s, last_s]| {
                time_s >= first_s - LONGEST_EXTRAPOLATION_S
                    && time_s <= last_s + LONGEST_EXTRAPOLATION_S
            })
        };
        let prisms: Vec<usize> = (0..all.count()).filter(is_followed).collect();
        if prisms.len() == all.count() {
            return Self { in_drive: Arc::clone(&all.in_drive), coordinates: None };
        }
        let coordinates = prisms.iter().flat_map(|prism| 3 * prism..3 * prism + 3).collect();
        let in_drive = prisms.iter().map(|prism| all.in_drive[*prism]).collect();
        Self { in_drive, coordinates: Some(coordinates) }
    }

    /// The rows of these prisms.
    pub fn rows(&self, matrix: DMatrix<f64>) -> DMatrix<f64> {
        match &self.coordinates {
            Some(coordinates) => matrix.select_rows(coordinates),
            None => matrix,
        }
    }

    /// Rows and columns of these prisms.
    pub fn rows_and_columns(&self, matrix: DMatrix<f64>) -> DMatrix<f64> {
        match &self.coordinates {
            Some(coordinates) => matrix.select_rows(coordinates).select_columns(coordinates),
            None => matrix,
        }
    }

    /// The coordinates of these prisms.
    pub fn of_vector(&self, vector: DVector<f64>) -> DVector<f64> {
        match &self.coordinates {
            Some(coordinates) => vector.select_rows(coordinates),
            None => vector,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::state_vector::tests::layout;
    use super::*;

    #[test]
    fn a_prism_is_there_half_a_second_beyond_its_readings() {
        let layout = layout(3);
        let all = SegmentPrisms::new(&layout, layout.followed_at(0.0), &[0, 1, 2]);
        let read_spans_s = [Some([0.0, 9.0]), Some([2.0, 4.0]), None];
        let places =
            |time_s: f64| PrismsOfInstant::at(time_s, &read_spans_s, &all).in_drive.to_vec();
        assert_eq!(places(1.4), [0]);
        assert_eq!(places(1.6), [0, 1]);
        assert_eq!(places(4.4), [0, 1]);
        assert_eq!(places(4.6), [0]);
        assert!(places(9.6).is_empty());
        let some = PrismsOfInstant::at(3.0, &read_spans_s, &all);
        let coordinates = DVector::from_fn(9, |i, _| i as f64);
        assert_eq!(some.of_vector(coordinates).as_slice(), [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    }
}
