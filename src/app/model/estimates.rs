//! Numbers with their σ, in one unit and with equal decimals; σ has two significant digits.

use super::units::{AngleUnit, Units, with_sign, without_negative_zero};
use resect_core::calibration::Quantity;
use resect_core::deployment::{AngleFormat, Finding, MessageAngle};
use resect_core::evaluation::answer_rows::AnswerRow;
use resect_report::rows::decimals_of;

/// A formatted number with its σ.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    value: String,
    sigma: String,
    unit: &'static str,
}

impl Shown {
    /// Formats a number with its σ, both in the unit; `decimals` apply without σ.
    pub fn new(value: f64, sigma: Option<f64>, unit: &'static str, decimals: usize) -> Self {
        let told = sigma.and_then(|sigma| Some((sigma, decimals_of(sigma)?)));
        let decimals = told.map_or(decimals, |(_, decimals)| decimals);
        Self {
            value: without_negative_zero(value, decimals),
            sigma: told.map_or("–".to_owned(), |(sigma, decimals)| format!("{sigma:.decimals$}")),
            unit,
        }
    }

    /// Adds a plus sign to a positive value.
    #[must_use]
    pub fn signed(mut self) -> Self {
        let above = self.value.bytes().any(|byte| (b'1'..=b'9').contains(&byte));
        if above && !self.value.starts_with('-') {
            self.value.insert(0, '+');
        }
        self
    }

    /// Returns the σ alone: "0.011 mrad".
    pub fn sigma_in_words(&self) -> String {
        format!("{} {}", self.sigma, self.unit)
    }

    /// Returns value and σ: "0.412 ± 0.011 mrad".
    pub fn in_words(&self) -> String {
        format!("{} ± {} {}", self.value, self.sigma, self.unit)
    }
}

/// Formats the numbers of a column with equal width, so that decimal points and units align in a font with tabular figures.
pub fn column(numbers: &[Shown]) -> Vec<String> {
    let whole = |text: &str| text.split('.').next().unwrap_or(text).chars().count();
    let part = |text: &str| text.chars().count() - whole(text);
    let widest = |of: &dyn Fn(&Shown) -> usize| numbers.iter().map(of).max().unwrap_or(0);
    let wholes = [widest(&|n| whole(&n.value)), widest(&|n| whole(&n.sigma))];
    let parts = [widest(&|n| part(&n.value)), widest(&|n| part(&n.sigma))];
    let padded = |text: &str, place: usize| {
        let (before, after) = (wholes[place] - whole(text), parts[place] - part(text));
        format!("{}{text}{}", " ".repeat(before), " ".repeat(after))
    };
    let line = |n: &Shown| format!("{} ± {} {}", padded(&n.value, 0), padded(&n.sigma, 1), n.unit);
    numbers.iter().map(line).collect()
}

impl Units {
    pub fn length_estimate(self, metres: f64, sigma_m: Option<f64>) -> Shown {
        let per = self.length.per_metre();
        let (unit, decimals) = (self.length.name(), self.length.decimals());
        Shown::new(metres * per, sigma_m.map(|sigma| sigma * per), unit, decimals)
    }

    pub fn angle_estimate(self, radians: f64, sigma_rad: Option<f64>) -> Shown {
        let per = self.angle.per_radian();
        let (unit, decimals) = (self.angle.name(), self.angle.decimals());
        Shown::new(radians * per, sigma_rad.map(|sigma| sigma * per), unit, decimals)
    }

    /// Formats the value of a row with its σ, lengths and angles in the user's units.
    pub fn value(self, row: &AnswerRow) -> Shown {
        match row.quantity {
            Quantity::Length => self.length_estimate(row.value, row.sigma),
            Quantity::Angle => self.angle_estimate(row.value, row.sigma),
            Quantity::Time | Quantity::Drift | Quantity::Share | Quantity::Coefficient => {
                let (per, unit) = row.quantity.told();
                Shown::new(row.value * per, row.sigma.map(|sigma| sigma * per), unit, 1)
            }
        }
    }

    /// Formats the deviation of a row from its reference, in the small unit of the quantity.
    pub fn deviation(self, row: &AnswerRow) -> Shown {
        let (per, unit) = self.of_extra(row.quantity);
        Shown::new(row.deviation() * per, row.sigma.map(|sigma| sigma * per), unit, 1).signed()
    }

    /// Formats the difference of two rows of the same quantity, with its unit: "+0.12 mm".
    pub fn difference(self, row: &AnswerRow, from: &AnswerRow) -> String {
        let (per, unit) = self.of_extra(row.quantity);
        format!("{} {unit}", with_sign((row.value - from.value) * per, 2))
    }

