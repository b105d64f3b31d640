//! Tabulated quantiles.

/// Half width of the central 95 % of a normal distribution, in σ: Φ⁻¹(0.975).
pub const NORMAL_95: f64 = 1.96;

/// 95 % quantile of χ² with three degrees of freedom.
pub const CHI_SQUARE_95_OF_3: f64 = 7.815;

/// 95 % quantile of χ² with eight degrees of freedom.
pub const CHI_SQUARE_95_OF_8: f64 = 15.507;

/// Returns the quantile of Student's t that has the probability of 3 σ of a normal distribution: 9.2 with 3 degrees of freedom, 3.96
/// with 10. The expansion of Abramowitz & Stegun (26.7.5) is within 3 % from 4 degrees on.
pub fn student_three_sigma(degrees_of_freedom: f64) -> f64 {
    let inverse = 1.0 / degrees_of_freedom.max(1.0);
    3.0 + inverse * (7.5 + inverse * (17.25 + inverse * 30.19))
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
            let found = student_three_sigma(degrees);
            assert!((found / quantile - 1.0).abs() < 0.035, "{degrees}: {found}");
        }
        for (sigmas, probability) in [(0.0, 0.5), (1.96, 0.975_002), (-1.0, 0.158_655)] {
            assert!((normal_probability(sigmas) - probability).abs() < 1e-6, "{sigmas}");
        }
    }
}
