#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let folder = tempfile::tempdir_in(resect_fuzz::place()).expect("a folder");
    let path = folder.path().join("s.resect.toml");
    std::fs::write(&path, bytes).expect("writable");
    _ = resect::app::persist::session_file::load(&path);
});
