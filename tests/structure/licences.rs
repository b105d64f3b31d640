//! The licences of all packages in the program, which `resect licences` prints.
//!
//! `UPDATE_GOLDEN=1 cargo test --test structure licences` rewrites them after a change of dependencies.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

/// Targets of the releases; tests compare the packages of the first.
const TARGETS: [&str; 5] = [
    "x86_64-unknown-linux-gnu",
    "aarch64-unknown-linux-gnu",
    "x86_64-pc-windows-msvc",
    "x86_64-apple-darwin",
    "aarch64-apple-darwin",
];
const HEADING: &str = "PACKAGES IN THE PROGRAM";

/// A package that the program contains.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Package {
    name: String,
    version: String,
    licence: String,
    folder: std::path::PathBuf,
}

impl Package {
    fn line(&self) -> String {
        format!("{} {} ({})", self.name, self.version, self.licence)
    }
}

/// Returns the packages of the program for a target: its dependencies without those of builds and tests.
fn packages(target: &str) -> BTreeSet<Package> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .args(["metadata", "--format-version", "1", "--locked", "--filter-platform", target])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let metadata: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
    let id = |value: &Value| value["id"].as_str().expect("an id").to_owned();
    let nodes: BTreeMap<String, Value> =
        list(&metadata["resolve"]["nodes"]).into_iter().map(|node| (id(&node), node)).collect();
    let all = list(&metadata["packages"]);
    let root = all.iter().find(|package| package["name"] == "resect").map(id).expect("the root");
    let (mut reached, mut waiting) = (BTreeSet::new(), vec![root]);
    while let Some(next) = waiting.pop() {
        if reached.insert(next.clone()) {
            for dependency in list(&nodes[&next]["deps"]) {
                // A kind of null is neither of builds nor of tests.
                if list(&dependency["dep_kinds"]).iter().any(|kind| kind["kind"].is_null()) {
                    waiting.push(dependency["pkg"].as_str().expect("an id").to_owned());
                }
            }
        }
    }
    let is_of_others = |package: &&Value| {
        reached.contains(&id(package))
            && (!package["source"].is_null() || package["name"] == "egui-wgpu")
    };
    let text = |value: &Value| value.as_str().unwrap_or("licence not stated").to_owned();
    let of = |package: &Value| Package {
        name: text(&package["name"]),
        version: text(&package["version"]),
        licence: text(&package["license"]),
        folder: Path::new(&text(&package["manifest_path"])).parent().expect("a folder").into(),
    };
    all.iter().filter(is_of_others).map(of).collect()
}

/// Returns the texts of licences and notices in a package. Where there is a choice of licences, that of MIT is enough.
fn texts(package: &Package) -> Vec<String> {
    let Ok(folder) = std::fs::read_dir(&package.folder) else { return Vec::new() };
    let mut files: Vec<_> = folder
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.is_file())
        .map(|path| (path.file_name().unwrap_or_default().to_ascii_lowercase(), path))
        .map(|(name, path)| (name.to_string_lossy().into_owned(), path))
        .filter(|(name, _)| {
            ["licen", "copying", "notice", "unlicense"].iter().any(|word| name.starts_with(word))
        })
        .collect();
    files.sort();
    let is_choice = package.licence.contains(" OR ") || package.licence.contains('/');
    if is_choice && files.iter().any(|(name, _)| name.contains("mit")) {
        files.retain(|(name, _)| name.contains("mit") || name.starts_with("notice"));
    }
    let read = |path: &Path| {
        let bytes = std::fs::read(path).expect("readable");
        String::from_utf8_lossy(&bytes).replace('\r', "").trim().to_owned()
    };
    files.iter().map(|(_, path)| read(path)).collect()
}

/// Returns the list of packages, then each text once, below the names of its packages.
fn written(packages: &BTreeSet<Package>) -> String {
    let mut all = format!("{HEADING}\n\n");
    packages.iter().for_each(|package| _ = writeln!(all, "{}", package.line()));
    let mut by_text: BTreeMap<String, Vec<&str>> = BTreeMap::new();
    for package in packages {
        for text in texts(package) {
            let names = by_text.entry(text).or_default();
            if names.last() != Some(&&*package.name) {
                names.push(&package.name);
            }
        }
    }
    let mut by_name: Vec<(Vec<&str>, String)> =
        by_text.into_iter().map(|(text, names)| (names, text)).collect();
    by_name.sort();
    for (names, text) in by_name {
        _ = write!(all, "\n{}\n{}\n\n{text}\n", "-".repeat(80), names.join(", "));
    }
    all
}

#[test]
fn the_program_has_the_licences_of_all_its_packages() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/licences.txt.zst");
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        let all = TARGETS.iter().flat_map(|target| packages(target)).collect();
        let bytes = zstd::encode_all(written(&all).as_bytes(), 19).expect("in memory");
        std::fs::write(&file, bytes).expect("writable");
    }
    let text = resect::licences::text();
    assert!(text.starts_with("MIT License"), "the program's own licence is first");
    let lines: BTreeSet<&str> = text.lines().collect();
    let now = packages(TARGETS[0]);
    assert!(now.len() > 200, "only {} packages", now.len());
    let missing: Vec<String> =
        now.iter().map(Package::line).filter(|line| !lines.contains(&**line)).collect();
    assert!(
        missing.is_empty(),
        "UPDATE_GOLDEN=1 cargo test --test structure licences; missing: {missing:?}"
    );
}
