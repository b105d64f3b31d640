//! Content of the scene: points and lines, each in the frame of its station. [`super::rebuild`] builds it.

use std::sync::Arc;

use nalgebra::Vector3;

use super::colouring::{Colours, fate_of};
use super::ghosts::Ghost;
use super::grid::Grid;
use super::trail::Trail;
use super::vehicle::VehicleAt;
use super::vertices::{Label, Landmark, Layer};
use crate::app::model::{Colouring, Picked};
use crate::app::prepared::Clouds;
use resect_core::analysis::Analysis;
use resect_core::deployment::Deployment;
use resect_core::geometry::RigidTransform;
use resect_core::network::{PerPrism, PerStation};

/// Everything in the scene.
#[derive(Clone, Debug, Default)]
pub struct SceneContent {
    /// Readings and tracks, with their version number.
    pub clouds: Clouds,
    pub clouds_version: u64,
    /// Colours of the readings and tracks, with their version number.
    pub colours: Colours,
    pub colours_version: u64,
    /// The stations whose readings, and whose tracks, are drawn.
    pub raw_shown: PerStation<bool>,
    pub tracks_shown: PerStation<bool>,
    /// Bit mask of the fates whose readings are drawn.
    pub shown_fates: u32,
    /// Highlighted span of time (s since the first measurement).
    pub selection_s: Option<[f32; 2]>,
    /// The selected span in the stations' clock (s).
    pub(super) selected_s: Option<[f64; 2]>,
    /// Poses of the vehicle along its path.
    pub(super) poses: Vec<VehicleAt>,
    pub along: Layer,
    /// Uncertainty of the vehicle's path.
    pub tube: Layer,
    /// Advised next move in a live deployment.
    pub advised: Layer,
    /// Paths of the vehicle in other open runs.
    pub beside: Layer,
    /// Positions of a ground truth of another system, thinned, and its origin (m). Map coordinates are too large for the scene's
    /// numbers, so everything is drawn relative to the first position.
    pub(super) truth_m: Vec<Vector3<f32>>,
    pub(super) truth_origin_m: Vector3<f64>,
    /// Trajectories of other systems, coloured by their errors.
    pub estimates: Layer,
    /// Names of these trajectories, each at its end.
    pub(super) estimate_labels: Vec<Label>,
    /// Error at the upper end of their colour scale (m); `None` without trajectories.
    pub worst_m: Option<f64>,
    /// The grid; depends on the camera.
    pub ground: Layer,
    /// Depends on the analysis and the visibility.
    pub data: Layer,
    /// The prism triangle at the time cursor.
    pub cursor: Layer,
    /// The prisms at the cursor where there is no triplet.
    pub ghosts: PerStation<Option<Ghost>>,
    pub trail: Trail,
    /// The prism triangle at the time under the pointer.
    pub hover: Layer,
    pub ruler: Layer,
    /// Transforms from the stations' frames to the world, which is station 1's frame; `None` if unknown.
    pub station1_from_station: PerStation<Option<RigidTransform>>,
    /// Transforms from the frames of their tracks to the world: `None` if the calibration is of another frame than theirs.
    pub station1_from_tracks: PerStation<Option<RigidTransform>>,
    pub labels: Vec<Label>,
    pub landmarks: Vec<Landmark>,
    /// Corners of the bounding box of stations and readings, shown or not (m); `None` if there are none.
    pub bounds_m: Option<(Vector3<f32>, Vector3<f32>)>,
    /// A sample of the visible points, for fitting the camera.
    pub outline_m: Vec<Vector3<f32>>,
    pub grid: Option<Grid>,
    /// The prisms at the cursor (m, station 1's frame); `None` unless all have a position.
    pub prisms_m: Option<PerPrism<Vector3<f64>>>,
    /// Mean of the prisms at the cursor, ghosts included (m, station 1's frame), which the camera follows.
    pub middle_m: Option<Vector3<f64>>,
    /// Pose of the vehicle at the cursor, if the rig is known.
    pub pose: Option<VehicleAt>,
    /// True if ellipsoids of the interpolation, and of the stations, are drawn.
    pub track_ellipsoids: bool,
    pub station_ellipsoids: bool,
    /// The residual arrows of control points; `None` without arrows.
    pub arrows: Option<DrawnArrows>,
}

/// Residual arrows of the control points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DrawnArrows {
    /// Enlargement of the residuals.
    pub scale: u32,
    /// Number of arrows that are cut short.
    pub cut: usize,
}

impl SceneContent {
    /// Replaces the clouds; does nothing if they are the same.
    pub fn set_clouds(&mut self, clouds: &Clouds) {
        let same = Arc::ptr_eq(&self.clouds.raw, &clouds.raw)
            && Arc::ptr_eq(&self.clouds.tracks, &clouds.tracks);
        if !same {
            self.clouds = clouds.clone();
            self.clouds_version += 1;
        }
    }

    /// Returns true if a reading is drawn.
    pub fn shows_reading(&self, picked: Picked) -> bool {
        let (cloud, Picked { station, index }) = (&self.clouds.raw, picked);
        let shown = self.raw_shown.as_slice().get(station).copied().unwrap_or(false);
        let colour = (self.colours.raw).get(cloud.ranges[station].start + index).filter(|_| shown);
        colour.is_some_and(|colour| self.shown_fates >> fate_of(*colour) & 1 == 1)
    }

    /// Returns the mean of the prisms at the cursor; `None` unless all have a position.
    pub fn middle_of_prisms_m(&self) -> Option<Vector3<f32>> {
        let prisms_m = self.prisms_m.as_ref()?;
        let sum_m = prisms_m.iter().sum::<Vector3<f64>>();
        Some((sum_m / prisms_m.len() as f64).cast())
    }

    /// Recomputes the colours of all points; to be called when the analysis or the colouring has changed.
    pub fn colour(&mut self, deployment: &Deployment, analysis: &Analysis, colouring: Colouring) {
        self.colours = Colours::of(deployment, analysis, colouring);
        self.colours_version += 1;
    }
}
