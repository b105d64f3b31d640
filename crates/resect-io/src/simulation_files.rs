//! Files of a simulated deployment: those of a real one, and the ground truth.

use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::atomic;
use crate::atomic::WriteError;
use crate::error::OpenError;
use crate::format::{control_points, pillars, polar_csv, rig_files, rtklib_pos};
use crate::open::open_files;
use resect_core::deployment::{Deployment, pairwise_distances};
use resect_core::geometry::{LevelTransform, Polar};
use resect_core::network::{PerPair, PerStation, Station, USUAL_STATIONS};
use resect_tools::simulation::{Simulated, SystematicErrors};

/// Ground truth of a simulation. A folder that contains this file may be overwritten.
const TRUTH: &str = "truth.toml";

#[derive(Debug, thiserror::Error)]
pub enum FolderError {
    #[error(transparent)]
    Write(#[from] WriteError),
    #[error("{}: cannot be read: {error}; choose a folder with read permission", folder.display())]
    Read { folder: PathBuf, error: std::io::Error },
    #[error("{}: contains {what}; choose an empty folder", folder.display())]
    Taken { folder: PathBuf, what: String },
}

/// Writes the deployment into a folder, creating it if necessary. Only an earlier simulation is replaced.
pub fn write_folder(simulated: &Simulated, folder: &Path) -> Result<(), FolderError> {
    atomic::make_folder(folder)?;
    let mut files = files(simulated);
    spare_what_is_there(folder, &files)?;
    // The ground truth is placed first, so that a later run may overwrite the folder if this one is killed in between.
    files.sort_by_key(|(name, _)| name != TRUTH);
    let ready = files.iter().map(|(name, text)| atomic::ready(&folder.join(name), text));
    atomic::place_all(ready.collect::<Result<_, _>>()?)?;
    Ok(())
}

/// Refuses a folder with anything but an earlier simulation of the same files.
fn spare_what_is_there(folder: &Path, files: &[(String, String)]) -> Result<(), FolderError> {
    let cannot = |error| FolderError::Read { folder: folder.to_owned(), error };
    let taken = |what| Err(FolderError::Taken { folder: folder.to_owned(), what });
    let mut is_empty = true;
    for entry in std::fs::read_dir(folder).map_err(cannot)? {
        let path = entry.map_err(cannot)?.path();
        // The next run removes temporary files of one that was killed.
        let path = atomic::target_of_part(&path).unwrap_or(path);
        is_empty &= !path.exists();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        // A file left from another deployment would be read together with this one.
        if !files.iter().any(|(own, _)| *own == name) {
            return taken(format!("`{name}`, which is not part of this deployment"));
        }
    }
    match is_empty || folder.join(TRUTH).is_file() {
        true => Ok(()),
        false => taken(format!("files but no {TRUTH}, so they may not be simulated")),
    }
}

/// Returns name and text of every file.
pub fn files(simulated: &Simulated) -> Vec<(String, String)> {
    let prism_constant_m = simulated.scenario.prism_constant_m;
    let measured = written_distances_m(simulated);
    let mut files = vec![
        ("inter_prism.csv".to_owned(), polar_csv::write(&simulated.records)),
        ("deployment.toml".to_owned(), deployment_text(simulated, &measured)),
        (TRUTH.to_owned(), truth_text(simulated)),
    ];
    let inter_antenna_m =
        simulated.scenario.antennas_m.as_ref().map(|antennas_m| pairwise_distances(antennas_m));
    for (index, fixes) in simulated.antennas.iter().flatten().enumerate() {
        files.push((format!("gnss_{}.pos", index + 1), rtklib_pos::write(fixes)));
    }
    // A single prism has no rig.
    if simulated.scenario.prisms() > 1 {
        files.push((
            "calibration_raw.csv".to_owned(),
            rig_files::write_rig_reading(simulated.rig_reading.as_slice(), prism_constant_m),
        ));
    }
    if simulated.scenario.prisms() > 2 {
        files.push((
            "calibration_results.csv".to_owned(),
            rig_files::write_distances(&measured, inter_antenna_m.as_ref()),
        ));
    }
    for set in &simulated.control_points {
        files.push((set.file.clone(), control_points::write(set, prism_constant_m)));
        if set.pillars {
            files.push(("pillars.csv".to_owned(), pillars::write(set)));
        }
    }
    files
}

/// Returns the `deployment.toml`, which states the prisms of the stations unless their numbers are the usual ones.
fn deployment_text(simulated: &Simulated, inter_prism_m: &PerPair<f64>) -> String {
    let scenario = &simulated.scenario;
    let (name, prism_constant_m) = (scenario.name, scenario.prism_constant_m);
    let mut text = format!(
        "# Simulated by resect: preset {name}, seed {}.\nname = \"{name} (simulated)\"\nprism_constant_m = {prism_constant_m}\n",
        simulated.seed
    );
    let (stations, prisms) = (scenario.stations(), scenario.prisms_m.len());
    if (stations, prisms) == (USUAL_STATIONS, USUAL_STATIONS) {
        return text;
    }
    let of_stations: Vec<usize> =
        (0..stations).map(|station| scenario.prism_of(station) + 1).collect();
    text += &match prisms {
        1 => "prisms = 1\n".to_owned(),
        _ => format!("prisms = {of_stations:?}\n"),
    };
    if prisms == 2 {
        // A file of one distance is not recognised.
        text += &format!("inter_prism_m = [{:.6}]\n", inter_prism_m[0]);
    }
    text
}

/// Returns the inter-prism distances by the reading of the rig, with their errors (m).
fn written_distances_m(simulated: &Simulated) -> PerPair<f64> {
    let SystematicErrors { inter_prism_m, rig_constant_m, .. } = &simulated.scenario.errors;
    let prisms_m = simulated.rig_reading.map(|reading| {
        Polar { range_m: reading.range_m + rig_constant_m, ..*reading }.to_cartesian()
    });
    let measured_m = pairwise_distances(prisms_m.as_slice());
    measured_m.iter().zip(inter_prism_m).map(|(own_m, error_m)| own_m + error_m).collect()
}

#[derive(Serialize)]
struct TruthFile<'a> {
    preset: &'static str,
    seed: u64,
    outliers: usize,
    lost_readings: usize,
    inter_prism_m: &'a PerPair<f64>,
    /// Intervals without recording (s); left out if empty, like the errors.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    pauses_s: &'a [[f64; 2]],
    #[serde(skip_serializing_if = "Option::is_none")]
    errors: Option<&'a SystematicErrors>,
    transforms: Vec<TransformEntry>,
    /// Transforms at the survey of the control points; left out if they are those of the drive.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    survey_transforms: Vec<TransformEntry>,
}

