//! Leica GSI-8 and GSI-16: readings of points by one instrument.
//!
//! The format is described in the manuals of the instruments ("Data format" in the TPS1100 user manual 2.2.1) and, unit by unit, in
//! the package geocompy (MIT). A line is a block of words of 15 or 23 characters: word index in columns 1–2, unit in column 6, a
//! sign, 8 or 16 characters. A line of GSI-16 begins with `*`. The words read are 11 (point), 21 (Hz), 22 (V), 31 (slope distance),
//! 51 and 58 (prism constant), 81–83 (coordinates) and 84–86 (station).
//!
//! The instrument stores the corrected slope distance, which includes the prism constant of its setting (`31` beside `51`: applied
//! ppm and mm), so nothing is added to it here. V is read as a zenith angle, the instruments' default. Feet are international feet.
//! Code lines (41) are skipped.
//!
//! Written from these documents and tested on the public jobs of totalopenstation and geocompy, one of which is a single line without
//! line ends. Not tested on a calibration of three stations. The finest stamps are whole seconds, so such a file cannot be a track.

use crate::findings::surveys::{
    survey_other_set_ups, survey_prism_constant_included, survey_readings_incomplete,
};
use resect_core::geometry::FOOT_M;
use std::f64::consts::TAU;

use nalgebra::Vector3;

use super::survey::{Sighting, Survey};
use crate::error::OpenError;
use resect_core::geometry::Polar;

/// Returns true if a line is a block of words.
pub fn looks_like(line: &str) -> bool {
    let line = line.trim_start().as_bytes();
    let block = line.strip_prefix(b"*").unwrap_or(line);
    (block.starts_with(b"11") || block.starts_with(b"41"))
        && block.len() >= 15
        && matches!(block[6], b'+' | b'-')
        && block[2..6].iter().all(|byte| byte.is_ascii_digit() || *byte == b'.')
}

/// The words of one point.
#[derive(Default)]
struct Block<'a> {
    point: Option<&'a str>,
    azimuth_rad: Option<f64>,
    zenith_rad: Option<f64>,
    range_m: Option<f64>,
    constant_m: Option<f64>,
    /// East, north, height of the point, and of the station.
    coordinates_m: [Option<f64>; 3],
    station_m: [Option<f64>; 3],
}

/// Reads all readings, and coordinates of points without a reading.
pub fn read(file: &str, text: &str) -> Result<Survey, OpenError> {
    let mut survey = Survey::default();
    let mut constants_m: Vec<f64> = Vec::new();
    let mut station_m: Option<[Option<f64>; 3]> = None;
    let (mut of_other_set_ups, mut without_range) = (0, 0);
    let mut all: Vec<Block<'_>> = Vec::new();
    for (index, line) in text.lines().enumerate() {
        if !looks_like(line) {
            continue;
        }
        let blocks = blocks(line.trim()).map_err(|what| {
            OpenError::line(file, index + 1, what, "export the job again, as GSI-8 or GSI-16")
        })?;
        all.extend(blocks);
    }
    for block in &all {
        let Some(point) = block.point else { continue };
        // A set-up writes its coordinates on a separate line, or on every line.
        if block.station_m.iter().any(Option::is_some) {
            match station_m {
                None => station_m = Some(block.station_m),
                Some(first) if first != block.station_m => {
                    of_other_set_ups += 1;
                    continue;
                }
                Some(_) => {}
            }
        } else if of_other_set_ups > 0 {
            of_other_set_ups += 1;
            continue;
        }
        match (block.azimuth_rad, block.zenith_rad, block.range_m, block.coordinates_m) {
            (Some(azimuth_rad), Some(zenith_rad), Some(range_m), _) => {
                constants_m.extend(block.constant_m);
                let polar = Polar { range_m, azimuth_rad, zenith_rad };
                survey.sightings.push(Sighting { point: point.to_owned(), polar, complete: true });
            }
            (Some(_), ..) | (_, Some(_), ..) => without_range += 1,
            (None, None, _, [Some(east), Some(north), Some(up)]) => {
                survey.coordinates.push((point.to_owned(), Vector3::new(east, north, up)));
            }
            _ => {}
        }
    }
    if of_other_set_ups > 0 {
        survey.findings.push(survey_other_set_ups(file, of_other_set_ups, "lines"));
    }
    if without_range > 0 {
        let missing = "a slope distance (word 31), or without an angle,";
        survey.findings.push(survey_readings_incomplete(file, without_range, missing));
    }
    if !survey.sightings.is_empty() {
        constants_m.sort_by(f64::total_cmp);
        constants_m.dedup();
        survey.findings.push(survey_prism_constant_included(file, &constants_m));
    }
    Ok(survey)
}

