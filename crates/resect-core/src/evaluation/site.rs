//! The frame in which the control points were surveyed, and poses in it.

use nalgebra::{Matrix3, Matrix6, Vector3};

use super::trajectory::{Pose, Twist};
use crate::calibration::joint::prism_motion::PrismInstant;
use crate::deployment::{ControlPoint, ControlPointSet, Deployment};
use crate::geometry::{LevelTransform, RigidTransform, align_level};
use crate::network::PerStation;

/// Smallest σ of a coordinate (m): residuals of a few points determine σ poorly.
const LEAST_SIGMA_M: f64 = 1e-3;
/// Smallest spread of the points about their centre in plan (m, root of the sum of squares); below it the heading is
/// unobservable.
const NARROWEST_M: f64 = 0.1;

/// Transform from station 1's frame to that of the surveyed coordinates, with its covariance.
#[derive(Clone, Debug, PartialEq)]
pub struct SiteFrame {
    /// The file of the control points.
    pub file: String,
    pub site_from_station1: LevelTransform,
    /// Number of points, and the root mean square of their residuals by coordinate (m).
    pub points: usize,
    pub rms_m: f64,
    /// Centroid of the points in the site's frame (m), about which rotation and translation are uncorrelated.
    middle_m: Vector3<f64>,
    shift_variance_m2: f64,
    turn_variance_rad2: f64,
}

/// Reason why there are no poses in the frame of the control points.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoSite {
    #[error(
        "{0}: no control point has surveyed coordinates; give them as CSV `file,marker_number,x_m,y_m,z_m`"
    )]
    NoCoordinates(String),
    #[error(
        "{0}: fewer than two distinct surveyed points were measured; measure two that are apart"
    )]
    TooFew(String),
}

impl SiteFrame {
    /// Estimates the frame from the set with the most points that are surveyed and read.
    ///
    /// Both frames are level, so the transform has four parameters. Their covariance is that of the least-squares fit with σ
    /// from the residuals (e.g. Förstner & Wrobel 2016, chapter 4.2). It neglects the correlation with the calibration.
    pub fn of(
        deployment: &Deployment,
        station1_from_station: &PerStation<RigidTransform>,
    ) -> Result<Self, NoSite> {
        let usable = |set: &ControlPointSet| {
            let both = |point| pair(point, station1_from_station);
            set.points.iter().filter_map(both).collect::<Vec<_>>()
        };
        let sets = deployment.control_points.iter().map(|set| (set, usable(set)));
        // The first of several sets with equally many points.
        let most = sets.rev().max_by_key(|(_, usable)| usable.len());
        let name = || deployment.name.clone();
        let (set, pairs) = most
            .filter(|(_, usable)| !usable.is_empty())
            .ok_or_else(|| NoSite::NoCoordinates(name()))?;
        let (known_m, seen_m): (Vec<_>, Vec<_>) = pairs.into_iter().unzip();
        let count = known_m.len();
        let site_from_station1 =
            align_level(&known_m, &seen_m).ok_or_else(|| NoSite::TooFew(name()))?;
        let middle_m = known_m.iter().sum::<Vector3<f64>>() / count as f64;
        let spread_m2: f64 = known_m.iter().map(|p| (p - middle_m).xy().norm_squared()).sum();
        if spread_m2 < NARROWEST_M * NARROWEST_M {
            return Err(NoSite::TooFew(name()));
        }
        let left = known_m.iter().zip(&seen_m);
        let square: f64 =
            left.map(|(known, seen)| (site_from_station1.apply(seen) - known).norm_squared()).sum();
        let variance = (square / (3 * count - 4) as f64).max(LEAST_SIGMA_M * LEAST_SIGMA_M);
        Ok(Self {
            file: set.file.clone(),
            site_from_station1,
            points: count,
            rms_m: (square / (3 * count) as f64).sqrt(),
            middle_m,
            shift_variance_m2: variance / count as f64,
            turn_variance_rad2: variance / spread_m2,
        })
    }

    /// Description for headers: "frame of GCP.txt (10 points, 1.2 mm rms)".
    pub fn in_words(&self) -> String {
        let Self { file, points, rms_m, .. } = self;
        format!("frame of {file} ({points} points, {:.1} mm rms)", 1e3 * rms_m)
    }

