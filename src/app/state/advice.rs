//! Display of the subject of a finding.

use super::State;
use super::scene_state::ShownPoint;
use crate::app::model::{Pane, Picked};

impl State {
    /// Selects a time interval (s), shows it with a margin, and points the camera at station 1's reading there.
    pub(super) fn look_at_times(&mut self, span_s: [f64; 2]) {
        let room_s = 0.5 * (span_s[1] - span_s[0]);
        self.with_timeline(|timeline, _| {
            timeline.select(Some(span_s));
            timeline.show([span_s[0] - room_s, span_s[1] + room_s]);
            timeline.move_cursor(0.5 * (span_s[0] + span_s[1]));
        });
        self.workspace.layout.show(Pane::Residuals);
        self.workspace.layout.show(Pane::Scene);
        if let Some(open) = self.active() {
            let readings = &open.deployment.tracks[0].measurements;
            let index = readings.partition_point(|m| m.time_s < span_s[0]);
            self.fly_to(Picked { station: 0, index });
        }
    }

    /// Points the camera at a control point, at its position from the first station that measured it.
    pub(super) fn look_at_point(&mut self, file: &str, marker: i64) {
        let Some((open, analysis)) = self.analysed() else { return };
        let answer = analysis.answer.as_ref().ok();
        let placing =
            answer.and_then(|answer| answer.calibration.placing_control_points(&open.deployment));
        let sets = open.deployment.control_points.iter().filter(|set| set.file == file);
        let point = sets.flat_map(|set| &set.points).find(|point| point.marker == marker);
        let position_m = placing.zip(point).and_then(|(transforms, point)| {
            let (station, polar) =
                point.readings.iter().enumerate().find_map(|(k, read)| Some((k, (*read)?)))?;
            Some(transforms[station].apply(&polar.to_cartesian()))
        });
        let Some(position_m) = position_m else {
            self.toasts.error(&format!(
                "point {marker} of {file} cannot be shown in the scene: its position is not determined"
            ));
            return;
        };
        self.scene.visibility.control_points = true;
        self.workspace.layout.show(Pane::Scene);
        self.come_to(&position_m);
        self.scene.shown_point = Some(ShownPoint { file: file.to_owned(), marker, position_m });
    }
}
