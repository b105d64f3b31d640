//! The tracks of a deployment: their files, their readings, and the readings that the user leaves out.

use super::copies::{self, SAME_STAMP_S};
use super::found::{Found, FoundFile};
use super::stations::listed_stations;
use super::{bags, dated, tables, track_checks};
use super::{cartesian, clock_jump};
use crate::error::{OpenError, Question};
use crate::findings::bags::copies_left_out;
use crate::findings::tracks::{
    masked_readings_missing, prism_constant_added, readings_masked, span_selected,
    stations_renumbered,
};
use crate::format;
use crate::format::Format;
use crate::format::mapped_csv;
use crate::recording::{Recording, station_index};
use resect_core::deployment::printable::printable;
use resect_core::deployment::{
    ColumnMapping, Finding, Measurement, OneOrMany, Overrides, TimeCorrection, Track, TrackFrame,
    station_clocks,
};
use resect_core::network::{MOST_STATIONS, PerStation, USUAL_STATIONS};
use resect_core::progress::Progress;

/// So many files are named in a message.
const NAMED_FILES: usize = 4;

/// Contents of the files with tracks.
pub struct TracksRead<'a> {
    pub tracks: PerStation<Track>,
    pub frame: TrackFrame,
    pub time_corrections: PerStation<Vec<TimeCorrection>>,
    /// Prism constants of the ranges of each station (m), even if those of the tracks contain them already.
    pub prism_constants_m: PerStation<f64>,
    /// Finding about added prism constants; `None` without ranges.
    pub about_prism_constant: Option<Finding>,
    /// Names of the files that were read.
    pub files: Vec<&'a str>,
    pub findings: Vec<Finding>,
}

/// Chooses the files with tracks, reads them, and marks the readings that the user leaves out.
pub fn read<'a>(
    name: &str,
    found: &'a Found,
    overrides: &Overrides,
    progress: &Progress,
) -> Result<TracksRead<'a>, OpenError> {
    let files = &found.files;
    let mut findings = Vec::new();
    // The user's answer takes precedence over the file that was opened, and that over deployment.toml.
    let answered = found.corrections.tracks.as_ref().map(OneOrMany::as_slice);
    let named = overrides.tracks.as_ref().map(OneOrMany::as_slice);
    let chosen = answered.or(found.chosen.as_ref().map(std::slice::from_ref)).or(named);
    let columns = overrides.columns.as_ref();
    let track_files = match choose_tracks(name, chosen, columns, files, progress)? {
        Choice::Files(chosen) => chosen,
        Choice::OneOf(mut candidates) => {
            let read = |file: &FoundFile| {
                let stations = tables::stations(name, &[file], columns, files, false)?;
                let mut recording =
                    Recording::new(overrides.stations.as_ref(), overrides.is_counter_clockwise());
                read_files(&[file], &stations, overrides, progress, &mut recording)?;
                Ok(recording.finish(&file.file)?.0)
            };
            progress.expect(candidates.iter().map(|f| f.bytes).sum());
            if !copies::are_copies(&candidates, read)? {
                let files = candidates.iter().map(|f| f.file.clone()).collect();
                return Err(Question::Tracks { folder: name.to_owned(), files }.into());
            }
            // Copies have the longer names: "tracks (1).csv", "drive.orig.bag".
            candidates.sort_by_key(|file| file.file.len());
            let (first, others) = candidates.split_at(1);
            findings.push(copies_left_out(&first[0].file, others.iter().map(|f| f.file.as_str())));
            first.to_vec()
        }
    };
    findings.extend(bags::finding(&track_files, files));
    let stations = tables::stations(name, &track_files, columns, files, chosen.is_some())?;
    let beside = files.iter().filter(|f| f.is_read_beside_tracks()).map(|f| f.bytes);
    progress.expect(track_files.iter().map(|f| f.bytes).sum::<u64>() + beside.sum::<u64>());
    let mut used: Vec<&str> = track_files.iter().map(|f| f.file.as_str()).collect();
    let new_recording = |numbers| Recording::new(numbers, overrides.is_counter_clockwise());
    let mut recording = new_recording(overrides.stations.as_ref());
    let mut frame = TrackFrame::Own;
    if track_files.iter().all(|f| f.format == Format::CartesianTrack) {
        let (theirs, undone) = cartesian::read(&track_files, files, progress, &mut recording)?;
        frame = theirs;
        used.extend(undone);
    } else {
        read_files(&track_files, &stations, overrides, progress, &mut recording)?;
        if let (None, Some(numbers)) = (&overrides.stations, recording.other_numbers()) {
            recording = new_recording(Some(&numbers));
            read_files(&track_files, &stations, overrides, &Progress::default(), &mut recording)?;
            recording.name_by_numbers(&numbers);
            recording.findings.push(stations_renumbered(&numbers));
        }
    }
    let track_names = track_files.iter().map(|f| f.file.as_str()).collect::<Vec<_>>().join(", ");
    let mut read = of_recording(recording, &track_names, &found.corrections, overrides)?;
    read.findings.splice(0..0, findings);
    read.findings.extend(dated::contradicts_folder(&found.name, &read.tracks));
    Ok(TracksRead { frame, files: used, ..read })
}