    /// Formats the prior standard deviation of an error: "1.2 mm".
    pub fn prior(self, quantity: Quantity, sigma: f64) -> String {
        let (per, unit) = self.of_extra(quantity);
        let decimals = decimals_of(sigma * per).unwrap_or(0);
        format!("{:.decimals$} {unit}", sigma * per)
    }

    fn of_extra(self, quantity: Quantity) -> (f64, &'static str) {
        match quantity {
            Quantity::Angle => (self.angle.small_per_radian(), self.angle.small_name()),
            _ => quantity.told(),
        }
    }

    /// Renders a finding's message with its angles in the user's unit.
    pub fn message(self, finding: &Finding) -> String {
        finding.render(|angle| self.told(angle))
    }

    /// Formats an angle of a message in the user's unit.
    pub fn told(self, angle: &MessageAngle) -> String {
        let MessageAngle { value_rad, sigma_rad, unit, decimals, signed } = *angle;
        if unit == AngleFormat::Degrees {
            return match self.angle {
                AngleUnit::Gon => {
                    format!("{:.decimals$} gon", value_rad * AngleUnit::Gon.per_radian())
                }
                AngleUnit::Radian | AngleUnit::Degree => angle.to_string(),
            };
        }
        let (per, name) = (self.angle.small_per_radian(), self.angle.small_name());
        let Some(sigma_rad) = sigma_rad else {
            // As many significant digits as σ would have.
            let decimals = decimals_of(value_rad.abs() * per).unwrap_or(0);
            let text = format!("{:.decimals$} {name}", value_rad * per);
            return if signed && value_rad > 0.0 { format!("+{text}") } else { text };
        };
        let shown = Shown::new(value_rad * per, Some(sigma_rad * per), name, decimals);
        if signed { shown.signed().in_words() } else { shown.in_words() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use resect_core::deployment::Message;
    use resect_core::deployment::kinds;

    #[test]
    fn sigma_has_two_significant_digits_and_the_value_as_many_decimals() {
        let shown = |value, sigma| Shown::new(value, Some(sigma), "m", 4).in_words();
        assert_eq!(shown(5.199_87, 0.001_12), "5.1999 ± 0.0011 m");
        assert_eq!(shown(-2.599_84, 0.000_9), "-2.59984 ± 0.00090 m");
        assert_eq!(shown(12.0, 0.099_6), "12.00 ± 0.10 m");
        assert_eq!(shown(1234.4, 56.7), "1234 ± 57 m");
        assert_eq!(shown(-0.000_01, 0.012), "0.000 ± 0.012 m");
        assert_eq!(Shown::new(5.0, None, "m", 4).in_words(), "5.0000 ± – m");
        assert_eq!(Shown::new(5.0, Some(f64::NAN), "m", 1).in_words(), "5.0 ± – m");
        assert_eq!(Shown::new(0.4, Some(0.12), "mm", 1).signed().in_words(), "+0.40 ± 0.12 mm");
    }

    #[test]
    fn points_and_units_of_a_column_stand_below_each_other() {
        let numbers = [
            Shown::new(5.199_87, Some(0.001_12), "m", 4),
            Shown::new(-12.599_84, Some(0.000_9), "m", 4),
            Shown::new(-1.456_87, None, "rad", 6),
        ];
        let expected =
            ["  5.1999   ± 0.0011  m", "-12.59984  ± 0.00090 m", " -1.456870 ± –       rad"];
        assert_eq!(column(&numbers), expected);
    }

    #[test]
    fn angles_of_a_message_come_in_the_users_unit() {
        let turned = MessageAngle::signed(0.000_5, AngleFormat::Milliradians, 3).sigma(0.000_011);
        let corner = MessageAngle::size(90_f64.to_radians(), AngleFormat::Degrees, 0);
        let lean = MessageAngle::size(-1_f64.to_radians() / 3600.0, AngleFormat::Arcseconds, 1);
        let message = Message::from("turned by ")
            .angle(turned)
            .text(" at a corner of ")
            .angle(corner)
            .text(", ")
            .angle(lean);
        let finding = Finding::new(kinds::STATION_MOVED, message);
        let told = |angle| Units { angle, ..Units::default() }.message(&finding);
        assert_eq!(finding.to_string(), "turned by +0.500 ± 0.011 mrad at a corner of 90°, -1.0″");
        assert_eq!(
            AngleUnit::ALL.map(told),
            [
                "turned by +0.500 ± 0.011 mrad at a corner of 90°, -0.0048 mrad",
                "turned by +103.1 ± 2.3 ″ at a corner of 90°, -1.0 ″",
                "turned by +31.83 ± 0.70 mgon at a corner of 100 gon, -0.31 mgon",
            ]
        );
    }
}
