//! Simulated deployments with known ground truth.

use crate::common::{analyse, answer, normalised, published, sample_folder};
use resect_core::calibration::{PriorMethod, Verdict};
use resect_core::geometry::LevelTransform;
use resect_core::network::PerStation;
use resect_io::open::open;
use resect_io::sample::Sample;
use resect_tools::simulation::{Preset, simulate};

#[derive(serde::Deserialize)]
struct Truth {
    transforms: Vec<TrueTransform>,
}

#[derive(serde::Deserialize)]
struct TrueTransform {
    translation_m: [f64; 3],
    yaw_rad: f64,
}

fn truth(sample: &str) -> PerStation<LevelTransform> {
    let text = std::fs::read_to_string(sample_folder(sample).join("truth.toml")).expect("readable");
    let truth: Truth = toml::from_str(&text).expect("valid");
    let [a, b] = [0, 1].map(|i| {
        LevelTransform::new(truth.transforms[i].translation_m.into(), truth.transforms[i].yaw_rad)
    });
    [LevelTransform::IDENTITY, a, b].into()
}

#[test]
fn every_number_of_the_samples_is_within_three_sigma() {
    for (sample, folder) in [(Sample::Warthog, "warthog"), (Sample::Hd2Tunnel, "hd2-tunnel")] {
        let deployment = sample.open().expect("built in");
        for prior in [PriorMethod::ClosedForm, PriorMethod::Search] {
            let mut settings = published();
            settings.calibration.prior = prior;
            let analysis = analyse(&deployment, &settings);
            let off = normalised(&analysis, &truth(folder));
            assert!(off.iter().all(|z| z.abs() < 3.0), "{folder}: {off:.2?}");
            assert_eq!(answer(&analysis).calibration.verdict, Verdict::Good, "{folder}");
        }
    }
}

#[test]
fn the_built_in_samples_are_the_files_in_assets() {
    for (sample, folder) in [(Sample::Warthog, "warthog"), (Sample::Hd2Tunnel, "hd2-tunnel")] {
        let built_in = sample.open().expect("built in");
        let on_disk = open(&sample_folder(folder)).expect("opens");
        assert_eq!(built_in.tracks, on_disk.tracks);
        assert_eq!(built_in.rig, on_disk.rig);
        assert_eq!(built_in.control_points, on_disk.control_points);
        // The truth is beside the data, and no reader uses it.
        let truth = on_disk.ingredients.iter().find(|i| i.file == "truth.toml").expect("listed");
        assert!(!truth.used);
    }
}

#[test]
fn the_same_seed_gives_the_same_deployment() {
    let [a, b, other] = [3, 3, 4].map(|seed| {
        resect_io::simulation_files::open(&simulate(Preset::Warthog, seed)).expect("valid")
    });
    assert_eq!(a.tracks, b.tracks);
    assert_ne!(a.tracks, other.tracks);
}

/// The stated σ covers the errors over many seeds. It has the errors of instruments, which these drives do not have.
#[test]
fn stated_uncertainty_covers_the_truth_over_seeds() {
    for preset in [Preset::Warthog, Preset::Hd2Tunnel] {
        let mut all = Vec::new();
        for seed in 101..=125 {
            let simulated = simulate(preset, seed);
            let analysis = analyse(
                &resect_io::simulation_files::open(&simulated).expect("valid"),
                &published(),
            );
            all.extend(normalised(&analysis, &simulated.truth.station1_from_station));
        }
        let rms = (all.iter().map(|z| z * z).sum::<f64>() / all.len() as f64).sqrt();
        let beyond_two = all.iter().filter(|z| z.abs() > 2.0).count() as f64 / all.len() as f64;
        eprintln!("{preset:?}: rms {rms:.2}, beyond 2σ {:.1} %", 100.0 * beyond_two);
        assert!((0.2..1.4).contains(&rms), "{preset:?}: rms {rms}");
        assert!(beyond_two < 0.12, "{preset:?}: {beyond_two} beyond 2σ");
    }
}

#[test]
fn without_the_outlier_filter_the_answer_is_worse_than_with_it() {
    let deployment = Sample::Warthog.open().expect("built in");
    let mut unfiltered = published();
    unfiltered.pipeline.outlier_filter = false;
    let [with, without] = [published(), unfiltered].map(|settings| {
        let analysis = analyse(&deployment, &settings);
        answer(&analysis).evaluation.inter_prism_mm.expect("a rig").iqr
    });
    assert!(without > 1.05 * with, "IQR {with} mm with the filter, {without} mm without");
}