#[derive(Serialize)]
struct TransformEntry {
    from: usize,
    to: usize,
    translation_m: [f64; 3],
    yaw_rad: f64,
}

fn truth_text(simulated: &Simulated) -> String {
    let truth = &simulated.truth;
    let errors = &simulated.scenario.errors;
    let file = TruthFile {
        preset: simulated.scenario.name,
        seed: simulated.seed,
        outliers: truth.outliers,
        lost_readings: truth.lost_readings,
        inter_prism_m: &truth.inter_prism_m,
        pauses_s: &simulated.scenario.pauses_s,
        errors: (*errors != SystematicErrors::default()).then_some(errors),
        transforms: transform_entries(&truth.station1_from_station),
        survey_transforms: if errors.set_up_changes.is_empty() {
            Vec::new()
        } else {
            transform_entries(&truth.station1_from_station_at_survey)
        },
    };
    toml::to_string(&file).expect("plain data")
}

fn transform_entries(station1_from_station: &PerStation<LevelTransform>) -> Vec<TransformEntry> {
    let entry = |(station, transform): (Station, &LevelTransform)| TransformEntry {
        from: station.number(),
        to: 1,
        translation_m: transform.translation_m.into(),
        yaw_rad: transform.yaw_rad,
    };
    station1_from_station.each().skip(1).map(entry).collect()
}

