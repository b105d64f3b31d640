//! Positions of one prism over time, as the authors of the paper publish them: `t x y z`, one file a station.
//!
//! `total_stations/trimble{1,2,3}.csv` of the repository norlab-ulaval/RTS_project: no header, separated by spaces, seconds and metres,
//! with the prism constant. Its scripts compute a point as d·(sin a · sin ζ, cos a · sin ζ, cos ζ) with the azimuth a and the zenith
//! angle ζ. Hence x is east and y is north if azimuth 0 is north: our frame rotated by 90° about z. (Scripts of 2023 use (cos a, −sin a),
//! our own frame. The two differ by one rotation common to all stations.) Tested on the run of 2022-07-11: station 1's readings agree
//! with its bag.

use nalgebra::Vector3;

use crate::error::OpenError;

/// A position and its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Position {
    pub line: usize,
    pub time_s: f64,
    /// The position in the axes of the file (m); may be non-finite, which the caller handles.
    pub position_m: Vector3<f64>,
}

/// Converts a vector of a file into the axes of the program. In the file, x is along azimuth 90° and y along azimuth 0.
pub fn own_from_theirs(v: &Vector3<f64>) -> Vector3<f64> {
    Vector3::new(v.y, -v.x, v.z)
}

/// Reads all lines, including non-finite numbers.
pub fn read(file: &str, text: &str) -> Result<Vec<Position>, OpenError> {
    let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    lines
        .map(|(index, line)| {
            let wrong = |what: String| {
                OpenError::line(file, index + 1, what, "lines are: time x y z, in s and m")
            };
            let mut fields = line.split_whitespace();
            let mut values = [0.0; 4];
            for value in &mut values {
                let field =
                    fields.next().ok_or_else(|| wrong("fewer than 4 numbers".to_owned()))?;
                *value = field.parse().map_err(|_| wrong(format!("`{field}` is not a number")))?;
            }
            if fields.next().is_some() {
                return Err(wrong("more than 4 numbers".to_owned()));
            }
            let [time_s, x, y, z] = values;
            Ok(Position { line: index + 1, time_s, position_m: Vector3::new(x, y, z) })
        })
        .collect()
}

/// Returns true if stamps are evenly spaced, as those of interpolated positions are and those of a station never.
pub fn evenly_spaced(head: &str) -> bool {
    /// Resolution of stamps: decimals of a double near 1.7e9 s.
    const SAME_STEP_S: f64 = 1e-6;
    let mut stamps: Vec<f64> = head
        .lines()
        .filter_map(|line| line.split_whitespace().next()?.parse().ok())
        .take(40)
        .collect();
    // The last line may be cut off.
    stamps.pop();
    let step_s = |pair: &[f64]| pair[1] - pair[0];
    stamps.len() >= 10
        && stamps.windows(2).all(|pair| {
            let usual_s = stamps[1] - stamps[0];
            (step_s(pair) - usual_s).abs() < SAME_STEP_S
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_read_and_mistakes_said() {
        let text = "1657569001.5 -5.25 -17.0 -0.5\n\n1657569001.9 1 2 3\n";
        let positions = read("trimble1.csv", text).expect("good");
        assert_eq!(positions.len(), 2);
        assert_eq!((positions[1].line, positions[1].time_s), (3, 1657569001.9));
        assert_eq!(own_from_theirs(&positions[0].position_m), Vector3::new(-17.0, 5.25, -0.5));
        for (text, expected) in [
            ("1 2 3\n", "t.csv:1: fewer than 4"),
            ("1 2 3 4\n1 2 3 4 5\n", "t.csv:2: more than 4"),
            ("1 2 x 4\n", "t.csv:1: `x` is not"),
        ] {
            let error = read("t.csv", text).expect_err(expected).to_string();
            assert!(error.starts_with(expected), "{error}");
        }
    }

    #[test]
    fn a_grid_of_times_is_no_measurement() {
        let text = |jitter_s: f64| {
            let line = |i: i32| {
                let time_s = 1657569001.5339975 + 0.1 * f64::from(i);
                format!("{} 1 2 3\n", time_s + jitter_s * f64::from(i % 3))
            };
            (0..30).map(line).collect::<String>()
        };
        assert!(evenly_spaced(&text(0.0)));
        assert!(!evenly_spaced(&text(0.001)));
        assert!(!evenly_spaced("1 2 3 4\n2 2 3 4\n"));
    }
}
