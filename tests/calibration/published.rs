//! The authors' layout: tracks as positions in one frame, with and without the transforms.

use resect_io::findings::kinds;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use crate::common::{analyse, answer, assert_close, field_data, of_field};
use nalgebra::{Rotation3, Vector3};
use resect_core::analysis::Settings;
use resect_core::calibration::{Alignment, Calibration, Method};
use resect_core::deployment::{Deployment, Severity, Subject, TrackFrame};
use resect_core::geometry::{LevelTransform, RigidTransform, wrap_to_pi};
use resect_core::network::PerStation;
use resect_io::open::open;
use resect_io::simulation_files::write_folder;
use resect_tools::simulation::{Preset, simulate};

/// Converts axes: our x is their y, our y their −x.
fn to_theirs(p: &Vector3<f64>) -> Vector3<f64> {
    Vector3::new(-p.y, p.x, p.z)
}

fn line_of(transform: &RigidTransform) -> String {
    // In their axes: conjugated by the rotation.
    let turn = Rotation3::from_matrix_unchecked(nalgebra::Matrix3::from_columns(
        &[Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| to_theirs(&axis)),
    ));
    let rotation = turn * transform.rotation * turn.inverse();
    let t = to_theirs(&transform.translation_m);
    let r = rotation.matrix();
    let row = |i: usize| format!("{} {} {} {}", r[(i, 0)], r[(i, 1)], r[(i, 2)], t[i]);
    format!("{} {} {}\n", row(0), row(1), row(2))
}

/// A simulated drive as the program writes it, and in the authors' published layout.
struct Published {
    folder: tempfile::TempDir,
    name: PathBuf,
    /// The deployment as measured.
    own: Deployment,
    applied: PerStation<RigidTransform>,
}

impl Published {
    fn new(name: &str, change: impl FnOnce(&mut PerStation<RigidTransform>)) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let simulated = simulate(Preset::Warthog, 3);
        let measured = folder.path().join("measured");
        write_folder(&simulated, &measured).expect("written");
        let own = open(&measured).expect("opens");
        let mut applied =
            simulated.truth.station1_from_station.map(|level| RigidTransform::from(*level));
        change(&mut applied);
        let published = Self { name: folder.path().join(name), folder, own, applied };
        for (index, track) in published.own.tracks.iter().enumerate() {
            let mut text = String::new();
            for m in &track.measurements {
                let p = to_theirs(&published.applied[index].apply(&track.position_m(m)));
                writeln!(text, "{} {} {} {}", m.time_s, p.x, p.y, p.z).expect("memory");
            }
            published.write(&format!("total_stations/trimble{}.csv", index + 1), &text);
        }
        for file in ["GCP_raw_1.txt", "GCP_raw_2.txt"] {
            let text = std::fs::read_to_string(measured.join(file)).expect("simulated");
            published.write(&format!("total_stations/{file}"), &text);
        }
        for file in ["calibration_raw.csv", "calibration_results.csv"] {
            let text = std::fs::read_to_string(measured.join(file)).expect("simulated");
            published.write(&format!("sensors_extrinsic_calibration/{file}"), &text);
        }
        published
    }

    fn write(&self, file: &str, text: &str) {
        let path = self.name.join(file);
        std::fs::create_dir_all(path.parent().expect("inside")).expect("writable");
        std::fs::write(path, text).expect("writable");
    }

    fn list(&self, transforms: &PerStation<RigidTransform>) {
        let text: String = transforms.iter().map(line_of).collect();
        self.write("list_tf/TF_list_static_cp.csv", &text);
    }

    fn open(&self) -> Deployment {
        open(&self.name).expect("opens")
    }
}

fn said(deployment: &Deployment) -> String {
    deployment.findings.iter().map(|f| format!("{f}\n")).collect()
}

fn calibration(deployment: &Deployment, method: Method) -> Calibration {
    let mut settings = Settings::default();
    settings.calibration.method = Some(method);
    answer(&analyse(deployment, &settings)).calibration.clone()
}

