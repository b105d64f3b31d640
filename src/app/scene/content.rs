//! What is drawn: points and lines, each in the frame of its station. [`super::rebuild`] makes it.

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

/// Everything in the scene.
#[derive(Clone, Debug, Default)]
pub struct SceneContent {
    /// Readings and tracks, with the number of their newest change.
    pub clouds: Clouds,
    pub clouds_version: u64,
    /// Colours of the readings and tracks, with the number of their newest change.
    pub colours: Colours,
    pub colours_version: u64,
    /// The stations whose readings, and whose tracks, are drawn.
    pub raw_shown: [bool; 3],
    pub tracks_shown: [bool; 3],
    /// A bit for each fate whose readings are drawn.
    pub shown_fates: u32,
    /// What stands out (s since the first measurement).
    pub selection_s: Option<[f32; 2]>,
    /// The selected span in the stations' clock (s).
    pub(super) selected_s: Option<[f64; 2]>,
    /// The vehicle along its way.
    pub(super) poses: Vec<VehicleAt>,
    pub along: Layer,
    /// How well the vehicle's way is known.
    pub tube: Layer,
    /// What to drive next in a live deployment.
    pub advised: Layer,
    /// Where the vehicle went in other open runs.
    pub beside: Layer,
    /// Trajectories of other systems, coloured by their errors.
    pub estimates: Layer,
    /// Their names, each where it ends.
    pub(super) estimate_labels: Vec<Label>,
    /// The error at the end of their colours (m); `None` where there are none.
    pub worst_m: Option<f64>,
    /// The grid; changes with the camera.
    pub ground: Layer,
    /// Changes with the analysis and the visibility.
    pub data: Layer,
    /// The prism triangle at the time cursor.
    pub cursor: Layer,
    /// The prisms at the cursor where there is no triplet.
    pub ghosts: [Option<Ghost>; 3],
    pub trail: Trail,
    /// The prism triangle at the time under the pointer.
    pub hover: Layer,
    pub ruler: Layer,
    /// Frames of stations 1–3 into the world, which is station 1's frame; `None` without a place.
    pub station1_from_station: [Option<RigidTransform>; 3],
    /// Frames of their tracks into the world: none where the answer is about another frame than theirs.
    pub station1_from_tracks: [Option<RigidTransform>; 3],
    pub labels: Vec<Label>,
    pub landmarks: Vec<Landmark>,
    /// Corners of the box around stations and readings, shown or not (m); `None` when there is nothing.
    pub bounds_m: Option<(Vector3<f32>, Vector3<f32>)>,
    /// A sample of what is shown, for the camera to look at.
    pub outline_m: Vec<Vector3<f32>>,
    pub grid: Option<Grid>,
    /// The three prisms at the cursor in station 1's frame, where all have a place.
    pub prisms_m: Option<[Vector3<f64>; 3]>,
    /// The middle of the prisms at the cursor, ghosts too (m, in station 1's frame): what the camera goes with.
    pub middle_m: Option<Vector3<f64>>,
    /// The vehicle's pose at the cursor, where the rig is known.
    pub pose: Option<VehicleAt>,
    /// Whether ellipsoids of the interpolation are drawn, and of the stations.
    pub track_ellipsoids: bool,
    pub station_ellipsoids: bool,
    /// How many arrows of the control points' residuals are longer than they are drawn; `None` where there are none.
    pub residuals: Option<usize>,
}

impl SceneContent {
    /// Takes in clouds; nothing is done with those that are there already.
    pub fn set_clouds(&mut self, clouds: &Clouds) {
        let same = Arc::ptr_eq(&self.clouds.raw, &clouds.raw)
            && Arc::ptr_eq(&self.clouds.tracks, &clouds.tracks);
        if !same {
            self.clouds = clouds.clone();
            self.clouds_version += 1;
        }
    }

    /// Whether a reading is drawn.
    pub fn shows_reading(&self, picked: Picked) -> bool {
        let (cloud, Picked { station, index }) = (&self.clouds.raw, picked);
        let shown = self.raw_shown.get(station).copied().unwrap_or(false);
        let colour = (self.colours.raw).get(cloud.ranges[station].start + index).filter(|_| shown);
        colour.is_some_and(|colour| self.shown_fates >> fate_of(*colour) & 1 == 1)
    }

    /// Goes through all points; to be called when analysis or colouring changed.
    pub fn colour(&mut self, deployment: &Deployment, analysis: &Analysis, colouring: Colouring) {
        self.colours = Colours::of(deployment, analysis, colouring);
        self.colours_version += 1;
    }
}
