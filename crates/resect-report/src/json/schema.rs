//! The version of the JSON contract.

pub const SCHEMA: u32 = 2;
