//! Time in all panes of a deployment: cursor, window, selection, and playback.
//!
//! Times are in seconds of the stations' clock; plots count from the first measurement.

use nalgebra::Vector3;

use crate::app::prepared::placing::placed_tracks;
use resect_core::analysis::Analysis;
use resect_core::deployment::Deployment;

/// A raw reading of a deployment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Picked {
    /// The station, 0 to 2.
    pub station: usize,
    /// Index of the reading in the station's track.
    pub index: usize,
}

impl Picked {
    /// Returns the time of the measurement (s); `None` if there is no such reading.
    pub fn time_s(&self, deployment: &Deployment) -> Option<f64> {
        let track = deployment.tracks.as_slice().get(self.station)?;
        track.measurements.get(self.index).map(|reading| reading.time_s)
    }

    /// Returns the position (m, station 1's frame); `None` if there is no such reading, or its station has no pose.
    pub fn place_m(&self, deployment: &Deployment, analysis: &Analysis) -> Option<Vector3<f64>> {
        let track = deployment.tracks.as_slice().get(self.station)?;
        let position_m = track.position_m(track.measurements.get(self.index)?);
        Some(placed_tracks(deployment, analysis)[self.station]?.apply(&position_m))
    }
}

/// Time cursor, window and selection of a deployment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timeline {
    /// Times of the first and the last measurement (s).
    pub whole_s: [f64; 2],
    /// Time window of the plots (s).
    pub window_s: [f64; 2],
    pub cursor_s: Option<f64>,
    pub selection_s: Option<[f64; 2]>,
    pub picked: Option<Picked>,
}

/// Shortest time window of the plots (s); readings come a few times a second.
const SHORTEST_WINDOW_S: f64 = 0.05;
/// Largest difference of equal times (s). Stamps decades after 1970 are rounded to a quarter of it.
const SAME_S: f64 = 1e-6;

impl Timeline {
    pub fn new(deployment: &Deployment) -> Self {
        let start_s = deployment.start_s().unwrap_or(0.0);
        let end_s = deployment.end_s().unwrap_or(start_s).max(start_s + 1.0);
        let whole_s = [start_s, end_s];
        Self { whole_s, window_s: whole_s, cursor_s: None, selection_s: None, picked: None }
    }

    /// Extends the time range to new readings. A window on the whole drive grows with it; any other does not change.
    pub fn grow(&mut self, deployment: &Deployment) {
        let new = Self::new(deployment);
        if self.window_s == self.whole_s {
            self.window_s = new.window_s;
        }
        self.whole_s = new.whole_s;
        // Late readings shift the indices of the others.
        self.picked = None;
    }

    /// Moves the cursor, clamped to the deployment.
    pub fn move_cursor(&mut self, time_s: f64) {
        if time_s.is_finite() {
            self.cursor_s = Some(time_s.clamp(self.whole_s[0], self.whole_s[1]));
        }
    }

    /// Sets the window from two ends in any order. It may extend a little beyond the measurements.
    pub fn show(&mut self, [a, b]: [f64; 2]) {
        if !(a.is_finite() && b.is_finite()) {
            return;
        }
        let margin_s = 0.5 * (self.whole_s[1] - self.whole_s[0]);
        let [from, to] = [self.whole_s[0] - margin_s, self.whole_s[1] + margin_s];
        let length_s = (b - a).abs().clamp(SHORTEST_WINDOW_S, to - from);
        // Rounding may leave slightly too little room, at which `clamp` would panic.
        let start_s = a.min(b).min(to - length_s).max(from);
        let window_s = [start_s, start_s + length_s];
        // Rounding errors must not turn the whole drive into a section, which would be saved as one.
        let is_all = (0..2).all(|end| (window_s[end] - self.whole_s[end]).abs() < SAME_S);
        self.window_s = if is_all { self.whole_s } else { window_s };
    }

    pub fn show_all(&mut self) {
        self.window_s = self.whole_s;
    }

    /// Moves the window, without changing its length, so that it contains a time.
    pub fn bring_into_view(&mut self, time_s: f64) {
        let [start_s, end_s] = self.window_s;
        if !(start_s..=end_s).contains(&time_s) {
            let half_s = (end_s - start_s) / 2.0;
            self.show([time_s - half_s, time_s + half_s]);
        }
    }

    /// Selects the interval between two ends in any order; clears the selection if none of it lies within the deployment.
    pub fn select(&mut self, span_s: Option<[f64; 2]>) {
        let finite = span_s.filter(|span_s| span_s.iter().all(|t| t.is_finite()));
        self.selection_s = finite
            .map(|[a, b]| [a.min(b), a.max(b)].map(|t| t.clamp(self.whole_s[0], self.whole_s[1])))
            .filter(|[from_s, to_s]| from_s < to_s);
    }
}

/// Automatic motion of the cursor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Playback {
    pub playing: bool,
    /// Speed, in seconds of the drive per second.
    pub speed: f64,
    /// Time of the last frame (s of the window's clock) while playing.
    last_frame_s: Option<f64>,
}

impl Default for Playback {
    fn default() -> Self {
        Self { playing: false, speed: 4.0, last_frame_s: None }
    }
}

impl Playback {
    /// Speeds that are offered.
    pub const SPEEDS: [f64; 7] = [0.25, 0.5, 1.0, 2.0, 4.0, 10.0, 40.0];

    /// Starts or stops the playback. From the end it restarts at the beginning of the played interval.
    pub fn toggle(&mut self, timeline: &mut Timeline) {
        self.playing = !self.playing;
        self.last_frame_s = None;
        let [start_s, end_s] = span(timeline);
        if self.playing && timeline.cursor_s.is_none_or(|t| t >= end_s || t < start_s) {
            timeline.move_cursor(start_s);
        }
    }

