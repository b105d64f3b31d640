//! Tracks as positions, one file a station: selection of the files, and their frame.
//!
//! The authors of the paper publish their tracks transformed into one frame. If the transforms are in the folder and the data
//! confirms them, they are inverted, so that ranges and angles are the instruments' again. Confirmation: a total station rounds
//! ranges (to 0.01 mm while it tracks), and only ranges from its true origin are multiples of this step. This determines the origin
//! to about half a millimetre in the plane; height and rotation are taken from the same transform.

use crate::findings::positions::{
    track_transform_inverted, tracks_in_common_frame, tracks_in_station_frames,
    transform_tilts_station, transforms_not_confirmed, transforms_unreadable,
};
use nalgebra::Vector3;
use resect_core::geometry::ARCSECOND_RAD;
use resect_core::network::{MOST_STATIONS, PerStation, USUAL_STATIONS};

use super::found::FoundFile;
use super::station_in_name::station_in_name;
use super::tables::stem;
use crate::error::{OpenError, Question};
use crate::format::Format;
use crate::format::applied_transforms;
use crate::format::applied_transforms::AppliedTransforms;
use crate::format::cartesian_tracks;
use crate::format::cartesian_tracks::{Position, own_from_theirs};
use crate::recording::Recording;
use resect_core::deployment::{Finding, Measurement, RawRecord, TrackFrame};
use resect_core::geometry::{Polar, RigidTransform};
use resect_core::progress::Progress;
use resect_core::statistics::quantiles;

/// Largest distance between prisms of one vehicle (m).
const LARGEST_RIG_M: f64 = 5.0;
/// Largest interquartile range of a distance between prisms of one vehicle (m).
const STEADY_M: f64 = 0.1;
/// Fewest distances from which their interquartile range is computed.
const FEWEST_DISTANCES: usize = 10;
/// Longest gap to interpolate over, when two tracks are compared (s).
const LONGEST_GAP_S: f64 = 1.0;
/// Steps to which instruments round ranges (m).
const RANGE_STEPS_M: [f64; 3] = [1e-5, 1e-4, 1e-3];
/// Least movement between consecutive readings (m) for their difference of ranges to count.
const MOVED_M: f64 = 0.1;
/// Fewest values from which an agreement is computed.
const FEWEST_MOVED: usize = 50;
/// Least agreement with the steps that confirms an origin: 1 is perfect, chance gives 0.14 or less.
const SHOWN: f64 = 0.35;
/// An origin is confirmed only if origins displaced by this much in the plane (m) agree worse by the factor `WORSE_BY`.
const A_LITTLE_M: f64 = 0.001;
const WORSE_BY: f64 = 0.8;
/// Largest tilt that a compensator leaves (rad): 20″.
const COMPENSATOR_RAD: f64 = 20.0 * ARCSECOND_RAD;

/// Returns the files of the stations if the tracks are positions; `None` otherwise.
pub fn choose<'a>(
    name: &str,
    chosen: Option<&[String]>,
    candidates: &[&'a FoundFile],
) -> Result<Option<Vec<&'a FoundFile>>, OpenError> {
    let cartesian = || candidates.iter().copied().filter(|f| f.format == Format::CartesianTrack);
    if let Some(chosen) = chosen {
        let named: Vec<_> =
            chosen.iter().filter_map(|own| cartesian().find(|f| f.file == *own)).collect();
        return match named[..] {
            // In the order named.
            [_, _, ..] if named.len() == chosen.len() && named.len() <= MOST_STATIONS => {
                Ok(Some(named))
            }
            [one] if chosen.len() == 1 => set_of(one, &cartesian()).map(Some),
            [] => Ok(None),
            _ => Err(incomplete(&named[0].file)),
        };
    }
    let mut sets: Vec<Vec<&FoundFile>> = Vec::new();
    for first in cartesian().filter(|f| station_in_name(&f.file).is_some_and(|(_, n)| n == 1)) {
        sets.extend(set_of(first, &cartesian()).ok());
    }
    let others = candidates.iter().filter(|f| f.format != Format::CartesianTrack);
    match (&sets[..], cartesian().next()) {
        (_, None) => Ok(None),
        ([], Some(lone)) if others.clone().next().is_none() => Err(incomplete(&lone.file)),
        ([], Some(_)) => Ok(None),
        ([_], Some(_)) if others.clone().next().is_none() => Ok(sets.pop()),
        _ => {
            let files = sets.iter().map(|set| set[0]).chain(others.copied());
            let files = files.map(|f| f.file.clone()).collect();
            Err(Question::Tracks { folder: name.to_owned(), files }.into())
        }
    }
}

