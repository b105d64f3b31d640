//! Structure of the source compared with its maps: no circular imports, no imports from lower layers, and small packages.

#![allow(clippy::print_stdout, reason = "the counts of files and arrows are worth reading")]

mod constants;
mod documents;
mod findings_page;
mod licences;
mod names;
mod packed_schema;
mod settings_page;
mod sizes;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use syn::visit::{self, Visit};

/// Path of a module below its crate: `["app", "state", "handle"]`; empty for `lib.rs`.
type Module = Vec<String>;

/// Folders of the crates of the workspace, and the least number of imports between files that the parser must find there.
const CRATES: [(&str, usize); 6] = [
    ("crates/resect-core", 400),
    ("crates/resect-tools", 100),
    ("crates/resect-io", 100),
    ("crates/resect-live", 30),
    ("crates/resect-report", 30),
    (".", 200),
];

/// Importing file, defining file, and the imported paths.
type Arrows<'a> = BTreeMap<(&'a Module, &'a Module), BTreeSet<String>>;

/// Definitions and imports of a file.
#[derive(Default)]
struct File {
    path: PathBuf,
    /// True for `mod.rs` or `lib.rs`, which declares the files of its folder and re-exports their items.
    is_face: bool,
    /// True if it has items other than declarations of modules and imports.
    has_code: bool,
    children: BTreeSet<String>,
    defines: BTreeSet<String>,
    /// Path below the crate of each imported name.
    imports: BTreeMap<String, Module>,
    /// Every path in the file, as written.
    written: BTreeSet<Vec<String>>,
    /// Every imported path, below the crate.
    named: BTreeSet<Module>,
}

struct Crate {
    files: BTreeMap<Module, File>,
    /// Modules of the table of `lib.rs`, row by row.
    table: Vec<Vec<String>>,
}

impl Crate {
    fn read(folder: &str) -> Self {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder).join("src/lib.rs");
        let map = std::fs::read_to_string(&root).expect("the map");
        let row = |line: &str| -> Option<Vec<String>> {
            let cell = line.strip_prefix("//! | [`")?.split(" | ").next()?;
            let names = cell.split("[`").filter_map(|name| name.split_once('`'));
            Some(names.map(|(name, _)| name.to_owned()).collect())
        };
        let table = map.lines().filter_map(row).collect();
        let mut all = Self { files: BTreeMap::new(), table };
        all.add(&root, &[]);
        all
    }

    /// Adds a file, and those that it declares.
    fn add(&mut self, path: &Path, module: &[String]) {
        let text = std::fs::read_to_string(path)
            .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let parsed = syn::parse_file(&text).expect("Rust");
        let name = path.file_stem().expect("a name");
        let is_face = name == "mod" || name == "lib";
        let file = File { path: path.to_owned(), is_face, ..File::default() };
        let mut reading = Reading { module, file };
        reading.visit_file(&parsed);
        let file = reading.finish();
        let folder = path.parent().expect("a folder");
        let folder = if is_face { folder.to_owned() } else { folder.join(name) };
        for child in &file.children {
            let own = [module, std::slice::from_ref(child)].concat();
            let alone = folder.join(format!("{child}.rs"));
            let in_folder = folder.join(child).join("mod.rs");
            self.add(if alone.exists() { &alone } else { &in_folder }, &own);
        }
        self.files.insert(module.to_vec(), file);
    }

    /// Returns the file that defines the item of a path, through re-exports.
    fn defining(&self, path: &[String]) -> &Module {
        let length = (0..=path.len()).rev().find(|n| self.files.contains_key(&path[..*n]));
        let length = length.expect("lib.rs");
        let (module, file) = self.files.get_key_value(&path[..length]).expect("found above");
        let Some(name) = path.get(length).filter(|name| !file.defines.contains(*name)) else {
            return module;
        };
        let from = file.imports.get(name).map(|from| [from, &path[length + 1..]].concat());
        match from.filter(|from| from != path) {
            Some(from) => self.defining(&from),
            None => module,
        }
    }

    /// Returns the imports between the files of the crate.
    fn arrows(&self) -> Arrows<'_> {
        let mut arrows = Arrows::new();
        for (to, file) in &self.files {
            for path in &file.named {
                let from = self.defining(path);
                // A face re-exports the items of its own files.
                let is_own = file.is_face && from.starts_with(to);
                if from != to && !is_own {
                    arrows.entry((to, from)).or_default().insert(path.join("::"));
                }
            }
        }
        arrows
    }

    /// Returns the circular imports among the files and folders directly in a module; the module's own file is one of them.
    fn circles_in(&self, folder: &Module, arrows: &Arrows<'_>) -> Vec<String> {
        let child = |module: &Module| {
            module.get(folder.len()).map_or_else(|| "(itself)".to_owned(), Clone::clone)
        };
        let mut next: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
        let mut words: BTreeMap<(String, String), Vec<String>> = BTreeMap::new();
        for ((to, from), names) in arrows {
            let (a, b) = (child(to), child(from));
            if to.starts_with(folder) && from.starts_with(folder) && a != b {
                let line = format!("  {} imports {names:?}", self.files[*to].path.display());
                next.entry(a.clone()).or_default().insert(b.clone());
                words.entry((a, b)).or_default().push(line);
            }
        }
        let describe = |circle: &BTreeSet<String>| {
            let inside = |(a, b): &(String, String)| circle.contains(a) && circle.contains(b);
            let lines = words.iter().filter(|(pair, _)| inside(pair)).flat_map(|(_, lines)| lines);
            let lines: Vec<&str> = lines.map(String::as_str).collect();
            format!("in {}: {circle:?}\n{}", folder.join("::"), lines.join("\n"))
        };
        circles(&next).iter().map(describe).collect()
    }
}

