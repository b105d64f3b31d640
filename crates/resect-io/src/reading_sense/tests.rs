use crate::findings::kinds as file_kinds;
use resect_core::deployment::kinds;
use std::f64::consts::{FRAC_PI_2, PI};

use super::impossible::Impossible;
use super::station_sense::{LARGEST_SAMPLE, StationSense};
use crate::format::polar_csv;
use crate::open::open_files;
use crate::sample::Sample;
use resect_core::deployment::{Deployment, Measurement};

use resect_tools::simulation::{Preset, simulate};

/// Returns the table of a sample with changed rows: index of the row; time, station, range, azimuth, zenith angle.
fn changed(mut change: impl FnMut(usize, &mut [f64; 5])) -> String {
    let (_, text) = Sample::Warthog.files()[0];
    let mut out = polar_csv::COLUMNS.join(",") + "\n";
    for (line, row) in text.lines().skip(1).enumerate() {
        let fields: Vec<f64> = row.split(',').map(|f| f.parse().expect("a number")).collect();
        let mut row = fields.try_into().expect("five columns");
        change(line, &mut row);
        out += &row.map(|value| value.to_string()).join(",");
        out.push('\n');
    }
    out
}

fn read(text: &str) -> Result<Deployment, String> {
    open_files("d", &[("p.csv", text)]).map_err(|error| error.to_string())
}

fn doubts(deployment: &Deployment) -> Vec<String> {
    deployment.findings.iter().filter(|f| f.kind.is_doubt()).map(ToString::to_string).collect()
}

/// A change of one row of the table.
type Change = fn(&mut [f64; 5]);

#[test]
fn a_column_in_another_unit_is_refused_and_named() {
    let cases: [(&str, Change, &[&str]); 11] = [
        (
            "zenith deg",
            |r| r[4] = r[4].to_degrees(),
            &["zenith angles of stations 1, 2, 3", "degrees?"],
        ),
        ("zenith gon", |r| r[4] *= 200.0 / PI, &["zenith angles of stations 1, 2, 3", "gon?"]),
        (
            "azimuth deg",
            |r| r[3] = r[3].to_degrees(),
            &["azimuths of stations 1, 2, 3", "degrees or gon?"],
        ),
        ("azimuth gon", |r| r[3] *= 200.0 / PI, &["azimuths of stations"]),
        (
            "both",
            |r| (r[3], r[4]) = (r[3].to_degrees(), r[4].to_degrees()),
            &["zenith angles", "and azimuths", "angle_unit = \"degrees\""],
        ),
        (
            "one station",
            |r| {
                if r[1] == 2.0 {
                    r[4] = r[4].to_degrees();
                }
            },
            &["zenith angles of station 2 lie about 9", "convert them to radians"],
        ),
        ("elevation", |r| r[4] = FRAC_PI_2 - r[4], &["elevation angles", "vertical_angle"]),
        ("ms", |r| r[0] *= 1e3, &["stamps of stations 1, 2, 3", "milliseconds?", "time_format"]),
        ("ns", |r| r[0] *= 1e9, &["nanoseconds?"]),
        ("relative ms", |r| r[0] = (r[0] - 1.76e9) * 1e3, &["step by", "milliseconds?"]),
        ("mm", |r| r[2] *= 1e3, &["ranges of stations 1, 2, 3", "millimetres?"]),
    ];
    for (name, change, expected) in cases {
        let error = read(&changed(|_, row| change(row))).expect_err(name);
        for part in expected {
            assert!(error.contains(part), "{name}: `{part}` is not in: {error}");
        }
    }
}

#[test]
fn impossible_readings_that_are_marked_as_valid_raise_a_doubt() {
    let zeros = changed(|line, row| {
        if line % 20 == 0 {
            row[2] = 0.0;
        }
    });
    let deployment = read(&zeros).expect("the rest is good");
    let said = doubts(&deployment).join("\n");
    assert!(said.contains("ranges of zero") && said.contains("(5."), "{said}");
    let one = changed(|line, row| {
        if row[1] == 3.0 && line % 10 < 3 {
            row[2] = -row[2];
        }
    });
    let said = doubts(&read(&one).expect("the rest is good"));
    assert!(
        said.len() == 1 && said[0].contains("station 3") && said[0].contains("negative"),
        "{said:?}"
    );
    let whole = changed(|_, row| row[0] = row[0].floor());
    let said = doubts(&read(&whole).expect("readable")).join("\n");
    assert!(said.contains("are rounded to 1 s"), "{said}");
}

#[test]
fn relative_time_is_a_note_and_clocks_that_never_meet_a_problem() {
    let relative = read(&changed(|_, row| row[0] -= 1.76e9)).expect("fine");
    assert!(doubts(&relative).is_empty());
    assert!(relative.findings.iter().any(|f| f.kind == file_kinds::STAMPS_RELATIVE));
    let apart = read(&changed(|_, row| {
        if row[1] == 2.0 {
            row[0] -= 1e6;
        }
    }))
    .expect("readable");
    let said = apart.findings.iter().find(|f| f.kind == kinds::STATIONS_WITHOUT_COMMON_TIME);
    assert_eq!(said.expect("said").severity, resect_core::deployment::Severity::Problem);
}

#[test]
fn good_data_raise_no_doubt() {
    for sample in Sample::ALL {
        assert_eq!(doubts(&sample.open().expect("built in")), [""; 0]);
    }
    for preset in Preset::ALL {
        let deployment = crate::simulation_files::open(&simulate(preset, 3)).expect("simulated");
        assert_eq!(doubts(&deployment), [""; 0], "{preset:?}");
        let notes = deployment.findings.iter().filter(|f| f.kind == file_kinds::STAMPS_RELATIVE);
        assert_eq!(notes.count(), 0);
    }
}

#[test]
fn the_sample_is_spread_over_everything() {
    let mut sense = StationSense::default();
    for k in 0..100_000 {
        let m = Measurement {
            time_s: f64::from(k) * 0.1,
            range_m: 5.0,
            azimuth_rad: 0.0,
            zenith_rad: 1.5,
        };
        sense.take(&m, Impossible::of(&m));
    }
    assert!(sense.sample.len() >= LARGEST_SAMPLE / 2 && sense.sample.len() < LARGEST_SAMPLE);
    let times = sense.column(|s| s.measurement.time_s);
    assert!((times.median().expect("many") - 5_000.0).abs() < 10.0);
}
