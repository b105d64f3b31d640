//! Columns of a table of poses: by the names in a header, or by a fixed layout without one.

use std::borrow::Cow;

use super::column_units::{length_unit_m, without_unit};
use super::orientation_columns::{OrientationColumns, named_orientation, unread_columns};
use super::pose_covariance::CovarianceColumns;
use super::pose_stamps::TimeColumns;
use super::table::{self, number};

/// Indices of the columns of a pose.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseColumns {
    pub time: TimeColumns,
    /// x and y, or east and north.
    pub position: [usize; 2],
    /// z, or the height; `None` for poses in a plane.
    pub height: Option<usize>,
    /// Unit of each coordinate (m), negative for a depth.
    pub length_m: [f64; 3],
    pub orientation: Option<OrientationColumns>,
    pub covariance: Option<CovarianceColumns>,
    /// Meaning of columns that their names leave open, with the names that would state it.
    pub guesses: Vec<&'static str>,
    /// Names of columns of an orientation or covariance that are not read.
    pub unread: Vec<String>,
}

const POSITION: [&str; 13] = [
    "",
    "t",
    "p",
    "p_",
    "t_",
    "pos_",
    "position_",
    "translation_",
    "p_rs_r_",
    "pose_position_",
    "pose_pose_position_",
    "transform_translation_",
    "point_",
];
/// Returns true if a header names time and position.
pub fn is_header(header: &str) -> bool {
    let Ok(fields) = table::fields(header, table::separator(header)) else { return false };
    let names: Vec<String> = fields.iter().map(|name| without_unit(name)).collect();
    let headers: Vec<&str> = fields.iter().map(AsRef::as_ref).collect();
    // One with a unit that is not read is a header too.
    !matches!(TimeColumns::named(&headers), Ok(None)) && position_columns(&names).is_some()
}

const NO_HEIGHT: &str =
    "no column is z, so all poses are in the plane z = 0; name a column z if there is one";

/// Names of heights beside x and y or map coordinates, and of depths.
const HEIGHTS: [&str; 7] = ["elevation", "height", "up", "altitude", "u", "h", "z"];
const DEPTHS: [&str; 3] = ["down", "depth", "d"];

/// Columns of a position: x and y, and the height if there is one.
type CoordinateColumns = ([usize; 2], Option<usize>);

fn position_columns(names: &[String]) -> Option<CoordinateColumns> {
    let find = |wanted: &str| names.iter().position(|name| name == wanted);
    // Without a height, the names of x and y alone decide, so those with one come first.
    let columns = |prefixes: &[&str]| {
        let all = prefixes.iter().filter_map(|prefix| {
            let axis = |axis: &str| find(&format!("{prefix}{axis}"));
            Some(([axis("x")?, axis("y")?], axis("z")))
        });
        let all: Vec<CoordinateColumns> = all.collect();
        all.iter().find(|(_, height)| height.is_some()).or(all.first()).copied()
    };
    // Beside w, plain letters are a quaternion if another name is a position.
    let is_quaternion = names.iter().any(|name| name == "w");
    let with_prefix = is_quaternion.then(|| columns(&POSITION[1..])).flatten();
    let by_letters = with_prefix.or_else(|| columns(&POSITION));
    let (position, height) = by_letters.or_else(|| Some((map_coordinates(names)?, None)))?;
    let vertical = || HEIGHTS.into_iter().chain(DEPTHS).find_map(find);
    Some((position, height.or_else(vertical)))
}

/// Returns the columns of map coordinates: east and north.
fn map_coordinates(names: &[String]) -> Option<[usize; 2]> {
    const EAST_NORTH: [[&str; 2]; 3] = [["easting", "northing"], ["east", "north"], ["e", "n"]];
    let find = |wanted: &str| names.iter().position(|name| name == wanted);
    EAST_NORTH.into_iter().find_map(|[east, north]| Some([find(east)?, find(north)?]))
}

