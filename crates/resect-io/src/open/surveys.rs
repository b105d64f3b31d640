//! Control points, their coordinates and the rig from surveyors' files (GSI, JobXML).
//!
//! One file is one instrument in one place. The number at the end of its name, or `surveys` of `deployment.toml`, gives its station.
//! Files whose names differ only in that number form one set of control points.

use crate::findings::surveys::{
    survey_coordinates_left_out, survey_empty, survey_points_numbered, survey_prism_constant_kept,
    survey_station_repeated, survey_station_unknown,
};
use resect_core::network::{MOST_STATIONS, Number, PerPrism, PerStation, Station};
use std::collections::HashMap;

use nalgebra::Vector3;

use super::found::{FoundFile, Standing};
use super::reading::Reading;
use super::station_in_name::station_in_name;
use crate::error::OpenError;
use crate::format::survey::{PointReading, Survey};
use crate::format::{Format, gsi, jobxml};
use crate::recording::station_index;
use resect_core::deployment::{ControlPoint, ControlPointSet, Finding, OneOrMany};

/// Contents of the surveyors' files of a folder.
pub struct Surveys<'a> {
    files: Vec<(&'a FoundFile, Survey)>,
}

/// Readings of the stations that form one set.
struct Group<'s> {
    /// Common name of the files, without the station's number.
    pattern: String,
    stations: PerStation<Option<(&'s str, &'s Survey)>>,
}

/// A file, and the prisms in the frame of its instrument (m).
pub type RigPoints<'a> = (&'a String, PerPrism<Vector3<f64>>);

impl<'a> Surveys<'a> {
    /// Reads every such file, except those set aside.
    pub fn read(reading: &mut Reading<'a, '_>) -> Result<Self, OpenError> {
        let mut files = Vec::new();
        for file in reading.files {
            let survey = if file.serves_as(Format::Gsi) {
                gsi::read(&file.file, &file.text(reading.progress)?)?
            } else if file.serves_as(Format::JobXml) {
                jobxml::read(&file.file, &file.text(reading.progress)?)?
            } else {
                continue;
            };
            files.push((file, survey));
        }
        if let Some(missing) = reading
            .overrides
            .surveys
            .iter()
            .flat_map(PerStation::iter)
            .find(|named| !files.iter().any(|(file, _)| file.file == **named))
        {
            return Err(OpenError::file(
                "deployment.toml",
                format!("surveys names `{missing}`, which is not a GSI or JobXML file here"),
                "give names relative to the folder, of stations 1, 2, …",
            ));
        }
        Ok(Self { files })
    }

    /// Returns the sets of control points, one for each group of files; points are identified by their names.
    pub fn control_points(
        &self,
        reading: &mut Reading<'a, '_>,
        prism_constants_m: &PerStation<f64>,
    ) -> Vec<ControlPointSet> {
        let overrides = reading.overrides;
        let rig = overrides.rig.as_ref().map_or(&[][..], OneOrMany::as_slice);
        let wanted = |file: &FoundFile| {
            let named = file.standing == Standing::Named;
            let listed = overrides.control_points.as_ref();
            !rig.contains(&file.file) && (named || listed.is_none_or(|l| l.contains(&file.file)))
        };
        let mut coordinates: HashMap<&str, Vector3<f64>> = HashMap::new();
        let mut groups: Vec<Group<'_>> = Vec::new();
        for (file, survey) in self.files.iter().filter(|(file, _)| wanted(file)) {
            let name = file.file.as_str();
            if survey.sightings.is_empty() {
                // Coordinates that an instrument computed from its own set-up are used only if the user names the file.
                let by_name =
                    file.standing == Standing::Named || overrides.control_points.is_some();
                if survey.coordinates.is_empty() {
                    reading.findings.push(survey_empty(name));
                } else if by_name {
                    for (point, position_m) in &survey.coordinates {
                        coordinates.entry(point).or_insert(*position_m);
                    }
                    reading.used.push(name);
                } else {
                    reading.findings.push(survey_coordinates_left_out(name));
                }
                continue;
            }
            let Some((pattern, station)) = whose(name, overrides.surveys.as_ref()) else {
                reading.findings.push(survey_station_unknown(name));
                continue;
            };
            reading.findings.extend(survey.findings.iter().cloned());
            if survey.sightings.iter().all(|s| s.complete)
                && let Some(given) = &overrides.prism_constant_m
                && given.of_station_m(Station::at(station)) != 0.0
            {
                reading.findings.push(survey_prism_constant_kept(name));
            }
            let group = match groups.iter().position(|g| g.pattern == pattern) {
                Some(known) => &mut groups[known],
                None => {
                    groups
                        .push(Group { pattern, stations: PerStation::repeat(MOST_STATIONS, None) });
                    groups.last_mut().expect("just pushed")
                }
            };
            let place = &mut group.stations[station];
            if let Some((other, _)) = place {
                reading.findings.push(survey_station_repeated(name, other));
            } else {
                *place = Some((name, survey));
                reading.used.push(name);
            }
        }
        let sets =
            groups.iter().map(|group| group.set(prism_constants_m, &coordinates, reading.findings));
        sets.filter(|set| !set.points.is_empty()).collect()
    }

