//! The state vector of the joint estimate: which unknown has which index, by the network and the table of unknowns.

use std::ops::Range;

use nalgebra::{DMatrix, DVector, Vector3};

use super::unknown::{Effect, Owner, ReadingError, UNKNOWNS, Unknown};
use crate::geometry::LevelTransform;
use crate::network::{Number, Pair, Per, PerPrism, PerStation, Prism, PrismSchedule, Station};

/// Constants θ (m, rad, s, shares), and a matrix of constants by constants.
pub type Constants = DVector<f64>;
pub type ConstantsMatrix = DMatrix<f64>;
/// Slow states s of a block (m, rad, s).
pub type Slow = DVector<f64>;
/// Unknowns u of a block, or their gradient.
pub type BlockVector = DVector<f64>;

/// All unknowns: constants θ, slow states s of each block, and spline coefficients c of each segment.
#[derive(Clone, Debug)]
pub struct StateVector {
    pub constants: Constants,
    pub slow: Vec<Slow>,
    /// Coefficients of the splines by segment: x, y, z of each prism, knot by knot (m, station 1's frame).
    pub coefficients_m: Vec<Vec<f64>>,
}

/// The network, and the indices of its unknowns.
///
/// Slots are the places of stations 2, 3, … among those whose transforms are estimated.
#[derive(Clone, Debug)]
pub struct Layout {
    /// The prisms that the stations follow.
    followed: PrismSchedule,
    /// The prisms that are followed, by their numbers on the rig.
    prisms: PerPrism<Prism>,
    unknowns: Vec<PlacedUnknown>,
    /// Number of constants θ.
    pub constants: usize,
}

/// An unknown with its first index among the constants, the distance from owner to owner, and the number of owners.
#[derive(Clone, Copy, Debug)]
struct PlacedUnknown {
    unknown: &'static Unknown,
    first: usize,
    stride: usize,
    owners: usize,
}

impl Layout {
    /// The layout for stations that follow these prisms, with the usual unknowns.
    pub fn new(followed: &PerStation<Prism>) -> Self {
        Self::with_unknowns(&PrismSchedule::constant(followed.clone()), &UNKNOWNS)
    }

    /// The layout for stations that change their prisms, with the usual unknowns.
    pub fn of_schedule(followed: &PrismSchedule) -> Self {
        Self::with_unknowns(followed, &UNKNOWNS)
    }

    /// The layout with these unknowns.
    pub fn with_unknowns(followed: &PrismSchedule, table: &[&'static Unknown]) -> Self {
        let (prisms, followed) = (followed.prisms(), followed.clone());
        let owners = |owner: Owner| match owner {
            Owner::SetUp | Owner::Clock => followed.stations().saturating_sub(1),
            Owner::Station => followed.stations(),
            Owner::Pair => Pair::count(prisms.len()),
        };
        let (mut unknowns, mut constants) = (Vec::new(), 0);
        for group in table.chunk_by(|a, b| (a.owner, a.source) == (b.owner, b.source)) {
            let (stride, owners) = (group.len(), owners(group[0].owner));
            for (first, unknown) in (constants..).zip(group) {
                unknowns.push(PlacedUnknown { unknown, first, stride, owners });
            }
            constants += stride * owners;
        }
        Self { followed, prisms: prisms.into_iter().collect(), unknowns, constants }
    }

    pub fn stations(&self) -> usize {
        self.followed.stations()
    }

    /// Number of stations whose transforms are estimated.
    pub fn moved(&self) -> usize {
        self.stations().saturating_sub(1)
    }

    /// Number of prisms that are followed.
    pub fn prisms(&self) -> usize {
        self.prisms.len()
    }

    /// Number of pairs of these prisms.
    pub fn pairs(&self) -> usize {
        Pair::count(self.prisms())
    }

    /// Returns the prisms that the stations follow at an instant (s).
    pub fn followed_at(&self, time_s: f64) -> &PerStation<Prism> {
        self.followed.at(time_s)
    }

    /// Returns the instants from which a station follows another prism (s).
    pub fn prism_changes_s(&self) -> impl Iterator<Item = f64> {
        self.followed.changes_s()
    }

    /// Returns the followed prisms by their numbers on the rig, in order.
    pub fn followed_prisms(&self) -> impl Iterator<Item = Prism> {
        self.prisms.iter().copied()
    }

    /// Returns the place of a prism among those that are followed.
    pub fn place_of(&self, prism: Prism) -> usize {
        self.prisms.as_slice().partition_point(|other| *other < prism)
    }

    /// Returns a pair of followed prisms by their numbers on the rig.
    pub fn pair(&self, pair: Pair) -> Pair {
        Pair { first: self.prisms[pair.first], second: self.prisms[pair.second] }
    }

    /// Returns the indices of an unknown, by owner; empty if the table does not have it.
    pub fn indices(&self, unknown: &Unknown) -> impl Iterator<Item = usize> + use<> {
        let placed = self.unknowns.iter().find(|placed| std::ptr::eq(placed.unknown, unknown));
        let (first, stride, owners) =
            placed.map_or((0, 1, 0), |placed| (placed.first, placed.stride, placed.owners));
        (0..owners).map(move |owner| first + stride * owner)
    }

    /// Returns the index of an unknown of one owner.
    pub fn index(&self, unknown: &Unknown, owner: usize) -> usize {
        self.indices(unknown).nth(owner).expect("an owner of the network")
    }

    /// Returns the unknowns in the order of the table.
    pub fn unknowns(&self) -> impl Iterator<Item = &'static Unknown> {
        self.unknowns.iter().map(|placed| placed.unknown)
    }

