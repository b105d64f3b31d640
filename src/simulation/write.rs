//! A simulated deployment as files: what a real one has, and the truth beside it.

use std::path::Path;

use serde::Serialize;

use super::{Simulated, SystematicErrors};
use crate::deployment::format::{control_points, pillars, polar_csv, rig_files, rtklib_pos};
use crate::deployment::{OpenError, pairwise_distances};
use crate::geometry::Polar;

/// What was simulated, by which a folder is known that may be written to again.
const TRUTH: &str = "truth.toml";

/// Writes the deployment into a folder, which is made if it is not there. Nothing but an earlier simulation is replaced.
pub fn write_folder(simulated: &Simulated, folder: &Path) -> Result<(), OpenError> {
    let io = |path: &Path| {
        let path = path.to_owned();
        move |error| OpenError::Io { path, error }
    };
    std::fs::create_dir_all(folder).map_err(io(folder))?;
    let files = files(simulated);
    let entries: Result<Vec<_>, _> = std::fs::read_dir(folder).map_err(io(folder))?.collect();
    let entries = entries.map_err(io(folder))?;
    if !entries.is_empty() && !folder.join(TRUTH).is_file() {
        return Err(OpenError::file(
            &folder.display().to_string(),
            format!("holds files, and no {TRUTH} that says they are simulated"),
            "choose an empty folder",
        ));
    }
    // A leftover of another deployment would be read together with this one.
    for entry in entries {
        let name = entry.file_name().to_string_lossy().into_owned();
        if !files.iter().any(|(own, _)| *own == name) {
            return Err(OpenError::file(
                &folder.display().to_string(),
                format!("holds `{name}`, which is not part of this deployment"),
                "choose an empty folder",
            ));
        }
    }
    for (name, text) in files {
        let path = folder.join(name);
        std::fs::write(&path, text).map_err(io(&path))?;
    }
    Ok(())
}

/// Name and text of every file.
pub fn files(simulated: &Simulated) -> Vec<(String, String)> {
    let prism_constant_m = simulated.scenario.prism_constant_m;
    let measured = pairwise_distances(&simulated.rig_reading.map(Polar::to_cartesian));
    let wrong_by = simulated.scenario.errors.inter_prism_m;
    let measured: [f64; 3] = std::array::from_fn(|pair| measured[pair] + wrong_by[pair]);
    let mut files = vec![
        ("inter_prism.csv".to_owned(), polar_csv::write(&simulated.records)),
        (
            "deployment.toml".to_owned(),
            format!(
                "# Simulated by resect: preset {}, seed {}.\nname = \"{} (simulated)\"\nprism_constant_m = {prism_constant_m}\n",
                simulated.scenario.name, simulated.seed, simulated.scenario.name
            ),
        ),
        (TRUTH.to_owned(), truth_text(simulated)),
    ];
    let inter_antenna_m = simulated.scenario.antennas_m.as_ref().map(pairwise_distances);
    for (index, fixes) in simulated.antennas.iter().flatten().enumerate() {
        files.push((format!("gnss_{}.pos", index + 1), rtklib_pos::write(fixes)));
    }
    // A single prism has no rig.
    if simulated.truth.inter_prism_m.iter().all(|distance| *distance > 0.0) {
        files.push((
            "calibration_raw.csv".to_owned(),
            rig_files::write_rig_reading(&simulated.rig_reading, prism_constant_m),
        ));
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

#[derive(Serialize)]
struct TruthFile<'a> {
    preset: &'static str,
    seed: u64,
    outliers: usize,
    lost_readings: usize,
    inter_prism_m: [f64; 3],
    /// When nothing was recorded; left out, as the errors are, where there is nothing to say.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    pauses_s: &'a [[f64; 2]],
    #[serde(skip_serializing_if = "Option::is_none")]
    errors: Option<&'a SystematicErrors>,
    transforms: Vec<TransformEntry>,
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
    let transforms = (1..3)
        .map(|station| {
            let transform = &truth.station1_from_station[station];
            TransformEntry {
                from: station + 1,
                to: 1,
                translation_m: transform.translation_m.into(),
                yaw_rad: transform.yaw_rad,
            }
        })
        .collect();
    let file = TruthFile {
        preset: simulated.scenario.name,
        seed: simulated.seed,
        outliers: truth.outliers,
        lost_readings: truth.lost_readings,
        inter_prism_m: truth.inter_prism_m,
        pauses_s: &simulated.scenario.pauses_s,
        errors: (*errors != SystematicErrors::default()).then_some(errors),
        transforms,
    };
    toml::to_string(&file).expect("plain data")
}
