//! Cholesky factorisation of a dense matrix of a few dozen rows, with right-hand sides, in tiles.
//!
//! Each row is followed by its right-hand sides: `[K | B]` becomes `[U | U⁻ᵀB]` with `K = UᵀU`. Tiles of [`HEIGHT`] rows and [`LANES`]
//! columns stay in registers. The inner functions have plain loops and are always inlined: closures and iterators would be compiled for
//! the oldest processor.

use multiversion::multiversion;

/// Columns of a tile; widths and orders are multiples of it.
pub const LANES: usize = 8;
/// Rows of a tile.
const HEIGHT: usize = 4;

type Tile = [[f64; LANES]; HEIGHT];

/// Returns the next multiple of [`LANES`].
pub fn padded(count: usize) -> usize {
    count.next_multiple_of(LANES)
}

/// Eliminates the first `order` columns of rows of this width, of which only the upper triangle is read.
///
/// From column `staircase` on the right-hand side is the identity, whose zeros are skipped. Rounding cannot make a pivot smaller than
/// `least_pivot`.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2"))]
pub fn eliminate(rows: &mut [f64], width: usize, order: usize, staircase: usize, least_pivot: f64) {
    for first in (0..order).step_by(HEIGHT) {
        let (done, active) = rows.split_at_mut(first * width);
        let active = &mut active[..HEIGHT * width];
        let diagonal = first / LANES * LANES;
        let tile = reduced(done, active, width, first, diagonal, 0);
        let pivots = DiagonalFactor::new(&tile, first - diagonal, least_pivot);
        store(active, width, diagonal, &pivots.solve(tile));
        let mut column = diagonal + LANES;
        while column < width {
            let first_step = column.saturating_sub(staircase);
            if first_step < first + HEIGHT {
                let tile = reduced(done, active, width, first, column, first_step);
                store(active, width, column, &pivots.solve(tile));
            }
            column += LANES;
        }
    }
}

/// Returns a tile of the active rows less the share of the rows above; the first `skip` of these are zero there.
#[inline(always)]
fn reduced(
    done: &[f64],
    active: &[f64],
    width: usize,
    first: usize,
    column: usize,
    skip: usize,
) -> Tile {
    let mut tile = [[0.0; LANES]; HEIGHT];
    for r in 0..HEIGHT {
        let from = r * width + column;
        tile[r].copy_from_slice(&active[from..from + LANES]);
    }
    for row in done.chunks_exact(width).skip(skip) {
        let (left, right) = (&row[first..first + HEIGHT], &row[column..column + LANES]);
        for r in 0..HEIGHT {
            for l in 0..LANES {
                tile[r][l] -= left[r] * right[l];
            }
        }
    }
    tile
}

#[inline(always)]
fn store(active: &mut [f64], width: usize, column: usize, tile: &Tile) {
    for r in 0..HEIGHT {
        let from = r * width + column;
        active[from..from + LANES].copy_from_slice(&tile[r]);
    }
}

/// Factor of the square of [`HEIGHT`] rows on the diagonal.
struct DiagonalFactor {
    /// Reciprocals of its diagonal.
    inverse: [f64; HEIGHT],
    /// Factor above the diagonal.
    beside: [[f64; HEIGHT]; HEIGHT],
}

impl DiagonalFactor {
    /// The square begins at column `at` of the tile.
    #[inline(always)]
    fn new(tile: &Tile, at: usize, least: f64) -> Self {
        let mut square = [[0.0; HEIGHT]; HEIGHT];
        for r in 0..HEIGHT {
            square[r].copy_from_slice(&tile[r][at..at + HEIGHT]);
        }
        let mut inverse = [0.0; HEIGHT];
        for r in 0..HEIGHT {
            inverse[r] = 1.0 / square[r][r].max(least).sqrt();
            for c in r + 1..HEIGHT {
                square[r][c] *= inverse[r];
            }
            for below in r + 1..HEIGHT {
                for c in below..HEIGHT {
                    square[below][c] -= square[r][below] * square[r][c];
                }
            }
        }
        Self { inverse, beside: square }
    }

    /// Applies the elimination to another tile of these rows.
    #[inline(always)]
    fn solve(&self, mut tile: Tile) -> Tile {
        for r in 0..HEIGHT {
            let mut done = tile[r];
            for l in 0..LANES {
                done[l] *= self.inverse[r];
            }
            tile[r] = done;
            for below in r + 1..HEIGHT {
                for l in 0..LANES {
                    tile[below][l] -= self.beside[r][below] * done[l];
                }
            }
        }
        tile
    }
}

