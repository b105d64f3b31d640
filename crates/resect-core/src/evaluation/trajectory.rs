//! Six-degree-of-freedom poses of the vehicle, from its prisms.

use nalgebra::{Matrix3, Matrix3x6, Matrix6, UnitQuaternion, Vector3};

use crate::calibration::Estimate;
use crate::deployment::pairwise_distances;
use crate::geometry::align_rigid;
use crate::network::PerPrism;
use crate::statistics::median;

/// Pose of the vehicle at one instant: `station1_from_vehicle`.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    pub time_s: f64,
    /// Origin of the vehicle's frame.
    pub position_m: Vector3<f64>,
    pub orientation: UnitQuaternion<f64>,
    /// Covariance of the position (m), then of the rotation vector θ in station 1's frame (rad): the true orientation
    /// is exp(θ) times this one.
    pub covariance: Matrix6<f64>,
    /// Velocity and rotation rate; `None` if only positions are known.
    pub twist: Option<Twist>,
    /// Largest |apparent − known distance| between two prisms by the readings around the instant (m). No pose can explain it.
    pub inter_prism_error_m: f64,
}

/// Heading, pitch and roll with σ (rad): rotations about z, then y, then x that lead from station 1's frame to the vehicle's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attitude {
    pub yaw_rad: Estimate,
    pub pitch_rad: Estimate,
    pub roll_rad: Estimate,
}

/// Velocity of the vehicle's origin and rotation rate, in station 1's frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Twist {
    pub velocity_m_per_s: Vector3<f64>,
    pub rate_rad_per_s: Vector3<f64>,
    /// Covariance of the velocity, then of the rate.
    pub covariance: Matrix6<f64>,
}

/// Poses in order of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trajectory {
    pub poses: Vec<Pose>,
    /// Number of instants without a pose, for any reason.
    pub dropped: usize,
    /// Number of them whose inter-prism error exceeds the limit.
    pub above_limit: usize,
    /// Number of them whose σ exceeds its limit. At the others no motion is known, or the points determine no pose.
    pub too_uncertain: usize,
}

/// Standard deviations of a pose: the root of the mean variance of the three axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseSigma {
    pub position_m: f64,
    pub orientation_rad: f64,
}

impl PoseSigma {
    /// Returns true if neither is above its limit.
    pub fn is_within(&self, limits: &Self) -> bool {
        self.position_m <= limits.position_m && self.orientation_rad <= limits.orientation_rad
    }
}

impl Pose {
    pub fn sigma(&self) -> PoseSigma {
        let mean =
            |from: usize| (from..from + 3).map(|k| self.covariance[(k, k)]).sum::<f64>() / 3.0;
        PoseSigma { position_m: mean(0).sqrt(), orientation_rad: mean(3).sqrt() }
    }

    /// Heading, pitch and roll, with σ to first order.
    ///
    /// A small rotation θ in station 1's frame is ψ̇ z + θ̇ R_z y + φ̇ R_z R_y x, which is solved for the three angles. At ±90°
    /// of pitch, heading and roll coincide, and their σ grows without limit.
    pub fn attitude(&self) -> Attitude {
        let (roll, pitch, yaw) = self.orientation.euler_angles();
        let (sin, cos) = yaw.sin_cos();
        let by_roll = Vector3::new(cos, sin, 0.0) / pitch.cos();
        let by_yaw = Vector3::new(0.0, 0.0, 1.0) + pitch.sin() * by_roll;
        let by_pitch = Vector3::new(-sin, cos, 0.0);
        let turn = self.covariance.fixed_view::<3, 3>(3, 3);
        let estimate = |value: f64, by: Vector3<f64>| Estimate {
            value,
            sigma: (by.transpose() * turn * by).x.max(0.0).sqrt(),
        };
        Attitude {
            yaw_rad: estimate(yaw, by_yaw),
            pitch_rad: estimate(pitch, by_pitch),
            roll_rad: estimate(roll, by_roll),
        }
    }

