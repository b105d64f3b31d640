//! Units of surveyors in SI.

/// An arcsecond (rad).
pub const ARCSECOND_RAD: f64 = std::f64::consts::PI / 180.0 / 3600.0;

/// Arcseconds in a radian.
pub const ARCSECONDS_PER_RAD: f64 = 3600.0_f64.to_degrees();

/// The international foot (m).
pub const FOOT_M: f64 = 0.3048;

/// The US survey foot (m).
pub const US_SURVEY_FOOT_M: f64 = 1200.0 / 3937.0;
