//! Layout of the prisms on the vehicle, in the vehicle's frame.

use nalgebra::{DMatrix, DVector, Rotation3, Vector3};

use super::trajectory::rig_from_distances;
use crate::deployment::Rig;
use crate::geometry::align_rigid;
use crate::network::{PerPair, PerPrism};

/// The frame of the vehicle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VehicleFrame {
    /// The frame in which `deployment.toml` gives the prisms.
    Given,
    /// Origin at prism 1, z up in the attitude in which the rig was read, x level and towards prism 2.
    Reading,
    /// Origin at prism 1, x to prism 2, y on the side of prism 3, z normal to the three.
    Triangle,
}

impl VehicleFrame {
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Given => "the vehicle's own, as prisms_m of deployment.toml",
            Self::Reading => {
                "origin at prism 1, z up as in the reading of the rig, x level towards prism 2"
            }
            Self::Triangle => {
                "origin at prism 1, x to prism 2, y on the side of prism 3, z normal to the three"
            }
        }
    }
}

/// Prisms in the vehicle's frame (m); `None` if they lie on a line, or if nothing determines the positions of more than three.
///
/// The shape is that of the inter-prism distances, which average many readings. The single reading of the rig gives its
/// attitude only; that of more than three prisms selects one of the mirrored shapes as well.
pub fn prisms_in_vehicle(rig: &Rig) -> Option<(PerPrism<Vector3<f64>>, VehicleFrame)> {
    if let Some(given) = &rig.in_vehicle_m {
        return Some((given.clone(), VehicleFrame::Given));
    }
    let standing = match (rig.inter_prism_m.as_array(), &rig.prisms_m) {
        (Some(distances_m), read) => {
            let triangle = rig_from_distances(distances_m)?;
            let Some(read) = read else {
                return Some((triangle.into(), VehicleFrame::Triangle));
            };
            let reading_from_triangle = align_rigid(read.as_slice(), &triangle)?;
            triangle.map(|prism| reading_from_triangle.rotate(&prism)).into()
        }
        (None, Some(read)) => with_distances(read, &rig.inter_prism_m)?,
        (None, None) => return None,
    };
    let towards = standing.iter().skip(1).find(|p| p.xy().norm() > 1e-3)?;
    let back = Rotation3::from_axis_angle(&Vector3::z_axis(), -towards.y.atan2(towards.x));
    Some((standing.map(|prism| back * prism), VehicleFrame::Reading))
}

/// Twice the area of the smallest triangle of prisms that has an orientation (m²).
const SMALLEST_SPAN_M2: f64 = 1e-6;
/// Gauss–Newton steps to the shape of a rig; the reading is accurate to millimetres.
const SHAPE_STEPS: usize = 4;
/// Singular values below this share of the largest belong to motions of the whole rig, which distances do not determine.
const RIGID_MOTION: f64 = 1e-9;

/// Returns the positions nearest to the reading that have these distances, or fit them best; the origin is at prism 1 (m).
fn with_distances(
    read: &PerPrism<Vector3<f64>>,
    inter_prism_m: &PerPair<f64>,
) -> Option<PerPrism<Vector3<f64>>> {
    let mut prisms_m = read.clone();
    for _ in 0..SHAPE_STEPS {
        let mut jacobian = DMatrix::zeros(inter_prism_m.len(), 3 * prisms_m.len());
        let mut error_m = DVector::zeros(inter_prism_m.len());
        for (row, (pair, known_m)) in inter_prism_m.each().enumerate() {
            let [a, b] = pair.indices();
            let apart_m = prisms_m.as_slice().get(b)? - prisms_m[a];
            let along = apart_m.try_normalize(0.0)?;
            error_m[row] = known_m - apart_m.norm();
            jacobian.fixed_view_mut::<1, 3>(row, 3 * a).copy_from(&-along.transpose());
            jacobian.fixed_view_mut::<1, 3>(row, 3 * b).copy_from(&along.transpose());
        }
        let svd = jacobian.svd(true, true);
        let least = RIGID_MOTION * svd.singular_values.max();
        let step = svd.solve(&error_m, least).ok()?;
        for (place, prism_m) in prisms_m.iter_mut().enumerate() {
            *prism_m += step.fixed_rows::<3>(3 * place);
        }
    }
    let first_m = *prisms_m.iter().next()?;
    Some(prisms_m.map(|prism_m| prism_m - first_m))
}

/// Returns true if three of the prisms (m) do not lie on a line, so that they have an orientation.
pub fn span_a_plane(prisms_m: &PerPrism<Vector3<f64>>) -> bool {
    let from_first = || prisms_m.iter().skip(1).map(|prism_m| prism_m - prisms_m[0]);
    let pairs = from_first().flat_map(|a| from_first().map(move |b| a.cross(&b).norm()));
    pairs.fold(0.0, f64::max) > SMALLEST_SPAN_M2
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deployment::pairwise_distances;

    #[test]
    fn four_prisms_have_the_measured_distances_in_the_attitude_of_the_reading() {
        let prisms_m = [[0.0, 0.0, 0.0], [1.1, 0.0, 0.0], [0.2, 0.9, 0.1], [0.4, 0.3, 0.8]];
        let prisms_m = prisms_m.map(Vector3::from);
        let inter_prism_m = pairwise_distances(&prisms_m);
        let turn = Rotation3::from_euler_angles(0.0, 0.0, 0.7);
        // Every reading of a prism has an error of millimetres.
        let read = prisms_m.map(|p| turn * p + Vector3::new(4.0, 7.0 + 2e-3 * p.x, -1e-3 * p.z));
        let rig = |read: Option<PerPrism<Vector3<f64>>>| Rig {
            inter_prism_m: inter_prism_m.clone(),
            prisms_m: read,
            in_vehicle_m: None,
            inter_antenna_m: None,
        };
        let (layout_m, frame) = prisms_in_vehicle(&rig(Some(read.into()))).expect("a layout");
        assert_eq!(frame, VehicleFrame::Reading);
        for (found_m, known_m) in pairwise_distances(layout_m.as_slice()).iter().zip(&inter_prism_m)
        {
            assert!((found_m - known_m).abs() < 1e-9, "{found_m} {known_m}");
        }
        for (found_m, prism_m) in layout_m.iter().zip(&prisms_m) {
            assert!((found_m - prism_m).norm() < 5e-3, "{found_m} {prism_m}");
        }
        assert_eq!(prisms_in_vehicle(&rig(None)), None);
    }
}
