//! The second floor of resect: what is done with calibrations, on plain data and without files.
//!
//! # Modules, from the ground up
//! A module imports only from those above it in this table, and from `resect_core` (`tests/structure`).
//!
//! | module | content | next change |
//! |---|---|---|
//! | [`findings`] | findings of this crate, one constructor for each kind | a finding: its kind in `kinds.rs`, a constructor here |
//! | [`validation`] | whether a calibration holds for another run, and which station moved | |
//! | [`palette`] | colours of stations, pairs, fates and verdicts, for window, report, pictures and Rerun alike | |
//! | [`estimates`] | trajectories of other systems (SLAM, odometry) against a deployment: APE, RPE, ranking, the odd one out | a metric: `metrics.rs` |
//! | [`extrinsics`] | pose of a body or an antenna in another body by their trajectories, with verdict and advice | a quantity of the verdict: `estimate_extrinsics.rs`; its advice: `advised_motion.rs` |
//! | [`simulation`] | deployments with known truth | a preset: a variant, a function and its arms in `preset.rs`, its words in `src/command/choice.rs`; stations and prisms of a scenario: `network.rs`; an error: a row of [`resect_core::calibration::joint::unknown`] is simulated by `FurtherError`, and drawn by presets with a kind in `error_kind.rs` and an arm in `field_errors.rs` |
//! | [`planning`] | predictions of a drive before it is driven, and what improves it | a key of a plan: `plan.rs`; a manoeuvre: `manoeuvres.rs`, tried by `improvements.rs` and `from_here.rs`; a condition along the way: `locks.rs` |
//! | [`experiment`] | the paper's studies over many deployments | a study: a file that returns a [`experiment::Study`] |

pub mod estimates;
pub mod experiment;
pub mod extrinsics;
pub mod findings;
pub mod palette;
pub mod planning;
pub mod simulation;
pub mod validation;
