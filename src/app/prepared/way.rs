//! The vehicle's path for plots and scene: position, attitude and speed, each with σ.

use nalgebra::{Matrix3, Vector3};

use resect_core::analysis::Analysis;
use resect_core::calibration::Estimate;
use resect_core::deployment::Deployment;
use resect_core::evaluation::trajectory::{Attitude, Pose, speed_of};
use resect_core::evaluation::vehicle::{Instants, PoseLimits, prism_by, trajectory_by};
use resect_core::geometry::wrap_to_pi;
use resect_core::network::Prism;

/// Rate of the instants (1/s), and their greatest number.
const RATE_HZ: f64 = 10.0;
const MOST: f64 = 40_000.0;
/// Time between neighbours from which there is a gap, in steps.
const GAP_STEPS: f64 = 1.5;

/// The path by one calibration.
#[derive(Clone, Debug, Default)]
pub struct Way {
    /// Instants in order of time.
    pub instants: Vec<Instant>,
    /// Greatest time between neighbours within a segment (s).
    pub step_s: f64,
    /// Reason for the absence of a path.
    pub why_not: Option<String>,
}

/// The vehicle, or the one prism, at one instant (station 1's frame).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instant {
    pub time_s: f64,
    pub position_m: Vector3<f64>,
    pub position_covariance_m2: Matrix3<f64>,
    pub speed_m_per_s: Option<Estimate>,
    pub attitude: Option<Attitude>,
    /// Square root of the mean variance of the rotation about the three axes (rad).
    pub turn_sigma_rad: Option<f64>,
}

impl Way {
    /// Returns the path by a calibration: the joint estimate's motion at even steps; with other methods, some of the triplets.
    pub fn of(deployment: &Deployment, analysis: &Analysis) -> Self {
        let answer = match &analysis.answer {
            Ok(answer) => answer,
            Err(why) => return Self::none(why.to_string()),
        };
        let (calibration, triplets) = (&answer.calibration, analysis.triplets());
        let times_s = &triplets.time_s;
        let of_triplets = times_s.first().copied().zip(times_s.last().copied());
        let motion = calibration.joint().map(|joint| &joint.solution);
        let of_motion = motion.and_then(|motion| {
            let both = |[first_s, _]: [f64; 2], [_, last_s]: [f64; 2]| [first_s, last_s];
            motion.spans_s().reduce(both).map(|[first_s, last_s]| (first_s, last_s))
        });
        let Some((first_s, last_s)) = of_motion.or(of_triplets) else {
            return Self::none("no triplet: no time with readings of all stations".to_owned());
        };
        let rate_hz = RATE_HZ.min(MOST / (last_s - first_s).max(1.0));
        let few;
        let (triplets, wanted, step_s) = if motion.is_some() {
            (&**triplets, Instants::Rate(rate_hz), 1.0 / rate_hz)
        } else {
            let stride = (times_s.len() as f64 / MOST).ceil().max(1.0);
            let some: Vec<usize> = (0..times_s.len()).step_by(stride as usize).collect();
            few = triplets.select(&some);
            (&few, Instants::Usual, stride / analysis.settings.pipeline.rate_hz)
        };
        let followed = &analysis.offer.followed;
        let found = if Prism::is_one(followed) {
            prism_by(deployment, triplets, calibration, wanted).map(|found| {
                let instants = found.iter().map(|at| Instant {
                    time_s: at.time_s,
                    position_m: at.position_m,
                    position_covariance_m2: at.position_covariance,
                    speed_m_per_s: Some(speed_of(&at.velocity_m_per_s, &at.velocity_covariance)),
                    attitude: None,
                    turn_sigma_rad: None,
                });
                instants.collect::<Vec<Instant>>()
            })
        } else {
            // Poses whose readings contradict the rig stay visible.
            let limits = PoseLimits { inter_prism_error_m: f64::INFINITY, ..PoseLimits::default() };
            trajectory_by(deployment, triplets, followed, calibration, wanted, &limits)
                .map(|(trajectory, _)| trajectory.poses.iter().map(Instant::of).collect())
        };
        match found {
            Ok(instants) => Self { instants, step_s, why_not: None },
            Err(why) => Self::none(why.to_string()),
        }
    }

