//! The parts of a drive and what is constant over all of them: which constants, and which slow changes, explain the parts
//! best, and how certain that is.
//!
//! Each part has its information about its own unknowns and about the next part's ([`super::band`]). These move with the
//! constants θ and with slow states s of the part ([`super::unknowns::moves`]). Priors: constants have theirs; stations
//! and clocks walk randomly from part to part; ranges wander as an Ornstein–Uhlenbeck process. The slow states are
//! eliminated along the chain, as in a Kalman smoother (Rauch, Tung & Striebel 1965).

use multiversion::multiversion;
use nalgebra::{ArrayStorage, Cholesky, Const, SMatrix};
use rayon::prelude::*;

use super::band::{PART, Part, factorise};
use super::unknowns::{CONSTANTS, Constants, SLOW, SLOW_CLOCKS, SLOW_RANGES, Slow};

type SlowMatrix = SMatrix<f64, SLOW, SLOW>;
/// A matrix of the states that walk: stations and clocks.
pub type Walk = SMatrix<f64, SLOW_RANGES, SLOW_RANGES>;
type Between = SMatrix<f64, SLOW, CONSTANTS>;
type Square = SMatrix<f64, CONSTANTS, CONSTANTS>;

/// Steps that were found are taken to be this many times the variance of a whole drive.
const STEP: f64 = 1e4;

/// How ranges wander: one standard deviation (m) of a process that forgets within some seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wander {
    pub sigma_m: f64,
    pub correlation_s: f64,
}

/// What is known of slow changes beforehand.
#[derive(Clone, Debug)]
pub struct SlowPriors {
    /// Variance of how far (x, y, z, yaw) of stations 2 and 3 walk during the whole drive (m², rad²).
    pub settling: SMatrix<f64, 8, 8>,
    /// Variance of how far the clocks of stations 2 and 3 walk during the whole drive (s²).
    pub clocks_s2: f64,
    pub wander: Wander,
    /// When further drives begin (s): stations may have settled since as during a drive, and clocks are their own, with
    /// this variance (s²).
    pub restarts_s: Vec<f64>,
    pub restarted_s2: f64,
    /// Parts before which stations, or clocks, did what no prior expects.
    pub station_steps: Vec<usize>,
    pub clock_steps: Vec<usize>,
}

/// One part, linear about where everything is taken to be.
pub struct Link<'a> {
    pub part: &'a Part,
    /// Whether the next part belongs to the same stretch.
    pub tied_to_next: bool,
    pub by_constants: &'a SMatrix<f64, PART, CONSTANTS>,
    pub by_slow: &'a SMatrix<f64, PART, SLOW>,
}

/// A right-hand side, or a solution: `K` columns for each part's slow states and for the constants.
#[derive(Clone, Debug)]
pub struct Columns<const K: usize> {
    pub slow: Vec<SMatrix<f64, SLOW, K>>,
    pub constants: SMatrix<f64, CONSTANTS, K>,
}

impl<const K: usize> Columns<K> {
    pub fn zeros(parts: usize) -> Self {
        Self { slow: vec![SMatrix::zeros(); parts], constants: SMatrix::zeros() }
    }

    pub fn dot<const L: usize>(&self, other: &Columns<L>) -> SMatrix<f64, K, L> {
        let of_slow = self.slow.iter().zip(&other.slow).map(|(a, b)| a.tr_mul(b));
        of_slow.fold(self.constants.tr_mul(&other.constants), |sum, part| sum + part)
    }
}

/// The priors of the slow states as precisions: of each, and of each with the next one.
pub struct SlowPrecisions {
    own: Vec<SlowMatrix>,
    with_next: Vec<SlowMatrix>,
    log_determinant: f64,
}