    /// Speed of the vehicle's origin (m/s); `None` without a twist.
    pub fn speed_m_per_s(&self) -> Option<Estimate> {
        let twist = self.twist.as_ref()?;
        let covariance = twist.covariance.fixed_view::<3, 3>(0, 0).into_owned();
        Some(speed_of(&twist.velocity_m_per_s, &covariance))
    }

    /// Pose of a frame parallel to the vehicle's with its origin elsewhere on it (m, in the vehicle's frame), such as a
    /// sensor's.
    ///
    /// The lever arm l is taken as exact. A rotation δθ moves its end by δθ × R l; a rotating vehicle moves it at ω × R l.
    pub fn at_lever_arm(&self, lever_arm_m: &Vector3<f64>) -> Self {
        let lever_m = self.orientation * lever_arm_m;
        let mut moved = Matrix6::identity();
        moved.fixed_view_mut::<3, 3>(0, 3).copy_from(&-lever_m.cross_matrix());
        let twist = self.twist.as_ref().map(|twist| {
            // The velocity of the lever's end also depends on the attitude, but σ of the attitude is small beside that of the
            // rates.
            let rate = twist.rate_rad_per_s;
            Twist {
                velocity_m_per_s: twist.velocity_m_per_s + rate.cross(&lever_m),
                rate_rad_per_s: rate,
                covariance: moved * twist.covariance * moved.transpose(),
            }
        });
        Self {
            position_m: self.position_m + lever_m,
            covariance: moved * self.covariance * moved.transpose(),
            twist,
            ..self.clone()
        }
    }
}

/// Length of a velocity (m/s), with σ along it. If the speed is at most its σ, the direction is unknown, and σ is the mean over
/// all directions.
pub fn speed_of(velocity_m_per_s: &Vector3<f64>, covariance: &Matrix3<f64>) -> Estimate {
    let value = velocity_m_per_s.norm();
    let along = (velocity_m_per_s.transpose() * covariance * velocity_m_per_s).x;
    let mean = covariance.trace() / 3.0;
    let variance = if value * value > mean { along / (value * value) } else { mean };
    Estimate { value, sigma: variance.max(0.0).sqrt() }
}

impl Trajectory {
    /// Medians of the standard deviations of position and of orientation; `None` without poses.
    pub fn median_sigma(&self) -> Option<PoseSigma> {
        let sigmas = || self.poses.iter().map(Pose::sigma);
        Some(PoseSigma {
            position_m: median(sigmas().map(|sigma| sigma.position_m))?,
            orientation_rad: median(sigmas().map(|sigma| sigma.orientation_rad))?,
        })
    }
}

/// Positions of the prisms at one instant, in station 1's frame.
#[derive(Clone, Debug, PartialEq)]
pub struct ObservedRig {
    pub time_s: f64,
    pub points_m: PerPrism<Vector3<f64>>,
    /// Standard deviation of each point along each axis (m).
    pub sigma_m: PerPrism<Vector3<f64>>,
}

/// Returns one pose for every instant whose inter-prism distances are within the limit of the rig's.
///
/// `rig_m` are the prisms in the vehicle's frame (m). If they lie on a line, every instant is dropped.
pub fn trajectory(
    rig_m: &[Vector3<f64>],
    observed: impl IntoIterator<Item = ObservedRig>,
    largest_inter_prism_error_m: f64,
) -> Trajectory {
    let mut result = Trajectory::default();
    for instant in observed {
        match align_rig(rig_m, &instant) {
            Some(pose) if pose.inter_prism_error_m <= largest_inter_prism_error_m => {
                result.poses.push(pose);
            }
            pose => {
                result.dropped += 1;
                result.above_limit += usize::from(pose.is_some());
            }
        }
    }
    result
}

