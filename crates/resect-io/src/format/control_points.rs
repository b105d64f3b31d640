//! Control points in the format of the authors' tools: one line for each station and marker.
//!
//! The column named `elevation` is a zenith angle; distances lack the prism constant. The stamps are not read, because the
//! clocks of the stations are not comparable.

use resect_core::network::{Number, PerStation, Station};
use std::collections::BTreeMap;

use super::survey::{SAME_POINT_M, mean};
use super::table;
use crate::error::OpenError;
use crate::findings::control_points::{
    ReadingPlace, control_point_reading_implausible, control_point_repeated,
    control_point_station_unknown, control_point_status_invalid,
};
use crate::findings::tracks::rows_skipped;
use crate::recording::station_index;
use resect_core::deployment::{ControlPoint, ControlPointSet, Finding};
use resect_core::geometry::Polar;
use resect_core::progress::Progress;

pub const COLUMNS: [&str; 6] =
    ["theodolite_number", "marker_number", "status", "elevation", "azimuth", "distance"];

/// Reads the points of one file, and adds the station's prism constant to every range. A reading is the mean of both faces, if there are
/// both.
pub fn read(
    file: &str,
    text: &str,
    prism_constants_m: &PerStation<f64>,
) -> Result<(ControlPointSet, Vec<Finding>), OpenError> {
    let mut points: Vec<ControlPoint> = Vec::new();
    let mut findings = Vec::new();
    // Readings in face left and in face right, by point and station.
    let mut by_face: BTreeMap<(usize, usize), [Option<Polar>; 2]> = BTreeMap::new();
    let mut rows = Vec::new();
    let skipped =
        table::for_each_row(file, text.as_bytes(), &COLUMNS, &Progress::default(), |row| {
            rows.push((row.whole(0, COLUMNS[0])?, row.whole(1, COLUMNS[1])?, row));
            Ok(())
        })?;
    findings.extend(rows_skipped(file, &skipped));
    for (number, marker, row) in rows {
        let [_, _, status, zenith_rad, azimuth_rad, distance_m] = row.values;
        let place = ReadingPlace { file, line: row.line, marker, number };
        let Some(station) = station_index(number) else {
            findings.push(control_point_station_unknown(&place));
            continue;
        };
        if status != 0.0 {
            findings.push(control_point_status_invalid(&place, status));
            continue;
        }
        let range_m = distance_m + prism_constants_m[station];
        let (polar, is_face_right) = Polar { range_m, azimuth_rad, zenith_rad }.in_face_left();
        if distance_m <= 0.0 || !polar.is_plausible() {
            findings.push(control_point_reading_implausible(&place));
            continue;
        }
        let index = points.iter().position(|p| p.marker == marker).unwrap_or_else(|| {
            points.push(ControlPoint::unread(marker, None));
            points.len() - 1
        });
        let faces = by_face.entry((index, station)).or_default();
        let other = faces[usize::from(!is_face_right)];
        let is_same_point = other.is_none_or(|other: Polar| {
            (other.to_cartesian() - polar.to_cartesian()).norm() < SAME_POINT_M
        });
        let face = &mut faces[usize::from(is_face_right)];
        if face.is_some() || !is_same_point {
            findings.push(control_point_repeated(&place));
        } else {
            *face = Some(polar);
        }
    }
    for ((index, station), faces) in by_face {
        let readings: Vec<Polar> = faces.into_iter().flatten().collect();
        let face_one = faces[0].filter(|_| faces[1].is_some());
        points[index].set_reading(Station::at(station), mean(&readings), face_one);
    }
    Ok((ControlPointSet { file: file.to_owned(), points, pillars: false }, findings))
}

/// Returns a text that [`read`] reads.
pub fn write(set: &ControlPointSet, prism_constant_m: f64) -> String {
    let mut text = COLUMNS.join(" , ") + " , sec , nsec\n";
    let stations = set.points.iter().map(ControlPoint::stations).max().unwrap_or_default();
    for station in (0..stations).map(Station::at) {
        for (order, point) in set.points.iter().enumerate() {
            let Some(Some(p)) = point.readings.get(station) else { continue };
            text += &format!(
                "{} , {} , 0 , {:.7} , {:.7} , {:.4} , {} , 0\n",
                station,
                point.marker,
                p.zenith_rad,
                p.azimuth_rad,
                p.range_m - prism_constant_m,
                30 * order,
            );
        }
    }
    text
}
