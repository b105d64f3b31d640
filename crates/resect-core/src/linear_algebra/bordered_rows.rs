//! Cholesky factorisation of a banded matrix with a border, one block row at a time.
//!
//! Rows of `A x + B y = b` with the unknowns x in blocks of a size N, each coupled to the next few blocks, and unknowns y that all have in
//! common. A block row lies in memory as `[A_kk | A_k,k+1 | … | border]`, for each of its N unknowns. Elimination leaves the upper factor
//! U of `A = UᵀU`, and `U⁻ᵀ` times the border. With two blocks in a row these are the equations of a Kalman smoother (Rauch, Tung & Striebel
//! 1965).
//!
//! Sizes are known at run time only. The tiles of the inner loops are not, so that they stay in registers.

use std::ops::Range;

use multiversion::multiversion;

use super::sums::dot;

/// A pivot below this share of its diagonal element is lost in rounding.
const LEAST_PIVOT: f64 = 1e-13;
/// Columns of a tile.
const LANES: usize = 8;
/// Rows of a tile.
const HEIGHT: usize = 4;

/// Shape of a block row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RowShape {
    /// Unknowns of a block.
    pub size: usize,
    /// Blocks of a block row: its own and those after it to which it is coupled.
    pub blocks: usize,
    /// Columns of the border.
    pub border: usize,
}

impl RowShape {
    /// Numbers of each unknown.
    pub fn width(self) -> usize {
        self.first_of_border() + self.border
    }

    /// Index of the border's first column.
    pub fn first_of_border(self) -> usize {
        self.blocks * self.size
    }

    /// Numbers of a block row.
    pub fn numbers(self) -> usize {
        self.size * self.width()
    }
}

/// Factorises the own block of a block row, and applies `U⁻ᵀ` to all right of it; `false` if the block is not positive definite.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+fma", "x86_64+avx2+fma"))]
pub fn factorise(rows: &mut [f64], shape: RowShape) -> bool {
    let width = shape.width();
    for m in 0..shape.size {
        let (above, below) = rows.split_at_mut((m + 1) * width);
        let (done, row) = above.split_at_mut(m * width);
        let pivot = row[m];
        // What the rows above have subtracted from the diagonal element.
        let subtracted: f64 = done.chunks_exact(width).map(|row| row[m] * row[m]).sum();
        if pivot.is_nan() || pivot <= LEAST_PIVOT * (pivot + subtracted) {
            return false;
        }
        let inverse = 1.0 / pivot.sqrt();
        row.iter_mut().for_each(|value| *value *= inverse);
        for (offset, other) in below.chunks_exact_mut(width).enumerate() {
            let factor = row[m + 1 + offset];
            for (value, own) in other.iter_mut().zip(row.iter()) {
                *value -= factor * own;
            }
        }
    }
    true
}

/// Subtracts the Schur complement's share of a factorised block row from the block row that is `away` rows after it.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+fma", "x86_64+avx2+fma"))]
pub fn update(own: &[f64], target: &mut [f64], shape: RowShape, away: usize) {
    let (width, first) = (shape.width(), away * shape.size);
    // Both couple to the target's own block and the blocks after it, as far as the band reaches, and to the border.
    let coupled = shape.first_of_border() - first;
    let mut row = 0;
    while row < shape.size {
        let height = if row + HEIGHT <= shape.size { HEIGHT } else { 1 };
        let rows = &mut target[row * width..(row + height) * width];
        let product = Product { own, width, factors: first + row };
        for (columns, shift) in [(0..coupled, first), (shape.first_of_border()..width, 0)] {
            if height == HEIGHT {
                product.subtract::<HEIGHT>(rows, columns, shift);
            } else {
                product.subtract::<1>(rows, columns, shift);
            }
        }
        row += height;
    }
}

/// Adds the upper triangle of the Gram matrix of a factorised block row's border to `gram`, a square by rows; its width is a multiple of
/// [`HEIGHT`]. What is below the triangle is undefined.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+fma", "x86_64+avx2+fma"))]
pub fn add_border_gram(gram: &mut [f64], own: &[f64], shape: RowShape) {
    let (width, first, border) = (shape.width(), shape.first_of_border(), shape.border);
    assert!(border.is_multiple_of(HEIGHT));
    for (four, rows) in gram.chunks_exact_mut(HEIGHT * border).enumerate() {
        let product = Product { own, width, factors: first + HEIGHT * four };
        product.add(rows, HEIGHT * four..border, first);
    }
}

/// Products of two parts of a factorised block row: HEIGHT columns from `factors` on, with other columns.
struct Product<'a> {
    own: &'a [f64],
    width: usize,
    factors: usize,
}

