//! Tests of the guide's advice on simulated drives that cannot be good.

use resect_core::analysis::{Analyst, Settings};
use resect_core::calibration::Verdict;
use resect_core::deployment::kinds;
use resect_core::deployment::{FindingKind, doubts};
use resect_tools::simulation::{Preset, simulate};

#[test]
fn the_main_doubt_of_a_drive_that_is_not_good_has_advice() {
    let expected = [
        (Preset::StraightLine, kinds::DRIVE_STRAIGHT_LINE),
        (Preset::Circle, kinds::DRIVE_CIRCLE),
        (Preset::LShape, kinds::DRIVE_TWO_LEGS),
    ];
    for (preset, shape) in expected {
        let deployment = resect_io::simulation_files::open(&simulate(preset, 1)).expect("valid");
        let analysis = Analyst::new(deployment.into()).run(&Settings::default());
        let calibration = analysis.answer.expect("an answer").calibration.clone();
        assert!(calibration.verdict > Verdict::Good, "{preset:?}");
        let kinds: Vec<FindingKind> =
            doubts(&calibration.findings).iter().map(|finding| finding.kind).collect();
        assert!(kinds.contains(&shape) && shape.advice.is_some(), "{preset:?}: {kinds:?}");
    }
}
