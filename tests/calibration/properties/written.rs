//! The same readings in other units, formats and orders of rows and files.

use resect_io::findings::kinds;
use std::fmt::Write;

use resect_core::calibration::Method;
use resect_core::deployment::Deployment;
use resect_io::open::open_files;
use resect_io::simulation_files::write_folder;
use resect_tools::simulation::{Preset, Scenario, Simulated, simulate_scenario};

use super::told::{Answered, OF_STAMPS, ROUNDING, Within, tell};

const METHODS: [Method; 4] =
    [Method::TwoPoint, Method::StaticGcp, Method::InterPrism, Method::Joint];

fn simulated() -> Simulated {
    let scenario = Scenario { duration_s: 120.0, ..Preset::Warthog.scenario() };
    simulate_scenario(&scenario, 1)
}

/// Name and text of every file of a deployment.
type Files = Vec<(String, String)>;

fn files() -> Files {
    let folder = tempfile::tempdir().expect("a folder");
    write_folder(&simulated(), folder.path()).expect("written");
    let mut files: Files = std::fs::read_dir(folder.path())
        .expect("readable")
        .map(|entry| {
            let path = entry.expect("an entry").path();
            let name = path.file_name().expect("a name").to_string_lossy().into_owned();
            (name, std::fs::read_to_string(path).expect("text"))
        })
        .collect();
    files.sort();
    files
}

fn read(files: &Files) -> Deployment {
    let files: Vec<_> = files.iter().map(|(name, text)| (name.as_str(), text.as_str())).collect();
    open_files("d", &files).expect("valid")
}

fn told(files: &Files) -> Vec<Answered> {
    let told = tell(&read(files), &METHODS);
    told.into_iter().map(|one| one.expect("an answer")).collect()
}

#[track_caller]
fn assert_tell_the_same(changed: &Files, within: Within, what: &str) {
    let mut complaints = Vec::new();
    for ((before, after), method) in told(&files()).iter().zip(told(changed)).zip(METHODS) {
        let covariance = before.covariance.as_ref();
        let mut wrong = after.says_else(before, within);
        wrong.extend(after.tells_other_numbers(before));
        wrong.extend(after.stands_elsewhere(&before.transforms, covariance, within));
        complaints.extend(wrong.iter().map(|what| format!("{method:?}: {what}")));
    }
    assert!(complaints.is_empty(), "{what}: {complaints:#?}");
}

fn text_of<'a>(files: &'a mut Files, name: &str) -> &'a mut String {
    &mut files.iter_mut().find(|(own, _)| own == name).expect("there").1
}

/// Reorders the lines below the header.
fn reorder(text: &mut String, order: impl Fn(&mut Vec<&str>)) {
    let mut lines: Vec<_> = text.lines().collect();
    let header = lines.remove(0);
    order(&mut lines);
    *text = format!("{header}\n{}\n", lines.join("\n"));
}

#[test]
fn the_order_of_files_changes_nothing() {
    let mut changed = files();
    changed.reverse();
    assert_tell_the_same(&changed, ROUNDING, "files in another order");
}

#[test]
fn rows_by_station_say_what_rows_by_time_say() {
    let mut changed = files();
    reorder(text_of(&mut changed, "inter_prism.csv"), |lines| {
        lines.sort_by_key(|line| line.split(',').nth(1).map(str::to_owned));
    });
    assert_tell_the_same(&changed, ROUNDING, "rows by station");
    assert_eq!(read(&changed).tracks, read(&files()).tracks);
}

#[test]
fn rows_in_any_order_are_the_same_readings_and_are_told() {
    let mut changed = files();
    reorder(text_of(&mut changed, "inter_prism.csv"), |lines| lines.reverse());
    let (before, after) = (read(&files()), read(&changed));
    assert_eq!(before.tracks, after.tracks);
    assert!(after.findings.iter().any(|f| f.kind == kinds::STAMPS_OUT_OF_ORDER), "{after:?}");
}

/// Returns the readings in another program's layout, with its description in `deployment.toml`.
fn as_table(files: &Files, columns: &str, row: impl Fn([f64; 5]) -> String) -> Files {
    let mut changed = files.clone();
    let text = text_of(&mut changed, "inter_prism.csv");
    let mut table = String::from("t;no;d;hz;v\n");
    for line in text.lines().skip(1) {
        let values: Vec<f64> = line.split(',').map(|v| v.parse().expect("a number")).collect();
        _ = writeln!(table, "{}", row(values.try_into().expect("five")));
    }
    *text = table;
    let toml = text_of(&mut changed, "deployment.toml");
    *toml += "\n[columns]\ntime = \"t\"\nstation = \"no\"\nrange = \"d\"\nazimuth = \"hz\"\nvertical = \"v\"\n";
    *toml += columns;
    changed
}

#[test]
fn other_units_of_the_same_readings_change_nothing() {
    let files = files();
    let degrees = as_table(&files, "angle_unit = \"degrees\"\n", |[t, no, d, hz, v]| {
        format!("{t:.6};{no};{d};{};{}", hz.to_degrees(), v.to_degrees())
    });
    let gon_and_feet =
        as_table(&files, "angle_unit = \"gon\"\nlength_unit = \"feet\"\n", |[t, no, d, hz, v]| {
            let gon = |rad: f64| rad.to_degrees() / 0.9;
            format!("{t:.6};{no};{};{};{}", d / 0.3048, gon(hz), gon(v))
        });
    let millimetres_and_elevations = as_table(
        &files,
        "length_unit = \"millimetres\"\nvertical_angle = \"elevation\"\ntime_format = \"milliseconds\"\n",
        |[t, no, d, hz, v]| {
            let elevation_rad = std::f64::consts::FRAC_PI_2 - v;
            format!("{:.3};{no};{};{hz};{elevation_rad}", t * 1e3, d * 1e3)
        },
    );
    for (what, changed, within) in [
        ("degrees", degrees, ROUNDING),
        ("gon and feet", gon_and_feet, ROUNDING),
        // Milliseconds are rounded to other stamps.
        ("millimetres and elevations", millimetres_and_elevations, OF_STAMPS),
    ] {
        assert_tell_the_same(&changed, within, what);
    }
}
