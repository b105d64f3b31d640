//! Elimination of the motion: a banded normal matrix of the knots, each coupled to the next three, with a border of the
//! columns of the drive's parts.
//!
//! The columns of a part couple to its own knots, and through the band to later ones, with decreasing size. A border of two
//! parts' width, which moves along, is enough: what remains of a part is added to the next but one when that begins. This is
//! exact for constants, and nearly so for slow states. The result is a chain: the information matrix of each part, that of each
//! part with the next, and the gradient.
//!
//! The loops over rows are in [`super::band_rows`].

use nalgebra::{SMatrix, SVector};

use super::band_rows::{
    BORDER, FIRST_PART, FIRST_PROBE, GRADIENT, MOTION_BORDER, PART, PROBES, TIED, add_gram,
    factorise, forward, substitute, subtract,
};

pub type PartMatrix = SMatrix<f64, PART, PART>;
pub type PartVector = SVector<f64, PART>;

/// Rows of a band by knot.
pub type Rows<const LOCAL: usize, const ROW: usize> = Vec<[[f64; ROW]; LOCAL]>;

/// Normal equations of one stretch: `LOCAL` unknowns a knot, `ROW` = 4 × `LOCAL` + [`BORDER`] or + [`MOTION_BORDER`].
pub struct Band<const LOCAL: usize, const ROW: usize> {
    /// The upper triangle, and after elimination its factor.
    rows: Rows<LOCAL, ROW>,
    /// The first knot of each part.
    first_knots: Vec<usize>,
    pub parts: Vec<Part>,
    /// Squares of the probes that the motion takes up.
    pub taken_up: [f64; PROBES],
}

/// Normal equations of a part after the motion is eliminated.
#[derive(Clone, Debug)]
pub struct Part {
    pub information: PartMatrix,
    /// Coupling of the part to the next one.
    pub with_next: PartMatrix,
    pub gradient: PartVector,
}

/// Four consecutive knots, and the factor of each in an equation.
#[derive(Clone, Copy)]
pub struct KnotFactors<'a> {
    pub first: usize,
    pub factors: &'a [f64; TIED],
}

/// An unknown of a part.
#[derive(Clone, Copy)]
pub struct PartUnknown {
    pub part: usize,
    /// Index among the unknowns of the part.
    pub column: usize,
}

impl Part {
    pub const NOTHING: Self = Self {
        information: PartMatrix::from_array_storage(nalgebra::ArrayStorage([[0.0; PART]; PART])),
        with_next: PartMatrix::from_array_storage(nalgebra::ArrayStorage([[0.0; PART]; PART])),
        gradient: PartVector::from_array_storage(nalgebra::ArrayStorage([[0.0; PART]; 1])),
    };
}

impl<const LOCAL: usize, const ROW: usize> Band<LOCAL, ROW> {
    const WIDTH: usize = ROW - TIED * LOCAL;
    /// The unknowns of the drive's parts are estimated as well.
    pub const HAS_PARTS: bool = Self::WIDTH > MOTION_BORDER;

    /// Returns a band without equations that reuses the memory of `rows`; parts begin at `first_knots`, the first at 0.
    pub fn new(mut rows: Rows<LOCAL, ROW>, knots: usize, first_knots: Vec<usize>) -> Self {
        rows.clear();
        rows.resize(knots, [[0.0; ROW]; LOCAL]);
        let parts = vec![Part::NOTHING; first_knots.len()];
        Self { rows, first_knots, parts, taken_up: [0.0; PROBES] }
    }

    pub fn into_rows(self) -> Rows<LOCAL, ROW> {
        self.rows
    }

    /// Takes the rows out, to reuse their memory; the normal equations of the parts stay.
    pub fn take_rows(&mut self) -> Rows<LOCAL, ROW> {
        std::mem::take(&mut self.rows)
    }

    /// Rows by knot: after elimination the Cholesky factor, and the coupling of each knot to the next knots and the border.
    pub fn rows(&self) -> &Rows<LOCAL, ROW> {
        &self.rows
    }

    pub fn has_rows(&self) -> bool {
        !self.rows.is_empty()
    }

    /// Adds equations of `SIZE` unknowns of each of four knots, from unknown `at` on: information matrix and gradient.
    pub fn add<const SIZE: usize>(
        &mut self,
        KnotFactors { first, factors }: KnotFactors<'_>,
        at: usize,
        information: &SMatrix<f64, SIZE, SIZE>,
        gradient: &SVector<f64, SIZE>,
    ) {
        for k in 0..TIED {
            for i in 0..SIZE {
                let row = &mut self.rows[first + k][at + i];
                for l in k..TIED {
                    let both = factors[k] * factors[l];
                    let block = &mut row[LOCAL * (l - k) + at..][..SIZE];
                    for j in 0..SIZE {
                        block[j] += both * information[(i, j)];
                    }
                }
                row[TIED * LOCAL + GRADIENT] += factors[k] * gradient[i];
            }
        }
    }

    /// Adds one equation for each unknown of four knots, all of the same precision, and their gradients.
    pub fn add_each(
        &mut self,
        KnotFactors { first, factors }: KnotFactors<'_>,
        precision: f64,
        gradient: &[f64; LOCAL],
    ) {
        for k in 0..TIED {
            for l in k..TIED {
                let both = precision * factors[k] * factors[l];
                for (i, row) in self.rows[first + k].iter_mut().enumerate() {
                    row[LOCAL * (l - k) + i] += both;
                }
            }
            for (row, value) in self.rows[first + k].iter_mut().zip(gradient) {
                row[TIED * LOCAL + GRADIENT] += factors[k] * value;
            }
        }
    }

