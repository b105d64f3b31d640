//! Which constants, and which slow changes, explain the parts of a drive best, and how certain that is.
//!
//! Data and priors make one normal matrix. The slow states are eliminated along the chain, as in a Kalman smoother (Rauch,
//! Tung & Striebel 1965), which leaves the constants. Of a long drive the rows of the factor are not kept but made again,
//! some parts at a time.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

use nalgebra::{ArrayStorage, Cholesky, Const, SMatrix};

use super::chain::{AT_ONCE, Between, Columns, Data, MOST_KEPT_PARTS, Square};
use super::chain_rows::{BORDER, Elimination, NEXT, Rows, backward, forward, next_rows};
use super::slow_priors::{SlowMatrix, SlowPrecisions, Walk};
use super::unknowns::{CONSTANTS, Constants, SLOW, SLOW_RANGES};

/// Data and priors, factorised.
pub struct Factor {
    data: Arc<Data>,
    pub priors: SlowPrecisions,
    /// Rows of the first parts.
    kept: Vec<Rows>,
    /// The rows before those of each chunk of parts, from which its own are made again where they are not kept.
    before: Vec<Option<Rows>>,
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
    /// Factorises, and solves for a right-hand side on the way; `None` where a direction stays free.
    pub fn new<const K: usize>(
        data: &Arc<Data>,
        precision: &Constants,
        priors: &SlowPrecisions,
        right: Columns<K>,
    ) -> Option<(Self, Columns<K>)> {
        let (mut kept, mut before) = (Vec::new(), Vec::new());
        let mut elimination = Elimination::new(priors);
        let mut sought = Sought::new(right);
        for some in data.chunks() {
            before.push(elimination.before);
            for (part, block) in some.clone().zip(data.blocks(some).iter()) {
                let rows = elimination.eliminate(block, part)?;
                sought.forward(part, rows);
                if part < MOST_KEPT_PARTS {
                    kept.push(*rows);
                }
            }
        }
        let (constants, _) = elimination.constants(&data.constants, precision)?;
        let (data, priors) = (Arc::clone(data), priors.clone());
        let factor = Self { data, priors, kept, before, constants };
        let found = factor.backward(sought);
        Some((factor, found))
    }

    /// The parts in their order, some at a time.
    fn chunks(&self) -> impl DoubleEndedIterator<Item = Range<usize>> + use<> {
        self.data.chunks()
    }

    /// The upper factor of each of some parts' own states, with what it has in common with the next part and the constants.
    fn rows(&self, parts: Range<usize>) -> Cow<'_, [Rows]> {
        if let Some(kept) = self.kept.get(parts.clone()) {
            return Cow::Borrowed(kept);
        }
        let mut before = self.before[parts.start / AT_ONCE];
        let blocks = self.data.blocks(parts.clone());
        // What was positive definite when the same was done before is so now.
        let rows = |(part, block)| {
            before = next_rows(block, &self.priors, part, before.as_ref());
            before
        };
        parts.zip(blocks.iter()).map_while(rows).collect()
    }

    /// Covariance of the constants.
    pub fn of_constants(&self) -> Square {
        self.constants.inverse()
    }

    /// The solution for a right-hand side, in its room.
    pub fn solve<const K: usize>(&self, right: Columns<K>) -> Columns<K> {
        let mut sought = Sought::new(right);
        for some in self.chunks() {
            let rows = self.rows(some.clone());
            some.zip(rows.iter()).for_each(|(part, rows)| sought.forward(part, rows));
        }
        self.backward(sought)
    }

    /// The solution of what all parts have been taken out of.
    fn backward<const K: usize>(&self, sought: Sought<K>) -> Columns<K> {
        let Sought { mut slow, constants } = sought;
        let by_column = SMatrix::<f64, K, CONSTANTS>::from_data(ArrayStorage(constants));
        let mut known = by_column.transpose();
        self.constants.solve_mut(&mut known);
        let constants = known.transpose().data.0;
        for some in self.chunks().rev() {
            for (part, rows) in some.clone().zip(self.rows(some).iter()).rev() {
                let (own, next) = slow[part..].split_first_mut().expect("a part");
                backward(rows, own, next.first(), &constants);
            }
        }
        let by_column = |rows| SMatrix::<f64, K, SLOW>::from_data(ArrayStorage(rows)).transpose();
        Columns { slow: slow.into_iter().map(by_column).collect(), constants: known }
    }

    /// Covariance of how the states that walk do so to each part but the first from the one before it.
    pub fn of_walks(&self) -> Vec<Walk> {
        let walking =
            |block: &SlowMatrix| block.fixed_view::<SLOW_RANGES, SLOW_RANGES>(0, 0).into_owned();
        let mut walks = vec![Walk::zeros(); self.data.len().saturating_sub(1)];
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
        for some in self.chunks().rev() {
            for (part, rows) in some.clone().zip(self.rows(some).iter()).rev() {
                let found = covariance(rows, after.as_ref(), &by_constants);
                show(part, &found);
                after = Some(found);
            }
        }
    }
}

