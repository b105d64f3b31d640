//! The Cramér–Rao bound of a simulated drive: the least covariance of an unbiased estimate of its extrinsics.
//!
//! It assumes the same drive, observed by the three stations at the same instants, with free poses of the rig: of nine measurements an
//! instant, six determine the pose, and the three distances remain. The bound is their Fisher information with the simulated noise, and
//! priors for the randomly drawn parameters. Derivatives are finite differences: the bound shares no code with the estimator.

use nalgebra::{Matrix3, Rotation3, SMatrix, SVector, Vector3};
use resect_core::analysis::Analysis;
use resect_core::geometry::Polar;
use resect_core::network::Pair;
use resect_tools::simulation::{EPOCH_S, Simulated};

/// Parameters: (x, y, z, yaw) of stations 2 and 3, their clocks, tilts of all stations, distances, prism constant, drifts.
const UNKNOWNS: usize = 22;
const CLOCKS: usize = 8;
const TILTS: usize = 10;
const DISTANCES: usize = 16;
const CONSTANT: usize = 19;
const DRIFTS: usize = 20;

type Unknowns = SVector<f64, UNKNOWNS>;

/// Standard deviations of the parameters that a campaign draws at random.
#[derive(Clone, Copy)]
pub struct Drawn {
    pub tilt_rad: f64,
    pub distance_m: f64,
    /// Error of the prism constant in the written distances.
    pub rig_constant_m: f64,
    pub prism_constant_m: f64,
    pub drift: f64,
}

/// Bound of the covariance of (x, y, z, yaw) of stations 2 and 3, over the
/// instants that the pipeline keeps. `None` if a direction is unconstrained.
pub fn bound(
    simulated: &Simulated,
    analysis: &Analysis,
    drawn: &Drawn,
) -> Option<SMatrix<f64, 8, 8>> {
    let mut information = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::zeros();
    let prior = |sigma: f64| sigma.max(1e-7).powi(-2);
    for place in TILTS..DISTANCES {
        information[(place, place)] += prior(drawn.tilt_rad);
    }
    let mut of_distances = information.fixed_view_mut::<3, 3>(DISTANCES, DISTANCES);
    of_distances += written_distances_covariance_m2(simulated, drawn).try_inverse()?;
    information[(CONSTANT, CONSTANT)] += prior(drawn.prism_constant_m);
    for place in DRIFTS..UNKNOWNS {
        information[(place, place)] += prior(drawn.drift);
    }
    for interval in analysis.pipeline.kept_intervals.iter() {
        let readings = (interval.length_s() * simulated.scenario.rate_hz).floor() as usize;
        for reading in 0..readings {
            let time_s = interval.start_s - EPOCH_S + reading as f64 / simulated.scenario.rate_hz;
            information += at(simulated, time_s);
        }
    }
    let covariance = information.cholesky()?.inverse();
    Some(covariance.fixed_view::<8, 8>(0, 0).into_owned())
}

/// Returns the covariance of the written distances, which share the error of the prism constant.
fn written_distances_covariance_m2(simulated: &Simulated, drawn: &Drawn) -> Matrix3<f64> {
    let sights_m = simulated.rig_reading.map(|own| own.to_cartesian());
    let by_constant = Vector3::from_iterator(Pair::among(3).map(Pair::indices).map(|[a, b]| {
        let along = (sights_m[a] - sights_m[b]).normalize();
        (sights_m[a].normalize() - sights_m[b].normalize()).dot(&along)
    }));
    Matrix3::from_diagonal_element(drawn.distance_m.powi(2))
        + drawn.rig_constant_m.powi(2) * by_constant * by_constant.transpose()
}

