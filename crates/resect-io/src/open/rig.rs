//! The rig, from all files that describe it, and their agreement.

use crate::findings::rig::{
    prism_positions_disagree, prism_positions_of_other_rig, rig_derived_from_reading,
    rig_file_preferred, rig_reading_disagrees, rig_unknown,
};
use nalgebra::{DVector, Vector3};
use resect_core::network::{MOST_STATIONS, Number, Pair, PerPair, PerPrism, Prism, Station};

use super::found::{FoundFile, Standing};
use super::reading::Reading;
use super::surveys::{RigPoints, Surveys};
use crate::error::OpenError;
use crate::format;
use crate::format::Format;
use resect_core::deployment::pairwise_distances;
use resect_core::deployment::{FollowedPrisms, OneOrMany, Overrides, Rig};

/// Difference of a distance between two files of one rig above which it is reported (m).
const RIG_TOLERANCE_M: f64 = 0.005;
/// Number of prisms where nothing states more.
const USUAL_PRISMS: usize = 3;
/// Largest prism constant (m).
const LARGEST_CONSTANT_M: f64 = 0.04;
/// Difference of a distance between two files above which they describe two rigs (m).
const WRONG_RIG_M: f64 = 0.05;

/// Formats of files that `rig` of `deployment.toml` can name.
const DESCRIBE_A_RIG: [Format; 5] = [
    Format::RigReading,
    Format::SensorPositions,
    Format::RigDistances,
    Format::Gsi,
    Format::JobXml,
];

/// Reads the rig; returns `None`, with a finding, if the inter-prism distances are unknown.
pub fn read_rig<'a>(
    reading: &mut Reading<'a, '_>,
    surveys: &Surveys<'a>,
) -> Result<Option<Rig>, OpenError> {
    check_named_files(reading)?;
    let files = read_rig_files(reading, surveys)?;
    let measured =
        files.prisms.as_ref().map(|(_, prisms_m)| pairwise_distances(prisms_m.as_slice()));
    let by_files = files.distances.clone().map(|(prisms, _)| prisms).or_else(|| measured.clone());
    reading.distances_of_files_m.clone_from(&by_files);
    let Reading { overrides, corrections, findings, .. } = reading;
    let inter_prism_m = match overrides.inter_prism_m.clone() {
        // A file that the user names takes precedence over the overrides of the folder.
        Some(_) if files.is_named && corrections.inter_prism_m.is_none() => {
            findings.push(rig_file_preferred());
            by_files
        }
        overriding => overriding.or(by_files),
    };
    let Some(inter_prism_m) = inter_prism_m else {
        // A single prism has no distances.
        if overrides.prisms.as_ref().map(FollowedPrisms::count) != Some(1) {
            findings.push(rig_unknown());
        }
        return Ok(None);
    };
    if let (Some((file, _)), None, true) =
        (&files.prisms, &files.distances, Some(&inter_prism_m) == measured.as_ref())
    {
        findings.push(rig_derived_from_reading(file));
    }
    check_triangles(&inter_prism_m)?;
    let prisms_m = files.prisms.as_ref().map(|(_, prisms_m)| prisms_m.clone());
    let prisms_m = prisms_m.filter(|prisms_m| Pair::count(prisms_m.len()) == inter_prism_m.len());
    let inter_antenna_m = files.distances.and_then(|(_, antennas)| antennas);
    let rig =
        Rig { inter_prism_m: inter_prism_m.clone(), prisms_m, inter_antenna_m, in_vehicle_m: None };
    if let (Some(measured), Some((file, _)), Some(_)) = (measured, files.prisms, &rig.prisms_m) {
        let largest_m = unexplained_difference_m(&rig, &measured);
        if largest_m > RIG_TOLERANCE_M {
            findings.push(rig_reading_disagrees(file, largest_m));
        }
    }
    let in_vehicle_m = prisms_in_vehicle(reading, &inter_prism_m, files.is_named)?;
    Ok(Some(Rig { in_vehicle_m, ..rig }))
}

