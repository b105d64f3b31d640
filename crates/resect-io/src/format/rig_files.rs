//! The files that describe the prisms on the vehicle.

use nalgebra::Vector3;
use resect_core::network::{Pair, PerPair, PerPrism};

use crate::error::OpenError;
use resect_core::geometry::Polar;

/// Plausible distances between prisms (m): from a millimetre to the size of a ship.
pub const PLAUSIBLE_DISTANCE_M: std::ops::RangeInclusive<f64> = 1e-3..=100.0;

/// Reads `calibration_results.csv`: distances 12, 13, 23, 14, … between the prisms, then 12, 13, 23 between the GNSS antennas (m).
///
/// Six distances are those of three prisms and three antennas, unless four prisms are `stated`.
pub fn read_distances(
    file: &str,
    text: &str,
    stated: Option<usize>,
) -> Result<(PerPair<f64>, Option<[f64; 3]>), OpenError> {
    let values = numbers(file, 1, text)?;
    if let Some(bad) = values.iter().find(|v| !PLAUSIBLE_DISTANCE_M.contains(*v)) {
        return Err(OpenError::line(
            file,
            1,
            format!("{bad} is not a distance between prisms"),
            "distances are in metres, from 1 mm to 100 m",
        ));
    }
    let pairs = [stated, Some(3)].into_iter().flatten().map(Pair::count);
    let is_whole = |pairs: &usize| values.len() == *pairs || values.len() == *pairs + 3;
    let pairs = pairs.into_iter().find(is_whole).or_else(|| {
        let counts = [values.len(), values.len().saturating_sub(3)];
        counts.into_iter().find(|pairs| Pair::prisms_of(*pairs).is_some())
    });
    let Some(pairs) = pairs else {
        return Err(OpenError::line(
            file,
            1,
            format!("{} numbers", values.len()),
            "give the distances 12, 13, 23, 14, … of the prisms, then of the antennas, in metres",
        ));
    };
    let (prisms, antennas) = values.split_at(pairs);
    Ok((prisms.iter().copied().collect(), antennas.try_into().ok()))
}

/// Returns a text that [`read_distances`] reads.
pub fn write_distances(
    inter_prism_m: &PerPair<f64>,
    inter_antenna_m: Option<&PerPair<f64>>,
) -> String {
    let antennas_m = inter_antenna_m.into_iter().flatten();
    let all = inter_prism_m.iter().chain(antennas_m);
    all.map(|distance| format!("{distance:.6}")).collect::<Vec<_>>().join(" ") + "\n"
}

/// Reads `calibration_raw.csv`: one static station's readings of prisms 1, 2, … (then antennas and lidar).
///
/// Columns 0–2 are the horizontal angle in degrees, minutes, seconds, 6–8 the zenith angle, 12 the distance (m). There is
/// a prism constant (m) for each prism; further rows are not read. Returns the prisms' positions in that station's frame (m).
pub fn read_rig_reading(
    file: &str,
    text: &str,
    prism_constants_m: &PerPrism<f64>,
) -> Result<PerPrism<Vector3<f64>>, OpenError> {
    let mut prisms = Vec::new();
    let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    for (index, line) in lines.take(prism_constants_m.len()) {
        let values = numbers(file, index + 1, line)?;
        if values.len() < 13 {
            return Err(OpenError::line(
                file,
                index + 1,
                format!("{} columns, 13 or more needed", values.len()),
                "columns are horizontal angle d m s, its σ, zenith angle d m s, its σ, distance",
            ));
        }
        let angle_rad =
            |at: usize| (values[at] + values[at + 1] / 60.0 + values[at + 2] / 3600.0).to_radians();
        let polar = Polar {
            range_m: values[12] + prism_constants_m[prisms.len()],
            azimuth_rad: angle_rad(0),
            zenith_rad: angle_rad(6),
        };
        if !polar.is_plausible() {
            return Err(OpenError::line(
                file,
                index + 1,
                "not a reading of a prism (distance in m, zenith angle within 0..180°)",
                "correct the line",
            ));
        }
        prisms.push(polar.to_cartesian());
    }
    complete(file, prisms, prism_constants_m.len())
}

/// Returns the prisms if all are there.
fn complete(
    file: &str,
    prisms: Vec<Vector3<f64>>,
    needed: usize,
) -> Result<PerPrism<Vector3<f64>>, OpenError> {
    if prisms.len() == needed {
        return Ok(prisms.into_iter().collect());
    }
    let what = format!("{} rows, {needed} prisms needed", prisms.len());
    let remedy = "add the missing prisms, or give their number in deployment.toml: prisms = [1, 2]";
    Err(OpenError::file(file, what, remedy))
}

