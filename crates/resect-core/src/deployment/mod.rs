//! The data model: one field session of robotic total stations, as it was measured.
//!
//! Readers (`resect-io`) create a [`Deployment`]; pipeline, calibration, window and commands use it, and never read a file
//! again.

pub mod advice;
mod column_mapping;
mod control_points;
mod deployment;
mod drives;
mod estimated_trajectory;
mod finding;
mod finding_kind;
pub mod findings;
mod gnss;
mod ingredient;
pub mod kinds;
mod message;
mod message_angle;
pub mod names;
mod overrides;
pub mod printable;
mod quantity;
mod remedy;
mod rig;
mod severity;
mod stated_prisms;
pub mod station_clocks;
mod track;
mod track_frame;

pub use column_mapping::{ColumnMapping, TableAngle, TableLength, TimeFormat, VerticalAngle};
pub use control_points::{ControlPoint, ControlPointSet};
pub use deployment::Deployment;
pub use drives::OtherSetUp;
pub use estimated_trajectory::{
    EstimatedPose, EstimatedTrajectory, FrameNames, PoseCovariance, names_of_trajectories,
};
pub use finding::{Finding, FindingIdentity, Subject, doubts};
pub use finding_kind::{FindingKind, Nature};
pub use gnss::GnssFix;
pub use ingredient::Ingredient;
pub use message::Message;
pub use message_angle::{AngleFormat, MessageAngle};
pub use overrides::{
    AzimuthSense, MaskedReading, OneOrMany, OverrideInWords, Overrides, PrismConstants,
    as_numbered, list_of,
};
pub use quantity::{FindingQuantity, Unit};
pub use remedy::Remedy;
pub use rig::{Rig, pairwise_distances};
pub use severity::Severity;
pub use stated_prisms::{FollowedPrisms, StatedPrismChange};
pub use track::{Measurement, RawRecord, TimeCorrection, Track};
pub use track_frame::TrackFrame;
