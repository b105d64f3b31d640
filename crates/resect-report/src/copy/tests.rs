//! Reads every format back as its consumer would.

use nalgebra::{Matrix4, Quaternion, Rotation3, UnitQuaternion, Vector3};
use serde_json::Value;

use super::*;
use crate::named_transform::TransformFormat;
use resect_core::analysis::Settings;
use resect_core::calibration::{Method, TransformSigma};
use resect_core::geometry::RigidTransform;

/// Largest error of a copy: below 1 µm and 1 µrad.
const LOST: f64 = 1e-8;

fn transforms() -> [RigidTransform; 2] {
    [
        RigidTransform {
            rotation: Rotation3::from_euler_angles(2e-4, -1e-4, 2.345_678_901_2),
            translation_m: Vector3::new(-123.456_789_012, 98.765_432_1, -0.123_456_789),
        },
        RigidTransform {
            rotation: Rotation3::from_euler_angles(0.0, 0.0, -0.7),
            translation_m: Vector3::new(1.0, -2.0, -1e-12),
        },
    ]
}

fn summary(verdict: Verdict) -> ResultSummary {
    let sigma = TransformSigma { translation_m: Vector3::new(1e-3, 2e-3, 3e-3), yaw_rad: 1e-5 };
    let [two, three] = transforms();
    ResultSummary {
        deployment: "field\nrm -rf everything".to_owned(),
        readings: [1, 2, 3].into(),
        method: Method::InterPrism,
        fallback: None,
        verdict,
        independently_checked: true,
        doubts: vec!["station 2 can slide\nalong the track".to_owned()],
        triplets: 10,
        one_prism: false,
        stations: vec![
            StationSummary::new(2, &two, Some(sigma)),
            StationSummary::new(3, &three, None),
        ],
        covariance: None,
        inter_prism_mm: None,
        control_points_mm: Vec::new(),
        estimates: Vec::new(),
        settings: Settings::default(),
    }
}

/// Copies a good answer: T12 and T13.
fn copied(format: CopyFormat) -> String {
    text(format, &summary(Verdict::Good), CopiedTransforms::All)
}

#[track_caller]
fn assert_is(found: &Matrix4<f64>, expected: &RigidTransform) {
    let off = (found - expected.matrix()).abs().max();
    assert!(off < LOST, "off by {off}: {found}");
}

fn numbers(line: &str) -> Vec<f64> {
    line.split_whitespace().filter_map(|word| word.parse().ok()).collect()
}

fn code_lines(text: &str) -> Vec<&str> {
    text.lines().filter(|line| !line.starts_with('#')).collect()
}

fn from_rows(rows: &[Vec<f64>]) -> Matrix4<f64> {
    Matrix4::from_row_iterator(rows.concat())
}

fn from_pose(pose: &[f64]) -> Matrix4<f64> {
    let &[x, y, z, qx, qy, qz, qw] = pose else { panic!("seven numbers: {pose:?}") };
    let quaternion = Quaternion::new(qw, qx, qy, qz);
    assert!((quaternion.norm() - 1.0).abs() < LOST);
    let rotation = UnitQuaternion::from_quaternion(quaternion);
    let translation_m = Vector3::new(x, y, z);
    RigidTransform { rotation: rotation.into(), translation_m }.matrix()
}

#[test]
fn the_matrices_are_read_back() {
    let text = copied(CopyFormat::Transforms(TransformFormat::Matrix));
    let rows: Vec<_> = code_lines(&text).into_iter().map(numbers).collect();
    assert_eq!(rows.len(), 8);
    for (rows, expected) in rows.chunks(4).zip(transforms()) {
        assert_is(&from_rows(rows), &expected);
    }
    assert!(!text.contains("-0.000000000"), "{text}");
}

#[test]
fn the_quaternions_are_read_back_in_the_order_that_is_named() {
    let text = copied(CopyFormat::Transforms(TransformFormat::Quaternion));
    assert!(text.contains("x y z (m) qx qy qz qw"));
    let lines = code_lines(&text);
    assert_eq!(lines.len(), 2);
    for (line, expected) in lines.into_iter().zip(transforms()) {
        assert_is(&from_pose(&numbers(line)), &expected);
    }
}

