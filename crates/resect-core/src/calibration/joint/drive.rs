//! The readings of a drive, by stretch, and what its parts look like.

use super::motion::stretches;
use super::observed::{Piece, Reading};
use super::unknowns::{Outlook, Station};
use crate::pipeline::Triplets;
use crate::statistics::median;

/// Slow changes are constant for about this long (s). Longer where the data holds a direction so weakly that a part's end
/// matters, and at last for as long as a stretch.
pub const PARTS_S: [f64; 3] = [6.0, 30.0, f64::INFINITY];
/// Rows of so many knots are kept (21 MB; half an hour of a usual drive). Those of longer drives are made twice for each
/// step, which takes nearly twice as long, and no more room than for one stretch at a time.
const MOST_KEPT_KNOTS: usize = 4096;

/// The readings of a drive, by stretch, and what its parts look like.
#[derive(Clone, Debug)]
pub struct Drive {
    pub pieces: Vec<Piece>,
    /// Where the readings of each station point at, by part over all stretches.
    pub outlooks: Vec<[Outlook; 3]>,
    pub part_times_s: Vec<f64>,
    pub tied_to_next: Vec<bool>,
    /// Start and end of each drive (s), where several are solved together.
    pub spans_s: Vec<[f64; 2]>,
}

impl Drive {
    pub fn new(triplets: &Triplets, part_s: f64) -> Option<Self> {
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
            spans_s: spans_s(triplets),
        };
        for stretch in stretches(&triplets.time_s, &triplets.interval, knot_s, part_s) {
            let readings = triplets.readings.each_ref().map(|track| {
                let from = track.time_s.partition_point(|t| *t < stretch.start_s);
                let to = track.time_s.partition_point(|t| *t <= stretch.end_s);
                let both = track.time_s[from..to].iter().zip(&track.position_m[from..to]);
                both.map(|(time_s, point_m)| Reading { time_s: *time_s, point_m: *point_m })
                    .collect::<Vec<_>>()
            });
            if readings.iter().any(Vec::is_empty) {
                continue;
            }
            for part in 0..stretch.parts {
                drive.outlooks.push(readings.each_ref().map(|readings| {
                    let of_part = readings.iter().filter(|r| stretch.part(r.time_s) == part);
                    let all = readings.iter().map(Reading::sight);
                    Outlook::over(of_part.map(Reading::sight))
                        .or_else(|| Outlook::over(all))
                        .unwrap_or_default()
                }));
                drive.part_times_s.push(stretch.part_time_s(part));
                drive.tied_to_next.push(part + 1 < stretch.parts);
            }
            let middle_s = drive.middle_s(stretch.start_s);
            drive.pieces.push(Piece { stretch, readings, middle_s });
        }
        (!drive.pieces.is_empty()).then_some(drive)
    }

    /// Knots of all stretches.
    pub fn knots(&self) -> usize {
        self.pieces.iter().map(|piece| piece.stretch.knots).sum()
    }

    /// How many of the stretches, from the first on, have the rows of their motion kept from pass to pass.
    pub fn kept_pieces(&self) -> usize {
        let mut knots = 0;
        let fits = |piece: &&Piece| {
            knots += piece.stretch.knots;
            knots <= MOST_KEPT_KNOTS
        };
        self.pieces.iter().take_while(fits).count()
    }

    /// Every so many stretches of the drive, which have about `knots` knots together.
    pub fn sample(&self, knots: usize) -> Self {
        let stride = (self.knots() / knots).max(1);
        let first_parts = self.first_parts();
        let taken: Vec<usize> = (stride / 2..self.pieces.len()).step_by(stride).collect();
        let parts = || taken.iter().flat_map(|index| first_parts[*index]..first_parts[*index + 1]);
        Self {
            pieces: taken.iter().map(|index| self.pieces[*index].clone()).collect(),
            outlooks: parts().map(|part| self.outlooks[part]).collect(),
            part_times_s: parts().map(|part| self.part_times_s[part]).collect(),
            tied_to_next: parts().map(|part| self.tied_to_next[part]).collect(),
            spans_s: self.spans_s.clone(),
        }
    }

    /// The drifts of clocks count from the middle of the drive that an instant is in (s).
    pub fn middle_s(&self, time_s: f64) -> f64 {
        let drive = self.spans_s.iter().rfind(|[from_s, _]| *from_s <= time_s);
        drive.or(self.spans_s.first()).map_or(0.0, |[from_s, to_s]| 0.5 * (from_s + to_s))
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

/// Start and end of each drive (s).
fn spans_s(triplets: &Triplets) -> Vec<[f64; 2]> {
    let mut cuts: Vec<usize> = triplets
        .restarts_s
        .iter()
        .map(|restart_s| triplets.time_s.partition_point(|time_s| time_s < restart_s))
        .collect();
    cuts.insert(0, 0);
    cuts.push(triplets.len());
    let spans = cuts.windows(2).filter_map(|cut| triplets.time_s.get(cut[0]..cut[1]));
    spans.filter_map(|times_s| Some([*times_s.first()?, *times_s.last()?])).collect()
}

/// Median time between consecutive instants (s).
fn median_step_s(time_s: &[f64]) -> f64 {
    median(time_s.windows(2).map(|w| w[1] - w[0])).unwrap_or(f64::NAN)
}
