//! The page of the constants of the calibration, `docs/src/constants.md`, compared with the source; and the equations of the joint estimate.
//!
//! `UPDATE_GOLDEN=1 cargo test --test structure constants` writes the page again.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::path::Path;

use syn::visit::{self, Visit};

use crate::documents::assert_written;
use crate::is_test;
use crate::names::files_of;

const FOLDER: &str = "crates/resect-core/src/calibration";

/// Groups of files by the beginning of their paths, the last one for all others.
const GROUPS: [(&str, &str); 5] = [
    ("joint/", "Joint estimate"),
    ("inter_prism/clock_check/", "Clock check of method D"),
    ("inter_prism/", "Method D"),
    ("sense/", "Orientation of the rig, and misreadings"),
    ("", "Methods A to C, and checks of all answers"),
];

/// Files whose constants are indices, sizes and words.
const LAYOUT_FILES: [&str; 8] = [
    "evidence.rs",
    "inter_prism/clock_check/model.rs",
    "inter_prism/pair_sums.rs",
    "joint/chain_factor.rs",
    "joint/motion_band.rs",
    "joint/state_vector.rs",
    "joint/survey_elimination.rs",
    "track_clocks.rs",
];
/// Other indices and sizes.
const LAYOUT: [&str; 24] = [
    "inter_prism/compression.rs CONSTANT",
    "inter_prism/compression.rs LANES",
    "inter_prism/compression.rs MONOMIALS",
    "inter_prism/distance_pass.rs LANES",
    "inter_prism/distance_pass.rs ZERO",
    "inter_prism/prism_network.rs UNKNOWNS_PER_STATION",
    "inter_prism/squared_cost.rs FIRST",
    "inter_prism/squared_cost.rs LANES",
    "inter_prism/squared_cost.rs ROWS",
    "joint/equations.rs HORIZONTAL_ANGLES",
    "joint/equations.rs VERTICAL_ANGLES",
    "joint/equations.rs HORIZONTAL_JERKS",
    "joint/equations.rs VERTICAL_JERKS",
    "joint/equations.rs PRISMS",
    "joint/equations.rs RANGES",
    "joint/equations.rs STAMPS",
    "joint/prism_motion.rs FRAME",
    "joint/step_fit.rs STEPPING",
    "joint/survey_adjustment.rs ALL",
    "joint/survey_change.rs CHANGES",
    "joint/survey_change.rs POSES",
    "point_to_point.rs COLUMNS",
    "recommendation.rs MOST_WORDS",
    "transform_sigma.rs ZERO",
];
/// Types of constants that are words, rows of the table of unknowns, or settings, which have a page of their own.
const WORDS: [&str; 5] = ["str", "FindingKind", "NumberSetting", "Unknown", "[Self"];

/// Units by the end of a name, the longest first.
const UNITS: [(&str, &str); 15] = [
    ("_M_PER_S2", "m/s²"),
    ("_M_PER_S3", "m/s³"),
    ("_M_PER_S", "m/s"),
    ("_PER_M2", "1/m²"),
    ("_SIGMAS", "σ"),
    ("_PPM", "ppm"),
    ("_RAD", "rad"),
    ("_HZ", "Hz"),
    ("_M2", "m²"),
    ("_S2", "s²"),
    ("_SIGMA_M", "m"),
    ("_SIGMAS_M", "m"),
    ("_M", "m"),
    ("_S", "s"),
    ("_SECONDS", "s"),
];
/// Units in the text of a constant without one in its name.
const UNITS_IN_TEXT: [&str; 6] = ["σ²", "σ", "m, s", "s/s", "rad", "m"];

/// Beginnings of the sentence that states the evidence.
const EVIDENCE: [&str; 5] = ["Measured: ", "Simulated: ", "Source: ", "Field: ", "Textbook: "];

const HEAD: &str = "\
# Constants

These numbers of the calibration decide something. The page is generated from the source: `UPDATE_GOLDEN=1 cargo test --test structure constants`.
Effect and evidence are the documentation of each constant. Numbers that a user can set are in [Settings](settings.md).

| evidence | meaning |
|---|---|
| measured | by real drives |
| simulated | by drives with known truth; [Accuracy](accuracy.md) has such campaigns |
| source | a publication |
| field | experience with instruments, without a publication |
| textbook | a theorem, a definition, or a quantile |
| judgement | chosen by the authors |
";

/// A constant in the source.
struct Constant {
    name: String,
    doc: String,
}

/// Collector of the constants of a file, in their order.
#[derive(Default)]
struct Constants(Vec<Constant>);

impl Constants {
    fn add(&mut self, name: &syn::Ident, attributes: &[syn::Attribute]) {
        let line = |attribute: &syn::Attribute| match &attribute.meta {
            syn::Meta::NameValue(syn::MetaNameValue {
                path,
                value: syn::Expr::Lit(syn::ExprLit { lit: syn::Lit::Str(text), .. }),
                ..
            }) if path.is_ident("doc") => Some(text.value().trim().to_owned()),
            _ => None,
        };
        let lines: Vec<String> = attributes.iter().filter_map(line).collect();
        self.0.push(Constant { name: name.to_string(), doc: lines.join(" ") });
    }
}

impl<'ast> Visit<'ast> for Constants {
    fn visit_item_mod(&mut self, item: &'ast syn::ItemMod) {
        if !is_test(&item.attrs) {
            visit::visit_item_mod(self, item);
        }
    }

    fn visit_item_const(&mut self, item: &'ast syn::ItemConst) {
        self.add(&item.ident, &item.attrs);
    }

