//! resect: extrinsic calibration of robotic total stations that can be trusted.
//!
//! This page is the map; CONTRIBUTING.md has a table of which file to open for which change. The terms are the field's, and
//! [`resect_report::glossary`] explains them.
//!
//! # The one path
//! ```text
//! files ──resect_io──▶ Deployment ──pipeline──▶ Triplets ──calibration──▶ Calibration ──evaluation──▶ Evaluation
//!                                   └───────────── resect_core::analysis::Analyst ─────────────┘
//! ```
//! [`resect_core::analysis::Analyst`] runs it and keeps the stages that a change of settings leaves valid. The window, the
//! commands and the tests use it; studies and benchmarks, which repeat or time one stage, call the same functions.
//!
//! ```
//! use resect_core::analysis::{Analyst, Settings};
//! use resect_io::Sample;
//!
//! let deployment = Sample::Warthog.open()?;
//! let analysis = Analyst::new(deployment.into()).run(&Settings::default());
//! let answer = analysis.answer?;
//! assert_eq!(answer.calibration.verdict.name(), "good");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Crates, from the ground up
//! Each crate imports only from those above it, and each `lib.rs` has the map of its own modules.
//!
//! ```text
//! resect-core     geometry, data model, pipeline, calibration, evaluation: what one must trust for an answer
//! └ resect-tools  validation, other trajectories, simulation, planning, studies: no files, no windows, no clap
//!   └ resect-io     formats, opening of folders, bags, atomic files
//!     └ resect-live     streams from the network, answers while a drive grows, coaching
//!       └ resect-report   text, JSON, CSV, HTML, pictures, trajectories, Rerun; the glossary
//!         └ resect          this package: the window, the command line
//! ```
//!
//! | module | content | next change |
//! |---|---|---|
//! | [`licences`] | licences of the program and of its packages | after a change of dependencies: `tests/structure/licences.rs` writes them |
//! | [`app`] | the window; knows egui | a pane: a function in `panels/` or `plots/`, an arm in `model/pane.rs` and `window.rs`; a series over time: a channel in `prepared/channels.rs`; a menu entry with its key: a line in `actions/` |
//! | [`command`] | the command line; prints | a subcommand: a file with its flags, and an arm in `mod.rs`; a flag with a few words as values: `choice.rs`; its output comes from `resect-report` |
//!
//! # Conventions
//! Lengths are metres, angles radians, times seconds unless the name says otherwise; `a_from_b` maps frame b to
//! frame a. Stations and prisms are numbered from 1 for people and from 0 in lists; pairs of prisms are in the order
//! 12, 13, 23, 14, … ([`resect_core::network`]). Errors are typed and carry file, place and remedy; warnings are data
//! ([`resect_core::deployment::Finding`]) that travel with the answer.

pub mod app;
pub mod command;
pub mod licences;