/// A right-hand side that parts are taken out of; by row, so that all columns are solved at once.
struct Sought<const K: usize> {
    slow: Vec<[[f64; K]; SLOW]>,
    constants: [[f64; K]; CONSTANTS],
}

impl<const K: usize> Sought<K> {
    fn new(right: Columns<K>) -> Self {
        let by_row = |slow: SMatrix<f64, SLOW, K>| slow.transpose().data.0;
        Self {
            slow: right.slow.into_iter().map(by_row).collect(),
            constants: right.constants.transpose().data.0,
        }
    }

    fn forward(&mut self, part: usize, rows: &Rows) {
        let (own, next) = self.slow[part..].split_first_mut().expect("a part");
        forward(rows, own, next.first_mut(), &mut self.constants);
    }
}

/// What is known of a part's slow states, from its rows, what is known of the part after it, and the covariance of the
/// constants.
fn covariance(
    rows: &Rows,
    after: Option<&SlowCovariance>,
    by_constants: &Square,
) -> SlowCovariance {
    let own = SlowMatrix::from_fn(|i, j| if j < i { 0.0 } else { rows[i][j] });
    let inverse =
        own.solve_upper_triangular(&SlowMatrix::identity()).unwrap_or_else(SlowMatrix::identity);
    // The part's states are `forward` times the next one's, `aside` times the constants, and noise.
    let forward = -inverse * SlowMatrix::from_fn(|i, j| rows[i][NEXT + j]);
    let aside = -inverse * Between::from_fn(|i, j| rows[i][BORDER + j]);
    let noise = inverse * inverse.transpose();
    let mut with_constants = aside * by_constants;
    let mut covariance = noise;
    let with_next = after.map(|next| {
        with_constants += forward * next.with_constants;
        forward * next.own + aside * next.with_constants.transpose()
    });
    covariance += with_constants * aside.transpose();
    if let Some(with_next) = &with_next {
        covariance += with_next * forward.transpose();
    }
    SlowCovariance { own: covariance, with_constants, with_next }
}

#[cfg(test)]
mod tests {
    use nalgebra::SMatrix;
    use rand::{RngExt, SeedableRng};

    use super::super::band::Part;
    use super::super::band_rows::PART;
    use super::super::chain::tests::without_kept;
    use super::super::drive::Drive;
    use super::super::moves::Moves;
    use super::super::slow_priors::{SlowPriors, Wander};
    use super::super::unknowns::Outlook;
    use super::*;

