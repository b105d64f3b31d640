//! Bags of every container and compression: identical readings with the right clock, and recovery from damage.
//!
//! `tests/fixtures/bags` has the first readings of the sample "HD2 in a tunnel", written by `tests/peers/write_bags.py` with the PyPI
//! package `rosbags`. The ignored tests read whole drives of the same script; `tests/run --peers` runs them.

use resect_io::findings::kinds;
use std::path::PathBuf;

use crate::common::{analyse, answer, assert_close, sample_folder};
use resect_core::analysis::Settings;
use resect_core::deployment::{Deployment, Finding, OneOrMany, Overrides};
use resect_core::geometry::RigidTransform;
use resect_core::network::PerStation;
use resect_core::progress::Progress;
use resect_io::error::{OpenError, Question};
use resect_io::open::open;
use resect_io::sample::Sample;
use resect_io::source::{Extras, Source};

const READINGS: usize = 30;
/// Tolerance of times (s): floating-point seconds since 1970, and microseconds in the text.
const SAME_S: f64 = 1e-6;

fn fixtures() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/bags")
}

fn fixture_names() -> Vec<String> {
    let folder = std::fs::read_dir(fixtures()).expect("they are committed");
    let mut names: Vec<_> =
        folder.map(|f| f.expect("readable").file_name().into_string().expect("ASCII")).collect();
    names.sort();
    assert_eq!(names.len(), 8, "{names:?}");
    names
}

/// Opens a fixture alone in a folder, since several together would be ambiguous.
fn open_alone(name: &str) -> Result<Deployment, OpenError> {
    open_bytes(name, &std::fs::read(fixtures().join(name)).expect("readable"))
}

fn open_bytes(name: &str, bytes: &[u8]) -> Result<Deployment, OpenError> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).expect("writable");
    open(&path)
}

/// Asserts that the tracks are the first readings of the sample.
#[track_caller]
fn assert_sample(deployment: &Deployment, readings: usize) {
    let sample = Sample::Hd2Tunnel.open().expect("built in");
    let total: usize = deployment.tracks.iter().map(|t| t.measurements.len()).sum();
    assert_eq!(total, readings, "{:?}", deployment.findings);
    for (track, expected) in deployment.tracks.iter().zip(&sample.tracks) {
        for (found, expected) in track.measurements.iter().zip(&expected.measurements) {
            assert!((found.time_s - expected.time_s).abs() < SAME_S, "{found:?} {expected:?}");
            assert_eq!(
                [found.range_m, found.azimuth_rad, found.zenith_rad],
                [expected.range_m, expected.azimuth_rad, expected.zenith_rad]
            );
        }
    }
}

fn words(deployment: &Deployment) -> String {
    deployment.findings.iter().map(|f| format!("{} {f}\n", f.severity.mark())).collect()
}

#[test]
fn every_container_and_compression_gives_the_same_readings() {
    for name in fixture_names() {
        let deployment = open_alone(&name).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_sample(&deployment, READINGS);
        let said = words(&deployment);
        assert!(!said.contains("damaged") && !said.contains("interrupted"), "{name}: {said}");
    }
}

#[test]
fn a_bag_that_is_cut_gives_what_came_before_and_says_so() {
    for name in fixture_names() {
        let bytes = std::fs::read(fixtures().join(&name)).expect("readable");
        let mut most = 0;
        for length in (0..bytes.len()).step_by(37).chain([bytes.len() - 1]) {
            match open_bytes(&name, &bytes[..length]) {
                Ok(deployment) => {
                    let readings: usize =
                        deployment.tracks.iter().map(|t| t.measurements.len()).sum();
                    let said = words(&deployment);
                    let complete = readings == READINGS;
                    assert!(complete || said.contains("! "), "{name} at {length}: {said}");
                    assert!(
                        ["cut off", "interrupted", "damaged"]
                            .iter()
                            .any(|word| said.contains(word)),
                        "{name} at {length}: {said}"
                    );
                    most = most.max(readings);
                }
                Err(error) => assert_one_line(&error, &name, length),
            }
        }
        // A small file is one block of zstd, which is read completely or not at all.
        assert!(most > 0 || name.ends_with(".zstd"), "{name}: nothing was saved at any length");
    }
}

