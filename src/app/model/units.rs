//! Units in which the window shows lengths and angles; all values are stored in metres and radians.
//!
//! Each unit has a small unit for σ and differences. It is mm for both lengths; for angles it is mrad for radians,
//! arcseconds for degrees, and mgon for gon, as is customary.

use serde::{Deserialize, Serialize};

use resect_core::analysis::{SettingChange, Settings, changes_in_words, setting_changes};
use resect_report::text::sigma_text;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LengthUnit {
    #[default]
    Metre,
    Millimetre,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AngleUnit {
    #[default]
    Radian,
    Degree,
    /// 400 to the circle.
    Gon,
}

/// Unit of displayed times.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TimeUnit {
    /// Hours, minutes and seconds since the first measurement.
    #[default]
    Elapsed,
    /// Seconds since the first measurement.
    Seconds,
    /// Time of day, if the stamps contain it.
    Utc,
}

impl TimeUnit {
    pub const ALL: [Self; 3] = [Self::Elapsed, Self::Seconds, Self::Utc];

    /// Returns the unit's label on an axis.
    pub fn name(self) -> &'static str {
        match self {
            Self::Elapsed => "h:m:s",
            Self::Seconds => "s",
            Self::Utc => "UTC",
        }
    }
}

/// Units of displayed lengths, angles and times.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Units {
    pub length: LengthUnit,
    pub angle: AngleUnit,
    pub time: TimeUnit,
}

impl LengthUnit {
    pub const ALL: [Self; 2] = [Self::Metre, Self::Millimetre];

    /// Returns the symbol.
    pub fn name(self) -> &'static str {
        match self {
            Self::Metre => "m",
            Self::Millimetre => "mm",
        }
    }

    pub fn per_metre(self) -> f64 {
        match self {
            Self::Metre => 1.0,
            Self::Millimetre => 1e3,
        }
    }

    /// Decimals for a resolution of 0.1 mm.
    pub(super) fn decimals(self) -> usize {
        match self {
            Self::Metre => 4,
            Self::Millimetre => 1,
        }
    }
}

impl AngleUnit {
    pub const ALL: [Self; 3] = [Self::Radian, Self::Degree, Self::Gon];

    /// Returns the symbol.
    pub fn name(self) -> &'static str {
        match self {
            Self::Radian => "rad",
            Self::Degree => "deg",
            Self::Gon => "gon",
        }
    }

    /// Returns the symbol of the unit for σ and differences.
    pub fn small_name(self) -> &'static str {
        match self {
            Self::Radian => "mrad",
            Self::Degree => "″",
            Self::Gon => "mgon",
        }
    }

    /// Returns the symbol of the unit for rates: with radians it is °/s, as in the paper and the settings.
    pub fn rate_name(self) -> &'static str {
        match self {
            Self::Radian | Self::Degree => "°/s",
            Self::Gon => "gon/s",
        }
    }

    /// Returns the number of [`Self::rate_name`] in one °/s.
    pub fn rate_per_deg_per_s(self) -> f64 {
        match self {
            Self::Radian | Self::Degree => 1.0,
            Self::Gon => 400.0 / 360.0,
        }
    }

    /// Returns the unit in which a setting with this unit is shown, and its number in one of that: angular rates are in the user's
    /// unit.
    pub fn of_setting(self, unit: &'static str) -> (&'static str, f64) {
        if unit == Self::Degree.rate_name() {
            (self.rate_name(), self.rate_per_deg_per_s())
        } else {
            (unit, 1.0)
        }
    }

    pub fn per_radian(self) -> f64 {
        match self {
            Self::Radian => 1.0,
            Self::Degree => 1_f64.to_degrees(),
            Self::Gon => 200.0 / std::f64::consts::PI,
        }
    }

    pub fn small_per_radian(self) -> f64 {
        match self {
            Self::Radian | Self::Gon => 1e3 * self.per_radian(),
            Self::Degree => 3600.0 * self.per_radian(),
        }
    }

    /// Decimals for a resolution of about 1 µrad.
    pub(super) fn decimals(self) -> usize {
        match self {
            Self::Radian => 6,
            Self::Degree | Self::Gon => 4,
        }
    }

    /// Decimals of the small unit for a resolution of about 1 µrad or better.
    fn small_decimals(self) -> usize {
        match self {
            Self::Radian => 3,
            Self::Degree => 1,
            Self::Gon => 2,
        }
    }
}