/// The largest difference of the distances from those of the reading (m), beside that of one prism constant: the published distances of
/// 2022-07-11 are those of the reading without it.
fn unexplained_difference_m(rig: &Rig, measured_m: &PerPair<f64>) -> f64 {
    let vector = |values: &PerPair<f64>| DVector::from_column_slice(values.as_slice());
    let by_constant = vector(&rig.distances_by_prism_constant());
    let difference_m = vector(&rig.inter_prism_m) - vector(measured_m);
    let constant_m = by_constant.dot(&difference_m) / by_constant.norm_squared().max(1e-6);
    let constant_m = constant_m.clamp(-LARGEST_CONSTANT_M, LARGEST_CONSTANT_M);
    (difference_m - by_constant * constant_m).amax()
}

/// Checks that all files that `deployment.toml` names describe a rig.
fn check_named_files(reading: &Reading<'_, '_>) -> Result<(), OpenError> {
    let describes_a_rig = |named: &String| {
        let files = &reading.files;
        files.iter().any(|f| f.file == *named && DESCRIBE_A_RIG.contains(&f.format))
    };
    let named_files = reading.overrides.rig.as_ref().map(OneOrMany::as_slice);
    match named_files.unwrap_or_default().iter().find(|named| !describes_a_rig(named)) {
        None => Ok(()),
        Some(wrong) => Err(OpenError::file(
            "deployment.toml",
            format!("rig names `{wrong}`, which does not describe a rig"),
            "give names relative to the folder",
        )),
    }
}

/// The contents of all files that describe the rig.
struct RigFiles<'a> {
    /// Prism positions (m), and the file that they are from.
    prisms: Option<RigPoints<'a>>,
    /// Distances between the prisms, and between the antennas (m).
    distances: Option<(PerPair<f64>, Option<[f64; 3]>)>,
    /// True if the user named one of the files.
    is_named: bool,
}

/// Reads the files that describe the rig: a reading, else positions, else a survey; and distances.
fn read_rig_files<'a>(
    reading: &mut Reading<'a, '_>,
    surveys: &Surveys<'a>,
) -> Result<RigFiles<'a>, OpenError> {
    let stated = stated_prisms(reading.overrides);
    let prism_constants_m = &prism_constants_m(reading.overrides, stated);
    let mut is_named = false;
    let mut only = |reading: &mut Reading<'a, '_>, format: Format| {
        let file = find_rig_file(reading, format)?;
        if let Some(file) = file {
            reading.used.push(&file.file);
            is_named |= file.standing == Standing::Named;
        }
        Ok::<_, OpenError>(file)
    };
    let prisms = if let Some(f) = only(reading, Format::RigReading)? {
        let text = f.text(reading.progress)?;
        Some((&f.file, format::rig_files::read_rig_reading(&f.file, &text, prism_constants_m)?))
    } else if let Some(f) = only(reading, Format::SensorPositions)? {
        let text = f.text(reading.progress)?;
        Some((
            &f.file,
            format::rig_files::read_sensor_positions(&f.file, &text, prism_constants_m.len())?,
        ))
    } else {
        let named_files = reading.overrides.rig.as_ref().map(OneOrMany::as_slice);
        surveys.rig(named_files, prism_constants_m, reading.findings)?
    };
    let distances = match only(reading, Format::RigDistances)? {
        Some(f) => {
            let text = f.text(reading.progress)?;
            Some(format::rig_files::read_distances(&f.file, &text, stated)?)
        }
        None => None,
    };
    reading.used.extend(prisms.as_ref().map(|(file, _)| file.as_str()));
    Ok(RigFiles { prisms, distances, is_named })
}

/// Returns the number of prisms on the vehicle that `deployment.toml` or the user states.
fn stated_prisms(overrides: &Overrides) -> Option<usize> {
    let followed = match overrides.prisms.as_ref() {
        Some(FollowedPrisms::Each(prisms)) => prisms.iter().max().copied().map(usize::from),
        Some(FollowedPrisms::Count(count)) => Some(usize::from(*count)),
        None => None,
    };
    let by_distances =
        || overrides.inter_prism_m.as_ref().and_then(|all_m| Pair::prisms_of(all_m.len()));
    let by_positions = || overrides.prisms_m.as_ref().map(PerPrism::len);
    by_distances().or_else(by_positions).or(followed.filter(|prisms| *prisms > 1))
}