impl SlowPrecisions {
    /// Precisions of the slow states of parts at these times (s); `None` where something is known exactly.
    pub fn new(priors: &SlowPriors, time_s: &[f64]) -> Option<Self> {
        let restarts = |part: usize| {
            part > 0
                && priors.restarts_s.iter().any(|at| (time_s[part - 1]..time_s[part]).contains(at))
        };
        let paused_s: f64 = (0..time_s.len())
            .filter(|part| restarts(*part))
            .map(|part| time_s[part] - time_s[part - 1])
            .sum();
        let drives = (priors.restarts_s.len() + 1) as f64;
        // A whole drive.
        let whole_s = ((time_s.last()? - time_s.first()? - paused_s) / drives).max(1.0);
        let settled = priors.settling.cholesky()?;
        let (settling, settled) = (settled.inverse(), 2.0 * settled.ln_determinant_of_root());
        let mut own = vec![SlowMatrix::zeros(); time_s.len()];
        let mut with_next = vec![SlowMatrix::zeros(); time_s.len()];
        let mut log_determinant = 0.0;
        let variance_m2 = priors.wander.sigma_m.powi(2);
        for part in 0..time_s.len() {
            let since_s = match part {
                // From the set-up to the first part.
                0 => 0.5 * whole_s * drives / time_s.len() as f64,
                _ => time_s[part] - time_s[part - 1],
            };
            let usual = if restarts(part) { 1.0 } else { (since_s / whole_s).max(1e-4) };
            let share = |steps: &[usize]| if steps.contains(&part) { STEP } else { usual };
            let (stations, clocks) = (share(&priors.station_steps), share(&priors.clock_steps));
            let clocks_s2 =
                if restarts(part) { priors.restarted_s2 } else { clocks * priors.clocks_s2 };
            let mut step = SlowMatrix::zeros();
            step.fixed_view_mut::<8, 8>(0, 0).copy_from(&(settling / stations));
            for clock in SLOW_CLOCKS..SLOW_RANGES {
                step[(clock, clock)] = clocks_s2.recip();
            }
            own[part] += step;
            log_determinant -= settled + 8.0 * stations.ln() + 2.0 * clocks_s2.ln();
            let kept = if part == 0 { 0.0 } else { (-since_s / priors.wander.correlation_s).exp() };
            let fresh = 1.0 / (variance_m2 * (1.0 - kept * kept).max(1e-6));
            for range in SLOW_RANGES..SLOW {
                own[part][(range, range)] += fresh;
                log_determinant += fresh.ln();
            }
            if part > 0 {
                own[part - 1] += step;
                with_next[part - 1] -= step;
                for range in SLOW_RANGES..SLOW {
                    own[part - 1][(range, range)] += kept * kept * fresh;
                    with_next[part - 1][(range, range)] -= kept * fresh;
                }
            }
        }
        Some(Self { own, with_next, log_determinant })
    }

    /// These precisions as if slow states were known a thousand times better.
    pub fn stiffer(&self) -> Self {
        let more = |all: &[SlowMatrix]| all.iter().map(|matrix| matrix * 1e6).collect();
        let log_determinant = self.log_determinant;
        Self { own: more(&self.own), with_next: more(&self.with_next), log_determinant }
    }

    /// Precision of how stations 2 and 3 and their clocks walk to a part from the one before it.
    pub fn of_walk(&self, part: usize) -> Walk {
        -self.with_next[part - 1].fixed_view::<SLOW_RANGES, SLOW_RANGES>(0, 0)
    }

    /// Precision of how all that walks from the first part to the last; `None` where that is known exactly.
    pub fn of_whole_walk(&self) -> Option<Walk> {
        let mut covariance = Walk::zeros();
        for part in 1..self.own.len() {
            covariance += self.of_walk(part).cholesky()?.inverse();
        }
        Some(covariance.cholesky()?.inverse())
    }

    /// The product of the precisions and slow states.
    pub fn times<const K: usize>(
        &self,
        slow: &[SMatrix<f64, SLOW, K>],
    ) -> Vec<SMatrix<f64, SLOW, K>> {
        (0..slow.len())
            .map(|part| {
                let mut product = self.own[part] * slow[part];
                if part + 1 < slow.len() {
                    product += self.with_next[part] * slow[part + 1];
                }
                if part > 0 {
                    product += self.with_next[part - 1].tr_mul(&slow[part - 1]);
                }
                product
            })
            .collect()
    }
}

