//! Prediction of the covariance of a planned drive, by the information matrix of the joint estimate.

use std::sync::Arc;

use nalgebra::{DMatrix, Vector3};

use super::drive::{Driven, drive};
use super::in_words;
use super::plan::{Plan, PlannedInstrument};
use super::prediction::{Held, OnTheWay, PlanError, Prediction};
use super::way;
use crate::simulation::{EPOCH_S, Scenario, Simulated};
use resect_core::calibration::inter_prism;
use resect_core::calibration::inter_prism::{Foreseen, PrismNetwork};
use resect_core::calibration::joint;
use resect_core::calibration::joint::loss::EFFICIENCY;
use resect_core::calibration::joint::prism_motion::MotionInstant;
use resect_core::calibration::joint::{
    ExpectedNoise, GaussMarkov, JointEstimate, Layout, NoiseLevels, OBSERVED_DISTANCE_SIGMA_M,
    RIG_FLEX_SIGMA_M, stated_range_m,
};
use resect_core::calibration::{ErrorSizes, Verdict};
use resect_core::deployment::pairwise_distances;
use resect_core::evaluation::far_end::{FarEnd, far_end};
use resect_core::evaluation::rig_motion::rig_pose;
use resect_core::geometry::ARCSECOND_RAD;
use resect_core::geometry::{LevelTransform, RigidTransform};
use resect_core::network::{PerStation, Prism, StationPair};
use resect_core::pipeline::SampleFate;
use resect_core::progress::Progress;

/// Largest number of instants at which the σ of the vehicle's pose is predicted.
const MOST_INSTANTS: f64 = 400.0;
/// Mean duration of a simulated lost lock (s).
const LOST_LOCK_S: f64 = 7.75;
/// Factor by which linear interpolation reduces the variance of the noise of readings, on average.
const INTERPOLATED: f64 = 2.0 / 3.0;
/// Smallest jerk of a vehicle in the joint estimate (m/s³).
const LEAST_JERK_M_PER_S3: f64 = 0.01;
/// Correlation time of time-correlated range errors, which last seconds to minutes (s).
const WANDER_S: f64 = 12.0;

/// A simulated plan, with the predicted joint estimate.
pub struct Looked {
    pub driven: Driven,
    pub expected: ExpectedNoise,
    pub estimate: Option<JointEstimate>,
    /// Prediction from the inter-prism distances; `None` with one prism.
    pub foreseen: Option<Foreseen>,
}

impl Looked {
    /// Returns the estimate; `None` if a direction is unobservable.
    pub fn held(&self) -> Option<&JointEstimate> {
        let is_held = self.foreseen.as_ref().is_none_or(|foreseen| foreseen.is_held);
        self.estimate.as_ref().filter(|_| is_held)
    }
}

/// Simulates a plan and predicts the estimate from its readings.
pub fn look(plan: &Plan) -> Result<Looked, PlanError> {
    let driven = drive(plan)?;
    let expected = expected(plan, &driven.simulated);
    let truth = &driven.simulated.truth;
    let triplets = &driven.pipeline.triplets;
    let (followed, prisms_m) = plan.rig.followed(plan.stations_m.len());
    let inter_prism_m = &pairwise_distances(prisms_m.as_slice());
    let at_the_truth = (&truth.station1_from_station, inter_prism_m);
    let layout = Arc::new(Layout::new(&followed));
    let (sizes, progress) = (sizes(plan), Progress::default());
    let estimate = joint::predict(triplets, &layout, at_the_truth, &sizes, &expected, &progress);
    let estimate = estimate.unwrap_or_default();
    let covariance = estimate.as_ref().map(|estimate| estimate.covariance.clone());
    let foreseen = (prisms_m.len() > 1).then(|| {
        let network = PrismNetwork::new(followed, inter_prism_m);
        inter_prism::foresee(triplets, &network, &truth.station1_from_station, covariance)
    });
    let foreseen = foreseen.flatten();
    Ok(Looked { driven, expected, estimate, foreseen })
}