#[track_caller]
fn assert_one_line(error: &OpenError, name: &str, place: usize) {
    let said = error.to_string();
    assert!(!said.contains('\n') && said.len() < 600, "{name} at {place}: {said}");
    assert!(said.contains("; "), "{name} at {place} has no remedy: {said}");
}

/// A random number generator with the same results on every machine (Steele, Lea & Flood 2014).
fn split_mix(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[test]
fn damaged_bytes_give_an_answer_or_one_line() {
    let mut state = 11;
    for name in fixture_names() {
        let bytes = std::fs::read(fixtures().join(&name)).expect("readable");
        for _ in 0..150 {
            let mut damaged = bytes.clone();
            for _ in 0..=split_mix(&mut state) % 4 {
                let place = split_mix(&mut state) as usize % damaged.len();
                let length = 1 + split_mix(&mut state) as usize % 8;
                let value = [0x00, 0xff, split_mix(&mut state) as u8][state as usize % 3];
                let end = (place + length).min(damaged.len());
                // Lengths become enormous, negative, zero.
                damaged[place..end].fill(value);
            }
            if let Err(error) = open_bytes(&name, &damaged) {
                assert_one_line(&error, &name, state as usize);
            }
        }
    }
}

/// The panic of issue 11: an index inside the header.
#[test]
fn a_damaged_header_or_index_costs_nothing_that_is_there() {
    let bytes = std::fs::read(fixtures().join("ros1-lz4.bag")).expect("readable");
    let key = b"index_pos=";
    let at = bytes.windows(key.len()).position(|w| w == key).expect("a header") + key.len();
    for index_at in [0_u64, 20, 4000, bytes.len() as u64 - 3, u64::MAX] {
        let mut damaged = bytes.clone();
        damaged[at..at + 8].copy_from_slice(&index_at.to_le_bytes());
        let deployment = open_bytes("x.bag", &damaged).expect("the records are whole");
        assert_sample(&deployment, READINGS);
        let said = words(&deployment);
        assert!(said.contains("index"), "{index_at}: {said}");
    }
    let mut damaged = bytes.clone();
    damaged[13..17].fill(0xff);
    let deployment = open_bytes("x.bag", &damaged).expect("the records behind it are whole");
    assert_sample(&deployment, READINGS);
    assert!(words(&deployment).contains("damaged at byte 13"), "{}", words(&deployment));
}

#[test]
fn a_recording_that_was_killed_is_read_without_an_index() {
    let bytes = std::fs::read(fixtures().join("ros1-plain.bag")).expect("readable");
    let text = b"index_pos=";
    let at = bytes.windows(text.len()).position(|w| w == text).expect("a header") + text.len();
    let index_at = u64::from_le_bytes(bytes[at..at + 8].try_into().expect("eight"));
    let mut killed = bytes[..index_at as usize].to_vec();
    killed[at..at + 8].fill(0);
    let deployment = open_bytes("drive.bag.active", &killed).expect("opens");
    assert_sample(&deployment, READINGS);
    assert!(words(&deployment).contains("the recording was interrupted"), "{}", words(&deployment));
}

/// ROS 1 bags around a chunk that inflates to a gigabyte: refused, with the limit in the message.
#[test]
fn a_bomb_is_refused() {
    let field = |name: &str, value: &[u8]| {
        let length = (name.len() + 1 + value.len()) as u32;
        [&length.to_le_bytes()[..], name.as_bytes(), b"=", value].concat()
    };
    let record = |header: &[u8], data: &[u8]| {
        let lengths = [header.len() as u32, data.len() as u32].map(u32::to_le_bytes);
        [&lengths[0][..], header, &lengths[1][..], data].concat()
    };
    // Unneeded index data, a megabyte each.
    let index = record(&[field("op", &[4]), field("conn", &[0; 4])].concat(), &vec![0; 1 << 20]);
    let mut encoder = zstd::stream::write::Encoder::new(Vec::new(), 1).expect("an encoder");
    std::io::Write::write_all(&mut encoder, b"#ROSBAG V2.0\n").expect("memory");
    for _ in 0..300 {
        std::io::Write::write_all(&mut encoder, &index).expect("memory");
    }
    let bomb = encoder.finish().expect("memory");
    assert!(bomb.len() < 1 << 16, "{}", bomb.len());
    let error = open_bytes("x.bag", &bomb).expect_err("300 MB").to_string();
    assert!(error.contains("decompress to more than") && error.contains("MiB"), "{error}");
}

#[test]
fn a_database_with_its_log_is_read_and_the_folder_left_as_it_was() {
    let folder = tempfile::tempdir().expect("a folder");
    let (killed, path) = (folder.path().join("killed.db3"), folder.path().join("drive.db3"));
    let compressed = std::fs::read(fixtures().join("sqlite-file.db3.zstd")).expect("readable");
    std::fs::write(&killed, zstd::decode_all(&compressed[..]).expect("whole")).expect("written");
    // Ten rows are only in the write-ahead log, as after the recorder was killed.
    let connection = rusqlite::Connection::open(&killed).expect("a database");
    connection.pragma_update(None, "journal_mode", "wal").expect("possible");
    connection.execute("DELETE FROM messages WHERE id > 20", []).expect("possible");
    let log = folder.path().join("killed.db3-wal");
    std::fs::copy(&killed, &path).expect("copied");
    std::fs::copy(&log, folder.path().join("drive.db3-wal")).expect("copied");
    drop(connection);
    std::fs::remove_file(&killed).expect("removed");
    let list = || {
        let mut names: Vec<_> = std::fs::read_dir(folder.path())
            .expect("readable")
            .map(|f| {
                let f = f.expect("readable");
                (f.file_name(), f.metadata().expect("there").len())
            })
            .collect();
        names.sort();
        names
    };
    let before = list();
    assert_sample(&open(folder.path()).expect("opens"), 20);
    assert_eq!(list(), before);
}

#[test]
fn a_foreign_database_is_passed_over_with_a_reason() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("notes.db3");
    let connection = rusqlite::Connection::open(&path).expect("a database");
    connection.execute("CREATE TABLE notes (text)", []).expect("possible");
    drop(connection);
    std::fs::copy(fixtures().join("ros1-plain.bag"), folder.path().join("a.bag")).expect("copied");
    let deployment = open(folder.path()).expect("one bag is left");
    let notes = deployment.ingredients.iter().find(|i| i.file == "notes.db3").expect("listed");
    assert!(!notes.used && notes.what.contains("not a ROS 2 bag"), "{notes:?}");
}