trait LnDeterminant {
    fn ln_determinant_of_root(&self) -> f64;
}

impl<const N: usize> LnDeterminant for Cholesky<f64, Const<N>>
where
    Const<N>: nalgebra::DimMin<Const<N>>,
{
    fn ln_determinant_of_root(&self) -> f64 {
        let root = self.l_dirty();
        (0..N).map(|i| root[(i, i)].ln()).sum()
    }
}

/// What the data says of the constants and the slow states, without any prior.
pub struct Data {
    own: Vec<SlowMatrix>,
    with_next: Vec<SlowMatrix>,
    with_constants: Vec<Between>,
    pub constants: Square,
    pub gradient: Columns<1>,
}

/// What the data says of one part.
struct OfPart {
    own: SlowMatrix,
    with_next: SlowMatrix,
    with_constants: Between,
    constants: Square,
    gradient: (Slow, Constants),
}

impl Data {
    pub fn of(links: &[Link<'_>]) -> Self {
        let one = |index: usize| {
            let link = &links[index];
            // Products with a transpose that is written out are several times faster than `tr_mul`.
            let (by_slow, by_constants) = (link.by_slow.transpose(), link.by_constants.transpose());
            let mut moved = link.part.information * link.by_constants;
            let mut coupling = SlowMatrix::zeros();
            if link.tied_to_next {
                let next = &links[index + 1];
                moved += link.part.with_next * next.by_constants;
                coupling = by_slow * (link.part.with_next * next.by_slow);
            }
            if let Some(before) = index.checked_sub(1).map(|i| &links[i]).filter(|l| l.tied_to_next)
            {
                moved += before.part.with_next.transpose() * before.by_constants;
            }
            OfPart {
                own: by_slow * (link.part.information * link.by_slow),
                with_next: coupling,
                with_constants: by_slow * moved,
                constants: by_constants * moved,
                gradient: (by_slow * link.part.gradient, by_constants * link.part.gradient),
            }
        };
        let parts: Vec<OfPart> = (0..links.len()).into_par_iter().map(one).collect();
        let mut data = Self {
            own: Vec::with_capacity(parts.len()),
            with_next: Vec::with_capacity(parts.len()),
            with_constants: Vec::with_capacity(parts.len()),
            constants: Square::zeros(),
            gradient: Columns::zeros(parts.len()),
        };
        for (index, part) in parts.into_iter().enumerate() {
            data.own.push(part.own);
            data.with_next.push(part.with_next);
            data.with_constants.push(part.with_constants);
            data.constants += part.constants;
            data.gradient.slow[index] = part.gradient.0;
            data.gradient.constants += part.gradient.1;
        }
        // Rounding must not make it lopsided.
        data.constants = 0.5 * (data.constants + data.constants.transpose());
        data
    }

    /// Another gradient, by part about slow states and constants.
    pub fn exchange_gradient(&mut self, parts: impl Iterator<Item = (Slow, Constants)>) {
        self.gradient.constants.fill(0.0);
        for (own, (slow, constants)) in self.gradient.slow.iter_mut().zip(parts) {
            *own = slow;
            self.gradient.constants += constants;
        }
    }

    /// The product of this normal matrix and a solution.
    pub fn times<const K: usize>(&self, columns: &Columns<K>) -> Columns<K> {
        let mut product = Columns::zeros(self.own.len());
        product.constants = self.constants * columns.constants;
        for part in 0..self.own.len() {
            product.constants += self.with_constants[part].tr_mul(&columns.slow[part]);
            let slow = &mut product.slow[part];
            *slow =
                self.with_constants[part] * columns.constants + self.own[part] * columns.slow[part];
            if part + 1 < self.own.len() {
                *slow += self.with_next[part] * columns.slow[part + 1];
            }
            if part > 0 {
                *slow += self.with_next[part - 1].tr_mul(&columns.slow[part - 1]);
            }
        }
        product
    }
}

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
    /// Logarithm of the determinant, less the one of the slow priors.
    pub log_determinant: f64,
}

