//! Content of a trajectory file, by its format.

use std::fmt::Write;
use std::path::Path;

use super::ply::{self, PlyPoint};
use super::{mcap_bag, ros1_bag};

use resect_core::calibration::joint::prism_motion::PrismInstant;
use resect_core::deployment::{EstimatedPose, EstimatedTrajectory};
use resect_core::evaluation::trajectory::{Pose, PoseSigma, Trajectory};

/// Format of a trajectory file, by the extension of its name.
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
    /// Returns the format for the extension of a file. TUM has no extension of its own: none, `tum` and `txt` select it.
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

/// Reason why a trajectory cannot be written in a format.
#[derive(Debug, thiserror::Error)]
pub enum Unwritable {
    #[error("unknown trajectory format .{0}; write .tum, .txt, .csv, .ply, .mcap or .bag")]
    UnknownEnding(String),
    #[error(
        "odometry messages need an orientation, which one prism does not give; write .tum, .csv or .ply"
    )]
    NoOrientation,
    #[error("the MCAP file could not be written: {0}; write .bag or .csv")]
    Mcap(#[from] ::mcap::McapError),
}

/// Frame of poses that were not transformed, as messages name it.
pub const STATION1: &str = "station1";

/// Returns the content of a file of poses in the frame `frame_id`. The header names their origin, in formats that have room for it.
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

/// Returns the content of a file of the positions of one prism.
pub fn prism_file(
    kind: FileKind,
    positions: &[PrismInstant],
    header: &str,
) -> Result<Vec<u8>, Unwritable> {
    match kind {
        FileKind::Tum => Ok(prism_tum(positions, header).into_bytes()),
        FileKind::Csv => Ok(prism_csv(positions).into_bytes()),
        FileKind::Ply => {
            let point = |at: &PrismInstant| PlyPoint {
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

/// Formats poses as `timestamp tx ty tz qx qy qz qw`, one a line, as in the TUM RGB-D benchmark. The header names their origin.
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

/// Formats poses with the largest inter-prism error, six standard deviations and the upper triangle of the covariance of
/// (position, rotation vector in station 1's frame). If the motion is known, velocity and angular rate with theirs follow.
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

/// Formats positions of one prism as TUM, with 0 0 0 1 in place of the unknown orientation.
pub fn prism_tum(positions: &[PrismInstant], header: &str) -> String {
    let mut text = format!(
        "# {header}; positions of one prism, no orientation\n# timestamp tx ty tz qx qy qz qw\n"
    );
    for at in positions {
        let t = &at.position_m;
        _ = writeln!(text, "{:.6} {:.6} {:.6} {:.6} 0 0 0 1", at.time_s, t.x, t.y, t.z);
    }
    text
}

/// Returns the content of a file of one station's positions.
pub fn station_file(
    kind: FileKind,
    track: &EstimatedTrajectory,
    header: &str,
) -> Result<Vec<u8>, Unwritable> {
    match kind {
        FileKind::Tum => Ok(station_tum(track, header).into_bytes()),
        FileKind::Csv => Ok(station_csv(track).into_bytes()),
        FileKind::Ply => {
            let each = track.poses.iter().zip(&track.covariances);
            let points: Vec<PlyPoint> = each
                .map(|(pose, covariance)| PlyPoint {
                    time_s: pose.time_s,
                    position_m: pose.position_m,
                    sigma_m: (covariance.position_m2.trace() / 3.0).max(0.0).sqrt(),
                    turn_sigma_rad: None,
                })
                .collect();
            Ok(ply::ply(&points, header).into_bytes())
        }
        FileKind::Mcap | FileKind::Ros1Bag => Err(Unwritable::NoOrientation),
    }
}

/// Formats positions of one station as TUM, with 0 0 0 1 in place of the unknown orientation.
pub fn station_tum(track: &EstimatedTrajectory, header: &str) -> String {
    let mut text = format!("# {header}, no orientation\n# timestamp tx ty tz qx qy qz qw\n");
    for EstimatedPose { time_s, position_m: t, .. } in &track.poses {
        _ = writeln!(text, "{time_s:.6} {:.6} {:.6} {:.6} 0 0 0 1", t.x, t.y, t.z);
    }
    text
}

/// Formats positions of one station with standard deviations and the upper triangle of the covariance.
fn station_csv(track: &EstimatedTrajectory) -> String {
    const AXES: [&str; 3] = ["x", "y", "z"];
    let mut text = "timestamp_s,x_m,y_m,z_m".to_owned();
    AXES.iter().for_each(|axis| text += &format!(",sigma_{axis}_m"));
    for row in 0..3 {
        AXES[row..].iter().for_each(|column| text += &format!(",cov_{}_{column}", AXES[row]));
    }
    text.push('\n');
    for (pose, covariance) in track.poses.iter().zip(&track.covariances) {
        let t = pose.position_m;
        _ = write!(text, "{:.6},{:.6},{:.6},{:.6}", pose.time_s, t.x, t.y, t.z);
        let covariance = &covariance.position_m2;
        for axis in 0..3 {
            _ = write!(text, ",{:.7}", covariance[(axis, axis)].max(0.0).sqrt());
        }
        for row in 0..3 {
            for column in row..3 {
                _ = write!(text, ",{:.6e}", covariance[(row, column)]);
            }
        }
        text.push('\n');
    }
    text
}

/// Formats positions and velocities of one prism, with standard deviations and the upper triangle of the position's covariance.
pub fn prism_csv(positions: &[PrismInstant]) -> String {
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
