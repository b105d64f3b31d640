//! A trajectory as a point cloud (PLY) for CloudCompare, MeshLab and others. CloudCompare reads `scalar_` properties
//! as scalar fields.

use std::fmt::Write;

use nalgebra::Vector3;

/// A position with time and σ, and σ of the orientation if known.
pub struct PlyPoint {
    pub time_s: f64,
    pub position_m: Vector3<f64>,
    pub sigma_m: f64,
    pub turn_sigma_rad: Option<f64>,
}

/// Formats points with times from the first one: scalar fields have single precision, too coarse for seconds of Unix time.
pub fn ply(points: &[PlyPoint], comment: &str) -> String {
    let turns = points.iter().all(|point| point.turn_sigma_rad.is_some());
    let start_s = points.first().map_or(0.0, |point| point.time_s);
    // A line break in a name would end the comment.
    let comment = comment.replace(['\n', '\r'], " ");
    let mut text = format!(
        "ply\nformat ascii 1.0\ncomment {comment}\ncomment scalar_time_s counts from {start_s:.6} s\nelement vertex {}\n\
         property double x\nproperty double y\nproperty double z\nproperty float scalar_time_s\n\
         property float scalar_sigma_mm\n",
        points.len()
    );
    if turns {
        text += "property float scalar_sigma_mrad\n";
    }
    text += "end_header\n";
    for point in points {
        let at = &point.position_m;
        let since_s = point.time_s - start_s;
        let sigma_mm = 1e3 * point.sigma_m;
        _ = write!(text, "{:.6} {:.6} {:.6} {since_s:.4} {sigma_mm:.4}", at.x, at.y, at.z);
        if let Some(turn_sigma_rad) = point.turn_sigma_rad.filter(|_| turns) {
            _ = write!(text, " {:.5}", 1e3 * turn_sigma_rad);
        }
        text.push('\n');
    }
    text
}
