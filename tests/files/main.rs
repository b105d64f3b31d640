//! Files of every format: each gives the same deployment, and errors name the file, the position and the remedy.

#[path = "../common/mod.rs"]
mod common;

mod bags;
mod opening;
mod surveys;
mod tables;
