//! The vehicle's poses in six degrees of freedom, compared with the simulator's ground truth and by the real evo.

use std::path::Path;
use std::process::Command;

use crate::common::{analyse, answer, by, of_field, published, sample_folder};
use resect_core::calibration::Method;
use resect_core::calibration::joint::prism_motion::MotionInstant;
use resect_core::evaluation::no_trajectory::NoTrajectory;
use resect_core::evaluation::rig_layout::VehicleFrame;
use resect_core::evaluation::vehicle::{
    Instants, PoseLimits, prism_by, trajectory_by, vehicle_at, vehicle_trajectory,
};
use resect_core::geometry::RigidTransform;
use resect_core::progress::Progress;
use resect_io::open::open;
use resect_io::sample::Sample;
use resect_tools::simulation::{EPOCH_S, Preset, simulate, simulate_scenario};

const LIMIT_M: f64 = 0.020;

#[test]
fn the_poses_carry_the_prisms_to_where_they_were_seen() {
    let deployment = Sample::Warthog.open().expect("built in");
    let analysis = analyse(&deployment, &published());
    let transforms = answer(&analysis).calibration.placing_tracks(&deployment);
    let triplets = &analysis.pipeline.triplets;
    let (trajectory, frame) =
        vehicle_trajectory(&deployment, triplets, &analysis.offer.followed, transforms, LIMIT_M)
            .expect("three prisms");
    assert_eq!(frame, VehicleFrame::Reading);
    assert!(trajectory.poses.len() + trajectory.dropped == triplets.len());
    assert!(trajectory.dropped < triplets.len() / 50, "{}", trajectory.dropped);
    // The rig was level when it was measured and the ground is nearly level: so is the vehicle, most of the time.
    let mut tilts: Vec<f64> = trajectory
        .poses
        .iter()
        .map(|pose| pose.orientation.to_rotation_matrix()[(2, 2)].acos())
        .collect();
    tilts.sort_by(f64::total_cmp);
    assert!(tilts[tilts.len() / 2] < 0.1, "{}", tilts[tilts.len() / 2]);
    let sigma = trajectory.median_sigma().expect("poses");
    assert!((0.0005..0.005).contains(&sigma.position_m), "{sigma:?}");
    assert!((0.0005..0.01).contains(&sigma.orientation_rad), "{sigma:?}");
}

#[test]
fn a_tighter_limit_drops_more_and_counts_them() {
    let deployment = Sample::Warthog.open().expect("built in");
    let analysis = analyse(&deployment, &published());
    let transforms = answer(&analysis).calibration.placing_tracks(&deployment);
    let dropped = |limit_m: f64| {
        let triplets = &analysis.pipeline.triplets;
        vehicle_trajectory(&deployment, triplets, &analysis.offer.followed, transforms, limit_m)
            .expect("three prisms")
            .0
            .dropped
    };
    assert!(dropped(0.002) > dropped(0.005) && dropped(0.005) > dropped(0.020));
    assert_eq!(dropped(f64::INFINITY), 0);
}

#[test]
fn the_frame_of_deployment_toml_is_taken_over() {
    let simulated = simulate(Preset::Warthog, 4);
    let mut deployment = resect_io::simulation_files::open(&simulated).expect("valid");
    let analysis = analyse(&deployment, &published());
    deployment.rig.as_mut().expect("a rig").in_vehicle_m = Some(simulated.truth.prisms_m.clone());
    let transforms =
        simulated.truth.station1_from_station.map(|level| RigidTransform::from(*level));
    let (trajectory, frame) = vehicle_trajectory(
        &deployment,
        &analysis.pipeline.triplets,
        &analysis.offer.followed,
        Some(&transforms),
        LIMIT_M,
    )
    .expect("three prisms");
    assert_eq!(frame, VehicleFrame::Given);
    // The vehicle's origin is on the ground, 1.6 m below station 1 on average.
    let mean_z = trajectory.poses.iter().map(|p| p.position_m.z).sum::<f64>()
        / trajectory.poses.len() as f64;
    assert!((mean_z + 1.6).abs() < 0.8, "{mean_z}");
    // x points ahead: a moving vehicle moves along its own x axis.
    let mut along: Vec<f64> = trajectory
        .poses
        .windows(2)
        .filter(|pair| (pair[1].time_s - pair[0].time_s - 0.1).abs() < 1e-6)
        .map(|pair| pair[1].position_m - pair[0].position_m)
        .zip(&trajectory.poses)
        .filter(|(step, _)| step.norm() > 0.05)
        .map(|(step, pose)| {
            step.normalize().dot(&(pose.orientation * nalgebra::Vector3::x())).abs()
        })
        .collect();
    along.sort_by(f64::total_cmp);
    assert!(along[along.len() / 2] > 0.9, "{}", along[along.len() / 2]);
}