#[test]
fn numpy_is_read_back() {
    let text = copied(CopyFormat::Transforms(TransformFormat::Numpy));
    let arrays: Vec<&str> = text.split("np.array(").skip(1).collect();
    assert_eq!(arrays.len(), 2);
    for (array, expected) in arrays.into_iter().zip(transforms()) {
        let array = array.split(')').next().expect("closed");
        // A list of lists with trailing commas is almost JSON.
        let array = array.replace(char::is_whitespace, "").replace(",]", "]");
        let rows: Vec<Vec<f64>> = serde_json::from_str(&array).expect("a list of lists");
        assert_is(&from_rows(&rows), &expected);
    }
    assert!(text.contains("T12 = np") && text.contains("T13 = np"));
}

#[test]
fn both_publishers_name_parent_and_child() {
    let text = copied(CopyFormat::Transforms(TransformFormat::Ros2));
    for ((line, expected), child) in code_lines(&text).into_iter().zip(transforms()).zip(2..) {
        let words: Vec<&str> = line.split_whitespace().collect();
        assert_eq!(words[..4], ["ros2", "run", "tf2_ros", "static_transform_publisher"]);
        let value = |flag: &str| {
            words.iter().position(|word| *word == flag).map(|at| words[at + 1]).expect("given")
        };
        let pose = ["--x", "--y", "--z", "--qx", "--qy", "--qz", "--qw"]
            .map(|flag| value(flag).parse().expect("a number"));
        assert_is(&from_pose(&pose), &expected);
        assert_eq!(value("--frame-id"), "station1");
        assert_eq!(value("--child-frame-id"), format!("station{child}"));
    }
    let text = copied(CopyFormat::Transforms(TransformFormat::Ros1));
    for ((line, expected), child) in code_lines(&text).into_iter().zip(transforms()).zip(2..) {
        let arguments = line
            .strip_prefix("rosrun tf2_ros static_transform_publisher ")
            .and_then(|rest| rest.strip_suffix(&format!(" station1 station{child}")))
            .expect("parent, then child");
        assert_is(&from_pose(&numbers(arguments)), &expected);
    }
}

/// A URDF joint rotates about fixed axes: first x, then y, then z.
#[test]
fn urdf_joints_are_read_back() {
    let text = copied(CopyFormat::Transforms(TransformFormat::Urdf));
    for (number, expected) in (2..).zip(transforms()) {
        let joint = text.split("<joint ").nth(number - 1).expect("one a station");
        assert!(joint.contains("type=\"fixed\"") && joint.contains("<parent link=\"station1\"/>"));
        assert!(joint.contains(&format!("<child link=\"station{number}\"/>")), "{joint}");
        let attribute = |name: &str| {
            let value = joint.split(&format!("{name}=\"")).nth(1).expect("given");
            numbers(value.split('"').next().expect("closed"))
        };
        let (xyz, rpy) = (attribute("xyz"), attribute("rpy"));
        let about = |axis: usize| {
            Rotation3::from_axis_angle(
                &nalgebra::Unit::new_unchecked(Vector3::ith(axis, 1.0)),
                rpy[axis],
            )
        };
        let rotation = about(2) * about(1) * about(0);
        let translation_m = Vector3::new(xyz[0], xyz[1], xyz[2]);
        assert_is(&RigidTransform { rotation, translation_m }.matrix(), &expected);
    }
    let mut dated = summary(Verdict::Good);
    dated.deployment = "2022-07-11-2".to_owned();
    assert!(text_of(&dated).starts_with("<!-- 2022-07-11-2: "), "{}", text_of(&dated));
    // The first two hyphens end an XML comment.
    let mut hostile = summary(Verdict::Weak);
    hostile.deployment = "a --> <joint/> ---".to_owned();
    let text = text_of(&hostile);
    for line in text.lines().filter(|line| line.starts_with("<!--")) {
        assert!(!line["<!--".len()..line.len() - "-->".len()].contains("--"), "{line}");
    }
}