    /// Returns the longest time between neighbours without a gap (s).
    pub fn longest_step_s(&self) -> f64 {
        GAP_STEPS * self.step_s
    }

    fn none(why: String) -> Self {
        Self { why_not: Some(why), ..Self::default() }
    }

    /// Returns the vehicle at a time, linearly interpolated between two
    /// neighbours; at the end of a segment its last state, and `None` in a gap.
    pub fn at(&self, time_s: f64) -> Option<Instant> {
        let after = self.instants.partition_point(|at| at.time_s < time_s);
        let around = &self.instants[after.saturating_sub(1)..self.instants.len().min(after + 1)];
        let most_s = self.longest_step_s();
        if let [before, after] = around
            && after.time_s - before.time_s <= most_s
        {
            let share = (time_s - before.time_s) / (after.time_s - before.time_s);
            return Some(before.towards(after, share));
        }
        let distance = |at: &&Instant| (at.time_s - time_s).abs();
        let nearest = around.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        (distance(&nearest) <= most_s).then_some(*nearest)
    }

    /// Returns the segments without a gap that overlap a span, each with the adjacent instants.
    pub fn pieces(&self, span_s: [f64; 2]) -> impl Iterator<Item = &[Instant]> {
        let from = self.instants.partition_point(|at| at.time_s < span_s[0]).saturating_sub(1);
        let to = self.instants.partition_point(|at| at.time_s <= span_s[1]);
        let seen = &self.instants[from..(to + 1).min(self.instants.len()).max(from)];
        let most_s = self.longest_step_s();
        seen.chunk_by(move |a, b| b.time_s - a.time_s <= most_s)
    }
}

impl Instant {
    /// Returns z of the position.
    pub fn height_m(&self) -> Estimate {
        let sigma = self.position_covariance_m2[(2, 2)].max(0.0).sqrt();
        Estimate { value: self.position_m.z, sigma }
    }

    /// Returns the square root of the mean variance of the three axes.
    pub fn position_sigma_m(&self) -> f64 {
        (self.position_covariance_m2.trace() / 3.0).max(0.0).sqrt()
    }

    /// Interpolates linearly to a neighbour: share 0 is here, 1 is there.
    fn towards(&self, other: &Self, share: f64) -> Self {
        let between = |from: f64, to: f64| from + share * (to - from);
        let number = |from: Estimate, to: Estimate| Estimate {
            value: between(from.value, to.value),
            sigma: between(from.sigma, to.sigma),
        };
        let angle = |from: Estimate, to: Estimate| Estimate {
            value: wrap_to_pi(from.value + share * wrap_to_pi(to.value - from.value)),
            sigma: between(from.sigma, to.sigma),
        };
        let covariance_m2 = other.position_covariance_m2 - self.position_covariance_m2;
        let attitudes = self.attitude.zip(other.attitude);
        Self {
            time_s: between(self.time_s, other.time_s),
            position_m: self.position_m.lerp(&other.position_m, share),
            position_covariance_m2: self.position_covariance_m2 + share * covariance_m2,
            speed_m_per_s: self.speed_m_per_s.zip(other.speed_m_per_s).map(|(a, b)| number(a, b)),
            attitude: attitudes.map(|(a, b)| Attitude {
                yaw_rad: angle(a.yaw_rad, b.yaw_rad),
                pitch_rad: angle(a.pitch_rad, b.pitch_rad),
                roll_rad: angle(a.roll_rad, b.roll_rad),
            }),
            turn_sigma_rad: self
                .turn_sigma_rad
                .zip(other.turn_sigma_rad)
                .map(|(a, b)| between(a, b)),
        }
    }

