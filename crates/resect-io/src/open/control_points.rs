//! Files of control points, and the known coordinates of their points.

use crate::findings::control_points::{
    control_points_empty, known_point_not_measured, pillar_coordinates_unknown,
    pillars_without_readings,
};
use resect_core::network::PerStation;
use std::path::Path;

use nalgebra::Vector3;

use super::found::Standing;
use super::reading::Reading;
use super::surveys::Surveys;
use crate::error::OpenError;
use crate::format;
use crate::format::Format;
use resect_core::deployment::{ControlPointSet, Finding};

/// Reads every set, with the surveyed coordinates of its points.
pub fn read_control_point_sets<'a>(
    reading: &mut Reading<'a, '_>,
    prism_constants_m: &PerStation<f64>,
    surveys: &Surveys<'a>,
) -> Result<Vec<ControlPointSet>, OpenError> {
    let mut sets: Vec<ControlPointSet> = surveys.control_points(reading, prism_constants_m);
    let Reading { files, overrides, progress, used, findings, .. } = reading;
    let mut pillars = None;
    // Files that the user names come last in the list.
    if let Some(file) = files.iter().rfind(|f| f.serves_as(Format::Pillars)) {
        pillars = Some(format::pillars::read(&file.file, &file.text(progress)?)?);
        used.push(&file.file);
    }
    for file in files.iter().filter(|f| f.serves_as(Format::ControlPoints)) {
        let wanted = overrides.control_points.as_ref();
        if file.standing != Standing::Named && wanted.is_some_and(|w| !w.contains(&file.file)) {
            continue;
        }
        let text = file.text(progress)?;
        let pillars = pillars.as_deref();
        let set = read_control_points(&file.file, &text, prism_constants_m, pillars, findings)?;
        if let Some(set) = set {
            used.push(&file.file);
            sets.push(set);
        }
    }
    if pillars.is_some() && !sets.is_empty() && !sets.iter().any(|set| set.pillars) {
        findings.push(pillars_without_readings());
    }
    for file in files.iter().filter(|f| f.serves_as(Format::SurveyedPoints)) {
        let surveyed = format::surveyed_points::read(&file.file, &file.text(progress)?)?;
        for known in &surveyed {
            let point = set_of(&mut sets, &known.file)
                .and_then(|set| set.points.iter_mut().find(|p| p.marker == known.marker_number));
            match point {
                Some(point) => point.known_m = Some(known.position_m()),
                None => {
                    let marker = known.marker_number;
                    findings.push(known_point_not_measured(&file.file, &known.file, marker));
                }
            }
        }
        used.push(&file.file);
    }
    if let Some(wanted) = &overrides.control_points
        && let Some(missing) = wanted.iter().find(|wanted| {
            let holds = [Format::ControlPoints, Format::Gsi, Format::JobXml];
            !files.iter().any(|f| f.file == **wanted && holds.contains(&f.format))
        })
    {
        return Err(OpenError::file(
            "deployment.toml",
            format!("control_points names `{missing}`, which is not a control-point file here"),
            "give names relative to the folder",
        ));
    }
    Ok(sets)
}

/// Returns the set of a file, by its name in the folder, or by the end of its path if the user named it.
fn set_of<'a>(sets: &'a mut [ControlPointSet], file: &str) -> Option<&'a mut ControlPointSet> {
    let exactly = sets.iter().position(|set| set.file == file);
    let place =
        exactly.or_else(|| sets.iter().position(|set| Path::new(&set.file).ends_with(file)))?;
    sets.get_mut(place)
}

/// Reads one file of control points; returns `None`, with a finding, if it has no usable point.
///
/// Pillars are recognised by the markers of the pillar survey, which has their coordinates; without one, by the authors' file name.
fn read_control_points(
    file: &str,
    text: &str,
    prism_constants_m: &PerStation<f64>,
    pillars: Option<&[(i64, Vector3<f64>)]>,
    findings: &mut Vec<Finding>,
) -> Result<Option<ControlPointSet>, OpenError> {
    let (mut set, set_findings) = format::control_points::read(file, text, prism_constants_m)?;
    findings.extend(set_findings);
    if set.points.is_empty() {
        findings.push(control_points_empty(file));
        return Ok(None);
    }
    let named = file.to_lowercase().contains("two_points");
    set.pillars = pillars.map_or(named, |pillars| {
        let known = |marker: i64| pillars.iter().any(|(pillar, _)| *pillar == marker);
        // Ground points are numbered from 1 as well; a set of pillars contains nothing else.
        named || (set.points.len() == pillars.len() && set.points.iter().all(|p| known(p.marker)))
    });
    if let (true, Some(pillars)) = (set.pillars, pillars) {
        for point in &mut set.points {
            let pillar = pillars.iter().find(|(pillar, _)| *pillar == point.marker);
            point.known_m = pillar.map(|(_, position_m)| *position_m);
            if point.known_m.is_none() {
                findings.push(pillar_coordinates_unknown(file, point.marker));
            }
        }
    }
    Ok(Some(set))
}
