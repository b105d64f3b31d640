//! The usual tilt of a vehicle, where its prisms do not determine it.
//!
//! Two prisms leave the rotation about their line open. Where all are followed, their poses show how far the vehicle tilts, and how much that
//! changes with time. Elsewhere the tilt is predicted from the last instant before and the first one after, by the covariance of
//! tilts at such distances (simple kriging; Chilès & Delfiner 2012, "Geostatistics", chapter 3).

use nalgebra::{DMatrix, DVector, Vector3};

use super::trajectory::Pose;

/// Fewest pairs of known instants from which a change is taken.
const FEWEST: usize = 10;
/// Instants further apart are independent (s). The change of the tilt is known for whole seconds.
const LONGEST_S: usize = 60;
/// Least variance of the expected tilt, as a share of that of its change within a second.
const LEAST: f64 = 0.25;

/// The tilt of a vehicle over a drive.
#[derive(Clone, Debug)]
pub struct UsualTilt {
    known: Vec<KnownTilt>,
    /// Mean direction upwards in the vehicle's frame (unit vector).
    mean: Vector3<f64>,
    /// Covariance of the tilts about each axis at instants 0, 1, 2, … s apart (rad²).
    covariance_rad2: Vec<f64>,
}

#[derive(Clone, Debug)]
struct KnownTilt {
    time_s: f64,
    /// Direction upwards in the vehicle's frame (unit vector).
    up: Vector3<f64>,
    /// Variance of the tilt about each axis (rad²).
    variance_rad2: f64,
}

/// The expected tilt at one instant.
#[derive(Clone, Debug, PartialEq)]
pub struct ExpectedTilt {
    /// Direction upwards in the vehicle's frame (unit vector).
    pub up: Vector3<f64>,
    /// Standard deviation about each level axis (rad).
    pub sigma_rad: f64,
    /// Standard deviation of the rotation rate about each level axis (rad/s).
    pub rate_sigma_rad_per_s: f64,
}

impl UsualTilt {
    /// The tilt by poses in order of time at which all prisms are followed; `None` with few of them.
    pub fn new(poses: &[Pose]) -> Option<Self> {
        let known = |pose: &Pose| KnownTilt {
            time_s: pose.time_s,
            up: pose.orientation.inverse() * Vector3::z(),
            variance_rad2: 0.5 * (pose.covariance[(3, 3)] + pose.covariance[(4, 4)]),
        };
        let known: Vec<KnownTilt> = poses.iter().map(known).collect();
        let mean = known.iter().map(|known| known.up).sum::<Vector3<f64>>().try_normalize(0.0)?;
        let squared = |tilt: Vector3<f64>| 0.5 * tilt.norm_squared();
        let variance_rad2 =
            known.iter().map(|known| squared(known.up - mean)).sum::<f64>() / known.len() as f64;
        let mut changes = vec![(0.0, 0_usize); LONGEST_S];
        for (index, from) in known.iter().enumerate() {
            for to in &known[index + 1..] {
                let apart = (to.time_s - from.time_s).round() as usize;
                let Some((sum, count)) = changes.get_mut(apart) else { break };
                *sum += squared(to.up - from.up) / 2.0;
                *count += 1;
            }
        }
        if changes[1].1 < FEWEST || variance_rad2 <= 0.0 {
            return None;
        }
        // A covariance that grew with the distance would give weights far beyond one.
        let mut least_rad2 = variance_rad2;
        let covariance_rad2 = changes.into_iter().enumerate().map(|(apart, (sum, count))| {
            least_rad2 = match (apart, count >= FEWEST) {
                (0, _) => variance_rad2,
                (_, true) => (variance_rad2 - sum / count as f64).clamp(0.0, least_rad2),
                // Few drives have pairs at one distance and not at the others.
                (_, false) => 0.0,
            };
            least_rad2
        });
        Some(Self { covariance_rad2: covariance_rad2.collect(), known, mean })
    }

    /// Returns the expected tilt at an instant (s).
    pub fn at(&self, time_s: f64) -> ExpectedTilt {
        let variance_rad2 = self.covariance_rad2[0];
        let index = self.known.partition_point(|known| known.time_s <= time_s);
        let beside: Vec<&KnownTilt> =
            self.known[index.saturating_sub(1)..].iter().take(2).collect();
        let covariance = |apart_s: f64| self.covariance(apart_s);
        let with_instant = DVector::from_iterator(
            beside.len(),
            beside.iter().map(|known| covariance(known.time_s - time_s)),
        );
        let among = DMatrix::from_fn(beside.len(), beside.len(), |i, k| {
            let error_rad2 = if i == k { beside[i].variance_rad2 } else { 0.0 };
            covariance(beside[i].time_s - beside[k].time_s) + error_rad2
        });
        let weights = among.cholesky().map(|among| among.solve(&with_instant));
        let weights = weights.unwrap_or_else(|| DVector::zeros(beside.len()));
        let deviations = beside.iter().zip(&weights);
        let deviation = deviations.map(|(known, weight)| (known.up - self.mean) * *weight);
        // A change within less than a second is at least as large as its share of that within one.
        let least_rad2 = LEAST * (variance_rad2 - self.covariance_rad2[1]);
        let remaining_rad2 = (variance_rad2 - with_instant.dot(&weights)).max(least_rad2);
        // Most of the errors of known tilts is common to all instants.
        let error_rad2 = beside.iter().map(|known| known.variance_rad2).fold(0.0, f64::max);
        ExpectedTilt {
            up: (self.mean + deviation.sum::<Vector3<f64>>()).normalize(),
            sigma_rad: (remaining_rad2 + error_rad2).sqrt(),
            rate_sigma_rad_per_s: (2.0 * (variance_rad2 - self.covariance_rad2[1])).sqrt(),
        }
    }

