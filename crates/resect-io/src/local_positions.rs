//! Positions of a GNSS receiver in metres about the first, for the comparison of trajectories.
//!
//! East, north and up are those at the first position that is used. Earth-centred coordinates are rotated, not projected, so lengths keep
//! their scale. Covariances along east, north and up of each position are taken as those of the first: over 10 km, the axes turn by 1.6 mrad.
//!
//! Heights may be above the ellipsoid or the sea, since a constant offset has no effect on an aligned trajectory.

use nalgebra::Vector3;

use crate::error::OpenError;
use crate::findings::gnss::{
    gnss_not_fixed, gnss_positions_local, gnss_solutions_left_out, gnss_solutions_mixed,
    gnss_without_solution,
};
use crate::findings::trajectories::estimate_positions_rounded;
use crate::gnss_solution::{
    GnssSolution, GnssTrack, SolutionChoice, SolutionKind, SolutionPosition,
};
use crate::rounding::rounded_axis;
use resect_core::deployment::{EstimatedPose, Finding, PoseCovariance};
use resect_core::geometry::Geodetic;

/// Mean radius of the Earth (m), which converts steps of rounded degrees to metres.
const EARTH_RADIUS_M: f64 = 6.371e6;

/// Positions with their covariances, and findings about them.
pub struct LocalPositions {
    pub poses: Vec<(EstimatedPose, Option<PoseCovariance>)>,
    /// Position on the Earth from which they count; `None` if they are relative to a base station.
    pub origin: Option<Geodetic>,
    pub findings: Vec<Finding>,
}

/// Converts the solutions of a receiver that are wanted; `None` wants all, as for an estimate. They count from `common_origin`, otherwise from the first.
///
/// # Errors
/// If no solution has a position, or if some are relative to a base station and others to the Earth.
pub fn local_positions(
    file: &str,
    mut track: GnssTrack,
    choice: Option<SolutionChoice>,
    common_origin: Option<Geodetic>,
) -> Result<LocalPositions, OpenError> {
    let mut findings = std::mem::take(&mut track.findings);
    let records = track.solutions.len() + track.without_fix;
    if track.solutions.is_empty() {
        let what = format!("none of {records} records has a GNSS solution");
        return Err(OpenError::file(file, what, "record or compute the positions again"));
    }
    if track.without_fix > 0 {
        findings.push(gnss_without_solution(file, track.without_fix, records));
    }
    let counts = track.choose(choice.unwrap_or(SolutionChoice::All));
    findings.extend(kind_findings(file, &counts, choice.is_some()));
    let covariance = |solution: &GnssSolution| {
        let position_m2 = solution.covariance_m2?;
        Some(PoseCovariance { position_m2, ..PoseCovariance::of_position(&Vector3::zeros()) })
    };
    let first = first_position(file, &track.solutions)?;
    let origin = first.map(|first| common_origin.unwrap_or(first));
    let positions_m = match origin {
        None => track.solutions.iter().map(|solution| solution.position.cartesian_m()).collect(),
        Some(origin) => {
            if common_origin.is_none() {
                findings.push(gnss_positions_local(file, &origin));
            }
            let rounded = rounded_axis(&on_a_sphere_m(&track.solutions, &origin));
            findings.extend(rounded.map(|(axis, step_m)| {
                estimate_positions_rounded(file, ["east", "north", "up"][axis], step_m)
            }));
            about_m(&track.solutions, origin)
        }
    };
    let poses = track.solutions.iter().zip(positions_m).map(|(solution, position_m)| {
        let pose = EstimatedPose { time_s: solution.time_s, position_m, orientation: None };
        (pose, covariance(solution))
    });
    Ok(LocalPositions { poses: poses.collect(), origin, findings })
}