/// Opens the files of a simulated deployment from memory, with the same readers as from disk.
pub fn open(simulated: &Simulated) -> Result<Deployment, OpenError> {
    let files = files(simulated);
    let files: Vec<_> = files.iter().map(|(name, text)| (name.as_str(), text.as_str())).collect();
    open_files(simulated.scenario.name, &files)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;
    use resect_core::network::{Number, Pair};
    use resect_tools::simulation::{
        ChangedSetUp, ClockStep, ErrorKind, Preset, Scenario, draw, simulate_scenario,
    };

    /// Scenario of one minute without a prism constant.
    fn short() -> Scenario {
        Scenario { duration_s: 60.0, prism_constant_m: 0.0, ..Preset::Warthog.scenario() }
    }

    fn drive(errors: SystematicErrors) -> Simulated {
        let mut scenario = short();
        scenario.noise.range_sigma_m = 0.0;
        scenario.noise.angle_sigma_rad = 0.0;
        simulate_scenario(&Scenario { errors, ..scenario }, 5)
    }

    #[test]
    fn the_distances_that_are_written_are_wrong_and_the_rig_is_not() {
        let inter_prism_m = [0.003, -0.002, 0.001];
        let errors =
            SystematicErrors { inter_prism_m: inter_prism_m.into(), ..SystematicErrors::default() };
        let simulated = drive(errors);
        let rig_m =
            pairwise_distances(simulated.rig_reading.map(|own| own.to_cartesian()).as_slice());
        let files = files(&simulated);
        let (_, written) =
            files.iter().find(|(name, _)| name == "calibration_results.csv").expect("written");
        for pair in 0..3 {
            let truth_m = simulated.truth.inter_prism_m[pair];
            assert!((rig_m[pair] - truth_m).abs() < 1e-9, "{rig_m:?}");
            let wrong = format!("{:.6}", rig_m[pair] + inter_prism_m[pair]);
            assert!(written.contains(&wrong[..6]), "{wrong} is not in {written}");
        }
    }

    #[test]
    fn distances_without_the_prism_constant_are_computed_from_shorter_ranges() {
        let errors = SystematicErrors { rig_constant_m: -0.010, ..SystematicErrors::default() };
        let simulated = drive(errors);
        let written_m = written_distances_m(&simulated);
        let shorter = simulated.rig_reading.map(|p| p.to_cartesian() * (1.0 - 0.010 / p.range_m));
        for (written_m, expected_m) in written_m.iter().zip(pairwise_distances(shorter.as_slice()))
        {
            assert!((written_m - expected_m).abs() < 1e-12, "{written_m} {expected_m}");
        }
        let off_m = |pair: usize| (written_m[pair] - simulated.truth.inter_prism_m[pair]).abs();
        let largest_m = [0, 1, 2].map(off_m).into_iter().fold(0.0, f64::max);
        assert!((5e-4..5e-3).contains(&largest_m), "{largest_m}");
    }

    fn truth_of(simulated: &Simulated) -> toml::Table {
        let mut files = files(simulated).into_iter();
        let (_, text) = files.find(|(name, _)| name == "truth.toml").expect("written");
        text.parse().expect("TOML")
    }

    #[test]
    fn the_truth_of_the_survey_is_written_if_a_set_up_changed() {
        let unchanged = truth_of(&drive(SystematicErrors::default()));
        assert!(!unchanged.contains_key("survey_transforms"), "{unchanged}");
        let move_m = Vector3::new(0.5, 0.0, 0.0);
        let set_up_changes =
            vec![ChangedSetUp { station: 2, turn_rad: 0.0, move_m, lean_rad: [0.0; 2] }];
        let truth =
            truth_of(&drive(SystematicErrors { set_up_changes, ..SystematicErrors::default() }));
        let x_m = |key: &str| truth[key][1]["translation_m"][0].as_float().expect("a number");
        assert!((x_m("transforms") - x_m("survey_transforms") - 0.5).abs() < 1e-12, "{truth}");
        assert_eq!(truth["errors"]["set_up_changes"][0]["station"].as_integer(), Some(3));
    }

    #[test]
    fn errors_of_all_kinds_are_written() {
        let mut scenario = short();
        for kind in ErrorKind::ALL {
            draw(kind, &mut scenario, &mut kind.rng(1));
        }
        let truth = truth_of(&simulate_scenario(&scenario, 1));
        for key in ["facets", "centring", "set_up_changes", "inter_prism_m", "settling"] {
            assert!(truth["errors"].get(key).is_some(), "{key} is not in {truth}");
        }
    }

    #[test]
    fn any_number_of_stations_and_prisms_opens() {
        for preset in [Preset::Warthog, Preset::Hd2Tunnel, Preset::SinglePrism] {
            for (stations, prisms) in [(1, 1), (2, 1), (2, 2), (4, 3), (4, 4), (6, 6), (8, 8)] {
                let scenario = preset.scenario().with_network(stations, prisms);
                let simulated = simulate_scenario(&Scenario { duration_s: 60.0, ..scenario }, 1);
                let deployment = open(&simulated).expect("own files");
                assert_eq!(deployment.tracks.len(), stations, "{} {prisms}", preset.name());
                for (station, track) in deployment.tracks.each() {
                    let prism = track.prism.expect("stated").index();
                    assert_eq!(prism, station.index() % prisms);
                    assert!(track.measurements.len() > 50);
                }
                assert_eq!(deployment.prisms, Some(prisms as u8));
                let distances = deployment.rig.map_or(0, |rig| {
                    assert_eq!(rig.prisms_m.map(|prisms_m| prisms_m.len()), Some(prisms));
                    rig.inter_prism_m.len()
                });
                assert_eq!(distances, Pair::count(prisms));
                for point in deployment.control_points.iter().flat_map(|set| &set.points) {
                    assert_eq!(point.readings.iter().flatten().count(), stations);
                }
                let truth = truth_of(&simulated);
                assert_eq!(truth["transforms"].as_array().map(Vec::len), Some(stations - 1));
            }
        }
    }

    #[test]
    fn the_truth_lists_what_is_wrong_and_nothing_else() {
        let right = truth_of(&drive(SystematicErrors::default()));
        assert!(!right.contains_key("errors") && !right.contains_key("pauses_s"), "{right}");
        let errors = SystematicErrors {
            latency_s: [0.0, 0.010, 0.0].into(),
            clock_steps: vec![ClockStep { station: 0, at_s: 7.0, by_s: 0.02 }],
            ..SystematicErrors::default()
        };
        let pauses_s = vec![[10.0, 20.0]];
        let wrong = truth_of(&simulate_scenario(&Scenario { errors, pauses_s, ..short() }, 5));
        let expected =
            "latency_s = [0.0, 0.01, 0.0]\n[[clock_steps]]\nstation = 1\nat_s = 7.0\nby_s = 0.02\n";
        assert_eq!(wrong["errors"], toml::Value::Table(expected.parse().expect("TOML")));
        assert_eq!(wrong["pauses_s"], toml::Value::from(vec![vec![10.0, 20.0]]));
    }
}