/// Returns the prism constant of each prism (m): that of the first station that follows it. Three prisms are usual.
fn prism_constants_m(overrides: &Overrides, stated: Option<usize>) -> PerPrism<f64> {
    let constants = overrides.prism_constant_m.clone().unwrap_or_default();
    let station_of = |prism: Prism| {
        let follows = |station: &Station| {
            overrides.prisms.as_ref().and_then(|all| all.of_station(*station)) == Some(prism)
        };
        let mut stations = (0..MOST_STATIONS).map(Station::at);
        stations.find(follows).unwrap_or_else(|| Station::at(prism.index()))
    };
    let prisms = stated.unwrap_or(USUAL_PRISMS);
    PerPrism::from_fn(prisms, |prism| constants.of_station_m(station_of(prism)))
}

/// Finds the one file of a format that may describe the rig.
fn find_rig_file<'a>(
    reading: &Reading<'a, '_>,
    format: Format,
) -> Result<Option<&'a FoundFile>, OpenError> {
    let named_files = reading.overrides.rig.as_ref().map(OneOrMany::as_slice);
    // Files that the user names take precedence over those that deployment.toml names.
    let wanted = |f: &&FoundFile| {
        f.standing == Standing::Named || named_files.is_none_or(|named| named.contains(&f.file))
    };
    let found: Vec<&FoundFile> =
        reading.files.iter().filter(|f| f.serves_as(format)).filter(wanted).collect();
    match found[..] {
        [] => Ok(None),
        [file] => Ok(Some(file)),
        [first, second, ..] => Err(OpenError::file(
            &first.file,
            format!("and {} both contain {}", second.file, format.describe()),
            "name the one to use in deployment.toml: rig = \"…\"; or keep only one in the folder",
        )),
    }
}

/// Checks that inter-prism distances are plausible sides of triangles.
fn check_triangles(inter_prism_m: &PerPair<f64>) -> Result<(), OpenError> {
    let distances = "inter-prism distances";
    if let Some(wrong_m) =
        inter_prism_m.iter().find(|d| !format::rig_files::PLAUSIBLE_DISTANCE_M.contains(*d))
    {
        let what = format!("{wrong_m} m is not a distance between prisms");
        return Err(OpenError::file(distances, what, "the order is 12, 13, 23, in metres"));
    }
    for base in inter_prism_m.numbers() {
        for third in (0..base.first.index()).map(Prism::at) {
            let d12 = inter_prism_m[Pair { first: third, second: base.first }];
            let d13 = inter_prism_m[Pair { first: third, second: base.second }];
            let d23 = inter_prism_m[base];
            if d12 > d13 + d23 || d13 > d12 + d23 || d23 > d12 + d13 {
                let what = format!("{d12} m, {d13} m and {d23} m are not the sides of a triangle");
                let remedy = "the order is 12, 13, 23, 14, 24, 34, …, in metres";
                return Err(OpenError::file(distances, what, remedy));
            }
        }
    }
    Ok(())
}

/// Returns the prisms in the frame of the vehicle (m), if `deployment.toml` has them and they match this rig.
fn prisms_in_vehicle(
    reading: &mut Reading<'_, '_>,
    inter_prism_m: &PerPair<f64>,
    is_named: bool,
) -> Result<Option<PerPrism<Vector3<f64>>>, OpenError> {
    let Some(given) = &reading.overrides.prisms_m else {
        return Ok(None);
    };
    let given = given.map(|prism_m| Vector3::from(*prism_m));
    let is_other_number = Pair::count(given.len()) != inter_prism_m.len();
    let worst = pairwise_distances(given.as_slice())
        .iter()
        .zip(inter_prism_m)
        .map(|(given, known)| (given - known).abs())
        .fold(0.0, f64::max);
    if (worst > WRONG_RIG_M || is_other_number) && is_named {
        reading.findings.push(prism_positions_of_other_rig(worst));
        return Ok(None);
    }
    if is_other_number {
        let what =
            format!("prisms_m lists {} prisms for {} distances", given.len(), inter_prism_m.len());
        return Err(OpenError::file("deployment.toml", what, "give every prism of the rig"));
    }
    if worst > WRONG_RIG_M || given.iter().flatten().any(|value| !value.is_finite()) {
        return Err(OpenError::file(
            "deployment.toml",
            format!("prisms_m does not have the inter-prism distances (off by {worst:.3} m)"),
            "give the prisms in the vehicle's frame, in metres",
        ));
    }
    if worst > RIG_TOLERANCE_M {
        reading.findings.push(prism_positions_disagree(worst));
    }
    Ok(Some(given))
}
