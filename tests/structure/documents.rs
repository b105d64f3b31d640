//! The documents: paths and links that exist, short sentences, a short README.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

const LONGEST_SENTENCE_WORDS: usize = 25;
const LONGEST_README_WORDS: usize = 750;
const LONGEST_README_LINES: usize = 80;

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn text(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// README, CONTRIBUTING and the pages of the book.
fn documents() -> Vec<PathBuf> {
    let mut documents = vec![root().join("README.md"), root().join("CONTRIBUTING.md")];
    let book = std::fs::read_dir(root().join("docs/src")).expect("the book");
    documents.extend(book.map(|entry| entry.expect("a page").path()));
    documents
}

/// Code spans of Markdown or Rust documentation.
fn code_spans(text: &str) -> impl Iterator<Item = &str> {
    text.lines().flat_map(|line| line.split('`').skip(1).step_by(2))
}

/// The file of a path as the map abbreviates it; `None` for anything that is not a path of the repository.
fn file_of(span: &str) -> Option<PathBuf> {
    let is_path = span.contains('/')
        && span.chars().all(|c| c.is_ascii_alphanumeric() || "/._-".contains(c))
        && !span.starts_with(['.', '/']);
    let (first, rest) = span.split_once('/').filter(|_| is_path)?;
    let folder = match first {
        "core" | "io" | "live" | "report" => format!("crates/resect-{first}/src"),
        "app" | "command" => format!("src/{first}"),
        "src" | "crates" | "tests" | "benches" | "examples" | "assets" | "docs" | "fuzz" => {
            first.to_owned()
        }
        _ => return None,
    };
    Some(root().join(folder).join(rest))
}

#[test]
fn every_path_of_the_maps_exists() {
    let mut missing = Vec::new();
    let mut maps: Vec<String> = ["CONTRIBUTING.md", "src/lib.rs", "src/app/mod.rs"]
        .map(|map| text(&root().join(map)))
        .into();
    maps.extend(documents().iter().map(|document| text(document)));
    let spans: BTreeSet<&str> = maps.iter().flat_map(|map| code_spans(map)).collect();
    let mut paths = 0;
    for span in spans {
        let Some(file) = file_of(span) else { continue };
        paths += 1;
        if !file.exists() {
            missing.push(format!("`{span}`"));
        }
    }
    assert!(paths > 80, "only {paths} paths were recognised");
    assert!(missing.is_empty(), "these paths do not exist: {}", missing.join(", "));
}

#[test]
fn every_link_of_the_documents_leads_somewhere() {
    let mut dead = Vec::new();
    for document in documents() {
        let folder = document.parent().expect("a folder").to_owned();
        for link in text(&document).split("](").skip(1) {
            let target = link.split([')', '#']).next().unwrap_or_default();
            if !target.starts_with("http") && !target.is_empty() && !folder.join(target).exists() {
                dead.push(format!("{}: {target}", document.display()));
            }
        }
    }
    assert!(dead.is_empty(), "dead links:\n{}", dead.join("\n"));
    let summary = text(&root().join("docs/src/SUMMARY.md"));
    for page in std::fs::read_dir(root().join("docs/src")).expect("the book") {
        let name = page.expect("a page").file_name();
        let name = name.to_string_lossy();
        assert!(name == "SUMMARY.md" || summary.contains(&*name), "SUMMARY.md lacks {name}");
    }
}

/// Sentences of Markdown without tables, code blocks and headings.
fn sentences(markdown: &str) -> Vec<String> {
    let (mut prose, mut in_code) = (String::new(), false);
    for line in markdown.lines() {
        if line.starts_with("```") {
            in_code = !in_code;
        } else if !in_code {
            match line.trim_start() {
                "" => prose += ".\n",
                line if line.starts_with(['|', '#', '!']) => prose += ".\n",
                line if line.starts_with("- ") || line.as_bytes().get(1) == Some(&b'.') => {
                    prose = prose + ".\n" + line + " ";
                }
                line => prose = prose + line + " ",
            }
        }
    }
    let ends = |c: char| matches!(c, '.' | ':' | ';' | '?' | '!');
    let mut sentences = vec![String::new()];
    for word in prose.split_whitespace() {
        let last = sentences.last_mut().expect("a sentence");
        *last = format!("{last} {word}");
        if word.trim_end_matches([')', '*', '`', '"']).ends_with(ends) {
            sentences.push(String::new());
        }
    }
    sentences
}

#[test]
fn sentences_of_the_documents_are_short() {
    let mut long = Vec::new();
    for document in documents() {
        for sentence in sentences(&text(&document)) {
            let words = sentence.split_whitespace().count();
            if words > LONGEST_SENTENCE_WORDS {
                long.push(format!("{} ({words} words):{sentence}", document.display()));
            }
        }
    }
    assert!(long.is_empty(), "{}", long.join("\n"));
}

#[test]
fn the_readme_is_short() {
    let readme = text(&root().join("README.md"));
    let (words, lines) = (readme.split_whitespace().count(), readme.lines().count());
    assert!(words <= LONGEST_README_WORDS, "{words} words");
    assert!(lines <= LONGEST_README_LINES, "{lines} lines");
}