impl Product<'_> {
    /// Subtracts from rows of the same width, at some columns, the products with the columns that are `shift` further.
    #[inline(always)]
    fn subtract<const H: usize>(&self, rows: &mut [f64], columns: Range<usize>, shift: usize) {
        let Range { start: mut column, end } = columns;
        while column + LANES <= end {
            self.tile::<H, LANES, true>(rows, self.width, column, shift);
            column += LANES;
        }
        if column + 4 <= end {
            self.tile::<H, 4, true>(rows, self.width, column, shift);
            column += 4;
        }
        while column < end {
            self.tile::<H, 1, true>(rows, self.width, column, shift);
            column += 1;
        }
    }

    /// Adds to rows whose width is the end of some columns, at these columns, the products with the columns that are `shift` further.
    #[inline(always)]
    fn add(&self, rows: &mut [f64], columns: Range<usize>, shift: usize) {
        let Range { start: mut column, end: width } = columns;
        while column + LANES <= width {
            self.tile::<HEIGHT, LANES, false>(rows, width, column, shift);
            column += LANES;
        }
        if column < width {
            self.tile::<HEIGHT, 4, false>(rows, width, column, shift);
        }
    }

    #[inline(always)]
    fn tile<const H: usize, const L: usize, const SUBTRACT: bool>(
        &self,
        rows: &mut [f64],
        width: usize,
        column: usize,
        shift: usize,
    ) {
        let mut sums = [[0.0; L]; H];
        for r in 0..H {
            sums[r].copy_from_slice(&rows[r * width + column..][..L]);
        }
        for row in self.own.chunks_exact(self.width) {
            let factors = &row[self.factors..self.factors + H];
            let values = &row[shift + column..shift + column + L];
            for r in 0..H {
                for l in 0..L {
                    if SUBTRACT {
                        sums[r][l] -= factors[r] * values[l];
                    } else {
                        sums[r][l] += factors[r] * values[l];
                    }
                }
            }
        }
        for r in 0..H {
            rows[r * width + column..][..L].copy_from_slice(&sums[r]);
        }
    }
}

/// Applies `U⁻ᵀ` to a right-hand side: `own` of this block row and `after` of the next ones. Subtracts from `border` the products of the
/// border's columns with the result.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+fma", "x86_64+avx2+fma"))]
pub fn forward_substitute(
    rows: &[f64],
    shape: RowShape,
    own: &mut [f64],
    after: &mut [f64],
    border: &mut [f64],
) {
    let (size, first) = (shape.size, shape.first_of_border());
    for (m, row) in rows.chunks_exact(shape.width()).enumerate() {
        let value = own[m] / row[m];
        own[m] = value;
        subtract_times(&mut own[m + 1..], value, &row[m + 1..size]);
        subtract_times(after, value, &row[size..first]);
        subtract_times(border, value, &row[first..]);
    }
}

/// Solves for the unknowns of a block row, given those of the blocks after it and of the border.
///
/// `x` begins with `U⁻ᵀ b` of this block row, followed by the unknowns after it.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+fma", "x86_64+avx2+fma"))]
pub fn back_substitute(rows: &[f64], shape: RowShape, x: &mut [f64], border: &[f64]) {
    let first = shape.first_of_border();
    for (m, row) in rows.chunks_exact(shape.width()).enumerate().rev() {
        let known = dot(&row[m + 1..x.len()], &x[m + 1..]) + dot(&row[first..], border);
        x[m] = (x[m] - known) / row[m];
    }
}

