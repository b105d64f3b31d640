//! Options for systematic errors of the instruments, and their application to a scenario.

use resect_core::calibration::joint::unknown;
use resect_core::network::MOST_STATIONS;
use std::slice::from_mut;

use clap::Args;
use nalgebra::Vector3;

use super::super::Failure;
use super::limits::{Limits, List, replace, replace_row, station};
use resect_core::geometry::ARCSECOND_RAD;
use resect_tools::simulation::{
    Centring, ChangedSetUp, ClockStep, Curvature, ErrorKind, Scenario, Settling, Wander,
    draw_facets,
};

#[derive(Args)]
#[command(next_help_heading = "Errors of instruments")]
pub struct ErrorArguments {
    /// All of the following errors, drawn from the seed with the sizes seen in the field; an explicit option takes precedence
    #[arg(long)]
    field_errors: bool,
    /// Settling of a station: rotation, displacement and optional tilt about
    /// x and y, from a start time and over a duration; may be repeated
    #[arg(
        long,
        value_name = "STATION,FROM_S,OVER_S,TURN_MRAD,MOVE_X_MM,MOVE_Y_MM,MOVE_Z_MM[,ARCSEC,ARCSEC]",
        allow_hyphen_values = true
    )]
    settle: Vec<List>,
    /// Offset added to the ranges of each station (mm)
    #[arg(long, value_name = "MM,MM,MM", value_delimiter = ',', allow_hyphen_values = true)]
    range_offset: Vec<f64>,
    /// Relative excess of their ranges (parts per million)
    #[arg(long, value_name = "PPM,PPM,PPM", value_delimiter = ',', allow_hyphen_values = true)]
    range_scale: Vec<f64>,
    /// Offset added to the ranges to each prism (mm)
    #[arg(long, value_name = "MM,MM,MM", value_delimiter = ',', allow_hyphen_values = true)]
    prism_offset: Vec<f64>,
    /// Error of the prism constant (mm)
    #[arg(long, value_name = "MM", allow_hyphen_values = true)]
    prism_constant_error: Option<f64>,
    /// Time-correlated errors of ranges: 1 σ (mm), and the time after which the correlation falls to 37 % (s)
    #[arg(long, value_name = "MM,S", value_delimiter = ',', allow_hyphen_values = true)]
    range_wander: Vec<f64>,
    /// Latency of the angles relative to the range for each station (ms): the angles are earlier
    #[arg(long, value_name = "MS,MS,MS", value_delimiter = ',', allow_hyphen_values = true)]
    latency: Vec<f64>,
    /// Independent error of every stamp, 1 σ (ms)
    #[arg(long, value_name = "MS", allow_hyphen_values = true)]
    stamp_jitter: Option<f64>,
    /// Delay of the stamps of each station (ms)
    #[arg(long, value_name = "MS,MS,MS", value_delimiter = ',', allow_hyphen_values = true)]
    clock_offset: Vec<f64>,
    /// Rate at which they fall behind (parts per million)
    #[arg(long, value_name = "PPM,PPM,PPM", value_delimiter = ',', allow_hyphen_values = true)]
    clock_drift: Vec<f64>,
    /// Step of a station's stamps: station, size (ms) and time (s, halfway if omitted): 3,20; may be repeated
    #[arg(long, value_name = "STATION,MS[,S]", allow_hyphen_values = true)]
    clock_step: Vec<List>,
    /// Start and end of a pause without readings (s); may be repeated
    #[arg(long, value_name = "FROM_S,TO_S", allow_hyphen_values = true)]
    pause: Vec<List>,
    /// Vertical index error, added to the zenith angles of each station (arcseconds)
    #[arg(long, value_name = "ARCSEC,…", value_delimiter = ',', allow_hyphen_values = true)]
    index: Vec<f64>,
    /// Collimation error of their lines of sight (arcseconds)
    #[arg(long, value_name = "ARCSEC,…", value_delimiter = ',', allow_hyphen_values = true)]
    collimation: Vec<f64>,
    /// Tilt of each station about x and y: x1,y1,x2,y2,x3,y3 (arcseconds)
    #[arg(long, value_name = "ARCSEC,…", value_delimiter = ',', allow_hyphen_values = true)]
    tilt: Vec<f64>,
    /// Earth curvature with diverging plumb lines, and refraction with this coefficient (0.13 if omitted)
    #[arg(long, value_name = "K", num_args = 0..=1, allow_negative_numbers = true)]
    curvature: Option<Option<f64>>,
    /// Refraction of the sights of each station beyond that, upward and to the right: up1,right1,up2,right2,…
    #[arg(long, value_name = "K,…", value_delimiter = ',', allow_hyphen_values = true)]
    refraction: Vec<f64>,
    /// Errors of the written inter-prism distances 12, 13, 23, 14, … (mm)
    #[arg(long, value_name = "MM,MM,MM", value_delimiter = ',', allow_hyphen_values = true)]
    distance_error: Vec<f64>,
    /// Error of the prism constant in these distances (mm)
    #[arg(long, value_name = "MM", allow_hyphen_values = true)]
    rig_constant_error: Option<f64>,
    /// Errors of prisms that repeat with the incidence, drawn from the seed: root mean square along the sight, across it and upward (mm)
    #[arg(long, value_name = "MM,MM,MM", value_delimiter = ',', allow_hyphen_values = true)]
    facets: Vec<f64>,
    /// Position of targets at control points, 1 σ on each axis: beside the marker, and after turning to a station (mm)
    #[arg(long, value_name = "MM,MM", value_delimiter = ',', allow_hyphen_values = true)]
    centring: Vec<f64>,
    /// Change of a station between the control points and the drive: rotation, displacement and optional tilt about x and y;
    /// may be repeated
    #[arg(
        long,
        value_name = "STATION,TURN_MRAD,MOVE_X_MM,MOVE_Y_MM,MOVE_Z_MM[,ARCSEC,ARCSEC]",
        allow_hyphen_values = true
    )]
    set_up_change: Vec<List>,
}