/// Findings about the kinds of solutions, of a ground truth or of an estimate.
fn kind_findings(
    file: &str,
    counts: &[(usize, SolutionKind, bool)],
    is_truth: bool,
) -> Vec<Finding> {
    let mut findings = Vec::new();
    let (used, left_out): (Vec<_>, Vec<_>) = counts.iter().partition(|(_, _, is_used)| *is_used);
    let counted = |counts: &[&(usize, SolutionKind, bool)]| -> Vec<(usize, SolutionKind)> {
        counts.iter().map(|(count, kind, _)| (*count, *kind)).collect()
    };
    let (used, left_out) = (counted(&used), counted(&left_out));
    if !left_out.is_empty() {
        let kinds: Vec<SolutionKind> = used.iter().map(|(_, kind)| *kind).collect();
        let count = used.iter().map(|(count, _)| count).sum();
        findings.push(gnss_solutions_left_out(file, (count, &kinds), &left_out));
    } else if used.len() > 1 {
        findings.push(gnss_solutions_mixed(file, &used));
    }
    if let Some((_, best)) = used.first().filter(|(_, best)| is_truth && best.is_coarse()) {
        findings.push(gnss_not_fixed(file, *best));
    }
    findings
}

/// Returns the first position; `None` if the positions are relative to a base station.
fn first_position(file: &str, solutions: &[GnssSolution]) -> Result<Option<Geodetic>, OpenError> {
    let is_local =
        |solution: &GnssSolution| matches!(solution.position, SolutionPosition::Baseline(_));
    match solutions.iter().filter(|solution| is_local(solution)).count() {
        count if count == solutions.len() => Ok(None),
        0 => Ok(Some(match solutions[0].position {
            SolutionPosition::Geodetic(geodetic) => geodetic,
            other => Geodetic::from_ecef(other.cartesian_m()),
        })),
        count => {
            let what = format!(
                "{count} of {} positions are relative to a base station, the others to the Earth",
                solutions.len()
            );
            Err(OpenError::file(file, what, "export all with the same setting"))
        }
    }
}

/// Positions east, north and up of the origin (m).
fn about_m(solutions: &[GnssSolution], origin: Geodetic) -> Vec<Vector3<f64>> {
    let (centre_m, local_from_ecef) = (origin.to_ecef(), origin.ecef_from_local().transpose());
    let local_m =
        |solution: &GnssSolution| local_from_ecef * (solution.position.cartesian_m() - centre_m);
    solutions.iter().map(local_m).collect()
}