/// Returns the sets of nodes that reach each other.
fn circles(next: &BTreeMap<String, BTreeSet<String>>) -> BTreeSet<BTreeSet<String>> {
    let reach = |start: &String| {
        let mut seen: BTreeSet<&String> = BTreeSet::new();
        let mut waiting: Vec<&String> = next[start].iter().collect();
        while let Some(node) = waiting.pop() {
            if seen.insert(node) {
                waiting.extend(next.get(node).into_iter().flatten());
            }
        }
        seen
    };
    let reached: BTreeMap<&String, _> = next.keys().map(|node| (node, reach(node))).collect();
    let in_circle = reached.iter().filter(|(node, seen)| seen.contains(*node));
    in_circle
        .map(|(node, seen)| {
            let back = |other: &&&String| reached.get(*other).is_some_and(|r| r.contains(*node));
            seen.iter().filter(back).map(|other| (*other).clone()).collect()
        })
        .collect()
}

/// Collector of the definitions and paths of a file.
struct Reading<'a> {
    module: &'a [String],
    file: File,
}

impl Reading<'_> {
    /// Returns the path below the crate; `None` for paths of other crates.
    fn absolute(&self, path: &[String]) -> Option<Module> {
        let first = path.first()?;
        match first.as_str() {
            "crate" => Some(path[1..].to_vec()),
            "self" => Some([self.module, &path[1..]].concat()),
            "super" => {
                let up = path.iter().take_while(|part| *part == "super").count();
                let kept = self.module.len().checked_sub(up)?;
                Some([&self.module[..kept], &path[up..]].concat())
            }
            name if self.file.children.contains(name) => Some([self.module, path].concat()),
            name => {
                let import = self.file.imports.get(name)?;
                Some([import, &path[1..]].concat())
            }
        }
    }

    fn add_use(&mut self, tree: &syn::UseTree, before: &[String]) {
        let with = |name: &syn::Ident| [before, &[name.to_string()]].concat();
        match tree {
            syn::UseTree::Path(path) => self.add_use(&path.tree, &with(&path.ident)),
            syn::UseTree::Group(group) => {
                group.items.iter().for_each(|tree| self.add_use(tree, before));
            }
            syn::UseTree::Name(name) if name.ident == "self" => {
                let own = before.last().cloned().unwrap_or_default();
                self.import(before, own);
            }
            syn::UseTree::Name(name) => self.import(&with(&name.ident), name.ident.to_string()),
            syn::UseTree::Rename(name) => self.import(&with(&name.ident), name.rename.to_string()),
            syn::UseTree::Glob(_) => {
                self.file.written.insert(before.to_vec());
            }
        }
    }

    fn import(&mut self, path: &[String], as_name: String) {
        if let Some(path) = self.absolute(path) {
            self.file.imports.insert(as_name, path.clone());
            self.file.named.insert(path);
        }
    }

    /// Resolves all paths, once all imports are known.
    fn finish(mut self) -> File {
        let paths = std::mem::take(&mut self.file.written);
        let absolute = paths.iter().filter_map(|path| self.absolute(path));
        let absolute: Vec<Module> = absolute.filter(|path| !path.is_empty()).collect();
        self.file.named.extend(absolute);
        self.file
    }
}

