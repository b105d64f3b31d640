//! The imports against the picture of the rooms: what stands below knows nothing of what stands above it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use syn::visit::{self, Visit};

/// A module's path below the crate: `["app", "state", "handle"]`.
type Module = Vec<String>;

/// What a file defines, and what it takes from elsewhere.
#[derive(Default)]
struct File {
    /// `mod.rs`, which declares the files of its folder and hands on what they define.
    is_face: bool,
    defines: BTreeSet<String>,
    /// By the name that it has here, where it comes from.
    imports: BTreeMap<String, Module>,
    /// Everything that is named by a path from the crate, the parent or itself.
    named: BTreeSet<Module>,
}

struct House {
    files: BTreeMap<Module, File>,
}

impl House {
    fn read(src: &Path) -> Self {
        let mut house = Self { files: BTreeMap::new() };
        house.add_folder(src, &Vec::new());
        house
    }

    fn add_folder(&mut self, folder: &Path, module: &Module) {
        let mut entries: Vec<_> = std::fs::read_dir(folder)
            .expect("a folder")
            .map(|entry| entry.expect("an entry").path())
            .collect();
        entries.sort();
        for path in entries {
            let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
            let mut own = module.clone();
            own.push(name.clone());
            if path.is_dir() {
                self.add_folder(&path, &own);
            } else if path.extension().is_some_and(|extension| extension == "rs")
                && !name.ends_with("tests")
            {
                let is_face = name == "mod";
                if is_face {
                    own.pop();
                }
                let text = std::fs::read_to_string(&path).expect("readable");
                let parsed = syn::parse_file(&text).expect("Rust");
                let mut reading =
                    Reading { module: &own, file: File { is_face, ..File::default() } };
                reading.visit_file(&parsed);
                let file = reading.file;
                self.files.insert(own, file);
            }
        }
    }

    /// The file that defines what a path names, through all that only hands it on.
    fn defining(&self, path: &[String]) -> Option<&Module> {
        let length = (1..=path.len()).rev().find(|n| self.files.contains_key(&path[..*n]))?;
        let (module, file) = self.files.get_key_value(&path[..length])?;
        let handed_on = path.get(length).filter(|name| !file.defines.contains(*name));
        let from = handed_on.and_then(|name| file.imports.get(name));
        // What hands on itself is a mistake of this reading.
        match from.filter(|from| from[..] != path[..from.len().min(path.len())]) {
            Some(from) => self.defining(from),
            None => Some(module),
        }
    }

    /// From which file to which something is taken, and what, below a module.
    fn arrows(&self, place: &str) -> BTreeMap<(&Module, &Module), BTreeSet<String>> {
        let inside = |module: &Module| module.len() > 1 && module[0] == place;
        let mut arrows: BTreeMap<_, BTreeSet<String>> = BTreeMap::new();
        for (module, file) in self.files.iter().filter(|(module, _)| inside(module)) {
            for path in &file.named {
                let Some(from) = self.defining(path).filter(|from| inside(from)) else { continue };
                if from != module {
                    let name = path.last().expect("not empty").clone();
                    arrows.entry((module, from)).or_default().insert(name);
                }
            }
        }
        arrows
    }

    /// Between the rooms of the crate.
    fn arrows_of_the_crate(&self) -> BTreeSet<(String, String)> {
        let arrows = self.files.iter().flat_map(|(module, file)| {
            let from = |path: &Module| self.defining(path).map(|from| from[0].clone());
            let to = module.first().cloned().unwrap_or_default();
            file.named.iter().filter_map(from).map(move |from| (to.clone(), from))
        });
        arrows.filter(|(to, from)| to != from).collect()
    }

    /// Between the files and folders that lie in a module.
    fn arrows_between_rooms(&self, place: &str) -> Vec<(String, String, BTreeSet<String>)> {
        let mut all: BTreeMap<(String, String), BTreeSet<String>> = BTreeMap::new();
        for ((to, from), names) in self.arrows(place) {
            if to[1] != from[1] {
                all.entry((to[1].clone(), from[1].clone())).or_default().extend(names);
            }
        }
        all.into_iter().map(|((to, from), names)| (to, from, names)).collect()
    }

