//! Pose and twist of a vehicle from the positions and velocities of its prisms, with their full covariance.

use nalgebra::{DMatrix, DVector, Matrix3, Matrix6, UnitQuaternion, Vector3, Vector6};

use super::trajectory::{Pose, Twist};
use super::usual_tilt::ExpectedTilt;
use crate::calibration::joint::prism_motion::MotionInstant;
use crate::geometry::{RigidTransform, align_rigid};
use crate::network::{Number, Pair};

/// Gauss–Newton steps to the pose; the first is accurate to millimetres.
const STEPS: usize = 4;
/// Prisms nearer to each other have no line (m).
const SHORTEST_LINE_M: f64 = 1e-3;
/// A line is upright if the sine of its angle to the vertical is smaller.
const MOST_UPRIGHT: f64 = 0.2;

/// Generalised least-squares pose of the rig; `None` if its prisms do not determine it.
///
/// The weights are from the covariance of the prisms and of the rig. `rig_m` are the prisms in the vehicle's frame (m), and
/// `rig_sigma_m` is σ of each along any axis (m). Gauss–Newton steps start at the unweighted pose, and the covariance is
/// (JᵀΣ⁻¹J)⁻¹ (Förstner & Wrobel 2016, "Photogrammetric Computer Vision", chapter 4). The twist is estimated likewise from the
/// velocities. Where prisms on a line are followed, the expected tilt determines the rotation about it, and its rate.
pub fn rig_pose(
    rig_m: &[Vector3<f64>],
    rig_sigma_m: f64,
    at: &MotionInstant,
    expected: Option<&ExpectedTilt>,
) -> Option<Pose> {
    let followed_m: Vec<Vector3<f64>> = at.prisms.iter().map(|place| rig_m[*place]).collect();
    let points_m: Vec<Vector3<f64>> = (0..followed_m.len()).map(|k| at.prism_m(k)).collect();
    let (start, tilt) = match align_rigid(&points_m, &followed_m) {
        Some(start) => (start, None),
        None => (align_upright(&points_m, &followed_m, &expected?.up)?, expected),
    };
    let (mut position_m, mut orientation) =
        (start.translation_m, UnitQuaternion::from(start.rotation));
    let weight = with_rig(at, rig_sigma_m).cholesky()?.inverse();
    let mut covariance = Matrix6::zeros();
    for _ in 0..STEPS {
        let design = design(&followed_m, &orientation);
        let mut error = DVector::zeros(at.position_m.len());
        for (prism, own_m) in followed_m.iter().enumerate() {
            let expected_m = position_m + orientation * own_m;
            error.fixed_rows_mut::<3>(3 * prism).copy_from(&(points_m[prism] - expected_m));
        }
        let tilt_error = tilt.map(|tilt| {
            // δ(R u) = θ × R u, whose level components are θ_y and −θ_x.
            let up = orientation * tilt.up;
            ([up.y, -up.x], tilt.sigma_rad)
        });
        let (step, left) = solve(&design, &weight, &error, tilt_error)?;
        position_m += step.fixed_rows::<3>(0);
        orientation = UnitQuaternion::from_scaled_axis(step.fixed_rows::<3>(3)) * orientation;
        covariance = left;
    }
    // Masts bend slowly, so the rig's own error is nearly constant.
    let weight = at.velocity_covariance.clone().cholesky()?.inverse();
    let still = tilt.map(|tilt| ([0.0; 2], tilt.rate_sigma_rad_per_s));
    let design = design(&followed_m, &orientation);
    let (rates, left) = solve(&design, &weight, &at.velocity_m_per_s, still)?;
    let distance_error_m = |Pair { first, second }: Pair| {
        let distance_m = |all: &[Vector3<f64>]| (all[first.index()] - all[second.index()]).norm();
        (distance_m(&points_m) - distance_m(&followed_m)).abs()
    };
    let pairs = (0..Pair::count(followed_m.len())).map(Pair::at);
    let twist = Twist {
        velocity_m_per_s: rates.fixed_rows::<3>(0).into(),
        rate_rad_per_s: rates.fixed_rows::<3>(3).into(),
        covariance: left,
    };
    Some(Pose {
        time_s: at.time_s,
        position_m,
        orientation,
        covariance,
        twist: Some(twist),
        inter_prism_error_m: pairs.map(distance_error_m).fold(0.0, f64::max),
    })
}

