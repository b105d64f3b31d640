//! The motion eliminated: normal equations whose local unknowns are a band, each knot tied to the next three, with the
//! columns of the drive's parts as a border.
//!
//! A part's columns act on its own knots, and through the band on those after them, where it fades. A border of two parts'
//! width, which moves along, is enough: what is left of a part where the next but one begins is given to that one, which is
//! exact for what is the same in all parts, and as good as that for what is slow. What stays is a chain: the information of
//! each part, of each part with the next one, and the gradient.
//!
//! One row of a knot is its own block, the blocks of the next three knots, and the border, in one array, so that the inner
//! loops run over neighbours in memory; `multiversion` picks AVX-512 or AVX2 where the processor has it.

use multiversion::multiversion;
use nalgebra::{SMatrix, SVector};

/// Unknowns of a part of the drive: shifts of stations 2 and 3 (m, station 1's frame), their lateness (s), latencies of
/// stations 1 to 3 (s), inter-prism distances (m).
pub const PART: usize = 14;
/// Knots that a knot is tied to, itself included.
pub const TIED: usize = 4;
/// What redundancies are asked with.
pub const PROBES: usize = 4;
/// Places in the border: the gradient, probes, parts with even numbers, and parts with odd numbers.
const GRADIENT: usize = 0;
const FIRST_PROBE: usize = 1;
const FIRST_PART: usize = 8;
/// Width of the border, and of one without the parts, whose unknowns then stay as they are.
pub const BORDER: usize = FIRST_PART + 2 * PART;
pub const MOTION_BORDER: usize = FIRST_PART;
/// Numbers in the widest vector of a processor.
const LANES: usize = 8;

pub type PartMatrix = SMatrix<f64, PART, PART>;
pub type PartVector = SVector<f64, PART>;

/// Rows of a band by knot.
pub type Rows<const LOCAL: usize, const ROW: usize> = Vec<[[f64; ROW]; LOCAL]>;

/// One span's equations: `LOCAL` unknowns a knot, `ROW` = 4 × `LOCAL` + [`BORDER`] or + [`MOTION_BORDER`].
pub struct Band<const LOCAL: usize, const ROW: usize> {
    /// The upper triangle, and after elimination its factor.
    rows: Rows<LOCAL, ROW>,
    /// The first knot of each part.
    first_knots: Vec<usize>,
    pub parts: Vec<Part>,
    /// Squares of the probes as the motion takes them up.
    pub taken_up: [f64; PROBES],
}

/// What is left of a part.
#[derive(Clone, Debug)]
pub struct Part {
    pub information: PartMatrix,
    /// What the part has in common with the part after it.
    pub with_next: PartMatrix,
    pub gradient: PartVector,
}

impl Part {
    const NOTHING: Self = Self {
        information: PartMatrix::from_array_storage(nalgebra::ArrayStorage([[0.0; PART]; PART])),
        with_next: PartMatrix::from_array_storage(nalgebra::ArrayStorage([[0.0; PART]; PART])),
        gradient: PartVector::from_array_storage(nalgebra::ArrayStorage([[0.0; PART]; 1])),
    };
}

impl<const LOCAL: usize, const ROW: usize> Band<LOCAL, ROW> {
    const WIDTH: usize = ROW - TIED * LOCAL;
    /// Whether the parts of the drive are unknown as well.
    pub const HAS_PARTS: bool = Self::WIDTH > MOTION_BORDER;

    /// A band without any equation, in the room of other rows; parts begin at these knots, the first at 0.
    pub fn new(mut rows: Rows<LOCAL, ROW>, knots: usize, first_knots: Vec<usize>) -> Self {
        rows.clear();
        rows.resize(knots, [[0.0; ROW]; LOCAL]);
        let parts = vec![Part::NOTHING; first_knots.len()];
        Self { rows, first_knots, parts, taken_up: [0.0; PROBES] }
    }