/// Subtracts a multiple of some values, as many as both have.
#[inline(always)]
fn subtract_times(from: &mut [f64], factor: f64, values: &[f64]) {
    for (from, value) in from.iter_mut().zip(values) {
        *from -= factor * value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};
    use rand::{RngExt, SeedableRng};

    const BLOCK_ROWS: usize = 9;
    const SHAPES: [RowShape; 3] = [
        RowShape { size: 3, blocks: 4, border: 4 },
        RowShape { size: 9, blocks: 4, border: 36 },
        RowShape { size: 19, blocks: 2, border: 20 },
    ];

    /// A random positive definite band with its border, dense and as block rows.
    struct RandomBand {
        band: DMatrix<f64>,
        border: DMatrix<f64>,
        rows: Vec<Vec<f64>>,
    }

    impl RandomBand {
        fn new(shape: RowShape, seed: u64) -> Self {
            let RowShape { size, blocks, .. } = shape;
            let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
            let order = size * BLOCK_ROWS;
            let mut band = DMatrix::zeros(order, order);
            for i in 0..order {
                for j in (0..=i).filter(|j| (i / size).abs_diff(j / size) < blocks) {
                    let value = rng.random_range(-1.0..1.0);
                    (band[(i, j)], band[(j, i)]) = (value, value);
                }
                band[(i, i)] += 4.0 * (blocks * size) as f64;
            }
            let border = DMatrix::from_fn(order, shape.border, |_, _| rng.random_range(-1.0..1.0));
            let mut rows = vec![vec![0.0; shape.numbers()]; BLOCK_ROWS];
            for (block, rows) in rows.iter_mut().enumerate() {
                for (m, row) in rows.chunks_exact_mut(shape.width()).enumerate() {
                    let i = size * block + m;
                    for c in 0..shape.first_of_border().min(order - size * block) {
                        row[c] = band[(i, size * block + c)];
                    }
                    for c in 0..shape.border {
                        row[shape.first_of_border() + c] = border[(i, c)];
                    }
                }
            }
            Self { band, border, rows }
        }

        /// Eliminates all block rows, and returns the Gram matrix of the border.
        fn eliminate(&mut self, shape: RowShape) -> DMatrix<f64> {
            let mut gram = vec![0.0; shape.border * shape.border];
            for block in 0..BLOCK_ROWS {
                let (own, after) = self.rows[block..].split_first_mut().expect("a block");
                assert!(factorise(own, shape));
                for (away, target) in (1..shape.blocks).zip(after) {
                    update(own, target, shape, away);
                }
                add_border_gram(&mut gram, own, shape);
            }
            let upper = |i: usize, j: usize| gram[shape.border * i.min(j) + i.max(j)];
            DMatrix::from_fn(shape.border, shape.border, upper)
        }
    }

    #[test]
    fn the_factor_and_the_border_are_nalgebra_s() {
        for shape in SHAPES {
            let mut random = RandomBand::new(shape, 1);
            let gram = random.eliminate(shape);
            let factor = random.band.clone().cholesky().expect("positive definite").l();
            let solved = factor.solve_lower_triangular(&random.border).expect("regular");
            for (block, rows) in random.rows.iter().enumerate() {
                let at = shape.size * block;
                for (m, row) in rows.chunks_exact(shape.width()).enumerate() {
                    for c in m..shape.first_of_border().min(factor.nrows() - at) {
                        assert!(
                            (row[c] - factor[(at + c, at + m)]).abs() < 1e-13,
                            "{at}, {m}, {c}"
                        );
                    }
                    let border = DVector::from_column_slice(&row[shape.first_of_border()..]);
                    assert!((border - solved.row(at + m).transpose()).amax() < 1e-13);
                }
            }
            assert!((gram - solved.tr_mul(&solved)).amax() < 1e-12);
        }
    }

    #[test]
    fn substitution_solves_the_system_for_any_right_hand_side() {
        for shape in SHAPES {
            let mut random = RandomBand::new(shape, 2);
            random.eliminate(shape);
            let order = shape.size * BLOCK_ROWS;
            let right = DVector::from_fn(order, |i, _| (i as f64).sin());
            let y = DVector::from_fn(shape.border, |i, _| (i as f64).cos());
            let mut x = right.as_slice().to_vec();
            let mut products = vec![0.0; shape.border];
            let end = |block: usize| order.min(shape.size * (block + shape.blocks));
            for block in 0..BLOCK_ROWS {
                let (own, after) = x[shape.size * block..end(block)].split_at_mut(shape.size);
                forward_substitute(&random.rows[block], shape, own, after, &mut products);
            }
            let root = random.band.clone().cholesky().expect("positive definite").l();
            let solved = root.solve_lower_triangular(&random.border).expect("regular");
            let expected = solved.tr_mul(&root.solve_lower_triangular(&right).expect("regular"));
            assert!((DVector::from_vec(products) + expected).amax() < 1e-13);
            for block in (0..BLOCK_ROWS).rev() {
                let x = &mut x[shape.size * block..end(block)];
                back_substitute(&random.rows[block], shape, x, y.as_slice());
            }
            let right = right - &random.border * y;
            let expected = random.band.cholesky().expect("positive definite").solve(&right);
            assert!((DVector::from_vec(x) - expected).amax() < 1e-13);
        }
    }

    #[test]
    fn a_matrix_that_is_not_positive_definite_is_refused() {
        let shape = SHAPES[0];
        let mut rows = RandomBand::new(shape, 3).rows.swap_remove(0);
        rows[shape.width() + 1] = -1.0;
        assert!(!factorise(&mut rows, shape));
        rows[0] = f64::NAN;
        assert!(!factorise(&mut rows, shape));
    }
}