/// Returns the tracks of a recording, corrected by the overrides; `track_names` names their source.
pub fn of_recording<'a>(
    mut recording: Recording,
    track_names: &str,
    corrections: &Overrides,
    overrides: &Overrides,
) -> Result<TracksRead<'a>, OpenError> {
    recording.remove_absent_stations();
    if let Some(numbers) = &overrides.stations {
        recording.name_by_numbers(numbers);
    }
    let time_corrections = recording.take_time_corrections();
    let include_constant =
        overrides.ranges_include_prism_constant.unwrap_or(recording.ranges_include_prism_constant);
    let mut findings = recording.check_sense(track_names)?;
    let (mut tracks, track_findings) = recording.finish(track_names)?;
    findings.extend(track_findings);
    findings.extend(station_clocks::findings(&tracks, &time_corrections));
    if overrides.span_s.is_none() {
        findings.extend(clock_jump::keep_longest_part(&mut tracks));
    }
    let names = overrides.station_names.iter().flatten();
    for (track, name) in tracks.iter_mut().zip(names) {
        track.name = Some(printable(name));
    }
    let none = TracksRead::none(overrides);
    let constants_m = &none.prism_constants_m;
    for (track, constant_m) in tracks.iter_mut().zip(constants_m) {
        track.prism_constant_m = if include_constant { 0.0 } else { *constant_m };
    }
    if include_constant {
        findings.extend(track_checks::cartesian_origins(&tracks));
    }
    findings.extend(track_checks::clock_offsets(&tracks));
    leave_out(&mut tracks, overrides, &mut findings);
    findings.extend(track_checks::leave_out_repeated_ranges(&mut tracks));
    let constants_m = &constants_m.as_slice()[..tracks.len()];
    let about = about_prism_constant(constants_m, include_constant, corrections, overrides);
    Ok(TracksRead { tracks, time_corrections, findings, about_prism_constant: Some(about), ..none })
}

impl TracksRead<'_> {
    /// Returns tracks without readings.
    pub fn none(overrides: &Overrides) -> Self {
        let stations = listed_stations(overrides).unwrap_or(USUAL_STATIONS);
        Self {
            tracks: PerStation::repeat(stations, Track::default()),
            frame: TrackFrame::Own,
            time_corrections: PerStation::repeat(stations, Vec::new()),
            prism_constants_m: overrides
                .prism_constant_m
                .clone()
                .unwrap_or_default()
                .each_m(MOST_STATIONS),
            about_prism_constant: None,
            files: Vec::new(),
            findings: Vec::new(),
        }
    }
}

/// Returns the finding about added prism constants and their source.
fn about_prism_constant(
    constants_m: &[f64],
    included_in_tracks: bool,
    corrections: &Overrides,
    overrides: &Overrides,
) -> Finding {
    let from = match (&corrections.prism_constant_m, &overrides.prism_constant_m) {
        (Some(_), _) => "the user",
        (None, Some(_)) => "deployment.toml",
        (None, None) => "the MT1000",
    };
    prism_constant_added(constants_m, from, included_in_tracks)
}

/// Marks the readings that the user leaves out: those outside the span, and the masked ones.
fn leave_out(tracks: &mut PerStation<Track>, overrides: &Overrides, findings: &mut Vec<Finding>) {
    if let Some([from_s, to_s]) = overrides.span_s {
        for track in tracks.iter_mut() {
            let used = |m: &Measurement| (from_s..=to_s).contains(&m.time_s);
            track.left_out = track.measurements.iter().map(|m| !used(m)).collect();
        }
        findings.push(span_selected(from_s, to_s));
    }
    let masked = overrides.masked.as_deref().unwrap_or_default();
    let mut missing = 0;
    for mask in masked {
        let Some(track) = tracks.as_mut_slice().get_mut(usize::from(mask.station) - 1) else {
            missing += 1;
            continue;
        };
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
        findings.push(readings_masked(masked.len() - missing));
    }
    if missing > 0 {
        findings.push(masked_readings_missing(missing));
    }
}

