//! Inputs as other programs, instruments and people leave them: read as what they are, or refused with the true cause.

use resect_io::findings::kinds;
use std::f64::consts::PI;
use std::path::Path;

use crate::common::{analyse, by, sample_folder};
use resect_core::calibration::Method;
use resect_core::deployment::{Deployment, Finding, FindingKind, OneOrMany, Overrides};
use resect_core::progress::Progress;
use resect_io::error::OpenError;
use resect_io::source::{Extras, Source};
use resect_tools::estimates::EstimatedTrajectory;

/// Time, station, range, azimuth and zenith angle, as the sample writes them.
type Row = [String; 5];

fn rows() -> Vec<Row> {
    let text = std::fs::read_to_string(sample_folder("warthog").join("inter_prism.csv"));
    let text = text.expect("readable");
    let row = |line: &str| {
        let fields: Vec<String> = line.split(',').map(ToOwned::to_owned).collect();
        fields.try_into().expect("five columns")
    };
    text.lines().skip(1).map(row).collect()
}

fn table(rows: &[Row]) -> String {
    let rows = rows.iter().map(|row| row.join(",") + "\n");
    "timestamp,id,distance,ha,va\n".to_owned() + &rows.collect::<String>()
}

fn number(field: &str) -> f64 {
    field.parse().expect("a number")
}

/// Opens a folder with these files.
fn opened(files: &[(&str, &[u8])]) -> Result<Deployment, OpenError> {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, content) in files {
        std::fs::write(folder.path().join(name), content).expect("writable");
    }
    Source::at(folder.path()).open(&Progress::default())
}

fn tracks(text: &str) -> Result<Deployment, OpenError> {
    opened(&[("inter_prism.csv", text.as_bytes())])
}

fn has(deployment: &Deployment, kind: FindingKind) -> bool {
    deployment.findings.iter().any(|finding| finding.kind == kind)
}

/// Returns the largest distance of the readings of two deployments (m); panics if their numbers differ.
fn apart_m(a: &Deployment, b: &Deployment) -> f64 {
    let mut largest_m: f64 = 0.0;
    for (a, b) in a.tracks.iter().zip(&b.tracks) {
        assert_eq!(a.measurements.len(), b.measurements.len());
        for (own, other) in a.measurements.iter().zip(&b.measurements) {
            assert!((own.time_s - other.time_s).abs() < 1e-6);
            largest_m = largest_m.max((a.position_m(own) - b.position_m(other)).norm());
        }
    }
    largest_m
}

#[test]
fn tracks_of_spreadsheets_and_shells_are_the_same_tracks() {
    let rows = rows();
    let plain = table(&rows);
    let expected = tracks(&plain).expect("the sample");
    let decimal_commas = plain.replace(',', ";").replace('.', ",");
    let utf16: Vec<u8> = std::iter::once(0xfeff)
        .chain(plain.replace('\n', "\r\n").encode_utf16())
        .flat_map(u16::to_le_bytes)
        .collect();
    let with_blanks = plain.replace(',', " ");
    let named = |text: &str| text.as_bytes().to_vec();
    let cases: [(&str, Vec<u8>); 9] = [
        ("decimal commas", named(&decimal_commas)),
        ("Excel's first line", named(&format!("sep=;\n{decimal_commas}"))),
        ("UTF-16", utf16),
        ("lone carriage returns", named(&plain.replace('\n', "\r"))),
        ("comments above", named(&format!("# Warthog, 9 October\n# m, rad\n\n{plain}"))),
        ("a header that is a comment", named(&format!("# {plain}"))),
        ("trailing commas", named(&plain.replace('\n', ",\n"))),
        ("blanks", named(&with_blanks)),
        ("Latin-1", {
            let mut bytes = b"Gr\xf6\xdfe und H\xf6he\n".to_vec();
            bytes.extend(plain.as_bytes());
            bytes
        }),
    ];
    for (name, content) in cases {
        let read = opened(&[("inter_prism.csv", &content)]);
        let read = read.unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(apart_m(&read, &expected) < 1e-9, "{name}");
        assert!(!has(&read, kinds::ROWS_SKIPPED), "{name}");
    }
}

#[test]
fn one_bad_row_costs_one_row() {
    let mut text = table(&rows());
    text = text.replacen("\n", "\ns,,m,rad,rad\n", 1);
    text.truncate(text.len() - 12);
    let read = tracks(&text).expect("the other rows");
    let finding = read.findings.iter().find(|finding| finding.kind == kinds::ROWS_SKIPPED);
    let said = finding.expect("a finding").to_string();
    assert!(
        said.contains("2 rows are not valid and skipped (line 2: `s` in column `timestamp`"),
        "{said}"
    );
    let left: usize = read.tracks.iter().map(|track| track.measurements.len()).sum();
    assert_eq!(left, rows().len() - 1);
}

