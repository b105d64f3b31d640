//! Tests of facets, of targets at control points, and of set-ups that change between survey and drive.

use super::*;
use resect_core::network::PerStation;

/// Errors of three different prisms.
fn facets() -> [FacetErrors; 3] {
    [1, 2, 3]
        .map(|seed| FacetErrors::draw([0.001, 0.0005, 0.001], &mut ErrorKind::Facets.rng(seed)))
}

#[test]
fn facets_have_the_sizes_that_were_asked_for() {
    const PRISMS: u64 = 1000;
    const INCIDENCES: u32 = 24;
    let rms_m = [0.001, 0.0005, 0.002];
    let mut squares_m2 = Vector3::zeros();
    for seed in 0..PRISMS {
        let errors = FacetErrors::draw(rms_m, &mut ErrorKind::Facets.rng(seed));
        let error_m = |k: u32| errors.at_m(TAU * f64::from(k) / f64::from(INCIDENCES));
        squares_m2 += (0..INCIDENCES)
            .map(|k| error_m(k).map(|value_m| value_m * value_m))
            .sum::<Vector3<f64>>();
    }
    for (square_m2, rms_m) in squares_m2.iter().zip(rms_m) {
        near((square_m2 / (PRISMS as f64 * f64::from(INCIDENCES))).sqrt() / rms_m, 1.0, 0.06);
    }
}

#[test]
fn facets_repeat_with_the_incidence_on_each_prism() {
    let errors = || SystematicErrors { facets: Some(facets().into()), ..none() };
    let Truth { motion, prisms_m, station1_from_station, .. } = drive(errors()).truth;
    for (station, pairs) in side_by_side(errors()).iter().enumerate() {
        let own = facets()[station];
        for (right, wrong) in pairs {
            let (origin_m, world_from_vehicle) = motion.pose(right.time_s);
            let prism_m = origin_m + world_from_vehicle * prisms_m[station];
            let to_station_m = station1_from_station[station].translation_m - prism_m;
            let [ahead_m, left_m] =
                [0, 1].map(|axis| world_from_vehicle.column(axis).dot(&to_station_m));
            let incidence_rad = left_m.atan2(ahead_m);
            let expected_m = own.at_m(incidence_rad);
            assert!((own.at_m(incidence_rad - TAU) - expected_m).norm() < 1e-12, "repeats");
            let turned_rad = wrap_to_pi(wrong.azimuth_rad - right.azimuth_rad);
            let across_m = right.range_m * right.zenith_rad.sin() * turned_rad;
            let upward_m = right.range_m * (right.zenith_rad - wrong.zenith_rad);
            // Stamps of this size resolve a quarter of a microsecond.
            near(wrong.range_m - right.range_m, expected_m.x, 1e-7);
            near(across_m, expected_m.y, 1e-7);
            near(upward_m, expected_m.z, 1e-7);
        }
    }
    for (_, prism, right, wrong) in standing(errors()) {
        assert_eq!(right != wrong, prism.is_some(), "targets have no facets, the rig has");
    }
}

/// Positions of the targets without and with some errors by each station, in the frame of the survey (m).
fn survey_m(errors: SystematicErrors) -> Vec<[(Vector3<f64>, Vector3<f64>); 3]> {
    let (right, wrong) = (drive(none()), drive(errors));
    let positions = |simulated: &Simulated| -> Vec<[Vector3<f64>; 3]> {
        let points = simulated.control_points.iter().flat_map(|set| set.points.clone());
        let frames = &simulated.truth.station1_from_station_at_survey;
        let place = |point: ControlPoint| {
            std::array::from_fn(|station| {
                let reading = point.readings[station].expect("read");
                frames[station].apply(&reading.to_cartesian())
            })
        };
        points.map(place).collect()
    };
    let pairs = positions(&right).into_iter().zip(positions(&wrong));
    pairs.map(|(right, wrong)| std::array::from_fn(|k| (right[k], wrong[k]))).collect()
}