/// Predicts the covariance of an estimate from a planned drive, and its limits.
pub fn predict(plan: &Plan) -> Result<Prediction, PlanError> {
    let looked = look(plan)?;
    let held = looked.held().and_then(|found| held(plan, &looked.driven, found));
    let way = along_the_way(plan, &looked.driven, looked.held().filter(|_| held.is_some()));
    let Looked { driven, expected, foreseen, .. } = looked;
    let mirror_cost_ratio = foreseen.as_ref().and_then(|foreseen| {
        let (followed, _) = plan.rig.followed(plan.stations_m.len());
        let noise_m2 = distance_noise_m2(&driven, &followed, &expected.levels);
        let twin_m2 = foreseen.twin_mean_square_m2?;
        Some((twin_m2 + noise_m2) / (foreseen.mean_square_m2 + noise_m2))
    });
    let mut prediction = Prediction {
        verdict: Verdict::Good,
        findings: Vec::new(),
        held,
        observability: foreseen.map(|foreseen| foreseen.observability),
        mirror_cost_ratio,
        way,
        readings: driven.deployment.tracks.map(|track| track.measurements.len()),
        kept: driven.pipeline.counts(SampleFate::Kept),
        locks: driven.locks,
        duration_s: driven.simulated.scenario.duration_s,
        length_m: way::length_m(&plan.waypoints()),
    };
    (prediction.verdict, prediction.findings) = in_words::judged(plan, &prediction);
    Ok(prediction)
}

/// Returns the standard deviations of the priors, that of the rig's distances included.
pub fn sizes(plan: &Plan) -> ErrorSizes {
    ErrorSizes { inter_prism_m: plan.rig.inter_prism_sigma_m, ..plan.errors }
}

/// Returns the noise levels that an estimate would learn from the readings of such a drive.
pub fn expected(plan: &Plan, simulated: &Simulated) -> ExpectedNoise {
    let PlannedInstrument { range_mm, range_ppm, angle_arcsec, .. } = plan.instrument;
    // Missing readings are modelled as more noise of the others.
    let more = (usable_share(&plan.instrument) * EFFICIENCY).sqrt().recip();
    let range_m = mean_range_m(simulated);
    let [horizontal, vertical] = jerk_m_per_s3(simulated);
    let angle_rad = more * angle_arcsec * ARCSECOND_RAD;
    let read_m = 1e-3 * range_mm + 1e-6 * range_ppm * range_m;
    ExpectedNoise {
        levels: NoiseLevels {
            distance_m: OBSERVED_DISTANCE_SIGMA_M,
            range: more * read_m / stated_range_m(range_m),
            horizontal_rad: angle_rad,
            vertical_rad: angle_rad,
            jitter_s: more * 1e-3 * plan.instrument.stamp_jitter_ms,
            horizontal_jerk_m_per_s3: horizontal,
            vertical_jerk_m_per_s3: vertical,
        },
        ranges: GaussMarkov {
            sigma_m: (1e-3 * plan.instrument.range_wander_mm).max(1e-4),
            correlation_s: WANDER_S,
        },
        across: GaussMarkov::SMALLEST,
        upward: GaussMarkov::SMALLEST,
    }
}

/// Share of usable readings with lost locks and outliers.
fn usable_share(instrument: &PlannedInstrument) -> f64 {
    let lost = (instrument.lost_locks_per_minute * LOST_LOCK_S / 60.0).min(0.9);
    (1.0 - lost) * (1.0 - instrument.outlier_share)
}

fn mean_range_m(simulated: &Simulated) -> f64 {
    let ranges_m = simulated.records.iter().map(|record| record.measurement.range_m);
    ranges_m.sum::<f64>() / simulated.records.len().max(1) as f64
}

/// Horizontal and vertical jerk of the prisms from reading to reading (m/s³, root mean square).
fn jerk_m_per_s3(simulated: &Simulated) -> [f64; 2] {
    let Scenario { rate_hz, duration_s, prisms_m, .. } = &simulated.scenario;
    let knots = (duration_s * rate_hz) as usize;
    let mut squares = Vector3::zeros();
    for prism_m in prisms_m {
        let at = |knot: usize| simulated.truth.motion.position_m(prism_m, knot as f64 / rate_hz);
        let places_m: Vec<Vector3<f64>> = (0..knots).map(at).collect();
        squares += places_m
            .windows(4)
            .map(|p| p[3] - p[0] - (p[2] - p[1]) * 3.0)
            .map(|difference_m| difference_m.component_mul(&difference_m))
            .sum::<Vector3<f64>>();
    }
    let jerks = (prisms_m.iter().count() * knots.saturating_sub(3)).max(1) as f64;
    [0.5 * (squares.x + squares.y), squares.z]
        .map(|square| ((square / jerks).sqrt() * rate_hz.powi(3)).max(LEAST_JERK_M_PER_S3))
}

