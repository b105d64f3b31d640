//! Median and quartiles.

use serde::{Deserialize, Serialize};

use crate::statistics::quantiles;

/// Median and quartiles of a list.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    pub median: f64,
    pub q25: f64,
    pub q75: f64,
    pub iqr: f64,
    pub n: usize,
}

impl Spread {
    /// Spread of the absolute values; `None` without values.
    pub fn of(sizes: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut n = 0;
        let counted = sizes.into_iter().inspect(|_| n += 1).map(f64::abs);
        let [q25, median, q75] = quantiles(counted, [0.25, 0.5, 0.75])?;
        Some(Self { median, q25, q75, iqr: q75 - q25, n })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn quartiles_are_numpy_s() {
        let spread = Spread::of(vec![3.0, 1.0]).expect("two");
        assert_eq!((spread.q25, spread.median, spread.q75), (1.5, 2.0, 2.5));
        // numpy.percentile([7, 1, 3, 10], [25, 50, 75]) = [2.5, 5.0, 7.75]
        let spread = Spread::of(vec![7.0, 1.0, 3.0, 10.0]).expect("four");
        assert_eq!((spread.q25, spread.median, spread.q75), (2.5, 5.0, 7.75));
        assert_eq!(Spread::of(vec![]), None);
    }

    proptest! {
        #[test]
        fn quartiles_are_ordered_and_scale(values in proptest::collection::vec(0.0..5.0f64, 1..40)) {
            let spread = Spread::of(values.clone()).expect("not empty");
            prop_assert!(spread.q25 <= spread.median && spread.median <= spread.q75);
            let twice = Spread::of(values.iter().map(|v| 2.0 * v)).expect("not empty");
            prop_assert!((twice.iqr - 2.0 * spread.iqr).abs() < 1e-12);
        }
    }
}
