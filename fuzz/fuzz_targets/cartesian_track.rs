#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    // The three files of the stations, each a third of the fuzzer's input.
    let third = bytes.len() / 3;
    let (one, rest) = bytes.split_at(third);
    let (two, three) = rest.split_at(third);
    resect_fuzz::open(&[("trimble1.csv", one), ("trimble2.csv", two), ("trimble3.csv", three)]);
});
