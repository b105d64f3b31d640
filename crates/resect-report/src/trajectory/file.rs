//! The content of the file of a trajectory, by its kind.

use std::fmt::Write;
use std::path::Path;

use super::ply::{self, PlyPoint};
use super::{mcap_bag, ros1_bag};

use resect_core::calibration::joint::prisms::Instant;
use resect_core::evaluation::trajectory::{Pose, PoseSigma, Trajectory};

/// What a file of a trajectory is, by the ending of its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    Tum,
    Csv,
    /// Points with time and σ.
    Ply,
    /// `nav_msgs/Odometry` of ROS 2.
    Mcap,
    /// `nav_msgs/Odometry` of ROS 1.
    Ros1Bag,
}

impl FileKind {
    /// What the ending of a file's name says. TUM has none of its own, but is not meant by that of another format.
    pub fn of(path: &Path) -> Result<Self, Unwritable> {
        let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
        Ok(match ending.to_str() {
            Some("" | "tum" | "txt") => Self::Tum,
            Some("csv") => Self::Csv,
            Some("ply") => Self::Ply,
            Some("mcap") => Self::Mcap,
            Some("bag") => Self::Ros1Bag,
            _ => return Err(Unwritable::UnknownEnding(ending.to_string_lossy().into_owned())),
        })
    }
}

/// Why a trajectory cannot be written as a kind of file.
#[derive(Debug, thiserror::Error)]
pub enum Unwritable {
    #[error("no trajectory is written as .{0}; write .tum, .txt, .csv, .ply, .mcap or .bag")]
    UnknownEnding(String),
    #[error(
        "a message of odometry has an orientation, and one prism has none; write .tum, .csv or .ply"
    )]
    NoOrientation,
    #[error("the MCAP cannot be made: {0}; write .bag or .csv")]
    Mcap(#[from] ::mcap::McapError),
}

/// The frame of poses that were not brought elsewhere, as messages name it.
pub const STATION1: &str = "station1";

/// The content of a file of poses in the frame of this name. The header says where they come from, in formats that have room
/// for it.
pub fn file(
    kind: FileKind,
    trajectory: &Trajectory,
    header: &str,
    frame_id: &str,
) -> Result<Vec<u8>, Unwritable> {
    Ok(match kind {
        FileKind::Tum => tum(trajectory, header).into_bytes(),
        FileKind::Csv => csv(trajectory).into_bytes(),
        FileKind::Ply => {
            let point = |pose: &Pose| {
                let PoseSigma { position_m, orientation_rad } = pose.sigma();
                PlyPoint {
                    time_s: pose.time_s,
                    position_m: pose.position_m,
                    sigma_m: position_m,
                    turn_sigma_rad: Some(orientation_rad),
                }
            };
            let points: Vec<PlyPoint> = trajectory.poses.iter().map(point).collect();
            ply::ply(&points, header).into_bytes()
        }
        FileKind::Mcap => mcap_bag::mcap(&trajectory.poses, frame_id)?,
        FileKind::Ros1Bag => ros1_bag::ros1_bag(&trajectory.poses, frame_id),
    })
}

/// The same of the positions of one prism.
pub fn prism_file(
    kind: FileKind,
    positions: &[Instant<3>],
    header: &str,
) -> Result<Vec<u8>, Unwritable> {
    match kind {
        FileKind::Tum => Ok(prism_tum(positions, header).into_bytes()),
        FileKind::Csv => Ok(prism_csv(positions).into_bytes()),
        FileKind::Ply => {
            let point = |at: &Instant<3>| PlyPoint {
                time_s: at.time_s,
                position_m: at.position_m,
                sigma_m: (at.position_covariance.trace() / 3.0).max(0.0).sqrt(),
                turn_sigma_rad: None,
            };
            let points: Vec<PlyPoint> = positions.iter().map(point).collect();
            Ok(ply::ply(&points, header).into_bytes())
        }
        FileKind::Mcap | FileKind::Ros1Bag => Err(Unwritable::NoOrientation),
    }
}

/// `timestamp tx ty tz qx qy qz qw`, one pose a line: the format of the TUM RGB-D benchmark. The header says where the
/// poses come from.
pub fn tum(trajectory: &Trajectory, header: &str) -> String {
    let mut text = format!("# {header}\n# timestamp tx ty tz qx qy qz qw\n");
    for pose in &trajectory.poses {
        let (t, q) = (&pose.position_m, pose.orientation.quaternion());
        _ = writeln!(
            text,
            "{:.6} {:.9} {:.9} {:.9} {:.9} {:.9} {:.9} {:.9}",
            pose.time_s, t.x, t.y, t.z, q.i, q.j, q.k, q.w
        );
    }
    text
}