/// Returns the largest differences of range (m), azimuth and zenith angle (rad) between the readings of two deployments.
fn differences(a: &Deployment, b: &Deployment, station: usize) -> [f64; 3] {
    let (a, b) = (&a.tracks[station], &b.tracks[station]);
    assert_eq!(a.measurements.len(), b.measurements.len(), "station {}", station + 1);
    let mut worst = [0.0_f64; 3];
    for (m, n) in a.measurements.iter().zip(&b.measurements) {
        assert!((m.time_s - n.time_s).abs() < 2e-6);
        let (p, q) = (a.polar(m), b.polar(n));
        worst[0] = worst[0].max((p.range_m - q.range_m).abs());
        worst[1] = worst[1].max(wrap_to_pi(p.azimuth_rad - q.azimuth_rad).abs());
        worst[2] = worst[2].max((p.zenith_rad - q.zenith_rad).abs());
    }
    worst
}

#[test]
fn the_right_transforms_are_undone_and_the_readings_are_the_instruments_again() {
    let published = Published::new("run", |_| {});
    published.list(&published.applied);
    let deployment = published.open();
    assert_eq!(deployment.track_frame, TrackFrame::Own, "{}", said(&deployment));
    for station in 0..3 {
        let worst = differences(&deployment, &published.own, station);
        assert!(worst.iter().all(|off| *off < 1e-9), "station {}: {worst:?}", station + 1);
    }
    let used = |name: &str| deployment.ingredients.iter().any(|i| i.file.ends_with(name) && i.used);
    assert!(used("TF_list_static_cp.csv") && used("trimble3.csv"));
    assert!(said(&deployment).contains("TF_list_static_cp.csv (from line 1)"));
    let [theirs, ours] = [&deployment, &published.own].map(|d| calibration(d, Method::InterPrism));
    for (found, expected) in theirs.station1_from_station.iter().zip(&ours.station1_from_station) {
        assert_close(found, expected, [1e-6; 3], 1e-7);
    }
    assert_eq!(deployment.comparable_control_points().len(), 2);
}

#[test]
fn without_them_the_frame_is_said_and_nothing_is_compared_across_it() {
    let published = Published::new("run", |_| {});
    let deployment = published.open();
    assert_eq!(deployment.track_frame, TrackFrame::Common, "{}", said(&deployment));
    assert!(said(&deployment).contains("rates about the origin of that frame"));
    assert!(differences(&deployment, &published.own, 0).iter().all(|off| *off < 1e-9));

    let settings = Settings::default();
    let analysis = analyse(&deployment, &settings);
    let by_drive = answer(&analysis);
    assert!(by_drive.evaluation.control_points_mm.is_empty());
    assert!(by_drive.evaluation.inter_prism_mm.is_some());
    let words = by_drive.calibration.findings.iter().map(ToString::to_string).collect::<String>();
    assert!(!words.contains("control points contradict") && !words.contains("disagree"), "{words}");
    let ours = calibration(&published.own, Method::InterPrism);
    for station in 1..3 {
        let left = by_drive.calibration.station1_from_station[station];
        let whole = left.then_from(&published.applied[station]);
        assert_close(&whole, &ours.station1_from_station[station], [0.002, 0.002, 0.005], 1e-4);
    }

    let mut settings = Settings::default();
    settings.calibration.method = Some(Method::StaticGcp);
    let analysis = analyse(&deployment, &settings);
    let by_points = answer(&analysis);
    let expected = calibration(&published.own, Method::StaticGcp);
    assert_close(
        &by_points.calibration.station1_from_station[2],
        &expected.station1_from_station[2],
        [1e-9; 3],
        1e-12,
    );
    assert!(by_points.evaluation.inter_prism_mm.is_none());
    assert_eq!(by_points.evaluation.control_points_mm.len(), 2);
    let words = by_points.calibration.findings.iter().map(ToString::to_string).collect::<String>();
    assert!(words.contains("the tracks are in another"), "{words}");
}

