//! Units that the names of columns state: `x [mm]`, `roll_deg`, `cov_xx (m^2)`.

/// Units of length (m), of angle (rad), and of time (counts per second).
const LENGTHS: [(&str, f64); 13] = [
    ("m", 1.0),
    ("metre", 1.0),
    ("metres", 1.0),
    ("meter", 1.0),
    ("meters", 1.0),
    ("mm", 1e-3),
    ("cm", 1e-2),
    ("dm", 0.1),
    ("km", 1e3),
    ("um", 1e-6),
    ("ft", 0.3048),
    ("feet", 0.3048),
    ("in", 0.0254),
];
const ANGLES: [(&str, f64); 11] = [
    ("rad", 1.0),
    ("radian", 1.0),
    ("radians", 1.0),
    ("mrad", 1e-3),
    ("deg", std::f64::consts::PI / 180.0),
    ("degree", std::f64::consts::PI / 180.0),
    ("degrees", std::f64::consts::PI / 180.0),
    ("°", std::f64::consts::PI / 180.0),
    // Whole numbers of receivers.
    ("e7", 1e-7 * std::f64::consts::PI / 180.0),
    ("gon", std::f64::consts::PI / 200.0),
    ("grad", std::f64::consts::PI / 200.0),
];
const TIMES: [(&str, u32); 10] = [
    ("s", 1),
    ("sec", 1),
    ("secs", 1),
    ("second", 1),
    ("seconds", 1),
    ("ms", 1_000),
    ("us", 1_000_000),
    ("µs", 1_000_000),
    ("ns", 1_000_000_000),
    ("nsec", 1_000_000_000),
];
/// Units of time that are not read.
const LONGER_TIMES: [&str; 8] = ["min", "minute", "minutes", "h", "hour", "hours", "d", "days"];
/// Units at the end of a name, after an underscore.
const ENDINGS: [&str; 18] = [
    "_mrad", "_radians", "_rad", "_degrees", "_degree", "_deg", "_e7", "_meters", "_metres", "_mm",
    "_cm", "_km", "_ft", "_ns", "_us", "_ms", "_m", "_s",
];

/// Returns a column's name in lower case without its unit: `p_RS_R_x [m]` becomes `p_rs_r_x`, `field.x` and `x_m` become `x`.
pub fn without_unit(name: &str) -> String {
    let name = name.split(['[', '(']).next().unwrap_or_default().trim().to_lowercase();
    let name = name.replace(['.', '/', ' ', '-'], "_");
    let name = name.trim_start_matches(['#', '%', '_']);
    let name = name.strip_prefix("field_").unwrap_or(name);
    // `time_s` and `timestamp_s` have names of their own.
    let units = ENDINGS.iter().filter(|unit| **unit != "_s");
    units.copied().find_map(|unit| name.strip_suffix(unit)).unwrap_or(name).to_owned()
}

/// A unit as it stands in a name, in lower case.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StatedUnit {
    pub text: String,
    /// True in square brackets, which enclose nothing but units.
    is_certain: bool,
}

/// Returns the unit that a column's name states; `None` without one.
pub fn stated_unit(name: &str) -> Option<StatedUnit> {
    let name = name.trim().to_lowercase();
    for (opening, closing, is_certain) in [('[', ']', true), ('(', ')', false)] {
        if let Some((_, rest)) = name.split_once(opening) {
            let text = rest.split(closing).next().unwrap_or_default().trim().to_owned();
            return (!["", "-", "1"].contains(&&*text)).then_some(StatedUnit { text, is_certain });
        }
    }
    let ending = ENDINGS.iter().find(|unit| name.ends_with(*unit))?;
    Some(StatedUnit { text: ending.trim_start_matches('_').to_owned(), is_certain: false })
}

impl StatedUnit {
    /// Returns the unit in a list; `None` if the text is no unit.
    ///
    /// # Errors
    /// If the unit is not in the list.
    fn of<T: Copy>(&self, list: &[(&str, T)], name: &str) -> Result<Option<T>, String> {
        let known = list.iter().find(|(unit, _)| *unit == self.text);
        let is_unit = LENGTHS.iter().chain(&ANGLES).any(|(unit, _)| *unit == self.text)
            || TIMES.iter().any(|(unit, _)| *unit == self.text)
            || LONGER_TIMES.contains(&&*self.text);
        match known {
            Some((_, value)) => Ok(Some(*value)),
            None if is_unit || self.is_certain => {
                let units: Vec<&str> = list.iter().map(|(unit, _)| *unit).collect();
                let name = name.trim();
                Err(format!("the unit of column `{name}` is not one of {}", units.join(", ")))
            }
            None => Ok(None),
        }
    }
}

/// Returns the length of a column's unit (m); metres without one.
///
/// # Errors
/// If the unit is unknown.
pub fn length_unit_m(name: &str) -> Result<f64, String> {
    let unit = stated_unit(name).map(|unit| unit.of(&LENGTHS, name));
    Ok(unit.transpose()?.flatten().unwrap_or(1.0))
}