fn text_of(summary: &ResultSummary) -> String {
    text(CopyFormat::Transforms(TransformFormat::Urdf), summary, CopiedTransforms::All)
}

#[test]
fn json_is_the_transforms_part_of_the_contract() {
    let value: Value = serde_json::from_str(&copied(CopyFormat::Json)).expect("JSON");
    assert_eq!(value["schema"], 2);
    assert_eq!(value["diagnosis"]["verdict"], "good");
    assert_eq!(value["diagnosis"]["independently_checked"], true);
    let copied = value["transforms"].as_array().expect("a list");
    for (transform, expected) in copied.iter().zip(transforms()) {
        let rows: Vec<Vec<f64>> =
            serde_json::from_value(transform["matrix"].clone()).expect("four rows");
        assert_is(&from_rows(&rows), &expected);
        assert_eq!(transform["to"], 1);
    }
    assert_eq!(copied[0]["sigma"]["yaw_rad"], 1e-5);
    assert_eq!(copied[1]["sigma"], Value::Null);
}

#[test]
fn toml_is_read_back() {
    let value: toml::Table = copied(CopyFormat::Toml).parse().expect("TOML");
    assert_eq!(value["verdict"].as_str(), Some("good"));
    let copied = value["transforms"].as_array().expect("a list");
    for (transform, expected) in copied.iter().zip(transforms()) {
        let list =
            |name: &str| -> Vec<f64> { transform[name].clone().try_into().expect("numbers") };
        let pose = [list("translation_m"), list("quaternion_xyzw")].concat();
        assert_is(&from_pose(&pose), &expected);
        let yaw_rad = transform["yaw_rad"].as_float().expect("a number");
        assert!((yaw_rad - expected.yaw_rad()).abs() < LOST);
    }
    assert!(copied[1].get("sigma").is_none());
}

#[test]
fn a_part_is_only_that_part() {
    for format in CopyFormat::ALL {
        let choices =
            [CopiedTransforms::All, CopiedTransforms::Station(2), CopiedTransforms::Station(3)];
        let [both, one, other] =
            choices.map(|copied| text(format, &summary(Verdict::Good), copied));
        assert!(one.len() < both.len() && other.len() < both.len(), "{both}");
        // A copy of T13 does not contain the x of station 2.
        assert!(one.contains("-123.456789") && !other.contains("-123.456789"), "{other}");
    }
}

#[test]
fn a_doubtful_answer_says_so_in_every_form() {
    for format in CopyFormat::ALL {
        let doubtful = text(format, &summary(Verdict::Weak), CopiedTransforms::Station(2));
        assert!(doubtful.contains("station 2 can slide"), "{doubtful}");
        assert!(doubtful.to_lowercase().contains("weak"), "{doubtful}");
        let good = text(format, &summary(Verdict::Good), CopiedTransforms::Station(2));
        assert!(!good.contains("WARNING"), "{good}");
    }
}

#[test]
fn a_good_answer_that_nothing_checked_says_so_in_every_form() {
    for format in CopyFormat::ALL {
        let unchecked = ResultSummary { independently_checked: false, ..summary(Verdict::Good) };
        let copied = text(format, &unchecked, CopiedTransforms::Station(2));
        let says = ["not independently checked", "\"independently_checked\": false"];
        assert!(says.iter().any(|words| copied.contains(words)), "{copied}");
        assert!(
            !text(format, &summary(Verdict::Good), CopiedTransforms::Station(2))
                .contains("not independently")
        );
    }
}

/// A deployment's name comes from a file, and these lines are pasted into a shell.
#[test]
fn a_name_cannot_smuggle_in_a_line() {
    for format in [
        CopyFormat::Transforms(TransformFormat::Ros1),
        CopyFormat::Transforms(TransformFormat::Ros2),
        CopyFormat::Transforms(TransformFormat::Numpy),
        CopyFormat::Transforms(TransformFormat::Matrix),
    ] {
        let text = text(format, &summary(Verdict::Weak), CopiedTransforms::All);
        assert!(!text.lines().any(|line| line.starts_with("rm") || line.starts_with("along")));
    }
}
