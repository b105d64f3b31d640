//! Tests of the recommendation: each reason, with its words.

use std::sync::LazyLock;

use resect_core::analysis::{Analyst, Settings};
use resect_core::calibration::joint::SolverStatus;
use resect_core::calibration::{
    Calibration, JointFailure, Method, Recommendation, RecommendationReason, Verdict, Witness,
    recommend,
};
use resect_core::calibration::{Details, Estimate};
use resect_core::deployment::findings::clocks::clock_offset_suspected;
use resect_core::deployment::findings::drive::{drive_weak, rival_minimum};
use resect_core::deployment::findings::instruments::{
    UndecidedChange, distance_implausible, set_up_change_undecided, set_up_changed,
};
use resect_core::deployment::findings::mirror::{MirrorWitness, mirror_needs_witness, mirror_twin};
use resect_core::deployment::findings::points::prism_count_undecided;
use resect_core::deployment::{Deployment, Finding, MessageAngle};
use resect_core::statistics::estimate::decimals_of;
use resect_tools::simulation::{Preset, simulate};

fn calibrated(preset: Preset) -> (Deployment, Calibration) {
    let deployment = simulate(preset, 1).readings();
    let analysis = Analyst::new(deployment.clone().into()).run(&Settings::default());
    let calibration = analysis.answer.expect("an answer").calibration.clone();
    (deployment, calibration)
}

/// Most words of a sentence.
const MOST_WORDS: usize = 25;

fn word_count(text: &str) -> usize {
    text.split_whitespace().count()
}

/// A joint estimate without doubts, beside a good answer of method D.
static GOOD: LazyLock<(Deployment, Calibration)> = LazyLock::new(|| {
    let (deployment, mut calibration) = calibrated(Preset::Warthog);
    assert!(calibration.joint().is_some(), "{:?}", calibration.findings);
    judge(published_of(&mut calibration), Verdict::Good, Vec::new());
    judge(&mut calibration, Verdict::Good, Vec::new());
    (deployment, calibration)
});

fn judge(calibration: &mut Calibration, verdict: Verdict, findings: Vec<Finding>) {
    calibration.verdict = verdict;
    calibration.findings = findings;
}

fn fail(calibration: &mut Calibration, status: SolverStatus) {
    let failure = JointFailure::before_first_step(status);
    let finding = failure.finding(Method::InterPrism);
    let Details::Joint(details) = &mut calibration.details else { panic!("a joint estimate") };
    details.estimate = Err(failure);
    judge(calibration, Verdict::Weak, vec![finding]);
}

fn published_of(calibration: &mut Calibration) -> &mut Calibration {
    calibration.published.as_mut().expect("method D")
}

#[track_caller]
fn assert_short(recommendation: &Recommendation) {
    for sentence in recommendation.sentences(MessageAngle::to_string) {
        let is_short = word_count(&sentence) <= MOST_WORDS;
        let is_sentence = sentence.ends_with('.') && !sentence.starts_with(char::is_lowercase);
        // σ has no capital letter at the beginning of a sentence.
        assert!(is_short && (is_sentence || sentence.starts_with('σ')), "{sentence}");
    }
}

/// Returns the recommendation for the good answer after a change of it.
#[track_caller]
fn recommended(change: impl FnOnce(&mut Calibration)) -> Recommendation {
    let (deployment, mut calibration) = GOOD.clone();
    change(&mut calibration);
    let recommendation = recommend(&calibration, &deployment);
    assert_short(&recommendation);
    recommendation
}

#[track_caller]
fn assert_says(recommendation: &Recommendation, words: &str) {
    let text = recommendation.to_string();
    assert!(text.contains(words), "`{words}` is not in: {text}");
}

#[test]
fn a_good_joint_estimate_is_used_with_its_largest_sigma() {
    let checked = recommended(|calibration| calibration.checked_by = vec![Witness::ControlPoints]);
    assert_eq!(checked.answer, Some(Method::Joint));
    assert_eq!(checked.reason, RecommendationReason::Good);
    assert_says(
        &checked,
        "Use the joint estimate for this drive. σ of a station's position is at most ",
    );
    assert_says(
        &checked,
        " mm along an axis, and the control points agree. For a smaller σ, reduce its",
    );
    let unchecked = recommended(|calibration| calibration.checked_by = vec![Witness::Rig]);
    assert_says(
        &unchecked,
        " mm along an axis. To check it independently, let all stations measure three",
    );
    let mut together = GOOD.0.clone();
    together.restarts_s = vec![100.0];
    assert_says(&recommend(&GOOD.1, &together), "Use the joint estimate for these drives.");
}

#[test]
fn a_change_of_a_set_up_separates_drive_and_survey() {
    let estimate = |value, sigma| Estimate { value, sigma };
    let (turned_rad, moved_m) = (estimate(8.52e-4, 4.1e-5), estimate(0.001, 0.001));
    let named = recommended(|calibration| {
        calibration.findings = vec![set_up_changed(1, &turned_rad, &moved_m)];
    });
    assert_eq!(named.answer, Some(Method::Joint));
    assert_eq!(named.reason, RecommendationReason::SetUpChanged);
    assert_says(&named, "for this drive, and its survey transforms for points of the survey.");
    assert_says(&named, "Station 2 turned by +0.852 ± 0.041 mrad between the survey and the");
    assert_says(&named, "If station 2 was not touched, check its control points");
    let in_microradians = named.sentences(|angle| format!("{:.0} µrad", angle.value_rad * 1e6));
    assert!(in_microradians[1].contains("turned by 852 µrad"), "{in_microradians:?}");
    let undecided = recommended(|calibration| {
        judge(
            calibration,
            Verdict::Weak,
            vec![set_up_change_undecided(UndecidedChange::WhichStation)],
        );
    });
    assert_eq!(undecided.reason, RecommendationReason::SetUpChanged);
    assert_says(&undecided, "Use the joint estimate with caution for this drive, and its");
    assert_says(&undecided, "Measure the control points again from every station");
}

