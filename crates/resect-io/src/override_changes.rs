//! Changed overrides in words.

use crate::extras::Extras;
use resect_core::deployment::{AS_NUMBERED, ColumnMapping, Overrides};

/// A changed value. Displays as "station numbers 1 2 3 → 1 3 2".
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

/// Returns the values that differ; `as_read` has those that neither gives.
pub fn extras_changes(before: &Extras, after: &Extras, as_read: &Overrides) -> Vec<OverrideChange> {
    let whole = |extras: &Extras| Extras {
        put_right: extras.put_right.clone().over(as_read.clone()),
        ..extras.clone()
    };
    named_values(&whole(before))
        .into_iter()
        .zip(named_values(&whole(after)))
        .filter(|(before, after)| before.1 != after.1)
        .map(|((name, before), (_, after))| OverrideChange { name, before, after })
        .collect()
}

/// Returns the values of `deployment.toml` that differ.
pub fn override_changes(before: &Overrides, after: &Overrides) -> Vec<OverrideChange> {
    let only = |put_right: &Overrides| Extras { put_right: put_right.clone(), ..Extras::default() };
    extras_changes(&only(before), &only(after), &Overrides::default())
}

/// Text of a value that is not given.
const AS_READ: &str = "as read";

/// Returns all values with their names. The patterns have every field, so that a new one does not compile until it is here.
fn named_values(extras: &Extras) -> Vec<(&'static str, String)> {
    let Extras { rig: rig_path, gcp, gcp_instead, gnss: gnss_paths, drives, put_right } = extras;
    let Overrides {
        name,
        tracks,
        topics,
        stations,
        azimuth,
        prism_constant_m,
        ranges_include_prism_constant,
        inter_prism_m,
        prisms,
        prisms_m,
        gnss,
        control_points,
        rig,
        span_s,
        masked,
        columns,
        surveys,
    } = put_right;
    let file = |path: &std::path::PathBuf| {
        path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
    };
    let files = |paths: &[std::path::PathBuf]| match paths {
        [] => AS_READ.to_owned(),
        paths => paths.iter().map(file).collect::<Vec<_>>().join(", "),
    };
    let or_as_read = |text: Option<String>| text.unwrap_or_else(|| AS_READ.to_owned());
    let control_points = match (control_points, gcp.as_slice()) {
        (Some(names), []) if names.is_empty() => "none".to_owned(),
        (Some(names), []) => names.join(", "),
        (_, paths) if *gcp_instead => format!("only {}", files(paths)),
        (_, paths) => files(paths),
    };
    let rig = rig_path.as_ref().map(file).or(rig.as_ref().map(|it| it.as_slice().join(", ")));
    vec![
        ("name", or_as_read(name.clone())),
        ("tracks", or_as_read(tracks.as_ref().map(|it| it.as_slice().join(", ")))),
        ("topics", or_as_read(topics.as_ref().map(|it| it.join(", ")))),
        ("columns", or_as_read(columns.as_ref().map(column_names))),
        ("surveys", or_as_read(surveys.as_ref().map(|it| it.join(", ")))),
        ("station numbers", in_a_row(&stations.unwrap_or(AS_NUMBERED).map(|n| n.to_string()))),
        ("azimuth", azimuth.unwrap_or_default().title().to_owned()),
        ("prism constant", prism_constant_m.unwrap_or_default().in_words()),
        (
            "ranges",
            or_as_read(ranges_include_prism_constant.map(|include| {
                let what = if include { "contain" } else { "do not contain" };
                format!("{what} the prism constant")
            })),
        ),
        ("inter-prism distances", or_as_read(inter_prism_m.map(metres))),
        ("prisms", or_as_read(prisms.map(|prisms| prisms.to_string()))),
        ("prisms in the vehicle", or_as_read(prisms_m.map(|all| all.map(metres).join("; ")))),
        ("rig", or_as_read(rig)),
        ("control points", control_points),
        ("further drives", if drives.is_empty() { "none".to_owned() } else { files(drives) }),
        ("GNSS", gnss.as_ref().map_or_else(|| files(gnss_paths), |names| names.join(", "))),
        ("span of time", span_s.map_or("all".to_owned(), |[a, b]| format!("{a:.1} to {b:.1} s"))),
        ("readings left out", masked.as_ref().map_or(0, Vec::len).to_string()),
    ]
}

fn in_a_row(words: &[String]) -> String {
    words.join(" ")
}

fn metres(values: [f64; 3]) -> String {
    in_a_row(&values.map(|value| format!("{value:.4}"))) + " m"
}

fn column_names(columns: &ColumnMapping) -> String {
    let ColumnMapping { time, station, range, azimuth, vertical, x, y, z, .. } = columns;
    let others = [station, range, azimuth, vertical, x, y, z];
    let mut names = vec![time.as_str()];
    names.extend(others.into_iter().flatten().map(String::as_str));
    names.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use resect_core::deployment::PrismConstants;

    #[test]
    fn a_change_is_told_from_what_the_folder_says() {
        let as_read = Overrides { stations: Some([1, 3, 2]), ..Overrides::default() };
        let mut after = Extras::default();
        after.put_right.stations = Some(AS_NUMBERED);
        let told = extras_changes(&Extras::default(), &after, &as_read);
        assert_eq!(told[0].to_string(), "station numbers 1 3 2 → 1 2 3");
    }

    #[test]
    fn changes_are_told_in_words() {
        let put_right = Overrides {
            stations: Some([1, 3, 2]),
            prism_constant_m: Some(PrismConstants::All(-0.0345)),
            ..Overrides::default()
        };
        let told: Vec<String> = override_changes(&Overrides::default(), &put_right)
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