/// Returns the transform from prisms on a line and a direction that points upwards, both in the vehicle's frame; `None` if the line is upright,
/// or has no length.
pub fn align_upright(
    points_m: &[Vector3<f64>],
    rig_m: &[Vector3<f64>],
    up: &Vector3<f64>,
) -> Option<RigidTransform> {
    let above = |all: &[Vector3<f64>], up: &Vector3<f64>| -> Option<Vec<Vector3<f64>>> {
        let (first_m, last_m) = (all.first()?, all.last()?);
        let line = (last_m - first_m).try_normalize(SHORTEST_LINE_M)?;
        // Across the line, so that the two shapes are alike.
        let across = line.cross(up).try_normalize(MOST_UPRIGHT)?;
        Some([all, &[first_m + across]].concat())
    };
    align_rigid(&above(points_m, &Vector3::z())?, &above(rig_m, up)?)
}

/// Jacobian of the pose of [`rig_pose`] with respect to the prisms; rows are position (m) and rotation (rad). `None` if the
/// covariance of the prisms is not positive definite.
pub fn pose_by_prisms(
    rig_m: &[Vector3<f64>],
    rig_sigma_m: f64,
    at: &MotionInstant,
    pose: &Pose,
) -> Option<DMatrix<f64>> {
    let followed_m: Vec<Vector3<f64>> = at.prisms.iter().map(|place| rig_m[*place]).collect();
    let weight = with_rig(at, rig_sigma_m).cholesky()?.inverse();
    let gain = pose.covariance * design(&followed_m, &pose.orientation).transpose() * weight;
    Some(gain.resize_vertically(6, 0.0))
}

/// Covariance of the prisms' positions with that of the rig (m²).
fn with_rig(at: &MotionInstant, rig_sigma_m: f64) -> DMatrix<f64> {
    let size = at.position_m.len();
    &at.position_covariance + DMatrix::from_diagonal_element(size, size, rig_sigma_m.powi(2))
}

/// Jacobian of the prisms with respect to the position and a rotation about station 1's axes: δq = δp + θ × R r.
fn design(rig_m: &[Vector3<f64>], orientation: &UnitQuaternion<f64>) -> DMatrix<f64> {
    let mut design = DMatrix::zeros(3 * rig_m.len(), 6);
    for (prism, own_m) in rig_m.iter().enumerate() {
        let lever = (orientation * own_m).cross_matrix();
        design.fixed_view_mut::<3, 3>(3 * prism, 0).copy_from(&Matrix3::identity());
        design.fixed_view_mut::<3, 3>(3 * prism, 3).copy_from(&-lever);
    }
    design
}