#[test]
fn readings_in_face_right_are_the_same_points() {
    let plain = rows();
    let expected = tracks(&table(&plain)).expect("the sample");
    let mut both = plain;
    let third = both.len() / 3;
    for row in &mut both[third..2 * third] {
        row[3] = format!("{:.9}", (number(&row[3]) + PI) % (2.0 * PI));
        row[4] = format!("{:.9}", 2.0 * PI - number(&row[4]));
    }
    let read = tracks(&table(&both)).expect("both faces");
    assert!(apart_m(&read, &expected) < 1e-5);
    assert!(has(&read, kinds::READINGS_IN_FACE_RIGHT));
    assert!(!read.findings.iter().any(|finding| finding.kind.is_doubt()), "{:?}", read.findings);
}

#[test]
fn control_points_in_both_faces_are_their_means() {
    let header = "theodolite_number , marker_number , status , elevation , azimuth , distance\n";
    let mut text = header.to_owned();
    for station in 1..4 {
        for marker in 1..5 {
            let (zenith_rad, azimuth_rad) =
                (1.5 + 0.01 * f64::from(marker), 0.3 * f64::from(marker));
            // Vertical index 1e-4 and collimation 2e-4.
            let left = (zenith_rad + 1e-4, azimuth_rad + 2e-4);
            let right = (2.0 * PI - zenith_rad + 1e-4, azimuth_rad + PI - 2e-4);
            for (zenith_rad, azimuth_rad) in [left, right] {
                text += &format!(
                    "{station} , {marker} , 0 , {zenith_rad:.8} , {azimuth_rad:.8} , 20.0\n"
                );
            }
        }
    }
    let content = table(&rows());
    let read = opened(&[("inter_prism.csv", content.as_bytes()), ("GCP.txt", text.as_bytes())]);
    let read = read.expect("opens");
    let points = &read.control_points[0].points;
    assert_eq!(points.len(), 4);
    let (reading, left) = (points[0].readings[1].expect("measured"), points[0].face_one[1]);
    assert!((reading.zenith_rad - 1.51).abs() < 1e-7 && (reading.azimuth_rad - 0.3).abs() < 1e-7);
    assert!((left.expect("both faces").zenith_rad - 1.5101).abs() < 1e-7);
    assert!(!has(&read, kinds::CONTROL_POINT_REPEATED));
}

#[test]
fn stations_of_other_numbers_are_stations_in_ascending_order() {
    let plain = rows();
    let expected = tracks(&table(&plain)).expect("the sample");
    for numbers in [["0", "1", "2"], ["883411", "883502", "891017"]] {
        let mut other = plain.clone();
        for row in &mut other {
            row[1] = numbers[row[1].parse::<usize>().expect("a station") - 1].to_owned();
        }
        let read = tracks(&table(&other)).expect("renumbered");
        assert!(apart_m(&read, &expected) < 1e-12);
        assert!(has(&read, kinds::STATIONS_RENUMBERED));
    }
}

#[test]
fn clocks_that_were_set_while_recording_are_a_doubt() {
    let plain = rows();
    let start_s = number(&plain[0][0]);
    let shifted = |by_s: &dyn Fn(f64) -> f64| {
        let mut rows = plain.clone();
        for row in &mut rows {
            let time_s = number(&row[0]);
            row[0] = format!("{:.6}", time_s + by_s(time_s - start_s));
        }
        tracks(&table(&rows)).expect("opens")
    };
    let back = shifted(&|after_s| if (60.0..75.0).contains(&after_s) { -3.0 } else { 0.0 });
    assert!(has(&back, kinds::CLOCK_SET_BACK), "{:?}", back.findings);
    let jumped = shifted(&|after_s| if after_s < 30.0 { -40.0 * 86_400.0 } else { 0.0 });
    assert!(has(&jumped, kinds::STAMPS_JUMPED));
    let duration_s = jumped.end_s().expect("readings") - jumped.start_s().expect("readings");
    assert!(duration_s < 400.0, "{duration_s}");
    // Parts of a file in another order are no clock that was set.
    let mut parts = plain.clone();
    parts.rotate_left(1500);
    let read = tracks(&table(&parts)).expect("opens");
    assert!(!has(&read, kinds::CLOCK_SET_BACK), "{:?}", read.findings);
    let mut twice = plain.clone();
    twice.extend(plain.clone());
    assert!(!has(&tracks(&table(&twice)).expect("opens"), kinds::CLOCK_SET_BACK));
}