#[test]
fn one_prism_has_no_orientation() {
    let deployment =
        resect_io::simulation_files::open(&simulate(Preset::SinglePrism, 1)).expect("valid");
    let analysis = analyse(&deployment, &by(Method::DynamicGcp));
    let transforms = answer(&analysis).calibration.placing_tracks(&deployment);
    let triplets = &analysis.pipeline.triplets;
    let error =
        vehicle_trajectory(&deployment, triplets, &analysis.offer.followed, transforms, LIMIT_M)
            .expect_err("one prism");
    assert!(matches!(error, NoTrajectory::OnePrism(_)));
}

fn resect() -> Command {
    Command::new(env!("CARGO_BIN_EXE_resect"))
}

#[test]
fn a_lever_arm_gives_the_poses_of_a_sensor() {
    let z_at = |more: &[&str]| -> Vec<f64> {
        let mut command = resect();
        command.arg("trajectory").arg(sample_folder("warthog")).args(more);
        let output = command.output().expect("runs");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let text = String::from_utf8(output.stdout).expect("text");
        let poses = text.lines().filter(|line| !line.starts_with('#'));
        poses.map(|line| line.split(' ').nth(3).expect("z").parse().expect("a number")).collect()
    };
    let (vehicle, sensor) = (z_at(&[]), z_at(&["--lever-arm", "0,0,0.5"]));
    assert_eq!(vehicle.len(), sensor.len());
    for (below, above) in vehicle.iter().zip(&sensor) {
        assert!((above - below - 0.5).abs() < 0.02, "{below} {above}");
    }
    for (wrong, part) in [("1,2", "three numbers"), ("a,b,c", "three numbers")] {
        let mut command = resect();
        command.arg("trajectory").arg(sample_folder("warthog")).args(["--lever-arm", wrong]);
        let output = command.output().expect("runs");
        let why = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(2) && why.contains(part), "{why}");
    }
}

/// A drive with little noise, of which the backward pass of the covariances lost a quarter by rounding.
#[test]
#[cfg_attr(not(field_data), ignore = "needs ../shared/datasets")]
fn a_stiff_drive_has_a_pose_at_every_triplet_with_readings() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("drive.csv");
    let output = resect()
        .args(["trajectory", "--out"])
        .arg(&file)
        .arg(of_field("real/20221205-1"))
        .output()
        .expect("runs");
    let said = String::from_utf8_lossy(&output.stdout);
    let reasons = "(6 with an inter-prism error above 20 mm, 663 without a motion that the readings determine)";
    assert!(said.contains("5212 poses, 669 epochs dropped") && said.contains(reasons), "{said}");
}

#[test]
fn the_command_writes_tum_that_evo_reads() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("warthog.tum");
    let status = resect()
        .args(["trajectory"])
        .arg(sample_folder("warthog"))
        .args(["--out"])
        .arg(&file)
        .output()
        .expect("runs");
    assert!(status.status.success(), "{}", String::from_utf8_lossy(&status.stderr));
    let said = String::from_utf8_lossy(&status.stdout);
    assert!(said.contains("epochs dropped") && said.contains("typical σ"), "{said}");
    let text = std::fs::read_to_string(&file).expect("written");
    let mut last = 0.0;
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        let numbers: Vec<f64> =
            line.split(' ').map(|field| field.parse().expect("a number")).collect();
        let [time_s, _, _, _, x, y, z, w] = numbers[..] else { panic!("eight fields: {line}") };
        assert!(time_s > last);
        last = time_s;
        assert!((x * x + y * y + z * z + w * w - 1.0).abs() < 1e-6, "a unit quaternion");
    }
    // `pip install evo` installs it on the path; machines without Python skip this test.
    match Command::new("evo_traj").args(["tum"]).arg(&file).env("HOME", folder.path()).output() {
        Ok(output) => {
            let said = String::from_utf8_lossy(&output.stdout);
            assert!(output.status.success() && said.contains("poses"), "{said}");
        }
        Err(_) => eprintln!("skipped: evo_traj is not here"),
    }
}