    /// Transforms a pose from station 1's frame, and adds the covariance of the frame.
    pub fn pose(&self, pose: &Pose) -> Pose {
        let turn = self.turn();
        let position_m = self.site_from_station1.apply(&pose.position_m);
        let mut both = Matrix6::zeros();
        both.fixed_view_mut::<3, 3>(0, 0).copy_from(&turn);
        both.fixed_view_mut::<3, 3>(3, 3).copy_from(&turn);
        let mut covariance = both * pose.covariance * both.transpose();
        let by_turn = self.by_turn(&position_m);
        let mut open = covariance.fixed_view_mut::<3, 3>(0, 0);
        open += self.position_covariance(&position_m);
        // A rotation δψ moves the position by δψ z × (p − c), and rotates the orientation by δψ z.
        let mut common = covariance.fixed_view_mut::<3, 1>(0, 5);
        common += by_turn * self.turn_variance_rad2;
        let mut common = covariance.fixed_view_mut::<1, 3>(5, 0);
        common += by_turn.transpose() * self.turn_variance_rad2;
        covariance[(5, 5)] += self.turn_variance_rad2;
        let twist = pose.twist.as_ref().map(|twist| Twist {
            velocity_m_per_s: turn * twist.velocity_m_per_s,
            rate_rad_per_s: turn * twist.rate_rad_per_s,
            covariance: both * twist.covariance * both.transpose(),
        });
        let turned = RigidTransform::from(self.site_from_station1).rotation;
        let orientation = nalgebra::UnitQuaternion::from(turned) * pose.orientation;
        Pose { position_m, orientation, covariance, twist, ..pose.clone() }
    }

    /// Transforms the position and velocity of one prism from station 1's frame, and adds the covariance of the frame.
    pub fn prism(&self, at: &PrismInstant) -> PrismInstant {
        let turn = self.turn();
        let position_m = self.site_from_station1.apply(&at.position_m);
        let own = turn * at.position_covariance * turn.transpose();
        PrismInstant {
            time_s: at.time_s,
            position_m,
            velocity_m_per_s: turn * at.velocity_m_per_s,
            position_covariance: own + self.position_covariance(&position_m),
            velocity_covariance: turn * at.velocity_covariance * turn.transpose(),
        }
    }

    fn turn(&self) -> Matrix3<f64> {
        let axis = |axis: Vector3<f64>| self.site_from_station1.rotate(&axis);
        Matrix3::from_columns(&[Vector3::x(), Vector3::y(), Vector3::z()].map(axis))
    }

    /// Jacobian of a position with respect to the heading of the frame (m/rad).
    fn by_turn(&self, position_m: &Vector3<f64>) -> Vector3<f64> {
        Vector3::z().cross(&(position_m - self.middle_m))
    }

    fn position_covariance(&self, position_m: &Vector3<f64>) -> Matrix3<f64> {
        let by_turn = self.by_turn(position_m);
        let shift = Matrix3::identity() * self.shift_variance_m2;
        shift + by_turn * by_turn.transpose() * self.turn_variance_rad2
    }
}

/// Surveyed coordinates of a point, and the mean of the stations' readings of it in station 1's frame (m); `None` if either is
/// missing.
fn pair(
    point: &ControlPoint,
    station1_from_station: &PerStation<RigidTransform>,
) -> Option<(Vector3<f64>, Vector3<f64>)> {
    Some((point.known_m?, seen_m(point, station1_from_station)?))
}