fn incomplete(file: &str) -> OpenError {
    OpenError::file(
        file,
        "positions of one station; those of the other two are missing",
        "put three such files into one folder, with 1, 2, 3 as the last number of their names, or list fewer in \
         deployment.toml: tracks = [\"…\", \"…\"]",
    )
}

/// Returns the files of stations 1, 2, 3, … in the same folder, with names that differ only in the last number. Fewer than the usual
/// number are incomplete unless the user names them.
fn set_of<'a>(
    one: &FoundFile,
    files: &(impl Iterator<Item = &'a FoundFile> + Clone),
) -> Result<Vec<&'a FoundFile>, OpenError> {
    let pattern = station_in_name(&one.file).map(|(pattern, _)| pattern);
    let of = |number: i64| {
        let named = |f: &&FoundFile| {
            station_in_name(&f.file).is_some_and(|(p, n)| n == number && Some(p) == pattern)
        };
        files.clone().find(named)
    };
    let set: Vec<_> = (1..=MOST_STATIONS as i64).map_while(of).collect();
    if set.len() < USUAL_STATIONS { Err(incomplete(&one.file)) } else { Ok(set) }
}

/// Reads the files of stations 1, 2, … as polar readings; returns their frame, and the file of transforms if one was inverted.
pub fn read<'a>(
    tracks: &[&FoundFile],
    files: &'a [FoundFile],
    progress: &Progress,
    into: &mut Recording,
) -> Result<(TrackFrame, Option<&'a str>), OpenError> {
    let mut positions = PerStation::default();
    for file in tracks {
        positions.push(cartesian_tracks::read(&file.file, &file.text(progress)?)?);
    }
    into.expect_stations(positions.len());
    into.ranges_include_prism_constant = true;
    let mut station_from_file = PerStation::repeat(positions.len(), RigidTransform::IDENTITY);
    let mut frame = TrackFrame::Own;
    let mut used = None;
    if in_one_frame(&positions) {
        match applied(&positions, files, &mut into.findings)? {
            Some((file, set)) => {
                station_from_file = set.common_from_station.map(RigidTransform::inverse);
                used = Some(file);
            }
            None => {
                frame = TrackFrame::Common;
                into.findings.push(tracks_in_common_frame());
            }
        }
    } else {
        into.findings.push(tracks_in_station_frames());
    }
    for (station, own) in positions.iter().enumerate() {
        into.begin_file(&tracks[station].file, "line");
        into.name_station(station, stem(&tracks[station].file));
        for position in own {
            let position_m = station_from_file[station].apply(&position.position_m);
            let polar = Polar::from_cartesian(own_from_theirs(&position_m));
            into.push(&RawRecord {
                station: station as i64 + 1,
                status: 0,
                place: position.line,
                measurement: Measurement {
                    time_s: position.time_s,
                    range_m: polar.range_m,
                    azimuth_rad: polar.azimuth_rad.rem_euclid(std::f64::consts::TAU),
                    zenith_rad: polar.zenith_rad,
                },
                own_clock_s: None,
            });
        }
    }
    Ok((frame, used))
}

/// Returns true if the distances between the prisms are constant and short without any transform.
fn in_one_frame(positions: &PerStation<Vec<Position>>) -> bool {
    let pairs = positions
        .iter()
        .enumerate()
        .flat_map(|(second, own)| positions.iter().take(second).map(move |first| (first, own)));
    let spreads: Vec<[f64; 2]> = pairs
        .map(|(first, second)| distances_m(first, second))
        .filter(|distances_m| distances_m.len() >= FEWEST_DISTANCES)
        .filter_map(|distances_m| quantiles(distances_m, [0.25, 0.5, 0.75]))
        .map(|[q25, median, q75]| [median, q75 - q25])
        .collect();
    !spreads.is_empty()
        && spreads.iter().all(|[median, iqr]| *median < LARGEST_RIG_M && *iqr < STEADY_M)
}

/// Returns the distances (m) at some hundred instants of the first track, with the second interpolated.
fn distances_m(a: &[Position], b: &[Position]) -> Vec<f64> {
    let mut b: Vec<&Position> = b.iter().collect();
    b.sort_by(|x, y| x.time_s.total_cmp(&y.time_s));
    let step = (a.len() / 500).max(1);
    let at = |p: &Position| {
        let after = b.partition_point(|q| q.time_s < p.time_s);
        let (before, after) = (b.get(after.checked_sub(1)?)?, b.get(after)?);
        let gap_s = after.time_s - before.time_s;
        let share = (p.time_s - before.time_s) / gap_s;
        let position_m = before.position_m.lerp(&after.position_m, share);
        let distance_m = (p.position_m - position_m).norm();
        (gap_s < LONGEST_GAP_S && distance_m.is_finite()).then_some(distance_m)
    };
    a.iter().step_by(step).filter_map(at).collect()
}

