//! A number with its uncertainty.

/// A number with one standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    pub value: f64,
    pub sigma: f64,
}

impl Estimate {
    /// How many σ it is from what it would be without estimating it.
    pub fn sigmas_from(&self, other: f64) -> f64 {
        (self.value - other) / self.sigma.max(f64::MIN_POSITIVE)
    }
}

/// Smaller than this many σ, an estimate is not told from what was assumed.
pub const SUPPORTED_SIGMAS: f64 = 2.0;

/// " (3.1 σ)", and where that is so, that it is not told from zero.
pub fn sigmas_in_words(sigmas: f64) -> String {
    let sigmas = sigmas.abs();
    if sigmas > SUPPORTED_SIGMAS {
        format!(" ({sigmas:.1} σ)")
    } else {
        format!(" ({sigmas:.1} σ: not told from zero)")
    }
}