    pub fn into_rows(self) -> Rows<LOCAL, ROW> {
        self.rows
    }

    /// Adds equations that tie four knots from `first` on by `weights`, about `SIZE` unknowns of each from `at` on: their
    /// information, their border with the part's `columns`, and their gradient.
    pub fn add<const SIZE: usize>(
        &mut self,
        first: usize,
        at: usize,
        weights: &[f64; TIED],
        information: &SMatrix<f64, SIZE, SIZE>,
        gradient: &SVector<f64, SIZE>,
    ) {
        for k in 0..TIED {
            for i in 0..SIZE {
                let row = &mut self.rows[first + k][at + i];
                for l in k..TIED {
                    let both = weights[k] * weights[l];
                    let block = &mut row[LOCAL * (l - k) + at..][..SIZE];
                    for j in 0..SIZE {
                        block[j] += both * information[(i, j)];
                    }
                }
                row[TIED * LOCAL + GRADIENT] += weights[k] * gradient[i];
            }
        }
    }

    /// Adds one equation for each unknown of four knots, of the same `weights` and precision, and their gradients.
    pub fn add_each(
        &mut self,
        first: usize,
        weights: &[f64; TIED],
        precision: f64,
        gradient: &[f64; LOCAL],
    ) {
        for k in 0..TIED {
            for l in k..TIED {
                let both = precision * weights[k] * weights[l];
                for (i, row) in self.rows[first + k].iter_mut().enumerate() {
                    row[LOCAL * (l - k) + i] += both;
                }
            }
            for (row, value) in self.rows[first + k].iter_mut().zip(gradient) {
                row[TIED * LOCAL + GRADIENT] += weights[k] * value;
            }
        }
    }

    /// Adds what such equations have in common with one unknown of a part.
    pub fn add_border<const SIZE: usize>(
        &mut self,
        first: usize,
        at: usize,
        weights: &[f64; TIED],
        part: usize,
        column: usize,
        values: &SVector<f64, SIZE>,
    ) {
        let column = TIED * LOCAL + FIRST_PART + PART * (part % 2) + column;
        for k in 0..TIED {
            for i in 0..SIZE {
                self.rows[first + k][at + i][column] += weights[k] * values[i];
            }
        }
    }

    /// Adds to a probe.
    pub fn add_probe<const SIZE: usize>(
        &mut self,
        first: usize,
        at: usize,
        weights: &[f64; TIED],
        probe: usize,
        values: &SVector<f64, SIZE>,
    ) {
        let column = TIED * LOCAL + FIRST_PROBE + probe;
        for k in 0..TIED {
            for i in 0..SIZE {
                self.rows[first + k][at + i][column] += weights[k] * values[i];
            }
        }
    }

    /// The parts in both places of the border at a knot: the last even and the last odd one that has begun.
    fn owners(&self, knot: usize) -> [Option<usize>; 2] {
        let begun = self.first_knots.partition_point(|first| *first <= knot);
        let last = begun - 1;
        let mut owners = [None; 2];
        owners[last % 2] = Some(last);
        owners[(last + 1) % 2] = last.checked_sub(1);
        owners
    }

    /// Eliminates the motion; `false` where it is not held.
    pub fn eliminate(&mut self) -> bool {
        let knots = self.rows.len();
        let mut gram = [[0.0; BORDER]; BORDER];
        for knot in 0..knots {
            let owners = self.owners(knot);
            let last = owners.into_iter().flatten().max().unwrap_or(0);
            let next_begins = self.first_knots.get(last + 1).copied().unwrap_or(usize::MAX);
            let (own, after) = self.rows[knot..].split_first_mut().expect("a knot");
            if !factorise(own) {
                return false;
            }
            if let Some(target) = after.first_mut() {
                subtract::<LOCAL, ROW, 1>(own, target);
            }
            if let Some(target) = after.get_mut(1) {
                subtract::<LOCAL, ROW, 2>(own, target);
            }
            if let Some(target) = after.get_mut(2) {
                subtract::<LOCAL, ROW, 3>(own, target);
            }
            add_gram(&mut gram, own);
            if !Self::HAS_PARTS {
                continue;
            }
            let ends = |part: usize| knot + 1 == knots || (part < last && next_begins == knot + 1);
            for part in last.saturating_sub(1)..=last {
                if ends(part) {
                    self.retire(part, &mut gram);
                }
            }
        }
        for (probe, sum) in self.taken_up.iter_mut().enumerate() {
            *sum = gram[FIRST_PROBE + probe][FIRST_PROBE + probe];
        }
        true
    }