const MILLI: f64 = 1e-3;
const SECONDS: Limits = Limits::up_to(100_000.0, 1.0);
const MILLISECONDS: Limits = Limits::either_way(1000.0, MILLI);
/// Unsynchronised clocks may have any offset.
const CLOCK_MILLISECONDS: Limits = Limits::either_way(1e7, MILLI);
const MILLIMETRES: Limits = Limits::either_way(1000.0, MILLI);
const NO_NEGATIVE_MILLIMETRES: Limits = Limits::up_to(1000.0, MILLI);
const PARTS_PER_MILLION: Limits = Limits::either_way(1000.0, 1e-6);
const MILLIRADIANS: Limits = Limits::either_way(100.0, MILLI);
const ARCSECONDS: Limits = Limits::either_way(3600.0, ARCSECOND_RAD);
/// [`station`] checks the number.
const STATION: Limits = Limits { low: 1.0, high: MOST_STATIONS as f64, unit: 1.0 };

impl ErrorArguments {
    /// Draws the random errors if asked for, then replaces those that are given.
    pub fn apply(&self, scenario: Scenario, seed: u64) -> Result<Scenario, Failure> {
        let mut scenario = if self.field_errors {
            scenario.with_field_errors(seed)
        } else {
            scenario.draw_errors(seed)
        };
        self.replace_constant(&mut scenario)?;
        self.replace_facets(&mut scenario, seed)?;
        self.replace_survey(&mut scenario)?;
        self.replace_at_times(&mut scenario)?;
        Ok(scenario)
    }

