//! Files of control points, and what is known of where their points are.

use nalgebra::Vector3;

use super::Source;
use crate::deployment::format::{self, Format, OpenError, deployment_toml::Overrides};
use crate::deployment::{ControlPointSet, Finding};

/// Every set, its points with their surveyed coordinates, and the names of the files that were used.
pub fn read_control_point_sets<'a>(
    sources: &'a [Source],
    overrides: &Overrides,
    prism_constant_m: f64,
    findings: &mut Vec<Finding>,
) -> Result<(Vec<ControlPointSet>, Vec<&'a str>), OpenError> {
    let mut used = Vec::new();
    let mut sets = Vec::new();
    let mut pillars = None;
    if let Some(source) = sources.iter().find(|s| s.format == Format::Pillars) {
        pillars = Some(format::pillars::read(&source.file, &source.text()?)?);
        used.push(source.file.as_str());
    }
    for source in sources.iter().filter(|s| s.format == Format::ControlPoints) {
        if overrides.control_points.as_ref().is_some_and(|files| !files.contains(&source.file)) {
            continue;
        }
        let Some(set) = read_control_points(
            &source.file,
            &source.text()?,
            prism_constant_m,
            pillars.as_deref(),
            findings,
        )?
        else {
            continue;
        };
        used.push(source.file.as_str());
        sets.push(set);
    }
    if pillars.is_some() && !sets.is_empty() && !sets.iter().any(|set| set.pillars) {
        findings.push(Finding::warning(
            "the survey of pillars belongs to no file of readings, and all points count as control points; name the file \
             with the pillars' readings Two_points.txt",
        ));
    }
    for source in sources.iter().filter(|s| s.format == Format::SurveyedPoints) {
        let surveyed = format::surveyed_points::read(&source.file, &source.text()?)?;
        for known in &surveyed {
            let point = sets
                .iter_mut()
                .find(|set| set.file == known.file)
                .and_then(|set| set.points.iter_mut().find(|p| p.marker == known.marker_number));
            match point {
                Some(point) => point.known_m = Some(known.position_m()),
                None => findings.push(Finding::warning(format!(
                    "{}: marker {} of {} was not measured",
                    source.file, known.marker_number, known.file
                ))),
            }
        }
        used.push(source.file.as_str());
    }
    if let Some(wanted) = &overrides.control_points
        && let Some(missing) = wanted.iter().find(|file| {
            !sources.iter().any(|s| s.file == **file && s.format == Format::ControlPoints)
        })
    {
        return Err(OpenError::file(
            "deployment.toml",
            format!("control_points names `{missing}`, which is no control-point file here"),
            "give names relative to the folder",
        ));
    }
    Ok((sets, used))
}

/// One file of control points; `None`, with a finding, when it holds no usable one.
///
/// Pillars are known by the markers of their survey, which gives their coordinates; failing that, by the authors'
/// file name.
pub fn read_control_points(
    file: &str,
    text: &str,
    prism_constant_m: f64,
    pillars: Option<&[(i64, Vector3<f64>)]>,
    findings: &mut Vec<Finding>,
) -> Result<Option<ControlPointSet>, OpenError> {
    let (mut set, set_findings) = format::control_points::read(file, text, prism_constant_m)?;
    findings.extend(set_findings);
    if set.points.is_empty() {
        findings.push(Finding::warning(format!("{file}: no usable control point")));
        return Ok(None);
    }
    let named = file.to_lowercase().contains("two_points");
    set.pillars = pillars.map_or(named, |pillars| {
        let known = |marker: i64| pillars.iter().any(|(pillar, _)| *pillar == marker);
        // Ground points are numbered from 1 as well; a set of pillars holds nothing else.
        named || (set.points.len() == pillars.len() && set.points.iter().all(|p| known(p.marker)))
    });
    if let (true, Some(pillars)) = (set.pillars, pillars) {
        for point in &mut set.points {
            let pillar = pillars.iter().find(|(pillar, _)| *pillar == point.marker);
            point.known_m = pillar.map(|(_, position_m)| *position_m);
            if point.known_m.is_none() {
                findings.push(Finding::warning(format!(
                    "{file}: pillar {} stands in no survey of pillars, so its coordinates are not known",
                    point.marker
                )));
            }
        }
    }
    Ok(Some(set))
}
