//! Unique names of deployments: two folders may have the same name.

use std::path::{Component, Path};

/// Returns each name with as many folder names as needed to be unique.
///
/// Folders of the same name become `run1/data` and `run2/data`; deployments that their files name alike become `drive, monday`
/// and `drive, tuesday`. Names that no path distinguishes are numbered.
pub fn told_apart(named: &[(String, Option<&Path>)]) -> Vec<String> {
    let mut names: Vec<String> = named.iter().map(|(name, _)| name.clone()).collect();
    for (first, (name, _)) in named.iter().enumerate() {
        let same: Vec<usize> = (first..named.len()).filter(|at| named[*at].0 == *name).collect();
        if same.len() < 2 || named[..first].iter().any(|(earlier, _)| earlier == name) {
            continue;
        }
        let with = |parts: usize| same.iter().map(move |at| longer(&named[*at], parts));
        let deepest = same.iter().map(|at| parts(named[*at].1).count()).max().unwrap_or(0);
        let enough = (1..=deepest).find(|parts| all_differ(with(*parts)));
        let longer: Vec<String> = with(enough.unwrap_or(0)).collect();
        for (number, (at, longer)) in same.iter().zip(longer).enumerate() {
            let alike = enough.is_none() && number > 0;
            names[*at] = if alike { format!("{longer} ({})", number + 1) } else { longer };
        }
    }
    names
}

/// Names of the components of a path, the last one first.
fn parts(place: Option<&Path>) -> impl Iterator<Item = String> {
    place.into_iter().flat_map(|place| place.components().rev()).filter_map(|part| match part {
        Component::Normal(name) => Some(name.to_string_lossy().into_owned()),
        _ => None,
    })
}

/// Name with the last `count` components of its path.
fn longer((name, place): &(String, Option<&Path>), count: usize) -> String {
    let mut parts: Vec<String> = parts(*place).take(count).collect();
    let named_after_it = parts.first() == Some(name);
    parts.reverse();
    match parts.join("/") {
        tail if tail.is_empty() => name.clone(),
        tail if named_after_it => tail,
        tail => format!("{name}, {tail}"),
    }
}

fn all_differ(names: impl Iterator<Item = String>) -> bool {
    let mut names: Vec<String> = names.collect();
    names.sort();
    names.windows(2).all(|two| two[0] != two[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(named: &[(&str, &str)]) -> Vec<String> {
        let place = |path: &'static str| Some(Path::new(path)).filter(|_| !path.is_empty());
        let named: Vec<(String, Option<&Path>)> = named
            .iter()
            .map(|(name, path)| ((*name).to_owned(), place(String::leak((*path).to_owned()))))
            .collect();
        told_apart(&named)
    }

    #[test]
    fn only_what_is_called_the_same_gets_folders_and_no_more_than_it_needs() {
        let three = names(&[
            ("data", "/day/run1/data"),
            ("warthog", "/day/warthog"),
            ("data", "/day/run2/data"),
        ]);
        assert_eq!(three, ["run1/data", "warthog", "run2/data"]);
        let deeper = names(&[("data", "/monday/run1/data"), ("data", "/tuesday/run1/data")]);
        assert_eq!(deeper, ["monday/run1/data", "tuesday/run1/data"]);
        let given = names(&[("drive", "/day/morning"), ("drive", "/day/noon")]);
        assert_eq!(given, ["drive, morning", "drive, noon"]);
    }

    #[test]
    fn what_came_from_no_file_is_numbered() {
        assert_eq!(
            names(&[("line", ""), ("line", ""), ("line", "")]),
            ["line", "line (2)", "line (3)"]
        );
        assert_eq!(names(&[("line", ""), ("line", "/made/a")]), ["line", "line, a"]);
    }
}