/// Solution with its covariance. `level` are observed rotations about x and y (rad), or their rates (rad/s), with σ.
fn solve(
    design: &DMatrix<f64>,
    weight: &DMatrix<f64>,
    error: &DVector<f64>,
    level: Option<([f64; 2], f64)>,
) -> Option<(Vector6<f64>, Matrix6<f64>)> {
    let pulled = design.transpose() * weight;
    let mut normal: Matrix6<f64> = (&pulled * design).fixed_view::<6, 6>(0, 0).into();
    let mut right: Vector6<f64> = (pulled * error).fixed_rows::<6>(0).into();
    for (axis, (angle, sigma)) in level
        .into_iter()
        .flat_map(|(both, sigma)| both.into_iter().map(move |angle| (angle, sigma)).enumerate())
    {
        normal[(3 + axis, 3 + axis)] += sigma.powi(-2);
        right[3 + axis] += angle / sigma.powi(2);
    }
    let covariance = normal.cholesky()?.inverse();
    Some((covariance * right, covariance))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    fn rig() -> [Vector3<f64>; 3] {
        [Vector3::new(0.4, 0.1, 0.8), Vector3::new(-0.5, 0.3, 0.9), Vector3::new(0.0, -0.6, 0.7)]
    }

    fn moving() -> (RigidTransform, Vector3<f64>, Vector3<f64>) {
        let station1_from_vehicle = RigidTransform {
            rotation: Rotation3::from_euler_angles(0.2, -0.3, 1.2),
            translation_m: Vector3::new(20.0, -35.0, 1.5),
        };
        (station1_from_vehicle, Vector3::new(0.9, 0.2, 0.0), Vector3::new(0.02, -0.01, 0.3))
    }

    fn exact() -> MotionInstant {
        let (pose, velocity, rate) = moving();
        let all = |of: &dyn Fn(&Vector3<f64>) -> Vector3<f64>| {
            DVector::from_iterator(9, rig().iter().flat_map(|p| of(p).data.0[0]))
        };
        MotionInstant {
            time_s: 7.0,
            prisms: [0, 1, 2].into(),
            position_m: all(&|p| pose.apply(p)),
            velocity_m_per_s: all(&|p| velocity + rate.cross(&pose.rotate(p))),
            position_covariance: DMatrix::identity(9, 9) * 1e-6,
            velocity_covariance: DMatrix::identity(9, 9) * 1e-4,
        }
    }

    #[test]
    fn prisms_without_an_error_give_pose_and_twist_exactly() {
        let (truth, velocity, rate) = moving();
        let pose = rig_pose(&rig(), 1e-3, &exact(), None).expect("a triangle");
        assert!((pose.position_m - truth.translation_m).norm() < 1e-12);
        assert!(pose.orientation.angle_to(&truth.rotation.into()) < 1e-12);
        let twist = pose.twist.expect("it moves");
        assert!((twist.velocity_m_per_s - velocity).norm() < 1e-12);
        assert!((twist.rate_rad_per_s - rate).norm() < 1e-12);
        let line = [0.0, 1.0, 3.0].map(|s| Vector3::new(s, 2.0 * s, 0.5));
        assert_eq!(rig_pose(&line, 1e-3, &exact(), None), None);
    }

    /// Monte Carlo test with errors common to all prisms, as of a calibration, with their own errors, and with an error of the
    /// rig.
    #[test]
    fn the_covariance_is_that_of_a_monte_carlo() {
        const DRAWS: usize = 4000;
        const RIG_SIGMA_M: f64 = 0.001;
        let (truth, ..) = moving();
        let mut root = DMatrix::<f64>::identity(9, 9) * 0.001;
        for prism in 0..3 {
            let mut common = root.fixed_view_mut::<3, 1>(3 * prism, 0);
            common += Vector3::new(0.004, -0.002, 0.003);
        }
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let mut mahalanobis = 0.0;
        for _ in 0..DRAWS {
            let error = &root * DVector::from_fn(9, |_, _| normal());
            let at = MotionInstant {
                position_m: exact().position_m + error,
                position_covariance: &root * root.transpose(),
                ..exact()
            };
            let given_m = rig().map(|p| p.map(|value| value + RIG_SIGMA_M * normal()));
            let pose = rig_pose(&given_m, RIG_SIGMA_M, &at, None).expect("a triangle");
            let moved = pose.position_m - truth.translation_m;
            let turned =
                (pose.orientation * UnitQuaternion::from(truth.rotation).inverse()).scaled_axis();
            let error = Vector6::from_iterator(moved.iter().chain(&turned).copied());
            mahalanobis += error.dot(&(pose.covariance.try_inverse().expect("full rank") * error));
        }
        let mean = mahalanobis / DRAWS as f64;
        assert!((mean / 6.0 - 1.0).abs() < 0.06, "Mahalanobis distance {mean} of 6 unknowns");
    }
}
