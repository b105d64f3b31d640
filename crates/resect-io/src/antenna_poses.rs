//! Poses of a body from the positions of three or more GNSS antennas on it.
//!
//! Antennas are prisms of a rig: an epoch at which all have a position is a pose. Three antennas need no positions in the body: their distances
//! are medians of the epochs. The body's frame is then that of the antennas: the origin at the first, x towards the second.

use std::path::{Path, PathBuf};

use nalgebra::{Matrix3, Vector3};

use crate::error::OpenError;
use crate::estimate_file::{gnss_track_of_file, put_in_order};
use crate::findings::gnss::{antenna_epochs_left_out, antenna_poses, antennas_without_sigma};
use crate::gnss_solution::SolutionChoice;
use crate::local_positions::local_positions;
use resect_core::deployment::{EstimatedPose, EstimatedTrajectory, Finding, PoseCovariance};
use resect_core::evaluation::trajectory::{ObservedRig, align_rig, rig_from_distances};
use resect_core::network::MOST_STATIONS;
use resect_core::statistics::median;

/// Largest difference of stamps within one epoch (s). Receivers measure on the seconds of GPS, with far smaller differences.
const SAME_EPOCH_S: f64 = 0.005;
/// Largest difference of an apparent distance between antennas from the known one (m); epochs beyond it are no poses. Textbook: a wrong ambiguity
/// is a multiple of the wavelength of L1, 0.19 m; fixed solutions differ by centimetres.
const LARGEST_DISTANCE_ERROR_M: f64 = 0.1;
/// Standard deviation of positions that state none (m). It sets only the weights, since all are equal; no covariance is returned.
const EQUAL_SIGMA_M: f64 = 0.01;
/// Fewest antennas that determine a rotation.
const FEWEST_ANTENNAS: usize = 3;

/// The antennas at one epoch.
struct AntennaEpoch {
    time_s: f64,
    points_m: Vec<Vector3<f64>>,
    /// Covariance of each; `None` if any position states none.
    covariances_m2: Option<Vec<Matrix3<f64>>>,
}

/// Reads the solutions of the antennas of one body, in the order of their positions in the body (m; empty if unknown).
///
/// # Errors
/// If a file is not a GNSS solution, if there are fewer than three antennas, or if no epoch is a pose.
pub fn read_antennas(
    paths: &[PathBuf],
    positions_m: &[Vector3<f64>],
    solutions: SolutionChoice,
) -> Result<EstimatedTrajectory, OpenError> {
    let file = paths.first().map(|path| path.display().to_string()).unwrap_or_default();
    let fault = |what: String, remedy: &str| OpenError::file(&file, what, remedy);
    if !(FEWEST_ANTENNAS..=MOST_STATIONS).contains(&paths.len()) {
        let what = format!("the number of antennas is {}, which gives no poses", paths.len());
        return Err(fault(
            what,
            &format!("name the files of 3 to {MOST_STATIONS} antennas of one body"),
        ));
    }
    if !positions_m.is_empty() && positions_m.len() != paths.len() {
        let what = format!("{} positions of antennas for {} files", positions_m.len(), paths.len());
        return Err(fault(what, "give --antenna once for each file, in their order"));
    }
    let (mut tracks, mut findings, mut origin) = (Vec::new(), Vec::new(), None);
    for path in paths {
        let track = gnss_track_of_file(path)?;
        let name = path.display().to_string();
        let local = local_positions(&name, track, Some(solutions), origin)?;
        origin = origin.or(local.origin);
        let track = put_in_order((name, None), path, local.poses, local.findings)?;
        findings.extend(track.findings.iter().cloned());
        tracks.push(track);
    }
    let (epochs, unmatched) = common_epochs(&tracks);
    let rig_m = match positions_m {
        [] => rig_of_medians(&epochs).ok_or_else(|| {
            let what = format!(
                "{} common epochs of {} antennas do not give their distances",
                epochs.len(),
                paths.len()
            );
            fault(what, "give the position of each antenna in the body (--antenna X,Y,Z)")
        })?,
        positions_m => positions_m.to_vec(),
    };
    let (poses, contradicting) = poses_of(&epochs, &rig_m);
    if poses.is_empty() {
        let what = format!("no pose of {} common epochs of the antennas", epochs.len());
        return Err(fault(
            what,
            "check the order of the files, and that the antennas are not on a line",
        ));
    }
    findings.push(antenna_poses(&rig_m, positions_m.is_empty()));
    if unmatched + contradicting > 0 {
        findings.push(antenna_epochs_left_out(unmatched, contradicting, LARGEST_DISTANCE_ERROR_M));
    }
    if poses.iter().any(|(_, covariance)| covariance.is_none()) {
        findings.push(antennas_without_sigma());
    }
    named(&paths[0], paths.len(), poses, findings)
}

