//! Which constants, and which slow changes, explain the parts of a drive best, and how certain that is.
//!
//! Data and priors make one normal matrix. The slow states are eliminated along the chain, as in a Kalman smoother (Rauch,
//! Tung & Striebel 1965), which leaves the constants.

use multiversion::multiversion;
use nalgebra::{ArrayStorage, Cholesky, Const, SMatrix};

use super::band_rows::factorise;
use super::chain::{Between, Columns, Data, Square};
use super::slow_priors::{LnDeterminant, SlowMatrix, SlowPrecisions, Walk};
use super::unknowns::{CONSTANTS, Constants, SLOW, SLOW_RANGES, Slow};

/// Places in a row of the factor: the part's own slow states, the next part's, and the constants.
const NEXT: usize = SLOW;
const BORDER: usize = 2 * SLOW;
const ROW: usize = BORDER + CONSTANTS;

type Rows = [[f64; ROW]; SLOW];

/// Data and priors, factorised.
pub struct Factor {
    /// The upper factor of each part's own states, with what it has in common with the next part and the constants.
    rows: Vec<Rows>,
    constants: Cholesky<f64, Const<CONSTANTS>>,
}

/// What is known of the slow states of a part.
pub struct SlowCovariance {
    pub own: SlowMatrix,
    pub with_constants: Between,
    /// With the part after it; `None` of the last.
    pub with_next: Option<SlowMatrix>,
}

impl Factor {
    /// `None` where a direction stays free.
    pub fn new(data: &Data, precision: &Constants, priors: &SlowPrecisions) -> Option<Self> {
        let mut rows: Vec<Rows> = Vec::with_capacity(data.own.len());
        let (constants, _) =
            factorise_chain(data, precision, priors, |_, block| rows.push(*block))?;
        Some(Self { rows, constants })
    }

    /// The logarithm of the determinant, less the one of the slow priors, and `gᵀH⁻¹g` of a gradient g with the normal matrix H of data and priors. Of the factor no more
    /// than one part is there at a time.
    pub fn explained(
        data: &Data,
        precision: &Constants,
        priors: &SlowPrecisions,
        gradient: &Columns<1>,
    ) -> Option<[f64; 2]> {
        let by_row = |slow: &Slow| slow.transpose().data.0;
        let mut own = gradient.slow.first().map(by_row)?;
        let mut rest = gradient.constants.transpose().data.0;
        let mut explained = 0.0;
        let (constants, log_determinant) =
            factorise_chain(data, precision, priors, |part, block| {
                let mut next = gradient.slow.get(part + 1).map(by_row);
                forward(block, &mut own, next.as_mut(), &mut rest);
                explained += own.iter().map(|[value]| value * value).sum::<f64>();
                own = next.unwrap_or(own);
            })?;
        let rest = Constants::from_column_slice(rest.as_flattened());
        explained += rest.dot(&constants.solve(&rest));
        Some([log_determinant, explained])
    }

    /// Gives its room away; what it says of the constants stays.
    pub fn forget(&mut self) {
        self.rows = Vec::new();
    }

    /// Covariance of the constants.
    pub fn of_constants(&self) -> Square {
        self.constants.inverse()
    }

    pub fn solve<const K: usize>(&self, right: &Columns<K>) -> Columns<K> {
        // By row, so that all columns are solved at once.
        let mut slow: Vec<[[f64; K]; SLOW]> =
            right.slow.iter().map(|slow| slow.transpose().data.0).collect();
        let mut constants = right.constants.transpose().data.0;
        for (part, rows) in self.rows.iter().enumerate() {
            let (own, next) = slow[part..].split_first_mut().expect("a part");
            forward(rows, own, next.first_mut(), &mut constants);
        }
        let mut known =
            SMatrix::<f64, K, CONSTANTS>::from_data(ArrayStorage(constants)).transpose();
        self.constants.solve_mut(&mut known);
        let constants = known.transpose().data.0;
        for (part, rows) in self.rows.iter().enumerate().rev() {
            let (own, next) = slow[part..].split_first_mut().expect("a part");
            backward(rows, own, next.first(), &constants);
        }
        let by_column = |rows| SMatrix::<f64, K, SLOW>::from_data(ArrayStorage(rows)).transpose();
        Columns { slow: slow.into_iter().map(by_column).collect(), constants: known }
    }

