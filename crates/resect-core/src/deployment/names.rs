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

/// Names without the words with which all of them begin, if some name is longer than `longest` letters.
///
/// `room_fastlio2` and `room_prism` become `fastlio2` and `prism`. A name keeps at least two letters, and begins with one.
pub fn without_common_words(names: &[String], longest: usize) -> Vec<String> {
    let is_short = names.iter().all(|name| name.chars().count() <= longest);
    let Some(first) = names.first().filter(|_| names.len() > 1 && !is_short) else {
        return names.to_vec();
    };
    let ends = first.char_indices().filter(|(_, c)| "_-./ ".contains(*c));
    let ends: Vec<usize> = ends.map(|(start, c)| start + c.len_utf8()).collect();
    for end in ends.into_iter().rev() {
        let rests: Option<Vec<&str>> =
            names.iter().map(|name| name.strip_prefix(&first[..end])).collect();
        let is_word = |rest: &&str| {
            rest.starts_with(char::is_alphabetic)
                && rest.chars().filter(|c| c.is_alphabetic()).count() > 1
        };
        if let Some(rests) = rests.filter(|rests| rests.iter().all(is_word)) {
            return rests.into_iter().map(str::to_owned).collect();
        }
    }
    names.to_vec()
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

    #[test]
    fn long_names_lose_the_words_that_all_share() {
        let short = |names: &[&str]| {
            without_common_words(
                &names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>(),
                16,
            )
        };
        assert_eq!(
            short(&["handheld_room00_fastlio2", "handheld_room00_prism"]),
            ["fastlio2", "prism"]
        );
        // No whole word in common, numbers, single letters, one name, short names.
        for same in [
            &["handheld_fastlio_2", "handmade_prism_003"][..],
            &["a-long-name-of-run-1", "a-long-name-of-run-2"][..1],
            &["slam_lidar", "slam_vio"],
        ] {
            assert_eq!(short(same), same);
        }
        assert_eq!(short(&["a-long-name-of-run-1", "a-long-name-of-run-2"]), ["run-1", "run-2"]);
    }
}