#[test]
fn rounded_stamps_are_a_doubt_and_exact_ones_are_not() {
    for (decimals, is_doubtful) in [(0, true), (1, true), (2, false), (6, false)] {
        let mut rounded = rows();
        for row in &mut rounded {
            row[0] = format!("{:.decimals$}", number(&row[0]));
        }
        let read = tracks(&table(&rounded)).expect("opens");
        assert_eq!(has(&read, kinds::STAMPS_COARSE), is_doubtful, "{decimals}");
    }
}

#[test]
fn joined_seconds_and_nanoseconds_are_named() {
    let mut joined = rows();
    for row in &mut joined {
        let (seconds, decimals) = row[0].split_once('.').expect("decimals");
        let nanoseconds: u32 = format!("{decimals:0<9}").parse().expect("digits");
        row[0] = format!("{seconds}.{nanoseconds}");
    }
    let error = tracks(&table(&joined)).expect_err("wrong stamps").to_string();
    assert!(error.contains("join seconds and nanoseconds without leading zeros"), "{error}");
}

#[test]
fn another_time_zone_is_the_reason_that_a_calibration_gives() {
    let mut late = rows();
    for row in late.iter_mut().filter(|row| row[1] == "3") {
        row[0] = format!("{:.6}", number(&row[0]) + 3600.0);
    }
    let deployment = tracks(&table(&late)).expect("opens");
    let analysis = analyse(&deployment, &by(Method::Joint));
    let why = analysis.answer.as_ref().expect_err("no triplets").to_string();
    assert!(why.contains("stations 1 and 3 never measured at the same time"), "{why}");
}

#[test]
fn what_is_not_there_is_named() {
    let pointer = b"version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 1482371\n";
    let metadata = b"rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: mcap\n";
    let columns = b"[columns]\ntime = \"t\"\nstation = \"s\"\nrange = \"r\"\nazimuth = \"hzz\"\nvertical = \"v\"\n";
    let foreign = b"t,s,r,hz,v\n1,1,20,1,1.5\n2,2,20,1,1.5\n";
    type Files<'a> = &'a [(&'a str, &'a [u8])];
    let cases: [(Files<'_>, &str); 3] = [
        (&[("drive.bag", pointer)], "a Git LFS pointer, not the file itself"),
        (&[("metadata.yaml", metadata)], "describes a bag whose files are missing here"),
        (
            &[("deployment.toml", columns), ("t.csv", foreign)],
            "t.csv:1: no column `hzz` among t, s, r, hz, v",
        ),
    ];
    for (files, expected) in cases {
        let error = opened(files).expect_err(expected).to_string();
        assert!(error.contains(expected), "{error}");
    }
}

/// The answer to a question about columns is kept although other lines are above the header.
#[test]
fn a_mapped_table_has_its_header_anywhere_near_the_top() {
    let plain = table(&rows()).replace("timestamp,id,distance,ha,va", "t,s,r,hz,v");
    let text = format!("Report of instrument 7\nOperator: N. N.\n\n{plain}");
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("t.csv"), text).expect("writable");
    let columns: resect_core::deployment::ColumnMapping = toml::from_str(
        "time = \"t\"\nstation = \"s\"\nrange = \"r\"\nazimuth = \"hz\"\nvertical = \"v\"\n",
    )
    .expect("a mapping");
    let tracks = Some(OneOrMany::One("t.csv".to_owned()));
    let corrections = Overrides { columns: Some(columns), tracks, ..Overrides::default() };
    let extras = Extras { corrections, ..Extras::default() };
    let path: &Path = folder.path();
    let read = Source::at(path).with(extras).open(&Progress::default()).expect("opens");
    assert_eq!(read.tracks[0].measurements.len(), 977);
}