    /// Moves what was gathered about a part out of the border; the one after it, if any, is in the other place.
    fn retire(&mut self, part: usize, gram: &mut [[f64; BORDER]; BORDER]) {
        let place = FIRST_PART + PART * (part % 2);
        let other = FIRST_PART + PART * ((part + 1) % 2);
        let sum = |gram: &[[f64; BORDER]; BORDER], i: usize, j: usize| gram[i.min(j)][i.max(j)];
        for i in 0..PART {
            for j in 0..PART {
                self.parts[part].information[(i, j)] -= sum(gram, place + i, place + j);
                if part + 1 < self.parts.len() {
                    self.parts[part].with_next[(i, j)] -= sum(gram, place + i, other + j);
                }
            }
            self.parts[part].gradient[i] -= sum(gram, place + i, GRADIENT);
        }
        for i in place..place + PART {
            for j in 0..BORDER {
                gram[i.min(j)][i.max(j)] = 0.0;
            }
        }
    }

    /// Another gradient of an eliminated band, with what it leaves of the parts' gradients; the rest stays as it is.
    pub fn exchange_gradient(&mut self, mut local: Vec<[f64; LOCAL]>, of_parts: Vec<PartVector>) {
        for (part, gradient) in self.parts.iter_mut().zip(of_parts) {
            part.gradient = gradient;
        }
        for knot in 0..self.rows.len() {
            let owners = self.owners(knot);
            let mut border = [0.0; BORDER];
            let (own, after) = local[knot..].split_first_mut().expect("a knot");
            forward(&mut self.rows[knot], own, after, &mut border);
            for part in owners.into_iter().flatten() {
                let place = FIRST_PART + PART * (part % 2);
                let taken = PartVector::from_column_slice(&border[place..place + PART]);
                self.parts[part].gradient -= taken;
            }
        }
    }

    /// The step of the local unknowns, given those of the parts; all are to be subtracted.
    pub fn local_step(&self, of_parts: &[PartVector]) -> Vec<f64> {
        let mut step = vec![0.0; self.rows.len() * LOCAL];
        for knot in (0..self.rows.len()).rev() {
            let mut border = [0.0; BORDER];
            border[GRADIENT] = -1.0;
            for part in self.owners(knot).into_iter().flatten().filter(|_| Self::HAS_PARTS) {
                let place = FIRST_PART + PART * (part % 2);
                border[place..place + PART].copy_from_slice(of_parts[part].as_slice());
            }
            let beyond = step.len().min((knot + TIED) * LOCAL);
            substitute(&self.rows[knot], &border, &mut step[knot * LOCAL..beyond]);
        }
        step
    }
}

