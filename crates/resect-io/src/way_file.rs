//! Driven paths from the files of other programs: CSV with x and y, PLY, GeoJSON.

use std::path::Path;

use nalgebra::{Rotation3, Vector2, Vector3};
use serde_json::Value;

use crate::error::OpenError;
use crate::format::text_encoding::decode_text;
use resect_core::geometry::Geodetic;
use resect_core::network::{MOST_STATIONS, PerStation, Station};
use resect_tools::planning::Plan;
use resect_tools::planning::way::{Piece, waypoints_along};
use resect_tools::simulation::Waypoint;

/// Distance of the waypoints made from points with times (m).
const APART_M: f64 = 2.0;
/// Largest size of a file with a path.
const MOST_BYTES: u64 = 64 << 20;
const FORMATS: &str = "give CSV with the columns x and y (m), an ASCII PLY, or GeoJSON with a line, and the stations as points";

/// Contents of a file: a path, and possibly the stations.
#[derive(Clone, Debug, PartialEq)]
pub struct WayFile {
    pub waypoints: Vec<Waypoint>,
    /// East and north of the stations, and their heights (m); without a height, the plan's is kept. Empty without stations.
    pub stations_m: PerStation<(Vector2<f64>, Option<f64>)>,
}

impl WayFile {
    /// Replaces the path of a plan, and its stations if the file has them.
    pub fn lay(self, plan: &mut Plan) {
        plan.is_driven = false;
        plan.way = vec![Piece::Waypoints(self.waypoints)];
        if self.stations_m.is_empty() {
            return;
        }
        let first_m = plan.stations_m[Station::FIRST];
        plan.stations_m = self.stations_m.map_each(|station, (place_m, height_m)| {
            let before_m = plan.stations_m.get(station).unwrap_or(&first_m);
            Vector3::new(place_m.x, place_m.y, height_m.unwrap_or(before_m.z))
        });
    }
}

/// Reads a path; the format is recognised from the content.
pub fn read(path: &Path) -> Result<WayFile, OpenError> {
    let file = path.display().to_string();
    let io = |error| OpenError::Io { path: path.to_owned(), error };
    let about = path.metadata().map_err(io)?;
    // Reading a pipe would block.
    if !about.is_file() || about.len() > MOST_BYTES {
        return Err(OpenError::file(&file, "not a regular file", FORMATS));
    }
    let bytes = std::fs::read(path).map_err(io)?;
    let text =
        decode_text(&bytes).ok_or_else(|| OpenError::file(&file, "not a text file", FORMATS))?;
    parse(&file, &text)
}

/// Parses a text; `file` is its name in errors.
pub fn parse(file: &str, text: &str) -> Result<WayFile, OpenError> {
    let found = match text.trim_start().as_bytes() {
        [b'{', ..] => geojson(file, text)?,
        [b'p', b'l', b'y', ..] => along(file, ply(file, text)?)?,
        _ => along(file, table(file, text)?)?,
    };
    match found.waypoints.len() {
        0 | 1 => Err(OpenError::file(file, "no path of at least two points", FORMATS)),
        _ => Ok(found),
    }
}

/// Points in the order of the drive.
#[derive(Default)]
struct Points {
    places_m: Vec<Vector2<f64>>,
    /// Times (s) and speeds (m/s) of all points, or empty.
    time_s: Vec<f64>,
    speed_m_per_s: Vec<f64>,
}

fn along(file: &str, points: Points) -> Result<WayFile, OpenError> {
    let Points { places_m, time_s, speed_m_per_s } = points;
    let waypoints = if !time_s.is_empty() {
        if !time_s.is_sorted_by(|a, b| a < b) {
            return Err(OpenError::file(file, "the times are not in order", "sort it by time"));
        }
        waypoints_along(&time_s, &places_m, APART_M)
    } else if !speed_m_per_s.is_empty() {
        let both = places_m.iter().zip(speed_m_per_s);
        both.map(|(at, speed)| Waypoint { speed_m_per_s: Some(speed), ..Waypoint::at(*at) })
            .collect()
    } else {
        places_m.into_iter().map(Waypoint::at).collect()
    };
    Ok(WayFile { waypoints, stations_m: PerStation::default() })
}

