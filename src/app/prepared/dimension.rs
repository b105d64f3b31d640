//! Dimensions of the values that are plotted over time.

/// The dimension of a value, and the unit in which it is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    /// Stored in metres.
    Length,
    /// A standard deviation of a position: stored in metres, shown in millimetres.
    LengthSigma,
    /// Stored in radians.
    Angle,
    /// A standard deviation of an angle: stored in radians, shown in milliradians or arcseconds.
    AngleSigma,
    /// Stored in degrees per second, as the thresholds are.
    AngleRate,
    /// Stored and shown in a unit of its own.
    Other(&'static str),
}