#[test]
fn transforms_that_were_not_applied_are_not_undone() {
    let published = Published::new("run", |_| {});
    let mut other = published.applied.clone();
    other[1].translation_m.x += 0.003;
    published.list(&other);
    let deployment = published.open();
    assert_eq!(deployment.track_frame, TrackFrame::Common);
    let text = said(&deployment);
    assert!(text.contains("none of the 1 sets of transforms in list_tf/TF_list"), "{text}");
    // The applied transform is found among several.
    let both = other.iter().chain(&published.applied);
    published.write("list_tf/more.csv", &both.map(line_of).collect::<String>());
    let deployment = published.open();
    assert_eq!(deployment.track_frame, TrackFrame::Own);
    assert!(said(&deployment).contains("list_tf/more.csv (from line 4)"), "{}", said(&deployment));
}

#[test]
fn a_tilt_beyond_a_compensator_is_said() {
    let published = Published::new("run", |applied| {
        applied[2].rotation *= Rotation3::from_euler_angles(3e-4, 0.0, 0.0);
    });
    published.list(&published.applied);
    let text = said(&published.open());
    assert!(text.contains("tilts station 3 by 62″") && !text.contains("tilts station 2"), "{text}");
}

#[test]
fn tracks_in_their_own_frames_are_left_there() {
    let published =
        Published::new("run", |applied| *applied = PerStation::repeat(3, RigidTransform::IDENTITY));
    let deployment = published.open();
    assert_eq!(deployment.track_frame, TrackFrame::Own);
    assert!(said(&deployment).contains("in each station's own frame"));
    assert!(differences(&deployment, &published.own, 2).iter().all(|off| *off < 1e-9));
}

#[test]
fn interpolated_positions_are_no_tracks() {
    let published = Published::new("run", |_| {});
    let grid = |n: i32| {
        let line = |i: i32| format!("{} 1.0 2.0 3.0\n", 1657569001.5 + 0.1 * f64::from(i));
        (0..n).map(line).collect::<String>()
    };
    for station in 1..4 {
        published.write(&format!("predictions/f-2-1_{station}.csv"), &grid(50));
        // By its position: too few lines for the grid to be recognised.
        published.write(&format!("raw_prediction/nf-1-2-0-L_{station}.csv"), &grid(3));
    }
    let deployment = published.open();
    let what = |end: &str| {
        let ingredient = deployment.ingredients.iter().find(|i| i.file.ends_with(end));
        ingredient.map(|i| (i.what, i.used)).expect("listed")
    };
    assert_eq!(
        what("f-2-1_2.csv"),
        ("positions at equal time steps: interpolated, not measured", false)
    );
    assert_eq!(what("nf-1-2-0-L_1.csv"), ("positions computed from tracks, not measured", false));
    assert!(what("trimble1.csv").1);
}

#[test]
fn one_file_of_three_stands_for_all_and_two_sets_are_a_question() {
    let published = Published::new("run", |_| {});
    let track = |n: usize| published.name.join(format!("total_stations/trimble{n}.csv"));
    let deployment = open(&track(2)).expect("opens");
    assert!(deployment.tracks.iter().all(|track| track.measurements.len() > 100));
    std::fs::create_dir(published.name.join("again")).expect("made");
    for n in 1..4 {
        let text = std::fs::read_to_string(track(n)).expect("written");
        published.write(&format!("again/leica{n}.csv"), &text);
    }
    let error = open(&published.name).expect_err("two sets").to_string();
    assert!(error.contains("again/leica1.csv, total_stations/trimble1.csv"), "{error}");
    published.write("deployment.toml", "tracks = \"again/leica1.csv\"\n");
    assert!(open(&published.name).is_ok());
    std::fs::remove_file(track(3)).expect("there");
    let error = open(&track(1)).expect_err("incomplete").to_string();
    assert!(error.contains("those of the other two are missing; put three"), "{error}");
}