/// Longitude, latitude and height in metres on a sphere, whose steps are those of the digits in the file. Empty for Cartesian coordinates.
fn on_a_sphere_m(solutions: &[GnssSolution], origin: &Geodetic) -> Vec<Vector3<f64>> {
    let scale_m = [EARTH_RADIUS_M * origin.latitude_rad.cos(), EARTH_RADIUS_M];
    let position = |solution: &GnssSolution| match solution.position {
        SolutionPosition::Geodetic(geodetic) => Some(Vector3::new(
            geodetic.longitude_rad * scale_m[0],
            geodetic.latitude_rad * scale_m[1],
            geodetic.height_m,
        )),
        SolutionPosition::Ecef(_) | SolutionPosition::Baseline(_) => None,
    };
    solutions.iter().map(position).collect::<Option<_>>().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gnss_solution::geodetic_of_degrees;
    use nalgebra::Matrix3;

    fn solution(time_s: f64, degrees: [f64; 2], kind: SolutionKind) -> GnssSolution {
        let geodetic = geodetic_of_degrees(degrees[0], degrees[1], 95.0).expect("on the Earth");
        let position = SolutionPosition::Geodetic(geodetic);
        let covariance_m2 = Some(Matrix3::from_diagonal_element(1e-4));
        GnssSolution { time_s, position, kind, covariance_m2 }
    }

    fn track(solutions: Vec<GnssSolution>) -> GnssTrack {
        GnssTrack { solutions, ..GnssTrack::default() }
    }

    #[test]
    fn metres_are_east_and_north_of_the_first_position() {
        let solutions = [[46.0, -71.0], [46.001, -71.0], [46.0, -70.999]]
            .map(|degrees| solution(0.0, degrees, SolutionKind::Fixed));
        let LocalPositions { poses, findings, .. } =
            local_positions("rover.pos", track(solutions.to_vec()), None, None).expect("positions");
        let positions_m: Vec<_> = poses.iter().map(|(pose, _)| pose.position_m).collect();
        assert_eq!(positions_m[0], Vector3::zeros());
        // Lengths of a thousandth of a degree at 46°, from the radii of curvature of WGS84.
        assert!(
            (positions_m[1] - Vector3::new(0.0, 111.150, 0.0)).norm() < 0.01,
            "{positions_m:?}"
        );
        assert!((positions_m[2] - Vector3::new(77.466, 0.0, 0.0)).norm() < 0.01, "{positions_m:?}");
        assert!(poses.iter().all(|(_, covariance)| covariance.is_some()));
        let said: Vec<_> = findings.iter().map(ToString::to_string).collect();
        assert!(said[0].contains("latitude 46.00000000°, longitude -71.00000000°"), "{said:?}");
    }

    #[test]
    fn only_the_most_accurate_kind_is_a_ground_truth_and_the_others_are_counted() {
        use SolutionKind::{Fixed, Float, Single};
        let kinds = [Float, Fixed, Fixed, Single];
        let solutions: Vec<_> = kinds
            .iter()
            .enumerate()
            .map(|(index, kind)| solution(index as f64, [46.0, -71.0], *kind))
            .collect();
        let read = |choice| {
            let LocalPositions { poses, findings, .. } =
                local_positions("rover.pos", track(solutions.clone()), choice, None)
                    .expect("positions");
            let said = findings.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n");
            (poses.len(), said)
        };
        let (count, said) = read(Some(SolutionChoice::Best));
        assert_eq!(count, 2);
        assert!(
            said.contains("2 fixed solutions are the ground truth; 1 float, 1 single"),
            "{said}"
        );
        let (count, said) = read(Some(SolutionChoice::Float));
        assert_eq!(count, 3);
        assert!(said.contains("3 fixed and float solutions"), "{said}");
        for choice in [Some(SolutionChoice::All), None] {
            let (count, said) = read(choice);
            assert_eq!(count, 4);
            assert!(said.contains("all solutions are used: 2 fixed, 1 float, 1 single"), "{said}");
        }
        let LocalPositions { findings, .. } = local_positions(
            "rover.pos",
            track(vec![solutions[0].clone()]),
            Some(SolutionChoice::Best),
            None,
        )
        .expect("positions");
        let said = findings[0].to_string();
        assert!(said.contains("no solution is fixed, the best are float"), "{said}");
    }

    #[test]
    fn degrees_with_few_digits_are_rounded_positions() {
        let solutions: Vec<_> = (0..200)
            .map(|index| {
                let degrees =
                    (46.0 + f64::from(index / 10) * 1e-6, -71.0 + f64::from(index) * 1e-7);
                solution(f64::from(index), [degrees.0, degrees.1], SolutionKind::Fixed)
            })
            .collect();
        let LocalPositions { findings, .. } =
            local_positions("rover.pos", track(solutions), None, None).expect("positions");
        let said: Vec<_> = findings.iter().map(ToString::to_string).collect();
        assert!(said.iter().any(|said| said.contains("rounded to 0.11 m in north")), "{said:?}");
    }

    #[test]
    fn positions_about_a_base_and_about_the_earth_do_not_mix() {
        let mut solutions = vec![solution(0.0, [46.0, -71.0], SolutionKind::Fixed)];
        solutions.push(GnssSolution {
            position: SolutionPosition::Baseline(Vector3::new(1.0, 2.0, 3.0)),
            ..solutions[0].clone()
        });
        let read = |solutions| local_positions("rover.pos", track(solutions), None, None);
        let why = read(solutions.clone()).err().expect("mixed").to_string();
        assert!(why.contains("1 of 2 positions are relative to a base station"), "{why}");
        let local = read(solutions.split_off(1)).expect("positions");
        assert_eq!(local.poses[0].0.position_m, Vector3::new(1.0, 2.0, 3.0));
        let empty = GnssTrack { without_fix: 7, ..GnssTrack::default() };
        let why = local_positions("rover.pos", empty, None, None).err().expect("none").to_string();
        assert!(why.contains("none of 7 records has a GNSS solution"), "{why}");
    }
}