/// Indices of the columns.
struct WayColumns {
    x: usize,
    y: usize,
    time: Option<usize>,
    speed: Option<usize>,
}

impl WayColumns {
    fn named<'a>(names: impl Iterator<Item = &'a str>) -> Option<Self> {
        let names: Vec<String> = names.map(|name| name.trim().to_lowercase()).collect();
        let find = |known: &[&str]| names.iter().position(|name| known.contains(&&**name));
        Some(Self {
            x: find(&["x", "x_m", "easting", "east", "e"])?,
            y: find(&["y", "y_m", "northing", "north", "n"])?,
            time: find(&["time", "time_s", "timestamp", "t", "scalar_time_s"]),
            speed: find(&["speed", "speed_m_per_s"]),
        })
    }

    /// Adds the point of a row; `None` if a field is missing or not a number.
    fn add(&self, row: &[&str], to: &mut Points) -> Option<()> {
        let number = |column: usize| -> Option<f64> {
            row.get(column)?.trim().parse().ok().filter(|value: &f64| value.is_finite())
        };
        to.places_m.push(Vector2::new(number(self.x)?, number(self.y)?));
        to.time_s.extend(self.time.map(|column| number(column).ok_or(())).transpose().ok()?);
        to.speed_m_per_s
            .extend(self.speed.map(|column| number(column).ok_or(())).transpose().ok()?);
        Some(())
    }
}

fn table(file: &str, text: &str) -> Result<Points, OpenError> {
    let split = |line: &'_ str| -> Vec<String> {
        line.split([',', ';', '\t']).map(ToOwned::to_owned).collect()
    };
    let mut columns: Option<WayColumns> = None;
    let mut points = Points::default();
    for (index, line) in text.lines().enumerate() {
        if line.trim().is_empty() || line.starts_with('#') {
            continue;
        }
        let fields = split(line);
        let Some(columns) = &columns else {
            columns = WayColumns::named(fields.iter().map(|name| &**name));
            if columns.is_none() {
                let what = format!("the header `{line}` has no x and y");
                return Err(OpenError::line(file, index + 1, what, FORMATS));
            }
            continue;
        };
        let row: Vec<&str> = fields.iter().map(|field| &**field).collect();
        columns.add(&row, &mut points).ok_or_else(|| {
            OpenError::line(
                file,
                index + 1,
                "a field is not a number",
                "correct or delete the line",
            )
        })?;
    }
    Ok(points)
}

/// Reads the vertices of an ASCII PLY, as written by this program and by CloudCompare.
fn ply(file: &str, text: &str) -> Result<Points, OpenError> {
    let mut lines = text.lines().enumerate();
    let (mut names, mut vertices, mut of_vertex): (Vec<String>, usize, bool) =
        (Vec::new(), 0, false);
    for (index, line) in lines.by_ref() {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[..] {
            ["format", "ascii", ..] => {}
            ["format", ..] => {
                let remedy = "write it as ASCII";
                return Err(OpenError::line(file, index + 1, "a binary PLY is not read", remedy));
            }
            ["element", "vertex", count] => {
                of_vertex = true;
                vertices = count.parse().map_err(|_| {
                    OpenError::line(
                        file,
                        index + 1,
                        "the number of vertices is missing",
                        "correct the line",
                    )
                })?;
            }
            ["element", ..] if vertices == 0 => {
                let what = "the vertices are not the first element";
                return Err(OpenError::line(file, index + 1, what, FORMATS));
            }
            ["element", ..] => of_vertex = false,
            ["property", _, name] if of_vertex => names.push(name.to_owned()),
            ["end_header"] => break,
            _ => {}
        }
    }
    let columns = WayColumns::named(names.iter().map(|name| &**name))
        .ok_or_else(|| OpenError::file(file, "the vertices have no x and y", FORMATS))?;
    let mut points = Points::default();
    for (index, line) in lines.take(vertices) {
        let row: Vec<&str> = line.split_whitespace().collect();
        columns.add(&row, &mut points).ok_or_else(|| {
            OpenError::line(
                file,
                index + 1,
                "a field is not a number",
                "correct or delete the line",
            )
        })?;
    }
    if points.places_m.len() < vertices {
        let what = format!("only {} of {vertices} vertices are present", points.places_m.len());
        return Err(OpenError::file(file, what, "write it again"));
    }
    Ok(points)
}

