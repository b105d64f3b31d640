//! Tables of tracks: foreign columns by a mapping, Bonn's network, and implausible units, clocks and readings.

use resect_io::findings::kinds;
use std::f64::consts::PI;
use std::path::Path;

use crate::common::{field_data, sample_folder};
use resect_core::deployment::{ColumnMapping, Deployment, Finding, OneOrMany, Overrides};
use resect_core::progress::Progress;
use resect_io::error::{OpenError, Question};
use resect_io::open::open;
use resect_io::source::{Extras, Source};

/// A reading as the polar CSV writes it: time, station, range, azimuth, zenith angle.
type Reading = [f64; 5];

fn readings(folder: &Path) -> Vec<Reading> {
    let text = std::fs::read_to_string(folder.join("inter_prism.csv")).expect("readable");
    let row = |line: &str| {
        let values: Vec<f64> = line.split(',').map(|f| f.parse().expect("a number")).collect();
        values.try_into().expect("five columns")
    };
    text.lines().skip(1).map(row).collect()
}

fn polar(readings: &[Reading]) -> String {
    let rows = readings.iter().map(|r| r.map(|value| value.to_string()).join(",") + "\n");
    "timestamp,id,distance,ha,va\n".to_owned() + &rows.collect::<String>()
}

/// Returns the readings of the tested deployments: a sample, and the field data if available.
fn originals() -> Vec<Vec<Reading>> {
    let folders = [Some(sample_folder("warthog")), field_data("2022-07-11-2")];
    folders.into_iter().flatten().map(|folder| readings(&folder)).collect()
}

fn opened(files: &[(&str, &str)], corrections: Overrides) -> Result<Deployment, OpenError> {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).expect("writable");
    }
    let extras = Extras { corrections, ..Extras::default() };
    Source::at(folder.path()).with(extras).open(&Progress::default())
}

fn doubts(deployment: &Deployment) -> Vec<&Finding> {
    deployment.findings.iter().filter(|f| f.kind.is_doubt()).collect()
}

/// A change of a reading.
type Change = fn(&mut Reading);

#[test]
fn a_column_in_degrees_gon_or_milliseconds_is_refused_by_name() {
    let changes: [(&str, Change, &str); 8] = [
        (
            "zenith, degrees",
            |r| r[4] = r[4].to_degrees(),
            "zenith angles of stations 1, 2, 3 lie about",
        ),
        ("zenith, gon", |r| r[4] *= 200.0 / PI, "gon?"),
        ("azimuth, degrees", |r| r[3] = r[3].to_degrees(), "azimuths of station"),
        ("azimuth, gon", |r| r[3] *= 200.0 / PI, "azimuths of station"),
        (
            "one station",
            |r| {
                if r[1] == 3.0 {
                    r[4] = r[4].to_degrees();
                }
            },
            "zenith angles of station 3 lie",
        ),
        ("milliseconds", |r| r[0] *= 1e3, "milliseconds?"),
        (
            "one clock in ms",
            |r| {
                if r[1] == 1.0 {
                    r[0] *= 1e3;
                }
            },
            "stamps of station 1 lie about",
        ),
        ("millimetres", |r| r[2] *= 1e3, "millimetres?"),
    ];
    for original in originals() {
        for (name, change, expected) in changes {
            let mut changed = original.clone();
            changed.iter_mut().for_each(change);
            let text = polar(&changed);
            let error =
                opened(&[("p.csv", &text)], Overrides::default()).expect_err(name).to_string();
            assert!(error.starts_with("p.csv: ") && error.contains(expected), "{name}: {error}");
            assert!(error.contains("; convert them to "), "{name}: {error}");
        }
    }
}

#[test]
fn the_remedy_of_a_wrong_unit_works() {
    for original in originals() {
        let mut degrees = original.clone();
        for reading in &mut degrees {
            (reading[3], reading[4]) = (reading[3].to_degrees(), reading[4].to_degrees());
        }
        let text = polar(&degrees);
        let error =
            opened(&[("p.csv", &text)], Overrides::default()).expect_err("degrees").to_string();
        let remedy = "angle_unit = \"degrees\"";
        assert!(
            error.contains(&format!("under [columns] in deployment.toml: {remedy}")),
            "{error}"
        );
        let toml = format!("[columns]\n{remedy}\n");
        let files = [("p.csv", text.as_str()), ("deployment.toml", toml.as_str())];
        let right = opened(&files, Overrides::default()).expect("put right");
        let good = opened(&[("p.csv", &polar(&original))], Overrides::default()).expect("good");
        assert_same(&right, &good);
    }
}

