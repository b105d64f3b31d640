//! Recognition of a trajectory estimated by another system; [`estimate_file`](crate::estimate_file) reads it.
//!
//! Only files with orientations are recognised: positions alone may equally be a station's track.

/// Largest difference from one of a quaternion's length, and of the lengths of a matrix's rows.
const ROUNDED: f64 = 1e-2;

/// Returns true if the first lines of a file are TUM, EuRoC, KITTI, or a table whose header names a quaternion.
pub fn looks_like(text: &str) -> bool {
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    let is_comment = |line: &&str| line.starts_with(['#', '%']);
    let first = lines.clone().next();
    let Some(data) = lines.find(|line| !is_comment(line)) else { return false };
    let numbers: Option<Vec<f64>> = fields(data).map(|field| field.parse().ok()).collect();
    match numbers {
        None => names_a_quaternion(data),
        Some(numbers) if numbers.len() == 8 => is_unit(&numbers[4..8]),
        Some(numbers) if numbers.len() == 12 => {
            [0, 4, 8].iter().all(|row| is_unit(&numbers[*row..row + 3]))
        }
        Some(numbers) => {
            numbers.len() > 8 && first.is_some_and(names_a_quaternion) && is_unit(&numbers[4..8])
        }
    }
}

fn fields(line: &str) -> impl Iterator<Item = &str> {
    line.split([',', ';', ' ', '\t']).map(str::trim).filter(|field| !field.is_empty())
}

/// Returns true for "timestamp,x,y,z,qx,qy,qz,qw", and for EuRoC's `q_RS_w []`.
fn names_a_quaternion(header: &str) -> bool {
    let names: Vec<String> =
        fields(header.trim_start_matches(['#', '%'])).map(str::to_ascii_lowercase).collect();
    ["x", "y", "z", "w"].iter().all(|axis| {
        let ends = |name: &&String| name.starts_with('q') && name.ends_with(axis);
        names.iter().any(|name| ends(&name))
    })
}

fn is_unit(numbers: &[f64]) -> bool {
    let length = numbers.iter().map(|number| number * number).sum::<f64>().sqrt();
    (length - 1.0).abs() < ROUNDED
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