#[test]
fn a_weak_answer_is_used_with_caution_and_its_doubt_has_a_remedy() {
    let doubtful =
        |doubt: Finding| recommended(|calibration| judge(calibration, Verdict::Weak, vec![doubt]));
    let rig = doubtful(distance_implausible(0, 0.02, 0.001, 6.0));
    assert_eq!((rig.answer, rig.reason), (Some(Method::Joint), RecommendationReason::Doubtful));
    assert_says(&rig, "Use the joint estimate with caution for this drive. Prisms 1–2 would");
    assert_says(&rig, "6.0 σ. Check the order of the prisms and their constants, then measure");
    let drive = doubtful(drive_weak("station 2 slides along the track", 0.03, "drive on"));
    assert_says(&drive, "Weakly observable: station 2 slides along the track (σ up to 30 mm). ");
    assert_says(&drive, "Next, drive");
}

#[test]
fn without_convergence_the_published_answer_is_used_and_nothing_leads_back() {
    let unconverged = recommended(|calibration| fail(calibration, SolverStatus::TooManySteps));
    assert_eq!(unconverged.answer, Some(Method::InterPrism));
    assert_eq!(unconverged.reason, RecommendationReason::NotConverged);
    assert_says(&unconverged, "Use method D for this drive: the joint estimate did not converge.");
    // σ is that of method D.
    let sigma = GOOD.1.published.as_ref().and_then(|published| published.sigma.clone()).expect("σ");
    let sigma_m = sigma.map(|station| station.translation_m.max());
    let sigma_mm = 1e3 * sigma_m[1].max(sigma_m[2]);
    let expected = format!("{sigma_mm:.*} mm", decimals_of(sigma_mm).unwrap_or(1));
    assert_says(
        &unconverged,
        &format!("σ of a station's position is at most {expected} along an axis."),
    );
    assert_says(&unconverged, "To determine the joint estimate, ");

    let undetermined = recommended(|calibration| fail(calibration, SolverStatus::NotDefinite));
    assert_eq!(undetermined.answer, Some(Method::InterPrism));
    assert_eq!(undetermined.reason, RecommendationReason::NotDetermined);

    let late = clock_offset_suspected(1, &Estimate { value: 0.01, sigma: 0.001 });
    let biased = recommended(|calibration| {
        fail(calibration, SolverStatus::TooManySteps);
        judge(published_of(calibration), Verdict::Weak, vec![late]);
    });
    assert_says(&biased, "Use method D with caution for this drive: ");
    assert_says(&biased, "Station 2's stamps seem 10.0 ± 1.0 ms late");
    assert!(!biased.next_step.contains("Try the joint estimate"), "{biased}");
}

#[test]
fn an_ambiguous_answer_is_not_used_until_it_is_decided() {
    let ambiguous = |findings: Vec<Finding>| {
        let ambiguous = recommended(|calibration| judge(calibration, Verdict::Ambiguous, findings));
        assert_eq!(ambiguous.answer, None);
        assert_eq!(ambiguous.reason, RecommendationReason::Ambiguous);
        ambiguous
    };
    let twin = mirror_twin(MirrorWitness::Nothing, 0.4, 1.2, false);
    let mirror = ambiguous(vec![mirror_needs_witness(), twin]);
    assert_says(&mirror, "Use no answer from this drive until the mirror ambiguity is resolved.");
    assert_says(&mirror, "The mirrored solution, 0.40 m away in height, has 1.20 times the cost.");
    assert_says(&mirror, "(calibration_raw.csv), or let all stations measure three control points");
    let rival = ambiguous(vec![rival_minimum(0.7, 1.3)]);
    assert_says(&rival, "until one of two solutions is excluded. Another solution 0.70 m away");
    let prisms = ambiguous(vec![prism_count_undecided()]);
    assert_says(&prisms, "State the number of prisms");
}

#[test]
fn a_degenerate_drive_names_what_it_leaves_open_and_what_determines_it() {
    let (deployment, calibration) = calibrated(Preset::StraightLine);
    let degenerate = recommend(&calibration, &deployment);
    assert_short(&degenerate);
    assert_eq!(degenerate.answer, None, "{degenerate}");
    assert_eq!(degenerate.reason, RecommendationReason::Degenerate);
    assert_says(&degenerate, " of 8 directions are not determined: ");
    assert_says(&degenerate, "Next, turn once around on the spot at both ends of the line");
    assert_says(&degenerate, ", or let all stations measure three control points.");
}

#[test]
fn a_method_of_the_paper_is_recommended_as_chosen() {
    let chosen = |verdict: Verdict, findings: Vec<Finding>| {
        recommended(|calibration| {
            *calibration = published_of(calibration).clone();
            judge(calibration, verdict, findings);
        })
    };
    let good = chosen(Verdict::Good, Vec::new());
    assert_eq!((good.answer, good.reason), (Some(Method::InterPrism), RecommendationReason::Good));
    assert!(!good.to_string().contains("joint estimate"), "{good}");
    // The joint estimate may fail to converge here as well, which the condition says.
    let late = clock_offset_suspected(1, &Estimate { value: 0.01, sigma: 0.001 });
    let biased = chosen(Verdict::Weak, vec![late]);
    assert_eq!(biased.answer, Some(Method::InterPrism));
    assert_says(&biased, "Try the joint estimate, which models this error, and use it if it");
}
