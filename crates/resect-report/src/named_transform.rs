//! Transforms with the names of their frames, as text for other programs: matrices, quaternions, commands of ROS, URDF.
//!
//! Each maps the child's frame to the parent's: p_parent = R p_child + t, lengths in m, angles in rad. Numbers have the digits for 1 nm and
//! 1 nrad.

use std::fmt::Write;

use resect_core::geometry::RigidTransform;

/// Format of a text with transforms.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TransformFormat {
    /// Homogeneous matrices of four rows.
    Matrix,
    /// One line `x y z qx qy qz qw` for each transform.
    Quaternion,
    /// Homogeneous matrices in Python's syntax.
    Numpy,
    /// A shell command: `ros2 run tf2_ros static_transform_publisher`, with named arguments.
    Ros2,
    /// A shell command: `rosrun tf2_ros static_transform_publisher`, with arguments in order.
    Ros1,
    /// Fixed joints of a robot description (XML).
    Urdf,
}

impl TransformFormat {
    /// All formats in the order of a menu.
    pub const ALL: [Self; 6] =
        [Self::Urdf, Self::Ros2, Self::Ros1, Self::Matrix, Self::Numpy, Self::Quaternion];

    /// Returns the name of the format in the command line and in Python.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Matrix => "matrix",
            Self::Quaternion => "quaternion",
            Self::Numpy => "numpy",
            Self::Ros2 => "ros2",
            Self::Ros1 => "ros1",
            Self::Urdf => "urdf",
        }
    }

    /// Returns the name of the format in a menu.
    pub fn title(self) -> &'static str {
        match self {
            Self::Matrix => "4×4 matrix",
            Self::Quaternion => "x y z qx qy qz qw",
            Self::Numpy => "numpy",
            Self::Ros2 => "ROS 2 static_transform_publisher",
            Self::Ros1 => "ROS 1 static_transform_publisher",
            Self::Urdf => "URDF joints",
        }
    }
}

/// Transform between two named frames.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedTransform {
    /// Name of the transform, which is an identifier: "T12".
    pub name: String,
    /// Both frames for people: "station 2 into station 1".
    pub maps: String,
    /// Names of the frames in tf and URDF.
    pub parent: String,
    pub child: String,
    pub parent_from_child: RigidTransform,
}

/// Returns the text of transforms below comments, which are lines that begin with `#`.
pub fn transforms_text(
    format: TransformFormat,
    comments: &str,
    transforms: &[NamedTransform],
) -> String {
    let parent = transforms.first().map_or("", |transform| &transform.parent);
    let tf = format!("Parent {parent}, lengths in m");
    let commented = |heading: &str, write: &dyn Fn(&mut String, &NamedTransform)| {
        let mut text = format!("{comments}# {heading}\n");
        transforms.iter().for_each(|transform| write(&mut text, transform));
        text
    };
    match format {
        TransformFormat::Matrix => commented("Rows of [R t; 0 1], t in m", &|text, transform| {
            _ = writeln!(text, "# {}: {}", transform.name, transform.maps);
            for row in matrix(transform) {
                _ = writeln!(text, "{}", row.map(|cell| format!("{cell:>15}")).join(" "));
            }
        }),
        TransformFormat::Quaternion => commented("x y z (m) qx qy qz qw", &|text, transform| {
            _ = writeln!(text, "# {}: {}", transform.name, transform.maps);
            _ = writeln!(text, "{}", pose(transform).join(" "));
        }),
        TransformFormat::Numpy => commented("[R t; 0 1], t in m", &|text, transform| {
            _ = writeln!(text, "# {}: {}", transform.name, transform.maps);
            _ = writeln!(text, "{} = np.array([", transform.name);
            for row in matrix(transform) {
                let cells = row.map(|cell| format!("{cell:>15}"));
                _ = writeln!(text, "    [{}],", cells.join(", "));
            }
            text.push_str("])\n");
        }),
        TransformFormat::Ros2 => commented(&tf, &|text, transform| {
            let [x, y, z, qx, qy, qz, qw] = pose(transform);
            let (parent, child) = (&transform.parent, &transform.child);
            _ = writeln!(
                text,
                "ros2 run tf2_ros static_transform_publisher --x {x} --y {y} --z {z} --qx {qx} --qy {qy} --qz {qz} \
                 --qw {qw} --frame-id {parent} --child-frame-id {child}"
            );
        }),
        TransformFormat::Ros1 => commented(&tf, &|text, transform| {
            let NamedTransform { parent, child, .. } = transform;
            let pose = pose(transform).join(" ");
            _ = writeln!(text, "rosrun tf2_ros static_transform_publisher {pose} {parent} {child}");
        }),
        TransformFormat::Urdf => urdf(comments, transforms),
    }
}

/// Writes joints whose origin is the pose of the child's frame in the parent's. `rpy` are rotations about the parent's
/// fixed x, y and z axes in that order (URDF specification, element `origin`).
fn urdf(comments: &str, transforms: &[NamedTransform]) -> String {
    let mut text = String::new();
    for line in comments.lines() {
        // Two hyphens would end the comment, so a space separates them. A single one, as in a date, stays.
        let mut said = line.trim_start_matches(['#', ' ']).to_owned();
        while said.contains("--") {
            said = said.replace("--", "- -");
        }
        _ = writeln!(text, "<!-- {said} -->");
    }
    for NamedTransform { parent, child, parent_from_child, .. } in transforms {
        let translation_m = parent_from_child.translation_m;
        let [x, y, z] = [translation_m.x, translation_m.y, translation_m.z].map(digits);
        let (roll, pitch, yaw) = parent_from_child.rotation.euler_angles();
        let [roll, pitch, yaw] = [roll, pitch, yaw].map(digits);
        _ = write!(
            text,
            "<joint name=\"{parent}_{child}\" type=\"fixed\">\n  <parent link=\"{parent}\"/>\n  \
             <child link=\"{child}\"/>\n  <origin xyz=\"{x} {y} {z}\" rpy=\"{roll} {pitch} {yaw}\"/>\n</joint>\n"
        );
    }
    text
}

/// Replaces control characters: copies are pasted into shells, where a name must not begin a line of its own.
pub fn one_line(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

/// Formats a value to 1e-9, without negative zeros.
fn digits(value: f64) -> String {
    let text = format!("{value:.9}");
    if text == "-0.000000000" { "0.000000000".to_owned() } else { text }
}

fn matrix(transform: &NamedTransform) -> [[String; 4]; 4] {
    let matrix = transform.parent_from_child.matrix();
    std::array::from_fn(|row| std::array::from_fn(|column| digits(matrix[(row, column)])))
}

/// Returns the numbers x, y, z, qx, qy, qz, qw of a transform.
fn pose(transform: &NamedTransform) -> [String; 7] {
    let RigidTransform { rotation, translation_m } = &transform.parent_from_child;
    let turn = nalgebra::UnitQuaternion::from_rotation_matrix(rotation);
    let sign = if turn.w < 0.0 { -1.0 } else { 1.0 };
    let [qx, qy, qz, qw] = [turn.i, turn.j, turn.k, turn.w].map(|value| sign * value);
    [translation_m.x, translation_m.y, translation_m.z, qx, qy, qz, qw].map(digits)
}
