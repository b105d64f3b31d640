//! Time of reading, of each stage, of each calibration and of the whole path, at 2e3 to 2e6 triplets.
//!
//! `joint` is the whole calibration by the joint estimate, checks included, here and on the published run
//! (`field/joint`, if that data is beside the project).
//!
//! Writes the same triplets to `target/bench-triplets/`, where `peer_scipy.py` and `peer_ceres.cpp` solve the same problem; the
//! `levenberg-marquardt` crate does so here. `benches/table` runs all of them and prints the README's table.

use resect_core::network::Pair;
use std::hint::black_box;
use std::sync::Arc;

use criterion::{BenchmarkId, Criterion, SamplingMode, criterion_group, criterion_main};
use nalgebra_peer::{DVector, Dyn, Matrix, OMatrix, OVector, Owned, U8, Vector3};
use resect_core::analysis::{Analysis, Analyst, Settings};
use resect_core::calibration;
use resect_core::calibration::{CalibrationSettings, Method, Offer, PriorMethod};
use resect_core::deployment::Deployment;
use resect_core::geometry::RigidTransform;
use resect_core::pipeline;
use resect_core::pipeline::{Interpolation, PipelineSettings, Triplets};
use resect_io::open::open;
use resect_tools::simulation::{Preset, simulate_scenario};

type Vector8 = OVector<f64, U8>;

/// A Warthog drive long enough for about this many triplets.
fn deployment(triplets: usize) -> Arc<Deployment> {
    let mut scenario = Preset::Warthog.scenario();
    // Outliers and lost locks cost about a third of the time.
    scenario.duration_s = triplets as f64 / 10.0 * 1.38;
    Arc::new(
        resect_io::simulation_files::open(&simulate_scenario(&scenario, 1)).expect("simulated"),
    )
}

fn benchmarks(criterion: &mut Criterion) {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("target/bench-triplets");
    std::fs::create_dir_all(&folder).expect("target can be written");
    field(criterion);
    for size in [2_000, 20_000, 200_000, 2_000_000] {
        let deployment = deployment(size);
        let mut settings = Settings::default();
        settings.calibration.method = Some(Method::InterPrism);
        let analysis = Analyst::new(Arc::clone(&deployment)).run(&settings);
        let triplets = Arc::clone(&analysis.pipeline.triplets);
        write_for_peers(&deployment, &analysis, &folder.join(format!("{size}")));
        eprintln!("{size}: {} triplets", triplets.len());

        let mut group = criterion.benchmark_group("path");
        group.sample_size(if size > 100_000 { 10 } else { 40 });
        // Benchmarks of seconds are not repeated more often than necessary.
        group.sampling_mode(if size > 100_000 { SamplingMode::Flat } else { SamplingMode::Auto });
        group.bench_function(BenchmarkId::new("pipeline", size), |b| {
            b.iter(|| pipeline::run(black_box(&deployment), &settings.pipeline));
        });
        for (name, interpolation) in
            [("pipeline-gp", Interpolation::Gp), ("pipeline-wnoa", Interpolation::Wnoa)]
        {
            let settings = PipelineSettings { interpolation, ..settings.pipeline };
            group.bench_function(BenchmarkId::new(name, size), |b| {
                b.iter(|| pipeline::run(black_box(&deployment), &settings));
            });
        }
        for (name, prior) in
            [("d-closed-form", PriorMethod::ClosedForm), ("d-search", PriorMethod::Search)]
        {
            let method = Some(Method::InterPrism);
            let settings = CalibrationSettings { method, prior, ..Default::default() };
            let offer = Offer::of(&deployment, &triplets);
            group.bench_function(BenchmarkId::new(name, size), |b| {
                b.iter(|| calibration::solve(&deployment, black_box(&triplets), &settings, &offer));
            });
        }
        let (joint, offer) = (CalibrationSettings::default(), Offer::of(&deployment, &triplets));
        group.bench_function(BenchmarkId::new("joint", size), |b| {
            b.iter(|| calibration::solve(&deployment, black_box(&triplets), &joint, &offer));
        });
        // Every stage runs again, since the threshold of the first one alternates.
        let mut analyst = Analyst::new(Arc::clone(&deployment));
        let mut odd = false;
        group.bench_function(BenchmarkId::new("whole", size), |b| {
            b.iter(|| {
                odd = !odd;
                let mut settings = settings;
                settings.pipeline.thresholds.tau_r_m_per_s = if odd { 2.1 } else { 2.0 };
                analyst.run(black_box(&settings))
            });
        });
        let distances: [f64; 3] = *deployment
            .rig
            .as_ref()
            .expect("simulated")
            .inter_prism_m
            .as_array()
            .expect("three prisms");
        group.bench_function(BenchmarkId::new("peer-levenberg-marquardt", size), |b| {
            b.iter(|| {
                let problem = Peer::new(black_box(&triplets), distances, good_prior(&analysis));
                let (_, report) = levenberg_marquardt::LevenbergMarquardt::new().minimize(problem);
                assert!(report.termination.was_successful());
            });
        });
        group.finish();
    }
}

