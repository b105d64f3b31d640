//! The readings of a drive, by stretch, and what its parts look like.

use super::equations::{Piece, Reading};
use super::motion::stretches;
use super::unknowns::{Outlook, Station};
use crate::pipeline::Triplets;
use crate::statistics::median;

/// The readings of a drive, by stretch, and what its parts look like.
pub struct Drive {
    pub pieces: Vec<Piece>,
    /// By part, over all stretches.
    pub outlooks: Vec<[Outlook; 3]>,
    pub part_times_s: Vec<f64>,
    pub tied_to_next: Vec<bool>,
    pub middle_s: f64,
}

impl Drive {
    pub fn new(triplets: &Triplets, part_s: f64) -> Option<Self> {
        let (first_s, last_s) = (*triplets.time_s.first()?, *triplets.time_s.last()?);
        let knot_s =
            triplets.readings.iter().map(|track| median_step_s(&track.time_s)).fold(0.0, f64::max);
        if !(0.01..=2.0).contains(&knot_s) {
            return None;
        }
        let mut drive = Self {
            pieces: Vec::new(),
            outlooks: Vec::new(),
            part_times_s: Vec::new(),
            tied_to_next: Vec::new(),
            middle_s: 0.5 * (first_s + last_s),
        };
        for stretch in stretches(&triplets.time_s, &triplets.interval, knot_s, part_s) {
            let readings = triplets.readings.each_ref().map(|track| {
                let from = track.time_s.partition_point(|t| *t < stretch.start_s);
                let to = track.time_s.partition_point(|t| *t <= stretch.end_s);
                let both = track.time_s[from..to].iter().zip(&track.position_m[from..to]);
                both.map(|(time_s, point_m)| Reading::new(*time_s, point_m)).collect::<Vec<_>>()
            });
            if readings.iter().any(Vec::is_empty) {
                continue;
            }
            for part in 0..stretch.parts {
                drive.outlooks.push(readings.each_ref().map(|readings| {
                    let of_part = readings.iter().filter(|r| stretch.part(r.time_s) == part);
                    let all = readings.iter().map(|reading| reading.sight);
                    Outlook::over(of_part.map(|reading| reading.sight))
                        .or_else(|| Outlook::over(all))
                        .unwrap_or_default()
                }));
                drive.part_times_s.push(stretch.part_time_s(part));
                drive.tied_to_next.push(part + 1 < stretch.parts);
            }
            drive.pieces.push(Piece { stretch, readings });
        }
        (!drive.pieces.is_empty()).then_some(drive)
    }

    /// Every so many stretches, of about so many knots together.
    pub fn sample(&self, knots: usize) -> Self {
        let all: usize = self.pieces.iter().map(|piece| piece.stretch.knots).sum();
        let stride = (all / knots).max(1);
        let first_parts = self.first_parts();
        let taken: Vec<usize> = (stride / 2..self.pieces.len()).step_by(stride).collect();
        let parts = || taken.iter().flat_map(|index| first_parts[*index]..first_parts[*index + 1]);
        Self {
            pieces: taken.iter().map(|index| self.pieces[*index].clone()).collect(),
            outlooks: parts().map(|part| self.outlooks[part]).collect(),
            part_times_s: parts().map(|part| self.part_times_s[part]).collect(),
            tied_to_next: parts().map(|part| self.tied_to_next[part]).collect(),
            middle_s: self.middle_s,
        }
    }

    /// The first part of each stretch, and the number of all parts.
    pub fn first_parts(&self) -> Vec<usize> {
        let mut first = vec![0];
        for piece in &self.pieces {
            first.push(first[first.len() - 1] + piece.stretch.parts);
        }
        first
    }

    /// Splines through the triplets.
    pub fn coefficients_m(
        &self,
        triplets: &Triplets,
        plain: &[Station; 3],
        prisms: usize,
    ) -> Vec<Vec<f64>> {
        let of = |piece: &Piece| {
            let stretch = &piece.stretch;
            let mut coefficients_m = Vec::with_capacity(stretch.knots * 3 * prisms);
            for knot in 0..stretch.knots {
                let time_s = stretch.knot_time_s(knot).clamp(stretch.start_s, stretch.end_s);
                let after = triplets.time_s.partition_point(|t| *t < time_s);
                let at = after.min(triplets.len() - 1);
                for (prism, station) in plain.iter().enumerate().take(prisms) {
                    let point_m = station.turn * triplets.points_m[prism][at] + station.place_m;
                    coefficients_m.extend(point_m.iter());
                }
            }
            coefficients_m
        };
        self.pieces.iter().map(of).collect()
    }
}

/// Between consecutive instants.
fn median_step_s(time_s: &[f64]) -> f64 {
    median(time_s.windows(2).map(|w| w[1] - w[0])).unwrap_or(f64::NAN)
}