/// Returns the first line and, if there are several points, the stations. Coordinates are degrees (RFC 7946), or metres if any is
/// too large for degrees.
fn geojson(file: &str, text: &str) -> Result<WayFile, OpenError> {
    let value: Value = serde_json::from_str(text).map_err(|error| {
        OpenError::line(file, error.line(), "not valid JSON".to_owned(), "correct the line")
    })?;
    let (mut line, mut points) = (Vec::new(), Vec::new());
    gather(&value, &mut line, &mut points);
    if line.is_empty() {
        return Err(OpenError::file(file, "no LineString in this file", FORMATS));
    }
    let is_degrees = |at: &[f64; 3]| at[0].abs() <= 180.0 && at[1].abs() <= 90.0;
    // More points are landmarks.
    let are_stations = (2..=MOST_STATIONS).contains(&points.len());
    let stations: PerStation<[f64; 3]> = points.iter().copied().filter(|_| are_stations).collect();
    if !line.iter().chain(&points).all(is_degrees) {
        let level = |at: &[f64; 3]| Vector2::new(at[0], at[1]);
        let places_m = line.iter().map(level).collect();
        let found = along(file, Points { places_m, ..Points::default() })?;
        let height = |at: &[f64; 3]| Some(at[2]).filter(|height| height.is_finite());
        let stations_m = stations.map(|at| (level(at), height(at)));
        return Ok(WayFile { stations_m, ..found });
    }
    if stations.is_empty() {
        let what = format!(
            "the stations are missing: coordinates are in degrees, and the file has {} Points instead of 2 to {MOST_STATIONS}",
            points.len()
        );
        let remedy = "add stations 1, 2, … as Points, or give metres in the plan's frame";
        return Err(OpenError::file(file, what, remedy));
    }
    let local = |at: &[f64; 3]| local_m(&stations[Station::FIRST], at);
    let places_m = line.iter().map(|at| local(at).xy()).collect();
    let found = along(file, Points { places_m, ..Points::default() })?;
    let heights = stations.iter().all(|at| at[2].is_finite());
    let stations_m = stations.map(|at| {
        let place_m = local(at);
        (place_m.xy(), heights.then_some(place_m.z))
    });
    Ok(WayFile { stations_m, ..found })
}

/// Returns the position of a place relative to an origin, east, north, up (m). Places are (longitude, latitude, height); degrees, m.
fn local_m(origin: &[f64; 3], place: &[f64; 3]) -> Vector3<f64> {
    let geodetic = |[longitude, latitude, height_m]: &[f64; 3]| Geodetic {
        latitude_rad: latitude.to_radians(),
        longitude_rad: longitude.to_radians(),
        height_m: if height_m.is_finite() { *height_m } else { 0.0 },
    };
    let from = geodetic(origin);
    let away_m = geodetic(place).to_ecef() - from.to_ecef();
    let east = Vector3::new(-from.longitude_rad.sin(), from.longitude_rad.cos(), 0.0);
    let up = Rotation3::from_axis_angle(&Vector3::z_axis(), from.longitude_rad)
        * Vector3::new(from.latitude_rad.cos(), 0.0, from.latitude_rad.sin());
    Vector3::new(east.dot(&away_m), up.cross(&east).dot(&away_m), up.dot(&away_m))
}

