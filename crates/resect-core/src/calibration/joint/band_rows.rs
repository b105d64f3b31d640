//! What a row of a band is, and the loops over rows.
//!
//! One row of a knot is its own block, the blocks of the next three knots, and the border,
//! so that the inner loops run over neighbours in memory. `multiversion` picks AVX-512 or AVX2 where the processor has it.

use multiversion::multiversion;

/// Unknowns of a part of the drive: shifts of stations 2 and 3 (m, station 1's frame), their lateness (s), latencies of
/// stations 1 to 3 (s), inter-prism distances (m).
pub const PART: usize = 14;
/// Knots that a knot is tied to, itself included.
pub const TIED: usize = 4;
/// What redundancies are asked with.
pub const PROBES: usize = 4;
/// Places in the border: the gradient, probes, parts with even numbers, and parts with odd numbers.
pub const GRADIENT: usize = 0;
pub const FIRST_PROBE: usize = 1;
pub const FIRST_PART: usize = 8;
/// Width of the border, and of one without the parts, whose unknowns then stay as they are.
pub const BORDER: usize = FIRST_PART + 2 * PART;
pub const MOTION_BORDER: usize = FIRST_PART;
/// Numbers in the widest vector of a processor.
const LANES: usize = 8;

/// Solves for a knot's unknowns, the first of `step`, the others and the border being known.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+fma", "x86_64+avx2+fma"))]
pub fn substitute<const LOCAL: usize, const ROW: usize>(
    rows: &[[f64; ROW]; LOCAL],
    border: &[f64; BORDER],
    step: &mut [f64],
) {
    for m in (0..LOCAL).rev() {
        let row = &rows[m];
        let border = &border[..ROW - TIED * LOCAL];
        let known =
            dot(&row[m + 1..step.len()], &step[m + 1..]) + dot(&row[TIED * LOCAL..], border);
        step[m] = -known / row[m];
    }
}

/// Takes a knot's own gradient out of those of the knots after it, and gathers what it says of the border.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+fma", "x86_64+avx2+fma"))]
pub fn forward<const LOCAL: usize, const ROW: usize>(
    rows: &mut [[f64; ROW]; LOCAL],
    own: &[f64; LOCAL],
    after: &mut [[f64; LOCAL]],
    border: &mut [f64; BORDER],
) {
    let mut own = *own;
    for (m, row) in rows.iter_mut().enumerate() {
        let value = own[m] / row[m];
        for (other, factor) in own[m + 1..].iter_mut().zip(&row[m + 1..LOCAL]) {
            *other -= value * factor;
        }
        for (other, factor) in after.as_flattened_mut().iter_mut().zip(&row[LOCAL..TIED * LOCAL]) {
            *other -= value * factor;
        }
        for (sum, factor) in border.iter_mut().zip(&row[TIED * LOCAL..]) {
            *sum += value * factor;
        }
        row[TIED * LOCAL + GRADIENT] = value;
    }
}

/// Divides rows by the root of their own block; `false` where that is not positive definite.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+fma", "x86_64+avx2+fma"))]
pub fn factorise<const LOCAL: usize, const ROW: usize>(rows: &mut [[f64; ROW]; LOCAL]) -> bool {
    let before: [f64; LOCAL] = std::array::from_fn(|m| rows[m][m]);
    for m in 0..LOCAL {
        let (above, below) = rows.split_at_mut(m + 1);
        let row = &mut above[m];
        let pivot = row[m];
        // A pivot that is lost in rounding is none.
        if pivot.is_nan() || pivot <= 1e-13 * before[m] {
            return false;
        }
        let inverse = 1.0 / pivot.sqrt();
        row.iter_mut().for_each(|value| *value *= inverse);
        for (offset, other) in below.iter_mut().enumerate() {
            let factor = row[m + 1 + offset];
            for (value, own) in other.iter_mut().zip(row.iter()) {
                *value -= factor * own;
            }
        }
    }
    true
}

/// Subtracts what an eliminated knot says of the `AWAY`-th knot after it.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+fma", "x86_64+avx2+fma"))]
pub fn subtract<const LOCAL: usize, const ROW: usize, const AWAY: usize>(
    own: &[[f64; ROW]; LOCAL],
    target: &mut [[f64; ROW]; LOCAL],
) {
    // As the target's row: its own block and those that both are tied to, and the border.
    let tied = (TIED - AWAY) * LOCAL;
    for (r, row) in target.iter_mut().enumerate() {
        let mut sum = *row;
        for from in own {
            let factor = from[LOCAL * AWAY + r];
            for c in 0..tied {
                sum[c] -= factor * from[LOCAL * AWAY + c];
            }
            for c in TIED * LOCAL..ROW {
                sum[c] -= factor * from[c];
            }
        }
        *row = sum;
    }
}

/// Adds the products of a knot's border with itself.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+fma", "x86_64+avx2+fma"))]
pub fn add_gram<const LOCAL: usize, const ROW: usize>(
    gram: &mut [[f64; BORDER]; BORDER],
    own: &[[f64; ROW]; LOCAL],
) {
    let width = ROW - TIED * LOCAL;
    let mut borders = [[0.0; BORDER]; LOCAL];
    for (to, from) in borders.iter_mut().zip(own) {
        to[..width].copy_from_slice(&from[TIED * LOCAL..]);
    }
    // Four rows at a time: each number that is read serves them all. The lower triangle is never read.
    let (fours, _) = gram[..width].as_chunks_mut::<4>();
    for (four, rows) in fours.iter_mut().enumerate() {
        let mut sums = *rows;
        for border in &borders {
            for (r, sum) in sums.iter_mut().enumerate() {
                let factor = border[4 * four + r];
                for (value, own) in sum[..width].iter_mut().zip(&border[..width]) {
                    *value += factor * own;
                }
            }
        }
        *rows = sums;
    }
}

/// The sum of products, in as many sums as a vector has room for.
#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (a_whole, a_rest) = a.as_chunks::<LANES>();
    let (b_whole, b_rest) = b.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for (a, b) in a_whole.iter().zip(b_whole) {
        for lane in 0..LANES {
            sums[lane] += a[lane] * b[lane];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + rest
}
