//! Medians, quantiles, and robust estimates of spread.
//!
//! A quantile is the linear interpolation between order statistics (definition 7 of Hyndman & Fan 1996, "Sample quantiles in
//! statistical packages"), as in numpy. The median of an even count is therefore the mean of the middle two. Lists must not contain
//! NaN.

/// σ of normal errors over the median of their absolute values: 1/Φ⁻¹(3/4).
const SIGMA_OVER_MEDIAN_SIZE: f64 = 1.482_602_218_505_602;
/// Probability that a normal error is below −σ, and that it is above σ: Φ(−1).
const BELOW_MINUS_SIGMA: f64 = 0.158_655_253_931_457;

/// Returns the median; `None` of an empty list.
pub fn median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    quantiles(values, [0.5]).map(|[median]| median)
}

/// Returns the quantiles for shares in increasing order; `None` of an empty list.
pub fn quantiles<const N: usize>(
    values: impl IntoIterator<Item = f64>,
    shares: [f64; N],
) -> Option<[f64; N]> {
    debug_assert!(shares.is_sorted());
    let mut keys: Vec<i64> = values.into_iter().map(key).collect();
    let last = keys.len().checked_sub(1)?;
    // A selection moves greater values to the right, where the next selection searches.
    let mut first = 0;
    Some(shares.map(|share| {
        let rank = share * last as f64;
        let (_, low, above) = keys[first..].select_nth_unstable(rank as usize - first);
        first = rank as usize;
        let low = value(*low);
        between(low, rank, || above.iter().min().map_or(low, |key| value(*key)))
    }))
}

/// Returns a quantile of a sorted list; `None` of an empty list.
pub fn quantile_of_sorted(sorted: &[f64], share: f64) -> Option<f64> {
    let last = sorted.len().checked_sub(1)?;
    let rank = share * last as f64;
    let low = rank as usize;
    Some(between(sorted[low], rank, || sorted[(low + 1).min(last)]))
}

/// Returns σ of errors about zero from the median of their absolute values, for normal errors; `None` of an empty list.
pub fn sigma_of_errors(errors: impl IntoIterator<Item = f64>) -> Option<f64> {
    Some(SIGMA_OVER_MEDIAN_SIZE * median(errors.into_iter().map(f64::abs))?)
}

/// Returns σ of values about any centre, as half the width of their middle 68 %; `None` of an empty list.
pub fn central_sigma(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let [low, high] = quantiles(values, [BELOW_MINUS_SIGMA, 1.0 - BELOW_MINUS_SIGMA])?;
    Some(0.5 * (high - low))
}

/// Interpolates between the values at the ranks below and above a fractional rank. The second is computed only if it has a weight.
fn between(low: f64, rank: f64, high: impl FnOnce() -> f64) -> f64 {
    match rank.fract() {
        0.0 => low,
        share => low + (high() - low) * share,
    }
}

/// Returns an integer that sorts like the float ([`f64::total_cmp`]) and is selected faster.
fn key(value: f64) -> i64 {
    flip_negative(value.to_bits() as i64)
}

fn value(key: i64) -> f64 {
    f64::from_bits(flip_negative(key) as u64)
}

/// Flips the bits of negative floats, which otherwise sort in reverse.
fn flip_negative(bits: i64) -> i64 {
    bits ^ (((bits >> 63) as u64) >> 1) as i64
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn quantiles_are_numpy_s() {
        // numpy.quantile([-7, 1, 3, -10], [0, 0.25, 0.5, 0.75, 1]) = [-10, -7.75, -3, 1.5, 3]
        let found = quantiles([-7.0, 1.0, 3.0, -10.0], [0.0, 0.25, 0.5, 0.75, 1.0]);
        assert_eq!(found, Some([-10.0, -7.75, -3.0, 1.5, 3.0]));
        assert_eq!(median([4.0, -1.0]), Some(1.5));
        assert_eq!(median([9.0, -1.0, 4.0]), Some(4.0));
        assert_eq!(median([]), None);
    }

    #[test]
    fn spreads_of_normal_errors_are_their_sigma_and_wild_ones_hardly_widen_them() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let mut errors: Vec<f64> = (0..40_000).map(|_| 0.02 * normal()).collect();
        // Both have a σ of 0.8 % here.
        let about_zero = |errors: &[f64]| sigma_of_errors(errors.iter().copied()).expect("many");
        let about_any =
            |errors: &[f64]| central_sigma(errors.iter().map(|e| e + 5.0)).expect("many");
        for sigma in [about_zero(&errors), about_any(&errors)] {
            assert!((sigma / 0.02 - 1.0).abs() < 0.025, "{sigma}");
        }
        errors.iter_mut().step_by(20).for_each(|error| *error = 1e3);
        for sigma in [about_zero(&errors), about_any(&errors)] {
            assert!((1.0..1.2).contains(&(sigma / 0.02)), "{sigma}");
        }
    }

    proptest! {
        #[test]
        fn selected_and_sorted_are_the_same(
            mut values in proptest::collection::vec(-5.0..5.0f64, 1..40),
            mut shares in [0.0..=1.0f64, 0.0..=1.0f64, 0.0..=1.0f64],
        ) {
            shares.sort_by(f64::total_cmp);
            let selected = quantiles(values.iter().copied(), shares).expect("not empty");
            values.sort_by(f64::total_cmp);
            let sorted = shares.map(|share| quantile_of_sorted(&values, share).expect("not empty"));
            prop_assert_eq!(selected, sorted);
            prop_assert!(selected.is_sorted());
        }
    }
}