impl Units {
    /// Formats a length to 0.1 mm without its unit, for columns whose heading contains it.
    pub fn length(self, metres: f64) -> String {
        without_negative_zero(metres * self.length.per_metre(), self.length.decimals())
    }

    /// Formats a length with its unit, for running text.
    pub fn length_with_unit(self, metres: f64) -> String {
        format!("{} {}", self.length(metres), self.length.name())
    }

    /// Formats an angle to about 1 µrad, without its unit.
    pub fn angle(self, radians: f64) -> String {
        without_negative_zero(radians * self.angle.per_radian(), self.angle.decimals())
    }

    /// Formats an angle with its unit, for running text.
    pub fn angle_with_unit(self, radians: f64) -> String {
        format!("{} {}", self.angle(radians), self.angle.name())
    }

    /// Formats the σ of a length in mm; a dash for `None`.
    pub fn length_sigma(self, metres: Option<f64>) -> String {
        sigma_text(metres, 1)
    }

    /// Formats the σ of an angle in [`AngleUnit::small_name`]; a dash for `None`.
    pub fn angle_sigma(self, radians: Option<f64>) -> String {
        // `sigma_text` multiplies by a thousand.
        let thousandth = radians.map(|radians| radians * self.angle.small_per_radian() / 1e3);
        sigma_text(thousandth, self.angle.small_decimals())
    }

    /// Describes the differences between two sets of settings, with rates in the user's unit.
    pub fn changes(self, before: &Settings, after: &Settings) -> String {
        let changes: Vec<SettingChange> =
            setting_changes(before, after).into_iter().map(|change| self.change(change)).collect();
        changes_in_words(&changes)
    }

    /// Returns a changed setting, in the user's unit if it is a rate.
    pub fn change(self, change: SettingChange) -> SettingChange {
        if change.unit != AngleUnit::Degree.rate_name() {
            return change;
        }
        let told = |text: String| match text.parse::<f64>() {
            // Hides rounding noise of the conversion.
            Ok(value) => {
                ((value * self.angle.rate_per_deg_per_s() * 1e4).round() / 1e4).to_string()
            }
            Err(_) => text,
        };
        let (before, after) = (told(change.before), told(change.after));
        SettingChange { before, after, unit: self.angle.rate_name(), ..change }
    }

    /// Formats a difference of lengths in mm, with its sign.
    pub fn length_difference(self, metres: f64) -> String {
        with_sign(metres * 1e3, 2)
    }

    /// Formats a difference of angles in [`AngleUnit::small_name`], with its sign.
    pub fn angle_difference(self, radians: f64) -> String {
        with_sign(radians * self.angle.small_per_radian(), self.angle.small_decimals())
    }

    /// Formats a difference of angles with its unit; large ones, as between set-ups, in the unit of angles.
    pub fn angle_difference_in_words(self, radians: f64) -> String {
        if radians.abs() < LARGE_RAD {
            return format!("{} {}", self.angle_difference(radians), self.angle.small_name());
        }
        let (turn, decimals) = (radians * self.angle.per_radian(), self.angle.decimals().min(4));
        format!("{} {}", with_sign(turn, decimals), self.angle.name())
    }
}

/// Smallest rotation (rad) that indicates another set-up.
const LARGE_RAD: f64 = 0.05;

/// Formats a number with this many decimals, and without a minus sign if all digits are zero.
pub fn without_negative_zero(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(zero) if zero.bytes().all(|byte| matches!(byte, b'0' | b'.')) => zero.to_owned(),
        _ => text,
    }
}

/// Formats a number with this many decimals and its sign; no sign if all digits are zero.
pub fn with_sign(value: f64, decimals: usize) -> String {
    let text = without_negative_zero(value, decimals);
    let zero = text.bytes().all(|byte| matches!(byte, b'0' | b'.'));
    if zero || text.starts_with('-') { text } else { format!("+{text}") }
}