    /// A drive of parts that all look elsewhere and have any information, as one chain.
    fn chain(parts: usize) -> (Data, SlowPrecisions) {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        let mut any = || rng.random_range(-1.0..1.0);
        let mut outlook = || {
            let mut vector = || nalgebra::Vector3::from_fn(|_, _| any());
            Outlook { along: vector(), point_m: vector(), up_m: vector(), side_m: vector() }
        };
        let drive = Drive {
            pieces: Vec::new(),
            outlooks: (0..parts).map(|_| std::array::from_fn(|_| outlook())).collect(),
            part_times_s: (0..parts).map(|part| 6.0 * part as f64).collect(),
            tied_to_next: (0..parts).map(|part| part % 3 < 2 && part + 1 < parts).collect(),
            spans_s: vec![[0.0, 6.0 * parts as f64]],
        };
        let mut matrix = || SMatrix::<f64, PART, PART>::from_fn(|_, _| any());
        let all = (0..parts).map(|_| {
            let root = matrix();
            let information = root * root.transpose() + SMatrix::identity() * 30.0;
            Part { information, with_next: matrix(), ..Part::NOTHING }
        });
        let all: Vec<Part> = all.collect();
        let priors = SlowPriors {
            settling: SMatrix::identity(),
            clocks_s2: 2.0,
            wander: Wander { sigma_m: 0.5, correlation_s: 5.0 },
            restarts_s: Vec::new(),
            restarted_s2: 1.0,
            station_steps: vec![2],
            clock_steps: vec![3],
        };
        let priors = SlowPrecisions::new(&priors, &drive.part_times_s);
        let moves = Moves::about(&Arc::new(drive), &Constants::zeros());
        (Data::new(all, moves), priors.expect("nothing is known exactly"))
    }

    #[test]
    fn walks_are_as_certain_as_their_solutions_say() {
        const PARTS: usize = 5;
        let (data, priors) = chain(PARTS);
        let data = Arc::new(data);
        let any = Columns::<1>::zeros(PARTS);
        let (factor, _) =
            Factor::new(&data, &Constants::repeat(1.0), &priors, any).expect("definite");
        let walks = factor.of_walks();
        assert_eq!(walks.len(), PARTS - 1);
        for (index, found) in walks.iter().enumerate() {
            let mut walked = Columns::<SLOW_RANGES>::zeros(PARTS);
            for k in 0..SLOW_RANGES {
                walked.slow[index + 1][(k, k)] = 1.0;
                walked.slow[index][(k, k)] = -1.0;
            }
            let solved = factor.solve(walked);
            let expected = solved.slow[index + 1] - solved.slow[index];
            let expected = expected.fixed_rows::<SLOW_RANGES>(0);
            assert!((found - expected).amax() < 1e-12, "{index}: {found} {expected}");
        }
    }

    #[test]
    fn a_solution_solves_the_normal_equations() {
        let (data, priors) = chain(7);
        let data = Arc::new(data);
        let precision = Constants::repeat(2.0);
        let mut right = Columns::<1>::zeros(7);
        right.slow.iter_mut().for_each(|slow| slow.fill(0.7));
        right.constants.fill(-0.3);
        let (factor, found) =
            Factor::new(&data, &precision, &priors, right.clone()).expect("definite");
        assert_eq!(found.slow, factor.solve(right.clone()).slow);
        // xᵀHx is xᵀ times the right-hand side.
        let by_priors: f64 =
            (0..7).map(|part| found.slow[part].dot(&priors.pull(&found.slow, part))).sum();
        let square = data.squares(&found)[0]
            + found.constants.dot(&found.constants.component_mul(&precision))
            + by_priors;
        let pulled: f64 = found.slow.iter().zip(&right.slow).map(|(a, b)| a.dot(b)).sum();
        let pulled = pulled + found.constants.dot(&right.constants);
        assert!((square - pulled).abs() < 1e-9 * pulled.abs(), "{square} {pulled}");
    }

    #[test]
    fn what_is_made_again_is_what_was_kept() {
        let parts = 2 * AT_ONCE + 7;
        let (data, priors) = chain(parts);
        let kept = Arc::new(data);
        let again = Arc::new(without_kept(&kept));
        let precision = Constants::repeat(2.0);
        let mut right = Columns::<2>::zeros(parts);
        right.slow.iter_mut().enumerate().for_each(|(part, slow)| slow.fill(part as f64));
        let of = |data| Factor::new(data, &precision, &priors, right.clone()).expect("definite");
        let ((factor, by), (mut other, by_other)) = (of(&kept), of(&again));
        other.kept = Vec::new();
        assert_eq!(by_other.slow, other.solve(right.clone()).slow);
        assert_eq!((&by.slow, &by.constants), (&by_other.slow, &by_other.constants));
        assert_eq!(kept.squares(&by), again.squares(&by));
        assert_eq!(factor.of_walks(), other.of_walks());
    }
}