/// Mean square of the noise of a distance between interpolated readings of two prisms (m²).
fn distance_noise_m2(driven: &Driven, followed: &PerStation<Prism>, levels: &NoiseLevels) -> f64 {
    let triplets = &driven.pipeline.triplets;
    let transforms = &driven.simulated.truth.station1_from_station;
    let pairs = StationPair::among(followed.len());
    let pairs: Vec<[usize; 2]> = pairs.map(StationPair::indices).collect();
    let between_prisms = pairs.iter().filter(|[a, b]| followed[*a] != followed[*b]);
    let mut sum_m2 = 0.0;
    for index in 0..triplets.len() {
        let points_m = triplets.triplet_m(index);
        let placed = transforms.zip(&points_m, LevelTransform::apply);
        for [a, b] in between_prisms.clone().copied() {
            let along = (placed[a] - placed[b]).normalize();
            for station in [a, b] {
                let own = transforms[station].inverse().rotate(&along);
                let range_m = points_m[station].norm();
                let radial = own.dot(&(points_m[station] / range_m)).powi(2);
                let radial_m2 = (levels.range * stated_range_m(range_m)).powi(2);
                let across_m2 = (levels.horizontal_rad * range_m).powi(2);
                sum_m2 += radial * radial_m2 + (1.0 - radial) * across_m2;
            }
        }
    }
    INTERPOLATED * sum_m2 / (between_prisms.count() * triplets.len()) as f64
}

fn held(plan: &Plan, driven: &Driven, estimate: &JointEstimate) -> Option<Held> {
    let transforms =
        driven.simulated.truth.station1_from_station.map(|level| RigidTransform::from(*level));
    let triplets = &driven.pipeline.triplets;
    let covariance = estimate.covariance.clone();
    let found = far_end(&transforms, &covariance, &triplets.points_m)?;
    Some(Held {
        sigma: estimate.sigma(),
        dominant: (0..covariance.nrows()).map(|place| estimate.largest_source(place)).collect(),
        covariance,
        far_end: FarEnd { position_m: found.position_m + plan.stations_m[0], ..found },
    })
}

/// Returns the vehicle's positions about once a second, with their σ if the estimate has a motion.
fn along_the_way(plan: &Plan, driven: &Driven, estimate: Option<&JointEstimate>) -> Vec<OnTheWay> {
    let Simulated { scenario, truth, .. } = &driven.simulated;
    let step_s = (scenario.duration_s / MOST_INSTANTS).max(1.0);
    let steps = (scenario.duration_s / step_s) as usize;
    let times_s: Vec<f64> = (0..=steps).map(|k| EPOCH_S + k as f64 * step_s).collect();
    let at = |time_s: f64, sigma: Option<[Option<f64>; 2]>| OnTheWay {
        time_s: time_s - EPOCH_S,
        position_m: plan.stations_m[0] + truth.motion.pose(time_s - EPOCH_S).0,
        position_sigma_m: sigma.and_then(|[position_m, _]| position_m),
        rotation_sigma_rad: sigma.and_then(|[_, rotation_rad]| rotation_rad),
    };
    let known: Vec<(f64, [Option<f64>; 2])> =
        match estimate.map(|found| found.solution.instants(&times_s, &Progress::default())) {
            Some(Ok(instants)) => {
                instants.iter().filter_map(|instant| sigma_of_instant(plan, instant)).collect()
            }
            _ => Vec::new(),
        };
    let mut known = known.into_iter().peekable();
    let with_sigma = |time_s: &f64| {
        let sigma = known.next_if(|(known_s, _)| known_s == time_s).map(|(_, sigma)| sigma);
        at(*time_s, sigma)
    };
    times_s.iter().map(with_sigma).collect()
}

/// Time of an instant, and root mean square errors of the vehicle's position (m) and rotation (rad). Fewer than three prisms have no
/// rotation, and the position of their middle.
fn sigma_of_instant(plan: &Plan, instant: &MotionInstant) -> Option<(f64, [Option<f64>; 2])> {
    let (_, prisms_m) = plan.rig.followed(plan.stations_m.len());
    let Some(pose) = rig_pose(prisms_m.as_slice(), RIG_FLEX_SIGMA_M, instant, None) else {
        let prisms = instant.position_m.len() / 3;
        let share = 1.0 / prisms as f64;
        let mean = |axis: usize, at: usize| if at % 3 == axis { share } else { 0.0 };
        let by_prisms = DMatrix::from_fn(3, 3 * prisms, mean);
        let covariance = &by_prisms * &instant.position_covariance * by_prisms.transpose();
        return Some((instant.time_s, [Some(covariance.trace().sqrt()), None]));
    };
    let rms = |at: usize| Some(pose.covariance.fixed_view::<3, 3>(at, at).trace().sqrt());
    Some((instant.time_s, [rms(0), rms(3)]))
}
