//! Differences between the halves of a drive.

use super::solution::Solution;

/// Largest difference of two halves that is no contradiction, in σ. Textbook: of eight numbers, 3.5 σ are exceeded once in 270 drives.
pub const MOST_SIGMAS: f64 = 3.5;

/// Difference of a number between the halves of the drive.
#[derive(Clone, Debug, PartialEq)]
pub struct HalvesDifference {
    /// Name of the number: "time offset", "lever arm, x".
    pub name: String,
    /// Second half minus first half (s, m, rad).
    pub difference: f64,
    pub sigma: f64,
    pub unit: HalvesUnit,
}

/// Unit of a difference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HalvesUnit {
    Second,
    Metre,
    Radian,
}

impl HalvesDifference {
    pub fn sigmas(&self) -> f64 {
        self.difference.abs() / self.sigma.max(f64::MIN_POSITIVE)
    }
}

/// Outcome of the comparison of both halves.
#[derive(Clone, Debug, PartialEq)]
pub enum HalvesOutcome {
    /// Differences of the numbers that both halves determine.
    Compared(Vec<HalvesDifference>),
    /// A half alone gives no answer, for this reason.
    NoAnswer(String),
}

impl HalvesOutcome {
    /// Returns the largest difference in σ; `None` if there is none to compare.
    pub fn largest(&self) -> Option<&HalvesDifference> {
        match self {
            Self::Compared(all) => all.iter().max_by(|a, b| a.sigmas().total_cmp(&b.sigmas())),
            Self::NoAnswer(_) => None,
        }
    }

    /// Returns the largest difference if it is significant.
    pub fn contradiction(&self) -> Option<&HalvesDifference> {
        self.largest().filter(|largest| largest.sigmas() > MOST_SIGMAS)
    }
}

/// Compares what both halves determine.
pub fn differences([first, second]: &[Solution; 2]) -> Vec<HalvesDifference> {
    let mut all = Vec::new();
    let mut add = |name: String, unit, both: Option<[(f64, f64); 2]>| {
        let Some([(a, sigma_a), (b, sigma_b)]) = both else { return };
        all.push(HalvesDifference { name, difference: b - a, sigma: sigma_a.hypot(sigma_b), unit });
    };
    let clock = |half: &Solution| Some((half.time_offset_s, half.time_offset_sigma_s?));
    let pair = clock(first).zip(clock(second)).map(|(a, b)| [a, b]);
    add("time offset".to_owned(), HalvesUnit::Second, pair);
    for (axis, letter) in ["x", "y", "z"].iter().enumerate() {
        let lever = |half: &Solution| {
            let sigma_m = half.lever_sigma_m?[axis];
            half.determines_lever[axis].then_some((half.a_from_b.translation_m[axis], sigma_m))
        };
        let pair = lever(first).zip(lever(second)).map(|(a, b)| [a, b]);
        add(format!("lever arm, {letter}"), HalvesUnit::Metre, pair);
    }
    let turn = (second.a_from_b.rotation * first.a_from_b.rotation.inverse()).scaled_axis();
    for (axis, letter) in ["x", "y", "z"].iter().enumerate() {
        let sigma = |half: &Solution| Some(half.rotation_sigma_rad?[axis]);
        let pair = sigma(first).zip(sigma(second)).map(|(a, b)| [(0.0, a), (turn[axis], b)]);
        add(format!("rotation about {letter}"), HalvesUnit::Radian, pair);
    }
    all
}
