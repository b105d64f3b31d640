//! Compression of one pair's squared distances from n triplets to a 9×9 triangular matrix.
//!
//! For a pair (a, b) with the pose (ψ, t) of frame b in frame a, the squared distance is linear in nine monomials: ‖q_a − R q_b −
//! t‖² − d² = φ(q_a, q_b)ᵀ m(ψ, t) with m = (cos ψ, sin ψ, t_x, t_y, t_z, ‖t‖², (Rᵀt)_x, (Rᵀt)_y, 1). So Σ (…)² = ‖Φ m‖² = ‖T m‖²
//! with the triangle T of Φ = Q T, and no later cost depends on n. Householder's QR keeps the precision that a Gram matrix ΦᵀΦ
//! would lose (2·10⁻¹¹ against 5·10⁻⁴ of the cost). Rows are processed in chunks, so the memory is bounded.
//!
//! For stations that follow the same prism, the three coordinates of q_a − R q_b − t are linear in five of the same monomials.

use multiversion::multiversion;

use super::CentredTriplets;
use super::prism_network::FollowedPair;

/// Number of monomials m = (cos ψ, sin ψ, t_x, t_y, t_z, ‖t‖², (Rᵀt)_x, (Rᵀt)_y, 1). The constant one is last, so the first eight
/// columns of the triangle are that of the problem without the constraints between the monomials.
pub const MONOMIALS: usize = 9;
pub const CONSTANT: usize = 8;
/// Number of rows that are reduced together: few enough for the first-level cache.
const CHUNK: usize = 64;
/// Number of lanes of each sum, for vector instructions.
const LANES: usize = 8;

/// Triangular factor by columns, `factor[column][row]`; zero below the diagonal.
pub type Factor = [[f64; MONOMIALS]; MONOMIALS];

type MonomialRows = [[f64; CHUNK]; MONOMIALS];