#[test]
fn stamps_of_another_day_than_the_folder_are_a_doubt() {
    let published = Published::new("20200101-1", |_| {});
    let deployment = published.open();
    let doubt =
        deployment.findings.iter().find(|f| f.kind == kinds::FOLDER_DATE_CONTRADICTS_STAMPS);
    let doubt = doubt.unwrap_or_else(|| panic!("not said: {}", said(&deployment)));
    assert!(doubt.kind.is_doubt() && doubt.severity == Severity::Warning, "{doubt}");
    assert!(published.folder.path().is_dir());
}

#[test]
fn positions_of_the_sensors_are_a_reading_of_the_rig() {
    let published = Published::new("run", |_| {});
    let rig = |name: &str| published.name.join("sensors_extrinsic_calibration").join(name);
    let known = published.open().rig.expect("there");
    let prisms_m = known.prisms_m.expect("a reading");
    let line = |p: &Vector3<f64>| format!("{} {} {} 1.0{}\n", p.x, p.y, p.z, " 0.0".repeat(9));
    let text: String = prisms_m.iter().map(line).collect();
    published.write("sensors_extrinsic_calibration/sensor_positions.csv", &text);
    std::fs::remove_file(rig("calibration_raw.csv")).expect("there");
    let deployment = published.open();
    assert_eq!(deployment.rig.as_ref().and_then(|rig| rig.prisms_m.as_ref()), Some(&prisms_m));
    assert!(!deployment.findings.iter().any(|f| f.kind.is_doubt()), "{}", said(&deployment));

    std::fs::remove_file(rig("calibration_results.csv")).expect("there");
    let deployment = published.open();
    let doubt = deployment.findings.iter().find(|f| f.kind.is_doubt()).expect("derived distances");
    assert_eq!(doubt.kind, kinds::RIG_DERIVED_FROM_READING);
    let file = "sensors_extrinsic_calibration/sensor_positions.csv".to_owned();
    assert_eq!(doubt.subject, Some(Subject::File(file)), "{doubt}");

    published.write("distances.csv", "0.70 0.90 1.03\n");
    let doubts = published.open().findings.into_iter().filter(|f| f.kind.is_doubt()).count();
    assert_eq!(doubts, 1, "more than 5 mm off the reading");
    published.write("again.csv", "0.70 0.90 1.03\n");
    let error = open(&published.name).expect_err("two").to_string();
    assert!(error.contains("rig = "), "{error}");
    published.write("deployment.toml", "rig = \"again.csv\"\n");
    let deployment = published.open();
    let rig = deployment.rig.expect("named");
    assert_eq!((rig.inter_prism_m, rig.prisms_m), ([0.70, 0.90, 1.03].into(), None));
    published.write("deployment.toml", "rig = \"total_stations/trimble1.csv\"\n");
    let error = open(&published.name).expect_err("no rig").to_string();
    assert!(error.contains("does not describe a rig"), "{error}");
}

