//! The rig, out of whatever describes it, and whether the descriptions agree.

use crate::findings::rig::{
    prism_positions_disagree, prism_positions_of_other_rig, rig_derived_from_reading,
    rig_file_preferred, rig_reading_disagrees, rig_unknown,
};
use nalgebra::Vector3;

use super::found::{FoundFile, Standing};
use super::reading::Reading;
use super::surveys::Surveys;
use crate::error::OpenError;
use crate::format;
use crate::format::Format;
use resect_core::deployment::pairwise_distances;
use resect_core::deployment::{OneOrMany, Rig};

/// Distances of one rig in two files may differ by this much (m) before it is worth a word.
const RIG_TOLERANCE_M: f64 = 0.005;
/// Distances in two files differ by more than this (m) only if they are not of one rig.
const WRONG_RIG_M: f64 = 0.05;

/// What `rig` of `deployment.toml` can name.
const DESCRIBE_A_RIG: [Format; 5] = [
    Format::RigReading,
    Format::SensorPositions,
    Format::RigDistances,
    Format::Gsi,
    Format::JobXml,
];

/// `None`, with a finding, where nothing gives the inter-prism distances.
#[expect(clippy::too_many_lines, reason = "not split yet")]
pub fn read_rig<'a>(
    reading: &mut Reading<'a, '_>,
    prism_constants_m: &[f64; 3],
    surveys: &Surveys<'a>,
) -> Result<Option<Rig>, OpenError> {
    let Reading { files, overrides, put_right, progress, used, findings, distances_of_files_m } =
        reading;
    let named_files = overrides.rig.as_ref().map(OneOrMany::as_slice);
    if let Some(wrong) = named_files.iter().copied().flatten().find(|named| {
        !files.iter().any(|f| f.file == **named && DESCRIBE_A_RIG.contains(&f.format))
    }) {
        return Err(OpenError::file(
            "deployment.toml",
            format!("rig names `{wrong}`, which does not describe a rig"),
            "give names relative to the folder",
        ));
    }
    let mut named = false;
    let mut only = |format: Format| {
        // What the user names now goes before what deployment.toml names.
        let wanted = |f: &&FoundFile| {
            f.standing == Standing::Named || named_files.is_none_or(|named| named.contains(&f.file))
        };
        let found: Vec<&FoundFile> =
            files.iter().filter(|f| f.serves_as(format)).filter(wanted).collect();
        match found[..] {
            [] => Ok(None),
            [one] => {
                used.push(&one.file);
                named |= one.standing == Standing::Named;
                Ok(Some(one))
            }
            [first, second, ..] => Err(OpenError::file(
                &first.file,
                format!("and {} both hold {}", second.file, format.describe()),
                "name the one to use in deployment.toml: rig = \"…\"; or leave one of them in the folder",
            )),
        }
    };
    let reading = match only(Format::RigReading)? {
        Some(f) => {
            let text = f.text(progress)?;
            Some((&f.file, format::rig_files::read_rig_reading(&f.file, &text, prism_constants_m)?))
        }
        None => match only(Format::SensorPositions)? {
            Some(f) => {
                let text = f.text(progress)?;
                Some((&f.file, format::rig_files::read_sensor_positions(&f.file, &text)?))
            }
            None => surveys.rig(named_files, prism_constants_m, findings)?,
        },
    };
    let distances = match only(Format::RigDistances)? {
        Some(f) => Some(format::rig_files::read_distances(&f.file, &f.text(progress)?)?),
        None => None,
    };
    used.extend(reading.map(|(file, _)| file.as_str()));
    let prisms_m = reading.map(|(_, prisms_m)| prisms_m);
    let inter_antenna_m = distances.and_then(|(_, antennas)| antennas);
    let measured = prisms_m.as_ref().map(pairwise_distances);
    let by_files = distances.map(|(prisms, _)| prisms).or(measured);
    *distances_of_files_m = by_files;
    let inter_prism_m = match overrides.inter_prism_m {
        // What the user names says it better than a file that lies about.
        Some(_) if named && put_right.inter_prism_m.is_none() => {
            findings.push(rig_file_preferred());
            by_files
        }
        overriding => overriding.or(by_files),
    };
    let Some(inter_prism_m) = inter_prism_m else {
        // One prism has no distances.
        if overrides.prisms != Some(1) {
            findings.push(rig_unknown());
        }
        return Ok(None);
    };
    if let (Some((file, _)), None, true) = (reading, distances, Some(inter_prism_m) == measured) {
        findings.push(rig_derived_from_reading(file));
    }
    let [d12, d13, d23] = inter_prism_m;
    if inter_prism_m.iter().any(|d| !format::rig_files::PLAUSIBLE_DISTANCE_M.contains(d))
        || d12 > d13 + d23
        || d13 > d12 + d23
        || d23 > d12 + d13
    {
        return Err(OpenError::file(
            "inter-prism distances",
            format!("{d12} m, {d13} m and {d23} m are not the sides of a triangle"),
            "the order is 12, 13, 23, in metres",
        ));
    }
    if let (Some(measured), Some((file, _))) = (measured, reading) {
        let worst = (0..3).map(|i| (measured[i] - inter_prism_m[i]).abs()).fold(0.0, f64::max);
        if worst > RIG_TOLERANCE_M {
            findings.push(rig_reading_disagrees(file, worst));
        }
    }
    let mut in_vehicle_m = overrides.prisms_m.map(|prisms| prisms.map(Vector3::from));
    if let Some(given) = in_vehicle_m {
        let worst = pairwise_distances(&given)
            .iter()
            .zip(&inter_prism_m)
            .map(|(given, known)| (given - known).abs())
            .fold(0.0, f64::max);
        if worst > WRONG_RIG_M && named {
            findings.push(prism_positions_of_other_rig(worst));
            in_vehicle_m = None;
        } else if worst > WRONG_RIG_M || given.iter().flatten().any(|value| !value.is_finite()) {
            return Err(OpenError::file(
                "deployment.toml",
                format!("prisms_m does not have the inter-prism distances (off by {worst:.3} m)"),
                "give the prisms 1, 2, 3 in the vehicle's frame, in metres",
            ));
        }
        if in_vehicle_m.is_some() && worst > RIG_TOLERANCE_M {
            findings.push(prism_positions_disagree(worst));
        }
    }
    Ok(Some(Rig { inter_prism_m, prisms_m, inter_antenna_m, in_vehicle_m }))
}
