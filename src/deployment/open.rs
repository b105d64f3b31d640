//! From a path to a deployment: what is in a folder, which file plays which part, and what is missing.

mod control_points;
mod found;
mod gnss;
mod rig;

use std::path::Path;

use self::control_points::read_control_point_sets;
use self::found::{Content, Found};
pub use self::found::{FOLDER_DEPTH, FoundFile, find, in_memory, list_folder};
use self::gnss::read_gnss;
use self::rig::read_rig;
use super::format::{self, Format, OpenError, deployment_toml::Overrides};
use super::{Deployment, Finding, RawRecord, assemble_tracks};
use crate::progress::Progress;

/// What the MT1000 prism adds to a range (m), unless `deployment.toml` says otherwise.
const PRISM_CONSTANT_M: f64 = 0.010;

/// A file that was looked at, and what became of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ingredient {
    /// Relative to the folder.
    pub file: String,
    /// What it holds, or why it was passed over.
    pub what: &'static str,
    pub used: bool,
}

/// Opens a folder by looking at what is in it, or a file of tracks with the rest of its folder.
pub fn open(path: &Path) -> Result<Deployment, OpenError> {
    combine(&find(path, &Progress::default())?, &Progress::default())
}

/// Opens files that are already in memory, as the built-in samples are.
pub fn open_files(name: &str, files: &[(&str, &str)]) -> Result<Deployment, OpenError> {
    combine(&in_memory(name, files), &Progress::default())
}

/// Gives every file its part, reads those that have one, and says what was passed over.
///
/// `progress` counts the bytes of the files that are read.
pub fn combine(found: &Found, progress: &Progress) -> Result<Deployment, OpenError> {
    let files = &found.files;
    // Only the folder's own: one further down belongs to another deployment.
    let is_overrides =
        |f: &&FoundFile| f.format == Format::DeploymentToml && f.file == "deployment.toml";
    let overrides = match files.iter().find(is_overrides) {
        Some(file) => format::deployment_toml::read(&file.file, &file.uncounted_text()?)?,
        None => Overrides::default(),
    };
    let prism_constant_m = overrides.prism_constant_m.unwrap_or(PRISM_CONSTANT_M);
    if !(-1.0..=1.0).contains(&prism_constant_m) {
        return Err(OpenError::file(
            "deployment.toml",
            format!("prism_constant_m is {prism_constant_m}"),
            "prism constants are a few hundredths of a metre",
        ));
    }
    let prisms = overrides.prisms;
    if prisms.is_some_and(|prisms| prisms != 1 && prisms != 3) {
        return Err(OpenError::file(
            "deployment.toml",
            "prisms must be 1 (all stations follow one) or 3",
            "leave it out to have it recognised",
        ));
    }
    let name = overrides.name.clone().unwrap_or_else(|| found.name.clone());
    let mut findings = Vec::new();
    let mut used: Vec<&str> = Vec::new();
    used.extend(files.iter().filter(is_overrides).map(|f| f.file.as_str()));

    let chosen = found.chosen.as_deref().or(overrides.tracks.as_deref());
    let track_file = choose_tracks(&name, chosen, files)?;
    let beside = files.iter().filter(|f| f.is_read_beside_tracks()).map(|f| f.bytes);
    progress.expect(track_file.bytes + beside.sum::<u64>());
    used.push(&track_file.file);
    let (records, place_word) = read_records(track_file, progress)?;
    let (tracks, track_findings) =
        assemble_tracks(&records, prism_constant_m, &track_file.file, place_word);
    findings.extend(track_findings);
    if tracks.iter().all(|track| track.measurements.is_empty()) {
        return Err(OpenError::file(
            &track_file.file,
            "no usable measurement of any station",
            "stations are numbered 1, 2, 3 and a valid reading has status 0",
        ));
    }

    let mut reading = Reading {
        files,
        overrides: &overrides,
        progress,
        used: &mut used,
        findings: &mut findings,
    };
    let control_points = read_control_point_sets(&mut reading, prism_constant_m)?;
    let rig = read_rig(&mut reading, prism_constant_m)?;
    let gnss = read_gnss(&mut reading)?;
    let constant_from =
        if overrides.prism_constant_m.is_some() { "deployment.toml" } else { "the MT1000" };
    findings.push(Finding::note(format!(
        "prism constant of {constant_from}, {:+.1} mm, added to every range",
        prism_constant_m * 1e3
    )));

    let ingredients = files
        .iter()
        .map(|f| Ingredient {
            file: f.file.clone(),
            what: f.format.describe(),
            used: used.contains(&f.file.as_str()),
        })
        .collect();
    Ok(Deployment { name, tracks, control_points, rig, prisms, gnss, ingredients, findings })
}

/// What the readers of everything beside the tracks share.
struct Reading<'a, 'b> {
    files: &'a [FoundFile],
    overrides: &'a Overrides,
    progress: &'a Progress,
    /// Names of the files that were read.
    used: &'b mut Vec<&'a str>,
    findings: &'b mut Vec<Finding>,
}

