//! resect: extrinsic calibration of three robotic total stations that can be trusted.
//!
//! This page is the map; CONTRIBUTING.md has a table of which file to open for which change. Words are the field's, and the
//! [`glossary`] explains them.
//!
//! # The one path
//! ```text
//! Deployment ──pipeline::run──▶ Triplets ──calibration::solve──▶ Calibration ──evaluation::evaluate──▶ Evaluation
//! ```
//! [`analysis::Analyst`] walks it and remembers the stages that a change of settings leaves alone. The window, the commands
//! and the tests go through it; studies and benchmarks, which repeat or time one stage, call the same functions.
//!
//! ```
//! use resect::analysis::{Analyst, Settings};
//! use resect::deployment::Sample;
//!
//! let deployment = Sample::Warthog.open()?;
//! let analysis = Analyst::new(deployment.into()).run(&Settings::default());
//! let answer = analysis.answer?;
//! assert_eq!(answer.calibration.verdict.name(), "good");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Rooms, from the ground up
//! A module imports only from those above it in this table (`tests/structure.rs`).
//!
//! | module | what is in it | what goes there next |
//! |---|---|---|
//! | [`atomic`] | files that are the old one or the new one, never half of it, and why one cannot be written | a remedy: `error.rs` |
//! | [`geometry`] | polar and geodetic coordinates, level and rigid transforms, alignment | |
//! | [`statistics`] | medians, robust losses, covariances from data that is correlated in time | |
//! | [`progress`] | how far long work is, and whether anyone still wants it | |
//! | [`deployment`] | the data model; `format/` has a file a format, and one for the bags (`bag/`), damage in them included | a reader: a file in `format/`, a variant of `Format` and a line in `recognise` (`format/mod.rs`), its part in `open/`; what a finding may advise: `remedy.rs` (any room makes findings) |
//! | [`pipeline`] | outlier filter, interval split and filter, interpolation | a threshold: a field of `pipeline/settings.rs`, which `staged.rs` compares to see from which stage to run again, tested in `outlier_filter.rs` or `interval_filter.rs`; an interpolation: a file in `interpolation/`, a variant of its `Interpolation` |
//! | [`calibration`] | methods A to D and the joint estimate, each answer with its uncertainty, verdict and what checked it | a better estimate of D: a file in `inter_prism/`; an unknown of the joint estimate: its index in `joint/unknowns.rs`, its kind in `joint/instruments.rs`, its words in `joint/summary.rs`; how large an error of instruments or clocks usually is, noise among them: `calibration/instrument.rs`; where the prisms are between readings, with covariance: `joint/prisms.rs`; the verdict's words: `verdict.rs`, its reasons: `checks.rs` and the files called `diagnosis` and `in_words` |
//! | [`evaluation`] | the paper's two metrics, GNSS baselines, six-degree-of-freedom trajectories | poses: from the joint estimate's motion in `rig_motion.rs`, of a triplet by itself in `trajectory.rs`; which of the two, when and in which frame of the vehicle: `vehicle.rs`; the frame of the control points: `site.rs`; what an answer leaves open where that is most: `far_end.rs` |
//! | [`analysis`] | settings, and the one path | |
//! | [`validation`] | whether a calibration holds for another run, and which station moved | its words: `in_words.rs`; other runs in one frame: `one_frame.rs` |
//! | [`estimates`] | trajectories of other systems (SLAM, odometry) held against a deployment's: evo's errors, each beside the ground truth's own σ, which is better, who is the odd one out: `resect evaluate` | a format: a function in `read.rs`; a metric: `metrics.rs` |
//! | [`simulation`] | deployments with known truth | a preset, gaps and outliers included: an arm in `scenario.rs`; an error of instruments: `errors.rs`; how large it is in the field: `field_errors.rs` |
//! | [`planning`] | plans of deployments: what a drive will tell before it is driven, and what would tell more | a manoeuvre: `manoeuvres.rs`, tried by `improvements.rs` and, from where a drive is, `from_here.rs`; a condition along the way: `locks.rs`, said in `in_words.rs` |
//! | [`live`] | a deployment while it is driven: streams from the network, answers while they come in, and whether it is enough | a source: a file that gives events, as `foxglove.rs`; a warning: a variant of `Amiss` in `warnings.rs`; what to drive next: `next.rs` |
//! | [`palette`] | the colours of stations, pairs, fates and verdicts, for window, report and pictures alike | |
//! | [`experiment`] | the paper's studies over many deployments | a study: a file that gives a [`experiment::Study`] |
//! | [`font`] | the one font | |
//! | [`glossary`] | the words of the field, explained | a term: a line in `terms.rs` |
//! | [`export`] | JSON, text, CSV, TUM, PLY, bags, HTML, SVG, PNG, Rerun | a writer; of trajectories: a file in `trajectory/`, a variant of its `FileKind`; a field of `calibrate --json`: `json.rs`, read again by `json/earlier.rs`; tables and JSON of all other commands: the file named after what they tell (`estimates/`, `validation.rs`, `planning.rs`, `live.rs`, `study.rs`) |
//! | [`app`] | the window; knows egui | a pane: a function in `panels/` or `plots/`, an arm in `model/pane.rs` and `window.rs`; one more series over time: a channel in `prepared/channels.rs`; an entry of a menu, with its key: a line in `actions/` |
//! | [`command`] | the command line; prints | a subcommand: a file with its flags, and an arm in `mod.rs`; what it prints and writes comes from `export` |
//!
//! # Conventions
//! Lengths are metres, angles radians, times seconds unless the name says otherwise; `a_from_b` maps frame b to
//! frame a. Stations, prisms and frames are numbered 1 to 3 for people and 0 to 2 in arrays; pairs of prisms
//! are in the order 12, 13, 23. Errors are typed and carry file, place and remedy; warnings are data
//! ([`deployment::Finding`]) that travel with the answer.

pub mod analysis;
pub mod app;
pub mod atomic;
pub mod calibration;
pub mod command;
pub mod deployment;
pub mod estimates;
pub mod evaluation;
pub mod experiment;
pub mod export;
pub mod font;
pub mod geometry;
pub mod glossary;
pub mod live;
pub mod palette;
pub mod pipeline;
pub mod planning;
pub mod progress;
pub mod simulation;
pub mod statistics;
pub mod validation;
