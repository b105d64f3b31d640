//! Files of every format: the same deployment out of each, and errors that name the file, the place and the remedy.

#[path = "../common/mod.rs"]
mod common;

mod bags;
mod opening;
mod surveys;
mod tables;
