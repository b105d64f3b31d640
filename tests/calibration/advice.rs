//! Advice on the first and next moves, followed during simulated drives with all errors of the field.

#![allow(clippy::print_stdout, reason = "the tables are the point")]

use crate::common::{analyse, by};
use nalgebra::{Vector2, Vector3};
use rayon::prelude::*;
use resect_core::analysis::{Analysis, Settings};
use resect_core::calibration::inter_prism::observability::Hold;
use resect_core::calibration::joint::ExpectedNoise;
use resect_core::calibration::{ErrorSizes, Method};
use resect_core::evaluation::far_end::far_end;
use resect_core::geometry::{LevelTransform, RigidTransform};
use resect_core::network::Prism;
use resect_core::pipeline::Thresholds;
use resect_core::progress::Progress;
use resect_tools::planning::{Known, NextMove, Plan, SoFar, known, opening_m, what_next};
use resect_tools::simulation::{
    EPOCH_S, ErrorKind, Motion, Path, Preset, Scenario, Simulated, Waypoint, simulate_scenario,
};

/// Interval at which the estimate is tested for sufficiency (s).
const EVERY_S: f64 = 20.0;
const TURN_RADIUS_M: f64 = 3.5;
/// Time at rest at the start, as in the preset's own drive, and least time at rest before a turn on the spot.
const STAND_S: f64 = 8.0;
const STOP_S: f64 = 0.01;
/// Number of positions at which the accuracy is required.
const PLACES: u32 = 42;

/// Stations, rig and instruments of a preset with all errors of the field except clock steps.
struct Site {
    scenario: Scenario,
    seed: u64,
    sizes: ErrorSizes,
    settings: Settings,
    /// Positions on the preset's own drive.
    places_m: Vec<Vector3<f64>>,
    target_m: f64,
}

impl Site {
    fn new(preset: Preset, seed: u64, target_m: f64) -> Self {
        let drawn_errors =
            ErrorKind::ALL.into_iter().filter(|kind| *kind != ErrorKind::ClockJumps).collect();
        let scenario = Scenario { drawn_errors, ..preset.scenario() }.draw_errors(seed);
        let sizes = ErrorSizes { inter_prism_m: 0.001, ..ErrorSizes::default() };
        Self::told(scenario, seed, sizes, by(Method::Joint), target_m)
    }

    /// The same with the paper's instruments: noise and lost locks are their only errors. The estimate has matching error sizes: apart from
    /// the clocks, only errors that calibrated instruments still have.
    fn of_the_paper(preset: Preset, seed: u64, target_m: f64) -> Self {
        let sizes = ErrorSizes {
            inter_prism_m: 0.3e-3,
            latency_s: 1e-3,
            lean_rad: 1e-6,
            range_offset_m: 0.3e-3,
            range_scale: 2e-6,
            index_rad: 2e-6,
            collimation_rad: 2e-6,
            settling_rad: 3e-6,
            settling_m: 0.1e-3,
            ranges_wander: false,
            ..ErrorSizes::default()
        };
        let mut settings = by(Method::Joint);
        settings.calibration.errors = sizes;
        settings.calibration.inter_prism_sigma_m = sizes.inter_prism_m;
        Self::told(preset.scenario(), seed, sizes, settings, target_m)
    }

    fn told(
        scenario: Scenario,
        seed: u64,
        sizes: ErrorSizes,
        settings: Settings,
        target_m: f64,
    ) -> Self {
        let motion = simulate_scenario(&scenario, seed).truth.motion;
        let above_m = Vector3::new(0.0, 0.0, 1.4);
        let at = |k: u32| f64::from(k) * scenario.duration_s / f64::from(PLACES);
        let places_m = (0..PLACES).map(|k| motion.position_m(&above_m, at(k))).collect();
        Self { scenario, seed, sizes, settings, places_m, target_m }
    }

    fn along(&self, waypoints: &[Waypoint]) -> Simulated {
        let path = Path::Waypoints { waypoints: waypoints.to_vec(), turn_radius_m: TURN_RADIUS_M };
        simulate_scenario(&Scenario { path, ..self.scenario.clone() }, self.seed)
    }

