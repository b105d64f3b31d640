//! Visibility of the elements of a deployment in the scene and the plots.

use serde::{Deserialize, Serialize};

use resect_core::network::MOST_STATIONS;
use resect_core::pipeline::SampleFate;

/// Largest number of pairs of prisms.
const MOST_PAIRS: usize = MOST_STATIONS * (MOST_STATIONS - 1) / 2;

/// Visible elements of the scene and the plots.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Visibility {
    pub stations: [bool; MOST_STATIONS],
    pub raw: bool,
    /// Readings in the scene by fate, in the order of [`SampleFate::ALL`].
    pub fates: [bool; SampleFate::ALL.len()],
    pub tracks: bool,
    /// Tracks in the scene by prism.
    pub prisms: [bool; MOST_STATIONS],
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
    /// Ellipsoids of the estimated positions of the stations.
    pub station_ellipsoids: bool,
    /// Arrows at the stations along unobservable or weak directions.
    pub weak_directions: bool,
    /// Pairs of prisms in the plots.
    pub pairs: [bool; MOST_PAIRS],
}

impl Default for Visibility {
    fn default() -> Self {
        Self {
            stations: [true; MOST_STATIONS],
            raw: true,
            fates: [true; SampleFate::ALL.len()],
            tracks: true,
            prisms: [true; MOST_STATIONS],
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
            pairs: [true; MOST_PAIRS],
        }
    }
}

impl Visibility {
    /// Returns true if the track of a station that follows a prism is drawn in the scene.
    pub fn shows_track(&self, station: usize, prism: usize) -> bool {
        self.tracks && self.stations[station] && self.prisms[prism]
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

    /// Shows or hides the tracks of one of some prisms.
    pub fn with_prism_toggled(mut self, prism: usize, prisms: usize) -> Self {
        toggle(&mut self.tracks, &mut self.prisms[..prisms], prism);
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
fn toggle(all: &mut bool, each: &mut [bool], one: usize) {
    each.iter_mut().for_each(|on| *on &= *all);
    each[one] ^= true;
    *all = each.contains(&true);
    if !*all {
        each.fill(true);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_of_a_group_turns_its_switch_off_and_the_first_comes_back_alone() {
        let prisms = |visibility: &Visibility| visibility.prisms[..3].to_vec();
        let mut visibility = Visibility::default().with_prism_toggled(1, 3);
        assert_eq!((visibility.tracks, prisms(&visibility)), (true, vec![true, false, true]));
        visibility = visibility.with_prism_toggled(0, 3).with_prism_toggled(2, 3);
        assert_eq!((visibility.tracks, prisms(&visibility)), (false, vec![true; 3]));
        visibility = visibility.with_prism_toggled(1, 3);
        assert_eq!((visibility.tracks, prisms(&visibility)), (true, vec![false, true, false]));
        assert!(visibility.shows_track(0, 1) && !visibility.shows_track(1, 0));
    }

    #[test]
    fn what_an_older_session_did_not_know_is_shown() {
        let old: Visibility = toml::from_str(
            "raw = false\nstations = [true, false, true, true, true, true, true, true]",
        )
        .expect("read");
        let wanted = Visibility { raw: false, ..Visibility::default() }.with_station_toggled(1);
        assert_eq!(old, wanted);
    }
}