#[test]
fn the_same_drive_in_two_containers_is_read_once() {
    let all = open(&fixtures()).expect("eight times the same drive");
    let alone = open(&fixtures().join("ros1-plain.bag")).expect("one of them");
    let counts = |deployment: &Deployment| deployment.tracks.map(|track| track.measurements.len());
    assert_eq!(counts(&all), counts(&alone));
    let told = |f: &&Finding| f.kind == kinds::COPIES_LEFT_OUT;
    assert_eq!(all.findings.iter().filter(told).count(), 1);
}

/// Bags of whole drives, as `tests/peers/write_bags.py` writes them to the folder in RESECT_BAGS.
struct PeerBags {
    folder: PathBuf,
    /// Number of readings of the sample in the bags.
    readings: usize,
    /// Transforms of the sample.
    station1_from_station: PerStation<RigidTransform>,
}

impl PeerBags {
    fn find() -> Self {
        let folder = std::env::var_os("RESECT_BAGS").expect("tests/run --peers sets it");
        let sample = Sample::Hd2Tunnel.open().expect("built in");
        let analysis = analyse(&sample, &Settings::default());
        Self {
            folder: PathBuf::from(folder),
            readings: sample.tracks.iter().map(|t| t.measurements.len()).sum(),
            station1_from_station: answer(&analysis).calibration.station1_from_station.clone(),
        }
    }

    fn open_with(&self, name: &str, corrections: Overrides) -> Result<Deployment, OpenError> {
        let rig = Some(sample_folder("hd2-tunnel"));
        let extras = Extras { rig, corrections, ..Extras::default() };
        Source::at(self.folder.join(name)).with(extras).open(&Progress::default())
    }