/// Splits a line into blocks: usually one; all of the job if a download lost its line ends.
fn blocks(line: &str) -> Result<Vec<Block<'_>>, String> {
    let (words, length) = match line.strip_prefix('*') {
        Some(words) => (words, 23),
        None => (line, 15),
    };
    let mut blocks: Vec<Block<'_>> = Vec::new();
    let mut rest = words;
    while !rest.is_empty() {
        // Names may contain characters of more than one byte.
        let end = rest.char_indices().map(|(at, _)| at).chain([rest.len()]).nth(length);
        // A number with a decimal point may be a digit shorter.
        let has_point = rest.get(7..).is_some_and(|data| data.contains('.') && !data.contains(' '));
        let end = end.or(has_point.then_some(rest.len()));
        let end = end.ok_or_else(|| format!("the word `{rest}` is cut short"))?;
        let word = &rest[..end];
        rest = rest[end..].trim_start();
        rest = rest.strip_prefix('*').unwrap_or(rest);
        let parts =
            word.get(..2).zip(word.get(6..)).filter(|(_, data)| data.starts_with(['+', '-']));
        let Some((index, data)) = parts else { return Err(format!("`{word}` is not a word")) };
        let unit = word.as_bytes()[5];
        let length_m = || length_m(data, unit).ok_or_else(|| format!("`{word}` is not a length"));
        let angle_rad = || angle_rad(data, unit).ok_or_else(|| format!("`{word}` is not an angle"));
        if matches!(index, "11" | "41") || blocks.is_empty() {
            blocks.push(Block::default());
        }
        let block = blocks.last_mut().expect("there is one");
        match index {
            "11" => block.point = Some(name(data)),
            "21" => block.azimuth_rad = Some(angle_rad()?),
            "22" => block.zenith_rad = Some(angle_rad()?),
            "31" => block.range_m = Some(length_m()?),
            // Ppm, then millimetres as a sign and three digits.
            "51" => {
                let millimetres = data.get(data.len() - 4..).and_then(|mm| mm.parse::<f64>().ok());
                let mm = millimetres.ok_or_else(|| format!("`{word}` is not ppm and mm"))?;
                block.constant_m = Some(mm * 1e-3);
            }
            "58" => block.constant_m = Some(length_m()?),
            "81" => block.coordinates_m[0] = Some(length_m()?),
            "82" => block.coordinates_m[1] = Some(length_m()?),
            "83" => block.coordinates_m[2] = Some(length_m()?),
            "84" => block.station_m[0] = Some(length_m()?),
            "85" => block.station_m[1] = Some(length_m()?),
            "86" => block.station_m[2] = Some(length_m()?),
            _ => {}
        }
    }
    Ok(blocks)
}

/// Returns a name without its leading zeros.
fn name(data: &str) -> &str {
    let name = data[1..].trim().trim_start_matches('0');
    if name.is_empty() { "0" } else { name }
}

/// Parses a sign and digits.
fn whole(data: &str) -> Option<f64> {
    data[1..].bytes().all(|byte| byte.is_ascii_digit()).then(|| data.parse().ok())?
}

fn length_m(data: &str, unit: u8) -> Option<f64> {
    // Office software writes a decimal point, although the format has none.
    if data.contains('.') {
        let is_feet = matches!(unit, b'1' | b'7');
        return Some(data.trim_end().parse::<f64>().ok()? * if is_feet { FOOT_M } else { 1.0 });
    }
    let last_digit_m = match unit {
        b'0' => 1e-3,
        b'1' => 1e-3 * FOOT_M,
        b'6' => 1e-4,
        b'7' => 1e-4 * FOOT_M,
        b'8' => 1e-5,
        _ => return None,
    };
    Some(whole(data)? * last_digit_m)
}