    /// Returns the time at which a drive along waypoints arrives (s), at most `latest_s`.
    fn arrival_s(&self, waypoints: &[Waypoint], latest_s: f64) -> f64 {
        let cruise_m_per_s = self.scenario.cruise_m_per_s;
        Motion::arrival_s(waypoints, TURN_RADIUS_M, cruise_m_per_s, latest_s)
    }

    /// Returns the coach's advice before there is a calibration, from the preset's start in its initial direction.
    fn opening(&self, preset: Preset) -> Vec<Waypoint> {
        let own = Plan::from_preset(preset, self.seed).waypoints();
        let (at_m, heading) = (own[0].place_m(), own[1].place_m() - own[0].place_m());
        let stations_m =
            self.scenario.stations_m.iter().map(Vector3::xy).sum::<Vector2<f64>>() / 3.0;
        let places_m = opening_m(at_m, heading.normalize(), stations_m);
        let mut waypoints: Vec<Waypoint> = places_m.into_iter().map(Waypoint::at).collect();
        waypoints[0].stand_s = STAND_S;
        waypoints
    }

    /// Returns the joint estimate of the readings up to a time of the drive (s).
    fn analysis(&self, drive: &Simulated, until_s: f64) -> Analysis {
        let mut so_far = drive.clone();
        so_far.records.retain(|record| record.measurement.time_s < EPOCH_S + until_s);
        analyse(&resect_io::simulation_files::open(&so_far).expect("valid"), &self.settings)
    }

