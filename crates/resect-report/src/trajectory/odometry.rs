//! Poses as messages `nav_msgs/Odometry`, in the encodings of ROS 1 and ROS 2.

use nalgebra::{Matrix3, Matrix6, Vector3};

use resect_core::evaluation::trajectory::{Pose, Twist};
pub use resect_io::format::bag::wire::stamp;

pub const TOPIC: &str = "/resect/odometry";
const CHILD_FRAME: &str = "vehicle";
/// MD5 of the definition below by genmsg, with which ROS 1 checks that both sides use the same definition.
pub const ROS1_MD5: &str = "cd5e73d190d741a2f92e81eda573aca7";
/// Separator between the definition of a message and those of its fields.
const SEPARATOR: &str =
    "================================================================================\n";
/// Value of ROS for an unknown covariance.
const UNKNOWN: f64 = -1.0;

const HEADER_1: &str = "MSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n";
const HEADER_2: [&str; 2] = [
    "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n",
    "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n",
];
const PARTS: [&str; 7] = [
    "MSG: geometry_msgs/PoseWithCovariance\ngeometry_msgs/Pose pose\nfloat64[36] covariance\n",
    "MSG: geometry_msgs/Pose\ngeometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n",
    "MSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n",
    "MSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n",
    "MSG: geometry_msgs/TwistWithCovariance\ngeometry_msgs/Twist twist\nfloat64[36] covariance\n",
    "MSG: geometry_msgs/Twist\ngeometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n",
    "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n",
];
const ODOMETRY: &str = "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n\
                        geometry_msgs/TwistWithCovariance twist\n";

/// Returns the definition with those of all messages in it, in the format of ROS 1.
pub fn ros1_definition() -> String {
    [&[ODOMETRY, HEADER_1], &PARTS[..]].concat().join(SEPARATOR)
}

/// Returns the definition with those of all messages in it, in the format of ROS 2.
pub fn ros2_definition() -> String {
    [&[ODOMETRY], &HEADER_2[..], &PARTS].concat().join(SEPARATOR)
}

/// Encodes one pose for ROS 1; `number` counts the messages.
pub fn ros1_message(pose: &Pose, frame_id: &str, number: u32) -> Vec<u8> {
    let mut bytes = number.to_le_bytes().to_vec();
    stamp(pose.time_s).iter().for_each(|part| bytes.extend(part.to_le_bytes()));
    for frame in [frame_id, CHILD_FRAME] {
        bytes.extend((frame.len() as u32).to_le_bytes());
        bytes.extend(frame.bytes());
    }
    numbers(pose).iter().for_each(|number| bytes.extend(number.to_le_bytes()));
    bytes
}

/// Encodes one pose as CDR, little-endian (OMG DDS-XTypes 1.3, section 7.4). Numbers are aligned to their size,
/// counted after the four bytes of the encapsulation header.
pub fn ros2_message(pose: &Pose, frame_id: &str) -> Vec<u8> {
    let mut bytes = Vec::new();
    stamp(pose.time_s).iter().for_each(|part| bytes.extend(part.to_le_bytes()));
    for frame in [frame_id, CHILD_FRAME] {
        bytes.resize(bytes.len().next_multiple_of(4), 0);
        bytes.extend((frame.len() as u32 + 1).to_le_bytes());
        bytes.extend(frame.bytes());
        bytes.push(0);
    }
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    numbers(pose).iter().for_each(|number| bytes.extend(number.to_le_bytes()));
    [&[0, 1, 0, 0][..], &bytes].concat()
}

/// Returns pose and twist with their covariances, in the order of the message. The pose is in the header's frame, with
/// rotations about its fixed axes; the twist is in the vehicle's frame, as ROS requires.
fn numbers(pose: &Pose) -> Vec<f64> {
    let (t, q) = (&pose.position_m, pose.orientation.quaternion());
    let mut numbers = vec![t.x, t.y, t.z, q.i, q.j, q.k, q.w];
    numbers.extend(rows(&pose.covariance));
    let vehicle_from_station1 = pose.orientation.inverse().to_rotation_matrix();
    match &pose.twist {
        Some(Twist { velocity_m_per_s, rate_rad_per_s, covariance }) => {
            let mut turn = Matrix6::zeros();
            let own: &Matrix3<f64> = vehicle_from_station1.matrix();
            turn.fixed_view_mut::<3, 3>(0, 0).copy_from(own);
            turn.fixed_view_mut::<3, 3>(3, 3).copy_from(own);
            for vector in [velocity_m_per_s, rate_rad_per_s] {
                let turned: Vector3<f64> = vehicle_from_station1 * vector;
                numbers.extend(turned.iter());
            }
            numbers.extend(rows(&(turn * covariance * turn.transpose())));
        }
        None => {
            numbers.extend([0.0; 6]);
            numbers.push(UNKNOWN);
            numbers.extend([0.0; 35]);
        }
    }
    numbers
}

fn rows(covariance: &Matrix6<f64>) -> impl Iterator<Item = f64> {
    // The matrix is symmetric, so the order of columns equals that of rows.
    covariance.iter().copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::UnitQuaternion;

    #[test]
    fn a_vehicle_that_drives_ahead_has_its_velocity_along_its_own_x() {
        let pose = Pose {
            time_s: 1.5,
            position_m: Vector3::new(1.0, 2.0, 3.0),
            orientation: UnitQuaternion::from_euler_angles(0.0, 0.0, std::f64::consts::FRAC_PI_2),
            covariance: Matrix6::identity(),
            twist: Some(Twist {
                velocity_m_per_s: Vector3::new(0.0, 2.0, 0.0),
                rate_rad_per_s: Vector3::new(0.0, 0.0, 0.5),
                covariance: Matrix6::from_diagonal(&[1.0, 4.0, 9.0, 1.0, 1.0, 1.0].into()),
            }),
            inter_prism_error_m: 0.0,
        };
        let numbers = numbers(&pose);
        assert_eq!(numbers.len(), 7 + 36 + 6 + 36);
        let close = |index: usize, value: f64| (numbers[index] - value).abs() < 1e-12;
        assert!(close(43, 2.0) && close(44, 0.0) && close(48, 0.5));
        assert!(close(49, 4.0) && close(49 + 7, 1.0), "variances are turned along");
        let bytes = ros2_message(&pose, "station1");
        // Eight bytes of stamp, 4 + 9 of the first name, 3 of padding, 4 + 8 of the second name, 4 of padding.
        assert_eq!(bytes.len(), 4 + 40 + 8 * numbers.len());
        assert_eq!(bytes[44..52], 1.0_f64.to_le_bytes());
    }
}
