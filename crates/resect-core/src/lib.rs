//! The ground floor of resect: the paper and what goes beyond it, as functions on plain data.
//!
//! No files, no windows, no command line, and no threads but rayon's: the crate compiles for `wasm32-unknown-unknown` too.
//!
//! ```text
//! Deployment ──pipeline::run──▶ Triplets ──calibration::solve──▶ Calibration ──evaluation::evaluate──▶ Evaluation
//! ```
//!
//! # Modules, from the ground up
//! A module imports only from those above it in this table (`tests/structure`).
//!
//! | module | content | next change |
//! |---|---|---|
//! | [`geometry`] | polar and geodetic coordinates, level and rigid transforms, alignment | |
//! | [`statistics`] | medians, robust losses, covariances of data that is correlated in time | another small-sample correction: `sandwich.rs` |
//! | [`linear_algebra`] | factorisation of structured matrices by vector instructions | |
//! | [`progress`] | progress and cancellation of long work | |
//! | [`number_setting`] | a number that a user can set: its name, unit, limits and meaning | |
//! | [`stopwatch`] | wall time of a calculation, on targets that have a clock | |
//! | [`network`] | numbers of stations, prisms and pairs, and values by each of them | |
//! | [`deployment`] | the data model: tracks, control points, rig, overrides, findings | a finding: its kind in `finding_kind.rs`, its constructor in `findings/`, its advice in `finding_advice.rs`; a prism constant per type of prism: `overrides.rs` |
//! | [`pipeline`] | outlier filter, interval split and filter, interpolation | a threshold: a field of `settings.rs`, its row in `numbers.rs`, compared in `staged.rs`; an interpolation: a file in `interpolation/`, a variant of `Interpolation` |
//! | [`calibration`] | methods A to D and the joint estimate, each answer with its uncertainty, verdict and checks | method D: `inter_prism/` (the mirror solution: `mirror.rs`); an unknown of the joint estimate: its index in `joint/state_vector.rs`, its kind in `joint/instrument_error_kind.rs`, its summary in `joint/summary.rs`, its prior in `instrument.rs` and `numbers.rs`; the robust loss: `joint/loss.rs`; the verdict: `checks.rs`, `inter_prism/diagnosis.rs` |
//! | [`evaluation`] | the paper's two metrics, GNSS baselines, six-degree-of-freedom trajectories | poses: `rig_motion.rs` (joint estimate), `trajectory.rs` (each triplet), `vehicle.rs` (which of the two); the frame of the control points: `site.rs`; an option of `trajectory`: `requested_trajectory.rs` |
//! | [`analysis`] | settings, and the one path | |
//! | [`validation`] | whether a calibration holds for another run, and which station moved | |
//! | [`palette`] | colours of stations, pairs, fates and verdicts, for window, report and pictures alike | |
//! | [`estimates`] | trajectories of other systems (SLAM, odometry) against a deployment: APE, RPE, ranking, the odd one out | a metric: `metrics.rs` |
//! | [`simulation`] | deployments with known truth | a preset: a function and an arm in `preset.rs`; an instrument error: `errors.rs`, its size in the field: `field_errors.rs` |
//! | [`planning`] | predictions of a drive before it is driven, and what improves it | a manoeuvre: `manoeuvres.rs`, tried by `improvements.rs` and `from_here.rs`; a condition along the way: `locks.rs` |
//! | [`experiment`] | the paper's studies over many deployments | a study: a file that returns a [`experiment::Study`] |

pub mod analysis;
pub mod calibration;
pub mod deployment;
pub mod estimates;
pub mod evaluation;
pub mod experiment;
pub mod geometry;
pub mod linear_algebra;
pub mod network;
pub mod number_setting;
pub mod palette;
pub mod pipeline;
pub mod planning;
pub mod progress;
pub mod simulation;
pub mod statistics;
pub mod stopwatch;
pub mod validation;