#[test]
fn targets_stand_off_their_markers_and_turn_to_the_stations() {
    let centring = Some(Centring { marker_m: 0.001, turned_m: 0.0003 });
    let targets = survey_m(SystematicErrors { centring, ..none() });
    assert_eq!(targets.len(), 24);
    let rms_m = |offsets_m: &mut dyn Iterator<Item = Vector3<f64>>| {
        let squares: Vec<f64> = offsets_m.map(|offset_m| offset_m.norm_squared() / 3.0).collect();
        (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
    };
    let offset_m = |(right, wrong): &(Vector3<f64>, Vector3<f64>)| wrong - right;
    let own = &mut targets.iter().map(|target| offset_m(&target[0]));
    near(rms_m(own), 0.001_f64.hypot(0.0003), 0.0003);
    let turned = &mut targets.iter().map(|target| offset_m(&target[1]) - offset_m(&target[2]));
    near(rms_m(turned), 2.0_f64.sqrt() * 0.0003, 0.0001);
}

#[test]
fn set_ups_change_between_the_survey_and_the_drive() {
    let change = |station: usize| ChangedSetUp {
        station,
        turn_rad: 1e-3,
        move_m: Vector3::new(0.004, -0.002, 0.001),
        lean_rad: [0.0; 2],
    };
    let errors =
        |station: usize| SystematicErrors { set_up_changes: vec![change(station)], ..none() };
    for changed in 0..3 {
        let pairs = side_by_side(errors(changed));
        assert!(pairs.iter().flatten().all(|(right, wrong)| right == wrong), "not the drive");
        let truth = drive(errors(changed)).truth;
        let (at_survey, in_drive) =
            (truth.station1_from_station_at_survey, truth.station1_from_station);
        for point in drive(errors(changed)).control_points.iter().flat_map(|set| &set.points) {
            let apart_m = |transforms: &PerStation<LevelTransform>| {
                let transforms = transforms.map(|level| RigidTransform::from(*level));
                point.disagreements_m(&transforms).fold(0.0, f64::max)
            };
            assert!(apart_m(&at_survey) < 1e-9, "{changed}: {point:?}");
            assert!(apart_m(&in_drive) > 0.002, "{changed}: {point:?}");
        }
        assert_eq!(at_survey[0], LevelTransform::IDENTITY);
        if changed > 0 {
            let moved_m = in_drive[changed].translation_m - at_survey[changed].translation_m;
            assert!((moved_m - change(changed).move_m).norm() < 1e-12, "{moved_m}");
            let turned_rad = in_drive[changed].yaw_rad - at_survey[changed].yaw_rad;
            near(wrap_to_pi(turned_rad), 1e-3, 1e-12);
        }
    }
}

#[test]
fn a_tripod_that_leans_at_the_survey_sees_the_targets_lean() {
    let lean_rad = [0.0, 1e-3];
    let move_m = Vector3::zeros();
    let set_up_changes = vec![ChangedSetUp { station: 0, turn_rad: 0.0, move_m, lean_rad }];
    for (station, prism, right, wrong) in standing(SystematicErrors { set_up_changes, ..none() }) {
        // The drive leans up towards +x relative to the survey, so at the survey targets ahead appear lower.
        let is_first = station == 0 && prism.is_none();
        let lowered_rad = if is_first { 1e-3 * right.azimuth_rad.cos() } else { 0.0 };
        near(wrong.zenith_rad - right.zenith_rad, lowered_rad, 2e-6);
    }
}

#[test]
fn control_points_in_a_tunnel_are_along_its_walls() {
    let scenario = Scenario { control_point_sets: 1, ..Preset::Hd2Tunnel.scenario() };
    let simulated = simulate_scenario(&scenario, 3);
    let [set] = &simulated.control_points[..] else { panic!("one set") };
    let places_m = set.points.iter().map(|point| point.readings[0].expect("read").to_cartesian());
    let along_m: Vec<f64> = places_m.map(|place_m| place_m.x).collect();
    assert!(along_m.windows(2).all(|pair| pair[0] < pair[1]), "{along_m:?}");
    assert!(along_m[0] < 20.0 && along_m[9] > 60.0, "{along_m:?}");
}
