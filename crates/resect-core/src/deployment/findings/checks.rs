//! Findings of the checks of an answer: standard deviations, control points, distances, the reading of the rig.

use crate::deployment::kinds;
use crate::deployment::{Finding, Remedy, Subject, Unit};
use crate::network::MOST_STATIONS;

pub fn points_leave_direction_free() -> Finding {
    Finding::new(
        kinds::POINTS_LEAVE_DIRECTION_FREE,
        "the points leave a direction unobservable: spread them over the whole area",
    )
}

/// `fits` is true if the points fit, so that their positions are to be improved.
pub fn points_weak(largest_sigma_m: f64, fits: bool) -> Finding {
    let advice = if fits {
        "spread the points over a larger area"
    } else {
        "first correct the poor fit of the points"
    };
    Finding::new(
        kinds::POINTS_WEAK,
        format!(
            "weakly observable: σ up to {:.0} mm at the stations; {advice}",
            largest_sigma_m * 1e3
        ),
    )
    .quantity("largest_sigma", largest_sigma_m, Unit::Metre)
}

/// Medians of the control points of a file: the difference between stations, and the expected one. `worst` is the marker
/// of the point with the largest difference.
pub fn control_points_contradict(
    file: &str,
    median_m: f64,
    expected_m: f64,
    worst: Option<i64>,
) -> Finding {
    let finding = Finding::new(
        kinds::CONTROL_POINTS_CONTRADICT,
        format!(
            "control points contradict this answer: {:.0} mm apart in {file} (median), about {:.0} mm expected; a station moved \
             between the survey and the drive, or a bias is not modelled",
            median_m * 1e3,
            expected_m * 1e3
        ),
    )
    .about(Subject::File(file.to_owned()))
    .quantity("median", median_m, Unit::Metre)
    .quantity("expected", expected_m, Unit::Metre);
    match worst {
        Some(marker) => finding.with(Remedy::ShowPoint { file: file.to_owned(), marker }),
        None => finding,
    }
}

/// Errors of the inter-prism distances of the drive: the median, and the expected one.
pub fn drive_contradicts(median_m: f64, expected_m: f64) -> Finding {
    Finding::new(
        kinds::DRIVE_CONTRADICTS,
        format!(
            "the drive contradicts this answer: its inter-prism distances are off by {:.1} mm (median), about {:.0} mm \
             expected; a station moved between the survey and the drive, or a bias is not modelled",
            median_m * 1e3,
            expected_m * 1e3
        ),
    )
    .quantity("median", median_m, Unit::Metre)
    .quantity("expected", expected_m, Unit::Metre)
}

/// Errors of the inter-prism distances of the drive: the median, and the expected one.
pub fn drive_fits_poorly(median_m: f64, expected_m: f64) -> Finding {
    Finding::new(
        kinds::DRIVE_FITS_POORLY,
        format!(
            "this answer fits the drive poorly: the inter-prism distances are off by {:.1} mm (median); its σ allows {:.0} mm, a \
             good answer has 1 to 2 mm",
            median_m * 1e3,
            expected_m * 1e3
        ),
    )
    .quantity("median", median_m, Unit::Metre)
    .quantity("expected", expected_m, Unit::Metre)
}

/// Signed areas of the triangle of the prisms from above (m²), counter-clockwise positive.
pub fn rig_orientation_contradicts(answer_m2: f64, rig_m2: f64) -> Finding {
    let way = |area_m2: f64| if area_m2 > 0.0 { "counter-clockwise" } else { "clockwise" };
    Finding::new(
        kinds::RIG_ORIENTATION_CONTRADICTS,
        format!(
            "the rig contradicts this answer: seen from above, prisms 1, 2, 3 lie {} in the answer ({answer_m2:+.3} m²) and {} \
             in the reading of the rig ({rig_m2:+.3} m²); the sense of the azimuths is wrong, or two stations are exchanged",
            way(answer_m2),
            way(rig_m2),
        ),
    )
    .quantity("area", answer_m2, Unit::SquareMetre)
    .quantity("area_of_rig", rig_m2, Unit::SquareMetre)
    .with(Remedy::Corrections)
}