    /// Covariance of how the states that walk do so to each part but the first from the one before it.
    pub fn of_walks(&self) -> Vec<Walk> {
        let walking =
            |block: &SlowMatrix| block.fixed_view::<SLOW_RANGES, SLOW_RANGES>(0, 0).into_owned();
        let mut walks = vec![Walk::zeros(); self.rows.len().saturating_sub(1)];
        let mut after: Option<SlowMatrix> = None;
        self.each_covariance(|part, found| {
            if let (Some(next), Some(with_next)) = (after, &found.with_next) {
                let across = walking(with_next);
                walks[part] = walking(&next) + walking(&found.own) - across - across.transpose();
            }
            after = Some(found.own);
        });
        walks
    }

    /// Shows the covariance of each part's slow states, from the last part back.
    ///
    /// Only the blocks of the inverse that this takes (Rauch, Tung & Striebel 1965).
    pub fn each_covariance(&self, mut show: impl FnMut(usize, &SlowCovariance)) {
        let by_constants = self.of_constants();
        let mut after: Option<SlowCovariance> = None;
        for (part, rows) in self.rows.iter().enumerate().rev() {
            let own = SlowMatrix::from_fn(|i, j| if j < i { 0.0 } else { rows[i][j] });
            let inverse = own
                .solve_upper_triangular(&SlowMatrix::identity())
                .unwrap_or_else(SlowMatrix::identity);
            // The part's states are `forward` times the next one's, `aside` times the constants, and noise.
            let forward = -inverse * SlowMatrix::from_fn(|i, j| rows[i][NEXT + j]);
            let aside = -inverse * Between::from_fn(|i, j| rows[i][BORDER + j]);
            let noise = inverse * inverse.transpose();
            let mut with_constants = aside * by_constants;
            let mut covariance = noise;
            let with_next = after.as_ref().map(|next| {
                with_constants += forward * next.with_constants;
                forward * next.own + aside * next.with_constants.transpose()
            });
            covariance += with_constants * aside.transpose();
            if let Some(with_next) = &with_next {
                covariance += with_next * forward.transpose();
            }
            let found = SlowCovariance { own: covariance, with_constants, with_next };
            show(part, &found);
            after = Some(found);
        }
    }
}

/// Shows the rows of each part in turn; the factor of the constants, and the logarithm of the determinant less the one of the
/// slow priors. `None` where a direction stays free.
fn factorise_chain(
    data: &Data,
    precision: &Constants,
    priors: &SlowPrecisions,
    mut show: impl FnMut(usize, &Rows),
) -> Option<(Cholesky<f64, Const<CONSTANTS>>, f64)> {
    let mut gram = [[0.0; CONSTANTS]; CONSTANTS];
    let mut log_determinant = -priors.log_determinant;
    let mut before: Option<Rows> = None;
    for part in 0..data.own.len() {
        let own = data.own[part] + priors.own(part);
        let next = data.with_next[part] + priors.with_next(part);
        let border = &data.with_constants[part];
        let mut block = [[0.0; ROW]; SLOW];
        for (i, row) in block.iter_mut().enumerate() {
            for j in 0..SLOW {
                row[j] = own[(i, j)];
                row[NEXT + j] = next[(i, j)];
            }
            for j in 0..CONSTANTS {
                row[BORDER + j] = border[(i, j)];
            }
        }
        if let Some(before) = &before {
            subtract(before, &mut block);
        }
        if !factorise(&mut block) {
            return None;
        }
        add_gram(&mut gram, &block);
        log_determinant += (0..SLOW).map(|i| 2.0 * block[i][i].ln()).sum::<f64>();
        show(part, &block);
        before = Some(block);
    }
    let gram = Square::from_fn(|i, j| gram[i.min(j)][i.max(j)]);
    let constants = data.constants + Square::from_diagonal(precision) - gram;
    let constants = constants.cholesky()?;
    log_determinant += 2.0 * constants.ln_determinant_of_root();
    log_determinant.is_finite().then_some((constants, log_determinant))
}

/// Solves for a part's own rows, and takes them out of what comes after.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+fma", "x86_64+avx2+fma"))]
fn forward<const K: usize>(
    rows: &Rows,
    own: &mut [[f64; K]; SLOW],
    mut next: Option<&mut [[f64; K]; SLOW]>,
    constants: &mut [[f64; K]; CONSTANTS],
) {
    for (m, row) in rows.iter().enumerate() {
        let (value, after) = own[m..].split_first_mut().expect("a row");
        value.iter_mut().for_each(|value| *value /= row[m]);
        for (factor, other) in row[m + 1..SLOW].iter().zip(after) {
            subtract_times(other, *factor, value);
        }
        if let Some(next) = next.as_deref_mut() {
            for (factor, other) in row[NEXT..BORDER].iter().zip(next) {
                subtract_times(other, *factor, value);
            }
        }
        for (factor, other) in row[BORDER..].iter().zip(constants.iter_mut()) {
            subtract_times(other, *factor, value);
        }
    }
}