fn angle_rad(data: &str, unit: u8) -> Option<f64> {
    let value = whole(data)?;
    let turns = match unit {
        b'2' => value * 1e-5 / 400.0,
        b'3' => value * 1e-5 / 360.0,
        b'4' => {
            let (degrees, rest) = ((value.abs() / 1e5).floor(), value.abs() % 1e5);
            let (minutes, seconds) = ((rest / 1e3).floor(), rest % 1e3 / 10.0);
            value.signum() * (degrees + minutes / 60.0 + seconds / 3600.0) / 360.0
        }
        b'5' => value * 1e-4 / 6400.0,
        _ => return None,
    };
    Some(turns * TAU)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::findings::kinds;

    #[test]
    fn coordinates_with_a_decimal_point_are_read_as_written() {
        let line = "*110099+00000000STATION1 81..06+0000008085.8440 82..06+0000000100.0000 83..06+0000000010.5000 \r\n";
        let survey = read("a.gsi", line).expect("good");
        assert_eq!(survey.coordinates[0].1, Vector3::new(8085.844, 100.0, 10.5));
    }

    #[test]
    fn both_lengths_of_words_are_read() {
        let text = "410001+0000CODE 42....+00000001\n\
            110002+00000P01 21.324+35545100 22.324+09117510 31..00+00013825 51....+0017-034\n\
            110003+00000P02 21.322+10000000 22.322+05000000 31..06+00138250 58..06+00000100\n\
            110004+00000P03 21.322+10000000 22.322+05000000\n\
            *110005+0000000000000P04 21.022+0000000020000000 22.022+0000000010000000 31..08+0000000001382511\n";
        let survey = read("a.gsi", text).expect("good");
        let [p1, p2, p4] = &survey.sightings[..] else { panic!("{survey:?}") };
        assert_eq!([p1, p2, p4].map(|s| s.point.as_str()), ["P01", "P02", "P04"]);
        let degrees = |p: &Sighting| [p.polar.azimuth_rad, p.polar.zenith_rad].map(f64::to_degrees);
        let near = |found: [f64; 2], expected: [f64; 2]| {
            assert!(
                (0..2).all(|i| (found[i] - expected[i]).abs() < 1e-9),
                "{found:?} {expected:?}"
            );
        };
        // 355°45'10.0" and 91°17'51.0".
        near(
            degrees(p1),
            [355.0 + 45.0 / 60.0 + 10.0 / 3600.0, 91.0 + 17.0 / 60.0 + 51.0 / 3600.0],
        );
        near(degrees(p2), [90.0, 45.0]);
        near(degrees(p4), [180.0, 90.0]);
        for (sighting, range_m) in [(p1, 13.825), (p2, 13.825), (p4, 13.82511)] {
            assert!((sighting.polar.range_m - range_m).abs() < 1e-12 && sighting.complete);
        }
        let said: Vec<String> = survey.findings.iter().map(ToString::to_string).collect();
        assert!(said[0].contains("1 readings without a slope distance"), "{said:?}");
        assert!(
            said[1].contains("-34.0, +10.0 mm") && said[1].contains("nothing is added"),
            "{said:?}"
        );
    }

    #[test]
    fn a_job_without_ends_of_lines_is_read_block_by_block() {
        let words = |point: usize| {
            format!(
                "11{point:04}+{point:08} 21.102+1000000{point} 22.102+10000000 31..00+00001000 "
            )
        };
        let survey = read("a.gsi", &(1..4).map(words).collect::<String>()).expect("good");
        let points: Vec<&str> = survey.sightings.iter().map(|s| s.point.as_str()).collect();
        assert_eq!(points, ["1", "2", "3"]);
    }

    #[test]
    fn units_of_the_format() {
        for (unit, expected_m) in [
            (b'0', 12.345),
            (b'1', 12.345 * 0.3048),
            (b'6', 1.2345),
            (b'7', 1.2345 * 0.3048),
            (b'8', 0.12345),
        ] {
            let found = length_m("+00012345", unit).expect("a length");
            assert!((found - expected_m).abs() < 1e-12, "{unit}");
        }
        for (unit, degrees) in [(b'2', 90.0), (b'3', 100.0), (b'4', 100.0), (b'5', 56.25)] {
            let found = angle_rad("+10000000", unit).expect("an angle").to_degrees();
            assert!((found - degrees).abs() < 1e-9, "{unit}: {found}");
        }
        assert_eq!(length_m("+00012345", b'2'), None);
        assert_eq!(length_m("+000x2345", b'0'), None);
    }

    #[test]
    fn only_the_first_set_up_counts_and_coordinates_stand_alone() {
        let text = "110001+0000000A 81..00+00001000 82..00-00002000 83..00+00000500\n\
            110002+000000S1 84..00+00000000 85..00+00000000 86..00+00000000\n\
            110003+0000000A 21.322+10000000 22.322+10000000 31..00+00010000\n\
            110004+000000S2 84..00+00005000 85..00+00000000 86..00+00000000\n\
            110005+0000000A 21.322+00000000 22.322+10000000 31..00+00009000\n";
        let survey = read("a.gsi", text).expect("good");
        assert_eq!(survey.coordinates, [("A".to_owned(), Vector3::new(1.0, -2.0, 0.5))]);
        assert_eq!(survey.sightings.len(), 1);
        assert_eq!(survey.findings[0].kind, kinds::SURVEY_OTHER_SET_UPS);
        assert_eq!(survey.findings[0].value("readings"), Some(2.0));
    }

    #[test]
    fn mistakes_say_where() {
        for (text, expected) in [
            ("110001+0000000A 21.322+1000", "a.gsi:1: the word `21.322+1000` is cut short"),
            ("110001+0000000A 31..09+00010000", "a.gsi:1: `31..09+00010000` is not a length"),
            ("110001+0000000A 21.3é+0000000 ", "a.gsi:1: the word"),
            ("110001+0000000A 21.322x10000000", "a.gsi:1: `21.322x10000000` is not a word"),
        ] {
            let error = read("a.gsi", text).expect_err(expected).to_string();
            assert!(error.starts_with(expected), "{error}");
        }
        assert!(!looks_like("11 0.7 0.9 1.0 1.1 1.2"));
        assert!(!looks_like("1657569001.5 1 2 3"));
    }
}
