//! Trimble JobXML (`.jxl`): readings of points by one instrument.
//!
//! By the schema (JobXMLSchema 5.72; JobXML.xsd in KubaSzostak/JobXML, MIT) a `PointRecord` has a `Circle` with `HorizontalCircle`,
//! `VerticalCircle` (degrees; a zenith angle, beyond 180° in face II) and `EDMDistance` (m). No prism constant has been applied to the
//! distance, and the ppm of its `AtmosphereRecord` have been applied only if `ApplyPPMToRawDistances` is false. The `PrismConstant`
//! (m) of its `TargetRecord` is therefore added here, or without a `TargetRecord` the deployment's prism constant, and the ppm if
//! necessary. Circles are not oriented, as required here. Keyed-in points have a `Grid` with North, East, Elevation (m).
//!
//! Written from quotations of the schema; not tested on a calibration of three stations. Records are stamped with whole seconds, so
//! such a file cannot be a track.

use crate::findings::surveys::{
    survey_other_set_ups, survey_points_deleted, survey_prism_constant_missing,
    survey_prism_constants_added, survey_readings_incomplete,
};
use std::collections::HashMap;

use nalgebra::Vector3;
use roxmltree::{Document, Node};

use super::survey::{Sighting, Survey};
use crate::error::OpenError;
use resect_core::deployment::Finding;
use resect_core::geometry::Polar;

/// Returns true if a text begins like a job.
pub fn looks_like(head: &str) -> bool {
    head.trim_start().starts_with('<') && head.contains("<JOBFile")
}

/// Reads every sighting, and coordinates that were keyed in.
pub fn read(file: &str, text: &str) -> Result<Survey, OpenError> {
    let document = Document::parse(text).map_err(|error| {
        let line = error.pos().row as usize;
        OpenError::line(file, line, format!("not XML: {error}"), "export the job again")
    })?;
    let mut records = HashMap::new();
    for record in document.descendants().filter(Node::is_element) {
        if let Some(id) = record.attribute("ID") {
            records.insert((record.tag_name().name(), id), record);
        }
    }
    let mut job = Job { file, records, survey: Survey::default(), counts: Counts::default() };
    let mut first_station: Option<Option<&str>> = None;
    for record in document.descendants().filter(|r| r.has_tag_name("PointRecord")) {
        let Some(name) = text_of(&record, "Name") else { continue };
        if text_of(&record, "Deleted").is_some_and(|deleted| deleted.eq_ignore_ascii_case("true")) {
            job.counts.deleted += 1;
            continue;
        }
        let Some(circle) = child(&record, "Circle") else {
            job.read_coordinates(&record, name)?;
            continue;
        };
        let station = text_of(&record, "StationID");
        if *first_station.get_or_insert(station) != station {
            job.counts.of_other_set_ups += 1;
            continue;
        }
        job.read_sighting(&record, &circle, name)?;
    }
    let findings = job.counts.findings(file);
    job.survey.findings.extend(findings);
    Ok(job.survey)
}

/// A job while it is read.
struct Job<'a, 'i> {
    file: &'a str,
    /// Records by kind and ID.
    records: HashMap<(&'a str, &'a str), Node<'a, 'i>>,
    survey: Survey,
    counts: Counts,
}

/// Records that were left out, and prism constants that were added.
#[derive(Default)]
struct Counts {
    deleted: usize,
    of_other_set_ups: usize,
    incomplete: usize,
    without_constant: usize,
    /// Distinct prism constants (mm).
    constants: Vec<String>,
}

impl<'a, 'i> Job<'a, 'i> {
    /// Adds the coordinates of a keyed-in point, if it has all three.
    fn read_coordinates(&mut self, record: &Node<'_, '_>, name: &str) -> Result<(), OpenError> {
        let Some(grid) = child(record, "Grid") else { return Ok(()) };
        let [north, east, up] = ["North", "East", "Elevation"].map(|n| number(self.file, &grid, n));
        if let (Some(north), Some(east), Some(up)) = (north?, east?, up?) {
            self.survey.coordinates.push((name.to_owned(), Vector3::new(east, north, up)));
        }
        Ok(())
    }

