//! Recognition of a trajectory estimated by another system; [`estimate_file`](crate::estimate_file) reads it.
//!
//! Files with orientations are recognised, and positions of GNSS receivers. Other positions may equally be a station's track.

use super::{geodetic_table, motion_capture, nmea, pose_table};

/// Numbers in a line of KITTI: the first three rows of a 4×4 matrix.
pub const KITTI_FIELDS: usize = 12;
/// Largest difference from one of the length of a matrix's row.
const ROUNDED: f64 = 1e-2;

/// Returns true for the beginning of a table of poses with unit quaternions, KITTI, NMEA, motion capture, or latitudes and longitudes.
pub fn looks_like(text: &str) -> bool {
    let is_table = |layout: pose_table::PoseLayout| {
        layout.has_orientations() && layout.has_unit_quaternions(text)
    };
    is_kitti(text)
        || nmea::looks_like(text)
        || geodetic_table::looks_like(text)
        || motion_capture::looks_like(text)
        || pose_table::layout(text).is_ok_and(is_table)
}

/// Returns true if the first line of numbers is a pose of KITTI.
pub fn is_kitti(text: &str) -> bool {
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    let Some(first) = lines.find(|line| !line.starts_with(['#', '%'])) else { return false };
    let numbers: Option<Vec<f64>> =
        first.split_whitespace().map(|field| field.parse().ok()).collect();
    let Some(numbers) = numbers.filter(|numbers| numbers.len() == KITTI_FIELDS) else {
        return false;
    };
    let is_unit = |row: &[f64]| {
        let length = row[..3].iter().map(|number| number * number).sum::<f64>().sqrt();
        (length - 1.0).abs() < ROUNDED
    };
    numbers.chunks(4).all(is_unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trajectories_with_orientations_are_told_from_other_numbers() {
        for text in [
            "1760000000.1 1 2 3 0 0 0.6 0.8\n",
            "# timestamp tx ty tz qx qy qz qw\n1760000000.1 1 2 3 0 0 0 1\n",
            "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z [],v_RS_R_x [m s^-1]\n\
             1403636580838555648,4.68,-1.78,0.78,0.534108,-0.153029,-0.827383,-0.082152,0.0\n",
            "timestamp;x;y;z;qx;qy;qz;qw\n",
            "1 0 0 5 0 1 0 6 0 0 1 7\n",
            "timestamp,lat,lon,alt\n1,46.78,-71.27,95\n",
            "[log] start\n$GNGGA,195001.20,4646.9,N,07116.5,W,4,12,0.6,95.2,M,-27.5,M,,\n",
        ] {
            assert!(looks_like(text), "{text}");
        }
        for text in [
            "",
            "# only a comment\n",
            "timestamp,id,distance,ha,va\n1,1,2,3,1.5\n",
            "1657 1.0 2.0 3.0\n",
            "1 2 3 4 5 6 7 8\n",
            "1 2 3 4 5 6 7 8 9 10 11 12\n",
            "quality,x,y,z\n1,2,3,4\n",
        ] {
            assert!(!looks_like(text), "{text}");
        }
    }
}
