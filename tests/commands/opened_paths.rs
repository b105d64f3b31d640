//! `resect PATHS` with trajectories, without a display: the evaluation is printed.

use crate::commands::stdout;
use crate::common::sample_folder;
use crate::common::slam::{SLAM, Slam, driven, write_tum};

#[test]
fn trajectories_are_evaluated_against_the_one_that_is_the_truth() {
    let folder = tempfile::tempdir().expect("a folder");
    let (simulated, _) = driven(1);
    let names = ["lio.tum", "vio.tum", "groundtruth.tum"];
    let [lio, vio, truth] = names.map(|name| folder.path().join(name));
    write_tum(&Slam { drift_m: 0.0, ..SLAM }.drive(&simulated), &lio);
    write_tum(&Slam { noise_m: 0.05, drift_m: 0.0, seed: 2, ..SLAM }.drive(&simulated), &vio);
    let exact = Slam { noise_m: 0.001, drift_m: 0.0, rate_hz: 50.0, seed: 3, ..SLAM };
    write_tum(&exact.drive(&simulated), &truth);
    let [lio, vio, truth] = [&lio, &vio, &truth].map(|path| path.to_str().expect("UTF-8"));
    let said = stdout(&[truth, lio, vio]);
    let lines: Vec<&str> = said.lines().filter(|line| !line.is_empty()).collect();
    assert!(lines[0].starts_with("no display"), "{said}");
    assert!(lines[1].starts_with("ground truth: groundtruth (by its name)"), "{said}");
    // The verdict comes before all numbers, and `evaluate` begins with it.
    assert!(lines[2].starts_with("lio is better in position"), "{said}");
    let evaluated = stdout(&["evaluate", lio, vio, "--against", truth]);
    assert!(said.contains(&evaluated), "{evaluated}\nis not in\n{said}");
    assert!(evaluated.starts_with(lines[2]), "{evaluated}");
    // One alone has its facts, and the advice to add a ground truth.
    let said = stdout(&[lio]);
    assert!(said.contains("lio · ") && said.contains(" Hz), "), "{said}");
    assert!(said.contains("One trajectory alone cannot be evaluated"), "{said}");
    // With a deployment, it is the ground truth.
    let drive = sample_folder("warthog");
    let said = stdout(&[lio, drive.to_str().expect("UTF-8")]);
    assert!(
        said.contains("ground truth by the joint estimate") && said.contains("APE position"),
        "{said}"
    );
}
