//! Drives of one set-up solved together: each has its own clocks, and all share one calibration.

use crate::common::{analyse, answer, by, knock, two_runs};
use resect_core::analysis::Analysis;
use resect_core::calibration::joint::{DriveClocks, JointEstimate, StepSize};
use resect_core::calibration::{Calibration, Method, Verdict};
use resect_core::deployment::kinds;
use resect_core::deployment::{Deployment, Finding};
use resect_core::geometry::wrap_to_pi;
use resect_core::progress::Progress;
use resect_io::simulation_files::write_folder;
use resect_io::source::{Extras, Source};
use resect_tools::simulation::{Preset, Settling, Simulated, simulate};

/// Increase of the clock offsets of stations 2 and 3 from the first drive to the second (s).
const RESTARTED_S: [f64; 2] = [0.15, -0.08];

/// Returns two drives; the clocks of stations 2 and 3 are reset in between.
fn drives(preset: Preset, seed: u64, between: &[Settling]) -> [Simulated; 2] {
    let mut drives = two_runs(preset.scenario(), seed, between);
    for record in &mut drives[1].records {
        if let Ok(slot) = usize::try_from(record.station - 2) {
            record.measurement.time_s += RESTARTED_S[slot];
        }
    }
    drives
}

fn together(drives: &[Simulated; 2]) -> Deployment {
    let [mut first, second] =
        drives.each_ref().map(|drive| resect_io::simulation_files::open(drive).expect("valid"));
    first.take_in(vec![second]).expect("one set-up");
    first
}

/// Calibrates by the drives and the rig: with control points, each drive is as sure as both.
fn jointly(deployment: &Deployment) -> Analysis {
    let mut settings = by(Method::Joint);
    settings.calibration.evidence.control_points = false;
    analyse(deployment, &settings)
}

fn joint(calibration: &Calibration) -> &JointEstimate {
    calibration.joint().expect("a joint estimate")
}

/// Returns the largest error of the calibration in σ.
fn sigmas_off(calibration: &Calibration, truth: &Simulated) -> f64 {
    let covariance = calibration.covariance.as_ref().expect("σ");
    let off = |k: usize| {
        let found = &calibration.station1_from_station[k / 4 + 1];
        let truth = &truth.truth.station1_from_station[k / 4 + 1];
        let error = match k % 4 {
            3 => wrap_to_pi(found.yaw_rad() - truth.yaw_rad),
            axis => found.translation_m[axis] - truth.translation_m[axis],
        };
        error.abs() / covariance[(k, k)].sqrt()
    };
    (0..8).map(off).fold(0.0, f64::max)
}

#[test]
fn two_drives_are_one_answer_that_is_surer_and_each_has_its_clocks() {
    for (preset, seed) in [(Preset::Warthog, 3), (Preset::FigureEight, 4), (Preset::Hd2Tunnel, 5)] {
        let drives = drives(preset, seed, &[]);
        let analysis = jointly(&together(&drives));
        let calibration = &answer(&analysis).calibration;
        let name = preset.name();
        assert_eq!(calibration.verdict, Verdict::Good, "{name}: {:?}", calibration.findings);
        let off = sigmas_off(calibration, &drives[0]);
        assert!(off < 4.0, "{name}: {off:.1} σ off");
        let [first, second]: [DriveClocks; 2] =
            joint(calibration).drives.clone().try_into().expect("two drives");
        for (station, restarted_s) in (1..).zip(RESTARTED_S) {
            let later_s = second.offsets_s[station].value - first.offsets_s[station].value;
            let sigma_s = first.offsets_s[station].sigma.hypot(second.offsets_s[station].sigma);
            assert!(
                (later_s - restarted_s).abs() < 4.0 * sigma_s && sigma_s < 0.003,
                "{name}: {later_s:.4} ± {sigma_s:.4} s"
            );
        }
        // Both drives have the errors of the same facets.
        let without_facets = |calibration: &Calibration| {
            let budget = joint(calibration).budget.iter();
            budget
                .filter(|(source, _)| *source != "facets of prisms")
                .map(|(_, part)| part.sum())
                .sum()
        };
        let alone: [f64; 2] = drives.each_ref().map(|drive| {
            let analysis = jointly(&resect_io::simulation_files::open(drive).expect("valid"));
            without_facets(&answer(&analysis).calibration)
        });
        let together: f64 = without_facets(calibration);
        assert!(together < alone[0].min(alone[1]), "{name}: {together:e} {alone:?}");
    }
}