    /// Evaluates the readings so far; `None` without a calibration.
    fn ask<T>(&self, analysis: &Analysis, ask: impl FnOnce(&SoFar<'_>) -> T) -> Option<T> {
        let calibration = &analysis.answer.as_ref().ok()?.calibration;
        let stations = calibration
            .station1_from_station
            .map(|at| LevelTransform::new(at.translation_m, at.yaw_rad()));
        let expected =
            calibration.joint().map_or_else(ExpectedNoise::default, |joint| ExpectedNoise {
                levels: joint.levels,
                ranges: joint.slow_ranges,
                across: joint.slow_across,
                upward: joint.slow_upward,
            });
        Some(ask(&SoFar {
            triplets: &analysis.pipeline.triplets,
            station1_from_station: &stations,
            followed: &analysis.offer.followed,
            prisms_m: &self.scenario.prisms_m,
            sizes: &self.sizes,
            expected,
            rate_hz: self.scenario.rate_hz,
            thresholds: Thresholds::default(),
            places_m: &self.places_m,
            target_m: self.target_m,
            speed_m_per_s: self.scenario.cruise_m_per_s,
            turn_radius_m: TURN_RADIUS_M,
        }))
    }

    fn known(&self, analysis: &Analysis) -> Option<Known> {
        let covariance = analysis.answer.as_ref().ok()?.calibration.covariance.clone();
        self.ask(analysis, |so_far| {
            known(so_far, covariance.as_ref(), &Progress::default()).expect("nobody cancels it")
        })
    }

    /// Returns the largest σ at the site's positions (m) if an estimate from the drive so far
    /// constrains every direction, and each position to the target. Independent of the drive.
    fn enough(&self, drive: &Simulated, until_s: f64) -> Option<f64> {
        let analysis = self.analysis(drive, until_s);
        let seen = self.known(&analysis)?.observability?;
        let calibration = &analysis.answer.as_ref().ok()?.calibration;
        let transforms = &calibration.station1_from_station;
        let own = transforms.map(|at| -> Vec<_> {
            let station_from_station1 = at.inverse();
            self.places_m.iter().map(|place_m| station_from_station1.apply(place_m)).collect()
        });
        let sigma_m = far_end(transforms, calibration.covariance.as_ref()?, &own)?.sigma_m;
        (seen.count(Hold::Held) == 8 && sigma_m <= self.target_m).then_some(sigma_m)
    }

    /// Returns the time at which a drive is first sufficient (s), to a few seconds.
    fn reaches_s(&self, drive: &Simulated, from_s: f64, until_s: f64) -> Option<f64> {
        const EVERY_S: f64 = 4.0;
        let times_s = (0..).map(|step| from_s + EVERY_S * f64::from(step));
        let mut times_s = times_s.take_while(|at_s| *at_s <= until_s);
        times_s.find(|at_s| self.enough(drive, *at_s).is_some())
    }

    /// Returns the error of the far end by the calibration (m).
    fn off_m(&self, drive: &Simulated, analysis: &Analysis, known: &Known) -> Option<f64> {
        let far = known.far_end?;
        let truth = drive.truth.station1_from_station.map(|level| RigidTransform::from(*level));
        let found = &analysis.answer.as_ref().ok()?.calibration.station1_from_station;
        let own = found[far.station].inverse().apply(&far.position_m);
        Some((truth[far.station].apply(&own) - far.position_m).norm())
    }
}

/// Returns the beginning of a preset's own drive.
fn beginning(site: &Site, preset: Preset, for_s: f64) -> Vec<Waypoint> {
    let mut waypoints = Plan::from_preset(preset, site.seed).waypoints();
    while waypoints.len() > 2 && site.arrival_s(&waypoints, 1e3) > for_s {
        waypoints.pop();
    }
    waypoints
}

/// Follows the best advice a number of times after a beginning. Returns σ at the far end before and after each (m), as predicted and as
/// estimated from the readings, and the drive with its end time (s).
fn followed(
    site: &Site,
    mut waypoints: Vec<Waypoint>,
    times: usize,
) -> (Vec<[Option<f64>; 3]>, Simulated, f64) {
    let mut steps = Vec::new();
    for _ in 0..times {
        let now_s = site.arrival_s(&waypoints, site.scenario.duration_s);
        let drive = site.along(&waypoints);
        let before = site.analysis(&drive, now_s);
        let best = site.ask(&before, advised).flatten().expect("something helps");
        println!("    {now_s:>4.0} s: {}", best.sentence);
        // The vehicle is at the first of them already, where it stops to turn on the spot.
        let last = waypoints.len() - 1;
        waypoints[last].stand_s += STOP_S;
        waypoints.extend(best.waypoints_m.into_iter().skip(1).map(Waypoint::at));
        let mut then_s = site.arrival_s(&waypoints, site.scenario.duration_s);
        if then_s < now_s + 5.0 {
            // After a lost lock, the advice is to stay: the vehicle waits until it is tracked again.
            let last = waypoints.len() - 1;
            waypoints[last].stand_s += 10.0;
            then_s += 10.0;
        }
        let drive = site.along(&waypoints);
        let after = site.analysis(&drive, then_s);
        let sigma_m = |analysis: &Analysis| Some(site.known(analysis)?.far_end?.sigma_m);
        steps.push([sigma_m(&before), Some(best.after_m), sigma_m(&after)]);
    }
    let end_s = site.arrival_s(&waypoints, site.scenario.duration_s);
    let drive = site.along(&waypoints);
    (steps, drive, end_s)
}

/// Drives with insufficient information of their own: an L never gets better
/// than 8 mm, and a line and a circle leave directions unconstrained.
#[test]
fn advice_makes_a_drive_of_one_that_holds_too_little() {
    let cases = [(Preset::StraightLine, 1), (Preset::Circle, 2), (Preset::LShape, 3)];
    cases.into_par_iter().for_each(|(preset, seed)| {
        let mut site = Site::new(preset, seed, 0.006);
        site.scenario.duration_s = 240.0;
        let begun = beginning(&site, preset, 45.0);
        let (steps, drive, end_s) = followed(&site, begun, 3);
        let analysis = site.analysis(&drive, end_s);
        let known = site.known(&analysis).expect("an answer");
        let far = known.far_end.expect("nothing is free any more");
        let off_m = site.off_m(&drive, &analysis, &known).expect("an answer");
        println!("{}: {:.1} mm, off by {:.1} mm", preset.name(), far.sigma_m * 1e3, off_m * 1e3);
        assert!(end_s < 240.0, "{}: {end_s} s", preset.name());
        assert!(far.sigma_m < 0.0085, "{}: {:?}", preset.name(), steps);
        assert!(off_m < 3.0 * far.sigma_m, "{}: {off_m}", preset.name());
        let [_, foreseen_m, found_m] = steps[steps.len() - 1];
        let ratio = found_m.expect("held") / foreseen_m.expect("held");
        // The analysis uses control points, which predictions do not know.
        assert!((0.5..1.25).contains(&ratio), "{}: {steps:?}", preset.name());
    });
}

/// Half the width of the simulated tunnel (m), and its direction from the x axis (rad).
const HALF_TUNNEL_M: f64 = 2.0;
const TUNNEL_RAD: f64 = 0.4;

/// Returns positions of a tunnel's frame in the frame of station 1 (m): distance into the tunnel, offset from its centre line.
fn in_tunnel(place_m: [f64; 2]) -> Waypoint {
    let along = Vector2::new(TUNNEL_RAD.cos(), TUNNEL_RAD.sin());
    let across = Vector2::new(-along.y, along.x);
    Waypoint::at(Vector2::new(12.0, 6.0) + along * place_m[0] + across * place_m[1])
}

/// Returns all manoeuvres offered at the end of a drive along waypoints.
fn offered(site: &Site, waypoints: &[Waypoint]) -> Vec<NextMove> {
    let end_s = site.arrival_s(waypoints, 1e3);
    let drive = site.along(waypoints);
    let analysis = site.analysis(&drive, end_s);
    let ask = |so_far: &SoFar<'_>| what_next(so_far, &Progress::default()).expect("not cancelled");
    site.ask(&analysis, ask).flatten().map_or_else(Vec::new, |advice| advice.moves)
}

/// Largest distance of a manoeuvre from the tunnel's centre line (m), if driven from a position. Stations that can still slide
/// shift the positions that the coach knows.
fn off_centre_m(one: &NextMove, from: &Waypoint) -> f64 {
    let [origin_m, across_m] = [[0.0; 2], [0.0, 1.0]].map(|at| in_tunnel(at).place_m());
    let by_m = from.place_m() - one.waypoints_m[0];
    let off_m = |at: &Vector2<f64>| (at + by_m - origin_m).dot(&(across_m - origin_m)).abs();
    one.waypoints_m.iter().map(off_m).fold(0.0, f64::max)
}

/// A tunnel 4 m wide, driven on its centre line, along one wall, winding, or there and back. Followed orders stay in it too.
#[test]
fn no_order_in_a_tunnel_leaves_its_width() {
    let winding = |to_m: u32| (0..=to_m / 4).map(|k| [4.0 * f64::from(k), f64::from(k % 3) - 1.0]);
    let drives: [Vec<[f64; 2]>; 5] = [
        vec![[0.0, 0.0], [35.0, 0.0]],
        vec![[0.0, 1.4], [50.0, 1.4]],
        winding(60).collect(),
        winding(60).chain([[60.0, -1.0], [25.0, -1.0]]).collect(),
        winding(40).chain([[40.3, 0.3], [40.0, 0.0]]).collect(),
    ];
    drives.into_par_iter().enumerate().for_each(|(index, drive)| {
        let mut site = Site::new(Preset::StraightLine, 7, 0.0001);
        site.scenario.duration_s = 400.0;
        site.places_m.clear();
        let mut waypoints: Vec<Waypoint> = drive.into_iter().map(in_tunnel).collect();
        for step in 0..3 {
            let moves = offered(&site, &waypoints);
            let turns = moves.iter().filter(|one| one.sentence.contains("turn")).count();
            println!("drive {index}, step {step}: {} orders, {turns} with a turn", moves.len());
            assert!(turns > 0, "drive {index}, step {step}: advice remains possible");
            for one in &moves {
                let off_m = off_centre_m(one, &waypoints[waypoints.len() - 1]);
                assert!(off_m <= HALF_TUNNEL_M, "drive {index}: {off_m:.1} m, {}", one.sentence);
            }
            let last = waypoints.len() - 1;
            waypoints[last].stand_s += STOP_S;
            let best = moves.into_iter().next().expect("one of them");
            let by_m = waypoints[last].place_m() - best.waypoints_m[0];
            waypoints.extend(best.waypoints_m.iter().skip(1).map(|at| Waypoint::at(at + by_m)));
        }
    });
}

/// Too little evidence restricts nothing: neither a drive that began, nor a wide one, however long.
#[test]
fn an_open_field_has_figure_eights_and_so_has_a_drive_that_began() {
    let field = (0..6).map(|k| [f64::from(k) * 10.0, if k % 2 == 0 { -12.0 } else { 12.0 }]);
    let mut site = Site::new(Preset::Warthog, 7, 0.0001);
    site.places_m.clear();
    let drives = [site.opening(Preset::Warthog), field.map(in_tunnel).collect::<Vec<_>>()];
    for (index, drive) in drives.iter().enumerate() {
        let moves = offered(&site, drive);
        println!("drive {index}: {} orders", moves.len());
        for size in ["figure-eight of 16 m", "figure-eight of 28 m", "loop of 12 m"] {
            assert!(moves.iter().any(|one| one.sentence.contains(size)), "drive {index}: {size}");
        }
    }
}

/// Tracks of a straight leg coincide like those of one prism, which would put stations a metre off. The first turn alone is insufficient:
/// the prisms move in every direction, but hardly anywhere.
#[test]
fn a_turn_on_the_spot_after_a_straight_leg_makes_no_one_prism_of_three() {
    let site = Site::new(Preset::LShape, 2, 0.001);
    let (_, drive, end_s) = followed(&site, beginning(&site, Preset::LShape, 45.0), 1);
    let truth = &drive.truth.station1_from_station;
    for until_s in [48.0, 51.0, end_s] {
        let analysis = site.analysis(&drive, until_s);
        assert_eq!(Prism::count(&analysis.offer.followed), 3, "{until_s} s");
    }
    let analysis = site.analysis(&drive, end_s);
    let found = &analysis.answer.as_ref().expect("an answer").calibration.station1_from_station;
    let off_m = (1..3).map(|k| (found[k].translation_m - truth[k].translation_m).norm());
    assert!(off_m.fold(0.0, f64::max) < 0.03);
}

/// Prisms evenly spaced about the middle of a vehicle follow one circle when it turns on the
/// spot, as one prism would. A calibration of one prism would put stations a hundred metres off.
#[test]
fn prisms_that_turn_on_the_spot_are_no_one_prism() {
    let mut site = Site::new(Preset::Warthog, 3, 0.002);
    let of_three = |prism: f64, z_m: f64| {
        let (sin, cos) = (prism / 3.0 * std::f64::consts::TAU).sin_cos();
        Vector3::new(0.5 * cos, 0.5 * sin, z_m)
    };
    site.scenario.prisms_m = [of_three(0.0, 1.55), of_three(1.0, 1.2), of_three(2.0, 1.38)].into();
    let there_and_back = (0..=6).map(|step| Vector2::new(60.0 + 0.05 * f64::from(step % 2), 8.0));
    let mut waypoints: Vec<Waypoint> = there_and_back.map(Waypoint::at).collect();
    waypoints.push(Waypoint::at(Vector2::new(45.0, 6.0)));
    let drive = site.along(&waypoints);
    for until_s in [16.0, 24.0, 36.0, 48.0, 56.0, 64.0] {
        let analysis = site.analysis(&drive, until_s);
        assert_eq!(Prism::count(&analysis.offer.followed), 3, "{until_s} s");
    }
}

/// Returns the time at which the data is first reported as sufficient (s), and the error of the far end then (m).
fn first_enough(site: &Site, drive: &Simulated) -> Option<(f64, f64)> {
    let steps = (site.scenario.duration_s / EVERY_S) as u32;
    (2..=steps).map(|step| f64::from(step) * EVERY_S).find_map(|until_s| {
        let analysis = site.analysis(drive, until_s);
        let known = site.known(&analysis)?;
        let off_m = known.is_enough.then(|| site.off_m(drive, &analysis, &known)).flatten()?;
        Some((until_s, off_m))
    })
}

/// Returns the number of drives that are reported as sufficient; asserts that the far end is then within three times the target.
fn never_too_early(drives: u64) -> usize {
    const TARGET_M: f64 = 0.0055;
    let presets = [Preset::Warthog, Preset::UnevenGround, Preset::Circle, Preset::FigureEight];
    let one = |seed: u64| {
        let preset = presets[(seed % 4) as usize];
        let site = Site::new(preset, seed, TARGET_M);
        let drive = simulate_scenario(&site.scenario, seed);
        let said = first_enough(&site, &drive);
        println!("{:<13} seed {seed}: {said:.4?}", preset.name());
        if let Some((at_s, off_m)) = said {
            assert!(off_m < 3.0 * TARGET_M, "{}: {off_m} m at {at_s} s", preset.name());
            assert!(preset != Preset::Circle, "a circle leaves a direction free");
        }
        usize::from(said.is_some())
    };
    (0..drives).into_par_iter().map(one).sum()
}

#[test]
fn enough_is_never_said_too_early() {
    assert!(never_too_early(8) >= 4);
}

/// 30 of 40 are reported as sufficient, after 80 to 240 s, with an error of the far end
/// of 1.5 to 11.9 mm for a target of 5.5 mm. The rest are circles, which never are.
#[test]
#[ignore = "minutes; prints each drive"]
fn enough_is_never_said_too_early_in_forty_drives() {
    assert!(never_too_early(40) >= 20);
}

/// Time that advised drives need for the final accuracy of the preset's own drive, relative to the preset's own time.
///
/// Noise averages out with time on any drive; turns on the spot give more information in that time. All of 20 reach it, after 58 % of the
/// time on average. By drive: winding on flat ground 45 to 59 %, eights 37 to 49 %, an L 64 to 74 %, the warthog's 63 to 86 %.
#[test]
#[ignore = "minutes; prints the table"]
fn an_advised_drive_is_as_good_in_less_time() {
    let one = |seed: u64| {
        let preset = [Preset::Warthog, Preset::FlatFloor, Preset::LShape, Preset::FigureEight]
            [(seed % 4) as usize];
        let site = Site::new(preset, seed, 0.001);
        let own = simulate_scenario(&site.scenario, seed);
        let own_end_s = site.scenario.duration_s;
        let sigma_m = |drive: &Simulated, at_s: f64| {
            Some(site.known(&site.analysis(drive, at_s))?.far_end?.sigma_m)
        };
        let goal_m = sigma_m(&own, own_end_s)?;
        let mut waypoints = beginning(&site, preset, 45.0);
        let mut reached_s = None;
        while reached_s.is_none() {
            let (_, drive, end_s) = followed(&site, waypoints.clone(), 1);
            let Path::Waypoints { waypoints: driven, .. } = &drive.scenario.path else { break };
            waypoints.clone_from(driven);
            if sigma_m(&drive, end_s).is_some_and(|sigma_m| sigma_m <= goal_m) {
                reached_s = Some(end_s);
            } else if end_s >= own_end_s {
                break;
            }
        }
        println!(
            "{:<13} seed {seed}: {:.1} mm after {own_end_s:.0} s, advised {reached_s:.0?} s",
            preset.name(),
            goal_m * 1e3
        );
        Some(reached_s? / own_end_s)
    };
    let ratios: Vec<Option<f64>> = (0..20).into_par_iter().map(one).collect();
    let reached: Vec<f64> = ratios.iter().copied().flatten().collect();
    let mean = reached.iter().sum::<f64>() / reached.len() as f64;
    println!("{} of 20 reach it, after {:.0} % of the time on average", reached.len(), 1e2 * mean);
    assert!(reached.len() >= 19 && mean < 0.66, "{} of 20 after {mean:.2}", reached.len());
}

/// Returns the times (s) at which the presets' randomly winding drives reach 2 mm at their positions, and those at which drives do that
/// begin with the coach's opening and follow the advice.
fn until_enough(seeds: std::ops::Range<u64>) -> Vec<[f64; 2]> {
    const TARGET_M: f64 = 0.002;
    const FROM_S: f64 = 16.0;
    let presets = [Preset::Warthog, Preset::FlatFloor, Preset::UnevenGround];
    let one = |seed: u64| {
        let preset = presets[(seed % 3) as usize];
        let site = Site::of_the_paper(preset, seed, TARGET_M);
        let whole_s = site.scenario.duration_s;
        let own = simulate_scenario(&site.scenario, seed);
        let own_s = site.reaches_s(&own, FROM_S, whole_s).expect("its own drive reaches it");
        let mut waypoints = site.opening(preset);
        let mut drive = site.along(&waypoints);
        let mut end_s = site.arrival_s(&waypoints, whole_s);
        while end_s < whole_s && site.enough(&drive, end_s).is_none() {
            (_, drive, end_s) = followed(&site, waypoints, 1);
            let Path::Waypoints { waypoints: driven, .. } = &drive.scenario.path else { break };
            waypoints = driven.clone();
        }
        let advised_s = site.reaches_s(&drive, FROM_S, end_s).unwrap_or(end_s);
        let analysis = site.analysis(&drive, advised_s);
        let off_m = site.known(&analysis).and_then(|known| site.off_m(&drive, &analysis, &known));
        println!(
            "{:<13} seed {seed}: by itself after {own_s:.0} s, advised after {advised_s:.0} s, off by {:.1} mm",
            preset.name(),
            off_m.map_or(f64::NAN, |off_m| off_m * 1e3)
        );
        assert!(off_m.is_some_and(|off_m| off_m < 3.0 * TARGET_M), "seed {seed}: {off_m:?}");
        [own_s, advised_s]
    };
    seeds.into_par_iter().map(one).collect()
}

fn advised(so_far: &SoFar<'_>) -> Option<NextMove> {
    let advice = what_next(so_far, &Progress::default()).expect("nobody cancels it")?;
    advice.moves.into_iter().next()
}

/// Returns the mean time of advised drives relative to that of randomly winding ones.
fn share(times_s: &[[f64; 2]]) -> f64 {
    let sum = |which: usize| times_s.iter().map(|times_s| times_s[which]).sum::<f64>();
    println!("{:.0} s instead of {:.0} s in all: {:.2}", sum(1), sum(0), sum(1) / sum(0));
    sum(1) / sum(0)
}

/// Three drives determine the ratio to about a fifth; the twenty below, with a limit of 60 %, are the actual measure.
#[test]
fn who_follows_the_advice_reaches_two_millimetres_sooner() {
    assert!(share(&until_enough(12..15)) <= 0.6);
}

/// Advised drives need 51 s on average and the presets' own 95 s: 53 %, and 57 % over sixty
/// drives. Both stand still for the first 8 s. Most reach the target in the second turn on the
/// spot, at 44 s, before any advice. The rest, in which a lock is lost, need a manoeuvre or two.
///
/// The opening is decisive. Twenty drives were tried with paths of one kind, repeated. Eights of 14 to 32 m need
/// 92 to 96 s. Legs of 12 m there and back with turns on the spot need 79 s. Legs of growing length along the line
/// of sight need 60 s. Single turns at the start and 12 to 15 m further along it need 51 s. Advice alone, from the
/// first calibration at 19 s on, needs 65 s, and 71 s if turns on the spot are predicted but bends are driven.
#[test]
#[ignore = "a minute; prints the table"]
fn who_follows_the_advice_reaches_two_millimetres_sooner_over_twenty_drives() {
    assert!(share(&until_enough(0..20)) <= 0.6);
}