/// The one file of tracks. Two representations in one folder are a question to the user.
fn choose_tracks<'a>(
    name: &str,
    chosen: Option<&str>,
    files: &'a [FoundFile],
) -> Result<&'a FoundFile, OpenError> {
    let candidates: Vec<_> = files.iter().filter(|f| f.format.is_track()).collect();
    let names = || candidates.iter().map(|f| f.file.as_str()).collect::<Vec<_>>().join(", ");
    if let Some(chosen) = chosen {
        return candidates.iter().find(|f| f.file == chosen).copied().ok_or_else(|| {
            OpenError::file(
                name,
                format!("`{chosen}` is no file with tracks (hidden files are not looked at)"),
                format!("the candidates here: {}", names()),
            )
        });
    }
    match candidates[..] {
        [only] => Ok(only),
        [] => {
            let mut seen: Vec<_> =
                files.iter().map(|f| format!("{} ({})", f.file, f.format.describe())).collect();
            seen.truncate(4);
            let seen = if seen.is_empty() { "no file".to_owned() } else { seen.join(", ") };
            Err(OpenError::file(
                name,
                format!("no tracks of the stations among: {seen}"),
                "open a folder with a polar CSV (timestamp,id,distance,ha,va) or a ROS 1 bag",
            ))
        }
        _ => Err(OpenError::file(
            name,
            format!("several files hold tracks: {}", names()),
            "open one of these files, or name it in deployment.toml: tracks = \"…\"",
        )),
    }
}

fn read_records(
    file: &FoundFile,
    progress: &Progress,
) -> Result<(Vec<RawRecord>, &'static str), OpenError> {
    match (&file.content, file.format) {
        (Content::Disk(path), Format::Ros1Bag) => {
            Ok((format::ros1_bag::read(path, &file.file, progress)?, "message"))
        }
        _ => {
            let text = file.uncounted_text()?;
            Ok((format::polar_csv::read(&file.file, &text, progress)?, "line"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRACKS: &str =
        "timestamp,id,distance,ha,va\n0.0,1,10,0.1,1.5\n0.1,2,11,0.1,1.5\n0.2,3,12,0.1,1.5\n";

    #[test]
    fn two_representations_are_a_question() {
        let error =
            open_files("d", &[("a.csv", TRACKS), ("b.csv", TRACKS)]).expect_err("ambiguous");
        assert!(error.to_string().contains("several files hold tracks: a.csv, b.csv"), "{error}");
        let toml = "tracks = \"b.csv\"\nprism_constant_m = 0.0\ninter_prism_m = [0.7, 0.9, 1.0]\n";
        let files = [("a.csv", TRACKS), ("b.csv", TRACKS), ("deployment.toml", toml)];
        let deployment = open_files("d", &files).expect("the override decides");
        assert_eq!(deployment.tracks[0].prism_constant_m, 0.0);
        assert_eq!(deployment.rig.expect("given").inter_prism_m, [0.7, 0.9, 1.0]);
        let unused: Vec<_> = deployment.ingredients.iter().filter(|i| !i.used).collect();
        assert_eq!(unused.len(), 1);
        assert_eq!(unused[0].file, "a.csv");
    }

    #[test]
    fn errors_name_file_line_and_remedy() {
        let cases: [(&str, &str); 5] = [
            (
                "timestamp;id;distance;ha;va\n0;1;2;3;4\n",
                "a.csv:1: the columns are separated by semicolons",
            ),
            (
                "timestamp,id,distance,ha,va\n0.0,1,10,x,1.5\n",
                "a.csv:2: `x` in column `ha` is not a number",
            ),
            ("timestamp,id,distance,ha,va\n0.0,1,10\n", "a.csv:2: 3 fields where the header has 5"),
            ("timestamp,id,distance,ha,va\n", "a.csv: has a header but no measurement"),
            ("", "no tracks of the stations"),
        ];
        for (text, expected) in cases {
            let error = open_files("d", &[("a.csv", text)]).expect_err(expected).to_string();
            assert!(error.contains(expected), "expected `{expected}`, got `{error}`");
            assert!(error.contains("; "), "no remedy in `{error}`");
        }
    }

    #[test]
    fn an_impossible_rig_is_refused() {
        let error = open_files("d", &[("a.csv", TRACKS), ("rig.txt", "0.1 0.2 1.0")])
            .expect_err("triangle");
        assert!(error.to_string().contains("not the sides of a triangle"), "{error}");
    }

    #[test]
    fn a_typo_in_the_overrides_is_refused() {
        let files =
            [("a.csv", TRACKS), ("deployment.toml", "name = \"x\"\nprism_constant = 0.0\n")];
        let error = open_files("d", &files).expect_err("unknown key").to_string();
        assert!(error.starts_with("deployment.toml:2: unknown field"), "{error}");
    }
}
