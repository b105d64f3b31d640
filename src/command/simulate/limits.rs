//! Numbers on the command line: their count, limits and unit.

use std::str::FromStr;

use super::super::Failure;

/// Limits of a number, and its unit in units of the scenario.
#[derive(Clone, Copy)]
pub struct Limits {
    pub low: f64,
    pub high: f64,
    pub unit: f64,
}

impl Limits {
    /// Symmetric limits about zero.
    pub const fn either_way(most: f64, unit: f64) -> Self {
        Self { low: -most, high: most, unit }
    }

    pub const fn up_to(high: f64, unit: f64) -> Self {
        Self { low: 0.0, high, unit }
    }
}

/// Numbers separated by commas, for options that may be repeated.
#[derive(Clone)]
pub struct List(pub Vec<f64>);

impl FromStr for List {
    type Err = std::num::ParseFloatError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        text.split(',').map(str::parse).collect::<Result<_, _>>().map(Self)
    }
}

/// Replaces numbers of the scenario by those of an option, all with the same limits; an absent option changes nothing.
pub fn replace(name: &str, given: &[f64], limits: Limits, to: &mut [f64]) -> Result<(), Failure> {
    if given.is_empty() {
        return Ok(());
    }
    let row = vec![limits; to.len()];
    replace_row(name, given, to.len(), &row, to)
}

/// Replaces a row of numbers, each with its own limits; either all of them, or the first `least`, are given.
pub fn replace_row(
    name: &str,
    given: &[f64],
    least: usize,
    limits: &[Limits],
    to: &mut [f64],
) -> Result<(), Failure> {
    let most = limits.len();
    if given.len() != least && given.len() != most {
        let wanted = if least == most { most.to_string() } else { format!("{least} or {most}") };
        let count = given.len();
        let line = format!("--{name} has {count} numbers; give {wanted}, separated by commas");
        return Err(Failure::Usage(line));
    }
    for ((value, Limits { low, high, unit }), to) in given.iter().zip(limits).zip(to) {
        if !(*low..=*high).contains(value) {
            let line = format!("--{name} is {value}; it must be from {low} to {high}");
            return Err(Failure::Usage(line));
        }
        *to = value * unit;
    }
    Ok(())
}

/// Returns the index of the station that is the first number of an option's list.
pub fn station(name: &str, given: &List, stations: usize) -> Result<usize, Failure> {
    let number = given.0.first().copied().unwrap_or_default();
    (0..stations).find(|index| number == (index + 1) as f64).ok_or_else(|| {
        let all: Vec<String> = (1..=stations).map(|station| station.to_string()).collect();
        let all = all.join(", ");
        Failure::Usage(format!("--{name} names station {number}; stations are {all}"))
    })
}
