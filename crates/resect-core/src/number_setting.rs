//! A number that a user can set, described once for checks, differences, flags and widgets.

use std::ops::Bound;

/// Name, unit, accepted values and meaning of a number in settings of type `S`.
pub struct NumberSetting<S: 'static> {
    /// Symbol or short name in lists of changes: "τ_s".
    pub name: &'static str,
    /// Caption of its widget.
    pub label: &'static str,
    /// Name in charts.
    pub title: &'static str,
    /// Key in settings files and messages, with the stored unit.
    pub key: &'static str,
    /// Name as a flag of the command line and as the parameter of a sweep.
    pub flag: Option<&'static str>,
    /// Meaning, in the words of the command line's help.
    pub meaning: &'static str,
    /// Unit for people.
    pub unit: &'static str,
    /// Size of the stored unit in the unit for people: 1000 for metres that are shown in millimetres.
    pub per_stored: f64,
    /// Smallest accepted value, in the stored unit.
    pub least: Bound<f64>,
    /// Largest accepted value, in the stored unit; infinite if there is none.
    pub most: f64,
    /// Ends of its slider, in the unit for people.
    pub slider: [f64; 2],
    /// The field of the settings.
    pub field: fn(&mut S) -> &mut f64,
}

impl<S: Copy + Default> NumberSetting<S> {
    /// Returns the stored value.
    pub fn value(&self, settings: &S) -> f64 {
        let mut settings = *settings;
        *(self.field)(&mut settings)
    }

    /// Returns the value in the unit for people, without noise from the conversion.
    pub fn shown(&self, settings: &S) -> f64 {
        (self.value(settings) * self.per_stored * 1e9).round() / 1e9
    }

    /// Returns the default, in the unit for people.
    pub fn default_shown(&self) -> f64 {
        self.shown(&S::default())
    }

    /// Returns the unit without signs that a keyboard lacks.
    pub fn typed_unit(&self) -> String {
        self.unit.replace('°', "deg")
    }

    /// Checks the value against the accepted ones.
    ///
    /// # Errors
    /// One line with the key, the value and the limit.
    pub fn check(&self, settings: &S) -> Result<(), String> {
        let Self { key, least, most, .. } = self;
        let value = self.value(settings);
        let (is_above, limit) = match least {
            Bound::Included(least) => (value >= *least, format!("at least {least}")),
            Bound::Excluded(least) => (value > *least, format!("above {least}")),
            Bound::Unbounded => (true, "a number".to_owned()),
        };
        if !(is_above && value.is_finite()) {
            Err(format!("{key} is {value}; it must be {limit}"))
        } else if value > *most {
            Err(format!("{key} is {value}; it must be at most {most}"))
        } else {
            Ok(())
        }
    }
}

/// Checks all numbers of a table.
///
/// # Errors
/// The first number that is not accepted, as one line.
pub fn check_all<S: Copy + Default>(
    numbers: &[&NumberSetting<S>],
    settings: &S,
) -> Result<(), String> {
    numbers.iter().try_for_each(|number| number.check(settings))
}
