//! Sizes of the crates in lines of code, without tests, comments and blank lines. A change that raises one raises its limit here.

use std::path::Path;

use crate::names::{SOURCES, files_of};

/// Most lines of code of each crate, in the order of [`SOURCES`].
const MOST_LINES: [usize; SOURCES.len()] = [26480, 13961, 13998, 2402, 8399, 33467];

fn is_test(path: &Path) -> bool {
    let mut names = path.iter().filter_map(|name| name.to_str());
    names.any(|name| {
        name == "tests"
            || name.trim_end_matches(".rs").ends_with("tests")
            || name == "simulated_drives.rs"
    })
}

/// Lines of a file that are code; a module of tests stands at its end.
fn lines_of_code(text: &str) -> usize {
    let lines: Vec<&str> = text.lines().collect();
    let begins_tests = |at: usize| {
        lines[at] == "#[cfg(test)]"
            && lines.get(at + 1).is_some_and(|next| next.contains("mod ") && next.ends_with('{'))
    };
    let end = (0..lines.len()).find(|at| begins_tests(*at)).unwrap_or(lines.len());
    let is_code = |line: &&&str| !line.trim().is_empty() && !line.trim_start().starts_with("//");
    lines[..end].iter().filter(is_code).count()
}

#[test]
fn no_crate_grows_unnoticed() {
    let mut grown = Vec::new();
    for (folder, most) in SOURCES.into_iter().zip(MOST_LINES) {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
        let files = files_of(folder)
            .into_iter()
            .filter(|(path, _)| !is_test(path.strip_prefix(&root).expect("below its folder")));
        let lines: usize = files.map(|(_, text)| lines_of_code(&text)).sum();
        println!("{folder}: {lines} lines of code");
        if lines > most {
            grown.push(format!("{folder} has {lines} lines of code, and its limit is {most}"));
        }
    }
    assert!(grown.is_empty(), "{}", grown.join("\n"));
}
