//! Shared code of the fuzz targets: opens the fuzzer's file as the program opens a user's file.

use std::path::PathBuf;

use resect_core::progress::Progress;
use resect_io::source::Source;

/// A drive that is read without errors, beside a damaged file of another kind.
pub const TRACKS: &str = "timestamp,id,distance,ha,va\n\
    1657569001.0,1,10.0,0.10,1.50\n1657569001.1,2,11.0,0.20,1.51\n1657569001.2,3,12.0,0.30,1.52\n\
    1657569001.4,1,10.1,0.11,1.50\n1657569001.5,2,11.1,0.21,1.51\n1657569001.6,3,12.1,0.31,1.52\n";

/// Reads a folder with only this file. The result does not matter, as long as the call returns.
pub fn open_alone(name: &str, bytes: &[u8]) {
    open(&[(name, bytes)]);
}

/// Reads a folder with this file and valid tracks.
pub fn open_beside_tracks(name: &str, bytes: &[u8]) {
    open(&[(name, bytes), ("inter_prism.csv", TRACKS.as_bytes())]);
}

/// Reads a folder with these files.
pub fn open(files: &[(&str, &[u8])]) {
    let folder = tempfile::tempdir_in(place()).expect("a folder");
    for (name, bytes) in files {
        std::fs::write(folder.path().join(name), bytes).expect("writable");
    }
    _ = Source::at(folder.path()).open(&Progress::default());
}

/// Returns a folder in memory if the system has one: a target writes thousands of files a second.
pub fn place() -> PathBuf {
    let memory = PathBuf::from("/dev/shm");
    if memory.is_dir() { memory } else { std::env::temp_dir() }
}