    /// Advances the cursor, and stops at the end of the selection or the window.
    pub fn advance(&mut self, timeline: &mut Timeline, now_s: f64) {
        if !self.playing {
            return;
        }
        // A slow frame must not make the cursor jump.
        let elapsed_s = self.last_frame_s.map_or(0.0, |last| (now_s - last).clamp(0.0, 0.25));
        self.last_frame_s = Some(now_s);
        let [start_s, end_s] = span(timeline);
        let next_s = timeline.cursor_s.unwrap_or(start_s) + self.speed * elapsed_s;
        timeline.move_cursor(next_s.min(end_s));
        if next_s >= end_s {
            self.playing = false;
            self.last_frame_s = None;
        }
    }
}

/// Returns the played interval (s): the selection, or the window clipped to the drive.
fn span(timeline: &Timeline) -> [f64; 2] {
    let [start_s, end_s] = timeline.whole_s;
    timeline.selection_s.unwrap_or(timeline.window_s).map(|t| t.clamp(start_s, end_s))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_selection_has_a_length_within_the_deployment() {
        let whole_s = [1000.0, 1100.0];
        let mut timeline = Timeline {
            whole_s,
            window_s: whole_s,
            cursor_s: None,
            selection_s: None,
            picked: None,
        };
        let mut selected = |span_s| {
            timeline.select(Some(span_s));
            timeline.selection_s
        };
        assert_eq!(selected([1030.0, 1020.0]), Some([1020.0, 1030.0]));
        assert_eq!(selected([900.0, 1030.0]), Some([1000.0, 1030.0]));
        for nothing in [[1020.0, 1020.0], [900.0, 1000.0], [-1e300, 1000.0], [1020.0, f64::NAN]] {
            assert_eq!(selected(nothing), None, "{nothing:?}");
        }
    }

    fn timeline() -> Timeline {
        let whole_s = [1000.0, 1100.0];
        Timeline { whole_s, window_s: whole_s, cursor_s: None, selection_s: None, picked: None }
    }

    #[test]
    fn what_is_shown_stays_near_the_drive_and_never_vanishes() {
        let mut timeline = timeline();
        timeline.show([1050.0, 1040.0]);
        assert_eq!(timeline.window_s, [1040.0, 1050.0]);
        timeline.show([1020.0, 1020.0]);
        assert!(timeline.window_s[1] > timeline.window_s[0]);
        timeline.show([-1e9, 1e9]);
        assert_eq!(timeline.window_s, [950.0, 1150.0]);
        timeline.show([f64::NAN, 1.0]);
        assert_eq!(timeline.window_s, [950.0, 1150.0]);
        timeline.show([5000.0, 5010.0]);
        assert_eq!(timeline.window_s, [1140.0, 1150.0]);
    }

    #[test]
    fn the_whole_drive_but_for_rounding_is_the_whole() {
        let whole_s = [1_760_000_000.028_027, 1_760_000_420.936_687_5];
        let mut timeline = Timeline { whole_s, ..timeline() };
        timeline.show([whole_s[0] + 3e-7, whole_s[1] - 3e-7]);
        assert_eq!(timeline.window_s, whole_s);
        timeline.show([whole_s[0] + 1e-3, whole_s[1]]);
        assert_ne!(timeline.window_s, whole_s);
    }

    #[test]
    fn all_that_there_is_can_be_shown_whatever_the_stamps() {
        let mut stamps = vec![[0.0, 1_760_000_419.6], [0.1, 0.2], [-1e11, 1e11]];
        stamps.extend((1..2000).map(|i| [0.37 * f64::from(i), 1.7 * f64::from(i) + 1.3]));
        for whole_s in stamps {
            let mut timeline = Timeline { whole_s, ..timeline() };
            timeline.show([-1e12, 1e12]);
            let [from_s, to_s] = timeline.window_s;
            assert!(from_s <= whole_s[0] && to_s >= whole_s[1], "{whole_s:?}");
        }
    }

    #[test]
    fn an_instant_out_of_sight_is_brought_into_the_middle() {
        let mut timeline = timeline();
        timeline.show([1010.0, 1020.0]);
        timeline.bring_into_view(1015.0);
        assert_eq!(timeline.window_s, [1010.0, 1020.0]);
        timeline.bring_into_view(1080.0);
        assert_eq!(timeline.window_s, [1075.0, 1085.0]);
    }

    #[test]
    fn playing_follows_the_clock_and_stops_at_the_end_of_the_selection() {
        let (mut timeline, mut playback) =
            (timeline(), Playback { speed: 10.0, ..Default::default() });
        timeline.select(Some([1030.0, 1020.0]));
        playback.toggle(&mut timeline);
        for frame in 0..=5 {
            playback.advance(&mut timeline, 7.0 + 0.1 * f64::from(frame));
        }
        let cursor_s = timeline.cursor_s.expect("playing sets it");
        assert!((cursor_s - 1025.0).abs() < 1e-9, "{cursor_s}");
        // A pause of ten seconds must not become a jump of a hundred.
        playback.advance(&mut timeline, 17.5);
        assert!((timeline.cursor_s.expect("set") - 1027.5).abs() < 1e-9);
        for frame in 0..10 {
            playback.advance(&mut timeline, 17.6 + 0.1 * f64::from(frame));
        }
        assert_eq!((timeline.cursor_s, playback.playing), (Some(1030.0), false));
        playback.toggle(&mut timeline);
        assert_eq!(timeline.cursor_s, Some(1020.0));
    }
}
