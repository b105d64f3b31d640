//! The joint estimate of motion, transforms, clocks, rig and instrument errors from the readings themselves.
//!
//! Readings are not interpolated: the prisms move along splines with the distances of the rig as constraints, and each reading
//! has the weight of its own noise (continuous-time batch estimation: Furgale, Barfoot & Sibley 2012). Instrument errors are
//! unknowns too, with priors of their physical size ([`ErrorSizes`](super::ErrorSizes)). An error that is not observable widens σ.
//!
//! [`mod@estimate`] iterates Gauss–Newton steps, each a [pass](mod@pass) over the [`drive`]: what is [`observed`] in each stretch →
//! [`equations`] → [`band`] eliminates the [`motion`], which leaves a [`chain`] of the drive's parts, with [`slow_priors`] →
//! [`chain_factor`] solves for constants ([`unknowns`]) and [`slow_changes`], with the [`likelihood`] of their process noise → back
//! substitution. Near the solution, [`gradients`] are enough.
//! Variance components of ranges, angles, stamps and process noise ([`noise`]) are estimated as Helmert's, with redundancy numbers
//! from random probes (Girard 1989). Rows of long drives are recomputed, not stored.
//!
//! [`stability`] looks for steps of stations and clocks, [`strain`] compares the estimate with its priors, and [`contradiction`] with
//! sizes that the user has reduced. [`summary`] makes the [`joint_estimate`], [`in_words`] its findings, [`corrected`] the corrected
//! triplets. [`mod@foresee`] predicts it before a drive. [`prisms`] evaluates the motion with its covariance
//! ([`band_covariance`]), across the [`cuts`] of long stretches too.

mod band;
mod band_covariance;
mod band_rows;
mod chain;
mod chain_factor;
mod chain_rows;
mod contradiction;
mod corrected;
mod cuts;
mod drive;
mod equations;
mod estimate;
mod foresee;
mod gradients;
pub mod in_words;
pub mod instruments;
mod joint_estimate;
mod likelihood;
pub mod loss;
mod motion;
mod moves;
mod noise;
mod observed;
mod pass;
pub mod prisms;
mod slow_changes;
mod slow_priors;
mod stability;
mod strain;
mod summary;
mod unknowns;

pub use self::estimate::estimate;
pub use self::foresee::{Expected, foresee};
pub use self::joint_estimate::{Dominant, DriveClocks, JointEstimate};
pub use self::observed::{Levels, RIGID_M, stated_range_m};
pub use self::slow_priors::Wander;
pub use self::stability::{Step, Stepped};