/// Returns true if a line of 13 numbers is a position with its covariance: the fourth is 1.
pub fn is_sensor_position(line: &str) -> bool {
    line.split_whitespace().nth(3).and_then(|field| field.parse().ok()) == Some(1.0)
}

/// Reads `sensor_positions.csv` of the authors' repository: x y z (m), 1, and the 3×3 covariance (m²) of prisms 1, 2, …, then GNSS
/// antennas and lidar. Returns the first `needed` ones, the prisms (m).
///
/// The authors' scripts compute it from `calibration_raw.csv`, so its frame is that of the static station that measured the rig (z
/// up), despite its name. The format does not state if the prism constant is included. On the run of 2022-07-11 it is not: the ranges
/// are those of the reading to the micrometre. This changes the distances between the prisms by a millimetre.
pub fn read_sensor_positions(
    file: &str,
    text: &str,
    needed: usize,
) -> Result<PerPrism<Vector3<f64>>, OpenError> {
    let mut prisms = Vec::new();
    let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    for (index, line) in lines.take(needed) {
        let values = numbers(file, index + 1, line)?;
        let position_m = values.get(..3).map(Vector3::from_column_slice);
        match position_m.filter(|p| p.iter().all(|value| value.is_finite())) {
            Some(position_m) => prisms.push(position_m),
            None => {
                let remedy =
                    "columns are x y z in metres, 1, and the nine elements of a covariance";
                return Err(OpenError::line(file, index + 1, "not a position", remedy));
            }
        }
    }
    complete(file, prisms, needed)
}

/// Returns a text that [`read_rig_reading`] reads, with angles to the second and distances to the millimetre, as a station
/// displays them.
pub fn write_rig_reading(prisms: &[Polar], prism_constant_m: f64) -> String {
    let mut text = String::new();
    for prism in prisms {
        let (azimuth, zenith) = (dms(prism.azimuth_rad), dms(prism.zenith_rad));
        let distance_m = prism.range_m - prism_constant_m;
        text += &format!("{azimuth} 0 00 01.000 {zenith} 0 00 01.000 {distance_m:.3} 0.0020 0\n");
    }
    text
}

fn dms(angle_rad: f64) -> String {
    let seconds = (angle_rad.to_degrees().rem_euclid(360.0) * 3600.0).round() as i64;
    format!("{} {:02} {:02}", seconds / 3600, seconds / 60 % 60, seconds % 60)
}

fn numbers(file: &str, line: usize, text: &str) -> Result<Vec<f64>, OpenError> {
    text.split_whitespace()
        .map(|field| {
            field.parse().map_err(|_| {
                OpenError::line(
                    file,
                    line,
                    format!("`{field}` is not a number"),
                    "separate numbers by spaces",
                )
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use resect_core::deployment::pairwise_distances;

    #[test]
    fn a_written_rig_reads_back() {
        let prisms = [
            Vector3::new(3.0, 0.1, -0.3),
            Vector3::new(3.6, 0.5, -0.5),
            Vector3::new(2.9, 0.9, -0.7),
        ];
        let text = write_rig_reading(&prisms.map(Polar::from_cartesian), 0.010);
        let back = read_rig_reading("x", &text, &[0.010; 3].into()).expect("own text");
        for (written, read) in
            pairwise_distances(&prisms).iter().zip(pairwise_distances(back.as_slice()))
        {
            assert!((written - read).abs() < 1.2e-3, "{written} {read}");
        }
    }

    #[test]
    fn bad_rig_files_say_where() {
        let error =
            read_distances("d.csv", "0.7 0.9 oops", None).expect_err("not a number").to_string();
        assert!(error.starts_with("d.csv:1: `oops`"), "{error}");
        let error = read_distances("d.csv", "0.7 0.9 -1", None).expect_err("negative").to_string();
        assert!(error.contains("not a distance"), "{error}");
        let error =
            read_sensor_positions("s.csv", "1 2 3 1\n1 2\n", 3).expect_err("short").to_string();
        assert!(error.starts_with("s.csv:2: not a position"), "{error}");
        let error = read_sensor_positions("s.csv", "1 2 3 1\n", 3).expect_err("one").to_string();
        assert!(error.starts_with("s.csv: 1 rows"), "{error}");
        let error =
            read_rig_reading("r.csv", "1 2 3\n", &[0.01; 3].into()).expect_err("short").to_string();
        assert!(error.starts_with("r.csv:1: 3 columns"), "{error}");
    }
}
