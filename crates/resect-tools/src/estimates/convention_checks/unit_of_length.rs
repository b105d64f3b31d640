//! Units of length and time of an estimate, before its clock is searched in detail.

use nalgebra::Vector3;

use crate::estimates::ground_truth::GroundTruth;
use crate::estimates::options::Association;
use crate::estimates::time_offset;
use resect_core::deployment::EstimatedPose;
use resect_core::evaluation::no_trajectory::NoTrajectory;
use resect_core::geometry::align_similar;
use resect_core::statistics::median;

/// Largest number of poses that are compared.
const MOST_POSES: usize = 500;
const FEWEST: usize = 10;
/// Largest median error relative to the extent of the drive at which two trajectories have the same shape.
const SAME_SHAPE: f64 = 0.1;
/// Largest relative difference of a ratio from that of a unit. A lever arm of a twentieth of the extent changes the ratio by 2 %.
const UNIT_TOLERANCE: f64 = 0.03;
/// Units that a trajectory has instead of metres: times longer, name, word of the convention.
/// Kilometres have the ratio of a ground truth in millimetres.
const UNITS: [(f64, &str, &str); 4] = [
    (1000.0, "millimetres", "mm"),
    (100.0, "centimetres", "cm"),
    (1.0 / 0.0254, "inches", "in"),
    (1.0 / 0.3048, "feet", "ft"),
];

/// Comparison of the shapes of two trajectories at the offset of their speeds, with a free scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeFit {
    /// Ratio of the estimate's lengths to the ground truth's.
    pub times_longer: f64,
    /// Median error relative to the extent of the ground truth; lever arms and drift add to it.
    pub relative_misfit: f64,
    /// Offset that was added to the estimate's times (s).
    pub offset_s: f64,
}

impl ShapeFit {
    pub fn is_same_shape(&self) -> bool {
        self.relative_misfit < SAME_SHAPE
    }

    /// Returns true if shape and size are the same.
    pub fn is_alike(&self) -> bool {
        self.is_same_shape() && (self.times_longer - 1.0).abs() < UNIT_TOLERANCE
    }
}

/// Compares the shapes at a given offset, or at that of the speeds; `None` if the times do not overlap.
pub fn compare_shapes(
    truth: &GroundTruth<'_>,
    poses: &[EstimatedPose],
    time_offset_s: Option<f64>,
) -> Result<Option<ShapeFit>, NoTrajectory> {
    let offset_s = match time_offset_s {
        Some(offset_s) => Some(offset_s),
        None => time_offset::coarse(poses, truth)?.map(|coarse| coarse.offset_s),
    };
    let Some(offset_s) = offset_s else { return Ok(None) };
    let pairs = truth.matched(poses, offset_s, (Association::Interpolated, MOST_POSES))?;
    let truth_m: Vec<Vector3<f64>> = pairs.iter().map(|pair| pair.truth.position_m).collect();
    let estimate_m: Vec<Vector3<f64>> = pairs.iter().map(|pair| pair.pose.position_m).collect();
    Ok(shape_fit(&truth_m, &estimate_m, offset_s))
}

fn shape_fit(
    truth_m: &[Vector3<f64>],
    estimate_m: &[Vector3<f64>],
    offset_s: f64,
) -> Option<ShapeFit> {
    if truth_m.len() < FEWEST {
        return None;
    }
    let (transform, scale) = align_similar(truth_m, estimate_m)?;
    let centre_m = truth_m.iter().sum::<Vector3<f64>>() / truth_m.len() as f64;
    let extent_m = median(truth_m.iter().map(|truth_m| (truth_m - centre_m).norm()))?;
    let error_m = |(truth_m, estimate_m): (&Vector3<f64>, &Vector3<f64>)| {
        (truth_m - transform.apply(&(scale * estimate_m))).norm()
    };
    let misfit_m = median(truth_m.iter().zip(estimate_m).map(error_m))?;
    (scale > 0.0 && extent_m > 0.0).then(|| ShapeFit {
        times_longer: scale.recip(),
        relative_misfit: misfit_m / extent_m,
        offset_s,
    })
}

/// A unit of length that explains a ratio of lengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SuspectedUnit {
    pub times_longer: f64,
    pub name: &'static str,
    /// Word of the convention.
    pub word: &'static str,
    /// True if the ground truth has the unit, and the estimate has metres.
    pub is_of_truth: bool,
}

/// Returns the unit by which an estimate is longer or shorter than a ground truth; `None` if there is none.
pub fn suspected_unit(fit: &ShapeFit) -> Option<SuspectedUnit> {
    let is_near = |ratio: f64| (fit.times_longer / ratio - 1.0).abs() < UNIT_TOLERANCE;
    let known = UNITS.iter().find_map(|(ratio, name, word)| {
        let is_of_truth = is_near(ratio.recip());
        (is_of_truth || is_near(*ratio)).then_some(SuspectedUnit {
            times_longer: fit.times_longer,
            name,
            word,
            is_of_truth,
        })
    });
    known.filter(|_| fit.is_same_shape())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ratio_of_lengths_names_the_unit_and_the_trajectory_that_has_it() {
        let unit = |times_longer, relative_misfit| {
            suspected_unit(&ShapeFit { times_longer, relative_misfit, offset_s: 0.0 })
                .map(|unit| (unit.word, unit.is_of_truth))
        };
        assert_eq!(unit(100.3, 0.01), Some(("cm", false)));
        assert_eq!(unit(999.0, 0.01), Some(("mm", false)));
        assert_eq!(unit(3.29, 0.01), Some(("ft", false)));
        assert_eq!(unit(0.3047, 0.01), Some(("ft", true)));
        assert_eq!(unit(0.01, 0.01), Some(("cm", true)));
        assert_eq!(unit(0.001, 0.01), Some(("mm", true)));
        assert_eq!(unit(1000.0, 0.3), None, "another shape");
        for plausible in [1.0, 1.1, 2.0, 3.1, 95.0, 0.5] {
            assert_eq!(unit(plausible, 0.01), None, "{plausible}");
        }
    }
}
