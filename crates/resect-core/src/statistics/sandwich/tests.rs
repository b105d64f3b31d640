//! Stated variances compared with the true ones, which are known exactly here, over many draws of the errors.

use super::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Numbers of independent blocks of time in drives of 40 s to 5 minutes.
const BLOCKS: [usize; 6] = [8, 12, 16, 20, 40, 60];
const ROWS: usize = 12;
const DESIGNS: usize = 6;
/// Variance of errors between −1 and 1, over the variance in the blocks' information.
const PHI: f64 = 1.0 / 3.0;

/// A kind of estimation problem.
struct Case {
    unknowns: usize,
    /// 1/σ² of the priors of the last unknowns.
    known: &'static [f64],
    /// Weight of the priors.
    weight: f64,
    /// Correlated error of all rows of a block, which the information ignores.
    shared: f64,
}

/// Two transforms.
const TRANSFORMS: Case = Case { unknowns: 8, known: &[], weight: 1.0, shared: 0.0 };
const ONE: Case = Case { unknowns: 1, ..TRANSFORMS };
/// Two transforms and clocks, with priors from weak, through as precise as the data, to far more precise.
const REFINED: Case =
    Case { unknowns: 16, known: &[3.0, 10.0, 30.0, 100.0, 1e4], weight: PHI, shared: 0.0 };

impl Case {
    fn prior(&self) -> Option<Prior> {
        let known = self.unknowns - self.known.len();
        let of = |k: usize| if k < known { 0.0 } else { self.known[k - known] };
        let precision = DVector::from_fn(self.unknowns, |k, _| of(k));
        (!self.known.is_empty()).then_some(Prior { precision, weight: self.weight })
    }

    /// Rows of each block, which scatter about a direction of its own, like the chords of one bend; some blocks are more
    /// informative than others.
    fn design(&self, blocks: usize, rng: &mut ChaCha8Rng) -> Vec<DMatrix<f64>> {
        (0..blocks)
            .map(|_| {
                let tells = rng.random_range(0.3..1.7);
                let about: Vec<f64> =
                    (0..self.unknowns).map(|_| rng.random_range(-1.0..1.0)).collect();
                DMatrix::from_fn(ROWS, self.unknowns, |_, k| {
                    tells * (about[k] + rng.random_range(-0.7..0.7))
                })
            })
            .collect()
    }
}

/// Function that states a covariance from the blocks at the minimum and the prior.
type Stated = fn(&[Block], Option<&Prior>) -> DMatrix<f64>;

/// Returns stated over true variance of each unknown, averaged over some designs.
fn stated_over_true(case: &Case, blocks: usize, state: Stated) -> DVector<f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(blocks as u64);
    let draws = (2400 / blocks).clamp(60, 200);
    let prior = case.prior();
    let mut ratios = DVector::zeros(case.unknowns);
    for _ in 0..DESIGNS {
        let design = case.design(blocks, &mut rng);
        let mut information: DMatrix<f64> = design.iter().map(|x| x.tr_mul(x)).sum();
        let mut pulls = PHI * &information;
        for x in &design {
            let alike = case.shared * x.row_sum().transpose();
            pulls += PHI * &alike * alike.transpose();
        }
        if let Some(Prior { precision, weight }) = &prior {
            information += DMatrix::from_diagonal(&(precision * *weight));
            pulls += DMatrix::from_diagonal(&(precision * (weight * weight)));
        }
        let inverse = information.cholesky().expect("full rank").inverse();
        let truth = &inverse * pulls * &inverse;
        let mut stated = DMatrix::zeros(case.unknowns, case.unknowns);
        for _ in 0..draws {
            let errors: Vec<DVector<f64>> = (0..blocks)
                .map(|_| {
                    let common = case.shared * rng.random_range(-1.0..1.0);
                    DVector::from_fn(ROWS, |_, _| common + rng.random_range(-1.0..1.0))
                })
                .collect();
            let mut pull: DVector<f64> = design.iter().zip(&errors).map(|(x, e)| x.tr_mul(e)).sum();
            if let Some(Prior { precision, weight }) = &prior {
                pull += precision.map(|precision| {
                    let normal: f64 = StandardNormal.sample(&mut rng);
                    weight * precision.sqrt() * normal
                });
            }
            let off = &inverse * pull;
            let at_minimum: Vec<Block> = design
                .iter()
                .zip(&errors)
                .map(|(x, e)| Block {
                    information: x.tr_mul(x),
                    gradient: x.tr_mul(&(e - x * &off)),
                })
                .collect();
            stated += state(&at_minimum, prior.as_ref()) / draws as f64;
        }
        ratios += stated.diagonal().component_div(&truth.diagonal()) / DESIGNS as f64;
    }
    ratios
}

fn ours(blocks: &[Block], prior: Option<&Prior>) -> DMatrix<f64> {
    covariance(blocks, prior).expect("held")
}

/// Returns the sandwich with uncorrected gradients of the blocks, times a factor.
fn with_factor(blocks: &[Block], prior: Option<&Prior>, factor: f64) -> DMatrix<f64> {
    let mut information: DMatrix<f64> = blocks.iter().map(|block| &block.information).sum();
    let mut middle: DMatrix<f64> =
        blocks.iter().map(|block| &block.gradient * block.gradient.transpose()).sum();
    middle *= factor;
    if let Some(Prior { precision, weight }) = prior {
        information += DMatrix::from_diagonal(&(precision * *weight));
        middle += DMatrix::from_diagonal(&(precision * (weight * weight)));
    }
    let inverse = information.cholesky().expect("held").inverse();
    &inverse * middle * &inverse
}

