//! Numbers with their uncertainty.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::geometry::ARCSECONDS_PER_RAD;

/// A number with one standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    pub value: f64,
    pub sigma: f64,
}

impl Estimate {
    /// A number that is zero by definition, as each of the reference station.
    pub const ZERO: Self = Self { value: 0.0, sigma: 0.0 };

    /// Returns the difference from another value, in σ.
    pub fn sigmas_from(&self, other: f64) -> f64 {
        (self.value - other) / self.sigma.max(f64::MIN_POSITIVE)
    }

    /// Returns the length of a vector; its σ is that along the vector, without correlations.
    pub fn length_of(vector: &[Self; 3]) -> Self {
        let values = Vector3::from(vector.each_ref().map(|axis| axis.value));
        let value = values.norm();
        let along = values / value.max(1e-12);
        let sigma = (0..3).map(|k| (along[k] * vector[k].sigma).powi(2)).sum::<f64>().sqrt();
        Self { value, sigma }
    }
}

/// The dimension of an estimate, in SI units (m, rad, s, ratios).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Quantity {
    Length,
    Angle,
    Time,
    /// Seconds per second.
    Drift,
    /// Ratio to a range.
    Share,
    /// Curvature of a sight over that of the earth.
    Coefficient,
}

impl Quantity {
    /// Returns the SI unit.
    pub fn si_unit(self) -> &'static str {
        match self {
            Self::Length => "m",
            Self::Angle => "rad",
            Self::Time => "s",
            Self::Drift => "s/s",
            Self::Share | Self::Coefficient => "1",
        }
    }

    /// Returns the factor to the unit for display, and that unit.
    pub fn told(self) -> (f64, &'static str) {
        match self {
            Self::Length => (1e3, "mm"),
            Self::Angle => (ARCSECONDS_PER_RAD, "″"),
            Self::Time => (1e3, "ms"),
            Self::Drift => (1e6, "µs/s"),
            Self::Share => (1e6, "ppm"),
            Self::Coefficient => (1.0, "k"),
        }
    }
}

/// Estimates within this many σ of their reference are not significant.
pub const SUPPORTED_SIGMAS: f64 = 3.0;

/// Returns " (3.1 σ)", with a note that it is not significant where that is so.
pub fn sigmas_in_words(sigmas: f64) -> String {
    let sigmas = sigmas.abs();
    if sigmas > SUPPORTED_SIGMAS {
        format!(" ({sigmas:.1} σ)")
    } else {
        format!(" ({sigmas:.1} σ: not significant)")
    }
}

/// Returns the number of decimals that show two significant digits of a σ; `None` if it is zero or not finite.
pub fn decimals_of(sigma: f64) -> Option<usize> {
    if !(sigma.is_finite() && sigma > 0.0) {
        return None;
    }
    let decimals = 1 - sigma.log10().floor() as i32;
    // 0.0996 is written 0.10.
    let rounds_up = (sigma * 10_f64.powi(decimals)).round() >= 100.0;
    Some((decimals - i32::from(rounds_up)).clamp(0, 9) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_length_has_the_sigma_along_the_vector() {
        let axis = |value, sigma| Estimate { value, sigma };
        let length = Estimate::length_of(&[axis(3.0, 1.0), axis(-4.0, 0.0), axis(0.0, 9.0)]);
        assert!((length.value - 5.0).abs() < 1e-12 && (length.sigma - 0.6).abs() < 1e-12);
        assert_eq!(Estimate::length_of(&[axis(0.0, 1.0); 3]), axis(0.0, 0.0));
    }

    #[test]
    fn two_digits_of_sigma_are_shown() {
        let decimals = [0.0432, 0.0996, 0.37, 4.2, 99.6, 123.0].map(decimals_of);
        assert_eq!(decimals, [3, 2, 2, 1, 0, 0].map(Some));
        assert_eq!([0.0, f64::NAN, f64::INFINITY].map(decimals_of), [None; 3]);
    }
}
