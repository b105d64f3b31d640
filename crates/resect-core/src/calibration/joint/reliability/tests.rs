//! Tests of the reliability of groups of readings.

use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};

use super::super::adjust_survey::tests::{adjusted, exact_survey};
use super::super::constants_prior::precisions;
use super::super::state_vector::tests::layout;
use super::super::survey::Survey;
use super::*;
use crate::calibration::ErrorSizes;

/// Readings of all constants and, except for the poses, priors; those of the distances are correlated.
fn dense_problem(layout: &Layout) -> (DMatrix<f64>, ConstantsMatrix) {
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(7);
    let constants = layout.constants;
    let design = DMatrix::from_fn(50, constants, |_, _| rng.random_range(-1.0..1.0));
    let mut information = ConstantsMatrix::zeros(constants, constants);
    (8..constants).for_each(|index| information[(index, index)] = 4.0 + index as f64);
    for a in layout.indices(&DISTANCE) {
        layout.indices(&DISTANCE).filter(|b| *b != a).for_each(|b| information[(a, b)] = -5.0);
    }
    (design, information)
}

/// Least squares of exact readings of zero and of biased priors: the estimates, and the sum of squared residuals.
fn solve(
    design: &DMatrix<f64>,
    information: &ConstantsMatrix,
    prior_mean: &Constants,
) -> (DVector<f64>, f64) {
    // The priors as whitened observations; the poses have none.
    let constants = design.ncols();
    let own = information.view((8, 8), (constants - 8, constants - 8)).into_owned();
    let root = own.cholesky().expect("definite").l().transpose();
    let readings = design.nrows();
    let mut rows = DMatrix::<f64>::zeros(readings + constants - 8, constants);
    rows.rows_mut(0, readings).copy_from(design);
    rows.view_mut((readings, 8), (constants - 8, constants - 8)).copy_from(&root);
    let mut right = DVector::<f64>::zeros(rows.nrows());
    let of_priors = root * prior_mean.rows(8, constants - 8);
    right.rows_mut(readings, constants - 8).copy_from(&of_priors);
    let solution = rows.clone().svd(true, true).solve(&right, 1e-12).expect("a solution");
    let residuals = &rows * &solution - right;
    (solution, residuals.norm_squared())
}

#[test]
fn a_detectable_bias_has_the_noncentrality_and_the_effect_of_least_squares() {
    let layout = &*layout(3);
    let (design, information) = dense_problem(layout);
    let covariance =
        (design.tr_mul(&design) + &information).cholesky().expect("definite").inverse();
    let with_poses = &covariance.columns(0, 8).into_owned();
    let change = Constants::zeros(layout.constants);
    let (information, covariance) = (information.clone(), &covariance);
    let added = &(covariance * 0.0);
    let posterior = PosteriorMoments { layout, information, change, covariance, added, with_poses };
    let unknowns = [
        (&RANGE_OFFSET, 1),
        (&RANGE_SCALE, 0),
        (&COLLIMATION, 2),
        (&VERTICAL_INDEX, 0),
        (&DISTANCE, 0),
        (&DISTANCE, 2),
    ];
    for index in unknowns.map(|(unknown, owner)| layout.index(unknown, owner)) {
        let test = posterior.test_prior(index);
        let bias = test.bias.expect("determined");
        let mut prior_mean = Constants::zeros(layout.constants);
        prior_mean[index] = bias.size;
        let (solution, square) = solve(&design, &posterior.information, &prior_mean);
        let noncentrality = square.sqrt();
        assert!(
            (noncentrality - CRITICAL_SIGMAS - POWER_SIGMAS).abs() < 1e-9,
            "{index}: {noncentrality}"
        );
        for (slot, effect) in bias.effect.iter().enumerate() {
            let position_m = solution.rows(4 * slot, 3).norm();
            let yaw_rad = solution[4 * slot + 3].abs();
            assert!((effect.position_m - position_m).abs() < 1e-9, "{index}: {position_m}");
            assert!((effect.yaw_rad - yaw_rad).abs() < 1e-9, "{index}: {yaw_rad}");
        }
        assert!((0.0..1.0).contains(&test.redundancy), "{index}: {}", test.redundancy);
    }
}