    fn open(&self, name: &str) -> Deployment {
        self.open_with(name, Overrides::default()).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// Asserts that a deployment has the calibration of the sample.
    fn assert_same_answer(&self, name: &str, deployment: &Deployment) {
        let analysis = analyse(deployment, &Settings::default());
        let transforms = &answer(&analysis).calibration.station1_from_station;
        for (a, b) in transforms.iter().zip(&self.station1_from_station) {
            assert_close(a, b, [1e-6; 3], 1e-7);
        }
        eprintln!("{name}: the same answer");
    }
}

/// Bags with the readings of the sample, in all containers and compressions.
const BAGS_OF_THE_SAMPLE: [&str; 22] = [
    "ros1-plain.bag",
    "ros1-bz2.bag",
    "ros1-lz4.bag",
    "sqlite-plain",
    "sqlite-message",
    "sqlite-file",
    "mcap-plain",
    "mcap-message",
    "mcap-file",
    "mcap-chunk",
    "own-off-1.bag",
    "own-off-2",
    "own-hour-1.bag",
    "own-hour-2",
    "own-zero-1.bag",
    "own-zero-2",
    "headers-zero-1.bag",
    "headers-zero-2",
    "corrections-1.bag",
    "corrections-2",
    "split-1",
    "split-2",
];

#[test]
#[ignore = "needs the PyPI package rosbags: tests/run --peers"]
fn bags_of_the_peer_give_the_answer_of_the_table() {
    let bags = PeerBags::find();
    for name in BAGS_OF_THE_SAMPLE {
        let deployment = bags.open(name);
        assert_sample(&deployment, bags.readings);
        bags.assert_same_answer(name, &deployment);
        let said = words(&deployment);
        for (part, expected) in [
            ("own-off", "station 2 +0.3000 s"),
            ("own-hour", "station 3 -3600.0000 s"),
            ("headers-zero", "no synchronised time"),
            ("corrections", "time corrections, +0.0 ms from its stamps"),
            ("split", "3 bags are read as one drive"),
        ] {
            assert!(!name.starts_with(part) || said.contains(expected), "{name}: {said}");
        }
    }
}

#[test]
#[ignore = "needs the PyPI package rosbags: tests/run --peers"]
fn headers_of_the_peer_that_are_off_make_the_answer_weak() {
    let bags = PeerBags::find();
    for name in ["headers-off-1.bag", "headers-off-2"] {
        let deployment = bags.open(name);
        let said = words(&deployment);
        assert!(said.contains("station 2 +0.300 s, station 3 -0.200 s"), "{name}: {said}");
        assert!(deployment.findings.iter().any(|f| f.kind.is_doubt()), "{name}: {said}");
        let analysis = analyse(&deployment, &Settings::default());
        assert_ne!(answer(&analysis).calibration.verdict.name(), "good", "{name}");
    }
}

#[test]
#[ignore = "needs the PyPI package rosbags: tests/run --peers"]
fn topics_of_points_of_the_peer_have_to_be_named() {
    let bags = PeerBags::find();
    for name in ["points-1.bag", "points-2"] {
        let error = bags.open_with(name, Overrides::default()).expect_err("no station");
        let OpenError::Question(question) = error else { panic!("{error}") };
        let Question::Topics { topics, .. } = *question else { panic!("{question}") };
        let names: Vec<_> = topics.iter().map(|t| t.name.clone()).collect();
        assert_eq!(names, [1, 2, 3].map(|k| format!("/station_{k}/position")));
        let topics = Some(names.into_iter().collect());
        let deployment = bags.open_with(name, Overrides { topics, ..Overrides::default() });
        let deployment = deployment.expect("opens");
        assert_eq!(deployment.tracks[0].prism_constant_m, 0.0);
        bags.assert_same_answer(name, &deployment);
    }
}

#[test]
#[ignore = "needs the PyPI package rosbags: tests/run --peers"]
fn missing_bags_of_a_recording_of_the_peer_are_reported() {
    let bags = PeerBags::find();
    let piece = bags.open("split-1/drive_1.bag");
    assert!(words(&piece).contains("one of several bags of a recording"), "{}", words(&piece));
    let both = OneOrMany::Many(vec!["drive_0.bag".into(), "drive_2.bag".into()]);
    let both = Overrides { tracks: Some(both), ..Overrides::default() };
    let both = bags.open_with("split-1", both).expect("opens");
    assert!(words(&both).contains("bag number 1 is missing"), "{}", words(&both));
}
