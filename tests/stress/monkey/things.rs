//! Valid and invalid files in the monkey's folder.

use std::path::{Path, PathBuf};

use resect_core::analysis::Settings;
use resect_io::simulation_files::write_folder;
use resect_tools::simulation::{Preset, simulate};

/// Writes all files; returns the paths that can be dropped, from folders to single files.
pub fn lay_out(folder: &Path) -> Vec<PathBuf> {
    let data = folder.join("data");
    let crate_folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut things = Vec::new();
    for sample in ["warthog", "hd2-tunnel"] {
        let to = data.join(sample);
        copy_files(&crate_folder.join("crates/resect-io/assets/samples").join(sample), &to);
        things.push(to);
    }
    for (name, preset) in [
        ("eight", Preset::FigureEight),
        ("single", Preset::SinglePrism),
        ("flat", Preset::FlatFloor),
    ] {
        let to = data.join(name);
        write_folder(&simulate(preset, 1), &to).expect("simulated");
        things.push(to);
    }
    copy_files(&crate_folder.join("tests/fixtures/bags"), &data.join("bags"));
    things.extend(files_of(&data.join("bags")));
    let warthog = files_of(&data.join("warthog"));
    let tracks = std::fs::read_to_string(data.join("warthog/inter_prism.csv")).expect("copied");
    things.extend(warthog);
    let file = |name: &str, bytes: &[u8]| {
        let path = data.join(name);
        std::fs::create_dir_all(path.parent().expect("inside")).expect("a folder");
        std::fs::write(&path, bytes).expect("written");
        path
    };
    let settings = toml::to_string(&Settings::default()).expect("text");
    let junk: Vec<u8> =
        (0..9000_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
    let (header, rows) = tracks.split_once('\n').expect("a header");
    let columns = header.split(',').count();
    let renamed: Vec<String> = (0..columns).map(|column| format!("c{column}")).collect();
    let few: Vec<&str> = rows.lines().take(30).collect();
    things.extend([
        file("settings.toml", settings.as_bytes()),
        file("bad-settings.toml", b"[pipeline]\noutlier_filter = 7\n"),
        file("broken.resect.toml", b"resect_session = 1\nactive = [["),
        file("newer.resect.toml", b"resect_session = 99\n"),
        file("empty.csv", b""),
        file("junk.csv", &junk),
        file("junk.bag", &junk),
        file("junk", &junk),
        file("renamed/readings.csv", format!("{}\n{rows}", renamed.join(",")).as_bytes()),
        file("cut/inter_prism.csv", &tracks.as_bytes()[..tracks.len() / 3]),
        file("few/inter_prism.csv", format!("{header}\n{}\n", few.join("\n")).as_bytes()),
        file("nothing/inter_prism.csv", format!("{header}\n").as_bytes()),
        file("nan/inter_prism.csv", tracks.replacen(",1", ",NaN", 500).as_bytes()),
        data.join("is-not-there"),
        data.join("empty"),
        data.clone(),
    ]);
    std::fs::create_dir(data.join("empty")).expect("a folder");
    things
}

fn files_of(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    files.sort();
    files
}

fn copy_files(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).expect("a folder");
    for file in files_of(from) {
        let name = file.file_name().expect("a name");
        std::fs::copy(&file, to.join(name)).expect("copied");
    }
}
