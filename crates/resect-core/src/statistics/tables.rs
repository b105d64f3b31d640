//! Tabulated quantiles.

/// Half width of the central 95 % of a normal distribution, in σ: Φ⁻¹(0.975).
pub const NORMAL_95: f64 = 1.96;

/// 95 % quantile of χ² with two degrees of freedom.
pub const CHI_SQUARE_95_OF_2: f64 = 5.991;

/// 95 % quantile of χ² with three degrees of freedom.
pub const CHI_SQUARE_95_OF_3: f64 = 7.815;

/// 95 % quantile of χ² with eight degrees of freedom.
pub const CHI_SQUARE_95_OF_8: f64 = 15.507;

/// Returns the quantile of Student's t that has the probability of some σ of a normal distribution: of 3 σ it is 3.96 with 10 degrees of
/// freedom. The expansion of Abramowitz & Stegun (26.7.5) is within 3 % from 4 degrees on.
pub fn student_sigmas(normal_sigmas: f64, degrees_of_freedom: f64) -> f64 {
    let (x, inverse) = (normal_sigmas, 1.0 / degrees_of_freedom.max(1.0));
    let square = x * x;
    let first = (square + 1.0) / 4.0;
    let second = ((5.0 * square + 16.0) * square + 3.0) / 96.0;
    let third = (((3.0 * square + 19.0) * square + 17.0) * square - 15.0) / 384.0;
    x * (1.0 + inverse * (first + inverse * (second + inverse * third)))
}

/// Probability with which the largest of several numbers exceeds [`largest_normal`] or [`largest_chi_square_of_4`] by chance.
const LARGEST: f64 = 1e-3;

/// Returns the size (σ) that the largest of `count` normal numbers exceeds with a probability of 0.1 %: 3.3 of one, 4.4 of a hundred.
pub fn largest_normal(count: usize) -> f64 {
    let odds = 2.0 * count.max(1) as f64 / (LARGEST * std::f64::consts::TAU.sqrt());
    // The tail beyond x is e^(−x²/2) / √(2π) x⁻¹ (1 − x⁻² + …).
    (0..8).fold(4.0, |x: f64, _| (2.0 * (odds / x * (1.0 - x.powi(-2))).ln()).sqrt())
}

/// Returns the value that the largest of `count` χ² with four degrees of freedom exceeds with a probability of 0.1 %, if their common variance
/// is estimated from `numbers` others: 18.5 of one with a known variance.
pub fn largest_chi_square_of_4(count: usize, numbers: f64) -> f64 {
    let least = LARGEST / count.max(1) as f64;
    // The mean of e^(−x s / 2) (1 + x s / 2) over variances s that are χ² over its degrees of freedom.
    let probability = |x: f64| {
        let growth = 1.0 + x / numbers;
        growth.powf(-0.5 * numbers) * (1.0 + 0.5 * x / growth)
    };
    let (mut low, mut high) = (0.0, 1e4);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if probability(middle) > least { low = middle } else { high = middle }
    }
    high
}

/// Returns the probability that a normal variable is below a value in σ (Abramowitz & Stegun 26.2.17; error below 1e-7).
pub fn normal_probability(sigmas: f64) -> f64 {
    let t = 1.0 / (1.0 + 0.231_641_9 * sigmas.abs());
    let series = [1.330_274_429, -1.821_255_978, 1.781_477_937, -0.356_563_782, 0.319_381_530];
    let sum = series.into_iter().fold(0.0, |sum, factor| (sum + factor) * t);
    let above = sum * (-0.5 * sigmas * sigmas).exp() / std::f64::consts::TAU.sqrt();
    if sigmas < 0.0 { above } else { 1.0 - above }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_tables() {
        for (degrees, quantile) in [(4.0, 6.620), (5.0, 5.507), (10.0, 3.957), (23.0, 3.361)] {
            let sigmas = student_sigmas(3.0, degrees);
            assert!((sigmas / quantile - 1.0).abs() < 0.035, "{degrees}: {sigmas}");
        }
        for (count, sigmas) in [(1, 3.291), (10, 3.891), (100, 4.417), (1000, 4.892)] {
            assert!((largest_normal(count) - sigmas).abs() < 0.02, "{}", largest_normal(count));
        }
        for (count, chi_square) in [(1, 18.467), (10, 23.513)] {
            let quantile = largest_chi_square_of_4(count, 1e9);
            assert!((quantile - chi_square).abs() < 0.01, "{quantile}");
        }
        // Four times the 99.9 % quantile of F with 4 and 20 degrees of freedom.
        assert!((largest_chi_square_of_4(1, 20.0) - 4.0 * 7.096).abs() < 0.01);
        for (sigmas, probability) in [(0.0, 0.5), (1.96, 0.975_002), (-1.0, 0.158_655)] {
            assert!((normal_probability(sigmas) - probability).abs() < 1e-6, "{sigmas}");
        }
    }
}