    /// Adds a sighting; its prism constant and ppm are applied to the range.
    fn read_sighting(
        &mut self,
        record: &Node<'a, 'i>,
        circle: &Node<'_, '_>,
        name: &str,
    ) -> Result<(), OpenError> {
        let [azimuth, zenith, range] = ["HorizontalCircle", "VerticalCircle", "EDMDistance"]
            .map(|n| number(self.file, circle, n));
        let (Some(azimuth_deg), Some(zenith_deg), Some(edm_m)) = (azimuth?, zenith?, range?) else {
            self.counts.incomplete += 1;
            return Ok(());
        };
        let constant_m = match self.record("TargetRecord", text_of(record, "TargetID")) {
            Some(target) => number(self.file, &target, "PrismConstant")?,
            None => None,
        };
        let ppm = self.ppm(text_of(record, "StationID"))?;
        self.counts.add_constant(constant_m);
        let range_m = (edm_m + constant_m.unwrap_or(0.0)) * (1.0 + ppm * 1e-6);
        let polar = Polar {
            range_m,
            azimuth_rad: azimuth_deg.to_radians(),
            zenith_rad: zenith_deg.to_radians(),
        };
        let point = name.to_owned();
        self.survey.sightings.push(Sighting { point, polar, complete: constant_m.is_some() });
        Ok(())
    }

    fn record(&self, kind: &'static str, id: Option<&'a str>) -> Option<Node<'a, 'i>> {
        self.records.get(&(kind, id?)).copied()
    }

    /// Returns the ppm still to be applied to ranges of a station; zero if the instrument has applied them.
    fn ppm(&self, station: Option<&'a str>) -> Result<f64, OpenError> {
        let atmosphere = self
            .record("StationRecord", station)
            .and_then(|s| self.record("AtmosphereRecord", text_of(&s, "AtmosphereID")));
        match atmosphere {
            Some(a) if text_of(&a, "ApplyPPMToRawDistances") == Some("true") => {
                Ok(number(self.file, &a, "PPM")?.unwrap_or(0.0))
            }
            _ => Ok(0.0),
        }
    }
}

impl Counts {
    fn add_constant(&mut self, constant_m: Option<f64>) {
        let Some(constant_m) = constant_m else {
            self.without_constant += 1;
            return;
        };
        let constant = format!("{:+.1}", constant_m * 1e3);
        if !self.constants.contains(&constant) {
            self.constants.push(constant);
        }
    }

    fn findings(&self, file: &str) -> Vec<Finding> {
        let Self { deleted, of_other_set_ups, incomplete, without_constant, constants } = self;
        let findings = [
            (*deleted > 0).then(|| survey_points_deleted(file, *deleted)),
            (*of_other_set_ups > 0)
                .then(|| survey_other_set_ups(file, *of_other_set_ups, "readings")),
            (*incomplete > 0)
                .then(|| survey_readings_incomplete(file, *incomplete, "a distance or an angle")),
            (*without_constant > 0).then(|| survey_prism_constant_missing(file, *without_constant)),
            (!constants.is_empty()).then(|| survey_prism_constants_added(file, constants)),
        ];
        findings.into_iter().flatten().collect()
    }
}

fn child<'a, 'i>(node: &Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|child| child.has_tag_name(name))
}

fn text_of<'a>(node: &Node<'a, '_>, name: &str) -> Option<&'a str> {
    child(node, name)?.text().map(str::trim).filter(|text| !text.is_empty())
}