    /// Returns each unknown with its owner and index.
    pub fn each(&self) -> impl Iterator<Item = (&'static Unknown, usize, usize)> {
        self.unknowns.iter().flat_map(|placed| {
            (0..placed.owners)
                .map(|owner| (placed.unknown, owner, placed.first + placed.stride * owner))
        })
    }

    /// Returns the unknowns of one station's instrument with their indices.
    pub fn of_instrument(
        &self,
        station: Station,
    ) -> impl Iterator<Item = (&'static Unknown, usize)> {
        let own = self.unknowns.iter().filter(|placed| placed.unknown.is_of_instrument());
        own.map(move |placed| (placed.unknown, placed.first + placed.stride * station.index()))
    }

    /// Returns the unknowns that displace readings of a station, with their indices.
    pub fn reading_errors(&self, station: Station) -> impl Iterator<Item = (ReadingError, usize)> {
        self.of_instrument(station).filter_map(|(unknown, index)| match unknown.effect {
            Effect::Reading(error) => Some((error, index)),
            _ => None,
        })
    }

    /// Returns the indices of the errors that a survey has of its own.
    pub fn of_pointing(&self) -> Vec<usize> {
        let is_own = |unknown: &Unknown| {
            matches!(unknown.effect, Effect::Reading(ReadingError { is_of_pointing: true, .. }))
        };
        self.each().filter(|(unknown, ..)| is_own(unknown)).map(|(.., index)| index).collect()
    }

    /// Returns the indices of unknowns that readings of points at rest do not depend on.
    pub fn of_motion(&self) -> Vec<usize> {
        let is_of_motion = |unknown: &Unknown| {
            use Effect::{ClockDrift, ClockOffset, Distance, Latency};
            matches!(unknown.effect, ClockOffset | ClockDrift | Latency | Distance)
        };
        self.each().filter(|(unknown, ..)| is_of_motion(unknown)).map(|(.., index)| index).collect()
    }

    /// Returns the sources of σ among the constants, with their indices.
    pub fn sources(&self) -> impl Iterator<Item = (&'static str, Range<usize>)> {
        let groups = self.unknowns.chunk_by(|a, b| a.unknown.source == b.unknown.source);
        groups.map(|group| {
            let (first, last) = (group[0], group[group.len() - 1]);
            (first.unknown.source, first.first..first.first + last.stride * last.owners)
        })
    }

