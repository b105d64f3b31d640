//! The JSON Schema as the program contains it: packed, because the program may have 40 MB.

use std::path::Path;

use serde_json::Value;

/// Level of the compression: the file is written once.
const LEVEL: i32 = 19;

#[test]
fn the_packed_schema_is_the_schema() {
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets");
    let schema = std::fs::read_to_string(assets.join("schema.json")).expect("the schema");
    let schema: Value = serde_json::from_str(&schema).expect("JSON");
    let file = assets.join("schema.json.zst");
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        let packed = zstd::encode_all(schema.to_string().as_bytes(), LEVEL).expect("packed");
        std::fs::write(&file, packed).expect("written");
    }
    let packed = std::fs::read(&file).expect("the packed schema");
    let unpacked = zstd::decode_all(&packed[..]).expect("packed by this test");
    let unpacked: Value = serde_json::from_slice(&unpacked).expect("JSON");
    assert_eq!(
        unpacked, schema,
        "pack it with UPDATE_GOLDEN=1 cargo test --test structure packed_schema"
    );
}
