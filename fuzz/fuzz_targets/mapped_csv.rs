#![no_main]

/// Columns of the seeds; the fuzzer finds other headers by itself.
const MAPPING: &[u8] = b"stations = [1, 2, 3]\n[columns]\ntime = \"t\"\nstation = \"s\"\nrange = \"sd\"\nazimuth = \"hz\"\n\
    vertical = \"v\"\nangle_unit = \"degrees-minutes-seconds\"\ntime_format = \"calendar\"\n";

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    resect_fuzz::open(&[("foreign.csv", bytes), ("deployment.toml", MAPPING)]);
    let head = String::from_utf8_lossy(bytes);
    let mapping = resect_io::format::mapped_csv::suggest(&head);
    _ = resect_io::format::mapped_csv::preview(&head, &mapping);
});