fn is_test(attributes: &[syn::Attribute]) -> bool {
    let is_test = |attribute: &syn::Attribute| {
        attribute.path().is_ident("cfg")
            && attribute.parse_args::<syn::Ident>().is_ok_and(|condition| condition == "test")
    };
    attributes.iter().any(is_test)
}

impl<'ast> Visit<'ast> for Reading<'_> {
    fn visit_file(&mut self, file: &'ast syn::File) {
        for item in &file.items {
            let name = match item {
                syn::Item::Const(item) => Some(&item.ident),
                syn::Item::Enum(item) => Some(&item.ident),
                syn::Item::Fn(item) => Some(&item.sig.ident),
                syn::Item::Static(item) => Some(&item.ident),
                syn::Item::Struct(item) => Some(&item.ident),
                syn::Item::Trait(item) => Some(&item.ident),
                syn::Item::Type(item) => Some(&item.ident),
                syn::Item::Mod(item) if item.content.is_none() && !is_test(&item.attrs) => {
                    self.file.children.insert(item.ident.to_string());
                    None
                }
                _ => None,
            };
            self.file.defines.extend(name.map(ToString::to_string));
            self.file.has_code |= match item {
                syn::Item::Mod(item) => item.content.is_some() && !is_test(&item.attrs),
                syn::Item::Use(_) => false,
                _ => true,
            };
        }
        visit::visit_file(self, file);
    }

    fn visit_item_mod(&mut self, item: &'ast syn::ItemMod) {
        if !is_test(&item.attrs) {
            visit::visit_item_mod(self, item);
        }
    }

    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        self.add_use(&item.tree, &[]);
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let parts = path.segments.iter().map(|part| part.ident.to_string()).collect();
        self.file.written.insert(parts);
        visit::visit_path(self, path);
    }

    /// Reads the paths that begin with `crate` or `super`, since the arguments of macros have no syntax tree.
    fn visit_macro(&mut self, item: &'ast syn::Macro) {
        let text = item.tokens.to_string();
        let words: Vec<&str> = text.split_whitespace().collect();
        for start in (0..words.len()).filter(|i| ["crate", "super"].contains(&words[*i])) {
            let mut path = vec![words[start].to_owned()];
            let mut rest = words[start + 1..].chunks_exact(2);
            while let Some(["::", name]) = rest.next() {
                path.push((*name).to_owned());
            }
            let after = start + 2 * path.len() - 1;
            // A macro has no module.
            if words.get(after) != Some(&"!") {
                self.file.written.insert(path);
            }
        }
    }

    // A link in the documentation is no import.
    fn visit_attribute(&mut self, _: &'ast syn::Attribute) {}
}