fn named(
    first: &Path,
    antennas: usize,
    poses: Vec<(EstimatedPose, Option<PoseCovariance>)>,
    findings: Vec<Finding>,
) -> Result<EstimatedTrajectory, OpenError> {
    let stem = first.file_stem().unwrap_or_default().to_string_lossy();
    let name = format!("{stem} and {} antennas", antennas - 1);
    put_in_order((name, None), first, poses, findings)
}

/// Returns the epochs at which all antennas have a position, and the number of positions at other times.
fn common_epochs(tracks: &[EstimatedTrajectory]) -> (Vec<AntennaEpoch>, usize) {
    let (mut epochs, mut unmatched) = (Vec::new(), 0);
    let mut next = vec![0; tracks.len()];
    let has_sigma = tracks.iter().all(|track| !track.covariances.is_empty());
    loop {
        let current = tracks.iter().zip(&next).map(|(track, index)| track.poses.get(*index));
        let Some(current) = current.collect::<Option<Vec<&EstimatedPose>>>() else { break };
        let newest_s = current.iter().map(|pose| pose.time_s).fold(f64::NEG_INFINITY, f64::max);
        let is_late = |pose: &&EstimatedPose| newest_s - pose.time_s > SAME_EPOCH_S;
        let late: Vec<bool> = current.iter().map(is_late).collect();
        if late.contains(&true) {
            for (index, _) in next.iter_mut().zip(&late).filter(|(_, is_late)| **is_late) {
                *index += 1;
                unmatched += 1;
            }
            continue;
        }
        let covariances = tracks.iter().zip(&next);
        let covariances_m2 = has_sigma.then(|| {
            covariances.map(|(track, index)| track.covariances[*index].position_m2).collect()
        });
        let points_m = current.iter().map(|pose| pose.position_m).collect();
        epochs.push(AntennaEpoch { time_s: newest_s, points_m, covariances_m2 });
        next.iter_mut().for_each(|index| *index += 1);
    }
    unmatched +=
        tracks.iter().zip(&next).map(|(track, index)| track.poses.len() - index).sum::<usize>();
    (epochs, unmatched)
}

/// Returns three antennas in their own frame by the medians of their distances; `None` for other numbers, or if they are on a line.
fn rig_of_medians(epochs: &[AntennaEpoch]) -> Option<Vec<Vector3<f64>>> {
    if epochs.first()?.points_m.len() != FEWEST_ANTENNAS {
        return None;
    }
    let distance_m = |a: usize, b: usize| {
        median(epochs.iter().map(move |epoch| (epoch.points_m[a] - epoch.points_m[b]).norm()))
    };
    let distances_m = [distance_m(0, 1)?, distance_m(0, 2)?, distance_m(1, 2)?];
    rig_from_distances(&distances_m).map(Vec::from)
}