/// Sandwich with the factor B / (B − 1).
fn one_block_less(blocks: &[Block], prior: Option<&Prior>) -> DMatrix<f64> {
    let count = blocks.len() as f64;
    with_factor(blocks, prior, count / (count - 1.0))
}

/// Sandwich with the factor B / (B − n).
fn a_block_less_an_unknown(blocks: &[Block], prior: Option<&Prior>) -> DMatrix<f64> {
    let (count, unknowns) = (blocks.len(), blocks[0].gradient.len());
    with_factor(blocks, prior, count as f64 / count.saturating_sub(unknowns).max(1) as f64)
}

/// Returns (H/φ + P)⁻¹, for any weight of the prior.
fn as_if_the_prior_were_weighed(blocks: &[Block], prior: Option<&Prior>) -> DMatrix<f64> {
    let information: DMatrix<f64> = blocks.iter().map(|block| &block.information).sum();
    let precision = DMatrix::from_diagonal(&prior.expect("known").precision);
    (information / PHI + precision).cholesky().expect("held").inverse()
}

fn assert_true(case: &Case) {
    for blocks in BLOCKS {
        let ratios = stated_over_true(case, blocks, ours);
        let (mean, least, most) = (ratios.mean(), ratios.min(), ratios.max());
        assert!((0.96..1.05).contains(&mean), "{blocks} blocks: {mean:.3}");
        assert!(least > 0.9 && most < 1.1, "{blocks} blocks: {ratios:.3}");
    }
}

#[test]
fn stated_variances_of_one_unknown_are_the_true_ones() {
    assert_true(&ONE);
    let old = stated_over_true(&ONE, 8, one_block_less).mean();
    assert!(old < 0.9, "{old:.3}");
}

#[test]
fn stated_variances_of_two_transforms_are_the_true_ones() {
    assert_true(&TRANSFORMS);
    for blocks in [8, 16, 20] {
        let old = stated_over_true(&TRANSFORMS, blocks, one_block_less).mean();
        assert!(old < 0.9, "{blocks} blocks: {old:.3}");
    }
    let old = stated_over_true(&TRANSFORMS, 16, a_block_less_an_unknown).mean();
    assert!(old > 1.3, "{old:.3}");
}

#[test]
fn stated_variances_with_prior_knowledge_are_the_true_ones() {
    assert_true(&REFINED);
    for (blocks, too_large) in [(16, 8.0), (20, 3.0), (40, 1.25)] {
        let old = stated_over_true(&REFINED, blocks, a_block_less_an_unknown).mean();
        assert!(old > too_large, "{blocks} blocks: {old:.3}");
    }
}

#[test]
fn a_prior_need_not_be_weighed_by_the_noise() {
    let unweighed = Case { weight: 1.0, ..REFINED };
    for (blocks, most) in [(8, 1.1), (16, 1.06), (60, 1.05)] {
        let ratios = stated_over_true(&unweighed, blocks, ours);
        assert!(ratios.min() > 0.95 && ratios.max() < most, "{blocks} blocks: {ratios:.3}");
    }
    // Unknowns informed by both prior and data are less certain than with the weight φ of the prior.
    let old = stated_over_true(&unweighed, 16, as_if_the_prior_were_weighed);
    assert!(old.min() < 0.8, "{old:.3}");
}

/// With few blocks, the variance of errors that a block shares is not fully stated: the information ignores them.
#[test]
fn errors_that_a_block_shares_are_nearly_all_stated() {
    for (blocks, least) in [(16, 0.8), (20, 0.85), (40, 0.9), (60, 0.92)] {
        let ratio = stated_over_true(&Case { shared: 0.7, ..TRANSFORMS }, blocks, ours).mean();
        assert!((least..1.05).contains(&ratio), "{blocks} blocks: {ratio:.3}");
    }
}

#[test]
fn the_series_and_the_eigenvalues_agree() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let rows = DMatrix::<f64>::from_fn(4, 8, |_, _| rng.random_range(-1.0..1.0));
    let leverage = rows.tr_mul(&rows);
    let gradient = DVector::from_fn(8, |_, _| rng.random_range(-1.0..1.0));
    // The last two are on both sides of the limit beyond which eigenvalues are used.
    for size in [0.01, 0.099, 0.4, 0.699, 0.701] {
        let leverage = &leverage * (size / leverage.norm());
        let found = unfollowed(leverage.clone(), gradient.clone());
        let root = (DMatrix::identity(8, 8) - leverage).symmetric_eigen();
        let by_root = &root.eigenvectors
            * DMatrix::from_diagonal(&root.eigenvalues.map(|value| value.powf(-0.5)))
            * root.eigenvectors.transpose()
            * &gradient;
        assert!((found - by_root).norm() < 1e-10, "{size}");
    }
}

/// A redescending loss can make the information of a block negative, which a trace does not show.
#[test]
fn negative_information_is_no_leverage() {
    let leverage = DMatrix::from_diagonal(&DVector::from_vec(vec![0.5, -0.5]));
    let found = unfollowed(leverage, DVector::from_vec(vec![1.0, 1.0]));
    assert!((found[0] - 2.0_f64.sqrt()).abs() < 1e-12 && (found[1] - 1.0).abs() < 1e-12, "{found}");
}
