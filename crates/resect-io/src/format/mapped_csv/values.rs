//! Numbers, lengths, angles and station numbers in the fields of other programs' tables.
//!
//! An error completes a sentence that begins with the field: "is not a number".

use crate::format::table::{number, with_point};
use resect_core::geometry::{FOOT_M, US_SURVEY_FOOT_M};
use std::f64::consts::PI;

use resect_core::deployment::{TableAngle, TableLength};

/// Parses a length (m).
pub fn metres(field: &str, unit: TableLength, decimal_comma: bool) -> Result<f64, String> {
    let value = number(field, decimal_comma)?;
    Ok(match unit {
        TableLength::Metres => value,
        TableLength::Millimetres => value / 1e3,
        TableLength::Feet => value * FOOT_M,
        TableLength::UsSurveyFeet => value * US_SURVEY_FOOT_M,
    })
}

/// Parses an angle (rad).
pub fn angle_rad(field: &str, unit: TableAngle, decimal_comma: bool) -> Result<f64, String> {
    Ok(match unit {
        TableAngle::Radians => number(field, decimal_comma)?,
        TableAngle::Degrees => number(field, decimal_comma)?.to_radians(),
        TableAngle::Gon => number(field, decimal_comma)? * (PI / 200.0),
        TableAngle::DegreesMinutesSeconds => {
            sexagesimal_degrees(field, decimal_comma)?.to_radians()
        }
    })
}

/// Returns the degrees of `272°23'19.4"`, `272 23 19.4`, `-2-23-19.4`; minutes and seconds may be missing.
fn sexagesimal_degrees(field: &str, decimal_comma: bool) -> Result<f64, String> {
    let field = with_point(field.trim(), decimal_comma);
    if field.is_empty() {
        return Ok(f64::NAN);
    }
    let (sign, digits) = match field.strip_prefix('-') {
        Some(digits) => (-1.0, digits),
        None => (1.0, field.strip_prefix('+').unwrap_or(&field)),
    };
    let what = || "is not an angle in degrees, minutes and seconds".to_owned();
    let parts: Vec<_> = digits
        .split(|c: char| !c.is_ascii_digit() && c != '.')
        .filter(|part| !part.is_empty())
        .map(str::parse::<f64>)
        .collect::<Result<_, _>>()
        .map_err(|_| what())?;
    // A letter in between has another meaning, such as a hemisphere or an exponent.
    if parts.is_empty() || parts.len() > 3 || field.chars().any(|c| c.is_alphabetic() && c != 'º')
    {
        return Err(what());
    }
    if parts[1..].iter().any(|part| *part >= 60.0) {
        return Err("has minutes or seconds of 60 or more".to_owned());
    }
    let units = parts.iter().zip([1.0, 60.0, 3600.0]);
    Ok(sign * units.map(|(part, per_degree)| part / per_degree).sum::<f64>())
}

/// Returns a station's number: the field itself, or the digits at the end of a name.
pub fn station_number(field: &str) -> Option<i64> {
    let field = field.trim();
    if let Ok(value) = field.parse::<f64>() {
        return (value.fract() == 0.0 && value.abs() < 1e15).then_some(value as i64);
    }
    let name = field.trim_end_matches(|c: char| c.is_ascii_digit());
    field[name.len()..].parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_of_every_unit() {
        let dms = TableAngle::DegreesMinutesSeconds;
        let expected = (272.0 + 23.0 / 60.0 + 19.4 / 3600.0_f64).to_radians();
        for field in
            ["272°23'19.4\"", "272 23 19.4", "272-23-19.4", "272:23:19.4", "272° 23′ 19.4″"]
        {
            let value = angle_rad(field, dms, false).expect(field);
            assert!((value - expected).abs() < 1e-12, "{field}: {value}");
        }
        assert!((angle_rad("272 23 19,4", dms, true).expect("comma") - expected).abs() < 1e-12);
        assert!(
            (angle_rad("-0-30-0", dms, false).expect("below") + 0.5_f64.to_radians()).abs() < 1e-12
        );
        for wrong in ["272 23 61", "east", "1 2 3 4", "1e5", "1.2.3 4", "12N"] {
            assert!(angle_rad(wrong, dms, false).is_err(), "{wrong}");
        }
        assert!(
            (angle_rad("100", TableAngle::Gon, false).expect("plain") - PI / 2.0).abs() < 1e-15
        );
        assert!((angle_rad("180", TableAngle::Degrees, false).expect("plain") - PI).abs() < 1e-15);
        assert!(angle_rad("", dms, false).expect("no reading").is_nan());
    }

    #[test]
    fn lengths_stations_and_commas() {
        let survey = metres("3937", TableLength::UsSurveyFeet, false).expect("plain");
        assert!((survey - 1200.0).abs() < 1e-9);
        assert_eq!(metres("1000", TableLength::Feet, false), Ok(304.8));
        assert_eq!(metres("1500,5", TableLength::Millimetres, true), Ok(1.5005));
        assert!(number("1,5", false).is_err());
        for (field, expected) in
            [("2", Some(2)), ("2.0", Some(2)), ("RTS3", Some(3)), ("1.5", None), ("west", None)]
        {
            assert_eq!(station_number(field), expected, "{field}");
        }
    }
}