    fn of(pose: &Pose) -> Self {
        Self {
            time_s: pose.time_s,
            position_m: pose.position_m,
            position_covariance_m2: pose.covariance.fixed_view::<3, 3>(0, 0).into_owned(),
            speed_m_per_s: pose.speed_m_per_s(),
            attitude: Some(pose.attitude()),
            turn_sigma_rad: Some(pose.sigma().orientation_rad),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::prepared::channels::Channel;
    use resect_core::analysis::{Analyst, Settings};
    use resect_core::calibration::Method;
    use resect_core::evaluation::vehicle::vehicle_at;
    use resect_io::sample::Sample;

    #[test]
    fn the_way_of_the_sample_is_even_and_has_every_channel() {
        let deployment = Sample::Warthog.open().expect("built in");
        let analysis = Analyst::new(deployment.clone().into()).run(&Settings::default());
        let way = Way::of(&deployment, &analysis);
        assert!(way.why_not.is_none() && way.instants.len() > 2000, "{}", way.instants.len());
        let all_s = [f64::NEG_INFINITY, f64::INFINITY];
        let pieces: Vec<&[Instant]> = way.pieces(all_s).collect();
        assert_eq!(pieces.iter().map(|p| p.len()).sum::<usize>(), way.instants.len());
        let middle = way.instants[way.instants.len() / 2];
        assert_eq!(way.at(middle.time_s), Some(middle));
        assert!(way.at(way.instants[0].time_s - 60.0).is_none());
        for channel in &Channel::ALL[..Channel::OF_VEHICLE] {
            let value = channel.of_vehicle(&middle).expect("there");
            assert!(value.value.is_finite() && value.sigma >= 0.0, "{channel:?} {value:?}");
        }
        // A short window of a long drive includes the adjacent instants.
        let some = way.pieces([middle.time_s, middle.time_s + 1.0]).map(<[_]>::len).sum::<usize>();
        assert!((10..=13).contains(&some), "{some}");
    }

    /// The scene reads the vehicle from the motion at the cursor's time, the channels pane from its path.
    #[test]
    fn at_the_cursor_the_way_is_where_the_scene_has_the_vehicle() {
        let deployment = Sample::Warthog.open().expect("built in");
        let analysis = Analyst::new(deployment.clone().into()).run(&Settings::default());
        let calibration = &analysis.answer.as_ref().expect("an answer").calibration;
        let way = Way::of(&deployment, &analysis);
        let steps = (way.instants.windows(2)).filter(|two| two[1].time_s - two[0].time_s < 0.15);
        let mut off_sigmas: Vec<f64> = Vec::new();
        for two in steps.step_by(7) {
            let time_s = two[0].time_s + 0.04;
            let at = way.at(time_s).expect("between two");
            assert!((at.time_s - time_s).abs() < 1e-6);
            let heading = at.attitude.expect("a rig").yaw_rad;
            let vehicle = vehicle_at(&deployment, calibration, time_s).expect("in a stretch");
            off_sigmas.push(wrap_to_pi(vehicle.yaw_rad() - heading.value).abs() / heading.sigma);
        }
        off_sigmas.sort_by(f64::total_cmp);
        // The scene weights the prisms without their covariance. Where the motion has them 3 mm from the rig's distances, headings differ by up to 1.4 σ.
        let share = |percent: usize| off_sigmas[off_sigmas.len() * percent / 100];
        assert!(share(50) < 0.2 && share(98) < 1.0, "{} σ, {} σ", share(50), share(98));
    }

    #[test]
    fn by_the_papers_d_there_are_poses_of_triplets_without_speed() {
        let deployment = Sample::Warthog.open().expect("built in");
        let mut settings = Settings::default();
        settings.calibration = settings.calibration.with_method(Method::InterPrism);
        let analysis = Analyst::new(deployment.clone().into()).run(&settings);
        let way = Way::of(&deployment, &analysis);
        assert_eq!(way.instants.len(), analysis.triplets().len());
        assert!(way.instants.iter().all(|at| at.speed_m_per_s.is_none()));
        assert!(way.pieces([f64::NEG_INFINITY, f64::INFINITY]).count() > 5);
    }
}
