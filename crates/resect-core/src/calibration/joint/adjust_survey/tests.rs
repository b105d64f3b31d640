use super::super::state_vector::Constants;
use super::super::state_vector::tests::layout;
use super::*;
use crate::calibration::Quantity;
use crate::deployment::{ControlPoint, kinds};
use crate::geometry::{ARCSECOND_RAD, Polar};

/// Readings of twelve markers by three stations, without errors.
pub fn exact_survey() -> Vec<ControlPointSet> {
    let stations = [
        LevelTransform::IDENTITY,
        LevelTransform::new(Vector3::new(32.0, -9.0, 0.8), 0.6),
        LevelTransform::new(Vector3::new(11.0, 27.0, -0.5), -2.0),
    ];
    let point = |marker: i64| {
        let angle_rad = 0.53 * marker as f64;
        let radius_m = 12.0 + (7 * marker % 25) as f64;
        let height_m = 0.4 * (marker % 4) as f64 - 1.0;
        let position_m =
            Vector3::new(15.0 + radius_m * angle_rad.cos(), radius_m * angle_rad.sin(), height_m);
        let reading = |station: &LevelTransform| {
            Some(Polar::from_cartesian(station.inverse().apply(&position_m)))
        };
        // The last three are surveyed as well.
        let known_m = (marker > 9).then(|| position_m + Vector3::new(100.0, 50.0, 3.0));
        let readings = stations.each_ref().map(reading).into();
        ControlPoint { readings, ..ControlPoint::unread(marker, known_m) }
    };
    let points = (1..=12).map(point).collect();
    vec![ControlPointSet { file: "GCP.txt".to_owned(), points, pillars: false }]
}

pub fn adjusted(sets: &[ControlPointSet]) -> Survey {
    adjust(sets, &layout(3), &ErrorSizes::default()).expect("an adjustment")
}

/// The survey with a vertical index and a collimation error at station 2.
fn survey_with_errors(index_rad: f64, collimation_rad: f64, of_both_faces: bool) -> Survey {
    let mut sets = exact_survey();
    for point in &mut sets[0].points {
        let mean = point.readings[1].expect("a reading");
        let face_one = Some(Polar {
            azimuth_rad: mean.azimuth_rad + collimation_rad / mean.zenith_rad.sin(),
            zenith_rad: mean.zenith_rad + index_rad,
            ..mean
        });
        if of_both_faces {
            point.face_one[1] = face_one;
        } else {
            point.readings[1] = face_one;
        }
    }
    adjusted(&sets)
}

/// Differences of the constants, those of coefficients of refraction in ten thousandths.
fn off(survey: &Survey, exact: &Survey) -> Constants {
    let mut off = &survey.constants - &exact.constants;
    for (unknown, _, index) in layout(3).each() {
        off[index] *= if unknown.quantity == Quantity::Coefficient { 1e-4 } else { 1.0 };
    }
    off
}

#[test]
fn both_faces_determine_vertical_index_and_collimation() {
    let (index_rad, collimation_rad) = (40.0 * ARCSECOND_RAD, -25.0 * ARCSECOND_RAD);
    let exact = survey_with_errors(0.0, 0.0, true);
    let survey = survey_with_errors(index_rad, collimation_rad, true);
    assert!(off(&survey, &exact).amax() < 1e-7, "{:?}", off(&survey, &exact));
    let errors = survey.face_errors[1].expect("both faces");
    assert_eq!((errors.points, survey.face_errors[0].is_none()), (12, true));
    for (estimate, error_rad) in
        [(errors.index_rad, index_rad), (errors.collimation_rad, collimation_rad)]
    {
        assert!((estimate.value - error_rad).abs() < ARCSECOND_RAD, "{estimate:?}");
        assert!(estimate.sigma < 0.5 * ARCSECOND_RAD, "{estimate:?}");
    }
    let findings = survey.significant_face_errors(&ErrorSizes::default());
    assert_eq!(findings.len(), 2);
    assert!(findings.iter().all(|finding| finding.kind == kinds::INSTRUMENT_ERROR));
    // The same errors in one face change the heights.
    let one_face = survey_with_errors(index_rad, collimation_rad, false);
    assert!(off(&one_face, &exact)[2].abs() > 1e-3, "{:?}", off(&one_face, &exact));
}

#[test]
fn a_reading_in_both_faces_leaves_the_redundancy_of_others() {
    let survey = survey_with_errors(0.0, 0.0, true);
    for reading in &survey.readings {
        let is_share = |share: f64| (0.0..=1.0).contains(&share);
        assert!(reading.redundancy.iter().copied().all(is_share), "{reading:?}");
    }
}