/// Measures the calibrations of the published run.
fn field(criterion: &mut Criterion) {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let Ok(deployment) = open(&folder.join("../shared/datasets/2022-07-11-2")) else { return };
    let triplets = Analyst::new(Arc::new(deployment.clone())).run(&Settings::default());
    let triplets = Arc::clone(&triplets.pipeline.triplets);
    let offer = Offer::of(&deployment, &triplets);
    let mut group = criterion.benchmark_group("field");
    for (name, method) in [("joint", Method::Joint), ("inter-prism", Method::InterPrism)] {
        let settings = CalibrationSettings { method: Some(method), ..Default::default() };
        group.bench_function(name, |b| {
            b.iter(|| calibration::solve(&deployment, black_box(&triplets), &settings, &offer));
        });
    }
    group.finish();
}

/// Returns a prior as good as the closed form's on field data: millimetres and centimetres off.
fn good_prior(analysis: &Analysis) -> Vector8 {
    let answer = analysis.answer.as_ref().expect("simulated");
    let [_, t2, t3] = *answer.calibration.station1_from_station.as_array().expect("three stations");
    let mut p = Vector8::zeros();
    for (slot, t) in [t2, t3].into_iter().enumerate() {
        for (axis, off) in [0.002, -0.002, 0.04].into_iter().enumerate() {
            p[4 * slot + axis] = t.translation_m[axis] + off;
        }
        p[4 * slot + 3] = t.yaw_rad() + 6e-5;
    }
    p
}

/// Writes for other programs the triplets, and in three lines the distances, the good prior and our solution.
fn write_for_peers(deployment: &Deployment, analysis: &Analysis, folder: &std::path::Path) {
    std::fs::create_dir_all(folder).expect("target can be written");
    resect_report::csv::write_triplets(analysis, &folder.join("triplets.csv"))
        .expect("target can be written");
    let answer = analysis.answer.as_ref().expect("simulated");
    let [_, t2, t3] = answer.calibration.station1_from_station.as_array().expect("three stations");
    let numbers =
        |t: &RigidTransform| [t.translation_m.x, t.translation_m.y, t.translation_m.z, t.yaw_rad()];
    let ours = [numbers(t2), numbers(t3)].concat();
    let distances: [f64; 3] = *deployment
        .rig
        .as_ref()
        .expect("simulated")
        .inter_prism_m
        .as_array()
        .expect("three prisms");
    let line = |numbers: &[f64]| {
        let numbers: Vec<String> = numbers.iter().map(f64::to_string).collect();
        numbers.join(",") + "\n"
    };
    let problem = [line(&distances), line(good_prior(analysis).as_slice()), line(&ours)].concat();
    std::fs::write(folder.join("problem.csv"), problem).expect("target can be written");
}

/// Method D for the `levenberg-marquardt` crate: the same eight parameters, all residuals, the analytic Jacobian.
struct Peer {
    points: [Vec<Vector3<f64>>; 3],
    distances: [f64; 3],
    p: Vector8,
}

impl Peer {
    fn new(triplets: &Triplets, distances: [f64; 3], p: Vector8) -> Self {
        let points = triplets
            .points_m
            .map(|list| list.iter().map(|q| Vector3::new(q.x, q.y, q.z)).collect());
        Self { points: points.into_array().expect("three stations"), distances, p }
    }

    /// Returns the position in frame 1 and its derivative with respect to yaw.
    fn place(&self, station: usize, q: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        if station == 0 {
            return (*q, Vector3::zeros());
        }
        let t = &self.p.as_slice()[4 * (station - 1)..];
        let (sin, cos) = t[3].sin_cos();
        let (x, y) = (cos * q.x - sin * q.y, sin * q.x + cos * q.y);
        (Vector3::new(x + t[0], y + t[1], q.z + t[2]), Vector3::new(-y, x, 0.0))
    }
}

impl levenberg_marquardt::LeastSquaresProblem<f64, Dyn, U8> for Peer {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, U8>;
    type ParameterStorage = Owned<f64, U8>;

    fn set_params(&mut self, p: &Vector8) {
        self.p = *p;
    }

    fn params(&self) -> Vector8 {
        self.p
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        let n = self.points[0].len();
        let mut r = DVector::zeros(3 * n);
        for i in 0..n {
            for (pair, [a, b]) in Pair::among(3).map(Pair::indices).enumerate() {
                let (pa, pb) =
                    (self.place(a, &self.points[a][i]).0, self.place(b, &self.points[b][i]).0);
                r[3 * i + pair] = (pa - pb).norm() - self.distances[pair];
            }
        }
        Some(r)
    }

    fn jacobian(&self) -> Option<Matrix<f64, Dyn, U8, Self::JacobianStorage>> {
        let n = self.points[0].len();
        let mut jacobian = OMatrix::<f64, Dyn, U8>::zeros(3 * n);
        for i in 0..n {
            for (pair, [a, b]) in Pair::among(3).map(Pair::indices).enumerate() {
                let ((pa, da), (pb, db)) =
                    (self.place(a, &self.points[a][i]), self.place(b, &self.points[b][i]));
                let u = (pa - pb).normalize();
                for (station, sign, turned) in [(a, 1.0, da), (b, -1.0, db)] {
                    if station > 0 {
                        let column = 4 * (station - 1);
                        for k in 0..3 {
                            jacobian[(3 * i + pair, column + k)] = sign * u[k];
                        }
                        jacobian[(3 * i + pair, column + 3)] = sign * u.dot(&turned);
                    }
                }
            }
        }
        Some(jacobian)
    }
}

criterion_group!(benches, benchmarks);
criterion_main!(benches);