/// Returns `Σ weight_ij (XᵀX − GᵀG)_ij` and `Σ weight_ij (WᵀW)_ij` for a lower triangle `X` with rows of this width, and two rows
/// each of `G` and `W`. The weights lie by rows of `order` numbers, zeros on and below the diagonal.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2"))]
pub fn contract(
    (lower, width): (&[f64], usize),
    [taken, outer]: [&[Vec<f64>]; 2],
    weights: &[f64],
    order: usize,
) -> [f64; 2] {
    let (mut inner_sum, mut outer_sum) = ([0.0; LANES], [0.0; LANES]);
    for first in (0..order).step_by(HEIGHT) {
        for column in (first / LANES * LANES..order).step_by(LANES) {
            // The triangle is zero above its diagonal.
            let skip = if column > first { column } else { first };
            let mut tile = products(&lower[skip * width..], width, first, column);
            for row in taken {
                add_product(&mut tile, row, first, column, -1.0);
            }
            let mut outer_tile = [[0.0; LANES]; HEIGHT];
            for row in outer {
                add_product(&mut outer_tile, row, first, column, 1.0);
            }
            for r in 0..HEIGHT {
                let from = (first + r) * order + column;
                let weight = &weights[from..from + LANES];
                for l in 0..LANES {
                    inner_sum[l] += weight[l] * tile[r][l];
                    outer_sum[l] += weight[l] * outer_tile[r][l];
                }
            }
        }
    }
    [inner_sum.iter().sum(), outer_sum.iter().sum()]
}

#[inline(always)]
fn products(rows: &[f64], width: usize, first: usize, column: usize) -> Tile {
    let mut tile = [[0.0; LANES]; HEIGHT];
    for row in rows.chunks(width) {
        let (left, right) = (&row[first..first + HEIGHT], &row[column..column + LANES]);
        for r in 0..HEIGHT {
            for l in 0..LANES {
                tile[r][l] += left[r] * right[l];
            }
        }
    }
    tile
}

#[inline(always)]
fn add_product(tile: &mut Tile, row: &[f64], first: usize, column: usize, sign: f64) {
    let (left, right) = (&row[first..first + HEIGHT], &row[column..column + LANES]);
    for r in 0..HEIGHT {
        for l in 0..LANES {
            tile[r][l] += sign * left[r] * right[l];
        }
    }
}

/// Four vectors, interleaved by row.
pub type Lists = [[f64; HEIGHT]];

/// Products of columns with each of four vectors, and with themselves.
pub struct Products {
    pub with_lists: [Vec<f64>; HEIGHT],
    pub squares: Vec<f64>,
}

/// Multiplies the first `count` columns with each vector and with themselves. With `is_triangle`, rows above the diagonal are skipped,
/// because they are zero.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2"))]
pub fn products_with(
    (rows, width): (&[f64], usize),
    lists: &Lists,
    count: usize,
    is_triangle: bool,
) -> Products {
    let mut found =
        Products { with_lists: [const { Vec::new() }; HEIGHT], squares: vec![0.0; count] };
    for list in &mut found.with_lists {
        list.resize(count, 0.0);
    }
    for column in (0..count).step_by(LANES) {
        let (mut tile, mut squares) = ([[0.0; LANES]; HEIGHT], [0.0; LANES]);
        let skip = if is_triangle { column.min(lists.len()) } else { 0 };
        for (row, list) in rows[skip * width..].chunks(width).zip(&lists[skip..]) {
            let row = &row[column..column + LANES];
            for l in 0..LANES {
                squares[l] += row[l] * row[l];
            }
            for r in 0..HEIGHT {
                for l in 0..LANES {
                    tile[r][l] += list[r] * row[l];
                }
            }
        }
        found.squares[column..column + LANES].copy_from_slice(&squares);
        for r in 0..HEIGHT {
            found.with_lists[r][column..column + LANES].copy_from_slice(&tile[r]);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

    #[test]
    fn elimination_is_a_cholesky_factor_and_its_solutions() {
        for order in [8, 16, 40] {
            let any = |i: usize, j: usize| {
                ((12.9898 * i as f64 + 78.233 * j as f64).sin() * 437.5).fract()
            };
            let root = DMatrix::from_fn(order, order, any);
            let matrix = &root * root.transpose() + DMatrix::identity(order, order);
            let sides = DMatrix::from_fn(order, LANES, |i, j| any(j, i + 3));
            let width = 2 * order + LANES;
            let mut rows = vec![0.0; order * width];
            for i in 0..order {
                for j in i..order {
                    rows[i * width + j] = matrix[(i, j)];
                }
                for j in 0..LANES {
                    rows[i * width + order + j] = sides[(i, j)];
                }
                rows[i * width + order + LANES + i] = 1.0;
            }
            eliminate(&mut rows, width, order, order + LANES, 0.0);
            let factor = nalgebra::Cholesky::new(matrix).expect("positive").l();
            let solved = factor.solve_lower_triangular(&sides).expect("regular");
            let inverse = factor.clone().try_inverse().expect("regular");
            for i in 0..order {
                let found = |j: usize| rows[i * width + j];
                for j in 0..order {
                    if j >= i {
                        assert!((found(j) - factor[(j, i)]).abs() < 1e-11, "{i}, {j} of {order}");
                    }
                    let of_inverse = found(order + LANES + j);
                    assert!((of_inverse - inverse[(i, j)]).abs() < 1e-11, "{i}, {j} of {order}");
                }
                for j in 0..LANES {
                    assert!((found(order + j) - solved[(i, j)]).abs() < 1e-11, "{i}, {j}");
                }
            }
        }
    }
}
