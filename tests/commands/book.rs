//! The commands of README and the book: every `sh` and `console` block runs, and prints what the page says.
//!
//! The blocks of a page run in their order in one temporary folder; the pages of the tour share a folder. A block of `console` has commands
//! after `$`, and below each its output. There `…` stands for any text, and alone on a line for any lines. A block with `no_run` in its
//! fence is left out: it opens a window, installs programs, needs a network, or takes minutes.

use std::path::{Path, PathBuf};
use std::process::Command;

/// Blocks that may be marked with `no_run`.
const MOST_NOT_RUN: usize = 4;

struct Block {
    /// Page and line of the fence.
    place: String,
    is_console: bool,
    is_run: bool,
    text: String,
}

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn pages(folder: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(root().join(folder)).expect("a folder");
    let paths = entries.map(|entry| entry.expect("a page").path());
    let mut pages: Vec<PathBuf> =
        paths.filter(|path| path.extension().is_some_and(|extension| extension == "md")).collect();
    pages.sort();
    pages
}

/// The blocks of a page. A fence of another language is no command; a shell's name that is not `sh` is an error.
fn blocks(page: &Path) -> Vec<Block> {
    let text = std::fs::read_to_string(page).expect("a page");
    let (mut blocks, mut open): (Vec<Block>, Option<Option<Block>>) = (Vec::new(), None);
    for (line, content) in text.lines().enumerate() {
        match (&mut open, content.strip_prefix("```")) {
            (None, Some(fence)) => {
                let place = format!("{}:{}", page.display(), line + 1);
                let (language, marks) = fence.split_once(',').unwrap_or((fence, ""));
                let is_known = ["sh", "console", "toml", "json", "python"].contains(&language);
                assert!(
                    is_known && ["", "no_run"].contains(&marks),
                    "{place}: the fence is {fence}"
                );
                open = Some(["sh", "console"].contains(&language).then(|| Block {
                    place,
                    is_console: language == "console",
                    is_run: marks.is_empty(),
                    text: String::new(),
                }));
            }
            (Some(block), Some(_)) => {
                blocks.extend(block.take());
                open = None;
            }
            (Some(Some(block)), None) => block.text += &format!("{content}\n"),
            _ => {}
        }
    }
    assert!(open.is_none(), "{}: an open block", page.display());
    blocks
}

/// Runs a script with resect on the path, and returns its output and errors in their order.
fn run(flags: &str, script: &str, folder: &Path, place: &str) -> String {
    let program = Path::new(env!("CARGO_BIN_EXE_resect")).parent().expect("a folder");
    let path = std::env::var("PATH").expect("a path");
    let output = Command::new("bash")
        .args([flags, &format!("exec 2>&1\n{script}")])
        .current_dir(folder)
        .env("PATH", format!("{}:{path}", program.display()))
        .env("XDG_RUNTIME_DIR", folder)
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("SOURCE_DATE_EPOCH")
        .output()
        .expect("bash");
    let said = String::from_utf8(output.stdout).expect("UTF-8");
    assert!(output.status.success(), "{place}: {script}\n{said}");
    said
}

/// Compares a line with its pattern, in which `…` is any text.
fn fits_line(pattern: &str, line: &str) -> bool {
    let mut parts = pattern.trim_end().split('…');
    let Some(mut rest) = line.trim_end().strip_prefix(parts.next().unwrap_or_default()) else {
        return false;
    };
    let parts: Vec<&str> = parts.collect();
    let Some((last, middle)) = parts.split_last() else { return rest.is_empty() };
    for part in middle {
        let Some((_, after)) = rest.split_once(part) else { return false };
        rest = after;
    }
    rest.ends_with(last)
}

/// Compares lines with their patterns, in which a line of `…` is any lines.
fn fits(patterns: &[&str], lines: &[&str]) -> bool {
    match (patterns, lines) {
        ([], lines) => lines.is_empty(),
        (["…", rest @ ..], lines) => (0..=lines.len()).any(|skip| fits(rest, &lines[skip..])),
        ([pattern, patterns @ ..], [line, lines @ ..]) => {
            fits_line(pattern, line) && fits(patterns, lines)
        }
        _ => false,
    }
}

fn run_console(block: &Block, folder: &Path) {
    for command in format!("\n{}", block.text).split("\n$ ").skip(1) {
        let (command, expected) = command.split_once('\n').unwrap_or((command, ""));
        let said = run("-uc", command, folder, &block.place);
        let [expected, lines] =
            [expected, &said].map(|text| text.trim_end().lines().collect::<Vec<_>>());
        let place = &block.place;
        assert!(
            fits(&expected, &lines),
            "{place}: `{command}` should print\n{expected:#?}\nnot\n{said}"
        );
    }
}

/// Runs the blocks of pages in one folder, and returns the number of those that ran.
fn run_pages(pages: &[PathBuf]) -> usize {
    let folder = tempfile::tempdir().expect("a folder");
    let all: Vec<Block> = pages.iter().flat_map(|page| blocks(page)).collect();
    let to_run: Vec<&Block> = all.iter().filter(|block| block.is_run).collect();
    for block in &to_run {
        if block.is_console {
            run_console(block, folder.path());
        } else {
            run("-euc", &block.text, folder.path(), &block.place);
        }
    }
    to_run.len()
}

#[test]
#[cfg_attr(not(target_os = "linux"), ignore = "the pages have the numbers and pictures of Linux")]
fn the_tour_prints_what_its_pages_say() {
    let count = run_pages(&pages("docs/src/tour"));
    assert!(count >= 12, "only {count} blocks");
}

#[test]
#[cfg_attr(not(target_os = "linux"), ignore = "the pages have the numbers of Linux")]
fn the_how_to_pages_print_what_they_say() {
    let has_python = Command::new("python3").arg("--version").output().is_ok();
    for page in pages("docs/src/howto") {
        // The tests need nothing but Rust.
        if !has_python && blocks(&page).iter().any(|block| block.text.contains("python3")) {
            continue;
        }
        assert!(run_pages(std::slice::from_ref(&page)) > 0, "{} has no command", page.display());
    }
}

#[test]
#[cfg_attr(not(target_os = "linux"), ignore = "the commands are for bash")]
fn the_commands_of_the_other_pages_run() {
    let mut all = pages("docs/src");
    all.push(root().join("README.md"));
    for page in &all {
        run_pages(std::slice::from_ref(page));
    }
}

#[test]
fn few_blocks_do_not_run() {
    let folders = ["docs/src", "docs/src/tour", "docs/src/howto"];
    let mut all: Vec<PathBuf> = folders.iter().flat_map(|folder| pages(folder)).collect();
    all.push(root().join("README.md"));
    let blocks = all.iter().flat_map(|page| blocks(page));
    let left_out: Vec<String> = blocks.filter(|it| !it.is_run).map(|it| it.place).collect();
    assert!(left_out.len() <= MOST_NOT_RUN, "{left_out:?}");
}

#[test]
fn an_ellipsis_is_any_text_or_any_lines_and_nothing_else_differs() {
    let lines = ["one 1.0", "two", "three 3.0 ms"];
    for fitting in
        [&["one 1.0", "two", "three 3.0 ms"][..], &["…"], &["one…", "…"], &["…", "three … ms"]]
    {
        assert!(fits(fitting, &lines), "{fitting:?}");
    }
    for other in
        [&["one 1.0", "two"][..], &["one 1.1", "…"], &["…", "four"], &["…", "three … s"], &[]]
    {
        assert!(!fits(other, &lines), "{other:?}");
    }
}
