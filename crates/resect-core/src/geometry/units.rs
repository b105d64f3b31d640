//! Units of surveyors in SI.

/// An arcsecond (rad).
pub const ARCSECOND_RAD: f64 = std::f64::consts::PI / 180.0 / 3600.0;

/// The international foot (m).
pub const FOOT_M: f64 = 0.3048;

/// The US survey foot (m).
pub const US_SURVEY_FOOT_M: f64 = 1200.0 / 3937.0;
