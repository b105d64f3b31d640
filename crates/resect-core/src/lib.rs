//! The ground floor of resect: what one must trust for an answer, as functions on plain data.
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
//! | [`network`] | numbers of stations, prisms and pairs, and values by each of them | the largest number: `MOST_STATIONS` in `number.rs`; the compiler finds its users but: `indexed` in `evaluation/answer_rows.rs`, three bits of a station in `src/app/scene/colouring.rs` (its byte is full) and `assets/shaders/scene.wgsl` (and the length of `world_from_frame`), `by_number` in `crates/resect-io/src/open/tables.rs`, places in `crates/resect-tools/src/simulation/network.rs`, `python/resect/__init__.py`, and messages with "1 to 8" |
//! | [`deployment`] | the data model: tracks, control points, rig, overrides, findings | another kind of measurement: a field of `deployment.rs`, carried by the crate `resect-io` (`crates/resect-io/src/open/combine.rs`, `crates/resect-io/src/recording.rs`, `crates/resect-io/src/growing.rs`); a finding: its kind in `kinds.rs`, its constructor in `findings/`, new advice in `advice.rs`; a prism constant per type of prism: `overrides.rs` |
//! | [`pipeline`] | outlier filter, interval split and filter, interpolation | a threshold: a field of `settings.rs`, its row in `numbers.rs`, compared in `staged.rs`; an interpolation: a file in `interpolation/`, a variant of `Interpolation` |
//! | [`calibration`] | methods A to D and the joint estimate, each answer with its uncertainty, verdict and checks | method D: `inter_prism/` (the mirror solution: `mirror.rs`); recognising the prism that a station follows: `followed_prisms.rs`, stated ones: `deployment/stated_prisms.rs`; a change of it: `network/prism_schedule.rs`, found in `inter_prism/followed_another.rs`, used in `joint/segment_prisms.rs`; the evaluation has the prisms that are followed most; an error of the instruments: its row in `joint/unknown.rs`, the user's size of its prior in `instrument.rs` and `numbers.rs`; a slow change: `joint/random_walks.rs`, `joint/state_vector.rs`, `joint/block_jacobians.rs`; the readings that the joint estimate takes: `joint_data.rs`, `joint/readings.rs`, its segments: `joint/spans.rs`, the jerk along the drive: `joint/excess_jerk.rs`; what a reading depends on: `joint/residuals.rs`; another kind of equation: `joint/equations.rs`; the robust loss: `joint/loss.rs`; the verdict: `checks.rs`, `inter_prism/diagnosis.rs` |
//! | [`evaluation`] | the paper's two metrics, GNSS baselines, six-degree-of-freedom trajectories | poses: `rig_motion.rs` (joint estimate), `usual_tilt.rs` (where two prisms are followed), `trajectory.rs` (each triplet), `vehicle.rs` (which of them, and limits of σ), the layout of the prisms: `rig_layout.rs`; the frame of the control points: `site.rs`; an option of `trajectory`: `requested_trajectory.rs` |
//! | [`analysis`] | settings, and the one path | |

pub mod analysis;
pub mod calibration;
pub mod deployment;
pub mod evaluation;
pub mod geometry;
pub mod linear_algebra;
pub mod network;
pub mod number_setting;
pub mod pipeline;
pub mod progress;
#[cfg(test)]
mod simulated_drives;
pub mod statistics;
pub mod stopwatch;
