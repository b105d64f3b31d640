//! Robust losses by their influence ψ, the derivative of the loss. Errors have the unit of the bend or scale, usually σ.

/// Bend of Huber's loss between its quadratic and its linear range (σ): 95 % as efficient as least squares on normal errors.
/// The loss is from Huber 1964, "Robust estimation of a location parameter", the number from Holland & Welsch 1977.
pub const HUBER_BEND: f64 = 1.345;

/// Influence of an error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Influence {
    /// ψ(x)/x: the weight of the squared error.
    pub weight: f64,
    /// ψ'(x).
    pub slope: f64,
}

/// Influence of the squared loss.
pub const SQUARED: Influence = Influence { weight: 1.0, slope: 1.0 };

/// Returns the influence of Huber's loss, which is linear beyond the bend.
pub fn huber(size: f64, bend: f64) -> Influence {
    if size > bend { Influence { weight: bend / size, slope: 0.0 } } else { SQUARED }
}

/// Returns the influence of Cauchy's loss: half weight at the scale, and a decreasing influence beyond it.
pub fn cauchy(size: f64, scale: f64) -> Influence {
    let square = (size / scale).powi(2);
    let weight = 1.0 / (1.0 + square);
    Influence { weight, slope: (1.0 - square) * weight * weight }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns E[ψ']² / E[ψ²] of normal errors: the efficiency relative to least squares.
    fn efficiency(influence: impl Fn(f64) -> Influence) -> f64 {
        let (mut slope, mut square) = (0.0, 0.0);
        let step = 1e-3;
        for k in 0..10_000 {
            let size = (f64::from(k) + 0.5) * step;
            let chance = (-0.5 * size * size).exp() * step * (2.0 / std::f64::consts::PI).sqrt();
            let Influence { weight, slope: here } = influence(size);
            slope += chance * here;
            square += chance * (weight * size).powi(2);
        }
        slope * slope / square
    }

    #[test]
    fn bends_are_as_efficient_as_they_say() {
        let huber_s = efficiency(|size| huber(size, HUBER_BEND));
        assert!((huber_s - 0.95).abs() < 1e-3, "{huber_s}");
        let cauchy_s = efficiency(|size| cauchy(size, 2.385));
        assert!((cauchy_s - 0.95).abs() < 1e-3, "{cauchy_s}");
    }

    #[test]
    fn slopes_are_the_differences_of_pulls() {
        for influence in [huber, cauchy] {
            let pull = |size: f64| influence(size, 1.3).weight * size;
            for size in [0.2, 1.0, 1.29, 1.31, 2.0, 7.0] {
                let numeric = (pull(size + 1e-6) - pull(size - 1e-6)) / 2e-6;
                assert!((numeric - influence(size, 1.3).slope).abs() < 1e-6, "{size}");
            }
        }
    }
}
