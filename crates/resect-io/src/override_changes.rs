//! Changes of [`Overrides`] and of extra files, in words.

use std::path::PathBuf;
use std::slice;

use crate::extras::Extras;
use resect_core::deployment::{OverrideInWords, Overrides};

/// A key of `deployment.toml`, or an extra file, with another value. Displays as "station numbers 1 2 3 → 1 3 2".
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OverrideChange {
    /// Name in the window.
    pub name: &'static str,
    pub before: String,
    pub after: String,
}

impl std::fmt::Display for OverrideChange {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} {} → {}", self.name, self.before, self.after)
    }
}

/// Returns the values that differ; `as_read` has those of the folder.
pub fn extras_changes(before: &Extras, after: &Extras, as_read: &Overrides) -> Vec<OverrideChange> {
    let whole = |extras: &Extras| Extras {
        corrections: extras.corrections.clone().over(as_read.clone()),
        ..extras.clone()
    };
    named_values(&whole(before))
        .into_iter()
        .zip(named_values(&whole(after)))
        .filter(|(before, after)| before.1 != after.1)
        .map(|((name, before), (_, after))| OverrideChange { name, before, after })
        .collect()
}

/// Returns the keys of `deployment.toml` whose values differ.
pub fn override_changes(before: &Overrides, after: &Overrides) -> Vec<OverrideChange> {
    let only =
        |corrections: &Overrides| Extras { corrections: corrections.clone(), ..Extras::default() };
    extras_changes(&only(before), &only(after), &Overrides::default())
}

/// Text for a value without an override.
const AS_READ: &str = "as read";

/// Returns all values by their names in the window. Extra files replace those of the folder.
fn named_values(extras: &Extras) -> Vec<(&'static str, String)> {
    let Extras { rig, gcp, gcp_instead, gnss, drives, corrections } = extras;
    let mut values: Vec<(&'static str, String)> = corrections
        .in_words()
        .into_iter()
        .map(|OverrideInWords { key, name, value }| {
            let value = match key {
                "rig" => rig.as_ref().map(|path| file_names(slice::from_ref(path))).or(value),
                "control_points" if *gcp_instead => Some(format!("only {}", file_names(gcp))),
                "control_points" if !gcp.is_empty() => Some(file_names(gcp)),
                "gnss" if !gnss.is_empty() => value.or(Some(file_names(gnss))),
                _ => value,
            };
            (name, value.unwrap_or_else(|| AS_READ.to_owned()))
        })
        .collect();
    let drives = if drives.is_empty() { "none".to_owned() } else { file_names(drives) };
    values.push(("further drives", drives));
    values
}

/// Names of the files, without their folders.
fn file_names(paths: &[PathBuf]) -> String {
    let name = |path: &PathBuf| {
        path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
    };
    paths.iter().map(name).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use resect_core::deployment::{PrismConstants, as_numbered};

    #[test]
    fn a_change_is_told_from_what_the_folder_says() {
        let as_read = Overrides { stations: Some([1, 3, 2].into()), ..Overrides::default() };
        let mut after = Extras::default();
        after.corrections.stations = Some(as_numbered(3));
        let told = extras_changes(&Extras::default(), &after, &as_read);
        assert_eq!(told[0].to_string(), "station numbers 1 3 2 → 1 2 3");
    }

    #[test]
    fn changes_are_told_in_words() {
        let corrections = Overrides {
            stations: Some([1, 3, 2].into()),
            prism_constant_m: Some(PrismConstants::All(-0.0345)),
            ..Overrides::default()
        };
        let told: Vec<String> = override_changes(&Overrides::default(), &corrections)
            .iter()
            .map(ToString::to_string)
            .collect();
        assert_eq!(told, ["station numbers 1 2 3 → 1 3 2", "prism constant +10.0 mm → -34.5 mm"]);
        let rig = Extras { rig: Some("/d/rig.csv".into()), ..Extras::default() };
        assert_eq!(
            extras_changes(&Extras::default(), &rig, &Overrides::default())[0].to_string(),
            "rig as read → rig.csv"
        );
    }
}