    /// Returns the owner of an unknown for people: "2", or "1–2" for a pair.
    pub fn owner_in_words(&self, unknown: &Unknown, owner: usize) -> String {
        match unknown.owner {
            Owner::SetUp | Owner::Clock => (owner + 2).to_string(),
            Owner::Station => (owner + 1).to_string(),
            Owner::Pair => self.pair(Pair::at(owner)).to_string(),
        }
    }

    /// Number of constants that are poses: (x, y, z, yaw) of each slot, from the first constant on.
    pub fn poses(&self) -> usize {
        4 * self.moved()
    }

    /// Places of the heights among the poses.
    pub fn heights(&self) -> Vec<usize> {
        (0..self.moved()).map(|slot| 4 * slot + 2).collect()
    }

    /// Number of slow states s of a block: changes of (x, y, z, yaw) by slot, of clocks by slot, errors of the ranges by station, errors
    /// across the sight and upward by station.
    pub fn slow(&self) -> usize {
        self.slow_across() + 2 * self.stations()
    }

    pub fn slow_clocks(&self) -> usize {
        4 * self.moved()
    }

    pub fn slow_ranges(&self) -> usize {
        5 * self.moved()
    }

    pub fn slow_across(&self) -> usize {
        self.slow_ranges() + self.stations()
    }

    /// Number of unknowns u of a block: shifts by slot (m, station 1's frame), clock offsets by slot (s), latencies by station (s),
    /// distances by pair (m).
    pub fn block(&self) -> usize {
        self.block_distances() + self.pairs()
    }

    pub fn block_clocks(&self) -> usize {
        3 * self.moved()
    }

    pub fn block_latencies(&self) -> usize {
        4 * self.moved()
    }

    pub fn block_distances(&self) -> usize {
        self.block_latencies() + self.stations()
    }
}

/// Transforms by poses (x, y, z, yaw; m, rad) of stations 2, 3, ….
pub fn level_transforms(poses: &DVector<f64>) -> PerStation<LevelTransform> {
    let level = |slot: usize| {
        let pose = poses.fixed_rows::<4>(4 * slot);
        LevelTransform::new(Vector3::new(pose[0], pose[1], pose[2]), pose[3])
    };
    by_station(LevelTransform::IDENTITY, (0..poses.len() / 4).map(level))
}

/// Returns one value for each station: that of the reference, then those by slot.
pub fn by_station<T>(reference: T, by_slot: impl IntoIterator<Item = T>) -> PerStation<T> {
    std::iter::once(reference).chain(by_slot).collect::<Per<Station, T>>()
}

#[cfg(test)]
pub mod tests {
    use std::sync::Arc;

    use super::super::unknown::{DISTANCE, LATENCY, LEAN_Y};
    use super::*;

    /// The layout of stations that each follow a prism of their own.
    pub fn layout(stations: usize) -> Arc<Layout> {
        let own = |station: Station| Prism::at(station.index());
        Arc::new(Layout::new(&PerStation::from_fn(stations, own)))
    }

    #[test]
    fn every_index_belongs_to_one_unknown_of_one_owner() {
        for stations in 1..=8 {
            let layout = layout(stations);
            let mut indices: Vec<usize> = layout.each().map(|(.., index)| index).collect();
            indices.sort_unstable();
            assert_eq!(indices, (0..layout.constants).collect::<Vec<usize>>());
        }
        let layout = layout(3);
        let sizes = [layout.constants, layout.slow(), layout.block()];
        assert_eq!(sizes, [42, 19, 14]);
        assert_eq!(layout.indices(&LEAN_Y).collect::<Vec<usize>>(), [34, 36, 38]);
    }

    #[test]
    fn stations_may_share_prisms() {
        let prism = |number: usize| Prism::at(number - 1);
        let layout = Layout::new(&[prism(1), prism(3), prism(1), prism(3)].into());
        assert_eq!((layout.prisms(), layout.pairs(), layout.indices(&DISTANCE).count()), (2, 1, 1));
        assert_eq!(layout.owner_in_words(&DISTANCE, 0), "1–3");
        assert_eq!(layout.place_of(Prism::at(2)), 1);
        assert_eq!(layout.indices(&LATENCY).count(), 4);
    }
}
