//! View of the scene.

use nalgebra::Vector3;

use super::flight::Flight;
use super::follow::Follow;
use super::{Camera, Frame, ViewPreset};

/// The camera and its motion.
#[derive(Clone, Default)]
pub struct View {
    pub camera: Camera,
    /// View preset to apply in the next frame.
    pub wanted: Option<ViewPreset>,
    pub last_look: Option<Look>,
    pub flight: Option<Flight>,
    pub follow: Follow,
}

/// The last view preset and the camera that it gave.
///
/// The preset is applied again for the complete result and for another frame until the user moves the camera. The view then
/// depends neither on the order of two results nor on the size of the scene at the time.
#[derive(Clone, Copy)]
pub struct Look {
    pub preset: ViewPreset,
    /// The camera after the preset was applied.
    pub camera: Camera,
    pub frame: Frame,
    /// True if the joint estimate was not computed yet.
    pub early: bool,
}

impl View {
    /// Applies a view preset in the next frame.
    pub fn look(&mut self, preset: ViewPreset) {
        self.wanted = Some(preset);
    }

    /// Applies the last preset again, unless the camera was moved since.
    pub fn look_again(&mut self, look: Look) {
        if look.camera == self.camera {
            self.wanted = self.wanted.or(Some(look.preset));
        }
    }

    /// Moves the camera smoothly to a position (m, station 1's frame), and closer to it if it is far away.
    pub fn fly_to(&mut self, position_m: &Vector3<f64>) {
        self.flight = Some(Flight::new(&self.camera, position_m.cast::<f32>()));
    }
}