#[test]
fn a_station_whose_clock_is_seconds_off_is_named_and_equal_clocks_are_not() {
    for (station, shift_s) in [("2", 18.0), ("1", -7.5), ("3", 37.0)] {
        let shifted = rows().into_iter().map(|mut row| {
            if row[1] == station {
                row[0] = format!("{:.6}", number(&row[0]) + shift_s);
            }
            row
        });
        let deployment = tracks(&table(&shifted.collect::<Vec<Row>>())).expect("opens");
        let off = deployment.findings.iter().filter(|f| f.kind == kinds::STATION_CLOCK_OFF);
        let off: Vec<&Finding> = off.collect();
        let [only] = off[..] else { panic!("{off:?}") };
        assert!(only.to_string().contains(&format!("station {station}")), "{only}");
        assert!((only.quantities[0].value - shift_s).abs() < 0.3, "{only}");
    }
    assert!(!has(&tracks(&table(&rows())).expect("opens"), kinds::STATION_CLOCK_OFF));
}

#[test]
fn ranges_that_were_repeated_while_the_prism_moved_are_left_out() {
    let mut frozen = rows();
    let of_station_2: Vec<usize> = (0..frozen.len()).filter(|row| frozen[*row][1] == "2").collect();
    let range = frozen[of_station_2[300]][2].clone();
    for row in &of_station_2[301..340] {
        frozen[*row][2].clone_from(&range);
    }
    let deployment = tracks(&table(&frozen)).expect("opens");
    assert!(has(&deployment, kinds::RANGES_REPEATED));
    assert_eq!(deployment.tracks[1].left_out.iter().filter(|left_out| **left_out).count(), 39);
    assert!(!has(&tracks(&table(&rows())).expect("opens"), kinds::RANGES_REPEATED));
}

#[test]
fn coordinates_of_the_set_up_in_cartesian_tracks_are_a_doubt() {
    let own = tracks(&table(&rows())).expect("opens");
    for (origin_m, is_doubt) in [([0.0; 3], false), ([100.0, 200.0, 10.0], true)] {
        let files: Vec<(String, String)> = (1..4)
            .zip(&own.tracks)
            .map(|(number, track)| {
                let row = |m| {
                    let at = track.position_m(m);
                    let [x, y, z] = [0, 1, 2].map(|axis| at[axis] + origin_m[axis]);
                    format!("{:.6},{x:.5},{y:.5},{z:.5}\n", m.time_s)
                };
                let rows: String = track.measurements.iter().map(row).collect();
                (format!("rts{number}.csv"), format!("time,x,y,z\n{rows}"))
            })
            .collect();
        let toml = "tracks = [\"rts1.csv\", \"rts2.csv\", \"rts3.csv\"]\n[columns]\ntime = \"time\"\nx = \"x\"\ny = \"y\"\nz = \"z\"\n";
        let mut all: Vec<(&str, &[u8])> =
            files.iter().map(|(name, text)| (&**name, text.as_bytes())).collect();
        all.push(("deployment.toml", toml.as_bytes()));
        let deployment = opened(&all).expect("opens");
        assert_eq!(has(&deployment, kinds::CARTESIAN_ORIGIN_DOUBTFUL), is_doubt);
    }
}

/// Reads a trajectory that is written to a file of this name.
fn trajectory(name: &str, text: &str) -> Result<EstimatedTrajectory, OpenError> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(name);
    std::fs::write(&path, text).expect("writable");
    resect_io::estimate_file::read_truth(&path, None, Default::default())
}

#[test]
fn rounded_positions_unset_orientations_and_missing_times_are_named() {
    let along = |digits: usize, time: fn(f64) -> f64, turned: bool| -> String {
        let line = |index: u32| {
            let s = 0.1 * f64::from(index);
            let (x, y) = (388_096.0 + 20.0 * s.sin(), 5_184_990.0 + 30.0 * s.cos());
            let q = if turned { [(0.5 * s).sin(), (0.5 * s).cos()] } else { [0.0, 1.0] };
            format!("{} {x:.digits$} {y:.digits$} {s:.3} 0 0 {:.6} {:.6}\n", time(s), q[0], q[1])
        };
        (0..200).map(line).collect()
    };
    let codes = |text: &str| -> Vec<&str> {
        let read = trajectory("slam.tum", text).expect("a trajectory");
        read.findings.iter().map(|finding| finding.kind.code).collect()
    };
    assert_eq!(codes(&along(0, |s| s, true)), ["estimate-positions-rounded"]);
    assert_eq!(codes(&along(4, |s| s, false)), ["estimate-orientations-constant"]);
    assert!(codes(&along(4, |s| s, true)).is_empty());
    let why = trajectory("slam.tum", &along(4, |s| 1e-8 * s, true)).expect_err("no time");
    assert!(why.to_string().contains("no pose has a time"), "{why}");
    let far = along(4, |s| s, true).replace("388", "9e388");
    assert!(trajectory("slam.tum", &far).is_err());
}