/// The modules of the window: each imports only from those after it.
const WINDOW: [&str; 19] = [
    "picture",
    "window",
    "panels",
    "actions",
    "saved_state",
    "scene",
    "plots",
    "state",
    "persist",
    "layout",
    "pictures",
    "model",
    "prepared",
    "jobs",
    "display_server",
    "file_dialog",
    "theme",
    "words",
    "short",
];

#[test]
fn a_module_of_the_window_imports_only_from_those_below() {
    let window = Crate::read(".");
    let height = |module: &str| {
        WINDOW.iter().position(|known| *known == module).unwrap_or_else(|| {
            panic!("src/app/{module} is new: add it here, and to the picture in src/app/mod.rs")
        })
    };
    let inside = |module: &Module| module.len() > 1 && module[0] == "app";
    let arrows = window.arrows();
    let arrows: Vec<_> = arrows
        .iter()
        .filter(|((to, from), _)| inside(to) && inside(from) && to[1] != from[1])
        .collect();
    assert!(arrows.len() > 100, "only {} arrows were found", arrows.len());
    let back: Vec<String> = arrows
        .iter()
        .filter(|((to, from), _)| height(&to[1]) >= height(&from[1]))
        .map(|((to, _), names)| format!("{} imports {names:?}", to.join("::")))
        .collect();
    assert!(back.is_empty(), "imports from above:\n{}", back.join("\n"));
}

#[test]
fn a_module_imports_only_from_those_above_it_in_the_table_of_its_crate() {
    for (folder, least) in CRATES {
        let read = Crate::read(folder);
        let row = |module: &str| {
            read.table.iter().position(|row| row.iter().any(|name| name == module)).unwrap_or_else(
                || panic!("{folder}: the module {module} is not in the table of lib.rs"),
            )
        };
        for module in &read.files[&Vec::new()].children {
            row(module);
        }
        let arrows = read.arrows();
        assert!(arrows.len() > least, "{folder}: only {} arrows were found", arrows.len());
        let back: Vec<String> = arrows
            .iter()
            .filter(|((to, _), _)| !to.is_empty())
            .filter(|((to, from), _)| from.is_empty() || row(&to[0]) < row(&from[0]))
            .map(|((to, _), names)| format!("{} imports {names:?}", to.join("::")))
            .collect();
        assert!(back.is_empty(), "{folder}: imports from below:\n{}", back.join("\n"));
    }
}

#[test]
fn no_files_or_folders_of_a_module_import_each_other() {
    let mut found = Vec::new();
    for (folder, _) in CRATES {
        let read = Crate::read(folder);
        let parents: BTreeSet<&Module> = read
            .files
            .iter()
            .filter(|(_, file)| !file.children.is_empty())
            .map(|(module, _)| module)
            .collect();
        let arrows = read.arrows();
        println!("{folder}: {} files, {} arrows", read.files.len(), arrows.len());
        found.extend(parents.into_iter().flat_map(|module| read.circles_in(module, &arrows)));
    }
    assert!(found.is_empty(), "{} circles:\n{}", found.len(), found.join("\n\n"));
}

#[test]
fn a_mod_rs_only_declares_and_re_exports() {
    let mut with_code = Vec::new();
    for (folder, _) in CRATES {
        let read = Crate::read(folder);
        let faces = read.files.into_values().filter(|file| file.is_face && file.has_code);
        with_code.extend(faces.map(|file| file.path));
    }
    assert!(with_code.is_empty(), "code in {with_code:#?}");
}

/// Largest released program (bytes).
const MOST_PROGRAM_BYTES: u64 = 40_000_000;

#[test]
#[cfg_attr(
    debug_assertions,
    ignore = "of the program as it is released: cargo test --release --test structure"
)]
fn the_released_program_is_small() {
    let bytes = std::fs::metadata(env!("CARGO_BIN_EXE_resect")).expect("built").len();
    assert!(bytes < MOST_PROGRAM_BYTES, "{bytes} bytes");
}