    /// Adds the coupling of `SIZE` unknowns of each of four knots to an unknown of a part.
    pub fn add_border<const SIZE: usize>(
        &mut self,
        knots: KnotFactors<'_>,
        at: usize,
        PartUnknown { part, column }: PartUnknown,
        values: &SVector<f64, SIZE>,
    ) {
        self.add_column(knots, at, FIRST_PART + PART * (part % 2) + column, values);
    }

    /// Adds to a probe.
    pub fn add_probe<const SIZE: usize>(
        &mut self,
        knots: KnotFactors<'_>,
        at: usize,
        probe: usize,
        values: &SVector<f64, SIZE>,
    ) {
        self.add_column(knots, at, FIRST_PROBE + probe, values);
    }

    /// Adds to a column of the border.
    fn add_column<const SIZE: usize>(
        &mut self,
        KnotFactors { first, factors }: KnotFactors<'_>,
        at: usize,
        column: usize,
        values: &SVector<f64, SIZE>,
    ) {
        for k in 0..TIED {
            for i in 0..SIZE {
                self.rows[first + k][at + i][TIED * LOCAL + column] += factors[k] * values[i];
            }
        }
    }

    /// Returns the parts in the two places of the border at a knot: the last even and the last odd one that has begun.
    fn owners(&self, knot: usize) -> [Option<usize>; 2] {
        let begun = self.first_knots.partition_point(|first| *first <= knot);
        let last = begun - 1;
        let mut owners = [None; 2];
        owners[last % 2] = Some(last);
        owners[(last + 1) % 2] = last.checked_sub(1);
        owners
    }

    /// Eliminates the motion; `false` where its normal matrix is singular.
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

    /// Moves the sums of a part from the border to [`Band::parts`]; the next part, if any, is in the other place.
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

    /// Replaces the gradient of an eliminated band, and returns the gradients of the parts after elimination.
    pub fn exchange_gradient(
        &mut self,
        mut local: Vec<[f64; LOCAL]>,
        mut of_parts: Vec<PartVector>,
    ) -> Vec<PartVector> {
        for knot in 0..self.rows.len() {
            let owners = self.owners(knot);
            let mut border = [0.0; BORDER];
            let (own, after) = local[knot..].split_first_mut().expect("a knot");
            forward(&mut self.rows[knot], own, after, &mut border);
            for part in owners.into_iter().flatten() {
                let place = FIRST_PART + PART * (part % 2);
                let taken = PartVector::from_column_slice(&border[place..place + PART]);
                of_parts[part] -= taken;
            }
        }
        of_parts
    }

    /// Returns the step of the local unknowns for given steps of the parts; all are to be subtracted.
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

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};
    use rand::{RngExt, SeedableRng};

    pub const LOCAL: usize = 3;
    pub const ROW: usize = TIED * LOCAL + BORDER;
    pub const KNOTS: usize = 40;

    /// A band of random equations in three parts, and the same equations as a dense normal matrix and gradient, in which the
    /// three parts are one.
    pub fn example() -> (Band<LOCAL, ROW>, DMatrix<f64>, DVector<f64>) {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        let first_knots = vec![0, 13, 26];
        let mut band = Band::<LOCAL, ROW>::new(Vec::new(), KNOTS, first_knots);
        let size = KNOTS * LOCAL + PART;
        let (mut full, mut gradient) = (DMatrix::zeros(size, size), DVector::zeros(size));
        for first in 0..KNOTS - (TIED - 1) {
            let part = [0, 13, 26].iter().filter(|begin| **begin <= first).count() - 1;
            for _ in 0..3 {
                let factors: [f64; TIED] = std::array::from_fn(|_| rng.random_range(0.0..1.0));
                let direction = SVector::<f64, LOCAL>::from_fn(|_, _| rng.random_range(-1.0..1.0));
                let columns = PartVector::from_fn(|_, _| rng.random_range(-1.0..1.0));
                let error: f64 = rng.random_range(-1.0..1.0);
                let information = direction * direction.transpose();
                let knots = KnotFactors { first, factors: &factors };
                band.add(knots, 0, &information, &(direction * error));
                for column in 0..PART {
                    let values = direction * columns[column];
                    band.add_border(knots, 0, PartUnknown { part, column }, &values);
                }
                band.parts[part].information += columns * columns.transpose();
                band.parts[part].gradient += columns * error;
                let mut row = DVector::zeros(size);
                for k in 0..TIED {
                    for i in 0..LOCAL {
                        row[(first + k) * LOCAL + i] = factors[k] * direction[i];
                    }
                }
                row.rows_mut(KNOTS * LOCAL, PART).copy_from(&columns);
                full.ger(1.0, &row, &row, 1.0);
                gradient.axpy(error, &row, 1.0);
            }
        }
        for knot in 0..KNOTS - (TIED - 1) {
            let knots = KnotFactors { first: knot, factors: &[0.3, 0.0, 0.0, 0.0] };
            let information = SMatrix::<f64, LOCAL, LOCAL>::identity();
            band.add(knots, 0, &information, &SVector::zeros());
            (0..LOCAL).for_each(|i| full[(knot * LOCAL + i, knot * LOCAL + i)] += 0.09);
        }
        for knot in KNOTS - (TIED - 1)..KNOTS {
            let factors = &[0.0, 0.0, 0.0, 0.3];
            let information = SMatrix::<f64, LOCAL, LOCAL>::identity();
            let knots = KnotFactors { first: knot - (TIED - 1), factors };
            band.add(knots, 0, &information, &SVector::zeros());
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