#[test]
#[cfg_attr(not(field_data), ignore = "needs ../shared/datasets")]
fn the_csv_has_the_covariance_and_the_field_data_its_poses() {
    let path = of_field("2022-07-11-2");
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("run.csv");
    let output =
        resect().arg("trajectory").arg(&path).arg("--out").arg(&file).output().expect("runs");
    assert!(output.status.success());
    let text = std::fs::read_to_string(&file).expect("written");
    let header: Vec<&str> = text.lines().next().expect("a header").split(',').collect();
    assert_eq!(header.len(), 9 + 6 + 21 + 12);
    // 2032 triplets; together with the times at which two prisms or all are followed beyond the paper's intervals, twice as many.
    let poses = text.lines().count() - 1;
    assert!((4000..4600).contains(&poses), "{poses}");
    assert!(open(&path).is_ok());
}

/// Returns times, positions and their σ from the CSV that the command writes.
fn csv_of(arguments: &[&str]) -> Vec<[f64; 5]> {
    csv_of_folder(&sample_folder("warthog"), arguments)
}

fn csv_of_folder(deployment: &Path, arguments: &[&str]) -> Vec<[f64; 5]> {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("drive.csv");
    let output = resect()
        .arg("trajectory")
        .arg(deployment)
        .args(arguments)
        .arg("--out")
        .arg(&file)
        .output()
        .expect("runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = std::fs::read_to_string(&file).expect("written");
    let row = |line: &str| {
        let numbers: Vec<f64> =
            line.split(',').map(|field| field.parse().expect("a number")).collect();
        let sigma = (9..12).map(|k| numbers[k].powi(2)).sum::<f64>().sqrt();
        [numbers[0], numbers[1], numbers[2], numbers[3], sigma]
    };
    text.lines().skip(1).map(row).collect()
}

#[test]
fn poses_are_had_at_a_rate_and_at_the_stamps_of_a_file() {
    let at_triplets = csv_of(&[]);
    let at_rate = csv_of(&["--pose-rate", "20"]);
    for pose in &at_rate {
        let steps = 20.0 * (pose[0] - at_rate[0][0]);
        assert!((steps - steps.round()).abs() < 1e-3, "{}", pose[0]);
    }
    assert!(at_rate.windows(2).all(|pair| pair[1][0] > pair[0][0]), "each once, in order");
    assert!((1.9..2.1).contains(&(at_rate.len() as f64 / at_triplets.len() as f64)));

    let folder = tempfile::tempdir().expect("a folder");
    let stamps = folder.path().join("stamps.txt");
    let mut text = "# timestamp tx\n".to_owned();
    for pose in at_triplets.iter().rev().step_by(7) {
        text += &format!("{:.6} 0\n", pose[0]);
    }
    // Long after the drive there is no pose.
    text += "1760009999.0 0\n";
    std::fs::write(&stamps, text).expect("written");
    let at_stamps = csv_of(&["--at", stamps.to_str().expect("UTF-8")]);
    assert_eq!(at_stamps.len(), at_triplets.len().div_ceil(7));
    let same = |pose: &&[f64; 5]| {
        let other = at_triplets.iter().find(|other| other[0] == pose[0]).expect("a triplet's time");
        (0..3).all(|k| (pose[1 + k] - other[1 + k]).abs() < 2e-5)
    };
    // A time is written to a microsecond, which moves the one at a cut of a long segment to the other side.
    let count = at_stamps.iter().filter(same).count();
    assert!(count + 3 >= at_stamps.len(), "{count} of {}", at_stamps.len());
}

#[test]
fn a_pose_is_less_certain_where_readings_end_and_none_is_made_up_in_a_gap() {
    let folder = tempfile::tempdir().expect("a folder");
    for entry in std::fs::read_dir(sample_folder("warthog")).expect("a folder") {
        let entry = entry.expect("a file");
        std::fs::copy(entry.path(), folder.path().join(entry.file_name())).expect("copied");
    }
    // No station has readings during ten seconds of each minute.
    let readings = folder.path().join("inter_prism.csv");
    let is_kept = |line: &&str| {
        let time_s = line.split(',').next().expect("a field").parse::<f64>();
        time_s.map_or(true, |time_s| time_s % 60.0 < 50.0)
    };
    let text = std::fs::read_to_string(&readings).expect("read");
    let kept: Vec<&str> = text.lines().filter(is_kept).collect();
    std::fs::write(&readings, kept.join("\n") + "\n").expect("written");
    let poses = csv_of_folder(folder.path(), &["--pose-rate", "10"]);
    let (mut ends, mut middles) = (Vec::new(), Vec::new());
    for stretch in poses.chunk_by(|a, b| b[0] - a[0] < 0.15).filter(|stretch| stretch.len() > 60) {
        ends.push(stretch[0][4]);
        middles.push(stretch[stretch.len() / 2][4]);
    }
    assert!(ends.len() > 5, "the drive has gaps");
    let median = |mut all: Vec<f64>| {
        all.sort_by(f64::total_cmp);
        all[all.len() / 2]
    };
    let (end, middle) = (median(ends), median(middles));
    // Most of both σ comes from the calibration.
    assert!(end > 1.05 * middle, "{end} at the ends, {middle} in the middle");
}

/// A drive without a pause is cut into segments of at most a hundred knots. The cuts are not visible: near a cut the prisms are as certain
/// as elsewhere, and do not jump. (The two overlapping motions have different knots, which explains the remaining difference.)
#[test]
fn nothing_tells_where_a_long_stretch_is_cut() {
    let mut found = Vec::new();
    for seed in 0..2 {
        let mut scenario = Preset::Warthog.scenario();
        scenario.noise.outlier_share = 0.0;
        scenario.noise.lost_locks_per_minute = 0.0;
        scenario.noise.wrong_targets_per_minute = 0.0;
        let deployment =
            resect_io::simulation_files::open(&simulate_scenario(&scenario, seed)).expect("valid");
        let mut settings = by(Method::Joint);
        settings.pipeline.outlier_filter = false;
        let analysis = analyse(&deployment, &settings);
        let joint = answer(&analysis).calibration.joint().expect("a joint estimate");
        let spans_s: Vec<[f64; 2]> = joint.solution.spans_s().collect();
        let cuts = spans_s.windows(2).filter(|two| two[1][0] - two[0][1] < 1e-6);
        for cut_s in cuts.map(|two| two[0][1]) {
            const STEP_S: f64 = 0.005;
            let times_s: Vec<f64> =
                (-2000..2000).map(|step| cut_s + STEP_S * f64::from(step)).collect();
            let instants = joint.solution.instants(&times_s, &Progress::default());
            let instants = instants.expect("not cancelled");
            assert_eq!(instants.len(), times_s.len(), "every instant once");
            let sigma_m = |at: &MotionInstant| (at.position_covariance.trace() / 9.0).sqrt();
            // Between readings σ is larger than at them.
            let largest_m = |from_s: f64, to_s: f64| {
                let is_in =
                    |at: &&MotionInstant| (from_s..to_s).contains(&(at.time_s - cut_s).abs());
                instants.iter().filter(is_in).map(sigma_m).fold(0.0, f64::max)
            };
            let jumps = instants.windows(2).map(|two| {
                let step = &two[1].position_m - &two[0].position_m;
                let ahead = &two[0].velocity_m_per_s;
                let jump_m = (step - ahead * (two[1].time_s - two[0].time_s)).amax();
                (jump_m / sigma_m(&two[0]), two[0].time_s - cut_s)
            });
            let (jump_sigmas, after_s) = jumps.max_by(|a, b| a.0.total_cmp(&b.0)).expect("some");
            found.push((largest_m(0.0, 0.4) / largest_m(4.0, 8.0), jump_sigmas, after_s));
        }
    }
    eprintln!("{found:.3?}");
    assert!(found.len() > 10, "{} cuts", found.len());
    for (over_usual, jump_sigmas, after_s) in found {
        let what = format!("{over_usual} {jump_sigmas} {after_s} s after the cut");
        assert!(over_usual < 1.15 && jump_sigmas < 0.5, "{what}");
    }
}

/// The scene draws the vehicle by the splines in every frame, and shows its σ once a pass over
/// the drive has computed it. Both give one pose. They differ only where one prism is much less
/// certain than the others, as at the end of its readings: the latter gives it less weight.
#[test]
fn where_the_scene_puts_the_vehicle_is_the_pose_that_has_a_sigma() {
    let deployment = Sample::Warthog.open().expect("built in");
    let analysis = analyse(&deployment, &by(Method::Joint));
    let (calibration, triplets) = (&answer(&analysis).calibration, &analysis.pipeline.triplets);
    let followed = &analysis.offer.followed;
    let rate = Instants::Rate(10.0);
    let off_sigmas = |needs_three_prisms: bool| {
        let limits = PoseLimits { needs_three_prisms, ..PoseLimits::NONE };
        let found = trajectory_by(&deployment, triplets, followed, calibration, rate, &limits);
        let (trajectory, _) = found.expect("a rig");
        let off_sigmas = trajectory.poses.iter().map(|pose| {
            let quick = vehicle_at(&deployment, calibration, pose.time_s).expect("in a stretch");
            let sigma = pose.sigma();
            let off_m = (quick.translation_m - pose.position_m).norm();
            let off_rad = pose.orientation.to_rotation_matrix().angle_to(&quick.rotation);
            (off_m / sigma.position_m).max(off_rad / sigma.orientation_rad)
        });
        let mut off_sigmas: Vec<f64> = off_sigmas.collect();
        off_sigmas.sort_by(f64::total_cmp);
        let told = [50, 95, 100].map(|percent| off_sigmas[(off_sigmas.len() - 1) * percent / 100]);
        (trajectory, told)
    };
    // In gaps of one prism, up to two seconds long, its readings do not show how certain it is.
    let (_, told) = off_sigmas(true);
    assert!(told[0] < 0.25 && told[1] < 0.5 && told[2] < 2.5, "{told:?} σ");
    // Where two prisms are followed, the scene has the tilt of the spans beside it, and σ is that of the tilt about one axis.
    let (trajectory, told) = off_sigmas(false);
    assert!(told[2] < 3.0, "{told:?} σ");
    for gap in trajectory.poses.windows(2).filter(|two| two[1].time_s - two[0].time_s > 0.5) {
        let middle_s = 0.5 * (gap[0].time_s + gap[1].time_s);
        assert_eq!(vehicle_at(&deployment, calibration, middle_s), None, "in a gap");
    }
    let by_triplets = analyse(&deployment, &published());
    let at_s = trajectory.poses[0].time_s;
    assert_eq!(vehicle_at(&deployment, &answer(&by_triplets).calibration, at_s), None);
}

#[test]
fn what_cannot_be_had_is_said_in_a_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let words = folder.path().join("words.txt");
    std::fs::write(&words, "time\nnoon\n").expect("written");
    let words = words.to_str().expect("UTF-8");
    let cases: [(&[&str], &str); 5] = [
        (&["--pose-rate", "5", "--method", "inter-prism"], "--method joint"),
        (&["--pose-rate", "nan"], "--pose-rate is NaN Hz"),
        (&["--at", words], "words.txt:2: the first column is not a time"),
        (&["--at", "/no/such/file"], "/no/such/file"),
        (&["--at", "/tmp"], "not a regular file"),
    ];
    for (arguments, expected) in cases {
        let output = resect()
            .arg("trajectory")
            .arg(sample_folder("warthog"))
            .args(arguments)
            .output()
            .expect("runs");
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success() && said.contains(expected), "{arguments:?}: {said}");
        assert_eq!(said.trim().lines().count(), 1, "{said}");
    }
}