/// Poses with the largest inter-prism error, six standard deviations and the upper triangle of the covariance of
/// (position, rotation vector in station 1's frame); where the motion is known, velocity and angular rate with theirs.
pub fn csv(trajectory: &Trajectory) -> String {
    const PARTS: [&str; 6] = ["x", "y", "z", "rx", "ry", "rz"];
    const MOVING: [&str; 6] =
        ["vx_m_per_s", "vy_m_per_s", "vz_m_per_s", "wx_rad_per_s", "wy_rad_per_s", "wz_rad_per_s"];
    let mut header = "timestamp_s,x_m,y_m,z_m,qx,qy,qz,qw,inter_prism_error_m".to_owned();
    for (index, part) in PARTS.iter().enumerate() {
        header += &format!(",sigma_{part}_{}", if index < 3 { "m" } else { "rad" });
    }
    for row in 0..6 {
        for column in row..6 {
            header += &format!(",cov_{}_{}", PARTS[row], PARTS[column]);
        }
    }
    let moving = trajectory.poses.iter().all(|pose| pose.twist.is_some());
    if moving {
        header += &format!(",{}", MOVING.join(","));
        for part in MOVING {
            header += &format!(",sigma_{part}");
        }
    }
    let mut text = header + "\n";
    for pose in &trajectory.poses {
        let (t, q) = (&pose.position_m, pose.orientation.quaternion());
        _ = write!(
            text,
            "{:.6},{:.6},{:.6},{:.6},{:.9},{:.9},{:.9},{:.9},{:.6}",
            pose.time_s, t.x, t.y, t.z, q.i, q.j, q.k, q.w, pose.inter_prism_error_m
        );
        for index in 0..6 {
            _ = write!(text, ",{:.7}", pose.covariance[(index, index)].max(0.0).sqrt());
        }
        for row in 0..6 {
            for column in row..6 {
                _ = write!(text, ",{:.6e}", pose.covariance[(row, column)]);
            }
        }
        if let Some(twist) = pose.twist.as_ref().filter(|_| moving) {
            for value in twist.velocity_m_per_s.iter().chain(&twist.rate_rad_per_s) {
                _ = write!(text, ",{value:.6}");
            }
            for index in 0..6 {
                _ = write!(text, ",{:.7}", twist.covariance[(index, index)].max(0.0).sqrt());
            }
        }
        text.push('\n');
    }
    text
}

/// Positions of one prism as TUM. It has no orientation, for which the format has no room: 0 0 0 1 stands there.
pub fn prism_tum(positions: &[Instant<3>], header: &str) -> String {
    let mut text = format!(
        "# {header}; positions of one prism, no orientation\n# timestamp tx ty tz qx qy qz qw\n"
    );
    for at in positions {
        let t = &at.position_m;
        _ = writeln!(text, "{:.6} {:.6} {:.6} {:.6} 0 0 0 1", at.time_s, t.x, t.y, t.z);
    }
    text
}

/// Positions and velocities of one prism, with their standard deviations and the upper triangle of the position's covariance.
pub fn prism_csv(positions: &[Instant<3>]) -> String {
    const AXES: [&str; 3] = ["x", "y", "z"];
    let mut text = "timestamp_s,x_m,y_m,z_m,vx_m_per_s,vy_m_per_s,vz_m_per_s".to_owned();
    AXES.iter().for_each(|axis| text += &format!(",sigma_{axis}_m"));
    AXES.iter().for_each(|axis| text += &format!(",sigma_v{axis}_m_per_s"));
    for row in 0..3 {
        AXES[row..].iter().for_each(|column| text += &format!(",cov_{}_{column}", AXES[row]));
    }
    text.push('\n');
    for at in positions {
        _ = write!(text, "{:.6}", at.time_s);
        for value in at.position_m.iter().chain(&at.velocity_m_per_s) {
            _ = write!(text, ",{value:.6}");
        }
        for covariance in [&at.position_covariance, &at.velocity_covariance] {
            for axis in 0..3 {
                _ = write!(text, ",{:.7}", covariance[(axis, axis)].max(0.0).sqrt());
            }
        }
        for row in 0..3 {
            for column in row..3 {
                _ = write!(text, ",{:.6e}", at.position_covariance[(row, column)]);
            }
        }
        text.push('\n');
    }
    text
}
