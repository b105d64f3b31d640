//! Names and comments: a type name once in a crate, doc comments that begin with their subject.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Folders of the crates' sources.
pub const SOURCES: [&str; 6] = [
    "crates/resect-core/src",
    "crates/resect-tools/src",
    "crates/resect-io/src",
    "crates/resect-live/src",
    "crates/resect-report/src",
    "src",
];
/// First words of a comment that hide its subject.
const HIDING: [&str; 10] =
    ["What", "How", "Whether", "Where", "Which", "Those", "Who", "Of", "And", "Its"];
/// Largest share of comments that begin so.
const MOST_HIDING: f64 = 0.02;

fn rust_files(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            rust_files(&path, files);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
}

/// Rust files of a folder of the repository, with their texts.
pub fn files_of(folder: &str) -> Vec<(PathBuf, String)> {
    let mut files = Vec::new();
    rust_files(&Path::new(env!("CARGO_MANIFEST_DIR")).join(folder), &mut files);
    let read = |path: PathBuf| {
        let text = std::fs::read_to_string(&path).expect("a source file");
        (path, text)
    };
    files.into_iter().map(read).collect()
}

/// Types that are defined outside of test modules and functions.
fn types(text: &str) -> Vec<String> {
    let parsed = syn::parse_file(text).expect("Rust");
    let is_test =
        |attributes: &[syn::Attribute]| attributes.iter().any(|a| a.path().is_ident("cfg"));
    let name = |item: &syn::Item| match item {
        syn::Item::Enum(item) => Some(item.ident.to_string()),
        syn::Item::Struct(item) => Some(item.ident.to_string()),
        syn::Item::Trait(item) => Some(item.ident.to_string()),
        syn::Item::Type(item) if !is_test(&item.attrs) => Some(item.ident.to_string()),
        _ => None,
    };
    parsed.items.iter().filter_map(name).collect()
}

#[test]
fn a_type_name_occurs_once_in_a_crate() {
    let mut twice = Vec::new();
    for folder in SOURCES {
        let mut defined: BTreeMap<String, Vec<PathBuf>> = BTreeMap::new();
        for (path, text) in files_of(folder) {
            let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            if stem == "tests" || stem.ends_with("_tests") {
                continue;
            }
            for name in types(&text) {
                defined.entry(name).or_default().push(path.clone());
            }
        }
        twice.extend(defined.into_iter().filter(|(_, paths)| paths.len() > 1));
    }
    assert!(twice.is_empty(), "{twice:#?}");
}

#[test]
fn comments_begin_with_their_subject() {
    let (mut comments, mut hiding) = (0, Vec::new());
    for (path, text) in SOURCES.into_iter().flat_map(files_of) {
        let mut is_first = true;
        for (number, line) in text.lines().enumerate() {
            let comment =
                ["///", "//!"].iter().find_map(|mark| line.trim_start().strip_prefix(mark));
            let Some(comment) = comment else {
                is_first = true;
                continue;
            };
            if std::mem::take(&mut is_first) {
                comments += 1;
                let first = comment.split_whitespace().next().unwrap_or_default();
                if HIDING.contains(&first) {
                    hiding.push(format!("{}:{}:{comment}", path.display(), number + 1));
                }
            }
        }
    }
    let share = hiding.len() as f64 / f64::from(comments);
    assert!(share <= MOST_HIDING, "{:.1} %:\n{}", 100.0 * share, hiding.join("\n"));
}