#[test]
fn one_prism_has_positions_that_are_as_certain_as_they_say() {
    let (mut covered, mut all) = (0, 0);
    for seed in 0..4 {
        let simulated = simulate(Preset::SinglePrism, seed);
        let deployment = resect_io::simulation_files::open(&simulated).expect("valid");
        let analysis = analyse(&deployment, &by(Method::Joint));
        let calibration = &answer(&analysis).calibration;
        let triplets = analysis.triplets();
        let positions = prism_by(&deployment, triplets, calibration, Instants::Rate(5.0))
            .expect("the joint estimate has a motion");
        for at in &positions {
            let truth = &simulated.truth;
            let true_m = truth.motion.position_m(&truth.prisms_m[0], at.time_s - EPOCH_S);
            let error = at.position_m - true_m;
            let inverse = at.position_covariance.try_inverse().expect("full rank");
            // The 95 % quantile of χ² with three degrees of freedom.
            covered += usize::from(error.dot(&(inverse * error)) < 7.815);
            all += 1;
        }
    }
    assert!(all > 2000, "{all}");
    let share = covered as f64 / all as f64;
    assert!(share > 0.9, "{share}");
}

/// The motion continues smoothly and keeps the rig's distances; a pose there would look better than the readings.
#[test]
fn no_pose_of_the_motion_stands_where_the_readings_contradict_the_rig() {
    let deployment = Sample::Warthog.open().expect("built in");
    let analysis = analyse(&deployment, &by(Method::Joint));
    let calibration = &answer(&analysis).calibration;
    let (triplets, followed) = (analysis.triplets(), &analysis.offer.followed);
    let dropped = |limit_m: f64| {
        let wanted = Instants::Usual;
        let limits = PoseLimits { inter_prism_error_m: limit_m, ..PoseLimits::NONE };
        let (found, _) =
            trajectory_by(&deployment, triplets, followed, calibration, wanted, &limits)
                .expect("three prisms");
        assert!(found.poses.iter().all(|pose| pose.inter_prism_error_m <= limit_m));
        found.dropped
    };
    assert_eq!(dropped(f64::INFINITY), 0);
    assert!(dropped(0.002) > dropped(0.005) && dropped(0.005) > 0);
}