    /// Returns the first points of the file that `rig` of `deployment.toml` names, in the frame of its instrument (m).
    pub fn rig(
        &self,
        named: Option<&[String]>,
        prism_constants_m: &PerPrism<f64>,
        findings: &mut Vec<Finding>,
    ) -> Result<Option<RigPoints<'a>>, OpenError> {
        let is_named = |file: &FoundFile| named.is_some_and(|named| named.contains(&file.file));
        let Some((file, survey)) = self.files.iter().find(|(file, _)| is_named(file)) else {
            return Ok(None);
        };
        findings.extend(survey.findings.iter().cloned());
        findings.extend(survey.points(&file.file, prism_constants_m[0]).1);
        // The prism constant belongs to the prism, and so to the station that tracks it.
        let of = |prism: usize| survey.points(&file.file, prism_constants_m[prism]).0;
        let prisms: Option<PerPrism<Vector3<f64>>> = (0..prism_constants_m.len())
            .map(|prism| of(prism).get(prism).map(|point| point.polar.to_cartesian()))
            .collect();
        let prisms = prisms.ok_or_else(|| {
            let prisms = prism_constants_m.len();
            let what = format!("has fewer than {prisms} points");
            OpenError::file(&file.file, what, format!("the first must be prisms 1 to {prisms}"))
        })?;
        Ok(Some((&file.file, prisms)))
    }
}

/// Returns the group of a file, and its station, from 0.
fn whose(name: &str, surveys: Option<&PerStation<String>>) -> Option<(String, usize)> {
    if let Some(surveys) = surveys {
        return surveys.iter().position(|own| own == name).map(|station| (String::new(), station));
    }
    let stem = name.rfind('.').map_or(name, |dot| &name[..dot]);
    let (pattern, number) = station_in_name(stem).filter(|(pattern, _)| pattern.ends_with('#'))?;
    Some((pattern, station_index(number)?))
}

impl Group<'_> {
    fn set(
        &self,
        prism_constants_m: &PerStation<f64>,
        coordinates: &HashMap<&str, Vector3<f64>>,
        findings: &mut Vec<Finding>,
    ) -> ControlPointSet {
        let mut points: Vec<(String, ControlPoint)> = Vec::new();
        let mut index_of: HashMap<String, usize> = HashMap::new();
        let mut files = Vec::new();
        for (station, own) in self.stations.iter().enumerate() {
            let Some((file, survey)) = own else { continue };
            files.push(*file);
            let (read, said) = survey.points(file, prism_constants_m[station]);
            findings.extend(said);
            for PointReading { name, polar, face_one } in read {
                let index = *index_of.entry(name.clone()).or_insert_with(|| {
                    let known_m = coordinates.get(name.as_str()).copied();
                    points.push((name, ControlPoint::unread(0, known_m)));
                    points.len() - 1
                });
                let point = &mut points[index].1;
                point.set_reading(Station::at(station), Some(polar), face_one);
            }
        }
        let file = files.join(", ");
        number(&file, &mut points, findings);
        ControlPointSet {
            file,
            points: points.into_iter().map(|(_, point)| point).collect(),
            pillars: false,
        }
    }
}

/// Numbers the points: by the numbers in their names if these are distinct, otherwise in order of appearance.
fn number(file: &str, points: &mut [(String, ControlPoint)], findings: &mut Vec<Finding>) {
    let in_name: Option<Vec<i64>> = points
        .iter()
        .map(|(name, _)| station_in_name(name).filter(|(p, _)| p.ends_with('#')).map(|(_, n)| n))
        .collect();
    let mut sorted = in_name.clone().unwrap_or_default();
    sorted.sort_unstable();
    sorted.dedup();
    let markers = match in_name {
        Some(markers) if sorted.len() == points.len() => markers,
        _ => {
            let names: Vec<&str> = points.iter().map(|(name, _)| name.as_str()).take(8).collect();
            let more = points.len() > names.len();
            findings.push(survey_points_numbered(file, &names, more));
            (1..=points.len() as i64).collect()
        }
    };
    for ((_, point), marker) in points.iter_mut().zip(markers) {
        point.marker = marker;
    }
}