/// Least-squares pose of the rig at the observed points, all with equal weight; `None` if the points lie on a line.
///
/// The covariance is that of this unweighted solution to first order: N⁻¹ Jᵀ Σ J N⁻¹. J is the design matrix of all
/// coordinates, N = JᵀJ, and Σ the covariance of the coordinates (Förstner & Wrobel 2016, "Photogrammetric Computer Vision",
/// chapter 4).
pub fn align_rig(rig_m: &[Vector3<f64>], observed: &ObservedRig) -> Option<Pose> {
    let station1_from_vehicle = align_rigid(observed.points_m.as_slice(), rig_m)?;
    let (mut normal, mut noise) = (Matrix6::zeros(), Matrix6::zeros());
    for (prism_m, sigma_m) in rig_m.iter().zip(&observed.sigma_m) {
        // δq = δp + θ × R r = δp − [R r]× θ.
        let lever = station1_from_vehicle.rotate(prism_m).cross_matrix();
        let mut design = Matrix3x6::zeros();
        design.fixed_columns_mut::<3>(0).copy_from(&Matrix3::identity());
        design.fixed_columns_mut::<3>(3).copy_from(&-lever);
        let variance = Matrix3::from_diagonal(&sigma_m.component_mul(sigma_m));
        normal += design.transpose() * design;
        noise += design.transpose() * variance * design;
    }
    let inverse = normal.cholesky()?.inverse();
    let (apparent_m, known_m) =
        (pairwise_distances(observed.points_m.as_slice()), pairwise_distances(rig_m));
    Some(Pose {
        time_s: observed.time_s,
        position_m: station1_from_vehicle.translation_m,
        orientation: station1_from_vehicle.rotation.into(),
        covariance: inverse * noise * inverse,
        twist: None,
        inter_prism_error_m: apparent_m
            .iter()
            .zip(&known_m)
            .map(|(apparent_m, known_m)| (apparent_m - known_m).abs())
            .fold(0.0, f64::max),
    })
}

