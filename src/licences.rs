//! The licence of the program, and the licences and notices of the packages in it.

/// Written by the test `tests/structure/licences.rs`.
const OF_PACKAGES: &[u8] = include_bytes!("../assets/licences.txt.zst");
const OWN: &str = include_str!("../LICENSE");

/// Returns all licences as text.
pub fn text() -> String {
    let of_packages = zstd::decode_all(OF_PACKAGES).expect("a test reads it");
    format!("{OWN}\n{}", String::from_utf8_lossy(&of_packages))
}