/// Replaces blanks by no-break ones between a number and its unit, after ± or σ, and at arrows.
pub fn unbroken(sentence: &str) -> String {
    const UNITS: [&str; 15] = [
        "m", "mm", "km", "s", "ms", "min", "rad", "mrad", "µrad", "deg", "gon", "mgon", "ppm",
        "Hz", "%",
    ];
    let mut words = sentence.split(' ');
    let mut before = words.next().unwrap_or_default();
    let mut text = before.to_owned();
    for word in words {
        let is_unit = UNITS.contains(&word.trim_end_matches([',', ';', '.', ':', ')']));
        let of_number = before.ends_with(|c: char| c.is_ascii_digit()) && is_unit;
        let to_number =
            before.ends_with(['±', 'σ', '→']) && word.starts_with(|c: char| c.is_ascii_digit());
        text.push(if of_number || to_number || word == "→" { '\u{a0}' } else { ' ' });
        text.push_str(word);
        before = word;
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn numbers_keep_their_units() {
        let plain = |text: &str| unbroken(text).replace('\u{a0}', "_");
        assert_eq!(
            plain("once more: 5.6 → 3.7 mm, 200 s more (σ 3.0 mm) in 2 places"),
            "once more: 5.6_→_3.7_mm, 200_s more (σ_3.0_mm) in 2 places"
        );
        assert_eq!(plain("a  b"), "a  b", "blanks stay");
        assert_eq!(plain(""), "");
    }

    #[test]
    fn a_right_angle_in_each_unit() {
        let show = |angle| Units { angle, ..Units::default() }.angle_with_unit(PI / 2.0);
        assert_eq!(AngleUnit::ALL.map(show), ["1.570796 rad", "90.0000 deg", "100.0000 gon"]);
    }

    #[test]
    fn small_angles_in_what_surveyors_read() {
        // 24 µrad are 4.95″ and 1.53 mgon.
        let show = |angle| {
            let units = Units { angle, ..Units::default() };
            (units.angle_sigma(Some(24e-6)), units.angle_difference(-24e-6))
        };
        let expected = [("0.024", "-0.024"), ("5.0", "-5.0"), ("1.53", "-1.53")];
        assert_eq!(AngleUnit::ALL.map(show), expected.map(|(a, b)| (a.to_owned(), b.to_owned())));
    }

    #[test]
    fn a_changed_threshold_is_told_in_the_unit_of_rates() {
        let mut after = Settings::default();
        after.pipeline.thresholds.tau_a_deg_per_s = 1.8;
        after.pipeline.thresholds.tau_r_m_per_s = 1.5;
        let told =
            |angle| Units { angle, ..Units::default() }.changes(&Settings::default(), &after);
        let degrees = "τ_r 2 → 1.5 m/s, τ_a 1 → 1.8 °/s";
        let gon = "τ_r 2 → 1.5 m/s, τ_a 1.1111 → 2 gon/s";
        assert_eq!(AngleUnit::ALL.map(told), [degrees, degrees, gon]);
    }

    #[test]
    fn lengths_to_a_tenth_of_a_millimetre() {
        let mm = Units { length: LengthUnit::Millimetre, ..Units::default() };
        assert_eq!(Units::default().length_with_unit(12.345_67), "12.3457 m");
        assert_eq!(mm.length_with_unit(12.345_67), "12345.7 mm");
        assert_eq!(mm.length_sigma(Some(0.0012)), "1.2");
        assert_eq!(mm.length_sigma(None), "–");
        assert_eq!(mm.length_difference(0.001_234), "+1.23");
    }

    #[test]
    fn nothing_has_no_sign() {
        let units = Units::default();
        assert_eq!(units.length(-1e-9), "0.0000");
        assert_eq!(units.length_difference(-1e-9), "0.00");
        assert_eq!(units.angle_difference(1e-9), "0.000");
        let in_words = |radians| units.angle_difference_in_words(radians);
        assert_eq!(
            (in_words(-0.0123), in_words(1.2)),
            ("-12.300 mrad".into(), "+1.2000 rad".into())
        );
    }
}
