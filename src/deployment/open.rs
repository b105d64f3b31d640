//! From a path to a deployment: what is in a folder, which file plays which part, and what is missing.

mod bags;
mod cartesian;
mod collection;
mod control_points;
mod dated;
mod found;
mod gnss;
mod rig;
mod surveys;
mod tables;

use std::path::Path;

pub use self::collection::holds_many;
use self::control_points::read_control_point_sets;
use self::found::Found;
pub use self::found::{FOLDER_DEPTH, FoundFile, find, in_memory, list_folder};
use self::gnss::read_gnss;
use self::rig::read_rig;
use self::surveys::Surveys;
use super::format::{self, Format, OpenError, Question};
use super::{
    AzimuthSense, ColumnMapping, Deployment, Finding, Measurement, OneOrMany, Overrides, Recording,
    Track, TrackFrame, station_clocks,
};
use crate::progress::Progress;

/// Stamps of one station this close are the same reading (s): text files round them to microseconds.
const SAME_STAMP_S: f64 = 2e-6;

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
    let in_folder = match files.iter().find(is_overrides) {
        Some(file) => format::deployment_toml::read(&file.file, &file.uncounted_text()?)?,
        None => Overrides::default(),
    };
    let overrides = found.put_right.clone().over(in_folder.clone());
    overrides.check().map_err(|(what, remedy)| OpenError::file(&found.name, what, remedy))?;
    let name = overrides.name.clone().unwrap_or_else(|| found.name.clone());
    let mut findings = Vec::new();
    let mut used: Vec<&str> = Vec::new();
    used.extend(files.iter().filter(is_overrides).map(|f| f.file.as_str()));

    // What the user answered goes before the file that was asked for, and that before what the folder says.
    let answered = found.put_right.tracks.as_ref().map(OneOrMany::as_slice);
    let named = overrides.tracks.as_ref().map(OneOrMany::as_slice);
    let chosen = answered.or(found.chosen.as_ref().map(std::slice::from_ref)).or(named);
    let columns = overrides.columns.as_ref();
    let track_files = choose_tracks(&name, chosen, columns, files, progress)?;
    findings.extend(bags::finding(&track_files, files));
    let stations = tables::stations(&name, &track_files, columns, files, chosen.is_some())?;
    let beside = files.iter().filter(|f| f.is_read_beside_tracks()).map(|f| f.bytes);
    progress.expect(track_files.iter().map(|f| f.bytes).sum::<u64>() + beside.sum::<u64>());
    used.extend(track_files.iter().map(|f| f.file.as_str()));
    let counter_clockwise = overrides.azimuth == Some(AzimuthSense::CounterClockwise);
    let mut recording = Recording::new(overrides.stations, counter_clockwise);
    let mut track_frame = TrackFrame::Own;
    if track_files.iter().all(|f| f.format == Format::CartesianTrack) {
        let (frame, undone) = cartesian::read(&track_files, files, progress, &mut recording)?;
        track_frame = frame;
        used.extend(undone);
    } else {
        read_tracks(&track_files, &stations, &overrides, progress, &mut recording)?;
    }
    let time_corrections = std::mem::take(&mut recording.time_corrections);
    let include_constant =
        overrides.ranges_include_prism_constant.unwrap_or(recording.ranges_include_prism_constant);
    let track_names = track_files.iter().map(|f| f.file.as_str()).collect::<Vec<_>>().join(", ");
    findings.extend(recording.check_sense(&track_names)?);
    let (mut tracks, track_findings) = recording.finish(&track_names);
    findings.extend(track_findings);
    findings.extend(station_clocks::findings(&tracks, &time_corrections));
    if tracks.iter().all(|track| track.measurements.is_empty()) {
        return Err(OpenError::file(
            &track_names,
            "no usable measurement of any station",
            "stations are numbered 1, 2, 3 and a valid reading has status 0",
        ));
    }
    let prism_constants_m = overrides.prism_constant_m.unwrap_or_default().each_m();
    for (track, constant_m) in tracks.iter_mut().zip(prism_constants_m) {
        track.prism_constant_m = if include_constant { 0.0 } else { constant_m };
    }
    findings.extend(dated::contradicts_folder(&found.name, &tracks));
    leave_out(&mut tracks, &overrides, &mut findings);

    let mut reading = Reading {
        files,
        overrides: &overrides,
        put_right: &found.put_right,
        distances_of_files_m: None,
        progress,
        used: &mut used,
        findings: &mut findings,
    };
    let surveys = Surveys::read(&mut reading)?;
    let control_points = read_control_point_sets(&mut reading, &prism_constants_m, &surveys)?;
    let rig = read_rig(&mut reading, &prism_constants_m, &surveys)?;
    let gnss = read_gnss(&mut reading)?;
    let mut as_read = in_folder;
    as_read.inter_prism_m = as_read.inter_prism_m.or(reading.distances_of_files_m);
    let constant_from = match (found.put_right.prism_constant_m, overrides.prism_constant_m) {
        (Some(_), _) => "the user",
        (None, Some(_)) => "deployment.toml",
        (None, None) => "the MT1000",
    };
    let constants = match prism_constants_m {
        [a, b, c] if a == b && a == c => format!("{:+.1} mm", a * 1e3),
        each => each.map(|own| format!("{:+.1}", own * 1e3)).join(", ") + " mm (stations 1, 2, 3)",
    };
    findings.push(Finding::note(if include_constant {
        format!(
            "prism constant of {constant_from}, {constants}, added to ranges of control points and rig; those of the \
             tracks contain it"
        )
    } else {
        format!("prism constant of {constant_from}, {constants}, added to every range")
    }));

    let ingredients = files
        .iter()
        .map(|f| Ingredient {
            file: f.file.clone(),
            what: f.format.describe(),
            used: used.contains(&f.file.as_str()),
        })
        .collect();
    Ok(Deployment {
        name,
        tracks,
        track_frame,
        control_points,
        rig,
        prisms: overrides.prisms,
        gnss,
        time_corrections,
        overrides,
        as_read,
        ingredients,
        findings,
    })
}

