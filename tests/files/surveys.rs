//! Surveyors' files: control points, their coordinates and the rig from GSI and JobXML.

use resect_core::deployment::{Deployment, Subject};
use resect_core::geometry::{Polar, RigidTransform};
use resect_core::network::PerStation;
use resect_io::error::OpenError;
use resect_io::findings::kinds;
use resect_io::open::open_files;
use resect_tools::simulation::{Preset, simulate};

const TRACKS: &str =
    "timestamp,id,distance,ha,va\n0.0,1,10,0.1,1.5\n0.1,2,11,0.1,1.5\n0.2,3,12,0.1,1.5\n";

fn gsi(readings: &[(String, Polar)]) -> String {
    let gon = |rad: f64| (rad.to_degrees() / 0.9 * 1e5).round() as i64;
    let line = |(name, p): &(String, Polar)| {
        format!(
            "*110001+{name:0>16} 21.322+{:016} 22.322+{:016} 31..08+{:016} 51....+000000000000+010\n",
            gon(p.azimuth_rad.rem_euclid(std::f64::consts::TAU)),
            gon(p.zenith_rad),
            (p.range_m * 1e5).round() as i64,
        )
    };
    readings.iter().map(line).collect()
}

fn jobxml(readings: &[(String, Polar)], constant_m: f64) -> String {
    let point = |(name, p): &(String, Polar)| {
        format!(
            "<PointRecord><Name>{name}</Name><Circle><HorizontalCircle>{}</HorizontalCircle><VerticalCircle>{}\
             </VerticalCircle><EDMDistance>{}</EDMDistance></Circle><TargetID>1</TargetID></PointRecord>\n",
            p.azimuth_rad.to_degrees(),
            p.zenith_rad.to_degrees(),
            p.range_m - constant_m
        )
    };
    let points: String = readings.iter().map(point).collect();
    format!(
        "<JOBFile><FieldBook><TargetRecord ID=\"1\"><PrismConstant>{constant_m}</PrismConstant></TargetRecord>\n{points}\
         </FieldBook></JOBFile>\n"
    )
}

/// Returns each station's readings of the first set of simulated control points, by name.
fn readings() -> ([Vec<(String, Polar)>; 3], PerStation<RigidTransform>) {
    let simulated = simulate(Preset::Warthog, 5);
    let points = &simulated.control_points[0].points;
    let of = |station: usize| {
        let named =
            points.iter().filter_map(|p| Some((format!("CP{}", p.marker), p.readings[station]?)));
        named.collect()
    };
    let truth = simulated.truth.station1_from_station.map(|level| RigidTransform::from(*level));
    (std::array::from_fn(of), truth)
}

fn opened(files: &[(&str, &str)]) -> Result<Deployment, OpenError> {
    let tracks = [("tracks.csv", TRACKS), ("rig.txt", "0.7 0.9 1.0\n")];
    open_files("d", &[&tracks[..], files].concat())
}

fn said(deployment: &Deployment) -> String {
    deployment.findings.iter().map(|f| format!("{f}\n")).collect()
}

#[test]
fn three_instruments_make_a_set_of_control_points() {
    let ([one, two, three], truth) = readings();
    let files = [gsi(&one), gsi(&two), jobxml(&three, 0.0344)];
    let named: Vec<_> = ["cp/s1.gsi", "cp/s2.gsi", "cp/s3.jxl"]
        .into_iter()
        .zip(files.iter().map(String::as_str))
        .collect();
    let deployment = opened(&named).expect("opens");
    let [set] = &deployment.control_points[..] else { panic!("{}", said(&deployment)) };
    assert_eq!(set.file, "cp/s1.gsi, cp/s2.gsi, cp/s3.jxl");
    assert_eq!(set.points.len(), one.len());
    assert_eq!(set.points[0].marker, 1);
    // The ranges include the constant: with another one they would be a centimetre off.
    let mut apart_m = set.disagreements_m(&truth);
    apart_m.sort_by(f64::total_cmp);
    assert!(apart_m[apart_m.len() / 2] < 0.005, "{apart_m:?}");
    let read = set.points[0].readings[0].expect("read");
    assert!((read.range_m - one[0].1.range_m).abs() < 1e-5);
    let text = said(&deployment);
    assert!(text.contains("(+10.0 mm by words 51 and 58); nothing is added"), "{text}");
    assert!(text.contains("the targets' prism constants (+34.4 mm)"), "{text}");
    assert!(deployment.ingredients.iter().filter(|i| i.file.starts_with("cp/")).all(|i| i.used));
}

