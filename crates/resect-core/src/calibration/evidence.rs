//! The measurements that the joint estimate uses.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// The groups of measurements that the joint estimate uses, each used or left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Evidence {
    /// Readings of the prisms while the vehicle drives.
    pub drive: bool,
    /// Readings of static points by all stations.
    pub control_points: bool,
    /// Inter-prism distances as measured on the vehicle.
    pub rig: bool,
}

impl Evidence {
    pub const ALL: Self = Self { drive: true, control_points: true, rig: true };
    pub const NONE: Self = Self { drive: false, control_points: false, rig: false };

    /// Names of the groups, in the order of [`Self::switches`].
    pub const NAMES: [&str; 3] = ["drive", "control-points", "rig"];

    /// Checks that the groups can determine the transforms.
    ///
    /// # Errors
    /// One line with the groups that do.
    pub fn check(&self) -> Result<(), String> {
        if self.drive || self.control_points {
            return Ok(());
        }
        let [drive, control_points, rig] = Self::NAMES;
        Err(format!(
            "evidence needs {drive} or {control_points}: {rig} alone determines no transform"
        ))
    }

    /// The switches of the groups, in the order of [`Self::NAMES`].
    pub fn switches(&mut self) -> [&mut bool; 3] {
        [&mut self.drive, &mut self.control_points, &mut self.rig]
    }
}

impl Default for Evidence {
    fn default() -> Self {
        Self::ALL
    }
}

/// Writes the names of the used groups: "drive,control-points,rig".
impl fmt::Display for Evidence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut copy = *self;
        let used = Self::NAMES.iter().zip(copy.switches()).filter(|(_, used)| **used);
        let names: Vec<&str> = used.map(|(name, _)| *name).collect();
        f.write_str(&names.join(","))
    }
}

/// Reads names of groups, separated by commas.
///
/// # Errors
/// The unknown name with the names that exist, or that the groups determine no transform.
impl FromStr for Evidence {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut evidence = Self::NONE;
        for name in text.split(',').map(str::trim).filter(|name| !name.is_empty()) {
            let known = Self::NAMES.iter().position(|known| *known == name);
            let index = known.ok_or_else(|| {
                format!("unknown evidence \"{name}\"; name some of {}", Self::NAMES.join(", "))
            })?;
            *evidence.switches()[index] = true;
        }
        evidence.check()?;
        Ok(evidence)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_written_as_they_are_read() {
        for text in ["drive", "control-points", "drive,rig", "drive,control-points,rig"] {
            let evidence: Evidence = text.parse().expect("names");
            assert_eq!(evidence.to_string(), text);
        }
        assert_eq!(" rig , drive".parse(), Ok(Evidence { control_points: false, ..Evidence::ALL }));
        for wrong in ["", ",", "rig", "drives", "drive;rig"] {
            let message = wrong.parse::<Evidence>().expect_err("wrong");
            assert!(message.contains("control-points"), "{message}");
        }
    }
}