/// What the readers of everything beside the tracks share.
struct Reading<'a, 'b> {
    files: &'a [FoundFile],
    overrides: &'a Overrides,
    /// Those of them that the user says, over what the folder says.
    put_right: &'a Overrides,
    /// The inter-prism distances by the rig's files (m), once they are read.
    distances_of_files_m: Option<[f64; 3]>,
    progress: &'a Progress,
    /// Names of the files that were read.
    used: &'b mut Vec<&'a str>,
    findings: &'b mut Vec<Finding>,
}

/// Marks the readings that the user leaves out: those outside of the span, and the masked ones.
fn leave_out(tracks: &mut [Track; 3], overrides: &Overrides, findings: &mut Vec<Finding>) {
    if let Some([from_s, to_s]) = overrides.span_s {
        for track in tracks.iter_mut() {
            let used = |m: &Measurement| (from_s..=to_s).contains(&m.time_s);
            track.left_out = track.measurements.iter().map(|m| !used(m)).collect();
        }
        findings.push(Finding::note(format!(
            "only the {:.1} s from {from_s:.3} to {to_s:.3} s are used",
            to_s - from_s
        )));
    }
    let masked = overrides.masked.as_deref().unwrap_or_default();
    let mut missing = 0;
    for mask in masked {
        let track = &mut tracks[usize::from(mask.station) - 1];
        let same = |m: &Measurement| (m.time_s - mask.time_s).abs() < SAME_STAMP_S;
        let near = track.measurements.partition_point(|m| m.time_s < mask.time_s - SAME_STAMP_S);
        if track.measurements.get(near).is_some_and(same) {
            track.left_out.resize(track.measurements.len(), false);
            track.left_out[near] = true;
        } else {
            missing += 1;
        }
    }
    if !masked.is_empty() {
        let left_out = masked.len() - missing;
        findings.push(Finding::note(format!("{left_out} readings are left out by hand")));
    }
    if missing > 0 {
        findings.push(Finding::warning(format!(
            "{missing} of the masked readings are not in the tracks; they were masked in other data"
        )));
    }
}

/// The files of tracks. Two representations in one folder are a question to the user.
fn choose_tracks<'a>(
    name: &str,
    chosen: Option<&[String]>,
    columns: Option<&ColumnMapping>,
    files: &'a [FoundFile],
    progress: &Progress,
) -> Result<Vec<&'a FoundFile>, OpenError> {
    // What may be a track is none unless it is asked for, or there is nothing else.
    let is_asked_for = |f: &FoundFile| chosen.is_some() && f.format.may_be_track();
    let candidates: Vec<_> =
        files.iter().filter(|f| f.format.is_track() || is_asked_for(f)).collect();
    let names = || candidates.iter().map(|f| f.file.clone()).collect::<Vec<_>>();
    if let Some(positions) = cartesian::choose(name, chosen, &candidates)? {
        return Ok(positions);
    }
    if let Some(chosen) = chosen {
        let find = |chosen: &String| {
            candidates.iter().find(|f| f.file == *chosen).copied().ok_or_else(|| {
                OpenError::file(
                    name,
                    format!("`{chosen}` is no file with tracks (hidden files are not looked at)"),
                    format!("the candidates here: {}", names().join(", ")),
                )
            })
        };
        return chosen.iter().map(find).collect();
    }
    match candidates[..] {
        [only] => Ok(vec![only]),
        [] if let Some(unknown) = tables::unknown(columns, files)? => Ok(unknown),
        [] => {
            let mut seen: Vec<_> =
                files.iter().map(|f| format!("{} ({})", f.file, f.format.describe())).collect();
            seen.truncate(4);
            let seen = if seen.is_empty() { "no file".to_owned() } else { seen.join(", ") };
            Err(OpenError::file(
                name,
                format!("no tracks of the stations among: {seen}"),
                "open a folder with a polar CSV (timestamp,id,distance,ha,va) or a bag of ROS 1 or ROS 2",
            ))
        }
        _ if let Some(pieces) = bags::of_one_drive(&candidates, progress)? => Ok(pieces),
        _ if candidates.iter().all(|f| tables::is_one_stations(f, columns)) => Ok(candidates),
        _ => Err(Question::Tracks { folder: name.to_owned(), files: names() }.into()),
    }
}

/// Reads the chosen files one after the other; bags among them are one recording.
fn read_tracks(
    files: &[&FoundFile],
    stations: &[Option<i64>],
    overrides: &Overrides,
    progress: &Progress,
    into: &mut Recording,
) -> Result<(), OpenError> {
    let pieces: Vec<_> = files.iter().filter_map(|file| bags::piece(file)).collect();
    if !pieces.is_empty() {
        format::bag::read(&pieces, overrides.topics.as_ref(), progress, into)?;
    }
    for (file, station) in files.iter().zip(stations).filter(|(file, _)| !file.format.is_bag()) {
        tables::read(file, *station, overrides.columns.as_ref(), progress, into)?;
    }
    Ok(())
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