    /// Covariance of the tilts at instants that are this far apart (s), about each axis (rad²).
    fn covariance(&self, apart_s: f64) -> f64 {
        let (second, share) = (apart_s.abs() as usize, apart_s.abs().fract());
        let rad2_at = |second: usize| self.covariance_rad2.get(second).copied().unwrap_or(0.0);
        rad2_at(second) + share * (rad2_at(second + 1) - rad2_at(second))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix6, UnitQuaternion};
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    /// Poses once a second whose roll and pitch are Ornstein–Uhlenbeck processes (σ in rad, correlation time in s).
    fn poses(sigma_rad: f64, correlation_s: f64, count: usize) -> Vec<Pose> {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let keep = (-1.0 / correlation_s).exp();
        let mut tilt_rad = [0.0; 2];
        let mut pose = |second: usize| {
            for angle_rad in &mut tilt_rad {
                *angle_rad = keep * *angle_rad + sigma_rad * (1.0 - keep * keep).sqrt() * normal();
            }
            let yaw_rad = 0.1 * second as f64;
            Pose {
                time_s: second as f64,
                position_m: Vector3::zeros(),
                orientation: UnitQuaternion::from_euler_angles(tilt_rad[0], tilt_rad[1], yaw_rad),
                covariance: Matrix6::identity() * 1e-8,
                twist: None,
                inter_prism_error_m: 0.0,
            }
        };
        (0..count).map(&mut pose).collect()
    }

    /// The covariances of a short drive hardly fall at first, and may even rise. Weights of hundreds would tilt the vehicle by tens of
    /// degrees.
    #[test]
    fn the_expected_tilt_of_a_short_drive_is_no_larger_than_the_known_ones() {
        for seconds in [12, 20, 40, 60] {
            let all = poses(0.03, 20.0, seconds);
            let (before, after) = all.split_at(seconds / 2);
            let gap_s = 8.0;
            let later =
                after.iter().map(|pose| Pose { time_s: pose.time_s + gap_s, ..pose.clone() });
            let known: Vec<Pose> = before.iter().cloned().chain(later).collect();
            let tilt = UsualTilt::new(&known).expect("enough poses");
            let from_mean_rad = |up: Vector3<f64>| (up - tilt.mean).norm();
            let most_rad =
                tilt.known.iter().map(|known| from_mean_rad(known.up)).fold(0.0, f64::max);
            for tenth in 0..80 {
                let time_s = before[before.len() - 1].time_s + 0.1 * f64::from(tenth);
                let found_rad = from_mean_rad(tilt.at(time_s).up);
                assert!(found_rad < 2.0 * most_rad, "{seconds} s: {found_rad} of {most_rad}");
            }
        }
    }

    #[test]
    fn the_expected_tilt_is_as_certain_as_it_says_in_gaps_of_any_length() {
        let all = poses(0.03, 8.0, 20_000);
        for gap in [1, 3, 10, 40] {
            // Of each period, the last `gap` poses are not known.
            let period = 3 * gap + 20;
            let (known, unknown): (Vec<Pose>, Vec<Pose>) = all
                .iter()
                .cloned()
                .partition(|pose| (pose.time_s as usize) % period < period - gap);
            let tilt = UsualTilt::new(&known).expect("many poses");
            let squares = unknown.iter().map(|pose| {
                let expected = tilt.at(pose.time_s);
                let up = pose.orientation.inverse() * Vector3::z();
                0.5 * (up - expected.up).norm_squared() / expected.sigma_rad.powi(2)
            });
            let mean = squares.sum::<f64>() / unknown.len() as f64;
            assert!((0.9..1.1).contains(&mean), "gap of {gap} s: {mean}");
            let sigma_rad = tilt.at(unknown[gap / 2].time_s).sigma_rad;
            assert!(sigma_rad < 0.032, "{sigma_rad}");
        }
        assert!(UsualTilt::new(&all[..5]).is_none());
    }
}
