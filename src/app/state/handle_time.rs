//! The time cursor, the selection, playback, and values over time.

use super::State;
use crate::app::model::{Pane, Picked, TimeCommand};

impl State {
    pub(super) fn handle_time(&mut self, command: TimeCommand) {
        use TimeCommand as Command;
        match command {
            Command::Hover(time_s) => self.time.hover_s = Some(time_s),
            Command::MoveCursor(time_s) => self.with_timeline(|timeline, _| {
                timeline.move_cursor(time_s);
            }),
            Command::StepCursor(steps) => self.step_cursor(steps),
            Command::ShowTimes(span_s) => self.with_timeline(|timeline, _| timeline.show(span_s)),
            Command::ShowAllTimes => self.with_timeline(|timeline, _| timeline.show_all()),
            Command::Select(span_s) => self.with_timeline(|timeline, _| timeline.select(span_s)),
            Command::ZoomToSelection => self.with_timeline(|timeline, _| {
                if let Some(span_s) = timeline.selection_s {
                    timeline.show(span_s);
                }
            }),
            Command::TogglePlay => {
                if let Some(open) = self.deployments.active_mut() {
                    self.time.playback.toggle(&mut open.timeline);
                }
            }
            Command::SetPlaySpeed(speed) => self.time.playback.speed = speed,
            Command::PickInScene(picked) => {
                // A layout without the pane Reading is not changed.
                if self.workspace.layout.holds(Pane::Reading) {
                    self.workspace.layout.show(Pane::Reading);
                }
                self.pick(picked);
            }
            Command::PickInPlot(picked) => {
                self.fly_to(picked);
                self.pick(picked);
            }
            Command::Unpick => self.with_timeline(|timeline, _| timeline.picked = None),
            Command::LookAtTimes(span_s) => self.look_at_times(span_s),
            Command::Plot(plots) => {
                self.time.plots = plots;
                self.workspace.layout.show(Pane::Channels);
            }
            Command::SaveChannelsDialog => self.save_channels(),
        }
    }

    fn pick(&mut self, picked: Picked) {
        self.with_timeline(|timeline, deployment| {
            if let Some(time_s) = picked.time_s(deployment) {
                timeline.picked = Some(picked);
                timeline.move_cursor(time_s);
                timeline.bring_into_view(time_s);
            }
        });
    }

    /// Moves the time cursor by this number of triplets, or of tenths of a second without triplets.
    fn step_cursor(&mut self, steps: i32) {
        let Some(open) = self.deployments.active_mut() else { return };
        let timeline = &mut open.timeline;
        let from_s = timeline.cursor_s.unwrap_or(timeline.whole_s[0]);
        let time_s = open.analysis.as_ref().map(|analysis| &analysis.triplets().time_s);
        let to_s = match time_s.filter(|time_s| !time_s.is_empty()) {
            Some(time_s) => {
                // The first triplet after the cursor, or the last before it, is one step away.
                let after = time_s.partition_point(|t| *t <= from_s) as i64;
                let before = time_s.partition_point(|t| *t < from_s) as i64;
                let steps = i64::from(steps);
                let index = if steps > 0 { after + steps - 1 } else { before + steps };
                time_s[index.clamp(0, time_s.len() as i64 - 1) as usize]
            }
            None => from_s + 0.1 * f64::from(steps),
        };
        timeline.move_cursor(to_s);
        timeline.bring_into_view(to_s);
    }
}