/// Solves for a part's own rows, all after it being known.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+fma", "x86_64+avx2+fma"))]
fn backward<const K: usize>(
    rows: &Rows,
    own: &mut [[f64; K]; SLOW],
    next: Option<&[[f64; K]; SLOW]>,
    constants: &[[f64; K]; CONSTANTS],
) {
    for (m, row) in rows.iter().enumerate().rev() {
        let (value, after) = own[m..].split_first_mut().expect("a row");
        for (factor, other) in row[BORDER..].iter().zip(constants) {
            subtract_times(value, *factor, other);
        }
        for (factor, other) in row[NEXT..BORDER].iter().zip(next.into_iter().flatten()) {
            subtract_times(value, *factor, other);
        }
        for (factor, other) in row[m + 1..SLOW].iter().zip(after) {
            subtract_times(value, *factor, other);
        }
        value.iter_mut().for_each(|value| *value /= row[m]);
    }
}

#[inline(always)]
fn subtract_times<const K: usize>(from: &mut [f64; K], factor: f64, values: &[f64; K]) {
    for k in 0..K {
        from[k] -= factor * values[k];
    }
}

/// Subtracts what an eliminated part says of the next one.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+fma", "x86_64+avx2+fma"))]
fn subtract(before: &Rows, block: &mut Rows) {
    for (r, row) in block.iter_mut().enumerate() {
        let mut sum = *row;
        for from in before {
            let factor = from[NEXT + r];
            for j in 0..SLOW {
                sum[j] -= factor * from[NEXT + j];
            }
            for j in BORDER..ROW {
                sum[j] -= factor * from[j];
            }
        }
        *row = sum;
    }
}

/// Adds the products of a part's border with itself, above the diagonal.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+fma", "x86_64+avx2+fma"))]
fn add_gram(gram: &mut [[f64; CONSTANTS]; CONSTANTS], rows: &Rows) {
    for (i, sum) in gram.iter_mut().enumerate() {
        for row in rows {
            let factor = row[BORDER + i];
            for j in 0..CONSTANTS {
                sum[j] += factor * row[BORDER + j];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::slow_priors::{SlowPriors, Wander};
    use super::*;
    use rand::{RngExt, SeedableRng};

    const PARTS: usize = 5;

    #[test]
    fn walks_are_as_certain_as_their_solutions_say() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        let mut any = || rng.random_range(-1.0..1.0);
        let slow = |any: &mut dyn FnMut() -> f64| SlowMatrix::from_fn(|_, _| any());
        let data = Data {
            own: (0..PARTS)
                .map(|_| {
                    let root = slow(&mut any);
                    root * root.transpose() + SlowMatrix::identity() * 30.0
                })
                .collect(),
            with_next: (0..PARTS).map(|_| slow(&mut any)).collect(),
            with_constants: (0..PARTS).map(|_| Between::from_fn(|_, _| any())).collect(),
            constants: Square::identity() * 300.0,
            gradient: Columns::zeros(PARTS),
        };
        let priors = SlowPriors {
            settling: SMatrix::identity(),
            clocks_s2: 2.0,
            wander: Wander { sigma_m: 0.5, correlation_s: 5.0 },
            restarts_s: Vec::new(),
            restarted_s2: 1.0,
            station_steps: vec![2],
            clock_steps: vec![3],
        };
        let times_s: Vec<f64> = (0..PARTS).map(|part| 6.0 * part as f64).collect();
        let priors = SlowPrecisions::new(&priors, &times_s).expect("nothing is known exactly");
        let factor = Factor::new(&data, &Constants::repeat(1.0), &priors).expect("definite");
        let walks = factor.of_walks();
        assert_eq!(walks.len(), PARTS - 1);
        for (index, found) in walks.iter().enumerate() {
            let mut walked = Columns::<SLOW_RANGES>::zeros(PARTS);
            for k in 0..SLOW_RANGES {
                walked.slow[index + 1][(k, k)] = 1.0;
                walked.slow[index][(k, k)] = -1.0;
            }
            let expected = walked.dot(&factor.solve(&walked));
            assert!((found - expected).amax() < 1e-12, "{index}: {found} {expected}");
        }
    }
}