/// Returns the angle of a column's unit (rad); `None` without one.
///
/// # Errors
/// If the unit is unknown.
pub fn angle_unit_rad(name: &str) -> Result<Option<f64>, String> {
    Ok(stated_unit(name).map(|unit| unit.of(&ANGLES, name)).transpose()?.flatten())
}

/// Returns the counts per second that a column's name states; `None` without a unit.
///
/// # Errors
/// If the unit is longer than a second.
pub fn counts_per_second(name: &str) -> Result<Option<u32>, String> {
    let last = name.trim().trim_end_matches([']', ')']).to_lowercase();
    let unit = last.rsplit(['[', '(', '_', ' ']).next().filter(|unit| unit.len() < last.len());
    let Some(unit) = unit else { return Ok(None) };
    if LONGER_TIMES.contains(&unit) {
        return Err(format!("the unit of column `{}` is not one of s, ms, us, ns", name.trim()));
    }
    Ok(TIMES.iter().find(|(known, _)| *known == unit).map(|(_, counts)| *counts))
}

/// Returns the factor of a variance or covariance between two quantities, each with its SI unit: `mm^2`, `deg²`, `m rad`.
///
/// # Errors
/// If the unit is unknown.
pub fn square_unit(name: &str, are_angles: [bool; 2]) -> Result<f64, String> {
    let Some(unit) = stated_unit(name) else { return Ok(1.0) };
    let factor = |text: &str, is_angle: bool| -> Option<f64> {
        let list: &[(&str, f64)] = if is_angle { &ANGLES } else { &LENGTHS };
        list.iter().find(|(known, _)| *known == text).map(|(_, factor)| *factor)
    };
    let text = unit.text.replace("**2", "²").replace("^2", "²").replace("·", " ").replace('*', " ");
    let base = text.strip_suffix('²').or_else(|| text.strip_suffix('2'));
    let words: Vec<&str> = text.split_whitespace().collect();
    let [first, second] = are_angles;
    let known = match (base, &words[..]) {
        (Some(base), _) if first == second => factor(base, first).map(|factor| factor * factor),
        (None, [a, b]) => factor(a, first)
            .zip(factor(b, second))
            .or_else(|| factor(a, second).zip(factor(b, first)))
            .map(|(a, b)| a * b),
        // An ending such as `_m` belongs to the name of an element.
        (None, _) if !unit.is_certain => Some(1.0),
        _ => None,
    };
    known.ok_or_else(|| format!("the unit of column `{}` is unknown; use m², rad²", name.trim()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_of_columns_are_read_or_refused() {
        assert_eq!(length_unit_m("sigma_x [mm]"), Ok(1e-3));
        assert_eq!(length_unit_m("x_cm"), Ok(0.01));
        for metres in ["x", "p_RS_R_x [m]", "x (east)", "q_w []", "easting (m)"] {
            assert_eq!(length_unit_m(metres), Ok(1.0), "{metres}");
        }
        for other in ["x [furlong]", "x [deg]", "x (rad)", "x [s]"] {
            assert!(length_unit_m(other).is_err_and(|why| why.contains("mm")), "{other}");
        }
        assert_eq!(angle_unit_rad("roll"), Ok(None));
        assert_eq!(angle_unit_rad("roll [rad]"), Ok(Some(1.0)));
        let degrees = angle_unit_rad("Yaw (°)").expect("a unit").expect("stated");
        assert!((degrees.to_degrees() - 1.0).abs() < 1e-12);
        assert!(angle_unit_rad("yaw [m]").is_err());
        assert_eq!(counts_per_second("#timestamp [ns]"), Ok(Some(1_000_000_000)));
        assert_eq!(counts_per_second("time (UTC)"), Ok(None));
        assert!(counts_per_second("time [min]").is_err());
    }

    #[test]
    fn squares_of_units_scale_covariances() {
        let near = |name, angles, factor: f64| {
            let read = square_unit(name, angles).expect(name);
            assert!((read / factor - 1.0).abs() < 1e-9, "{name}: {read}");
        };
        near("cov_xx [mm^2]", [false; 2], 1e-6);
        near("cov_xy (cm²)", [false; 2], 1e-4);
        near("cov_rxrx [deg**2]", [true; 2], 1_f64.to_radians().powi(2));
        near("cov_x_rx [mm rad]", [false, true], 1e-3);
        near("cov_x_y", [false; 2], 1.0);
        assert!(square_unit("cov_xx [mm]", [false; 2]).is_err());
        assert!(square_unit("cov_xx [parsec^2]", [false; 2]).is_err());
    }

    #[test]
    fn names_lose_their_units() {
        for (name, plain) in [
            ("p_RS_R_x [m]", "p_rs_r_x"),
            ("field.x", "x"),
            ("x_mm", "x"),
            ("Roll (deg)", "roll"),
            ("yaw_deg", "yaw"),
            ("time_s", "time_s"),
            ("% pose.position.x", "pose_position_x"),
        ] {
            assert_eq!(without_unit(name), plain);
        }
    }
}