/// Collects the first line and all points of a document at any depth; a missing height is NaN.
fn gather(value: &Value, line: &mut Vec<[f64; 3]>, points: &mut Vec<[f64; 3]>) {
    let place = |value: &Value| -> Option<[f64; 3]> {
        let at = value.as_array()?;
        let number = |k: usize| at.get(k).and_then(Value::as_f64);
        Some([number(0)?, number(1)?, number(2).unwrap_or(f64::NAN)])
    };
    let coordinates = value.get("coordinates").and_then(Value::as_array);
    match (value.get("type").and_then(Value::as_str), coordinates) {
        (Some("LineString"), Some(all)) if line.is_empty() => {
            line.extend(all.iter().filter_map(place));
        }
        (Some("MultiLineString"), Some(all)) if line.is_empty() => {
            let first = all.first().and_then(Value::as_array);
            line.extend(first.into_iter().flatten().filter_map(place));
        }
        (Some("Point"), Some(_)) => points.extend(value.get("coordinates").and_then(place)),
        _ => {}
    }
    for key in ["features", "geometries"] {
        let all = value.get(key).and_then(Value::as_array);
        all.into_iter().flatten().for_each(|one| gather(one, line, points));
    }
    if let Some(geometry) = value.get("geometry") {
        gather(geometry, line, points);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn places(found: &WayFile) -> Vec<[f64; 2]> {
        found.waypoints.iter().map(|at| [at.x_m, at.y_m]).collect()
    }

    #[test]
    fn tables_and_clouds_are_driven_in_their_order() {
        let table = "# from a planner\nid;Y;X;speed\n1;2.5;1;0.4\n2;-3;10;0.9\n";
        let found = parse("way.csv", table).expect("a way");
        assert_eq!(places(&found), [[1.0, 2.5], [10.0, -3.0]]);
        assert_eq!(found.waypoints[1].speed_m_per_s, Some(0.9));
        let cloud = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n\
                     element face 0\nproperty list uchar int vertex_index\nend_header\n1 2 0\n4 6 0\n";
        let found = parse("way.ply", cloud).expect("a way");
        assert_eq!(places(&found), [[1.0, 2.0], [4.0, 6.0]]);
        // Ten metres at 0.5 m/s, with a stop of 20 s at the end.
        let timed: String = (0..=400)
            .map(|k| format!("{},{},0\n", f64::from(k) / 10.0, (f64::from(k) / 20.0).min(10.0)))
            .collect();
        let found = parse("way.csv", &format!("timestamp,x,y\n{timed}")).expect("a way");
        assert_eq!(found.waypoints.len(), 6);
        for at in &found.waypoints[1..] {
            assert!((at.speed_m_per_s.expect("known") - 0.5).abs() < 0.03, "{at:?}");
        }
        assert!((found.waypoints[5].stand_s - 20.0).abs() < 2.5, "{:?}", found.waypoints[5]);
    }

    #[test]
    fn degrees_become_metres_about_station_1() {
        let text = |points: &str| {
            format!(
                r#"{{"type":"FeatureCollection","features":[{points}
                {{"type":"Feature","geometry":{{"type":"LineString","coordinates":[[-71.2,46.8],[-71.2,46.801]]}}}}]}}"#
            )
        };
        let point = |at: &str| {
            format!(r#"{{"type":"Feature","geometry":{{"type":"Point","coordinates":[{at}]}}}},"#)
        };
        let stations = ["-71.2,46.8", "-71.1999,46.8", "-71.2,46.79995"].map(point).concat();
        let found = parse("site.geojson", &text(&stations)).expect("a way");
        // At this latitude, 0.001 degrees of latitude are 111.17 m.
        let north = found.waypoints[1].place_m();
        assert!((north - Vector2::new(0.0, 111.17)).norm() < 0.05, "{north}");
        let [first, second, _] = *found.stations_m.as_array().expect("three points");
        assert_eq!(first, (Vector2::zeros(), None));
        assert!((second.0 - Vector2::new(7.632, 0.0)).norm() < 0.02, "{second:?}");
        let error = parse("site.geojson", &text("")).expect_err("no stations");
        assert!(error.to_string().contains("add stations 1, 2, …"), "{error}");
        let metres = r#"{"type":"LineString","coordinates":[[310.0,20.0],[340.0,95.0]]}"#;
        assert_eq!(places(&parse("way.json", metres).expect("a way"))[1], [340.0, 95.0]);
    }

    #[test]
    fn what_is_no_way_is_told_with_its_line() {
        for (text, said) in [
            ("a,b\n1,2\n", "way:1: the header `a,b` has no x and y"),
            ("x,y\n1,2\n3,four\n", "way:3: a field is not a number"),
            ("x,y\n1,2\n", "no path of at least two points"),
            ("ply\nformat binary_little_endian 1.0\nend_header\n", "way:2: a binary PLY"),
            (
                "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nend_header\n1 2\n",
                "1 of 3 vertices",
            ),
            ("{\"type\":\n", "way:2: not valid JSON"),
            ("{}", "no LineString"),
        ] {
            let error = parse("way", text).expect_err(said).to_string();
            assert!(error.contains(said), "{error} instead of {said}");
        }
    }
}
