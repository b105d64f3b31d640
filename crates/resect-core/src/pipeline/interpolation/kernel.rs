//! The squared-exponential kernel for many times at once, with vector instructions.

use multiversion::multiversion;

use crate::linear_algebra::dense_tiles::LANES;

/// Smallest exponent: e⁻¹⁰⁰ is negligible beside 1, and much smaller values are subnormal numbers, which are slow.
const LEAST_EXPONENT: f64 = -100.0;

/// Computes `exp(−(t − t_j)²/2ℓ²)` for times t_j, which fill whole vectors.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2"))]
pub fn correlations(t_s: f64, times_s: &[f64], length_scale_s: f64, found: &mut [f64]) {
    let scale = -0.5 / (length_scale_s * length_scale_s);
    for (found, times_s) in found.chunks_exact_mut(LANES).zip(times_s.chunks_exact(LANES)) {
        for l in 0..LANES {
            let apart_s = times_s[l] - t_s;
            found[l] = exp(scale * apart_s * apart_s);
        }
    }
}

/// Computes the same, and its derivative by `ln ℓ`, which is `(t − t_j)²/ℓ²` times the value.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2"))]
pub fn correlations_and_changes(
    t_s: f64,
    times_s: &[f64],
    length_scale_s: f64,
    found: &mut [f64],
    changes: &mut [f64],
) {
    let scale = -0.5 / (length_scale_s * length_scale_s);
    let both = found.chunks_exact_mut(LANES).zip(changes.chunks_exact_mut(LANES));
    for ((found, changes), times_s) in both.zip(times_s.chunks_exact(LANES)) {
        for l in 0..LANES {
            let apart_s = times_s[l] - t_s;
            let exponent = scale * apart_s * apart_s;
            found[l] = exp(exponent);
            changes[l] = -2.0 * exponent * found[l];
        }
    }
}

/// eˣ for x ≤ 0, accurate to about the last digit: 2ᵏ times the Taylor series of the remainder.
#[inline(always)]
fn exp(x: f64) -> f64 {
    /// 1.5·2⁵²: a sum with it is rounded to an integer.
    const WHOLE: f64 = 6_755_399_441_055_744.0;
    /// ln 2 as a sum of two terms; the first has so few digits that its multiples are exact.
    const LN_2: [f64; 2] = [0.693_147_180_369_123_8, 1.908_214_929_270_587_7e-10];
    /// 1/13!, 1/12!, … 1/2!.
    const SERIES: [f64; 12] = [
        1.0 / 6_227_020_800.0,
        1.0 / 479_001_600.0,
        1.0 / 39_916_800.0,
        1.0 / 3_628_800.0,
        1.0 / 362_880.0,
        1.0 / 40_320.0,
        1.0 / 5_040.0,
        1.0 / 720.0,
        1.0 / 120.0,
        1.0 / 24.0,
        1.0 / 6.0,
        0.5,
    ];
    let x = if x > LEAST_EXPONENT { x } else { LEAST_EXPONENT };
    let shifted = x * std::f64::consts::LOG2_E + WHOLE;
    let k = shifted - WHOLE;
    let rest = (x - k * LN_2[0]) - k * LN_2[1];
    let mut sum = SERIES[0];
    for i in 1..SERIES.len() {
        sum = sum * rest + SERIES[i];
    }
    let power = f64::from_bits((shifted.to_bits() << 52).wrapping_add(1.0_f64.to_bits()));
    power * (1.0 + (rest + rest * rest * sum))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponential_is_that_of_the_standard_library() {
        for i in 0..200_000 {
            let x = -100.0 * f64::from(i) / 200_000.0;
            assert!((exp(x) / x.exp() - 1.0).abs() < 4e-16, "{x}: {} and {}", exp(x), x.exp());
        }
        assert_eq!(exp(0.0), 1.0);
        assert!(exp(-1e300) < 1e-40 && exp(f64::NEG_INFINITY) < 1e-40);
    }

    #[test]
    fn correlations_change_with_the_length_scale_as_they_say() {
        let times_s: Vec<f64> = (0..24).map(|k| 0.4 * f64::from(k)).collect();
        let at = |length_scale_s: f64| {
            let (mut found, mut changes) = (vec![0.0; 24], vec![0.0; 24]);
            correlations_and_changes(3.1, &times_s, length_scale_s, &mut found, &mut changes);
            (found, changes)
        };
        let (found, changes) = at(2.0);
        let mut alone = vec![0.0; 24];
        correlations(3.1, &times_s, 2.0, &mut alone);
        assert_eq!(found, alone);
        let step = 1e-5;
        let (above, below) = (at(2.0 * f64::exp(step)).0, at(2.0 * f64::exp(-step)).0);
        for (i, t) in times_s.iter().enumerate() {
            assert!((found[i] - (-(t - 3.1).powi(2) / 8.0).exp()).abs() < 1e-15, "{t}");
            let numerical = (above[i] - below[i]) / (2.0 * step);
            assert!((changes[i] - numerical).abs() < 1e-8, "{t}: {} {numerical}", changes[i]);
        }
    }
}