#[track_caller]
fn assert_same(a: &Deployment, b: &Deployment) {
    for (a, b) in a.tracks.iter().zip(&b.tracks) {
        assert_eq!(a.measurements.len(), b.measurements.len());
        for (a_own, b_own) in a.measurements.iter().zip(&b.measurements) {
            assert!((a_own.time_s - b_own.time_s).abs() < 1e-6);
            let off = a.position_m(a_own) - b.position_m(b_own);
            assert!(off.norm() < 1e-6, "{a_own:?} {b_own:?}");
        }
    }
}

#[test]
fn zero_ranges_among_valid_readings_raise_a_doubt_and_good_data_none() {
    for mut original in originals() {
        let good = opened(&[("p.csv", &polar(&original))], Overrides::default()).expect("good");
        assert_eq!(doubts(&good), Vec::<&Finding>::new());
        original.iter_mut().step_by(20).for_each(|reading| reading[2] = 0.0);
        let spoiled =
            opened(&[("p.csv", &polar(&original))], Overrides::default()).expect("the rest");
        let said = doubts(&spoiled);
        assert_eq!(said.len(), 3, "one a station: {said:?}");
        assert!(said.iter().all(|f| f.kind == kinds::READINGS_IMPLAUSIBLE), "{said:?}");
        // With a time origin of its own, as in some recorders.
        for reading in &mut original {
            reading[0] -= 1.6e9;
            reading[2] = reading[2].max(1.0);
        }
    }
    if let Some(folder) = field_data("2022-07-11-2") {
        assert_eq!(doubts(&open(&folder).expect("opens")), Vec::<&Finding>::new());
    }
}

/// The sample in foreign columns: semicolons, decimal commas, gon, millimetres, milliseconds.
fn foreign(readings: &[Reading], of_station: Option<f64>) -> String {
    let mut text = "Zeit;Instrument;Strecke;Hz;V\n".to_owned();
    for [time_s, station, range_m, azimuth_rad, zenith_rad] in readings {
        if of_station.is_none_or(|own| own == *station) {
            let gon = 200.0 / PI;
            let row = format!(
                "{:.3};{station};{:.5};{:.9};{:.9}\n",
                time_s * 1e3,
                range_m * 1e3,
                azimuth_rad * gon,
                zenith_rad * gon
            );
            text += &row.replace('.', ",");
        }
    }
    text
}

const COLUMNS: &str = "[columns]\ntime = \"Zeit\"\ntime_format = \"milliseconds\"\nrange = \"Strecke\"\n\
    length_unit = \"millimetres\"\nazimuth = \"Hz\"\nvertical = \"V\"\nangle_unit = \"gon\"\n";

#[test]
fn foreign_columns_are_a_question_and_its_answer_reads_the_same_tracks() {
    let original = readings(&sample_folder("warthog"));
    let good = opened(&[("p.csv", &polar(&original))], Overrides::default()).expect("good");
    let table = foreign(&original, None);
    let asked = opened(&[("tracks.csv", &table)], Overrides::default()).expect_err("a question");
    let OpenError::Question(question) = &asked else { panic!("{asked}") };
    let Question::Columns { file, path, header } = &**question else { panic!("{asked}") };
    assert_eq!((file.as_str(), header.as_str()), ("tracks.csv", "Zeit;Instrument;Strecke;Hz;V"));
    assert!(path.ends_with("tracks.csv"));
    let toml = COLUMNS.to_owned() + "station = \"Instrument\"\n";
    let files = [("tracks.csv", table.as_str()), ("deployment.toml", toml.as_str())];
    assert_same(&opened(&files, Overrides::default()).expect("answered"), &good);
    // The window gives the same answer.
    let columns: Overrides = toml::from_str(&toml).expect("valid");
    let deployment = opened(&files[..1], columns).expect("answered");
    assert!(
        deployment
            .findings
            .iter()
            .any(|f| f.kind == kinds::TABLE_COLUMNS && f.to_string().contains("(millimetres)"))
    );
}

