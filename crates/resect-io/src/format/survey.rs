//! Readings of named points by one instrument: the common content of the surveyors' formats.

use crate::findings::surveys::{
    survey_angles_seem_elevations, survey_points_inconsistent, survey_readings_unusable,
};
use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

use nalgebra::Vector3;

use resect_core::deployment::Finding;
use resect_core::geometry::{Polar, wrap_to_pi};

/// Largest distance between readings of one point (m).
pub(super) const SAME_POINT_M: f64 = 0.05;
/// If half of all points are steeper than this zenith angle (rad), the vertical angles count from the horizon.
const STEEP_RAD: f64 = PI / 6.0;

/// Number of cases of one kind that a finding names.
const NAMED: usize = 3;

/// Contents of a file of one instrument.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Survey {
    /// The sightings in the order of the file.
    pub sightings: Vec<Sighting>,
    /// Names and coordinates (east, north, up; m) of points without a reading.
    pub coordinates: Vec<(String, Vector3<f64>)>,
    pub findings: Vec<Finding>,
}

/// One sighting of a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Sighting {
    pub point: String,
    /// The reading in either face: a zenith angle beyond 180° is face II.
    pub polar: Polar,
    /// True if the range includes the prism constant.
    pub complete: bool,
}

impl Survey {
    /// Returns every point once, in order of appearance: the mean of its readings, with equal weight of both faces. `prism_constant_m`
    /// is added to ranges that lack the prism constant.
    pub fn points(&self, file: &str, prism_constant_m: f64) -> (Vec<PointReading>, Vec<Finding>) {
        let mut names: Vec<&str> = Vec::new();
        let mut by_name: HashMap<&str, [Vec<Polar>; 2]> = HashMap::new();
        let (mut unusable, mut apart) = (Several::default(), Several::default());
        for sighting in &self.sightings {
            let zenith_rad = sighting.polar.zenith_rad.rem_euclid(TAU);
            let (mut polar, second) = Polar { zenith_rad, ..sighting.polar }.in_face_left();
            polar.range_m += if sighting.complete { 0.0 } else { prism_constant_m };
            if !polar.is_plausible() {
                unusable.add(|| sighting.point.clone());
                continue;
            }
            let faces = by_name.entry(&sighting.point).or_insert_with(|| {
                names.push(&sighting.point);
                Default::default()
            });
            faces[usize::from(second)].push(polar);
        }
        let mut points = Vec::new();
        for name in names {
            let faces = &by_name[name];
            let all = || faces.iter().flatten();
            let Some(first) = all().next() else { continue };
            let apart_m = |p: &Polar| (p.to_cartesian() - first.to_cartesian()).norm();
            let apart_m = all().map(apart_m).fold(0.0, f64::max);
            if apart_m > SAME_POINT_M {
                apart.add(|| format!("{name}: {} up to {apart_m:.2} m apart", all().count()));
                continue;
            }
            let means: Vec<Polar> = faces.iter().filter_map(|face| mean(face)).collect();
            let face_one = if means.len() == 2 { means.first().copied() } else { None };
            let named = |polar| PointReading { name: name.to_owned(), polar, face_one };
            points.extend(mean(&means).map(named));
        }
        let mut findings = Vec::new();
        if unusable.count > 0 {
            let first = unusable.in_words();
            findings.push(survey_readings_unusable(file, unusable.count, &first));
        }
        if apart.count > 0 {
            findings.push(survey_points_inconsistent(file, apart.count, &apart.in_words()));
        }
        let steep = points.iter().filter(|point| point.polar.zenith_rad < STEEP_RAD).count();
        if 2 * steep > points.len() {
            findings.push(survey_angles_seem_elevations(file));
        }
        (points, findings)
    }
}