/// Solves for a knot's unknowns, the first of `step`, the others and the border being known.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+fma", "x86_64+avx2+fma"))]
fn substitute<const LOCAL: usize, const ROW: usize>(
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
fn forward<const LOCAL: usize, const ROW: usize>(
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
fn subtract<const LOCAL: usize, const ROW: usize, const AWAY: usize>(
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
fn add_gram<const LOCAL: usize, const ROW: usize>(
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

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};
    use rand::{RngExt, SeedableRng};

    const LOCAL: usize = 3;
    const ROW: usize = TIED * LOCAL + BORDER;
    const KNOTS: usize = 40;

    /// A band of random equations in three parts, and the same as one dense matrix and gradient over all local unknowns and
    /// those of one part that the whole drive has.
    fn example() -> (Band<LOCAL, ROW>, DMatrix<f64>, DVector<f64>) {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        let first_knots = vec![0, 13, 26];
        let mut band = Band::<LOCAL, ROW>::new(Vec::new(), KNOTS, first_knots);
        let size = KNOTS * LOCAL + PART;
        let (mut full, mut gradient) = (DMatrix::zeros(size, size), DVector::zeros(size));
        for first in 0..KNOTS - (TIED - 1) {
            let part = [0, 13, 26].iter().filter(|begin| **begin <= first).count() - 1;
            for _ in 0..3 {
                let weights: [f64; TIED] = std::array::from_fn(|_| rng.random_range(0.0..1.0));
                let direction = SVector::<f64, LOCAL>::from_fn(|_, _| rng.random_range(-1.0..1.0));
                let columns = PartVector::from_fn(|_, _| rng.random_range(-1.0..1.0));
                let error: f64 = rng.random_range(-1.0..1.0);
                let information = direction * direction.transpose();
                band.add(first, 0, &weights, &information, &(direction * error));
                for column in 0..PART {
                    let values = direction * columns[column];
                    band.add_border(first, 0, &weights, part, column, &values);
                }
                band.parts[part].information += columns * columns.transpose();
                band.parts[part].gradient += columns * error;
                let mut row = DVector::zeros(size);
                for k in 0..TIED {
                    for i in 0..LOCAL {
                        row[(first + k) * LOCAL + i] = weights[k] * direction[i];
                    }
                }
                row.rows_mut(KNOTS * LOCAL, PART).copy_from(&columns);
                full.ger(1.0, &row, &row, 1.0);
                gradient.axpy(error, &row, 1.0);
            }
        }
        for knot in 0..KNOTS - (TIED - 1) {
            let weights = [0.3, 0.0, 0.0, 0.0];
            let information = SMatrix::<f64, LOCAL, LOCAL>::identity();
            band.add(knot, 0, &weights, &information, &SVector::zeros());
            (0..LOCAL).for_each(|i| full[(knot * LOCAL + i, knot * LOCAL + i)] += 0.09);
        }
        for knot in KNOTS - (TIED - 1)..KNOTS {
            let weights = [0.0, 0.0, 0.0, 0.3];
            let information = SMatrix::<f64, LOCAL, LOCAL>::identity();
            band.add(knot - (TIED - 1), 0, &weights, &information, &SVector::zeros());
            (0..LOCAL).for_each(|i| full[(knot * LOCAL + i, knot * LOCAL + i)] += 0.09);
        }
        (band, full, gradient)
    }

    #[test]
    fn what_all_parts_have_in_common_is_the_dense_solution() {
        let (mut band, full, gradient) = example();
        assert!(band.eliminate());
        let (mut information, mut pull) = (PartMatrix::zeros(), PartVector::zeros());
        for part in &band.parts {
            information += part.information + part.with_next + part.with_next.transpose();
            pull += part.gradient;
        }
        let locals = KNOTS * LOCAL;
        let dense = full.clone().cholesky().expect("definite").solve(&gradient);
        let inverse = full.try_inverse().expect("definite");
        let expected = inverse.view((locals, locals), (PART, PART)).into_owned();
        let expected = expected.try_inverse().expect("definite");
        assert!(
            (information - &expected).amax() < 1e-9 * expected.amax(),
            "{information} {expected}"
        );
        let step = information.cholesky().expect("definite").solve(&pull);
        assert!((step - dense.rows(locals, PART)).amax() < 1e-8, "{step}");
        let local = band.local_step(&[step; 3]);
        for (found, expected) in local.iter().zip(dense.iter()) {
            assert!((found - expected).abs() < 1e-8, "{found} {expected}");
        }
    }
}