#[test]
fn a_station_that_moved_between_drives_is_named() {
    let moved = knock(1, 1e-3, [0.01, 0.0, 0.0]);
    let drives = drives(Preset::Warthog, 3, &[moved]);
    let deployment = together(&drives);
    let analysis = jointly(&deployment);
    let calibration = &answer(&analysis).calibration;
    assert_eq!(calibration.verdict, Verdict::Weak);
    let moved: Vec<&Finding> =
        calibration.findings.iter().filter(|f| f.kind == kinds::STATION_MOVED).collect();
    let [moved] = moved[..] else { panic!("{:#?}", calibration.findings) };
    assert!(moved.is_about_station(1), "{moved}");
    assert!(moved.to_string().contains("between drives 1 and 2"), "{moved}");
    let [step] = &joint(calibration).steps[..] else { panic!("{moved}") };
    let StepSize::Station { turned_rad, .. } = &step.size else { panic!("{moved}") };
    assert!(turned_rad.sigmas_from(1e-3).abs() < 3.0, "{moved}");
}

#[test]
fn drives_whose_stamps_overlap_follow_each_other_and_other_rigs_do_not() {
    let [first, second] = [3, 4].map(|seed| {
        resect_io::simulation_files::open(&simulate(Preset::Warthog, seed)).expect("valid")
    });
    let mut both = first.clone();
    both.take_in(vec![second]).expect("the same rig");
    assert_eq!(both.restarts_s.len(), 1);
    assert!(both.restarts_s[0] > first.end_s().expect("readings"));
    for track in &both.tracks {
        assert!(track.measurements.windows(2).all(|w| w[0].time_s < w[1].time_s));
    }
    assert!(both.findings.iter().any(|f| f.kind == kinds::DRIVE_SHIFTED));
    let twice = both.take_in(vec![first.clone()]).expect_err("nothing new").to_string();
    assert!(twice.contains("give each drive once"), "{twice}");
    let mut lacking =
        resect_io::simulation_files::open(&simulate(Preset::Warthog, 3)).expect("valid");
    lacking.tracks[2].measurements.clear();
    let complaint = both.take_in(vec![lacking]).expect_err("two stations").to_string();
    assert!(complaint.contains("station 3 has no measurement"), "{complaint}");
    let other = resect_io::simulation_files::open(&simulate(Preset::Hd2Tunnel, 3)).expect("valid");
    let complaint = both.take_in(vec![other]).expect_err("another rig").to_string();
    assert!(complaint.contains("it has other inter-prism distances than"), "{complaint}");
}

#[test]
fn a_source_opens_its_further_drives() {
    let folder = tempfile::tempdir().expect("a folder");
    let paths = ["first", "second"].map(|name| folder.path().join(name));
    for (drive, path) in drives(Preset::Warthog, 3, &[]).iter().zip(&paths) {
        write_folder(drive, path).expect("written");
    }
    let drives = vec![paths[1].clone()];
    let source = Source::at(&paths[0]).with(Extras { drives, ..Extras::default() });
    let deployment = source.open(&Progress::default()).expect("both");
    assert_eq!(deployment.restarts_s.len(), 1);
    let readings = |path| Source::at(path).open(&Progress::default()).expect("a drive").tracks;
    let [first, second] = paths.each_ref().map(readings);
    for station in 0..3 {
        let all = first[station].measurements.len() + second[station].measurements.len();
        assert_eq!(deployment.tracks[station].measurements.len(), all);
    }
}