/// Mean of the stations' readings of a point in station 1's frame (m); `None` if no station read it.
pub fn seen_m(
    point: &ControlPoint,
    station1_from_station: &PerStation<RigidTransform>,
) -> Option<Vector3<f64>> {
    let readings = station1_from_station.iter().zip(&point.readings);
    let seen: Vec<Vector3<f64>> = readings
        .filter_map(|(transform, reading)| Some(transform.apply(&reading.as_ref()?.to_cartesian())))
        .collect();
    (!seen.is_empty()).then(|| seen.iter().sum::<Vector3<f64>>() / seen.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Polar;
    use crate::simulated_drives::{Preset, simulated};
    use nalgebra::UnitQuaternion;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    fn here() -> PerStation<RigidTransform> {
        PerStation::repeat(3, RigidTransform::IDENTITY)
    }

    /// The sample with one set of five surveyed points, with independent normal errors of each coordinate.
    fn surveyed(
        station1_from_site: &LevelTransform,
        sigma_m: f64,
        rng: &mut ChaCha8Rng,
    ) -> Deployment {
        let mut deployment = simulated(Preset::Hd2Tunnel, 2);
        let places = [
            [0.0, 0.0, 0.0],
            [30.0, 2.0, 1.0],
            [12.0, 25.0, 0.5],
            [-9.0, 11.0, 2.0],
            [4.0, -20.0, -1.0],
        ];
        let points = places.iter().zip(1..).map(|(place, marker)| {
            let known_m = Vector3::from(*place);
            let noise = Vector3::from_fn(|_, _| StandardNormal.sample(&mut *rng));
            let seen_m = station1_from_site.apply(&known_m) + sigma_m * noise;
            let readings = [Some(Polar::from_cartesian(seen_m)), None, None].into();
            ControlPoint { readings, ..ControlPoint::unread(marker, Some(known_m)) }
        });
        let points = points.collect();
        deployment.control_points =
            vec![ControlPointSet { file: "GCP.txt".into(), points, pillars: false }];
        deployment
    }

    fn a_pose() -> Pose {
        Pose {
            time_s: 7.0,
            position_m: Vector3::new(80.0, -35.0, 1.5),
            orientation: UnitQuaternion::from_euler_angles(0.1, -0.2, 1.1),
            covariance: Matrix6::identity() * 1e-12,
            twist: None,
            inter_prism_error_m: 0.0,
        }
    }

    #[test]
    fn exact_points_give_the_frame_and_poses_keep_their_distances() {
        let station1_from_site = LevelTransform::new(Vector3::new(100.0, -40.0, 3.0), 2.2);
        let deployment = surveyed(&station1_from_site, 0.0, &mut ChaCha8Rng::seed_from_u64(1));
        let site = SiteFrame::of(&deployment, &here()).expect("a frame");
        let pose = a_pose();
        let moved = site.pose(&pose);
        let expected = station1_from_site.inverse();
        assert!((moved.position_m - expected.apply(&pose.position_m)).norm() < 1e-9);
        let ahead = moved.orientation * Vector3::x();
        assert!((ahead - expected.rotate(&(pose.orientation * Vector3::x()))).norm() < 1e-9);
        assert_eq!(site.in_words(), "frame of GCP.txt (5 points, 0.0 mm rms)");
    }

    /// Monte Carlo test with a pose far from the points, whose σ is nearly that of the frame alone.
    #[test]
    fn the_frame_is_as_far_off_as_its_covariance_says() {
        const DRAWS: usize = 2000;
        let station1_from_site = LevelTransform::new(Vector3::new(10.0, -4.0, 3.0), -0.7);
        let exact = station1_from_site.inverse();
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let (mut position, mut heading, mut sigma_m) = (0.0, 0.0, 0.0);
        for _ in 0..DRAWS {
            let deployment = surveyed(&station1_from_site, 0.01, &mut rng);
            let site = SiteFrame::of(&deployment, &here()).expect("a frame");
            let moved = site.pose(&a_pose());
            let off = moved.position_m - exact.apply(&a_pose().position_m);
            let covariance = moved.covariance.fixed_view::<3, 3>(0, 0).into_owned();
            position += off.dot(&covariance.cholesky().expect("definite").solve(&off)) / 3.0;
            let turned = site.site_from_station1.yaw_rad - exact.yaw_rad;
            heading += turned * turned / moved.covariance[(5, 5)];
            sigma_m += moved.sigma().position_m / DRAWS as f64;
        }
        // σ is estimated from 11 degrees of freedom, so the expectation is a little above 1: 11 / 9.
        let mean = [position, heading].map(|sum| sum / DRAWS as f64);
        assert!(mean.iter().all(|mean| (1.05..1.4).contains(mean)), "{mean:?}");
        assert!((0.008..0.012).contains(&sigma_m), "{sigma_m}");
    }

    #[test]
    fn without_coordinates_or_on_one_spot_there_is_no_frame() {
        let tunnel = simulated(Preset::Hd2Tunnel, 2);
        assert!(matches!(SiteFrame::of(&tunnel, &here()), Err(NoSite::NoCoordinates(_))));
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let mut few = surveyed(&LevelTransform::IDENTITY, 0.0, &mut rng);
        few.control_points[0].points.truncate(1);
        assert!(matches!(SiteFrame::of(&few, &here()), Err(NoSite::TooFew(_))));
    }
}
