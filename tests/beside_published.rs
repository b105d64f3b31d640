//! The joint estimate is the default, and the paper's answer stands beside it unchanged.

mod common;

use common::{analyse, answer, by, field_data, published};
use resect_core::analysis::{Analyst, Settings};
use resect_core::calibration::{Calibration, Estimated, Loss, Method};
use resect_core::deployment::Deployment;
use resect_core::progress::Progress;
use resect_core::simulation::{Preset, simulate};
use resect_io::open::open;
use resect_io::sample::Sample;

fn calibration(deployment: &Deployment, settings: &Settings) -> Calibration {
    answer(&analyse(deployment, settings)).calibration.clone()
}

/// The same numbers to the last bit, and the same judgement.
#[track_caller]
fn assert_same(a: &Calibration, b: &Calibration) {
    assert_eq!(a.method, b.method);
    assert_eq!(a.station1_from_station, b.station1_from_station);
    assert_eq!(a.covariance, b.covariance);
    assert_eq!((a.verdict, &a.findings), (b.verdict, &b.findings));
    assert_eq!(a.checked_by, b.checked_by);
}

fn sample() -> Deployment {
    Sample::Warthog.open().expect("built in")
}

#[test]
fn without_a_method_the_answer_is_the_joint_estimate() {
    let found = calibration(&sample(), &Settings::default());
    assert_eq!(found.method, Method::Joint);
    assert_same(&found, &calibration(&sample(), &by(Method::Joint)));
    let refinement = found.inter_prism().and_then(|details| details.refinement.as_ref());
    let refinement = refinement.expect("three prisms");
    assert!(refinement.clock_offsets_s.is_some() && refinement.distances_m.is_some());
    assert!(refinement.joint.is_some());
}

#[test]
fn the_papers_answer_stands_beside_it_to_the_last_bit() {
    let mut deployments = vec![sample(), Sample::Hd2Tunnel.open().expect("built in")];
    deployments.extend(field_data("2022-07-11-2").map(|path| open(&path).expect("opens")));
    for deployment in &deployments {
        let joint = calibration(deployment, &Settings::default());
        let beside = joint.published.as_deref().expect("the paper's method has an answer");
        let alone = calibration(deployment, &published());
        assert_same(beside, &alone);
        assert!(alone.published.is_none(), "only a joint estimate carries another answer");
        assert_ne!(joint.station1_from_station, alone.station1_from_station);
    }
}

#[test]
fn of_one_prism_the_joint_estimate_has_the_clocks_and_c_beside_it() {
    let deployment =
        resect_io::simulation_files::open(&simulate(Preset::SinglePrism, 5)).expect("valid");
    let joint = calibration(&deployment, &Settings::default());
    assert_eq!(joint.method, Method::Joint);
    assert!(joint.clocks().is_some());
    let beside = joint.published.as_deref().expect("C has an answer");
    assert_same(beside, &calibration(&deployment, &by(Method::DynamicGcp)));
    assert!(beside.clocks().is_none(), "as published, C knows no clocks");
}

#[test]
fn a_loss_or_estimates_are_of_the_published_methods_and_the_joint_estimate_says_so() {
    let mut settings = Settings::default();
    settings.calibration.loss = Loss::Huber;
    settings.calibration.estimate = Estimated { tilt: true, ..Estimated::default() };
    let chosen = calibration(&sample(), &settings);
    let plain = calibration(&sample(), &Settings::default());
    assert_eq!(chosen.station1_from_station, plain.station1_from_station);
    let said = |c: &Calibration| c.findings.iter().any(|f| f.to_string().contains("were not used"));
    assert!(said(&chosen) && !said(&plain), "{:?}", chosen.findings);
    assert_same(
        chosen.published.as_deref().expect("beside it"),
        plain.published.as_deref().expect("beside it"),
    );
    // Of method D they are switches, as ever.
    settings.calibration.method = Some(Method::InterPrism);
    let by_d = calibration(&sample(), &settings);
    let refinement = by_d.inter_prism().and_then(|details| details.refinement.as_ref());
    let refinement = refinement.expect("something beyond the paper was asked for");
    assert!(refinement.tilts_rad.is_some() && refinement.clock_offsets_s.is_none());
    assert!(refinement.joint.is_none(), "of triplets, not of readings");
}

/// The window shows it before the joint estimate is there.
#[test]
fn the_papers_answer_can_be_had_first() {
    let mut analyst = Analyst::new(sample().into());
    let progress = Progress::default();
    let first = analyst.run_published_while(&Settings::default(), &progress);
    let first = first.expect("nobody cancels it").expect("the default is the joint estimate");
    let joint = analyst.run(&Settings::default());
    assert_same(
        &answer(&first).calibration,
        answer(&joint).calibration.published.as_deref().expect("beside it"),
    );
    let none = analyst.run_published_while(&published(), &progress).expect("nobody cancels it");
    assert!(none.is_none(), "there is nothing to follow");
}

/// What older versions could be told, as their files have it.
#[test]
fn settings_of_older_versions_say_what_became_of_them() {
    let file = tempfile::NamedTempFile::new().expect("a file");
    let read = |text: &str| {
        std::fs::write(file.path(), text).expect("writable");
        let (settings, findings) = resect_io::settings_file::read(file.path()).expect("opens");
        (settings, findings.into_iter().map(|f| f.to_string()).collect::<Vec<_>>().join("; "))
    };
    let (settings, said) = read(
        "[calibration]\nloss = \"cauchy\"\ncontinuous_time = true\nestimate = { clocks = true }\n",
    );
    assert_eq!(settings, by(Method::Joint), "that was the joint estimate");
    assert!(said.contains("continuous_time") && said.contains("joint estimate"), "{said}");

    let (settings, said) =
        read("[calibration]\nmethod = \"inter-prism\"\nloss = \"huber\"\nweigh_by_noise = true\n");
    let mut expected = published();
    expected.calibration.loss = Loss::Huber;
    assert_eq!(settings, expected);
    assert!(said.contains("weigh_by_noise"), "{said}");

    // Every file has them as off, and loses nothing.
    let off = "[calibration]\nmethod = \"inter-prism\"\nweigh_by_noise = false\ncontinuous_time = false\n";
    assert_eq!(read(off), (published(), String::new()));
    let text = toml::to_string(&Settings::default()).expect("plain data");
    assert!(!text.contains("weigh_by_noise") && !text.contains("continuous_time"), "{text}");
}
