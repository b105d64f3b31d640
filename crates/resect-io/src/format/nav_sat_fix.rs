//! Fixes of `sensor_msgs/NavSatFix`: kind by their status, and covariances.
//!
//! `status` is -1 without a fix, 0 for a fix, 1 with satellite-based and 2 with ground-based augmentation. Drivers write 2 for fixed
//! and float solutions alike. `position_covariance_type` is 0 unknown, 1 approximated from DOP, 2 with known diagonal, 3 known.

use nalgebra::Matrix3;

use super::bag::messages::NavSatFix;
use crate::findings::gnss::gnss_sigma_approximated;
use crate::findings::tracks::rows_skipped;
use crate::gnss_solution::{
    GnssSolution, GnssTrack, SolutionKind, SolutionPosition, geodetic_of_degrees,
};
use crate::skipped_rows::SkippedRows;

/// Covariance of a fix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FixCovariance {
    Unknown,
    /// Derived from the dilution of precision, which is no standard deviation.
    Approximated,
    /// East, north, up (m²).
    Known(Matrix3<f64>),
}

impl FixCovariance {
    /// Returns the covariance of nine elements, row by row, and their type.
    pub fn of_elements(elements_m2: &[f64; 9], covariance_type: u8) -> Self {
        let matrix = Matrix3::from_row_slice(elements_m2);
        let diagonal = Matrix3::from_diagonal(&matrix.diagonal());
        let covariance = if covariance_type == 2 { diagonal } else { matrix };
        let is_valid = covariance.iter().all(|value| value.is_finite())
            && covariance.diagonal().iter().all(|variance| *variance > 0.0)
            && covariance.symmetric_eigenvalues().iter().all(|value| *value > 0.0);
        match covariance_type {
            1 => Self::Approximated,
            2 | 3 if is_valid => Self::Known(covariance),
            _ => Self::Unknown,
        }
    }
}

/// Returns the kind of a status; `None` without a fix.
pub fn kind_of_status(status: i64) -> Option<SolutionKind> {
    match status {
        -1 => None,
        0 => Some(SolutionKind::Single),
        1 => Some(SolutionKind::Differential),
        2 => Some(SolutionKind::GroundAugmented),
        _ => Some(SolutionKind::Unstated),
    }
}

/// Returns the solutions of the messages of a topic; positions that are not on the Earth are skipped and counted.
///
/// Status 0 of all messages says nothing: many drivers write no other.
pub fn track(file: &str, fixes: &[NavSatFix]) -> GnssTrack {
    let (mut track, mut skipped, mut approximated) =
        (GnssTrack::default(), SkippedRows::default(), 0);
    for (index, fix) in fixes.iter().enumerate() {
        let kind =
            fix.status.map_or(Some(SolutionKind::Unstated), |status| kind_of_status(status.into()));
        let [latitude_deg, longitude_deg] = fix.degrees;
        // Drivers write zeros or NaN before the first fix.
        let is_unset = latitude_deg.is_nan() || (latitude_deg, longitude_deg) == (0.0, 0.0);
        let Some(kind) = kind.filter(|_| !is_unset) else {
            track.without_fix += 1;
            continue;
        };
        let geodetic = geodetic_of_degrees(latitude_deg, longitude_deg, fix.altitude_m);
        let Some((geodetic, time_s)) = geodetic.zip(fix.stamp_s) else {
            skipped.add(index + 1, "latitude, longitude or altitude beyond the Earth's".to_owned());
            continue;
        };
        let covariance = FixCovariance::of_elements(&fix.covariance_m2, fix.covariance_type);
        let covariance_m2 = match covariance {
            FixCovariance::Known(covariance_m2) => Some(covariance_m2),
            FixCovariance::Approximated | FixCovariance::Unknown => None,
        };
        approximated += usize::from(covariance == FixCovariance::Approximated);
        let position = SolutionPosition::Geodetic(geodetic);
        track.solutions.push(GnssSolution { time_s, position, kind, covariance_m2 });
    }
    forget_constant_single(&mut track.solutions);
    track.findings.extend(rows_skipped(file, &skipped));
    if approximated > 0 {
        track.findings.push(gnss_sigma_approximated(file, approximated));
    }
    track
}

/// Sets the kind of solutions to unstated if all have the status 0.
pub fn forget_constant_single(solutions: &mut [GnssSolution]) {
    if solutions.iter().all(|solution| solution.kind == SolutionKind::Single) {
        solutions.iter_mut().for_each(|solution| solution.kind = SolutionKind::Unstated);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fix(status: i8, covariance_type: u8) -> NavSatFix {
        NavSatFix {
            stamp_s: Some(1_657_569_001.0),
            status: Some(status),
            degrees: [46.78, -71.27],
            altitude_m: 95.0,
            covariance_m2: [1e-4, 2e-5, 0.0, 2e-5, 1e-4, 0.0, 0.0, 0.0, 4e-4],
            covariance_type,
        }
    }

    #[test]
    fn the_type_decides_if_a_covariance_is_one() {
        let of_type = |covariance_type| track("a.bag", &[fix(2, covariance_type)]);
        assert_eq!(of_type(0).solutions[0].covariance_m2, None);
        let approximated = of_type(1);
        assert_eq!(approximated.solutions[0].covariance_m2, None);
        let said = approximated.findings[0].to_string();
        assert!(said.contains("1 covariances are approximated from the dilution"), "{said}");
        let east_north =
            |track: GnssTrack| track.solutions[0].covariance_m2.expect("known")[(0, 1)];
        assert_eq!((east_north(of_type(2)), east_north(of_type(3))), (0.0, 2e-5));
        let mut zeros = fix(2, 3);
        zeros.covariance_m2 = [0.0; 9];
        assert_eq!(track("a.bag", &[zeros]).solutions[0].covariance_m2, None);
    }

    #[test]
    fn the_status_decides_the_kind() {
        let mut unset = fix(0, 0);
        unset.degrees = [0.0, 0.0];
        let mut far = fix(0, 0);
        far.degrees = [460.0, 0.0];
        let track = track("a.bag", &[fix(-1, 0), unset, fix(0, 0), fix(1, 0), fix(2, 0), far]);
        let kinds: Vec<_> = track.solutions.iter().map(|solution| solution.kind).collect();
        use SolutionKind::{Differential, GroundAugmented, Single};
        assert_eq!(kinds, [Single, Differential, GroundAugmented]);
        assert_eq!(track.without_fix, 2);
        let said = track.findings[0].to_string();
        assert!(said.contains("1 row is not valid") && said.contains("line 6"), "{said}");
        let constant = super::track("a.bag", &[fix(0, 0), fix(0, 0)]);
        assert_eq!(constant.solutions[1].kind, SolutionKind::Unstated);
    }
}
