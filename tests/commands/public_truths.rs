//! The page of the ground truths that anyone can have, `docs/src/public_truths.md`: its table is the output of `evaluate`.
//!
//! `UPDATE_GOLDEN=1 cargo test --release --test commands public_truths -- --ignored` writes the table again.

use std::fmt::Write;
use std::path::PathBuf;
use std::process::Command;

use crate::common::of_field;
use serde_json::Value;

/// A public drive: data set and drive, files of the estimate and of the ground truth, further flags.
struct PublicDrive {
    name: &'static str,
    estimate: &'static str,
    truth: &'static str,
    flags: &'static [&'static str],
}

const DRIVES: [PublicDrive; 14] = [
    PublicDrive {
        name: "EuRoC MH_01, batch solution",
        estimate: "imu/euroc_mh01/batch.tum",
        truth: "imu/euroc_mh01/leica.csv",
        flags: &[],
    },
    PublicDrive {
        name: "EuRoC MH_05, SVO stereo",
        estimate: "others/euroc/MH_05_svo_stereo.txt",
        truth: "others/euroc/MH_05_groundtruth.txt",
        flags: &[],
    },
    PublicDrive {
        name: "EuRoC V2_03, batch solution",
        estimate: "imu/euroc_v203/batch.csv",
        truth: "imu/euroc_v203/vicon.csv",
        flags: &[],
    },
    fusion_portable("handheld_room00", FUSION[0]),
    fusion_portable("handheld_escalator00", FUSION[1]),
    fusion_portable("handheld_grass00", FUSION[2]),
    fusion_portable("legged_room00", FUSION[3]),
    fusion_portable("legged_transition00", FUSION[4]),
    fusion_portable("ugv_transition00", FUSION[5]),
    PublicDrive {
        name: "FoMo, odometry",
        estimate: "others/fomo/odom.csv",
        truth: "others/fomo/gt.txt",
        flags: &[],
    },
    PublicDrive {
        name: "Hilti 2021 Basement_4, SVO",
        estimate: "others/hilti2021/Basement_4_svo2.txt",
        truth: "others/hilti2021/Basement_4_prism.txt",
        flags: &[],
    },
    PublicDrive {
        name: "Hilti 2021 Campus_2, SVO",
        estimate: "others/hilti2021/Campus_2_svo2.txt",
        truth: "others/hilti2021/Campus_2_prism.txt",
        flags: &[],
    },
    PublicDrive {
        name: "Hilti 2021 Campus_2, hdl_graph_slam",
        estimate: "others/hilti2021/Campus_2_hdl_graph_slam.txt",
        truth: "others/hilti2021/Campus_2_prism.txt",
        flags: &[],
    },
    PublicDrive {
        name: "TUM freiburg1_xyz, RGB-D SLAM",
        estimate: "others/evo/freiburg1_xyz-rgbdslam.txt",
        truth: "others/evo/freiburg1_xyz-groundtruth.txt",
        flags: &[],
    },
];

/// Files of FusionPortable: estimate and ground truth.
const FUSION: [[&str; 2]; 6] = [
    [
        "others/fusionportable/handheld_room00_fastlio2.tum",
        "others/fusionportable/handheld_room00_prism.tum",
    ],
    [
        "others/fusionportable/handheld_escalator00_fastlio2.tum",
        "others/fusionportable/handheld_escalator00_prism.tum",
    ],
    [
        "others/fusionportable/handheld_grass00_fastlio2.tum",
        "others/fusionportable/handheld_grass00_prism.tum",
    ],
    [
        "others/fusionportable/legged_room00_fastlio2.tum",
        "others/fusionportable/legged_room00_prism.tum",
    ],
    [
        "others/fusionportable/legged_transition00_fastlio2.tum",
        "others/fusionportable/legged_transition00_prism.tum",
    ],
    [
        "others/fusionportable/ugv_transition00_fastlio2.tum",
        "others/fusionportable/ugv_transition00_prism.tum",
    ],
];

const fn fusion_portable(name: &'static str, [estimate, truth]: [&'static str; 2]) -> PublicDrive {
    PublicDrive { name, estimate, truth, flags: &[] }
}

const BEGIN: &str = "<!-- table -->\n";
const END: &str = "<!-- end of the table -->\n";

#[test]
#[ignore = "needs the data of other groups, and a minute"]
fn public_truths_are_judged_as_the_page_states() {
    let page = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("docs/src/public_truths.md");
    let text = std::fs::read_to_string(&page).expect("the page");
    let (before, rest) = text.split_once(BEGIN).expect("a table");
    let (written, after) = rest.split_once(END).expect("the end of the table");
    let table = table();
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&page, format!("{before}{BEGIN}{table}{END}{after}")).expect("written");
    } else {
        assert_eq!(written, table);
    }
}

fn table() -> String {
    let mut table = "| drive, estimate | points of the truth | time offset (ms) | lever arm x, y, z (mm) | APE (mm) | spans that contradict |\n\
                     |---|---|---|---|---|---|\n"
        .to_owned();
    for drive in &DRIVES {
        let [estimate, truth] = [drive.estimate, drive.truth].map(of_field);
        let output = Command::new(env!("CARGO_BIN_EXE_resect"))
            .arg("evaluate")
            .arg(estimate)
            .arg("--against")
            .arg(truth)
            .arg("--json")
            .args(drive.flags)
            .output()
            .expect("runs");
        let row = match serde_json::from_slice::<Value>(&output.stdout) {
            Ok(answer) => row(&answer["estimates"][0], &answer["ground_truth"]),
            Err(_) => {
                let why = String::from_utf8_lossy(&output.stderr);
                let why = why.split_once("resect: ").map_or(&*why, |(_, why)| why);
                format!("| | | | | {}", why.trim())
            }
        };
        _ = writeln!(table, "| {} {row} |", drive.name);
    }
    table
}

/// Formats a number of thousandths with σ.
fn millis(value: &Value, sigma: &Value) -> String {
    match (value.as_f64(), sigma.as_f64()) {
        (Some(_), Some(sigma)) if sigma > 0.5 => "–".to_owned(),
        (Some(value), Some(sigma)) => format!("{:+.1} ± {:.1}", 1e3 * value, 1e3 * sigma),
        _ => "–".to_owned(),
    }
}

fn row(judged: &Value, truth: &Value) -> String {
    let clock = match judged["time_offset_determined"].as_bool() {
        Some(true) => millis(&judged["time_offset_s"], &judged["time_offset_sigma_s"]),
        _ => "not determined".to_owned(),
    };
    let lever = [0, 1, 2]
        .map(|axis| millis(&judged["lever_arm_m"][axis], &judged["lever_arm_sigma_m"][axis]));
    let spans = judged["odd_spans"].as_array().map_or(&[][..], |spans| spans);
    let seconds: f64 = spans
        .iter()
        .map(|span| {
            let end = |index: usize| span["span_s"][index].as_f64().unwrap_or_default();
            end(1) - end(0)
        })
        .sum();
    let odd = match spans.len() {
        0 => "none".to_owned(),
        count => format!("{count}, {seconds:.0} s"),
    };
    let ape_mm = 1e3 * judged["ape_position_m"]["rmse"].as_f64().unwrap_or(f64::NAN);
    format!("| {} | {clock} | {} | {ape_mm:.1} | {odd}", truth["poses"], lever.join(", "))
}