    /// Replaces errors that are constant during the drive.
    fn replace_constant(&self, scenario: &mut Scenario) -> Result<(), Failure> {
        let errors = &mut scenario.errors;
        let prism_constant = self.prism_constant_error.as_slice();
        let jitter = Limits { low: 0.0, ..MILLISECONDS };
        for (name, given, limits, to) in [
            (
                "range-offset",
                &self.range_offset[..],
                MILLIMETRES,
                errors.range_offset_m.as_mut_slice(),
            ),
            (
                "range-scale",
                &self.range_scale,
                PARTS_PER_MILLION,
                errors.range_scale.as_mut_slice(),
            ),
            ("prism-offset", &self.prism_offset, MILLIMETRES, errors.prism_offset_m.as_mut_slice()),
            (
                "prism-constant-error",
                prism_constant,
                Limits::either_way(100.0, MILLI),
                from_mut(&mut errors.prism_constant_m),
            ),
            ("latency", &self.latency, MILLISECONDS, errors.latency_s.as_mut_slice()),
            (
                "stamp-jitter",
                self.stamp_jitter.as_slice(),
                jitter,
                from_mut(&mut errors.stamp_jitter_s),
            ),
            (
                "clock-offset",
                &self.clock_offset,
                CLOCK_MILLISECONDS,
                errors.clock_offset_s.as_mut_slice(),
            ),
            (
                "clock-drift",
                &self.clock_drift,
                PARTS_PER_MILLION,
                errors.clock_drift.as_mut_slice(),
            ),
            ("index", &self.index, ARCSECONDS, errors.index_rad.as_mut_slice()),
            ("collimation", &self.collimation, ARCSECONDS, errors.collimation_rad.as_mut_slice()),
            ("tilt", &self.tilt, ARCSECONDS, errors.tilt_rad.as_mut_slice().as_flattened_mut()),
            (
                "distance-error",
                &self.distance_error,
                MILLIMETRES,
                errors.inter_prism_m.as_mut_slice(),
            ),
            (
                "rig-constant-error",
                self.rig_constant_error.as_slice(),
                Limits::either_way(100.0, MILLI),
                from_mut(&mut errors.rig_constant_m),
            ),
        ] {
            replace(name, given, limits, to)?;
        }
        if !self.range_wander.is_empty() {
            let mut row = [0.0; 2];
            let limits = [Limits { low: 0.0, ..MILLIMETRES }, Limits { low: 0.001, ..SECONDS }];
            replace_row("range-wander", &self.range_wander, 2, &limits, &mut row)?;
            let [sigma_m, correlation_s] = row;
            errors.range_wander = Some(Wander { sigma_m, correlation_s });
        }
        if let Some(coefficient) = self.curvature {
            let mut refraction = Curvature::STANDARD.refraction;
            let limits = Limits::either_way(5.0, 1.0);
            replace("curvature", coefficient.as_slice(), limits, from_mut(&mut refraction))?;
            errors.curvature = Some(Curvature { refraction, ..Curvature::STANDARD });
        }
        self.replace_refraction(scenario)
    }

    /// Replaces the refraction of each station, by its rows in the table of unknowns.
    fn replace_refraction(&self, scenario: &mut Scenario) -> Result<(), Failure> {
        let mut coefficients = vec![[0.0; 2]; scenario.stations()];
        let limits = Limits::either_way(100.0, 1.0);
        replace("refraction", &self.refraction, limits, coefficients.as_flattened_mut())?;
        if !self.refraction.is_empty() {
            let rows = [&unknown::REFRACTION_UPWARD, &unknown::REFRACTION_SIDEWAYS];
            for (place, row) in rows.into_iter().enumerate() {
                let sizes = coefficients.iter().map(|both| both[place]).collect();
                scenario.errors.set_further(row, sizes);
            }
        }
        Ok(())
    }

    /// Draws the errors of prisms that repeat with the incidence.
    fn replace_facets(&self, scenario: &mut Scenario, seed: u64) -> Result<(), Failure> {
        let mut rms_m = [0.0; 3];
        replace("facets", &self.facets, NO_NEGATIVE_MILLIMETRES, &mut rms_m)?;
        if !self.facets.is_empty() {
            draw_facets(rms_m, scenario, &mut ErrorKind::Facets.rng(seed));
        }
        Ok(())
    }

