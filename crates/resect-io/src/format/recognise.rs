//! Recognition of formats by content.

use super::format::{Format, SESSION_KEY};
use super::text_encoding::decode;
use super::{
    applied_transforms, bag, bonn_csv, cartesian_tracks, control_points, estimate, gsi, jobxml,
    mapped_csv, pillars, polar_csv, rig_files, rtklib_pos, surveyed_points, table,
};
use resect_core::network::Pair;

/// Recognises a file by its first bytes; a few hundred suffice. Only TOML files are recognised by `file_name`, without folder.
pub fn recognise(file_name: &str, head: &[u8]) -> Format {
    match file_name {
        "deployment.toml" => return Format::DeploymentToml,
        "truth.toml" => {
            return Format::Ignored("ground truth of a simulation: not used for calibration");
        }
        _ => {}
    }
    if let Some(format) = bag::recognise(head) {
        return format;
    }
    let text = decode(head);
    let text = &*text;
    if rtklib_pos::looks_like(text) {
        return Format::RtklibPos;
    }
    let mut lines = text.lines().filter(|line| !line.trim().is_empty());
    let Some(first) = lines.next() else {
        return Format::Ignored("empty");
    };
    if first.starts_with("version https://git-lfs") {
        return Format::Ignored("a Git LFS pointer, not the file itself: run `git lfs pull`");
    }
    if first.starts_with(SESSION_KEY) {
        return Format::Ignored("a session: open it with `resect FILE`");
    }
    let has_header = |columns: &[&str]| {
        table::header_line(text, |line| table::header_has(line, columns)).is_some()
    };
    if jobxml::looks_like(text) {
        Format::JobXml
    } else if gsi::looks_like(first) {
        Format::Gsi
    } else if has_header(&polar_csv::COLUMNS) {
        Format::PolarCsv
    } else if has_header(&bonn_csv::COLUMNS) {
        Format::BonnCsv
    } else if has_header(&control_points::COLUMNS[..2]) {
        Format::ControlPoints
    } else if has_header(&pillars::COLUMNS) {
        Format::Pillars
    } else if has_header(&surveyed_points::COLUMNS) {
        Format::SurveyedPoints
    } else if !is_applied_transforms(first) && estimate::looks_like(text) {
        Format::Estimate
    } else if mapped_csv::looks_like(text) {
        Format::UnknownTable
    } else {
        match (numeric_fields(first), lines.next()) {
            (Some(15), Some(_)) => Format::RigReading,
            (Some(4), _) if cartesian_tracks::evenly_spaced(text) => {
                Format::Ignored("positions at equal time steps: interpolated, not measured")
            }
            (Some(4), _) => Format::CartesianTrack,
            _ if is_applied_transforms(first) => Format::AppliedTransforms,
            (Some(13), _) if rig_files::is_sensor_position(first) => Format::SensorPositions,
            (Some(numbers), None) if are_distances(numbers) => Format::RigDistances,
            _ => Format::Ignored("not recognised"),
        }
    }
}

/// Returns true if a line is a transform applied to Cartesian tracks, which has as many numbers as a pose of KITTI.
fn is_applied_transforms(line: &str) -> bool {
    numeric_fields(line) == Some(applied_transforms::FIELDS) && applied_transforms::looks_like(line)
}

/// Returns true if three or more prisms have this number of distances, alone or with those of three antennas.
fn are_distances(numbers: usize) -> bool {
    let counts = [numbers, numbers.saturating_sub(3)];
    counts.into_iter().filter_map(Pair::prisms_of).any(|prisms| prisms > 2)
}

/// Returns the number of white-space separated fields, if all are numbers.
fn numeric_fields(line: &str) -> Option<usize> {
    let fields: Vec<_> = line.split_whitespace().collect();
    fields.iter().all(|field| field.parse::<f64>().is_ok()).then_some(fields.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_told_apart_by_content() {
        let polar = b"timestamp,id,distance,ha,va\n1,1,2,3,1.5\n";
        assert_eq!(recognise("anything.txt", polar), Format::PolarCsv);
        assert_eq!(recognise("x", b"timestamp;id;distance;ha;va\n"), Format::PolarCsv);
        assert_eq!(
            recognise("x", b"theodolite_number , marker_number , status\n"),
            Format::ControlPoints
        );
        for numbers in [3, 6, 9, 10, 13, 15, 18, 21, 24, 28, 31] {
            let line = "0.7 ".repeat(numbers) + "\n";
            assert_eq!(recognise("x", line.as_bytes()), Format::RigDistances, "{numbers}");
        }
        assert_eq!(recognise("x", b"#ROSBAG V2.0\n"), Format::Ros1Bag);
        assert_eq!(recognise("x", b""), Format::Ignored("empty"));
        assert_eq!(recognise("x.csv", b"1657 1.0 2.0 3.0\n"), Format::CartesianTrack);
        assert!(matches!(
            recognise("notes.txt", b"it rained\n"),
            Format::Ignored("not recognised")
        ));
    }
}