/// Heights of prism 1 above prisms 2 and 3 (m).
pub fn rig_heights_contradict(answer_m: &[f64], rig_m: &[f64]) -> Finding {
    let prisms: Vec<String> = (2..).take(answer_m.len()).map(|prism| format!("{prism}")).collect();
    let heights = |heights_m: &[f64]| {
        heights_m.iter().map(|height_m| format!("{height_m:+.3}")).collect::<Vec<_>>().join(" and ")
    };
    let finding = Finding::new(
        kinds::RIG_HEIGHTS_CONTRADICT,
        format!(
            "the rig contradicts this answer: prism 1 stands {} m above prism{} {} in the answer, {} m in the reading of the rig: \
             more than tilt explains; check which station tracked which prism",
            heights(answer_m),
            if prisms.len() > 1 { "s" } else { "" },
            prisms.join(" and "),
            heights(rig_m),
        ),
    );
    const KEYS: [&str; MOST_STATIONS - 1] = [
        "height_over_prism_2",
        "height_over_prism_3",
        "height_over_prism_4",
        "height_over_prism_5",
        "height_over_prism_6",
        "height_over_prism_7",
        "height_over_prism_8",
    ];
    let quantities = KEYS.into_iter().zip(answer_m);
    quantities
        .fold(finding, |finding, (key, height_m)| finding.quantity(key, *height_m, Unit::Metre))
        .with(Remedy::Corrections)
}

/// A misreading that would explain the contradictions of an answer.
pub struct SuspectedMisreading<'a> {
    /// Misreading, assumption and correction in words.
    pub misreading: &'a str,
    pub assuming: &'a str,
    pub correction: &'a str,
    /// The improvements under the assumption, in words.
    pub improvements: &'a [String],
    /// True if only the rig contradicts the answer; the rig may be wrong itself.
    pub only_by_rig: bool,
    /// True if other misreadings were named before.
    pub is_alternative: bool,
    pub remedy: Option<Remedy>,
}

pub fn misreading_suspected(suspected: SuspectedMisreading<'_>) -> Finding {
    let SuspectedMisreading { misreading, assuming, correction, improvements, .. } = suspected;
    let or = if suspected.is_alternative { "or else " } else { "" };
    let unless =
        if suspected.only_by_rig { ", unless the reading of the rig is wrong" } else { "" };
    let message =
        format!("{or}{misreading}: {assuming} {}; {correction}{unless}", improvements.join(", "));
    let finding = Finding::new(kinds::MISREADING_SUSPECTED, message)
        .about(Subject::Named(misreading.to_owned()));
    suspected.remedy.into_iter().fold(finding, Finding::with)
}

pub fn misreading_not_found() -> Finding {
    Finding::new(
        kinds::MISREADING_NOT_FOUND,
        "no single misreading explains the contradictions of this answer: station numbers, the sense of azimuths and ranges in \
         feet were tried",
    )
}

pub(super) fn examples() -> Vec<Finding> {
    vec![
        points_leave_direction_free(),
        points_weak(0.03, true),
        control_points_contradict("GCP.txt", 0.04, 0.01, Some(3)),
        drive_contradicts(0.03, 0.005),
        drive_fits_poorly(0.008, 0.01),
        rig_orientation_contradicts(0.4, -0.4),
        rig_heights_contradict(&[0.2, 0.1], &[-0.2, -0.1]),
        misreading_suspected(SuspectedMisreading {
            misreading: "stations 2 and 3 look exchanged",
            assuming: "with the numbers corrected",
            correction: "set `stations` of deployment.toml",
            improvements: &["the distances fit to 1.3 mm instead of 42 mm".to_owned()],
            only_by_rig: false,
            is_alternative: false,
            remedy: None,
        }),
        misreading_not_found(),
    ]
}