    /// Replaces errors of the survey of the control points.
    fn replace_survey(&self, scenario: &mut Scenario) -> Result<(), Failure> {
        let stations = scenario.stations();
        let errors = &mut scenario.errors;
        if !self.centring.is_empty() {
            let mut sigmas_m = [0.0; 2];
            replace("centring", &self.centring, NO_NEGATIVE_MILLIMETRES, &mut sigmas_m)?;
            let [marker_m, turned_m] = sigmas_m;
            errors.centring = Some(Centring { marker_m, turned_m });
        }
        let changes = self.set_up_change.iter().map(|given| {
            let station = station("set-up-change", given, stations)?;
            let limits = [
                STATION,
                MILLIRADIANS,
                MILLIMETRES,
                MILLIMETRES,
                MILLIMETRES,
                ARCSECONDS,
                ARCSECONDS,
            ];
            let mut row = [0.0; 7];
            replace_row("set-up-change", &given.0, 5, &limits, &mut row)?;
            let [_, turn_rad, x_m, y_m, z_m, lean_x_rad, lean_y_rad] = row;
            Ok(ChangedSetUp {
                station,
                turn_rad,
                move_m: Vector3::new(x_m, y_m, z_m),
                lean_rad: [lean_x_rad, lean_y_rad],
            })
        });
        replace_all(changes, &mut errors.set_up_changes)
    }

    /// Replaces errors that begin at some time, any number of them.
    fn replace_at_times(&self, scenario: &mut Scenario) -> Result<(), Failure> {
        let (duration_s, stations) = (scenario.duration_s, scenario.stations());
        // An error outside the drive would have no effect.
        let moment = Limits::up_to(duration_s, 1.0);
        let settling = self.settle.iter().map(|given| {
            let station = station("settle", given, stations)?;
            let limits = [
                STATION,
                moment,
                SECONDS,
                MILLIRADIANS,
                MILLIMETRES,
                MILLIMETRES,
                MILLIMETRES,
                ARCSECONDS,
                ARCSECONDS,
            ];
            let mut row = [0.0; 9];
            replace_row("settle", &given.0, 7, &limits, &mut row)?;
            let [_, from_s, over_s, turn_rad, x_m, y_m, z_m, lean_x_rad, lean_y_rad] = row;
            Ok(Settling {
                station,
                from_s,
                over_s,
                turn_rad,
                move_m: Vector3::new(x_m, y_m, z_m),
                lean_rad: [lean_x_rad, lean_y_rad],
            })
        });
        let clock_steps = self.clock_step.iter().map(|given| {
            let station = station("clock-step", given, stations)?;
            let mut row = [0.0, 0.0, 0.5 * duration_s];
            let limits = [STATION, CLOCK_MILLISECONDS, moment];
            replace_row("clock-step", &given.0, 2, &limits, &mut row)?;
            let [_, by_s, at_s] = row;
            Ok(ClockStep { station, at_s, by_s })
        });
        let pauses_s = self.pause.iter().map(|given| {
            let mut pause_s = [0.0; 2];
            replace_row("pause", &given.0, 2, &[moment; 2], &mut pause_s)?;
            let [from_s, to_s] = pause_s;
            if from_s >= to_s {
                let line =
                    format!("--pause is from {from_s} to {to_s} s; give the earlier time first");
                return Err(Failure::Usage(line));
            }
            Ok(pause_s)
        });
        replace_all(settling, &mut scenario.errors.settling)?;
        replace_all(clock_steps, &mut scenario.errors.clock_steps)?;
        replace_all(pauses_s, &mut scenario.pauses_s)
    }
}