/// Files with tracks in a folder.
enum Choice<'a> {
    /// All of them are read.
    Files(Vec<&'a FoundFile>),
    /// Representations of one drive, or different drives.
    OneOf(Vec<&'a FoundFile>),
}

/// Chooses the files with tracks.
fn choose_tracks<'a>(
    name: &str,
    chosen: Option<&[String]>,
    columns: Option<&ColumnMapping>,
    files: &'a [FoundFile],
    progress: &Progress,
) -> Result<Choice<'a>, OpenError> {
    // A file that may be a track is used only if it was named, or if there is no other.
    let is_asked_for = |f: &FoundFile| chosen.is_some() && f.format.may_be_track();
    let candidates: Vec<_> =
        files.iter().filter(|f| f.format.is_track() || is_asked_for(f)).collect();
    let names = || candidates.iter().map(|f| f.file.clone()).collect::<Vec<_>>();
    if let Some(positions) = cartesian::choose(name, chosen, &candidates)? {
        return Ok(Choice::Files(positions));
    }
    if let Some(chosen) = chosen {
        let find = |chosen: &String| {
            candidates.iter().find(|f| f.file == *chosen).copied().ok_or_else(|| {
                OpenError::file(
                    name,
                    format!("`{chosen}` is not a file with tracks (hidden files are ignored)"),
                    format!("candidates: {}", names().join(", ")),
                )
            })
        };
        return chosen.iter().map(find).collect::<Result<_, _>>().map(Choice::Files);
    }
    match candidates[..] {
        [only] => Ok(Choice::Files(vec![only])),
        [] if let Some(unknown) = tables::unknown(columns, files)? => Ok(Choice::Files(unknown)),
        [] if let Some(columns) = columns
            && let Some(table) = files.iter().find(|f| f.format == Format::UnknownTable) =>
        {
            let what = mapped_csv::misfit(&table.head()?, columns);
            Err(OpenError::line(&table.file, 1, what, "correct [columns] in deployment.toml"))
        }
        [] if let Some(metadata) = files.iter().find(|f| f.format == Format::RosbagMetadata) => {
            let what = "describes a bag whose files are missing here";
            Err(OpenError::file(&metadata.file, what, "copy its .db3 or .mcap files beside it"))
        }
        [] => Err(no_tracks(name, files)),
        _ if let Some(pieces) = bags::of_one_drive(&candidates, progress)? => {
            Ok(Choice::Files(pieces))
        }
        _ if candidates.iter().all(|f| tables::is_one_stations(f, columns)) => {
            Ok(Choice::Files(candidates))
        }
        _ => Ok(Choice::OneOf(candidates)),
    }
}

fn no_tracks(name: &str, files: &[FoundFile]) -> OpenError {
    // What is not read may be the missing tracks: an empty file, a pointer of Git LFS.
    let (unread, others): (Vec<_>, Vec<_>) =
        files.iter().partition(|f| matches!(f.format, Format::Ignored(_) | Format::Unreadable));
    let all = unread.iter().chain(&others);
    let mut seen: Vec<_> = all.map(|f| format!("{} ({})", f.file, f.format.describe())).collect();
    let more = seen.len().saturating_sub(NAMED_FILES);
    seen.truncate(NAMED_FILES);
    if more > 0 {
        seen.push(format!("and {more} more"));
    }
    let seen = if seen.is_empty() { "no file".to_owned() } else { seen.join(", ") };
    OpenError::file(
        name,
        format!("no tracks of the stations among: {seen}"),
        "open a folder with a polar CSV (timestamp,id,distance,ha,va) or a ROS 1 or ROS 2 bag",
    )
}

/// Reads the chosen files one after the other; all bags among them form one recording.
fn read_files(
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
    let last = stations.iter().flatten().filter_map(|number| station_index(*number)).max();
    into.expect_stations(last.map_or(0, |last| last + 1));
    for (file, station) in files.iter().zip(stations).filter(|(file, _)| !file.format.is_bag()) {
        if let Some(place) = station.and_then(station_index) {
            into.name_station(place, tables::stem(&file.file));
        }
        tables::read(file, *station, overrides.columns.as_ref(), progress, into)?;
    }
    Ok(())
}
