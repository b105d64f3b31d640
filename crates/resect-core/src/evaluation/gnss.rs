//! Distance errors between three GNSS antennas on the vehicle: the inter-prism metric for the sensor that the total stations
//! are compared with.

use crate::deployment::GnssFix;
use crate::network::Pair;

/// Quality of a fix with integer ambiguities, the only kind that is accurate to millimetres.
const FIXED: u8 = 1;

/// Largest difference of stamps within one epoch (s). Receivers measure on the seconds of GPS, with far smaller differences.
const SAME_EPOCH_S: f64 = 0.005;

/// Distances between the antennas, epoch by epoch.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InterAntenna {
    /// Apparent minus known distance (mm), for pairs 12, 13, 23; one value of each for every epoch.
    pub errors_mm: [Vec<f64>; 3],
    /// Epochs at which all three antennas have a fixed solution.
    pub epochs: usize,
    /// Epochs of all three antennas that are left out because a solution is not fixed.
    pub not_fixed: usize,
    /// Fixes left out because another antenna has none at that time.
    pub unmatched: usize,
}

/// Compares the fixes of antennas 1, 2, 3 with the known distances 12, 13, 23 (m).
///
/// The stamps of each antenna increase, and the positions are in one frame.
pub fn inter_antenna(fixes: [&[GnssFix]; 3], inter_antenna_m: &[f64; 3]) -> InterAntenna {
    let mut result = InterAntenna::default();
    let mut rest = fixes;
    while let [[first, ..], [second, ..], [third, ..]] = rest {
        let epoch = [first, second, third];
        let newest_s = epoch.iter().fold(f64::NEG_INFINITY, |newest, fix| newest.max(fix.time_s));
        let late = epoch.map(|fix| newest_s - fix.time_s > SAME_EPOCH_S);
        if late.contains(&true) {
            for antenna in (0..3).filter(|antenna| late[*antenna]) {
                rest[antenna] = &rest[antenna][1..];
                result.unmatched += 1;
            }
            continue;
        }
        rest = rest.map(|fixes| &fixes[1..]);
        if epoch.iter().any(|fix| fix.quality != FIXED) {
            result.not_fixed += 1;
            continue;
        }
        result.epochs += 1;
        for (pair, [a, b]) in Pair::among(3).map(Pair::indices).enumerate() {
            let distance_m = (epoch[a].position_m - epoch[b].position_m).norm();
            result.errors_mm[pair].push((distance_m - inter_antenna_m[pair]) * 1e3);
        }
    }
    result.unmatched += rest.map(<[GnssFix]>::len).iter().sum::<usize>();
    result
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    /// A 3-4-5 triangle of antennas.
    const CORNERS_M: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0]];

    /// Fixes of one antenna on the moving vehicle.
    fn fixes(antenna: usize, stamps_s: &[f64]) -> Vec<GnssFix> {
        let corner = Vector3::from(CORNERS_M[antenna]);
        let at = |time_s: f64| Vector3::new(1.6e6 + time_s.round(), -4.3e6, 4.4e6) + corner;
        stamps_s
            .iter()
            .map(|t| GnssFix { time_s: 1.7e9 + t, position_m: at(*t), quality: FIXED })
            .collect()
    }

    #[test]
    fn errors_are_apparent_minus_known_in_the_order_of_the_pairs() {
        let all = [0, 1, 2].map(|antenna| fixes(antenna, &[0.0, 1.0]));
        let found = inter_antenna(all.each_ref().map(Vec::as_slice), &[2.999, 4.002, 5.0]);
        assert_eq!((found.epochs, found.not_fixed, found.unmatched), (2, 0, 0));
        for (errors, expected) in found.errors_mm.iter().zip([1.0, -2.0, 0.0]) {
            assert_eq!(errors.len(), 2);
            assert!(errors.iter().all(|error| (error - expected).abs() < 1e-5), "{errors:?}");
        }
    }

    #[test]
    fn only_common_fixed_epochs_count() {
        // Jitter at 1 s is below the limit. Antenna 2 lacks 2 s; antenna 3 starts later and ends later.
        let mut all = [
            fixes(0, &[0.0, 1.0, 2.0, 3.0, 4.0]),
            fixes(1, &[0.0, 1.004, 3.0, 4.0]),
            fixes(2, &[1.0, 2.0, 3.0, 4.0, 5.0]),
        ];
        all[1][2].quality = 2;
        let found = inter_antenna(all.each_ref().map(Vec::as_slice), &[3.0, 4.0, 5.0]);
        assert_eq!((found.epochs, found.not_fixed, found.unmatched), (2, 1, 5));
        assert!(found.errors_mm.iter().all(|errors| errors.len() == 2));
        assert!(found.errors_mm.iter().flatten().all(|error| error.abs() < 1e-5));
        // Stamps that differ by more than the limit are different epochs.
        all[1][1].time_s += 0.002;
        let found = inter_antenna(all.each_ref().map(Vec::as_slice), &[3.0, 4.0, 5.0]);
        assert_eq!((found.epochs, found.not_fixed, found.unmatched), (1, 1, 8));
    }

    #[test]
    fn nothing_in_common_is_not_an_error() {
        let found = inter_antenna([&fixes(0, &[1.0]), &fixes(1, &[1.0]), &[]], &[3.0, 4.0, 5.0]);
        assert_eq!(found, InterAntenna { unmatched: 2, ..InterAntenna::default() });
    }
}