/// Returns the columns by the names in a header; `None` without time or position.
///
/// # Errors
/// If a name states a unit that is not read.
pub fn named(header: &str) -> Result<Option<PoseColumns>, String> {
    let fields = table::fields(header, table::separator(header))?;
    let headers: Vec<&str> = fields.iter().map(AsRef::as_ref).collect();
    let names: Vec<String> = headers.iter().map(|name| without_unit(name)).collect();
    let (Some(time), Some((position, height))) =
        (TimeColumns::named(&headers)?, position_columns(&names))
    else {
        return Ok(None);
    };
    let coordinates: Vec<usize> = position.into_iter().chain(height).collect();
    let mut length_m = [1.0; 3];
    for (length_m, column) in length_m.iter_mut().zip(&coordinates) {
        let is_depth = DEPTHS.contains(&&*names[*column]);
        *length_m = length_unit_m(headers[*column])? * if is_depth { -1.0 } else { 1.0 };
    }
    let has_position = |column| coordinates.contains(&column);
    let orientation = named_orientation(&names, &headers, &has_position, height.is_none())?;
    let mut guesses: Vec<&'static str> =
        if height.is_none() { vec![NO_HEIGHT] } else { Vec::new() };
    let orientation = orientation.map(|named| {
        guesses.extend(named.guess);
        named.columns
    });
    let find = |wanted: &str| names.iter().position(|name| name == wanted);
    let covariance =
        CovarianceColumns::named(&find).map(|columns| columns.with_units(&headers)).transpose()?;
    let mut used = time.indices();
    used.extend(coordinates);
    used.extend(orientation.iter().flat_map(OrientationColumns::indices));
    used.extend(covariance.iter().flat_map(CovarianceColumns::indices));
    let unread = unread_columns(&headers, &names, &used, orientation.is_some());
    Ok(Some(PoseColumns {
        time,
        position,
        height,
        length_m,
        orientation,
        covariance,
        guesses,
        unread,
    }))
}

/// Returns the columns of a row without a header, and the name of the layout unless it is TUM's or positions.
pub fn without_header(
    fields: &[Cow<'_, str>],
    separator: char,
) -> Result<(PoseColumns, Option<&'static str>), String> {
    let numbers: Vec<Option<f64>> =
        fields.iter().map(|field| number(field, separator != ',').ok()).collect();
    let columns_from = |time, first: usize, quaternion: Option<[usize; 4]>| PoseColumns {
        time,
        position: [first, first + 1],
        height: Some(first + 2),
        length_m: [1.0; 3],
        orientation: quaternion.map(OrientationColumns::Quaternion),
        covariance: None,
        guesses: Vec::new(),
        unread: Vec::new(),
    };
    let single = TimeColumns::One(0, None);
    let pair = TimeColumns::SecondsAndNanoseconds(0, 1);
    let is_text = |index: usize| numbers.get(index).is_some_and(Option::is_none);
    let are_numbers =
        |from: usize| numbers.len() > from && numbers[from..].iter().all(Option::is_some);
    let is_nanoseconds = numbers.first().copied().flatten().is_some_and(|t| t.abs() > 1e15);
    let count = match fields.last() {
        Some(last) if last.is_empty() => fields.len() - 1,
        _ => fields.len(),
    };
    let quaternion_from = |first: usize| Some([first, first + 1, first + 2, first + 3]);
    Ok(match count {
        8 | 17 if separator == ',' && is_nanoseconds && are_numbers(1) => (
            columns_from(single, 1, Some([5, 6, 7, 4])),
            Some("EuRoC: time, x, y, z, qw, qx, qy, qz"),
        ),
        8 if are_numbers(1) => (columns_from(single, 1, quaternion_from(4)), None),
        4 if are_numbers(1) => (columns_from(single, 1, None), None),
        10.. if separator == ',' && is_text(2) && !is_text(3) => (
            columns_from(pair, 3, quaternion_from(6)),
            Some("ros2 topic echo --csv: sec, nanosec, frame, pose"),
        ),
        11.. if separator == ',' && is_text(2) && is_text(3) => (
            columns_from(pair, 4, quaternion_from(7)),
            Some("ros2 topic echo --csv: sec, nanosec, frames, pose"),
        ),
        6 if separator == ',' && is_text(2) && !is_text(3) => {
            (columns_from(pair, 3, None), Some("ros2 topic echo --csv: sec, nanosec, frame, point"))
        }
        _ if is_text(0) => {
            return Err(format!(
                "the header `{}` has no columns of poses",
                shown_row(fields, separator)
            ));
        }
        count => return Err(format!("{count} fields without a header do not form a pose")),
    })
}

fn shown_row(fields: &[Cow<'_, str>], separator: char) -> String {
    table::shown(&fields.join(&separator.to_string()))
}
