//! Writes what the targets start from into `fuzz/corpus`: a simulated drive in every format that the program writes, and
//! the fixtures of the tests.

use std::path::Path;

use resect::simulation::{Preset, simulate, write_folder};

/// Longer seeds make the fuzzer slow and find nothing more.
const LONGEST_SEED_BYTES: usize = 8 << 10;

fn main() {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus");
    let folder = tempfile::tempdir().expect("a folder");
    let drive = folder.path().join("drive");
    write_folder(&simulate(Preset::Warthog, 1), &drive).expect("written");
    let seed = |target: &str, from: &Path| {
        let mut bytes = std::fs::read(from).expect("a seed");
        bytes.truncate(LONGEST_SEED_BYTES);
        let into = corpus.join(target);
        std::fs::create_dir_all(&into).expect("a folder");
        let name = from.file_name().expect("a file");
        std::fs::write(into.join(name), bytes).expect("written");
    };
    for (target, name) in [
        ("polar_csv", "inter_prism.csv"),
        ("mapped_csv", "inter_prism.csv"),
        ("control_points", "GCP_raw_1.txt"),
        ("control_points", "pillars.csv"),
        ("rig", "calibration_raw.csv"),
        ("rig", "calibration_results.csv"),
        ("rtklib_pos", "gnss_1.pos"),
        ("deployment_toml", "deployment.toml"),
    ] {
        seed(target, &drive.join(name));
    }
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/fixtures");
    let mut folders = vec![fixtures];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
            let path = entry.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
            let target = match name.rsplit('.').next() {
                _ if path.is_dir() => {
                    folders.push(path);
                    continue;
                }
                Some("bag" | "active") => "ros1_bag",
                Some("db3") => "ros2_sqlite",
                Some("mcap") => "mcap",
                Some("zstd") => "compressed_bag",
                Some("gsi") => "gsi",
                Some("jxl" | "jobxml") => "jobxml",
                Some("csv") if name.contains("bonn") => "bonn_csv",
                Some("csv") => "mapped_csv",
                _ => continue,
            };
            seed(target, &path);
        }
    }
}
