//! Tabulated quantiles.

/// Half width of the central 95 % of a normal distribution, in σ: Φ⁻¹(0.975).
pub const NORMAL_95: f64 = 1.96;

/// 95 % quantile of χ² with three degrees of freedom.
pub const CHI_SQUARE_95_OF_3: f64 = 7.815;

/// 95 % quantile of χ² with eight degrees of freedom.
pub const CHI_SQUARE_95_OF_8: f64 = 15.507;
