//! The data model: one field session of three robotic total stations, as it was measured.
//!
//! Readers (`resect-io`) make a [`Deployment`]; pipeline, calibration, window and commands take one and never look at a file again.

mod column_mapping;
mod control_points;
mod deployment;
mod drives;
mod finding;
mod finding_advice;
mod finding_kind;
pub mod findings;
mod gnss;
mod ingredient;
mod message;
pub mod names;
mod overrides;
mod overrides_beyond;
mod pairs;
pub mod printable;
mod quantity;
mod remedy;
mod rig;
mod severity;
pub mod station_clocks;
mod told_angle;
mod track;
mod track_frame;

pub use column_mapping::{ColumnMapping, TableAngle, TableLength, TimeFormat, VerticalAngle};
pub use control_points::{ControlPoint, ControlPointSet};
pub use deployment::Deployment;
pub use drives::OtherSetUp;
pub use finding::{Finding, FindingIdentity, Subject, doubts};
pub use finding_advice::{ADVICE, Advice};
pub use finding_kind::FindingKind;
pub use gnss::GnssFix;
pub use ingredient::Ingredient;
pub use message::Message;
pub use overrides::{AzimuthSense, MaskedReading, OneOrMany, Overrides, PrismConstants};
pub use overrides_beyond::AS_NUMBERED;
pub use pairs::{PAIRS, pair_label};
pub use quantity::{FindingQuantity, Unit};
pub use remedy::Remedy;
pub use rig::{Rig, pairwise_distances};
pub use severity::Severity;
pub use told_angle::{ToldAngle, ToldIn};
pub use track::{Measurement, RawRecord, TimeCorrection, Track};
pub use track_frame::TrackFrame;