/// Returns the triangle of a pair (m²; m if both stations follow the same prism).
pub fn compress(data: &CentredTriplets, pair: &FollowedPair) -> Factor {
    let lists = [pair.stations.first, pair.stations.second]
        .map(|station| data.coordinates[station].each_ref().map(Vec::as_slice));
    reduce_all(&lists, pair.distance_m, pair.is_shared())
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2+fma"))]
fn reduce_all(lists: &[[&[f64]; 3]; 2], distance_m: f64, is_shared: bool) -> Factor {
    let mut factor = [[0.0; MONOMIALS]; MONOMIALS];
    let mut rows = [[0.0; CHUNK]; MONOMIALS];
    let count = lists[0][0].len();
    for start in (0..count).step_by(CHUNK) {
        let end = count.min(start + CHUNK);
        let some = lists.map(|list| list.map(|axis| &axis[start..end]));
        if is_shared {
            for axis in 0..3 {
                fill_coordinate(&mut rows, &some, axis);
                reduce(&mut factor, &mut rows);
            }
        } else {
            fill(&mut rows, &some, distance_m);
            reduce(&mut factor, &mut rows);
        }
    }
    factor
}

/// Fills in φ of some instants, then zeros, which change no triangle.
#[inline(always)]
fn fill(rows: &mut MonomialRows, [a, b]: &[[&[f64]; 3]; 2], distance_m: f64) {
    let count = a[0].len();
    for i in 0..count {
        let (ax, ay, az, bx, by, bz) = (a[0][i], a[1][i], a[2][i], b[0][i], b[1][i], b[2][i]);
        let dz = az - bz;
        rows[0][i] = -2.0 * (ax * bx + ay * by);
        rows[1][i] = -2.0 * (ay * bx - ax * by);
        rows[2][i] = -2.0 * ax;
        rows[3][i] = -2.0 * ay;
        rows[4][i] = -2.0 * dz;
        rows[5][i] = 1.0;
        rows[6][i] = 2.0 * bx;
        rows[7][i] = 2.0 * by;
        rows[8][i] = ax * ax + ay * ay + bx * bx + by * by + dz * dz - distance_m * distance_m;
    }
    for column in rows {
        column[count..].fill(0.0);
    }
}

/// Fills in the rows of one coordinate of q_a − R q_b − t at some instants, then zeros.
#[inline(always)]
fn fill_coordinate(rows: &mut MonomialRows, [a, b]: &[[&[f64]; 3]; 2], axis: usize) {
    let count = a[0].len();
    for column in rows.iter_mut() {
        column.fill(0.0);
    }
    for i in 0..count {
        let (bx, by) = (b[0][i], b[1][i]);
        match axis {
            0 => (rows[0][i], rows[1][i], rows[CONSTANT][i]) = (-bx, by, a[0][i]),
            1 => (rows[0][i], rows[1][i], rows[CONSTANT][i]) = (-by, -bx, a[1][i]),
            _ => rows[CONSTANT][i] = a[2][i] - b[2][i],
        }
        rows[2 + axis][i] = -1.0;
    }
}

/// Updates the triangle by the rows, with Householder reflections. Overwrites the rows.
#[inline(always)]
fn reduce(factor: &mut Factor, rows: &mut MonomialRows) {
    for j in 0..MONOMIALS {
        // Only the diagonal element and the rows of the reflection's vector are not zero.
        let below = rows[j];
        let below_squared = dot(&below, &below);
        if below_squared == 0.0 {
            continue;
        }
        let diagonal = factor[j][j];
        let size = (diagonal * diagonal + below_squared).sqrt();
        // The sign that avoids cancellation.
        let head = diagonal + size.copysign(diagonal);
        let scale = 2.0 / (head * head + below_squared);
        factor[j][j] = diagonal - head;
        for k in j + 1..MONOMIALS {
            let s = scale * (head * factor[k][j] + dot(&below, &rows[k]));
            factor[k][j] -= s * head;
            for i in 0..CHUNK {
                rows[k][i] -= s * below[i];
            }
        }
    }
}

#[inline(always)]
fn dot(a: &[f64; CHUNK], b: &[f64; CHUNK]) -> f64 {
    let mut sums = [0.0; LANES];
    for start in (0..CHUNK).step_by(LANES) {
        for l in 0..LANES {
            sums[l] += a[start + l] * b[start + l];
        }
    }
    sums.iter().sum()
}

#[cfg(test)]
mod tests {
    use super::super::distance_pass::tests::{irregular, irregular_shared};
    use super::*;
    use nalgebra::DMatrix;

    /// Triangle of all rows at once, by nalgebra's QR.
    fn one_shot(data: &CentredTriplets, pair: &FollowedPair) -> DMatrix<f64> {
        let mut tall = DMatrix::zeros(pair.residuals() * data.len(), MONOMIALS);
        let mut rows = [[0.0; CHUNK]; MONOMIALS];
        for row in 0..tall.nrows() {
            let (i, axis) = (row / pair.residuals(), row % pair.residuals());
            let lists = [pair.stations.first, pair.stations.second]
                .map(|s| data.coordinates[s].each_ref().map(|axis| &axis[i..i + 1]));
            if pair.is_shared() {
                fill_coordinate(&mut rows, &lists, axis);
            } else {
                fill(&mut rows, &lists, pair.distance_m);
            }
            for column in 0..MONOMIALS {
                tall[(row, column)] = rows[column][0];
            }
        }
        tall.qr().r()
    }

    /// A triangle is unique except for the signs of its rows, on which no cost depends.
    #[test]
    fn chunk_by_chunk_gives_the_triangle_of_all_at_once() {
        for count in [10, CHUNK - 1, CHUNK, CHUNK + 1, 1000] {
            let (data, _) = irregular(count);
            for pair in &data.network.pairs {
                let (streamed, whole) = (compress(&data, pair), one_shot(&data, pair));
                for column in 0..MONOMIALS {
                    let size = whole.column(column).norm();
                    for row in 0..MONOMIALS {
                        let (s, w) = (streamed[column][row], whole[(row, column)]);
                        assert!(
                            (s.abs() - w.abs()).abs() < 1e-12 * size,
                            "{row}, {column}: {s} {w}"
                        );
                    }
                }
            }
        }
    }

    /// The triangle of a shared prism has three columns of zeros, so only its products are unique.
    #[test]
    fn the_products_of_a_shared_prism_are_those_of_all_rows() {
        for count in [10, CHUNK + 1, 1000] {
            let (data, _) = irregular_shared(count);
            for pair in data.network.pairs.iter().filter(|pair| pair.is_shared()) {
                let streamed = compress(&data, pair);
                let streamed = DMatrix::from_fn(MONOMIALS, MONOMIALS, |i, j| streamed[j][i]);
                let (streamed, whole) = (streamed.tr_mul(&streamed), one_shot(&data, pair));
                let whole = whole.tr_mul(&whole);
                assert!((streamed - &whole).amax() < 1e-12 * whole.amax());
            }
        }
    }
}