/// Bags and clouds of the same poses, read by other programs.
#[test]
#[ignore = "needs the PyPI packages rosbags and mcap-ros2-support: tests/run --peers"]
fn odometry_in_bags_is_read_by_the_peers_as_it_was_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str| {
        let file = folder.path().join(name);
        let mut command = resect();
        command.arg("trajectory").arg(sample_folder("warthog")).arg("--out").arg(&file);
        let output = command.args(["--pose-rate", "20"]).output().expect("runs");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        file
    };
    let numbers = |text: &str| -> Vec<Vec<f64>> {
        let lines = text.lines().filter(|line| !line.starts_with('#'));
        lines
            .map(|line| line.split(' ').map(|field| field.parse().expect("a number")).collect())
            .collect()
    };
    let tum = numbers(&std::fs::read_to_string(write("drive.tum")).expect("written"));
    assert!(tum.len() > 5000, "more than one chunk: {}", tum.len());
    let mut both = Vec::new();
    for name in ["drive.bag", "drive.mcap"] {
        let mut python = Command::new("python");
        let output = python
            .arg(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/peers/read_odometry.py"))
            .arg(write(name))
            .output()
            .expect("tests/run --peers has it on the path");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let read = numbers(&String::from_utf8_lossy(&output.stdout));
        assert_eq!(read.len(), tum.len());
        for (read, tum) in read.iter().zip(&tum) {
            // TUM has six decimals of a second and nine of the other values.
            assert!(
                read[..8].iter().zip(tum).all(|(a, b)| (a - b).abs() < 2e-6),
                "{read:?} {tum:?}"
            );
            assert!((1e-8..1e-2).contains(&read[8]) && read[9].abs() < 10.0 && read[10] > 0.0);
        }
        both.push(read);
    }
    assert_eq!(both[0], both[1]);
}