/// Returns the poses of the epochs, and the number of those that contradict the distances of the antennas.
fn poses_of(
    epochs: &[AntennaEpoch],
    rig_m: &[Vector3<f64>],
) -> (Vec<(EstimatedPose, Option<PoseCovariance>)>, usize) {
    let (mut poses, mut contradicting) = (Vec::new(), 0);
    for epoch in epochs {
        let sigmas_m: Vec<Vector3<f64>> = match &epoch.covariances_m2 {
            Some(covariances_m2) => {
                covariances_m2.iter().map(|matrix| matrix.diagonal().map(f64::sqrt)).collect()
            }
            None => vec![Vector3::repeat(EQUAL_SIGMA_M); epoch.points_m.len()],
        };
        let observed = ObservedRig {
            time_s: epoch.time_s,
            points_m: epoch.points_m.iter().copied().collect(),
            sigma_m: sigmas_m.into_iter().collect(),
        };
        let pose = align_rig(rig_m, &observed);
        let pose = pose.filter(|pose| pose.inter_prism_error_m <= LARGEST_DISTANCE_ERROR_M);
        let Some(pose) = pose else {
            contradicting += 1;
            continue;
        };
        let block = |row, column| pose.covariance.fixed_view::<3, 3>(row, column).into_owned();
        let covariance = epoch.covariances_m2.is_some().then(|| PoseCovariance {
            position_m2: block(0, 0),
            rotation_rad2: Some(block(3, 3)),
            rotation_with_position: block(3, 0),
        });
        let (time_s, position_m) = (pose.time_s, pose.position_m);
        poses.push((
            EstimatedPose { time_s, position_m, orientation: Some(pose.orientation) },
            covariance,
        ));
    }
    (poses, contradicting)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::UnitQuaternion;

    const RIG_M: [[f64; 3]; 3] = [[0.5, 0.2, 0.8], [-0.5, 0.3, 0.9], [0.0, -0.6, 0.7]];

    /// Writes baselines of antennas on a body that turns; returns their files.
    fn written(folder: &Path, change: impl Fn(usize, usize) -> (u8, f64)) -> Vec<PathBuf> {
        let mut paths = Vec::new();
        for (antenna, arm_m) in RIG_M.into_iter().enumerate() {
            let mut text = String::from(
                "% UTC e-baseline(m) n-baseline(m) u-baseline(m) Q ns sde(m) sdn(m) sdu(m) sden(m) sdnu(m) sdue(m)\n",
            );
            for epoch in 0..20 {
                let (quality, error_m) = change(antenna, epoch);
                let (orientation, position_m) = body(epoch);
                let antenna_m = position_m + orientation * Vector3::from(arm_m);
                text += &format!(
                    "2022/07/11 19:50:{epoch:02}.000 {:.9} {:.9} {:.9} {quality} 9 0.01 0.01 0.02 0 0 0\n",
                    antenna_m.x,
                    antenna_m.y,
                    antenna_m.z + error_m
                );
            }
            let path = folder.join(format!("antenna{antenna}.pos"));
            std::fs::write(&path, text).expect("written");
            paths.push(path);
        }
        paths
    }

    fn body(epoch: usize) -> (UnitQuaternion<f64>, Vector3<f64>) {
        let turn = 0.1 * epoch as f64;
        (UnitQuaternion::from_euler_angles(0.05, -0.02, turn), Vector3::new(turn, 2.0 * turn, 0.3))
    }

    #[test]
    fn three_antennas_give_poses_with_covariance() {
        let folder = tempfile::tempdir().expect("a folder");
        // One float solution, and one with a wrong ambiguity.
        let paths = written(folder.path(), |antenna, epoch| match (antenna, epoch) {
            (1, 4) => (2, 0.0),
            (2, 7) => (1, 1.2),
            _ => (1, 0.0),
        });
        let rig_m = RIG_M.map(Vector3::from);
        let truth = read_antennas(&paths, &rig_m, SolutionChoice::Best).expect("poses");
        assert_eq!((truth.poses.len(), truth.covariances.len()), (18, 18));
        for pose in &truth.poses {
            let epoch = (pose.time_s - 1_657_569_000.0).round() as usize;
            let (orientation, position_m) = body(epoch);
            assert!((pose.position_m - position_m).norm() < 1e-6, "{pose:?}");
            let turned = pose.orientation.expect("an orientation");
            assert!(turned.angle_to(&orientation) < 1e-6, "{pose:?}");
        }
        let sigma_rad = truth.covariances[0].rotation_rad2.expect("known")[(2, 2)].sqrt();
        assert!((0.005..0.03).contains(&sigma_rad), "{sigma_rad}");
        let said: Vec<_> = truth.findings.iter().map(ToString::to_string).collect();
        let said = said.join("\n");
        assert!(
            said.contains("2 positions without those of the other antennas, 1 epochs"),
            "{said}"
        );
        // Without positions, the frame is that of the antennas.
        let medians = read_antennas(&paths, &[], SolutionChoice::Best).expect("poses");
        let between = |truth: &EstimatedTrajectory| {
            let [first, last] = [0, 17].map(|index| truth.poses[index].orientation.expect("known"));
            first.angle_to(&last)
        };
        assert!((between(&medians) - between(&truth)).abs() < 1e-6);
    }

    #[test]
    fn too_few_antennas_and_positions_on_a_line_are_refused() {
        let folder = tempfile::tempdir().expect("a folder");
        let paths = written(folder.path(), |_, _| (1, 0.0));
        let line = [0.0, 1.0, 2.0].map(|x| Vector3::new(x, 0.0, 0.0));
        for (paths, positions_m, why) in [
            (&paths[..2], &[][..], "the number of antennas is 2"),
            (&paths, &line[..2], "2 positions of antennas for 3 files"),
            (&paths, &line, "no pose of 20 common epochs"),
        ] {
            let error = read_antennas(paths, positions_m, SolutionChoice::Best).expect_err(why);
            assert!(error.to_string().contains(why), "{error}");
        }
        let other = folder.path().join("slam.tum");
        std::fs::write(&other, "1 2 3 4 0 0 0 1\n").expect("written");
        let files = [paths[0].clone(), paths[1].clone(), other];
        let error = read_antennas(&files, &[], SolutionChoice::Best).expect_err("a pose");
        assert!(error.to_string().contains("slam.tum: not a GNSS solution"), "{error}");
    }
}