/// Two sets of `list_tf` of the authors' repository (data/20220711-2, MIT): one from control points, and that of D.
const BY_POINTS: &str = "1.0 0.0 0.0 0.0 0.0 1.0 0.0 0.0 0.0 0.0 1.0 0.0\n\
0.8680246066119283 0.49652118010440266 4.892774548533936e-06 2.52681898970547 -0.4965211801274662 0.8680246065477573 1.0603733445372343e-05 5.319690381106842 1.0179295413874425e-06 -1.163366774546789e-05 0.999999999931811 -0.29296556794641193\n\
0.8963591628112443 0.443328604041812 -9.091985137624918e-06 0.02766459847635261 -0.4433286041349115 0.8963591626383024 -1.761117085320332e-05 -5.450739614750583 3.421483947849148e-07 1.981667144198189e-05 0.9999999998035912 -0.2626835119996478\n";
const BY_DRIVE: &str = "1.0 0.0 0.0 0.0 0.0 1.0 0.0 0.0 0.0 0.0 1.0 0.0\n\
0.8684435931486179 0.49578798376373157 -2.5973287570449e-05 2.526342842316592 -0.49578798389450485 0.8684435885275894 -9.258048040803694e-05 5.318380782602153 -2.3343954653840676e-05 9.327816894064579e-05 0.9999999953771215 -0.2916278150099093\n\
0.8963490104380502 0.44334912488965 7.033000618378267e-05 0.027111256874936384 -0.4433491253658931 0.8963489647782429 0.0002939018032605418 -5.450081513434377 6.726087904336889e-05 -0.0002946193372471038 0.999999954337709 -0.26779144649937164\n";

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).expect("writable");
    for entry in std::fs::read_dir(from).expect("there") {
        let path = entry.expect("readable").path();
        let target = to.join(path.file_name().expect("a name"));
        if path.is_dir() {
            copy(&path, &target);
        } else {
            std::fs::write(target, std::fs::read(path).expect("readable")).expect("written");
        }
    }
}

#[test]
#[cfg_attr(not(field_data), ignore = "needs ../shared/datasets")]
fn the_published_run_gives_the_table_of_the_data() {
    let path = of_field("2022-07-11-2-published");
    let deployment = open(&path).expect("opens");
    assert_eq!(deployment.track_frame, TrackFrame::Common);
    assert!(!deployment.findings.iter().any(|f| f.kind.is_doubt()), "{}", said(&deployment));
    let left = calibration(&deployment, Method::InterPrism);
    let mut settings = Settings::default();
    settings.calibration.method = Some(Method::StaticGcp);
    settings.calibration.alignment = Alignment::Rigid;
    let applied = answer(&analyse(&deployment, &settings)).calibration.clone();
    let whole =
        left.station1_from_station.zip(&applied.station1_from_station, RigidTransform::then_from);
    let table = |x: f64, y: f64, z: f64, yaw| LevelTransform::new(Vector3::new(x, y, z), yaw);
    let near = [0.003, 0.003, 0.005];
    assert_close(&whole[1], &table(5.3191, -2.5264, -0.2885, -0.51872), near, 1e-4);
    assert_close(&whole[2], &table(-5.4514, -0.0256, -0.2655, -0.45934), near, 1e-4);
}

#[test]
#[cfg_attr(not(field_data), ignore = "needs ../shared/datasets")]
fn station_1_reads_what_its_bag_has_and_the_others_too_once_they_are_undone() {
    let path = of_field("2022-07-11-2-published");
    let Some(polar) = field_data("2022-07-11-2") else { return };
    let polar = open(&polar).expect("opens");
    let folder = tempfile::tempdir().expect("a folder");
    let name = folder.path().join("20220711-2");
    copy(&path, &name);
    std::fs::create_dir(name.join("list_tf")).expect("made");
    std::fs::write(name.join("list_tf/d.csv"), BY_DRIVE).expect("written");
    let deployment = open(&name).expect("opens");
    assert_eq!(deployment.track_frame, TrackFrame::Common, "{}", said(&deployment));
    let [range_m, azimuth_rad, zenith_rad] = differences(&deployment, &polar, 0);
    assert!(range_m < 1e-5 && azimuth_rad < 1e-7 && zenith_rad < 1e-7, "{range_m} {azimuth_rad}");

    std::fs::write(name.join("list_tf/b.csv"), BY_POINTS).expect("written");
    let deployment = open(&name).expect("opens");
    assert_eq!(deployment.track_frame, TrackFrame::Own, "{}", said(&deployment));
    assert!(said(&deployment).contains("list_tf/b.csv"));
    for station in 1..3 {
        // The accuracy of the data's own conversion is a millimetre.
        let [range_m, azimuth_rad, _] = differences(&deployment, &polar, station);
        assert!(range_m < 0.002 && azimuth_rad < 2e-4, "{range_m} {azimuth_rad}");
    }
}