    fn visit_item_static(&mut self, item: &'ast syn::ItemStatic) {
        self.add(&item.ident, &item.attrs);
    }

    fn visit_impl_item_const(&mut self, item: &'ast syn::ImplItemConst) {
        self.add(&item.ident, &item.attrs);
    }
}

fn unit(name: &str, doc: &str) -> &'static str {
    let by_name = UNITS.iter().find(|(end, _)| name.ends_with(end)).map(|(_, unit)| *unit);
    let in_text = || UNITS_IN_TEXT.into_iter().find(|unit| doc.contains(&format!("({unit})")));
    by_name.or_else(in_text).unwrap_or_default()
}

/// Row of a constant with its definition from the type on: `f64 = 0.25;`.
fn row(file: &str, Constant { name, doc }: &Constant, value: &str) -> String {
    assert!(!doc.is_empty(), "{file}: {name} has no documentation, and no place in LAYOUT");
    let at = EVIDENCE.iter().filter_map(|label| doc.find(label)).min().unwrap_or(doc.len());
    let (effect, evidence) = doc.split_at(at);
    let evidence = if evidence.is_empty() { "judgement" } else { evidence };
    let value: Vec<&str> = value.split_whitespace().collect();
    let (value, unit) = (value.join(" ").replace(", }", " }"), unit(name, doc));
    let value = format!("`{value}` {unit}");
    let row =
        format!("{file} | `{name}` | {} | {} | {evidence}", value.trim_end(), effect.trim_end());
    let first = evidence[..1].to_lowercase();
    let row = row.replace(&format!("| {evidence}"), &format!("| {first}{}", &evidence[1..]));
    // Links of the documentation lead nowhere here.
    row.replace("[`", "`").replace("`]", "`")
}

/// Rows of the constants of a file that decide something.
fn rows(file: &str, text: &str) -> Vec<String> {
    let mut constants = Constants::default();
    constants.visit_file(&syn::parse_file(text).expect("Rust"));
    let mut rest = text;
    let mut rows = Vec::new();
    for constant in &constants.0 {
        let start = [format!("const {}:", constant.name), format!("static {}:", constant.name)];
        let at = start.iter().find_map(|it| Some(rest.find(it)? + it.len())).expect("the constant");
        rest = &rest[at..];
        let (kind, value) = rest.split_once('=').expect("a value");
        let value = value.split(";\n").next().unwrap_or_default();
        let is_layout = LAYOUT.contains(&format!("{file} {}", constant.name).as_str());
        if !is_layout && !WORDS.iter().any(|word| kind.contains(word)) {
            rows.push(row(file.trim_end_matches(".rs"), constant, value));
        }
    }
    rows
}

/// Files of the calibration without those of tests: path below the folder, and text.
fn sources() -> BTreeMap<String, String> {
    let below = |path: &Path| {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(FOLDER);
        let below = path.strip_prefix(folder).expect("below").display().to_string();
        below.replace('\\', "/")
    };
    let files = files_of(FOLDER).into_iter().map(|(path, text)| (below(&path), text));
    files.filter(|(path, _)| !path.ends_with("tests.rs")).collect()
}

#[test]
fn the_page_has_every_constant_that_decides_something() {
    let mut groups = [const { String::new() }; GROUPS.len()];
    let mut count = 0;
    for (file, text) in sources() {
        let is_in = |(beginning, _): &(&str, &str)| file.starts_with(beginning);
        let group = GROUPS.iter().position(is_in).expect("the last takes all");
        let all =
            if LAYOUT_FILES.contains(&file.as_str()) { Vec::new() } else { rows(&file, &text) };
        count += all.len();
        all.iter().for_each(|row| _ = writeln!(groups[group], "| {row} |"));
    }
    let mut page = format!("{HEAD}\nThey are {count}.\n");
    for ((_, title), rows) in GROUPS.iter().zip(&groups) {
        _ = write!(
            page,
            "\n## {title}\n\n| file | name | value | effect | evidence |\n|---|---|---|---|---|\n{rows}"
        );
    }
    assert_written("docs/src/constants.md", &page);
}

/// Numbers of equations in comments such as `// (3), (5)`.
fn named_equations(code: &str) -> Vec<usize> {
    let comments = code.lines().filter_map(|line| line.split_once("// ("));
    let words = comments
        .filter(|(before, _)| !before.ends_with('/'))
        .flat_map(|(_, comment)| comment.split([',', '.', ' ']));
    let numbers = words.filter_map(|word| word.strip_suffix(')'));
    let numbers = numbers.filter_map(|number| number.trim_start_matches('(').parse().ok());
    // A larger one is a year.
    numbers.filter(|number| *number < 1000).collect()
}

#[test]
fn code_names_every_equation_of_the_joint_estimate() {
    let sources = sources();
    let equation = |line: &str| -> Option<usize> {
        let (_, number) = line.strip_suffix(')')?.rsplit_once("  (")?;
        number.parse().ok()
    };
    let on_page: Vec<usize> = sources["joint/mod.rs"].lines().filter_map(equation).collect();
    assert_eq!(on_page, (1..=on_page.len()).collect::<Vec<_>>(), "equations of the page");
    let joint = sources.iter().filter(|(file, _)| file.starts_with("joint/"));
    let in_code: BTreeSet<usize> = joint.flat_map(|(_, text)| named_equations(text)).collect();
    assert_eq!(in_code, on_page.into_iter().collect(), "equations that comments of the code name");
}
