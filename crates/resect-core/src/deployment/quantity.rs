//! Quantities of findings: the numbers behind a message, in SI units.

use std::borrow::Cow;

/// Unit of a quantity; the name of the quantity in JSON ends with its suffix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    Metre,
    SquareMetre,
    Radian,
    Second,
    /// A number of things.
    Count,
    /// A ratio of two numbers of the same unit, such as a number of σ.
    Ratio,
}

impl Unit {
    /// Suffix of a name with this unit.
    pub fn suffix(self) -> &'static str {
        match self {
            Self::Metre => "_m",
            Self::SquareMetre => "_m2",
            Self::Radian => "_rad",
            Self::Second => "_s",
            Self::Count | Self::Ratio => "",
        }
    }
}

/// A number on which a finding is based.
#[derive(Clone, Debug, PartialEq)]
pub struct FindingQuantity {
    /// The name without unit, in snake case.
    pub name: Cow<'static, str>,
    pub value: f64,
    /// One standard deviation; `None` if the value is not an estimate.
    pub sigma: Option<f64>,
    pub unit: Unit,
}

impl FindingQuantity {
    /// The name with its unit: `offset_s`.
    pub fn key(&self) -> String {
        format!("{}{}", self.name, self.unit.suffix())
    }
}
