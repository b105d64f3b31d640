//! How the scene is looked at.

use nalgebra::Vector3;

use super::flight::Flight;
use super::follow::Follow;
use super::{Camera, Frame, ViewPreset};

/// The camera, and where it is going.
#[derive(Default)]
pub struct View {
    pub camera: Camera,
    /// The way to look that is taken at the next frame.
    pub wanted: Option<ViewPreset>,
    pub last_look: Option<Look>,
    pub flight: Option<Flight>,
    pub follow: Follow,
}

/// What the camera was told to look at last. What is seen does not depend on which of two answers was drawn first, nor on
/// the size that the scene had by then: it looks again with the whole answer, and in another frame, until someone moves it.
#[derive(Clone, Copy)]
pub struct Look {
    pub preset: ViewPreset,
    /// The camera as the look left it.
    pub camera: Camera,
    pub frame: Frame,
    /// Whether the joint estimate was still to follow.
    pub early: bool,
}

impl View {
    /// Turns or moves the camera at the next frame.
    pub fn look(&mut self, preset: ViewPreset) {
        self.wanted = Some(preset);
    }

    /// Looks as it did the last time, unless the camera was moved since.
    pub fn look_again(&mut self, look: Look) {
        if look.camera == self.camera {
            self.wanted = self.wanted.or(Some(look.preset));
        }
    }

    /// Glides to a place (m, in station 1's frame), and closer to it if it is far away.
    pub fn fly_to(&mut self, position_m: &Vector3<f64>) {
        self.flight = Some(Flight::new(&self.camera, position_m.cast::<f32>()));
    }
}