/// The reading of a point by one instrument.
#[derive(Clone, Debug, PartialEq)]
pub struct PointReading {
    pub name: String,
    /// Mean of all readings, with equal weight of both faces.
    pub polar: Polar,
    /// Mean of those in face I; `None` unless there are both faces.
    pub face_one: Option<Polar>,
}

/// Cases of one kind: their number, and descriptions of the first.
#[derive(Default)]
struct Several {
    count: usize,
    first: Vec<String>,
}

impl Several {
    fn add(&mut self, words: impl FnOnce() -> String) {
        self.count += 1;
        if self.first.len() < NAMED {
            self.first.push(words());
        }
    }

    fn in_words(&self) -> String {
        self.first.join("; ") + if self.count > NAMED { "; …" } else { "" }
    }
}

/// Mean of readings of one point; `None` without readings.
pub(super) fn mean(readings: &[Polar]) -> Option<Polar> {
    let first = readings.first()?;
    let of = |value: &dyn Fn(&Polar) -> f64| {
        readings.iter().map(value).sum::<f64>() / readings.len() as f64
    };
    let turned = of(&|p| wrap_to_pi(p.azimuth_rad - first.azimuth_rad));
    Some(Polar {
        range_m: of(&|p| p.range_m),
        azimuth_rad: (first.azimuth_rad + turned).rem_euclid(TAU),
        zenith_rad: of(&|p| p.zenith_rad),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::findings::kinds;

    fn sighting(point: &str, azimuth_rad: f64, zenith_rad: f64, range_m: f64) -> Sighting {
        let polar = Polar { range_m, azimuth_rad, zenith_rad };
        Sighting { point: point.to_owned(), polar, complete: false }
    }

    #[test]
    fn both_faces_weigh_the_same() {
        // Collimation error 1e-4, vertical index error 2e-4: opposite in the two faces. The readings are on both sides of azimuth 0.
        let survey = Survey {
            sightings: vec![
                sighting("a", 1e-4, 1.5 + 2e-4, 20.0),
                sighting("b", 1.0, 1.4, 30.0),
                sighting("a", 1e-4, 1.5 + 2e-4, 20.0),
                sighting("a", PI - 1e-4, TAU - 1.5 + 2e-4, 20.0),
            ],
            ..Survey::default()
        };
        let (points, findings) = survey.points("x.gsi", 0.01);
        assert!(findings.is_empty(), "{findings:?}");
        assert_eq!(points.iter().map(|point| point.name.as_str()).collect::<Vec<_>>(), ["a", "b"]);
        let (a, face_one) = (points[0].polar, points[0].face_one.expect("both faces"));
        assert!(wrap_to_pi(a.azimuth_rad).abs() < 1e-12, "{a:?}");
        assert!((a.zenith_rad - 1.5).abs() < 1e-12 && (a.range_m - 20.01).abs() < 1e-12, "{a:?}");
        assert!((face_one.zenith_rad - 1.5002).abs() < 1e-12, "{face_one:?}");
        assert!((face_one.azimuth_rad - 1e-4).abs() < 1e-12, "{face_one:?}");
        assert_eq!(points[1].face_one, None);
    }

    #[test]
    fn what_cannot_be_one_point_is_said() {
        let survey = Survey {
            sightings: vec![sighting("a", 0.0, 1.5, 20.0), sighting("a", 0.1, 1.5, 20.0)],
            ..Survey::default()
        };
        let (points, findings) = survey.points("x.gsi", 0.0);
        assert!(points.is_empty());
        assert_eq!(findings[0].kind, kinds::SURVEY_POINTS_INCONSISTENT);
        assert!(findings[0].to_string().contains("up to 1.99 m apart"), "{findings:?}");
        let survey =
            Survey { sightings: vec![sighting("a", 0.0, 0.01, 20.0)], ..Survey::default() };
        let (_, findings) = survey.points("x.gsi", 0.0);
        assert_eq!(findings[0].kind, kinds::SURVEY_ANGLES_SEEM_ELEVATIONS);
    }
}
