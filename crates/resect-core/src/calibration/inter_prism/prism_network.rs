//! The network of method D: pairs of stations, and the distances between the prisms that they follow.

use nalgebra::Vector3;

use crate::calibration::joint::JointEstimate;
use crate::deployment::Rig;
use crate::network::{
    MOST_STATIONS, Number, Pair, PerPair, PerStation, Prism, Station, StationPair,
};

/// Number of unknowns of each station but the first: x, y, z, yaw.
pub const UNKNOWNS_PER_STATION: usize = 4;

/// Two stations with a known distance between the prisms that they follow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FollowedPair {
    pub stations: StationPair,
    /// The prisms that they follow; `None` if both follow the same one. Such a pair has the vector between its two positions as
    /// residual, because a distance has no derivative at zero.
    pub prisms: Option<Pair>,
    /// Distance between the prisms (m); zero if both follow the same one.
    pub distance_m: f64,
}

impl FollowedPair {
    /// Returns true if both stations follow the same prism.
    pub fn is_shared(&self) -> bool {
        self.prisms.is_none()
    }

    /// Returns the number of residuals of one triplet: a distance, or the three coordinates of a vector.
    pub fn residuals(&self) -> usize {
        if self.is_shared() { 3 } else { 1 }
    }
}

/// The stations, the prism that each one follows, and the pairs whose distances are observations.
///
/// The list of pairs has station 1 with every other station.
#[derive(Clone, Debug, PartialEq)]
pub struct PrismNetwork {
    pub prism_of_station: PerStation<Prism>,
    pub pairs: Vec<FollowedPair>,
}

impl PrismNetwork {
    /// Returns the network of all pairs of stations, with the distances between the prisms (m).
    pub fn new(prism_of_station: PerStation<Prism>, inter_prism_m: &PerPair<f64>) -> Self {
        assert!(prism_of_station.len() <= MOST_STATIONS, "more than {MOST_STATIONS} stations");
        let pairs = (0..StationPair::count(prism_of_station.len()))
            .map(|index| {
                let stations = StationPair::at(index);
                let [a, b] =
                    [stations.first, stations.second].map(|station| prism_of_station[station]);
                let prisms = Pair::between(a, b);
                let distance_m = prisms.map_or(0.0, |prisms| inter_prism_m[prisms]);
                FollowedPair { stations, prisms, distance_m }
            })
            .collect();
        Self { prism_of_station, pairs }
    }

    /// Returns the network of as many stations as prisms, each of which follows the prism with its number.
    pub fn of_own_prisms(inter_prism_m: impl Into<PerPair<f64>>) -> Self {
        let inter_prism_m = inter_prism_m.into();
        let is_enough = |prisms: &usize| Pair::count(*prisms) >= inter_prism_m.len();
        let prisms = (2..).find(is_enough).expect("a count of prisms");
        Self::new(PerStation::from_fn(prisms, |station| Prism::at(station.index())), &inter_prism_m)
    }

    /// Returns the same network with the distances of a joint estimate.
    pub fn with_estimates(&self, estimate: &JointEstimate) -> Self {
        let mut network = self.clone();
        for pair in &mut network.pairs {
            let estimated = pair.prisms.and_then(|prisms| estimate.distance_m(prisms));
            pair.distance_m = estimated.map_or(pair.distance_m, |distance| distance.value);
        }
        network
    }

    /// Returns the height of station 1's prism above that of each station (m), by the static station that measured the rig; `None`
    /// without a reading of the rig.
    pub fn height_differences_m(&self, rig: &Rig) -> Option<PerStation<f64>> {
        let prisms_m = rig.prisms_m.as_ref()?;
        let height_m = |prism: Prism| prisms_m[prism.index()].z;
        let first_m = height_m(self.prism_of_station[Station::FIRST]);
        Some(self.prism_of_station.map(|prism| first_m - height_m(*prism)))
    }

    /// Returns the number of stations.
    pub fn stations(&self) -> usize {
        self.prism_of_station.len()
    }

    /// Returns the stations whose poses are unknown: all but the first.
    pub fn unknown_stations(
        &self,
    ) -> impl DoubleEndedIterator<Item = Station> + ExactSizeIterator + use<> {
        (1..self.stations()).map(Station::at)
    }

    /// Returns the number of unknowns.
    pub fn unknowns(&self) -> usize {
        UNKNOWNS_PER_STATION * (self.stations() - 1)
    }

    /// Returns the number of residuals of one triplet.
    pub fn residuals(&self) -> usize {
        self.pairs.iter().map(FollowedPair::residuals).sum()
    }

    /// Returns the index in the list of a pair of two stations; `None` if its distance is no observation.
    pub fn index_of(&self, a: Station, b: Station) -> Option<usize> {
        let stations = StationPair::between(a, b)?;
        self.pairs.iter().position(|pair| pair.stations == stations)
    }

    /// Returns the distance of a station's prism from that of station 1 (m).
    pub fn from_station1_m(&self, station: Station) -> f64 {
        self.index_of(Station::FIRST, station).map_or(0.0, |index| self.pairs[index].distance_m)
    }

    /// Returns the pairs of different prisms, each one once.
    pub fn prism_pairs(&self) -> Vec<Pair> {
        let mut pairs: Vec<Pair> = self.pairs.iter().filter_map(|pair| pair.prisms).collect();
        pairs.sort_by_key(|pair| pair.index());
        pairs.dedup();
        pairs
    }

    /// Returns the errors of the distances of prisms at given positions by station (m, station 1's frame), one for each pair.
    pub fn errors_m(&self, placed_m: &[Vector3<f64>]) -> impl Iterator<Item = f64> {
        self.pairs.iter().map(|FollowedPair { stations, distance_m, .. }| {
            let [a, b] = [stations.first, stations.second].map(|station| placed_m[station.index()]);
            (a - b).norm() - distance_m
        })
    }
}

/// Returns the index of the first unknown of a station; `None` of station 1.
pub fn first_unknown(station: Station) -> Option<usize> {
    Some(UNKNOWNS_PER_STATION * station.slot()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_of_stations_have_the_distances_of_their_prisms() {
        // Stations 1 and 3 follow prism 1, station 2 follows prism 3, station 4 follows prism 2.
        let prisms = PerStation::from([0, 2, 0, 1].map(Prism::at));
        let network = PrismNetwork::new(prisms, &PerPair::from([1.2, 1.3, 2.3]));
        let distances_m: Vec<f64> = network.pairs.iter().map(|pair| pair.distance_m).collect();
        assert_eq!(distances_m, [1.3, 0.0, 1.3, 1.2, 2.3, 1.2]);
        assert_eq!((network.unknowns(), network.residuals()), (12, 8));
        assert_eq!(network.prism_pairs().len(), 3);
        assert!(network.pairs[1].is_shared());
        assert_eq!(PrismNetwork::of_own_prisms([1.0; 6]).stations(), 4);
    }
}
