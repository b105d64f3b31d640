//! Triplets that cannot be right, such as those of a station that followed another prism for a while: which they are, and
//! how far they pull an answer by least squares.

use super::levenberg_marquardt::FINE_M;
use super::{CentredTriplets, Minimum, distance_errors_m, minimise};
use crate::calibration::TransformSigma;
use crate::deployment::Finding;
use crate::geometry::RigidTransform;
use crate::pipeline::Triplets;

/// A triplet is wild when one of its distances is off by more than both: bends and stops make 20 mm of chords. Wild ones
/// seem to turn a rig, and so to hold what the drive leaves free: a hundredth of triplets off by 20 mm adds 5e-6 to the
/// smallest eigenvalue.
const WILD_M: f64 = 0.02;
const WILD_TIMES: f64 = 5.0;
/// A pull is worth a warning when it is more than this (m) and as much as the answer's own σ.
pub const NOTABLE_PULL_M: f64 = 0.002;

/// Instants that are not wild, out of the errors of each one's three distances (m).
pub fn fitting(errors_m: impl Iterator<Item = [f64; 3]>) -> Vec<usize> {
    let worst_m: Vec<f64> =
        errors_m.map(|pairs| pairs.iter().fold(0.0, |worst: f64, e| worst.max(e.abs()))).collect();
    let mut ordered = worst_m.clone();
    let middle = ordered.len() / 2;
    let Some(middle_m) = ordered
        .get(middle)
        .copied()
        .map(|_| *ordered.select_nth_unstable_by(middle, f64::total_cmp).1)
    else {
        return Vec::new();
    };
    let limit_m = WILD_M.max(WILD_TIMES * middle_m);
    (0..worst_m.len()).filter(|i| worst_m[*i] < limit_m).collect()
}

/// Triplets that fit an answer.
pub fn fitting_triplets(
    triplets: &Triplets,
    station1_from_station: &[RigidTransform; 3],
    inter_prism_m: &[f64; 3],
) -> Vec<usize> {
    let [first, second, third] = distance_errors_m(triplets, station1_from_station, inter_prism_m);
    fitting((0..triplets.len()).map(|i| [first[i], second[i], third[i]]))
}

/// What the wild triplets do to an answer by least squares: a finding where they move it by more than it is certain.
pub fn pull(
    data: &CentredTriplets,
    answer: &Minimum,
    sigma: Option<&[TransformSigma; 2]>,
) -> Option<Finding> {
    let errors_m = data.distance_errors_m(&answer.parameters);
    let kept = fitting(errors_m.chunks(3).map(|pairs| [pairs[0], pairs[1], pairs[2]]));
    let wild = data.len() - kept.len();
    if wild == 0 || kept.len() < data.len() / 2 {
        return None;
    }
    let without = minimise(&data.select(&kept), answer.parameters, FINE_M);
    let (with, without) =
        (data.transforms(&answer.parameters), data.transforms(&without.parameters));
    let (mut pull_m, mut sigmas) = (0.0_f64, 0.0_f64);
    for slot in 0..2 {
        let moved = with[slot + 1].translation_m - without[slot + 1].translation_m;
        pull_m = pull_m.max(moved.norm());
        let sigma_m = sigma.map_or(f64::INFINITY, |sigma| sigma[slot].translation_m.norm());
        sigmas = sigmas.max(moved.norm() / sigma_m);
    }
    (pull_m > NOTABLE_PULL_M && sigmas > 1.0).then(|| {
        let largest_m = errors_m.iter().fold(0.0, |worst: f64, e| worst.max(e.abs()));
        Finding::warning(format!(
            "{wild} triplets with distances off by up to {largest_m:.2} m pull this answer by {:.0} mm: a station lost its \
             prism or followed another; give them less weight (--robust)",
            pull_m * 1e3
        ))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wild_ones_are_told_from_chords() {
        let mut errors_m = vec![[0.001, -0.002, 0.001]; 30];
        errors_m[4] = [0.0, 0.015, 0.0];
        errors_m[7] = [0.0, 0.0, -0.9];
        let kept = fitting(errors_m.into_iter());
        assert!(kept.contains(&4) && !kept.contains(&7));
        assert_eq!(kept.len(), 29);
        assert!(fitting(std::iter::empty()).is_empty());
    }
}