/// Returns the applied transforms with their file, if the readings confirm them.
fn applied<'a>(
    positions: &PerStation<Vec<Position>>,
    files: &'a [FoundFile],
    findings: &mut Vec<Finding>,
) -> Result<Option<(&'a str, AppliedTransforms)>, OpenError> {
    let mut best: Option<(f64, &str, AppliedTransforms)> = None;
    let mut looked_at = Vec::new();
    let mut count = 0;
    for file in files.iter().filter(|f| f.serves_as(Format::AppliedTransforms)) {
        looked_at.push(file.file.as_str());
        let sets =
            match applied_transforms::read(&file.file, &file.uncounted_text()?, positions.len()) {
                Ok(sets) => sets,
                // The tracks are usable without it.
                Err(error) => {
                    findings.push(transforms_unreadable(&file.file, &error.to_string()));
                    continue;
                }
            };
        for set in sets {
            count += 1;
            let agreement = agreement(positions, &set);
            if agreement > SHOWN && best.as_ref().is_none_or(|(known, ..)| agreement > *known) {
                best = Some((agreement, &file.file, set));
            }
        }
    }
    let Some((_, file, set)) = best else {
        if let Some(first) = looked_at.first() {
            findings.push(transforms_not_confirmed(first, looked_at.len(), count));
        }
        return Ok(None);
    };
    findings.push(track_transform_inverted(file, set.line));
    let level = set.common_from_station[0].rotate(&Vector3::z());
    for (index, transform) in set.common_from_station.iter().enumerate() {
        let tilt_rad = transform.rotate(&Vector3::z()).cross(&level).norm().asin();
        if tilt_rad > COMPENSATOR_RAD {
            findings.push(transform_tilts_station(file, index, tilt_rad));
        }
    }
    Ok(Some((file, set)))
}

/// Agreement of the ranges of all stations with an instrument's steps, after inverting a set of transforms. It is 0 if a slightly
/// displaced origin agrees about as well.
fn agreement(positions: &PerStation<Vec<Position>>, set: &AppliedTransforms) -> f64 {
    let of = |step_m: f64, in_steps: InSteps| {
        let each = positions.iter().zip(&set.common_from_station).map(|(own, applied)| {
            let origin_m = applied.translation_m;
            let here = in_steps(own, &origin_m, step_m);
            let around = [Vector3::x(), Vector3::y(), -Vector3::x(), -Vector3::y()]
                .map(|way| in_steps(own, &(origin_m + A_LITTLE_M * way), step_m));
            if around.iter().all(|off| *off < WORSE_BY * here) { here } else { 0.0 }
        });
        each.fold(1.0, f64::min)
    };
    // Exact transforms show in all ranges. Transforms that are slightly wrong, in a drive around the stations, show only in
    // differences of consecutive ranges.
    let both =
        RANGE_STEPS_M.map(|step_m| f64::max(of(step_m, all_in_steps), of(step_m, next_in_steps)));
    both.into_iter().fold(0.0, f64::max)
}

/// Agreement of the ranges from an origin (m) with steps (m), from 0 (chance) to 1.
type InSteps = fn(&[Position], &Vector3<f64>, f64) -> f64;

/// Length of the mean of exp(2πi r / step) over all ranges r. It is 1 if they are multiples of the step plus a constant, such as
/// the prism constant.
fn all_in_steps(positions: &[Position], origin_m: &Vector3<f64>, step_m: f64) -> f64 {
    mean_phase(positions.iter().map(|p| (p.position_m - origin_m).norm() / step_m))
}

/// Length of the mean of exp(2πi Δr / step) over consecutive readings that moved. An error of the origin changes these differences
/// Δr of ranges less than the ranges.
fn next_in_steps(positions: &[Position], origin_m: &Vector3<f64>, step_m: f64) -> f64 {
    let pairs = positions.windows(2).map(|pair| [pair[0].position_m, pair[1].position_m]);
    let moved = pairs.filter(|[a, b]| (a - b).norm() > MOVED_M);
    mean_phase(moved.map(|[a, b]| ((b - origin_m).norm() - (a - origin_m).norm()) / step_m))
}

/// Length of the mean of exp(2πi x); 0 for too few values.
fn mean_phase(values: impl Iterator<Item = f64>) -> f64 {
    let (mut cos, mut sin, mut count) = (0.0, 0.0, 0);
    for value in values {
        let (s, c) = (std::f64::consts::TAU * value.fract()).sin_cos();
        (cos, sin, count) = (cos + c, sin + s, count + 1);
    }
    if count < FEWEST_MOVED { 0.0 } else { f64::hypot(cos, sin) / count as f64 }
}
