//! `resect schema`: the JSON Schema of the JSON outputs.

use clap::Args;
use serde_json::{Map, Value, json};

use super::{Failure, print};

/// The schema of all outputs, `assets/schema.json` as packed by the test `tests/structure/packed_schema.rs`; each command is one of its
/// definitions.
const SCHEMA: &[u8] = include_bytes!("../../assets/schema.json.zst");
/// Commands with JSON outputs.
const COMMANDS: [&str; 10] = [
    "calibrate",
    "check",
    "compare",
    "validate",
    "ablate",
    "sweep",
    "evaluate",
    "extrinsics",
    "plan",
    "live",
];

#[derive(Args)]
pub struct SchemaArguments {
    /// Command whose output is described; all commands if none
    #[arg(value_parser = COMMANDS)]
    command: Option<String>,
}

pub fn run(arguments: &SchemaArguments) -> Result<(), Failure> {
    let packed = zstd::decode_all(SCHEMA).expect("a test reads it");
    let mut schema: Map<String, Value> = serde_json::from_slice(&packed)?;
    if let Some(command) = &arguments.command {
        schema.remove("anyOf");
        schema.insert("$ref".to_owned(), json!(format!("#/$defs/{command}")));
    }
    print(&format!("{:#}\n", Value::Object(schema)))?;
    Ok(())
}