#[test]
fn whose_a_file_is_must_be_said() {
    let ([one, two, three], _) = readings();
    let [a, b, c] = [gsi(&one), gsi(&two), gsi(&three)];
    let files = [("a.gsi", a.as_str()), ("b.gsi", b.as_str()), ("c.gsi", c.as_str())];
    let deployment = opened(&files).expect("opens");
    assert!(deployment.control_points.is_empty());
    assert!(said(&deployment).contains("surveys = ["), "{}", said(&deployment));
    let toml = [("deployment.toml", "surveys = [\"b.gsi\", \"a.gsi\", \"c.gsi\"]\n")];
    let deployment = opened(&[&files[..], &toml].concat()).expect("opens");
    let first = deployment.control_points[0].points[0].readings[0].expect("station 1 is b.gsi");
    assert!((first.range_m - two[0].1.range_m).abs() < 1e-5);
    let toml = [("deployment.toml", "surveys = [\"b.gsi\", \"x.gsi\", \"c.gsi\"]\n")];
    let error = opened(&[&files[..], &toml].concat()).expect_err("no x.gsi").to_string();
    assert!(error.contains("surveys names `x.gsi`"), "{error}");
}

#[test]
fn coordinates_count_only_where_they_are_named() {
    let ([one, two, three], _) = readings();
    let files = [gsi(&one), gsi(&two), gsi(&three)];
    let coordinates = "110001+00000CP1 81..00+00001000 82..00-00002000 83..00+00000500\n";
    let mut named: Vec<_> =
        ["s1.gsi", "s2.gsi", "s3.gsi"].into_iter().zip(files.iter().map(String::as_str)).collect();
    named.push(("grid.gsi", coordinates));
    let deployment = opened(&named).expect("opens");
    assert!(deployment.control_points[0].points.iter().all(|p| p.known_m.is_none()));
    assert!(said(&deployment).contains("grid.gsi: coordinates without readings are left out"));
    let toml = "control_points = [\"s1.gsi\", \"s2.gsi\", \"s3.gsi\", \"grid.gsi\"]\n";
    named.push(("deployment.toml", toml));
    let deployment = opened(&named).expect("opens");
    let known = deployment.control_points[0].points[0].known_m.expect("CP1");
    assert_eq!([known.x, known.y, known.z], [1.0, -2.0, 0.5]);
}

#[test]
fn a_rig_is_the_first_three_points_of_the_file_that_is_named() {
    let simulated = simulate(Preset::Warthog, 5);
    let names = ["left", "right", "top"].map(str::to_owned);
    let rig: Vec<_> = names.into_iter().zip(simulated.rig_reading).collect();
    let text = gsi(&rig);
    let files = [("tracks.csv", TRACKS), ("rig.gsi", text.as_str())];
    let deployment = open_files("d", &files).expect("opens");
    assert_eq!(deployment.rig, None);
    let toml = [("deployment.toml", "rig = \"rig.gsi\"\n")];
    let deployment = open_files("d", &[&files[..], &toml].concat()).expect("opens");
    let rig = deployment.rig.as_ref().expect("named");
    for (found, known) in rig.inter_prism_m.iter().zip(&simulated.truth.inter_prism_m) {
        assert!((found - known).abs() < 0.005, "{found} {known}");
    }
    assert!(deployment.control_points.is_empty());
    let doubt = deployment.findings.iter().find(|f| f.kind.is_doubt()).expect("derived distances");
    assert_eq!(doubt.kind, kinds::RIG_DERIVED_FROM_READING);
    assert_eq!(doubt.subject, Some(Subject::File("rig.gsi".to_owned())), "{doubt}");
}

#[test]
fn as_tracks_they_are_refused_with_the_reason() {
    let ([one, ..], _) = readings();
    for (name, text) in [("s1.gsi", gsi(&one)), ("s1.jxl", jobxml(&one, 0.0))] {
        let error = open_files("d", &[(name, &text)]).expect_err("no tracks").to_string();
        assert!(error.contains("not a track, because stamps are whole seconds"), "{error}");
    }
}
