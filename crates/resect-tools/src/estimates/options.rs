//! Options of a comparison with the ground truth: alignment, time offset and body.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::conventions::Convention;
use super::plane::Plane;

/// Options of the alignment of an estimate with the ground truth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Options {
    pub alignment: TrajectoryAlignment,
    /// Added to the estimate's times (s); estimated if `None`.
    pub time_offset_s: Option<f64>,
    /// Time offset near which it is estimated (s), for a span of a drive whose offset is known roughly; sought by speeds if `None`.
    #[serde(skip)]
    pub near_offset_s: Option<f64>,
    pub body: Body,
    #[serde(default)]
    pub association: Association,
    /// Convention of the estimate's file, which is applied before the comparison.
    #[serde(default, skip_serializing_if = "Convention::is_as_read")]
    pub convention: Convention,
    /// First and last time of the compared poses (s, in the ground truth's time); the whole drive if `None`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from_s: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to_s: Option<f64>,
    /// Number of compared poses, from the first on, by which the frame is aligned; all if `None`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub align_first: Option<usize>,
    /// Plane to which both trajectories are projected after the alignment.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plane: Option<Plane>,
}

impl Options {
    /// Returns true if a time in the ground truth's time (s) is compared.
    pub fn has_time(&self, time_s: f64) -> bool {
        self.from_s.is_none_or(|from_s| time_s >= from_s)
            && self.to_s.is_none_or(|to_s| time_s <= to_s)
    }

    /// Returns what evo assumes where nothing else is given: equal clocks, one body frame, and the nearest stamps. Results then equal those of `evo_ape`.
    pub fn as_evo(self) -> Self {
        Self {
            time_offset_s: self.time_offset_s.or(Some(0.0)),
            body: if self.body == Body::Found { Body::Same } else { self.body },
            association: Association::Nearest,
            ..self
        }
    }
}

impl Default for Options {
    fn default() -> Self {
        Self {
            alignment: TrajectoryAlignment::Rigid,
            time_offset_s: None,
            near_offset_s: None,
            body: Body::Found,
            association: Association::Interpolated,
            convention: Convention::AS_READ,
            from_s: None,
            to_s: None,
            align_first: None,
            plane: None,
        }
    }
}

/// Transform that aligns an estimate's frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TrajectoryAlignment {
    /// No transform: the estimate is in the ground truth's frame.
    None,
    /// A rotation and a translation (evo's `--align`).
    Rigid,
    /// A rotation, a translation and a scale, for a single camera (evo's `--align --correct_scale`).
    Similarity,
}

impl TrajectoryAlignment {
    /// Short name for people: "rotation and translation".
    pub fn in_words(self) -> &'static str {
        match self {
            Self::None => "nothing",
            Self::Rigid => "rotation and translation",
            Self::Similarity => "scale too",
        }
    }
}

/// Position of the estimate's body in the vehicle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Body {
    /// Unknown: the lever arm is estimated, and the body's rotation if the estimate has orientations.
    Found,
    /// The body's frame is the vehicle's, as evo assumes.
    Same,
    /// Known lever arm (m): the body's origin in the vehicle's frame, or the single prism in the body's.
    Lever(Vector3<f64>),
}

/// Association of the poses of an estimate with those of a trajectory that is the ground truth.
///
/// A deployment's ground truth is computed at the times of the estimate, so both are the same for it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Association {
    /// The trajectory with the shorter intervals is interpolated at the times of the other.
    #[default]
    Interpolated,
    /// The pose of the longer trajectory that is nearest in time, at most 10 ms apart (evo's default).
    Nearest,
}