impl Factor {
    /// `None` where a direction stays free.
    pub fn new(data: &Data, precision: &Constants, priors: &SlowPrecisions) -> Option<Self> {
        let mut rows: Vec<Rows> = vec![[[0.0; ROW]; SLOW]; data.own.len()];
        let mut gram = [[0.0; CONSTANTS]; CONSTANTS];
        let mut log_determinant = -priors.log_determinant;
        for part in 0..data.own.len() {
            let own = data.own[part] + priors.own[part];
            let next = data.with_next[part] + priors.with_next[part];
            let border = &data.with_constants[part];
            let (before, block) = rows[..=part].split_at_mut(part);
            let block = &mut block[0];
            for (i, row) in block.iter_mut().enumerate() {
                for j in 0..SLOW {
                    row[j] = own[(i, j)];
                    row[NEXT + j] = next[(i, j)];
                }
                for j in 0..CONSTANTS {
                    row[BORDER + j] = border[(i, j)];
                }
            }
            if let Some(before) = before.last() {
                subtract(before, block);
            }
            if !factorise(block) {
                return None;
            }
            add_gram(&mut gram, block);
            log_determinant += (0..SLOW).map(|i| 2.0 * block[i][i].ln()).sum::<f64>();
        }
        let gram = Square::from_fn(|i, j| gram[i.min(j)][i.max(j)]);
        let constants = data.constants + Square::from_diagonal(precision) - gram;
        let constants = constants.cholesky()?;
        log_determinant += 2.0 * constants.ln_determinant_of_root();
        log_determinant.is_finite().then_some(Self { rows, constants, log_determinant })
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
}

impl Factor {
    /// Covariance of how the states that walk do so to each part but the first from the one before it.
    ///
    /// Only the blocks of the inverse that this takes, from the last part back (Rauch, Tung & Striebel 1965).
    pub fn of_walks(&self) -> Vec<Walk> {
        let by_constants = self.of_constants();
        let walking =
            |block: &SlowMatrix| block.fixed_view::<SLOW_RANGES, SLOW_RANGES>(0, 0).into_owned();
        let mut walks = vec![Walk::zeros(); self.rows.len().saturating_sub(1)];
        // Of the part after: its own covariance, and with the constants.
        let mut after: Option<(SlowMatrix, Between)> = None;
        for (part, rows) in self.rows.iter().enumerate().rev() {
            let own = SlowMatrix::from_fn(|i, j| if j < i { 0.0 } else { rows[i][j] });
            let inverse = own
                .solve_upper_triangular(&SlowMatrix::identity())
                .unwrap_or_else(SlowMatrix::identity);
            // The part's states are `forward` times the next one's, `aside` times the constants, and noise.
            let forward = -inverse * SlowMatrix::from_fn(|i, j| rows[i][NEXT + j]);
            let aside = -inverse * Between::from_fn(|i, j| rows[i][BORDER + j]);
            let noise = inverse * inverse.transpose();
            let with_constants = aside * by_constants;
            after = Some(match after {
                None => (noise + with_constants * aside.transpose(), with_constants),
                Some((next, next_with_constants)) => {
                    let with_constants = with_constants + forward * next_with_constants;
                    let with_next = forward * next + aside * next_with_constants.transpose();
                    let covariance = noise
                        + with_next * forward.transpose()
                        + with_constants * aside.transpose();
                    let across = walking(&with_next);
                    walks[part] =
                        walking(&next) + walking(&covariance) - across - across.transpose();
                    (covariance, with_constants)
                }
            });
        }
        walks
    }
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
        let none = vec![SlowMatrix::zeros(); PARTS];
        let priors = SlowPrecisions { own: none.clone(), with_next: none, log_determinant: 0.0 };
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
