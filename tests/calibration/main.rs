//! Estimates against simulated truth, the field data and each other.

#[path = "../common/mod.rs"]
mod common;

mod advice;
mod beside_published;
mod campaign;
mod drives;
mod explanation;
mod field_data;
mod interpolation;
mod methods;
mod minima;
mod networks;
mod observability;
mod own_evidence;
mod paper;
mod planning;
mod properties;
mod published;
mod real_drives;
mod refinement;
mod samples;
mod sense;