/// By CloudCompare's rules a PLY has x, y, z and any number of properties called `scalar_…`, one line a vertex.
#[test]
fn a_cloud_has_its_time_and_sigma_as_scalar_fields() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("drive.ply");
    let mut command = resect();
    command.arg("trajectory").arg(sample_folder("warthog")).arg("--out").arg(&file);
    assert!(command.output().expect("runs").status.success());
    let text = std::fs::read_to_string(&file).expect("written");
    let (header, body) = text.split_once("end_header\n").expect("a header");
    let mut lines = header.lines();
    assert_eq!((lines.next(), lines.next()), (Some("ply"), Some("format ascii 1.0")));
    let properties: Vec<&str> =
        header.lines().filter_map(|line| line.strip_prefix("property ")).collect();
    assert_eq!(
        properties,
        [
            "double x",
            "double y",
            "double z",
            "float scalar_time_s",
            "float scalar_sigma_mm",
            "float scalar_sigma_mrad"
        ]
    );
    let count =
        header.lines().find_map(|line| line.strip_prefix("element vertex ")).expect("a count");
    assert_eq!(body.lines().count().to_string(), count);
    for line in body.lines() {
        let numbers: Vec<f64> =
            line.split(' ').map(|field| field.parse().expect("a number")).collect();
        let [.., since_s, sigma_mm, sigma_mrad] = numbers[..] else { panic!("{line}") };
        assert_eq!(numbers.len(), properties.len());
        assert!(
            (0.0..500.0).contains(&since_s) && (0.1..50.0).contains(&sigma_mm) && sigma_mrad > 0.0,
            "{line}"
        );
    }
}

