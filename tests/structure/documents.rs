//! The documents: paths and links that exist, short sentences, a short README.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crate::names::{SOURCES, files_of};

const LONGEST_SENTENCE_WORDS: usize = 25;
const LONGEST_README_WORDS: usize = 750;
const LONGEST_README_LINES: usize = 80;

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn text(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Compares a generated page with its file; `UPDATE_GOLDEN=1` writes it first.
pub fn assert_written(path: &str, page: &str) {
    let file = root().join(path);
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&file, page).expect("written");
    }
    let written = text(&file);
    let differs = page.lines().zip(written.lines()).find(|(code, page)| code != page);
    assert!(page == written, "the page differs from the code, first here: {differs:#?}");
}

/// README, CONTRIBUTING and the pages of the book.
fn documents() -> Vec<PathBuf> {
    let mut documents = vec![root().join("README.md"), root().join("CONTRIBUTING.md")];
    documents.extend(pages());
    documents
}

/// The pages of the book: those of `docs/src` and of its folders.
fn pages() -> Vec<PathBuf> {
    let (mut pages, mut folders) = (Vec::new(), vec![root().join("docs/src")]);
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            match path.extension() {
                None => folders.push(path),
                Some(extension) if extension == "md" => pages.push(path),
                Some(_) => {}
            }
        }
    }
    pages
}

/// Anchors of the headings of a page, as mdBook and GitHub write them.
fn anchors(markdown: &str) -> BTreeSet<String> {
    let headings = markdown.lines().filter(|line| line.starts_with('#'));
    headings.map(|line| anchor(line.trim_start_matches('#').trim())).collect()
}

/// Returns the anchor of a heading.
pub fn anchor(heading: &str) -> String {
    let kept = heading.chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c));
    kept.collect::<String>().to_lowercase().replace(' ', "-")
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
        "core" | "tools" | "io" | "live" | "report" => format!("crates/resect-{first}/src"),
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
fn every_file_of_the_maps_of_the_crates_exists() {
    let mut missing = Vec::new();
    for source in SOURCES.into_iter().chain(["python/src"]) {
        let map = text(&root().join(source).join("lib.rs"));
        let head: Vec<&str> = map.lines().filter(|line| line.starts_with("//!")).collect();
        let head = head.join("\n");
        let files = files_of(source);
        for span in code_spans(&head).filter(|span| span.ends_with(".rs")) {
            let is_there = files.iter().any(|(path, _)| path.ends_with(span));
            if !is_there && !root().join(span).exists() {
                missing.push(format!("{source}/lib.rs: `{span}`"));
            }
        }
    }
    assert!(missing.is_empty(), "these files do not exist: {}", missing.join(", "));
}

#[test]
fn every_link_of_the_documents_leads_somewhere() {
    let mut dead = Vec::new();
    for document in documents() {
        let folder = document.parent().expect("a folder").to_owned();
        let own = text(&document);
        for link in own.split("](").skip(1) {
            let link = link.split(')').next().unwrap_or_default();
            let (target, anchor) = link.split_once('#').unwrap_or((link, ""));
            if target.starts_with("http") {
                continue;
            }
            let file = folder.join(target);
            let page = if target.is_empty() { Some(own.clone()) } else { page_at(&file) };
            let has_anchor = || page.is_some_and(|page| anchors(&page).contains(anchor));
            let is_alive = target.is_empty() || file.exists();
            if !is_alive || (!anchor.is_empty() && !has_anchor()) {
                dead.push(format!("{}: {link}", document.display()));
            }
        }
    }
    assert!(dead.is_empty(), "dead links:\n{}", dead.join("\n"));
}

/// The text of a link's target, if it is a page.
fn page_at(file: &Path) -> Option<String> {
    file.extension().is_some_and(|extension| extension == "md").then(|| text(file))
}

#[test]
fn the_summary_has_every_page_of_the_book() {
    let book = root().join("docs/src");
    let summary = text(&book.join("SUMMARY.md"));
    for page in pages() {
        let name = page.strip_prefix(&book).expect("a page of the book").display().to_string();
        let is_listed = summary.contains(&format!("]({name})"));
        assert!(name == "SUMMARY.md" || is_listed, "SUMMARY.md lacks {name}");
    }
}

/// Each picture of the book is small, and its command is beside it.
#[test]
fn pictures_of_the_book_are_few_small_and_have_their_commands() {
    const MOST: usize = 3;
    const MOST_BYTES: u64 = 120_000;
    let pictures = std::fs::read_dir(root().join("docs/src/pictures")).expect("the pictures");
    let pictures: Vec<PathBuf> = pictures.map(|entry| entry.expect("a picture").path()).collect();
    assert!(pictures.len() <= MOST, "{} pictures", pictures.len());
    for picture in pictures {
        let bytes = picture.metadata().expect("a file").len();
        assert!(bytes < MOST_BYTES, "{}: {bytes} bytes", picture.display());
        let name = picture.file_name().expect("a name").to_string_lossy().into_owned();
        let has_both = |page: &String| {
            let commands = page.lines().filter(|line| line.starts_with("resect screenshot"));
            page.contains(&format!("pictures/{name})"))
                && commands.clone().any(|line| line.ends_with(&format!("--out {name}")))
        };
        assert!(pages().iter().map(|page| text(page)).any(|page| has_both(&page)), "{name}");
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
