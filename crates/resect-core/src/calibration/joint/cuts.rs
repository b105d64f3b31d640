//! The motion about the cuts of long stretches.
//!
//! Both sides of a cut are estimated side by side, and each knows only its own readings: near the cut it is twice as uncertain
//! as elsewhere, and the two do not meet. That is nothing to the rest of the estimate. Once that is settled, the motion about
//! the cut is estimated again from the readings of both sides, and instants near it are taken from there.

use super::band::{Band, Rows};
use super::drive::Drive;
use super::motion::Stretch;
use super::observed::Piece;
use super::pass::{Around, Eliminated, Weigh, eliminate};

/// So many knots on either side of a cut are taken from the motion about it, whose ends are as far away again.
const TAKEN_KNOTS: f64 = 8.0;
/// What is nearer to a cut than so many knots is weighed anew.
const ANEW_KNOTS: f64 = 4.0;
/// Steps towards the motion, which begins at that of both sides: while all is weighed anew, and with the weights that are kept.
const STEPS: usize = 4;
const KEPT_STEPS: usize = 2;

/// The motion about a cut.
pub struct AboutCut<const LOCAL: usize, const ROW: usize> {
    pub stretch: Stretch,
    pub coefficients_m: Vec<f64>,
    pub band: Band<LOCAL, ROW>,
}

/// From when to when the motion about the cut after a stretch is taken (s); `None` where there is no cut.
pub fn taken_s(drive: &Drive, index: usize) -> Option<[f64; 2]> {
    let [stretch, next] = [index, index + 1].map(|k| drive.pieces.get(k).map(|it| &it.stretch));
    let (stretch, half_s) = (stretch?, TAKEN_KNOTS * stretch?.knot_s);
    stretch.about_cut(next?)?;
    Some([stretch.end_s - half_s, stretch.end_s + half_s])
}

/// The motion about the cut after a stretch, all else being where it is taken to be; `None` where there is no cut, or the motion
/// is not held.
pub fn about_cut<const LOCAL: usize, const ROW: usize, const MOTION: usize>(
    around: &Around<'_>,
    by: &Weigh,
    index: usize,
) -> Option<AboutCut<LOCAL, ROW>> {
    let sides = around.drive.pieces.get(index..index + 2)?;
    let stretch = sides[0].stretch.about_cut(&sides[1].stretch)?;
    let readings = [0, 1, 2].map(|station| {
        let both = sides.iter().flat_map(|side| &side.readings[station]);
        both.filter(|reading| stretch.has(reading.time_s)).cloned().collect()
    });
    let mut coefficients_m = coefficients_m::<LOCAL>(around, &stretch, index);
    let piece = Piece { stretch, readings, middle_s: sides[0].middle_s };
    // The last part before the cut, and the first after it.
    let next = around.first_parts[index + 1];
    let parts = next - 1..next + 1;
    let mut rows = Rows::<LOCAL, MOTION>::default();
    let mut held: Option<Vec<f64>> = None;
    for step in 0..STEPS + KEPT_STEPS {
        let at = around.parts_at::<LOCAL>(&piece, parts.clone(), &coefficients_m);
        let Eliminated { band, weights, .. } =
            eliminate(&piece, &at, by, held.as_deref(), std::mem::take(&mut rows))?;
        let moved = band.local_step(&[]);
        coefficients_m.iter_mut().zip(&moved).for_each(|(value, moved)| *value -= moved);
        rows = band.into_rows();
        if step + 1 == STEPS {
            held = Some(with_kept(
                weights,
                sides,
                by.held.as_ref().map(|held| &held[index..]),
                &piece,
            ));
        }
    }
    let at = around.parts_at::<LOCAL>(&piece, parts, &coefficients_m);
    let Eliminated { band, .. } = eliminate(&piece, &at, by, held.as_deref(), Rows::default())?;
    Some(AboutCut { stretch: piece.stretch, coefficients_m, band })
}

/// The weights about a cut, of which those that are further from it are what the sides have: the two motions go over into each
/// other. Nearer to it, each side had to weigh what it saw the half of.
fn with_kept(
    mut weights: Vec<f64>,
    sides: &[Piece],
    held: Option<&[Vec<f64>]>,
    piece: &Piece,
) -> Vec<f64> {
    let Some(held) = held else { return weights };
    let cut_s = sides[0].stretch.end_s;
    let is_far = |time_s: f64| (time_s - cut_s).abs() > ANEW_KNOTS * piece.stretch.knot_s;
    let mut all = weights.iter_mut();
    let mut from = [0; 2];
    for station in 0..3 {
        for (side, (own, held)) in sides.iter().zip(held).enumerate() {
            let readings = &own.readings[station];
            let of_readings = readings.iter().zip(&held[from[side]..]);
            let near = of_readings.filter(|(reading, _)| piece.stretch.has(reading.time_s));
            // Those of the piece come in the same order.
            for ((reading, kept), weight) in near.zip(all.by_ref()) {
                if is_far(reading.time_s) {
                    *weight = *kept;
                }
            }
            from[side] += readings.len();
        }
    }
    for (segment, weight) in all.enumerate() {
        let time_s = piece.stretch.segment_time_s(segment);
        let side = usize::from(time_s > cut_s);
        let of_jerks = &held[side][from[side]..];
        let at = sides[side].stretch.place(time_s).first;
        if let Some(kept) = of_jerks.get(at).filter(|_| is_far(time_s)) {
            *weight = *kept;
        }
    }
    weights
}

/// Splines through the motion on both sides of the cut after a stretch.
fn coefficients_m<const LOCAL: usize>(
    around: &Around<'_>,
    stretch: &Stretch,
    index: usize,
) -> Vec<f64> {
    let cut_s = around.drive.pieces[index].stretch.end_s;
    let place_m = |time_s: f64| -> [f64; LOCAL] {
        let side = if time_s <= cut_s { index } else { index + 1 };
        let place = around.drive.pieces[side].stretch.place(time_s);
        let knots_m = &around.at.coefficients_m[side][LOCAL * place.first..];
        std::array::from_fn(|i| {
            place
                .position
                .iter()
                .enumerate()
                .map(|(k, weight)| weight * knots_m[LOCAL * k + i])
                .sum()
        })
    };
    let knots = 0..stretch.knots;
    let of_knot = |knot: usize| {
        let time_s = stretch.knot_time_s(knot);
        // A spline is below its coefficients where it bends down (Schoenberg 1946).
        let [before, at, after] = [-1.0, 0.0, 1.0].map(|k| place_m(time_s + k * stretch.knot_s));
        (0..LOCAL).map(move |i| at[i] - (before[i] - 2.0 * at[i] + after[i]) / 6.0)
    };
    knots.flat_map(of_knot).collect()
}
