#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| resect_fuzz::open_alone("inter_prism.csv", bytes));
