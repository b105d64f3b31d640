//! Content of the scene, its camera, and the end of following the rig.

use nalgebra::Vector3;

use super::State;
use crate::app::model::{Picked, SceneCommand, ViewPreset};

impl State {
    pub(super) fn handle_scene(&mut self, command: SceneCommand) {
        use SceneCommand as Command;
        match command {
            Command::Show(visibility) => self.scene.visibility = visibility,
            Command::Colour(colouring) => self.scene.colouring = colouring,
            Command::SetOptions(options) => self.scene.options = options,
            Command::Measure(ruler) => self.scene.ruler = ruler,
            Command::Look(preset) => self.look(preset),
            Command::ComeTo(position_m) => self.come_to(&position_m),
            Command::ForgetPoint => self.scene.shown_point = None,
            Command::LookAtPoint { file, marker } => self.look_at_point(&file, marker),
        }
    }

    /// Applies a view preset. While the camera follows the rig, a direction only rotates it; fitting or a station's view
    /// ends the following.
    pub(super) fn look(&mut self, preset: ViewPreset) {
        self.scene.shown_point = None;
        use ViewPreset::{Fit, Front, Side, Slanted, Station, Top};
        match preset {
            Slanted | Top | Front | Side if self.scene.options.follow => {
                self.scene.view.camera.turn(preset);
            }
            Fit | Station(_) | Slanted | Top | Front | Side => {
                self.scene.options.follow = false;
                self.scene.view.look(preset);
            }
        }
    }

    /// Moves the camera smoothly to a position (m, station 1's frame), and stops following the rig.
    pub(super) fn come_to(&mut self, position_m: &Vector3<f64>) {
        self.scene.options.follow = false;
        self.scene.shown_point = None;
        self.scene.view.fly_to(position_m);
    }

    /// Moves the camera smoothly to a reading of the active deployment, if its position is known.
    pub(super) fn fly_to(&mut self, picked: Picked) {
        let Some((open, analysis)) = self.analysed() else { return };
        if let Some(position_m) = picked.place_m(&open.deployment, analysis) {
            self.come_to(&position_m);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_looks_elsewhere_ends_following_and_what_only_turns_does_not() {
        let ctx = egui::Context::default();
        let mut state = State::new(ctx.clone());
        let mut after = |command: SceneCommand| {
            state.scene.options.follow = true;
            let before = state.scene.view.camera;
            state.handle(command, &ctx);
            let camera = state.scene.view.camera;
            let turned = camera.pitch_rad != before.pitch_rad || camera.yaw_rad != before.yaw_rad;
            let stayed =
                camera.target_m == before.target_m && camera.distance_m == before.distance_m;
            assert!(stayed, "no frame was drawn yet");
            (state.scene.options.follow, turned, state.scene.view.wanted.take().is_some())
        };
        assert_eq!(after(SceneCommand::Look(ViewPreset::Top)), (true, true, false));
        assert_eq!(after(SceneCommand::Look(ViewPreset::Slanted)), (true, true, false));
        assert_eq!(after(SceneCommand::Look(ViewPreset::Fit)), (false, false, true));
        assert_eq!(after(SceneCommand::Look(ViewPreset::Station(1))), (false, false, true));
        assert_eq!(after(SceneCommand::ComeTo(Vector3::zeros())), (false, false, false));
    }
}
