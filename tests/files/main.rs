//! Files of every format: each gives the same deployment, and errors name the file, the position and the remedy.

#[path = "../common/mod.rs"]
mod common;

mod bags;
mod opening;
mod other_tools;
mod surveys;
mod tables;
