//! Solutions of a GNSS receiver, as the readers of all formats return them.

use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

use resect_core::deployment::Finding;
use resect_core::geometry::Geodetic;

/// Kind of a solution, the most accurate first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SolutionKind {
    /// Carrier phases with integer ambiguities: centimetres.
    Fixed,
    /// Corrections of a ground station; the message does not distinguish fixed from float (`STATUS_GBAS_FIX`).
    GroundAugmented,
    /// Precise point positioning.
    Ppp,
    /// Carrier phases with real ambiguities: decimetres.
    Float,
    /// Code phases with corrections (DGPS, SBAS): decimetres to metres.
    Differential,
    /// Code phases of one receiver: metres.
    Single,
    /// Dead reckoning, or typed in.
    NotMeasured,
    /// The file does not state the kind.
    Unstated,
}

impl SolutionKind {
    /// Word before "solutions".
    pub fn word(self) -> &'static str {
        match self {
            Self::Fixed => "fixed",
            Self::GroundAugmented => "ground-augmented (GBAS)",
            Self::Ppp => "PPP",
            Self::Float => "float",
            Self::Differential => "differential",
            Self::Single => "single",
            Self::NotMeasured => "estimated (dead reckoning)",
            Self::Unstated => "unclassified",
        }
    }

    /// Returns true for kinds with errors of decimetres or more.
    pub fn is_coarse(self) -> bool {
        matches!(self, Self::Float | Self::Differential | Self::Single | Self::NotMeasured)
    }
}

/// Kinds of solutions that are a ground truth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SolutionChoice {
    /// The most accurate kind of the file: fixed solutions, if there are any.
    #[default]
    Best,
    /// Fixed and float solutions, and those between them.
    Float,
    All,
}

impl SolutionChoice {
    /// Returns true if solutions of a kind are used in a file whose most accurate kind is `best`.
    fn uses(self, kind: SolutionKind, best: SolutionKind) -> bool {
        match self {
            Self::Best => kind == best,
            Self::Float => kind == best || kind <= SolutionKind::Float,
            Self::All => true,
        }
    }
}

/// Position of a solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SolutionPosition {
    Geodetic(Geodetic),
    /// Earth-centred, Earth-fixed (m).
    Ecef(Vector3<f64>),
    /// East, north, up of a base station (m).
    Baseline(Vector3<f64>),
}

impl SolutionPosition {
    /// Earth-centred, Earth-fixed coordinates (m), or those of the baseline.
    pub fn cartesian_m(self) -> Vector3<f64> {
        match self {
            Self::Geodetic(geodetic) => geodetic.to_ecef(),
            Self::Ecef(position_m) | Self::Baseline(position_m) => position_m,
        }
    }
}

/// A position of an antenna.
#[derive(Clone, Debug, PartialEq)]
pub struct GnssSolution {
    /// Unix time (s).
    pub time_s: f64,
    pub position: SolutionPosition,
    pub kind: SolutionKind,
    /// Covariance along east, north and up (m²); `None` if the file does not state it.
    pub covariance_m2: Option<Matrix3<f64>>,
}

/// The solutions of one receiver in the order of the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GnssTrack {
    pub solutions: Vec<GnssSolution>,
    /// Number of records that say that there is no solution.
    pub without_fix: usize,
    pub findings: Vec<Finding>,
}

impl GnssTrack {
    /// Removes the solutions that a choice does not use. Returns the number of solutions of each kind, the most accurate first; true for the kinds
    /// that remain.
    pub fn choose(&mut self, choice: SolutionChoice) -> Vec<(usize, SolutionKind, bool)> {
        let mut kinds: Vec<SolutionKind> =
            self.solutions.iter().map(|solution| solution.kind).collect();
        kinds.sort();
        let Some(best) = kinds.first().copied() else { return Vec::new() };
        self.solutions.retain(|solution| choice.uses(solution.kind, best));
        let counts = kinds.chunk_by(|a, b| a == b);
        counts.map(|same| (same.len(), same[0], choice.uses(same[0], best))).collect()
    }
}

/// Returns the covariance of three axes by their standard deviations (m) and the square roots of the covariances, with their signs.
/// The roots are those of axes 1 and 2, 2 and 3, 3 and 1. `None` if a standard deviation is not positive.
///
/// Rounded square roots may exceed what the standard deviations allow. The covariances are then left out.
pub fn covariance_of_roots(sigma_m: [f64; 3], roots_m: [f64; 3]) -> Option<Matrix3<f64>> {
    if !sigma_m.iter().all(|sigma_m| sigma_m.is_finite() && *sigma_m > 0.0) {
        return None;
    }
    let diagonal = Matrix3::from_diagonal(&Vector3::from(sigma_m.map(|sigma_m| sigma_m * sigma_m)));
    let mut covariance = diagonal;
    for ((row, column), root_m) in [(0, 1), (1, 2), (2, 0)].into_iter().zip(roots_m) {
        covariance[(row, column)] = root_m * root_m.abs();
        covariance[(column, row)] = root_m * root_m.abs();
    }
    let is_covariance = covariance.iter().all(|value| value.is_finite())
        && covariance.symmetric_eigenvalues().iter().all(|value| *value > 0.0);
    Some(if is_covariance { covariance } else { diagonal })
}

/// Returns a position by degrees and height (m); `None` if there is none on the Earth.
pub fn geodetic_of_degrees(
    latitude_deg: f64,
    longitude_deg: f64,
    height_m: f64,
) -> Option<Geodetic> {
    let is_on_earth = latitude_deg.abs() <= 90.0
        && longitude_deg.abs() <= 360.0
        && height_m.abs() <= LARGEST_HEIGHT_M;
    is_on_earth.then(|| Geodetic {
        latitude_rad: latitude_deg.to_radians(),
        longitude_rad: longitude_deg.to_radians(),
        height_m,
    })
}

/// Largest height of a receiver above or below the ellipsoid (m). A larger one is an error of the file or its unit. Textbook: satellites of
/// GNSS are 2e7 m high, receivers in low orbits up to 2e6 m.
const LARGEST_HEIGHT_M: f64 = 2e6;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn square_roots_of_covariances_have_signs() {
        let covariance =
            covariance_of_roots([0.01, 0.02, 0.03], [-0.005, 0.01, 0.0]).expect("positive");
        assert_eq!((covariance[(0, 0)], covariance[(2, 2)]), (1e-4, 9e-4));
        assert!((covariance[(0, 1)] + 2.5e-5).abs() < 1e-12);
        assert!((covariance[(2, 1)] - 1e-4).abs() < 1e-12);
        // Rounded to 0.1 mm, the covariance exceeds the variances.
        let rounded = covariance_of_roots([1e-4, 1e-4, 1e-4], [2e-4, 0.0, 0.0]).expect("positive");
        assert_eq!(rounded, Matrix3::from_diagonal_element(1e-8));
        assert_eq!(covariance_of_roots([0.0, 0.02, 0.03], [0.0; 3]), None);
        assert_eq!(covariance_of_roots([f64::NAN, 0.02, 0.03], [0.0; 3]), None);
    }

    #[test]
    fn positions_beyond_the_earth_are_refused() {
        assert!(geodetic_of_degrees(46.8, -71.2, 95.0).is_some());
        for [latitude, longitude, height] in
            [[90.1, 0.0, 0.0], [0.0, 361.0, 0.0], [0.0, 0.0, 1e7], [f64::NAN, 0.0, 0.0]]
        {
            assert_eq!(geodetic_of_degrees(latitude, longitude, height), None);
        }
    }
}