/// Returns the information of one instant.
fn at(simulated: &Simulated, time_s: f64) -> SMatrix<f64, UNKNOWNS, UNKNOWNS> {
    let truth = &simulated.truth;
    let seen = |time_s: f64| -> [Vector3<f64>; 3] {
        std::array::from_fn(|station| {
            let prism_m = truth.motion.position_m(&truth.prisms_m[station], time_s);
            truth.station1_from_station[station].inverse().apply(&prism_m)
        })
    };
    let points_m = seen(time_s);
    let later_m = seen(time_s + 0.05);
    let earlier_m = seen(time_s - 0.05);
    let placed = |unknowns: &Unknowns, moved: Option<(usize, Vector3<f64>)>| -> [Vector3<f64>; 3] {
        std::array::from_fn(|station| {
            let mut point = points_m[station];
            if let Some((_, by)) = moved.filter(|(which, _)| *which == station) {
                point += by;
            }
            point += point.normalize() * unknowns[CONSTANT];
            if station > 0 {
                let velocity = (later_m[station] - earlier_m[station]) / 0.1;
                let since_s = time_s - 0.5 * simulated.scenario.duration_s;
                let late_s =
                    unknowns[CLOCKS + station - 1] + since_s * unknowns[DRIFTS + station - 1];
                point += velocity * late_s;
            }
            let at = TILTS + 2 * station;
            point = Rotation3::new(Vector3::new(unknowns[at], unknowns[at + 1], 0.0)) * point;
            let mut placed = truth.station1_from_station[station].rotate(&point);
            if station > 0 {
                let at = 4 * (station - 1);
                let yaw = Rotation3::from_axis_angle(&Vector3::z_axis(), unknowns[at + 3]);
                placed = yaw * placed + unknowns.fixed_rows::<3>(at);
            }
            placed + truth.station1_from_station[station].translation_m
        })
    };
    let errors = |unknowns: &Unknowns, moved: Option<(usize, Vector3<f64>)>| {
        let placed = placed(unknowns, moved);
        Vector3::from_iterator(Pair::among(3).map(Pair::indices).enumerate().map(
            |(pair, [a, b])| {
                (placed[a] - placed[b]).norm()
                    - truth.inter_prism_m[pair]
                    - unknowns[DISTANCES + pair]
            },
        ))
    };
    const STEP: f64 = 1e-5;
    let mut slopes = SMatrix::<f64, 3, UNKNOWNS>::zeros();
    for place in 0..UNKNOWNS {
        let mut step = Unknowns::zeros();
        step[place] = STEP;
        let slope = (errors(&step, None) - errors(&-step, None)) / (2.0 * STEP);
        slopes.set_column(place, &slope);
    }
    let mut noise_m2 = Matrix3::zeros();
    let none = Unknowns::zeros();
    for station in 0..3 {
        let mut slope = Matrix3::zeros();
        for axis in 0..3 {
            let mut step = Vector3::zeros();
            step[axis] = STEP;
            let by = errors(&none, Some((station, step))) - errors(&none, Some((station, -step)));
            slope.set_column(axis, &(by / (2.0 * STEP)));
        }
        noise_m2 +=
            slope * reading_covariance_m2(simulated, &points_m[station]) * slope.transpose();
    }
    let weight = noise_m2.cholesky().expect("noise").inverse();
    slopes.transpose() * weight * slopes
}

/// Propagates the noise of range and angles, by finite differences.
fn reading_covariance_m2(simulated: &Simulated, point_m: &Vector3<f64>) -> Matrix3<f64> {
    let polar = Polar::from_cartesian(*point_m);
    let noise = &simulated.scenario.noise;
    let along = point_m.normalize() * noise.range_sigma_m;
    let moved = |azimuth_rad: f64, zenith_rad: f64| {
        let turned = Polar {
            azimuth_rad: polar.azimuth_rad + azimuth_rad,
            zenith_rad: polar.zenith_rad + zenith_rad,
            ..polar
        };
        turned.to_cartesian() - point_m
    };
    let sigma = noise.angle_sigma_rad;
    [along, moved(sigma, 0.0), moved(0.0, sigma)]
        .into_iter()
        .map(|column| column * column.transpose())
        .sum()
}
