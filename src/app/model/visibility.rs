//! Visibility of the elements of a deployment in the scene and the plots.

use serde::{Deserialize, Serialize};

use resect_core::pipeline::SampleFate;

/// Visible elements of the scene and the plots.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Visibility {
    pub stations: [bool; 3],
    pub raw: bool,
    /// Readings in the scene by fate, in the order of [`SampleFate::ALL`].
    pub fates: [bool; SampleFate::ALL.len()],
    pub tracks: bool,
    /// Tracks in the scene by prism.
    pub prisms: [bool; 3],
    pub control_points: bool,
    /// Arrows at the control points: the residual of each station.
    pub residuals: bool,
    /// The vehicle's frame along the track.
    pub poses: bool,
    /// Tube about the vehicle's trajectory: its uncertainty.
    pub tube: bool,
    /// Trajectories of the vehicle in other open runs.
    pub runs_beside: bool,
    /// Estimated trajectories of other systems.
    pub estimates: bool,
    /// Standard deviations of the interpolation: ellipsoids in the scene, bands in the plot.
    pub uncertainty: bool,
    /// Ellipsoids of the estimated positions of stations 2 and 3.
    pub station_ellipsoids: bool,
    /// Arrows at stations 2 and 3 along unobservable or weak directions.
    pub weak_directions: bool,
    /// Pairs of prisms in the plots.
    pub pairs: [bool; 3],
}

impl Default for Visibility {
    fn default() -> Self {
        Self {
            stations: [true; 3],
            raw: true,
            fates: [true; SampleFate::ALL.len()],
            tracks: true,
            prisms: [true; 3],
            control_points: true,
            residuals: true,
            poses: true,
            // Computed only on request.
            tube: false,
            runs_beside: false,
            estimates: true,
            uncertainty: true,
            station_ellipsoids: true,
            weak_directions: true,
            pairs: [true; 3],
        }
    }
}

impl Visibility {
    /// Returns true if a station's track is drawn in the scene.
    pub fn shows_track(&self, station: usize) -> bool {
        self.tracks && self.stations[station] && self.prisms[station]
    }

    /// Returns true if readings of a fate, by its index in [`SampleFate::ALL`], are drawn in the scene.
    pub fn shows_fate(&self, fate: usize) -> bool {
        self.raw && self.fates[fate]
    }

    pub fn with_station_toggled(mut self, station: usize) -> Self {
        self.stations[station] ^= true;
        self
    }

    /// Shows or hides the readings of a fate.
    pub fn with_fate_toggled(mut self, fate: usize) -> Self {
        toggle(&mut self.raw, &mut self.fates, fate);
        self
    }

    /// Shows or hides the track of a prism.
    pub fn with_prism_toggled(mut self, prism: usize) -> Self {
        toggle(&mut self.tracks, &mut self.prisms, prism);
        self
    }

    /// Shows everything in the scene, but keeps the pairs of the plots and the layers that are computed on request.
    pub fn with_the_whole_scene(self) -> Self {
        let Self { pairs, tube, runs_beside, .. } = self;
        Self { pairs, tube, runs_beside, ..Self::default() }
    }
}

/// Toggles one member of a group that has a switch of its own.
///
/// With the group off, only that member becomes visible. Hiding the last member turns the group off, so that its switch can
/// show all again.
fn toggle<const COUNT: usize>(all: &mut bool, each: &mut [bool; COUNT], one: usize) {
    let mut seen = each.map(|on| on && *all);
    seen[one] ^= true;
    *all = seen.contains(&true);
    *each = if *all { seen } else { [true; COUNT] };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_of_a_group_turns_its_switch_off_and_the_first_comes_back_alone() {
        let mut visibility = Visibility::default().with_prism_toggled(1);
        assert_eq!((visibility.tracks, visibility.prisms), (true, [true, false, true]));
        visibility = visibility.with_prism_toggled(0).with_prism_toggled(2);
        assert_eq!((visibility.tracks, visibility.prisms), (false, [true; 3]));
        visibility = visibility.with_prism_toggled(1);
        assert_eq!((visibility.tracks, visibility.prisms), (true, [false, true, false]));
        assert!(visibility.shows_track(1) && !visibility.shows_track(0));
    }

    #[test]
    fn what_an_older_session_did_not_know_is_shown() {
        let old: Visibility =
            toml::from_str("raw = false\nstations = [true, false, true]").expect("read");
        let wanted = Visibility { raw: false, ..Visibility::default() }.with_station_toggled(1);
        assert_eq!(old, wanted);
    }
}