/// Prisms in a vehicle frame from the inter-prism distances 12, 13, 23 (m) alone; `None` if the distances form no triangle.
///
/// The origin is at prism 1, x points to prism 2, y is positive at prism 3, and z is normal to the three. The height of the
/// triangle is from Heron's formula, whose factors are the triangle inequalities.
pub fn rig_from_distances(inter_prism_m: &[f64; 3]) -> Option<[Vector3<f64>; 3]> {
    let [d12, d13, d23] = *inter_prism_m;
    let slack = [d12 + d13 - d23, d12 + d23 - d13, d13 + d23 - d12];
    if !slack.iter().all(|slack| *slack > 0.0) {
        return None;
    }
    let four_areas = ((d12 + d13 + d23) * slack.iter().product::<f64>()).sqrt();
    let x = (d12 * d12 + (d13 - d23) * (d13 + d23)) / (2.0 * d12);
    Some([
        Vector3::zeros(),
        Vector3::new(d12, 0.0, 0.0),
        Vector3::new(x, four_areas / (2.0 * d12), 0.0),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::RigidTransform;
    use nalgebra::{Rotation3, Vector6};
    use proptest::prelude::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    /// A rig that is not centred, so that position and orientation are correlated.
    fn rig() -> [Vector3<f64>; 3] {
        [Vector3::new(0.4, 0.1, 0.8), Vector3::new(-0.5, 0.3, 0.9), Vector3::new(0.0, -0.6, 0.7)]
    }

    fn motion() -> impl Strategy<Value = RigidTransform> {
        (proptest::array::uniform3(-50.0..50.0f64), proptest::array::uniform3(-2.0..2.0f64))
            .prop_map(|(translation, turn)| RigidTransform {
                rotation: Rotation3::new(turn.into()),
                translation_m: translation.into(),
            })
    }

    /// Vector of independent normal deviates.
    fn noise(rng: &mut ChaCha8Rng) -> Vector3<f64> {
        Vector3::from_fn(|_, _| StandardNormal.sample(rng))
    }

    #[test]
    fn the_covariance_is_that_of_a_monte_carlo() {
        const DRAWS: usize = 4000;
        let truth = RigidTransform {
            rotation: Rotation3::from_euler_angles(0.2, -0.3, 1.2),
            translation_m: Vector3::new(20.0, -35.0, 1.5),
        };
        let sigma_m = [
            Vector3::new(0.002, 0.001, 0.003),
            Vector3::new(0.001, 0.004, 0.001),
            Vector3::new(0.003, 0.002, 0.002),
        ];
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let mut squares = Vector6::zeros();
        let mut mahalanobis = 0.0;
        for _ in 0..DRAWS {
            let points_m: [_; 3] = std::array::from_fn(|prism| {
                truth.apply(&rig()[prism]) + sigma_m[prism].component_mul(&noise(&mut rng))
            });
            let observed =
                ObservedRig { time_s: 0.0, points_m: points_m.into(), sigma_m: sigma_m.into() };
            let pose = align_rig(&rig(), &observed).expect("a triangle");
            let moved_m = truth.translation_m - pose.position_m;
            let turned_rad =
                (UnitQuaternion::from(truth.rotation) * pose.orientation.inverse()).scaled_axis();
            let error = Vector6::from_iterator(moved_m.iter().chain(&turned_rad).copied());
            squares += error.component_mul(&error).component_div(&pose.covariance.diagonal());
            // The diagonal does not test the correlations; the Mahalanobis distance does.
            let information = pose.covariance.try_inverse().expect("full rank");
            mahalanobis += error.dot(&(information * error));
        }
        let rms = (squares / DRAWS as f64).map(f64::sqrt);
        assert!(rms.iter().all(|rms| (rms - 1.0).abs() < 0.1), "normalised errors {rms}");
        let mean = mahalanobis / DRAWS as f64;
        assert!((mean / 6.0 - 1.0).abs() < 0.1, "Mahalanobis distance {mean} of 6 unknowns");
    }

    /// A lever arm to a prism ends at the prism. With equal σ of all prisms, σ there is at most that of a prism. The opposite
    /// lever arm restores the pose.
    #[test]
    fn the_end_of_a_lever_arm_is_where_the_vehicle_has_it() {
        let truth = RigidTransform {
            rotation: Rotation3::from_euler_angles(0.2, -0.3, 1.2),
            translation_m: Vector3::new(20.0, -35.0, 1.5),
        };
        let points_m = rig().map(|prism| truth.apply(&prism));
        let sigma_m = [Vector3::repeat(1e-3); 3].into();
        let observed = ObservedRig { time_s: 0.0, points_m: points_m.into(), sigma_m };
        let rate_rad_per_s = Vector3::new(0.1, -0.2, 0.5);
        let twist = Twist {
            velocity_m_per_s: Vector3::new(1.0, 0.5, 0.0),
            rate_rad_per_s,
            covariance: Matrix6::identity() * 1e-4,
        };
        let pose = Pose {
            twist: Some(twist.clone()),
            ..align_rig(&rig(), &observed).expect("a triangle")
        };
        for (prism, at_m) in rig().iter().zip(points_m) {
            let there = pose.at_lever_arm(prism);
            assert!((there.position_m - at_m).norm() < 1e-12);
            assert!((0.5e-3..1.0e-3).contains(&there.sigma().position_m), "{:?}", there.sigma());
            let moving = there.twist.clone().expect("it moves").velocity_m_per_s;
            let expected = twist.velocity_m_per_s + rate_rad_per_s.cross(&(at_m - pose.position_m));
            assert!((moving - expected).norm() < 1e-12);
            let back = there.at_lever_arm(&-prism);
            assert!((back.covariance - pose.covariance).norm() < 1e-15);
        }
        let far = pose.at_lever_arm(&Vector3::new(10.0, 0.0, 0.0)).sigma();
        assert!(far.position_m > 5.0 * pose.sigma().position_m, "{far:?}");
    }

    /// Monte Carlo test of σ of heading, pitch and roll, with rotations drawn from the covariance.
    #[test]
    fn heading_pitch_and_roll_scatter_as_their_sigmas_say() {
        const DRAWS: usize = 4000;
        let mut root = Matrix6::identity() * 1e-3;
        // Rotations about x and y are correlated; σ about z is about a third of theirs.
        (root[(4, 3)], root[(5, 5)]) = (7e-4, 3e-4);
        let pose = Pose {
            time_s: 0.0,
            position_m: Vector3::zeros(),
            orientation: UnitQuaternion::from_euler_angles(0.3, 0.7, 2.0),
            covariance: root * root.transpose(),
            twist: None,
            inter_prism_error_m: 0.0,
        };
        let stated = pose.attitude();
        let angles = |a: Attitude| [a.yaw_rad, a.pitch_rad, a.roll_rad];
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        let mut squares = [0.0; 3];
        for _ in 0..DRAWS {
            let error = root * Vector6::from_fn(|_, _| StandardNormal.sample(&mut rng));
            let turn = Vector3::new(error[3], error[4], error[5]);
            let orientation = UnitQuaternion::from_scaled_axis(turn) * pose.orientation;
            let drawn = angles(Pose { orientation, ..pose.clone() }.attitude());
            for (square, (drawn, stated)) in
                squares.iter_mut().zip(drawn.iter().zip(angles(stated)))
            {
                *square += ((drawn.value - stated.value) / stated.sigma).powi(2);
            }
        }
        let rms = squares.map(|square| (square / DRAWS as f64).sqrt());
        assert!(rms.iter().all(|rms| (rms - 1.0).abs() < 0.05), "{rms:?}");
    }

    #[test]
    fn a_speed_has_the_sigma_along_it_and_at_rest_that_of_any_direction() {
        let covariance = Matrix3::from_diagonal(&Vector3::new(4e-4, 1e-4, 1e-4));
        let moving = speed_of(&Vector3::new(3.0, 0.0, 4.0), &covariance);
        assert!((moving.value - 5.0).abs() < 1e-12);
        assert!((moving.sigma - (0.36 * 4e-4 + 0.64 * 1e-4_f64).sqrt()).abs() < 1e-9);
        let still = speed_of(&Vector3::zeros(), &covariance);
        assert!((still.sigma - 2e-4_f64.sqrt()).abs() < 1e-9, "{}", still.sigma);
    }

    proptest! {
        #[test]
        fn moving_the_observations_moves_the_pose_alike(
            before in motion(),
            by in motion(),
            seed in 0..1000u64,
        ) {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let points_m = rig().map(|prism| before.apply(&prism) + 0.01 * noise(&mut rng));
            // Equal σ in all directions, which a rotation leaves unchanged.
            let sigma_m = [0.001, 0.002, 0.005].map(Vector3::repeat).into();
            let observed = ObservedRig { time_s: 7.0, points_m: points_m.into(), sigma_m };
            let pose = align_rig(&rig(), &observed).expect("a triangle");
            let moved = ObservedRig { points_m: points_m.map(|p| by.apply(&p)).into(), ..observed };
            let moved = align_rig(&rig(), &moved).expect("a triangle");

            prop_assert!((moved.position_m - by.apply(&pose.position_m)).norm() < 1e-9);
            let expected = UnitQuaternion::from(by.rotation) * pose.orientation;
            prop_assert!(moved.orientation.angle_to(&expected) < 1e-9);
            let mut turn = Matrix6::zeros();
            turn.fixed_view_mut::<3, 3>(0, 0).copy_from(by.rotation.matrix());
            turn.fixed_view_mut::<3, 3>(3, 3).copy_from(by.rotation.matrix());
            let expected = turn * pose.covariance * turn.transpose();
            prop_assert!((moved.covariance - expected).norm() < 1e-9 * expected.norm());
            prop_assert!((moved.inter_prism_error_m - pose.inter_prism_error_m).abs() < 1e-12);
        }

        #[test]
        fn a_rig_keeps_its_distances(
            x in -2.0..2.0f64, y in 0.01..2.0f64, d12 in 0.1..3.0f64,
        ) {
            let expected = [Vector3::zeros(), Vector3::new(d12, 0.0, 0.0), Vector3::new(x, y, 0.0)];
            let found = rig_from_distances(pairwise_distances(&expected).as_array().expect("three")).expect("a triangle");
            for (found, expected) in found.iter().zip(&expected) {
                prop_assert!((found - expected).norm() < 1e-10);
            }
        }
    }

    #[test]
    fn an_exact_observation_gives_the_pose_and_no_error() {
        let truth = RigidTransform {
            rotation: Rotation3::from_euler_angles(0.1, 0.2, -2.0),
            translation_m: Vector3::new(1.0, 2.0, 3.0),
        };
        let points_m = rig().map(|prism| truth.apply(&prism)).into();
        let observed =
            ObservedRig { time_s: 3.5, points_m, sigma_m: [Vector3::repeat(1e-3); 3].into() };
        let pose = align_rig(&rig(), &observed).expect("a triangle");
        assert_eq!(pose.time_s, 3.5);
        assert!((pose.position_m - truth.translation_m).norm() < 1e-12);
        assert!(pose.orientation.angle_to(&truth.rotation.into()) < 1e-12);
        assert!(pose.inter_prism_error_m < 1e-12);
    }

    #[test]
    fn distances_of_no_triangle_make_no_rig() {
        assert!(rig_from_distances(&[3.0, 4.0, 5.0]).is_some());
        for broken in [
            [1.0, 2.0, 4.0],
            [4.0, 1.0, 2.0],
            [2.0, 4.0, 1.0],
            [1.0, 2.0, 3.0],
            [0.0, 1.0, 1.0],
            [-3.0, -4.0, -5.0],
            [1.0, 1.0, f64::NAN],
            [1.0, f64::INFINITY, f64::INFINITY],
        ] {
            assert_eq!(rig_from_distances(&broken), None, "{broken:?}");
        }
    }

    #[test]
    fn prisms_on_a_line_or_a_spot_have_no_pose() {
        let sigma_m = [Vector3::repeat(1e-3); 3].into();
        let fine = ObservedRig { time_s: 0.0, points_m: rig().into(), sigma_m };
        let line = [0.0, 1.0, 3.0].map(|s| Vector3::new(s, 2.0 * s, 0.5));
        for hopeless in [line, [Vector3::x(); 3]] {
            assert_eq!(align_rig(&hopeless, &fine), None);
            assert_eq!(
                align_rig(&rig(), &ObservedRig { points_m: hopeless.into(), ..fine.clone() }),
                None
            );
        }
    }

    #[test]
    fn instants_above_the_limit_are_dropped_and_counted() {
        let sigma_m = [Vector3::repeat(1e-3); 3];
        let along = (rig()[1] - rig()[0]).normalize();
        let instants =
            [0.0, 0.004, 0.02, -0.006, -0.03].iter().enumerate().map(|(i, stretch_m)| {
                let [one, two, three] = rig();
                let points_m = [one, two + *stretch_m * along, three];
                ObservedRig { time_s: i as f64, points_m: points_m.into(), sigma_m: sigma_m.into() }
            });
        let found = trajectory(&rig(), instants, 0.01);
        assert_eq!((found.dropped, found.above_limit), (2, 2));
        let kept: Vec<_> = found.poses.iter().map(|pose| pose.time_s).collect();
        assert_eq!(kept, [0.0, 1.0, 3.0]);
        assert!((found.poses[1].inter_prism_error_m - 0.004).abs() < 1e-12);
        assert!((found.poses[2].inter_prism_error_m - 0.006).abs() < 1e-12);
    }
}
