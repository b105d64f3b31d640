//! Combines the files of a folder into a deployment, and reports missing files.

use crate::findings::tracks::file_unreadable;
use std::path::Path;

use resect_core::deployment::printable::printable;
use resect_core::deployment::{Deployment, Finding, FollowedPrisms, Ingredient, Overrides};
use resect_core::progress::Progress;

use super::control_points::read_control_point_sets;
use super::found::{Found, FoundFile, find, in_memory};
use super::gnss::read_gnss;
use super::reading::Reading;
use super::rig::read_rig;
use super::stations::complete_stations;
use super::surveys::Surveys;
use super::tracks;
use crate::error::OpenError;
use crate::format::{self, Format};

/// Opens a folder by the content of its files, or a file of tracks with the rest of its folder.
pub fn open(path: &Path) -> Result<Deployment, OpenError> {
    combine(&find(path, &Progress::default())?, &Progress::default())
}

/// Opens files in memory, such as those of the built-in samples.
pub fn open_files(name: &str, files: &[(&str, &str)]) -> Result<Deployment, OpenError> {
    combine(&in_memory(name, files), &Progress::default())
}

/// Combines the files into a deployment, and reports those that are not used.
///
/// `progress` counts the bytes of the files that are read.
pub fn combine(found: &Found, progress: &Progress) -> Result<Deployment, OpenError> {
    put_together(found, progress, |name, overrides| tracks::read(name, found, overrides, progress))
}

/// Combines everything but tracks, for readings from another source.
pub fn combine_without_tracks(found: &Found, progress: &Progress) -> Result<Deployment, OpenError> {
    put_together(found, progress, |_, overrides| Ok(tracks::TracksRead::none(overrides)))
}

/// `read_tracks` receives the deployment's name and its overrides.
fn put_together<'a>(
    found: &'a Found,
    progress: &Progress,
    read_tracks: impl FnOnce(&str, &Overrides) -> Result<tracks::TracksRead<'a>, OpenError>,
) -> Result<Deployment, OpenError> {
    let files = &found.files;
    // Only the file in the folder itself: one in a subfolder belongs to another deployment.
    let is_overrides =
        |f: &&FoundFile| f.format == Format::DeploymentToml && f.file == "deployment.toml";
    let in_folder = match files.iter().find(is_overrides) {
        Some(file) => format::deployment_toml::read(&file.file, &file.uncounted_text()?)?,
        None => Overrides::default(),
    };
    let overrides = found.corrections.clone().over(in_folder.clone());
    overrides.check().map_err(|(what, remedy)| OpenError::file(&found.name, what, remedy))?;
    let name = printable(overrides.name.as_ref().unwrap_or(&found.name));
    let unreadable = files.iter().filter(|f| f.format == Format::Unreadable);
    let mut findings: Vec<Finding> = unreadable.map(|f| file_unreadable(&f.file)).collect();
    let mut used: Vec<&str> = Vec::new();
    used.extend(files.iter().filter(is_overrides).map(|f| f.file.as_str()));

    let read = read_tracks(&name, &overrides)?;
    let track_files = read.files.join(", ");
    used.extend(read.files);
    findings.extend(read.findings);
    let prism_constants_m = read.prism_constants_m;

    let mut reading = Reading {
        files,
        overrides: &overrides,
        corrections: &found.corrections,
        distances_of_files_m: None,
        progress,
        used: &mut used,
        findings: &mut findings,
    };
    let surveys = Surveys::read(&mut reading)?;
    let control_points = read_control_point_sets(&mut reading, &prism_constants_m, &surveys)?;
    let rig = read_rig(&mut reading, &surveys)?;
    let gnss = read_gnss(&mut reading)?;
    let mut as_read = in_folder;
    as_read.inter_prism_m = as_read.inter_prism_m.or(reading.distances_of_files_m);
    findings.extend(read.about_prism_constant);

    let ingredients = files
        .iter()
        .map(|f| Ingredient {
            file: printable(&f.file),
            path: None,
            what: f.format.describe(),
            used: used.contains(&f.file.as_str()),
        })
        .collect();
    let mut deployment = Deployment {
        name,
        tracks: read.tracks,
        track_frame: read.frame,
        control_points,
        rig,
        prisms: overrides.prisms.as_ref().map(FollowedPrisms::count),
        gnss,
        time_corrections: read.time_corrections,
        overrides,
        as_read,
        ingredients,
        findings,
        ground_truth: None,
        restarts_s: Vec::new(),
    };
    complete_stations(&mut deployment, &track_files)?;
    Ok(deployment)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::findings::kinds;

    const TRACKS: &str =
        "timestamp,id,distance,ha,va\n0.0,1,10,0.1,1.5\n0.1,2,11,0.1,1.5\n0.2,3,12,0.1,1.5\n";

    #[test]
    fn two_representations_are_a_question() {
        let others = TRACKS.replace("0.1,2,11", "0.1,2,12");
        let error =
            open_files("d", &[("a.csv", TRACKS), ("b.csv", &others)]).expect_err("ambiguous");
        assert!(
            error.to_string().contains("several files contain tracks: a.csv, b.csv"),
            "{error}"
        );
        let toml = "tracks = \"b.csv\"\nprism_constant_m = 0.0\ninter_prism_m = [0.7, 0.9, 1.0]\n";
        let files = [("a.csv", TRACKS), ("b.csv", TRACKS), ("deployment.toml", toml)];
        let deployment = open_files("d", &files).expect("the override decides");
        assert_eq!(deployment.tracks[0].prism_constant_m, 0.0);
        assert_eq!(deployment.rig.expect("given").inter_prism_m, [0.7, 0.9, 1.0].into());
        let unused: Vec<_> = deployment.ingredients.iter().filter(|i| !i.used).collect();
        assert_eq!(unused.len(), 1);
        assert_eq!(unused[0].file, "a.csv");
    }

    #[test]
    fn copies_are_read_once_and_told() {
        let rounded = TRACKS.replace("0.1,1.5", "0.1000001,1.5000000");
        let files = [("a (1).csv", TRACKS), ("a.csv", TRACKS), ("b.csv", &rounded)];
        let deployment = open_files("d", &files).expect("opens");
        assert_eq!(deployment.tracks.map(|track| track.measurements.len()), [1; 3].into());
        let told = deployment.findings.iter().find(|f| f.kind == kinds::COPIES_LEFT_OUT);
        let told = told.expect("told").message().to_string();
        assert_eq!(told, "a.csv is read; the same readings are in b.csv, a (1).csv");
    }

    #[test]
    fn errors_name_file_line_and_remedy() {
        let cases: [(&str, &str); 5] = [
            (
                "timestamp,id,distance,ha,va\n0.0,1,10,\u{1b}[2J,1.5\n",
                "a.csv:2: `\\u{1b}[2J` in column `ha` is not a number",
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
    fn a_name_is_one_line() {
        let toml = "name = \"two\\nlines\"\ninter_prism_m = [0.7, 0.9, 1.0]\n";
        let deployment =
            open_files("d", &[("a.csv", TRACKS), ("deployment.toml", toml)]).expect("opens");
        assert_eq!(deployment.name, "two\\nlines");
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
