//! A separate process for a test, with its memory and processor time by the system's count.

use std::path::Path;
use std::process::Command;
use std::time::Duration;

/// Environment variable with the folder of the process.
const FOLDER: &str = "RESECT_TEST_FOLDER";
/// File that the process writes when the work is done: a name that matches no test would pass otherwise.
const DONE: &str = "test-is-done";

/// Does a test's work in a separate process, which has only a temporary folder: no home of the user, no program to start, and no memory of
/// other tests. `test` is the path of the test below its binary.
pub fn alone(test: &str, work: impl FnOnce(&Path)) {
    if let Some(folder) = std::env::var_os(FOLDER) {
        work(Path::new(&folder));
        std::fs::write(Path::new(&folder).join(DONE), "").expect("written");
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().canonicalize().expect("a folder");
    let status = Command::new(std::env::current_exe().expect("this program"))
        .args(["--exact", test, "--include-ignored", "--nocapture"])
        .current_dir(&path)
        .env(FOLDER, &path)
        .env("HOME", &path)
        .env("RESECT_CONFIG_DIR", path.join("config"))
        .env("PATH", path.join("no-programs"))
        .env("TMPDIR", &path)
        .env("MESA_SHADER_CACHE_DISABLE", "true")
        // With one heap for each thread, as many as there ever were threads, the resident size is meaningless.
        .env("MALLOC_ARENA_MAX", "2")
        .env_remove("XDG_CONFIG_HOME")
        .env_remove("XDG_DATA_HOME")
        .env_remove("XDG_CACHE_HOME")
        .status()
        .expect("started");
    assert!(status.success(), "{test}: {status}; the reason is printed above");
    assert!(path.join(DONE).exists(), "{test} is the name of no test");
}

/// Returns the resident size of this process (MB) on Linux; zero on other systems.
pub fn resident_mb() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    let kilobytes = line.and_then(|rest| rest.split_whitespace().next()?.parse::<f64>().ok());
    kilobytes.map_or(0.0, |kilobytes| kilobytes / 1024.0)
}

/// Returns the processor time of this thread on Linux; zero on other systems, where a busy machine would make a frame slow.
pub fn thread_time() -> Duration {
    // The kernel updates the count when the thread sleeps.
    std::thread::sleep(Duration::from_micros(1));
    std::fs::read_to_string("/proc/thread-self/schedstat")
        .ok()
        .and_then(|text| text.split(' ').next()?.parse().ok())
        .map_or(Duration::ZERO, Duration::from_nanos)
}