    /// Files that import each other, all the way round. The face of a folder may import from its files, and they from it.
    fn circles_of_files(&self, place: &str) -> Vec<Vec<String>> {
        let mut next: BTreeMap<&Module, Vec<&Module>> = BTreeMap::new();
        for (to, from) in self.arrows(place).into_keys() {
            let is_own =
                |face: &Module, file: &Module| self.files[face].is_face && file.starts_with(face);
            if !is_own(to, from) && !is_own(from, to) {
                next.entry(to).or_default().push(from);
            }
        }
        let reach = |start: &Module| {
            let mut seen: BTreeSet<&Module> = BTreeSet::new();
            let mut waiting: Vec<&Module> = next.get(start).cloned().unwrap_or_default();
            while let Some(module) = waiting.pop() {
                if seen.insert(module) {
                    waiting.extend(next.get(module).into_iter().flatten());
                }
            }
            seen
        };
        let reached: BTreeMap<&Module, _> = next.keys().map(|file| (*file, reach(file))).collect();
        let mut circles: BTreeSet<Vec<String>> = BTreeSet::new();
        for (file, seen) in reached.iter().filter(|(file, seen)| seen.contains(*file)) {
            let circle = seen
                .iter()
                .filter(|other| reached.get(*other).is_some_and(|back| back.contains(file)));
            circles.insert(circle.map(|module| module.join("::")).collect());
        }
        circles.into_iter().collect()
    }
}

/// Walks through a file, and gathers.
struct Reading<'a> {
    module: &'a Module,
    file: File,
}

impl Reading<'_> {
    /// From the crate, where it begins with `crate`, `super` or `self`.
    fn absolute(&self, path: &[String]) -> Option<Module> {
        let first = path.first()?;
        match first.as_str() {
            "crate" => Some(path[1..].to_vec()),
            "self" => Some([&self.module[..], &path[1..]].concat()),
            "super" => {
                let up = path.iter().take_while(|part| *part == "super").count();
                let kept = self.module.len().checked_sub(up)?;
                Some([&self.module[..kept], &path[up..]].concat())
            }
            _ => None,
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
                self.take(before, own);
            }
            syn::UseTree::Name(name) => self.take(&with(&name.ident), name.ident.to_string()),
            syn::UseTree::Rename(name) => self.take(&with(&name.ident), name.rename.to_string()),
            syn::UseTree::Glob(_) => {}
        }
    }

    fn take(&mut self, path: &[String], as_name: String) {
        // In a face, what is not from the crate is from one of its own files.
        let path = match self.absolute(path) {
            Some(path) => path,
            None if self.file.is_face => [&self.module[..], path].concat(),
            None => return,
        };
        self.file.imports.insert(as_name, path.clone());
        self.file.named.insert(path);
    }
}

fn is_test(attributes: &[syn::Attribute]) -> bool {
    let is_test = |attribute: &syn::Attribute| {
        attribute.path().is_ident("cfg")
            && attribute.parse_args::<syn::Ident>().is_ok_and(|what| what == "test")
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
                syn::Item::Struct(item) => Some(&item.ident),
                syn::Item::Trait(item) => Some(&item.ident),
                syn::Item::Type(item) => Some(&item.ident),
                _ => None,
            };
            self.file.defines.extend(name.map(ToString::to_string));
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
        let parts: Vec<String> = path.segments.iter().map(|part| part.ident.to_string()).collect();
        if let Some(path) = self.absolute(&parts).filter(|path| !path.is_empty()) {
            self.file.named.insert(path);
        }
        visit::visit_path(self, path);
    }

    // What stands in a documentation is no import.
    fn visit_attribute(&mut self, _: &'ast syn::Attribute) {}
}

/// The window's rooms, each above those that it may look into.
const WINDOW: [&str; 17] = [
    "picture",
    "window",
    "panels",
    "actions",
    "keeping",
    "scene",
    "plots",
    "state",
    "persist",
    "layout",
    "model",
    "prepared",
    "jobs",
    "file_dialog",
    "theme",
    "words",
    "short",
];