#[test]
fn a_prior_that_the_data_does_not_reduce_has_no_detectable_bias() {
    let layout = &*layout(3);
    let size = layout.constants;
    let posterior = PosteriorMoments {
        layout,
        information: ConstantsMatrix::identity(size, size),
        change: Constants::zeros(size),
        covariance: &ConstantsMatrix::from_diagonal_element(size, size, 0.97),
        added: &ConstantsMatrix::zeros(size, size),
        with_poses: &DMatrix::zeros(size, 8),
    };
    let test = posterior.test_prior(layout.index(&RANGE_OFFSET, 0));
    assert_eq!((test.bias, test.residual_sigmas), (None, None));
    assert!((test.redundancy - 0.03).abs() < 1e-12);
}

#[test]
fn an_error_of_a_control_point_moves_the_adjustment_by_its_influence() {
    const ERROR_M: f64 = 5e-5;
    let before = adjusted(&exact_survey());
    let own = ConstantsMatrix::from_diagonal(&precisions(&layout(3), &ErrorSizes::default()));
    let covariance = (&before.information + own).cholesky().expect("definite").inverse();
    let errors = [(1, 4, 0), (2, 10, 0), (0, 7, 1), (1, 2, 2), (2, 11, 2)];
    for (station, point, axis) in errors {
        let mut sets = exact_survey();
        let reading = sets[0].points[point].readings[station].as_mut().expect("a reading");
        match axis {
            0 => reading.range_m += ERROR_M,
            1 => reading.azimuth_rad += ERROR_M / (reading.range_m * reading.zenith_rad.sin()),
            _ => reading.zenith_rad -= ERROR_M / reading.range_m,
        }
        let after = adjusted(&sets);
        let is_it = |one: &&SurveyReading| one.station.index() == station && one.point == point;
        let find = |survey: &Survey| survey.readings.iter().find(is_it).expect("adjusted").clone();
        let (own, biased) = (find(&before), find(&after));
        // Robust weights and noise levels follow the error a little.
        let expected = -&covariance * own.influence.column(axis) * ERROR_M;
        let moved = &after.constants - &before.constants;
        for slot in 0..2 {
            let [expected, moved] =
                [&expected, &moved].map(|all| all.fixed_rows::<3>(4 * slot).into_owned());
            let off_m = (expected - moved).norm();
            assert!(off_m < 0.05 * expected.norm() + 2e-6, "{station} {point}: {off_m}");
        }
        let remains = (own.residual_m - biased.residual_m)[axis] / ERROR_M;
        let redundancy = own.redundancy[axis];
        assert!((remains - redundancy).abs() < 0.05, "{station} {point}: {remains}");
    }
}

#[test]
fn groups_of_control_points_have_the_reading_with_the_largest_residual() {
    let mut sets = exact_survey();
    sets[0].points[5].readings[1].as_mut().expect("a reading").range_m += 0.02;
    let survey = adjusted(&sets);
    let groups = control_point_reliability(&survey.readings, 3, |_| PoseChange::zeros(8));
    let codes: Vec<String> = groups.iter().map(GroupReliability::code).collect();
    assert_eq!(codes[2..4], ["station-2-control-point-ranges", "station-2-control-point-angles"]);
    assert_eq!(groups.len(), 6);
    let group = &groups[2];
    assert_eq!(group.largest_at(), Some((0, 5)));
    assert!(group.residual_sigmas().expect("residuals").abs() > 4.0, "{group:?}");
    let redundancy = group.redundancy.expect("redundant");
    let bias = group.bias.as_ref().expect("determined");
    assert!((0.2..1.0).contains(&redundancy) && bias.size > 1e-3 && bias.size < 0.02);
}
