//! Comparison of Gaussian processes with linear interpolation, on deployments with known ground truth.

use std::sync::Arc;

use crate::common::{analyse, answer, of_field, published};
use resect_core::analysis::Settings;
use resect_core::calibration::misfits::compared_stations;
use resect_core::deployment::Deployment;
use resect_core::geometry::RigidTransform;
use resect_core::pipeline::Interpolation;
use resect_core::progress::Progress;
use resect_io::open::open;
use resect_io::sample::Sample;
use resect_tools::experiment::ablate;
use resect_tools::simulation::{Path, Preset, simulate, simulate_scenario};

/// Returns the median of the inter-prism metric of method D (mm).
fn metric_mm(deployment: &Deployment, interpolation: Interpolation) -> f64 {
    let mut settings = published();
    settings.pipeline.interpolation = interpolation;
    let analysis = analyse(deployment, &settings);
    answer(&analysis).evaluation.inter_prism_mm.expect("a rig").median
}

/// Returns the mean over seeds of the metric with an interpolation relative to the linear one.
fn ratio(preset: Preset, interpolation: Interpolation) -> f64 {
    const SEEDS: u64 = 4;
    let ratios = (0..SEEDS).map(|seed| {
        let deployment = resect_io::simulation_files::open(&simulate(preset, seed)).expect("valid");
        metric_mm(&deployment, interpolation) / metric_mm(&deployment, Interpolation::Linear)
    });
    ratios.sum::<f64>() / SEEDS as f64
}

#[test]
fn on_winding_tracks_at_2_5_hz_learned_noise_beats_straight_lines() {
    for preset in [Preset::Warthog, Preset::UnevenGround, Preset::Hd2Tunnel] {
        let gp = ratio(preset, Interpolation::Gp);
        // The GP's metric is 20 % to 40 % smaller.
        assert!(gp < 0.85, "{preset:?}: the GP's metric is {gp:.2} times that of straight lines");
        let wnoa = ratio(preset, Interpolation::Wnoa);
        assert!(wnoa < 1.1, "{preset:?}: the motion model's is {wnoa:.2} times");
    }
}

#[test]
fn with_gross_errors_left_in_straight_lines_lose_least() {
    let sample = [Arc::new(Sample::Warthog.open().expect("built in"))];
    let study = ablate(&sample, &Settings::default(), None, None, &Progress::default());
    let study = study.expect("the sample has control points to judge by");
    let median = |group: usize, series: usize| {
        study.groups[group].boxes[series].as_ref().expect("a box").median
    };
    // An outlier of some metres bends a smooth curve over a wide range, a polyline only beside it.
    let [linear, gp, wnoa] = [0, 1, 2].map(|series| median(0, series) / median(3, series));
    assert!(linear < 1.1, "{linear:.2} times the error with both filters");
    assert!(gp > 3.0 && wnoa > 2.0, "GP {gp:.2}, motion model {wnoa:.2} times");
}

#[test]
#[cfg_attr(not(field_data), ignore = "needs ../shared/datasets")]
fn on_the_field_data_the_motion_model_wins_and_the_smooth_process_loses() {
    let path = of_field("2022-07-11-2");
    let deployment = open(&path).expect("opens");
    let [linear, gp, wnoa] = Interpolation::ALL.map(|i| metric_mm(&deployment, i));
    // The paper's finding, even with learned noise: a Warthog's motion is no sample of a smooth process.
    assert!(gp > linear, "GP {gp:.2}, linear {linear:.2} mm");
    assert!(wnoa < linear, "motion model {wnoa:.2}, linear {linear:.2} mm");
}

/// Tests σ on a slow winding drive: distance errors over their σ, with the exact transforms and distances.
#[test]
fn the_stated_sigma_is_about_as_large_as_the_errors() {
    // The distances between prisms are known exactly, so their errors test σ.
    for (interpolation, low, high) in
        [(Interpolation::Gp, 0.5, 2.6), (Interpolation::Wnoa, 0.4, 1.6)]
    {
        let mut scenario = Preset::Warthog.scenario();
        scenario.path = Path::Wander { centre_m: [40.0, 5.0], radius_m: 15.0 };
        scenario.noise.outlier_share = 0.0;
        let simulated = simulate_scenario(&scenario, 9);
        let deployment = resect_io::simulation_files::open(&simulated).expect("valid");
        let mut settings = published();
        settings.pipeline.interpolation = interpolation;
        let analysis = analyse(&deployment, &settings);
        let transforms =
            simulated.truth.station1_from_station.map(|level| RigidTransform::from(*level));
        let triplets = &analysis.pipeline.triplets;
        let followed = &analysis.offer.followed;
        let by_station = compared_stations(followed);
        let errors_m = resect_core::calibration::distance_errors_m(
            triplets,
            &transforms,
            followed,
            &simulated.truth.inter_prism_m,
        );
        let mut ratios: Vec<f64> = (0..triplets.len())
            .flat_map(|index| {
                let sigma = resect_core::evaluation::vehicle::distance_sigma_m(
                    triplets,
                    index,
                    &transforms,
                    &by_station,
                );
                let sigma = sigma.expect("stated");
                [0, 1, 2].map(|pair| errors_m[pair][index].abs() / sigma[pair])
            })
            .collect();
        ratios.sort_by(f64::total_cmp);
        let typical = ratios[ratios.len() / 2] / 0.6745;
        assert!((low..high).contains(&typical), "{interpolation:?}: errors are {typical:.2} σ");
    }
}