fn house() -> House {
    House::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"))
}

#[test]
fn no_arrow_of_the_window_goes_back_up() {
    let house = house();
    let height = |room: &str| {
        WINDOW.iter().position(|known| *known == room).unwrap_or_else(|| {
            panic!(
                "src/app/{room} is new: give it a place here, and in the picture of src/app/mod.rs"
            )
        })
    };
    let arrows = house.arrows_between_rooms("app");
    assert!(arrows.len() > 30, "{} arrows are too few to be all", arrows.len());
    let back: Vec<String> = arrows
        .iter()
        .filter(|(to, from, _)| height(to) >= height(from))
        .map(|(to, from, names)| format!("{to} takes {names:?} from {from}"))
        .collect();
    assert!(back.is_empty(), "arrows that go back up:\n{}", back.join("\n"));
}

/// The map's table lists the rooms from the ground up.
#[test]
fn a_room_of_the_crate_takes_only_from_those_above_it_on_the_map() {
    let map = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("src/lib.rs"));
    let map = map.expect("the map");
    let row = |line: &str| {
        line.strip_prefix("//! | [`")?.split_once('`').map(|(room, _)| room.to_owned())
    };
    let rooms: Vec<String> = map.lines().filter_map(row).collect();
    let height = |room: &str| {
        let found = rooms.iter().position(|known| known == room);
        found.unwrap_or_else(|| panic!("src/{room} is not on the map of src/lib.rs"))
    };
    let house = house();
    let arrows = house.arrows_of_the_crate();
    assert!(arrows.len() > 60, "{} arrows are too few to be all", arrows.len());
    let back: Vec<_> = arrows
        .iter()
        .filter(|(to, _)| !["lib", "main"].contains(&to.as_str()))
        .filter(|(to, from)| height(to) <= height(from))
        .collect();
    assert!(back.is_empty(), "a room takes from one below it on the map: {back:?}");
}

#[test]
fn no_files_of_the_window_or_the_calibrations_import_each_other() {
    let house = house();
    for place in ["app", "calibration"] {
        let circles = house.circles_of_files(place);
        assert!(circles.is_empty(), "circles of imports in src/{place}:\n{circles:#?}");
    }
}

#[test]
fn no_rooms_of_the_calibrations_look_into_each_other() {
    let house = house();
    let arrows = house.arrows_between_rooms("calibration");
    assert!(arrows.len() > 30, "{} arrows are too few to be all", arrows.len());
    let mut left: Vec<_> = arrows.iter().map(|(to, from, _)| (to, from)).collect();
    // What nobody looks into goes away, until nothing is left or only circles are.
    loop {
        let before = left.len();
        let looked_into: BTreeSet<_> = left.iter().map(|(_, from)| *from).collect();
        left.retain(|(to, _)| looked_into.contains(to));
        if left.len() == before {
            break;
        }
    }
    assert!(left.is_empty(), "circles among {left:?}");
}

/// Largest file that crates.io is given, of which it takes ten (bytes).
const MOST_PACKAGE_BYTES: u64 = 3_000_000;
/// Largest program as it is released (bytes).
const MOST_PROGRAM_BYTES: u64 = 40_000_000;

#[test]
fn the_package_is_small() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = std::process::Command::new(env!("CARGO"))
        .args(["package", "--no-verify", "--allow-dirty", "--offline", "--quiet", "--target-dir"])
        .arg(folder.path())
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let file = format!("package/resect-{}.crate", env!("CARGO_PKG_VERSION"));
    let bytes = std::fs::metadata(folder.path().join(file)).expect("a package").len();
    assert!(bytes < MOST_PACKAGE_BYTES, "{bytes} bytes");
}

#[test]
#[cfg_attr(
    debug_assertions,
    ignore = "of the program as it is released: cargo test --release --test structure"
)]
fn the_released_program_is_small() {
    let bytes = std::fs::metadata(env!("CARGO_BIN_EXE_resect")).expect("built").len();
    assert!(bytes < MOST_PROGRAM_BYTES, "{bytes} bytes");
}
