//! Coordinates of control points in a separate frame (a map, a local grid): `file,marker_number,x_m,y_m,z_m`.
//!
//! A marker number is unique within its own file only, so each line names the file with the readings. The frame is right-handed
//! with z up.

use nalgebra::Vector3;

use crate::error::OpenError;

pub const COLUMNS: [&str; 5] = ["file", "marker_number", "x_m", "y_m", "z_m"];

#[derive(Clone, Debug, PartialEq, serde::Deserialize)]
pub struct SurveyedPoint {
    /// File with the readings, relative to the folder.
    pub file: String,
    pub marker_number: i64,
    x_m: f64,
    y_m: f64,
    z_m: f64,
}

impl SurveyedPoint {
    pub fn position_m(&self) -> Vector3<f64> {
        Vector3::new(self.x_m, self.y_m, self.z_m)
    }
}

pub fn read(file: &str, text: &str) -> Result<Vec<SurveyedPoint>, OpenError> {
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_bytes());
    let mut points: Vec<SurveyedPoint> = Vec::new();
    for (index, row) in reader.deserialize().enumerate() {
        let point: SurveyedPoint = row.map_err(|error| {
            let line = error.position().map_or(index + 2, |position| position.line() as usize);
            let what = error.to_string().lines().next().unwrap_or_default().to_owned();
            OpenError::line(file, line, what, format!("columns are {}", COLUMNS.join(",")))
        })?;
        let place = index + 2;
        if !point.position_m().iter().all(|value| value.is_finite()) {
            return Err(OpenError::line(
                file,
                place,
                "not a coordinate",
                "correct or delete the line",
            ));
        }
        let same = |other: &SurveyedPoint| {
            (&other.file, other.marker_number) == (&point.file, point.marker_number)
        };
        if points.iter().any(same) {
            let what = format!("marker {} of {} is listed twice", point.marker_number, point.file);
            return Err(OpenError::line(file, place, what, "keep one of the lines"));
        }
        points.push(point);
    }
    Ok(points)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_are_read_and_mistakes_said() {
        let text = "file,marker_number,x_m,y_m,z_m\nGCP_raw_1.txt, 3, 10.5, -2, 0.25\n";
        let points = read("map.csv", text).expect("good");
        assert_eq!(points[0].position_m(), Vector3::new(10.5, -2.0, 0.25));
        let twice = format!("{text}GCP_raw_1.txt,3,1,2,3\n");
        let error = read("map.csv", &twice).expect_err("twice").to_string();
        assert!(error.starts_with("map.csv:3: marker 3"), "{error}");
        let error =
            read("map.csv", &format!("{text}GCP_raw_1.txt,4,oops,2,3\n")).expect_err("text");
        assert!(error.to_string().starts_with("map.csv:3: "), "{error}");
    }
}