/// Returns a number; `None` if it is absent or empty.
fn number(file: &str, node: &Node<'_, '_>, name: &str) -> Result<Option<f64>, OpenError> {
    let Some(text) = text_of(node, name) else { return Ok(None) };
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(Some(value)),
        _ => {
            let place = child(node, name).map_or(0, |child| child.range().start);
            let line = node.document().text_pos_at(place).row as usize;
            let what = format!("`{text}` in {name} is not a number");
            Err(OpenError::line(file, line, what, "export the job again"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn job(points: &str) -> String {
        format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<JOBFile jobName=\"x\" version=\"5.72\"><FieldBook>\n\
             <AtmosphereRecord ID=\"1\"><PPM>10</PPM><ApplyPPMToRawDistances>true</ApplyPPMToRawDistances></AtmosphereRecord>\n\
             <StationRecord ID=\"2\"><StationName>S</StationName><AtmosphereID>1</AtmosphereID></StationRecord>\n\
             <TargetRecord ID=\"3\"><PrismConstant>0.0100</PrismConstant></TargetRecord>\n{points}</FieldBook></JOBFile>\n"
        )
    }

    fn point(name: &str, circle: &str, ids: &str) -> String {
        format!(
            "<PointRecord ID=\"9\"><Name>{name}</Name><Circle>{circle}</Circle>{ids}</PointRecord>\n"
        )
    }

    const CIRCLE: &str = "<HorizontalCircle>223.5</HorizontalCircle><VerticalCircle>92.25</VerticalCircle>\
        <EDMDistance>100.0</EDMDistance><Face>Face1</Face>";

    #[test]
    fn readings_get_their_targets_constant_and_the_ppm_once() {
        let both = "<StationID>2</StationID><TargetID>3</TargetID>";
        let text = job(&[
            point("A", CIRCLE, both),
            point("B", CIRCLE, "<StationID>2</StationID>"),
            point("C", CIRCLE, "<StationID>7</StationID><TargetID>3</TargetID>"),
            point("D", CIRCLE, &format!("{both}<Deleted>true</Deleted>")),
            point("E", "<HorizontalCircle>1</HorizontalCircle><EDMDistance/>", both),
            "<PointRecord><Name>K</Name><Grid><North>2</North><East>1</East><Elevation>3</Elevation></Grid></PointRecord>"
                .to_owned(),
        ]
        .concat());
        assert!(looks_like(&text));
        let survey = read("a.jxl", &text).expect("good");
        let [a, b] = &survey.sightings[..] else { panic!("{survey:?}") };
        assert!((a.polar.range_m - 100.010 * (1.0 + 1e-5)).abs() < 1e-12 && a.complete);
        assert!((b.polar.range_m - 100.0 * (1.0 + 1e-5)).abs() < 1e-12 && !b.complete);
        assert!((a.polar.azimuth_rad.to_degrees() - 223.5).abs() < 1e-9);
        assert_eq!(survey.coordinates, [("K".to_owned(), Vector3::new(1.0, 2.0, 3.0))]);
        let said = survey.findings.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n");
        for expected in [
            "1 points left out: deleted",
            "1 readings of further",
            "1 readings without a distance",
            "1 readings without a prism constant",
            "(+10.0 mm) are added",
        ] {
            assert!(said.contains(expected), "{expected} in {said}");
        }
    }

    #[test]
    fn mistakes_say_where() {
        let wrong = job(&point("A", &CIRCLE.replace("100.0", "twenty"), ""));
        let error = read("a.jxl", &wrong).expect_err("text").to_string();
        assert!(error.starts_with("a.jxl:6: `twenty` in EDMDistance"), "{error}");
        let cut = &job("")[..150];
        assert!(read("a.jxl", cut).expect_err("cut").to_string().starts_with("a.jxl:"));
        let bomb = "<!DOCTYPE a [<!ENTITY b \"c\">]><JOBFile>&b;</JOBFile>";
        assert!(read("a.jxl", bomb).expect_err("a DTD").to_string().contains("not XML"));
    }
}
