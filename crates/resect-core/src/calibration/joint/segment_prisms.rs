//! The prisms that are followed in a segment of a drive.

use super::state_vector::Layout;
use crate::network::{Number, Pair, PerStation, Prism, Station};

/// The prisms that are followed in a segment.
///
/// Their places are those in the segment, from 0: a drive may have further prisms, which other segments have.
#[derive(Clone, Debug)]
pub struct SegmentPrisms {
    /// The place of the prism that each station follows.
    pub of_station: PerStation<usize>,
    /// Each pair of places, with the index of its distance among the pairs of the drive.
    pub pairs: Vec<(usize, (usize, usize))>,
    prisms: usize,
    of_drive: usize,
}

impl SegmentPrisms {
    /// The prisms of a segment in which the stations follow these.
    pub fn new(layout: &Layout, followed: &PerStation<Prism>) -> Self {
        let in_drive = followed.map(|prism| layout.place_of(*prism));
        let mut prisms: Vec<usize> = in_drive.iter().copied().collect();
        prisms.sort_unstable();
        prisms.dedup();
        let pair = |local: Pair| {
            let (a, b) = (local.first.index(), local.second.index());
            let of_drive = Pair::between(Prism::at(prisms[a]), Prism::at(prisms[b]))?;
            Some((of_drive.index(), (a, b)))
        };
        Self {
            of_station: in_drive.map(|place| prisms.partition_point(|other| other < place)),
            pairs: (0..Pair::count(prisms.len())).map(Pair::at).filter_map(pair).collect(),
            prisms: prisms.len(),
            of_drive: layout.prisms(),
        }
    }

    /// Number of prisms.
    pub fn count(&self) -> usize {
        self.prisms
    }

    /// Returns the first station that follows a prism.
    pub fn follower(&self, prism: usize) -> Option<Station> {
        self.of_station.each().find(|(_, followed)| **followed == prism).map(|(own, _)| own)
    }

    /// Number of coordinates of a knot.
    pub fn coordinates(&self) -> usize {
        3 * self.prisms
    }

    /// Returns true if the segment has all prisms of the drive.
    pub fn is_complete(&self) -> bool {
        self.prisms == self.of_drive
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::{PrismChange, PrismSchedule};

    #[test]
    fn places_are_those_in_the_segment_and_pairs_those_of_the_drive() {
        let prisms = |numbers: &[usize]| -> PerStation<Prism> {
            numbers.iter().map(|number| Prism::at(number - 1)).collect()
        };
        let change = PrismChange { time_s: 9.0, prism: Prism::at(3) };
        let schedule = PrismSchedule::new(prisms(&[1, 2, 4]), [(Station::at(1), change)]);
        let layout = Layout::of_schedule(&schedule);
        let all = SegmentPrisms::new(&layout, &prisms(&[1, 2, 4]));
        assert_eq!(all.pairs, [(0, (0, 1)), (1, (0, 2)), (2, (1, 2))]);
        assert_eq!(all.of_station, PerStation::from([0, 1, 2]));
        assert!(all.is_complete());
        // Prisms 1 and 4 are pair 1 of the drive.
        let some = SegmentPrisms::new(&layout, layout.followed_at(10.0));
        assert_eq!(some.pairs, [(1, (0, 1))]);
        assert_eq!(some.of_station, PerStation::from([0, 1, 1]));
        assert_eq!((some.coordinates(), some.is_complete()), (6, false));
    }
}