#[test]
fn a_table_beside_tracks_is_no_question() {
    let original = readings(&sample_folder("warthog"));
    let table = foreign(&original, None);
    let files = [("p.csv", polar(&original)), ("weather.csv", table)];
    let files = files.each_ref().map(|(name, text)| (*name, text.as_str()));
    let deployment = opened(&files, Overrides::default()).expect("the known one");
    let used: Vec<_> = deployment.ingredients.iter().filter(|i| i.used).map(|i| &i.file).collect();
    assert_eq!(used, ["p.csv"]);
}

#[test]
fn three_files_of_a_station_each_are_told_apart_by_name_or_by_the_user() {
    let original = readings(&sample_folder("warthog"));
    let good = opened(&[("p.csv", &polar(&original))], Overrides::default()).expect("good");
    let tables = [1.0, 2.0, 3.0].map(|station| foreign(&original, Some(station)));
    let [one, two, three] = tables.each_ref().map(String::as_str);
    let numbered =
        [("t1.csv", one), ("t2.csv", two), ("t3.csv", three), ("deployment.toml", COLUMNS)];
    assert_same(&opened(&numbered, Overrides::default()).expect("by number"), &good);
    let named = [("a.csv", three), ("b.csv", one), ("c.csv", two), ("deployment.toml", COLUMNS)];
    let asked = opened(&named, Overrides::default()).expect_err("a question");
    let OpenError::Question(question) = &asked else { panic!("{asked}") };
    let Question::StationFiles { files, .. } = &**question else { panic!("{asked}") };
    assert_eq!(files, &["a.csv", "b.csv", "c.csv"]);
    let tracks = ["b.csv", "c.csv", "a.csv"].map(str::to_owned).to_vec();
    let answer = Overrides { tracks: Some(OneOrMany::Many(tracks)), ..Overrides::default() };
    assert_same(&opened(&named, answer).expect("answered"), &good);
}

#[test]
fn coordinates_are_read_as_the_polar_readings_that_they_are() {
    let original = readings(&sample_folder("warthog"));
    let good = opened(&[("p.csv", &polar(&original))], Overrides::default()).expect("good");
    let mut text = "time,station,x,y,z\n".to_owned();
    for (station, track) in good.tracks.iter().enumerate() {
        for m in &track.measurements {
            let p = track.position_m(m);
            text += &format!("{},{},{},{},{}\n", m.time_s, station + 1, p.x, p.y, p.z);
        }
    }
    let name = |name: &str| Some(name.to_owned());
    let columns = ColumnMapping {
        time: "time".into(),
        station: name("station"),
        x: name("x"),
        y: name("y"),
        z: name("z"),
        ..ColumnMapping::default()
    };
    let corrections = Overrides { columns: Some(columns), ..Overrides::default() };
    let cartesian = opened(&[("xyz.csv", &text)], corrections).expect("read");
    assert_eq!(cartesian.tracks[0].prism_constant_m, 0.0);
    assert_same(&cartesian, &good);
}

#[test]
fn bonns_files_are_stations_in_the_order_that_the_user_gives() {
    let original = readings(&sample_folder("warthog"));
    let file = |own: f64| {
        let mut text =
            "ref_time, ts_time, h_angle, v_angle, distance, num_chars, geocom_return_code, \
                        rpc_return_code\n"
                .to_owned();
        for [time_s, station, range_m, azimuth_rad, zenith_rad] in &original {
            if *station == own {
                let range_m = range_m + 0.010;
                text += &format!("{time_s},{time_s},{azimuth_rad},{zenith_rad},{range_m},80,0,0\n");
            }
        }
        text
    };
    let texts = [1.0, 2.0, 3.0].map(file);
    let [one, two, three] = texts.each_ref().map(String::as_str);
    let files = [("raw_a.csv", two), ("raw_b.csv", three), ("raw_c.csv", one)];
    let asked = opened(&files, Overrides::default()).expect_err("nothing tells");
    assert!(asked.to_string().contains("the stations of these files are unknown"), "{asked}");
    let tracks = ["raw_c.csv", "raw_a.csv", "raw_b.csv"].map(str::to_owned).to_vec();
    let answer = Overrides { tracks: Some(OneOrMany::Many(tracks)), ..Overrides::default() };
    let bonn = opened(&files, answer).expect("answered");
    let good = opened(&[("p.csv", &polar(&original))], Overrides::default()).expect("good");
    assert_same(&bonn, &good);
    assert!(bonn.findings.iter().any(|f| f.kind == kinds::TABLE_CLOCK));
}