/// Replaces a list by the given one; an empty one changes nothing.
fn replace_all<T>(
    given: impl ExactSizeIterator<Item = Result<T, Failure>>,
    to: &mut Vec<T>,
) -> Result<(), Failure> {
    if given.len() > 0 {
        *to = given.collect::<Result<_, _>>()?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;
    use resect_tools::simulation::{Preset, SystematicErrors};

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        errors: ErrorArguments,
    }

    fn scenario_of(words: &str) -> Result<Scenario, Failure> {
        let line = Line::try_parse_from(["simulate"].into_iter().chain(words.split_whitespace()));
        line.expect("parses").errors.apply(Preset::Warthog.scenario(), 1)
    }

    fn errors(words: &str) -> SystematicErrors {
        scenario_of(words).expect("in range").errors
    }

    fn complaint(words: &str) -> String {
        match scenario_of(words) {
            Err(Failure::Usage(line)) => line,
            other => panic!("{words} gave {other:?}"),
        }
    }

    #[test]
    fn nothing_is_wrong_unless_it_is_asked_for() {
        assert_eq!(scenario_of("").expect("fine"), Preset::Warthog.scenario());
    }

    #[test]
    fn every_option_reaches_its_error_in_its_unit() {
        let errors = errors(
            "--range-offset -1,2,3 --range-scale=40,-5,0 --prism-offset 0.5,0,-0.5 \
             --prism-constant-error -2 --range-wander 1.5,20 --latency 0,10,15 --stamp-jitter 4 \
             --clock-offset -4,0,8 --clock-drift 0,-5,5 --index 3600,0,0 --collimation 0,-3600,0 \
             --tilt 3600,0,0,0,0,-3600 --curvature 0.2 --refraction 3,-1,0,0,2,0.5 \
             --distance-error 1,-2,3 \
             --settle 1,100,0,0.2,5,0,-5 --settle 3,50,60,0,0,0,0,-3600,3600 \
             --clock-step 3,20 --clock-step 1,-5,17.5 --rig-constant-error -10 --facets 1,0.5,2 \
             --centring 1,0.3 --set-up-change 2,-1.5,3,0,-2 --set-up-change 1,0,0,0,0,3600,0",
        );
        let degree = 1.0_f64.to_radians();
        let rounded = |value: f64| (value * 1e12).round() / 1e12;
        let close = |found: &[f64], expected: &[f64]| {
            assert_eq!(found.len(), expected.len());
            for (found, expected) in found.iter().zip(expected) {
                assert_eq!(rounded(*found), rounded(*expected));
            }
        };
        close(errors.range_offset_m.as_slice(), &[-0.001, 0.002, 0.003]);
        close(errors.range_scale.as_slice(), &[40e-6, -5e-6, 0.0]);
        close(errors.prism_offset_m.as_slice(), &[0.0005, 0.0, -0.0005]);
        close(&[errors.prism_constant_m], &[-0.002]);
        let wander = errors.range_wander.expect("given");
        close(&[wander.sigma_m, wander.correlation_s], &[0.0015, 20.0]);
        close(errors.latency_s.as_slice(), &[0.0, 0.010, 0.015]);
        close(&[errors.stamp_jitter_s], &[0.004]);
        close(errors.clock_offset_s.as_slice(), &[-0.004, 0.0, 0.008]);
        close(errors.clock_drift.as_slice(), &[0.0, -5e-6, 5e-6]);
        close(errors.index_rad.as_slice(), &[degree, 0.0, 0.0]);
        close(errors.collimation_rad.as_slice(), &[0.0, -degree, 0.0]);
        close(errors.tilt_rad.as_slice().as_flattened(), &[degree, 0.0, 0.0, 0.0, 0.0, -degree]);
        close(&[errors.curvature.expect("given").refraction], &[0.2]);
        let [upward, sideways] = &errors.further[..] else { panic!("{:?}", errors.further) };
        close(upward.sizes.as_slice(), &[3.0, 0.0, 2.0]);
        close(sideways.sizes.as_slice(), &[-1.0, 0.0, 0.5]);
        close(errors.inter_prism_m.as_slice(), &[0.001, -0.002, 0.003]);
        let [first, second] = errors.settling[..] else { panic!("{:?}", errors.settling) };
        assert_eq!((first.station, second.station), (0, 2));
        close(&[first.from_s, first.over_s, first.turn_rad], &[100.0, 0.0, 0.0002]);
        close(first.move_m.as_slice(), &[0.005, 0.0, -0.005]);
        assert_eq!(first.lean_rad, [0.0; 2]);
        close(&[second.from_s, second.over_s], &[50.0, 60.0]);
        close(&second.lean_rad, &[-degree, degree]);
        let [half_way, given] = errors.clock_steps[..] else { panic!("{:?}", errors.clock_steps) };
        assert_eq!(half_way, ClockStep { station: 2, at_s: 210.0, by_s: 0.020 });
        assert_eq!(given, ClockStep { station: 0, at_s: 17.5, by_s: -0.005 });
        close(&[errors.rig_constant_m], &[-0.010]);
        let mut drawn = Preset::Warthog.scenario();
        draw_facets([0.001, 0.0005, 0.002], &mut drawn, &mut ErrorKind::Facets.rng(1));
        assert_eq!(errors.facets, drawn.errors.facets);
        let centring = errors.centring.expect("given");
        close(&[centring.marker_m, centring.turned_m], &[0.001, 0.0003]);
        let [first, second] = errors.set_up_changes[..] else { panic!("two are given") };
        assert_eq!((first.station, second.station), (1, 0));
        close(&[first.turn_rad], &[-0.0015]);
        close(first.move_m.as_slice(), &[0.003, 0.0, -0.002]);
        close(&second.lean_rad, &[degree, 0.0]);
    }

    #[test]
    fn pauses_and_a_round_earth() {
        let scenario = scenario_of("--pause 10,20 --pause 30,31.5 --curvature").expect("fine");
        assert_eq!(scenario.pauses_s, [[10.0, 20.0], [30.0, 31.5]]);
        assert_eq!(scenario.errors.curvature, Some(Curvature::STANDARD));
    }

    #[test]
    fn an_option_overrules_what_is_drawn_and_leaves_the_rest() {
        let drawn = Preset::Warthog.scenario().with_field_errors(1);
        let given = scenario_of("--field-errors --latency 0,0,9 --settle 2,0,0,0.2,0,0,0");
        let mut expected = drawn.clone();
        expected.errors.latency_s = [0.0, 0.0, 9.0 * MILLI].into();
        let given = given.expect("fine");
        assert_eq!(given.errors.settling.len(), 1);
        expected.errors.settling.clone_from(&given.errors.settling);
        assert_eq!(given, expected);
        assert_ne!(drawn.errors.latency_s, expected.errors.latency_s);
    }

    #[test]
    fn what_no_instrument_does_is_refused_in_a_line() {
        for (words, line) in [
            ("--latency 1,2", "--latency has 2 numbers; give 3, separated by commas"),
            ("--latency 0,0,2000", "--latency is 2000; it must be from -1000 to 1000"),
            ("--stamp-jitter -1", "--stamp-jitter is -1; it must be from 0 to 1000"),
            ("--index 0,NaN,0", "--index is NaN; it must be from -3600 to 3600"),
            ("--range-wander 1,0", "--range-wander is 0; it must be from 0.001 to 100000"),
            ("--curvature=9", "--curvature is 9; it must be from -5 to 5"),
            ("--clock-step 4,20", "--clock-step names station 4; stations are 1, 2, 3"),
            ("--clock-step 3", "--clock-step has 1 numbers; give 2 or 3, separated by commas"),
            ("--clock-step 3,20,421", "--clock-step is 421; it must be from 0 to 420"),
            ("--settle 0,0,0,0,0,0,0", "--settle names station 0; stations are 1, 2, 3"),
            ("--settle 1,0,0,0", "--settle has 4 numbers; give 7 or 9, separated by commas"),
            ("--settle 1,0,0,101,0,0,0", "--settle is 101; it must be from -100 to 100"),
            ("--facets 1,2", "--facets has 2 numbers; give 3, separated by commas"),
            ("--centring 1,-1", "--centring is -1; it must be from 0 to 1000"),
            ("--set-up-change 4,0,0,0,0", "--set-up-change names station 4; stations are 1, 2, 3"),
            ("--pause 20,10", "--pause is from 20 to 10 s; give the earlier time first"),
        ] {
            assert_eq!(complaint(words), line);
        }
    }
}