#[test]
fn poses_are_had_at_the_readings_of_all_stations() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("drive.tum");
    let mut command = resect();
    command
        .arg("trajectory")
        .arg(sample_folder("warthog"))
        .arg("--at-readings")
        .arg("--out")
        .arg(&file);
    let output = command.output().expect("runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = std::fs::read_to_string(&file).expect("written");
    let times_s: Vec<f64> = text
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| line.split(' ').next().expect("a time").parse().expect("a number"))
        .collect();
    let deployment = Sample::Warthog.open().expect("built in");
    // Times of station 1 are unchanged; the others are converted to its clock.
    let first: Vec<f64> = deployment.tracks[0].measurements.iter().map(|m| m.time_s).collect();
    let found = |time_s: &&f64| times_s.iter().any(|t| (t - **time_s).abs() < 2e-6);
    let shared = first.iter().filter(found).count();
    assert!(3 * shared > 2 * first.len(), "{shared} of {}", first.len());
    let all: usize = deployment.tracks.iter().map(|track| track.measurements.len()).sum();
    assert!((all / 2..=all).contains(&times_s.len()), "{} of {all}", times_s.len());
    assert!(times_s.is_sorted());
}

/// The sample's pillars are surveyed: poses in their frame describe the same drive, rotated and translated, and less certain.
#[test]
fn poses_are_had_in_the_frame_of_the_control_points() {
    let (here, there) = (csv_of(&[]), csv_of(&["--frame", "control-points"]));
    assert_eq!(here.len(), there.len());
    let between = |all: &[[f64; 5]], a: usize, b: usize| {
        (1..4).map(|axis| (all[a][axis] - all[b][axis]).powi(2)).sum::<f64>().sqrt()
    };
    for index in (10..here.len()).step_by(97) {
        let [near, far] = [&here, &there].map(|all| between(all, 0, index));
        assert!((near - far).abs() < 1e-4, "{near} {far}");
    }
    assert!((here[0][1] - there[0][1]).abs() > 0.1, "it is another frame");
    assert!(here.iter().zip(&there).all(|(here, there)| there[4] > here[4]), "and less certain");
    let mut command = resect();
    command.arg("trajectory").arg(sample_folder("hd2-tunnel")).args(["--frame", "control-points"]);
    let output = command.output().expect("runs");
    let why = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.code() == Some(1) && why.contains("no control point has surveyed"),
        "{why}"
    );
}
