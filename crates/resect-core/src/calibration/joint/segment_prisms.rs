//! The prisms that are followed in a segment of a drive.

use std::sync::Arc;

use super::state_vector::Layout;
use crate::network::{Number, Pair, PerStation, Prism};

/// The prisms that are followed in a segment.
///
/// Their places are those in the segment, from 0: a drive may have further prisms, which other segments have.
#[derive(Clone, Debug)]
pub struct SegmentPrisms {
    /// The place of the prism that each station follows; `None` for a station without readings of the segment's prisms.
    pub of_station: PerStation<Option<usize>>,
    /// Each pair of places, with the index of its distance among the pairs of the drive.
    pub pairs: Vec<(usize, (usize, usize))>,
    /// Their places among the prisms of the drive, in order.
    pub in_drive: Arc<[usize]>,
    of_drive: usize,
}

impl SegmentPrisms {
    /// The prisms of a segment: of those that the stations follow, those at some places of the drive, which are in order.
    pub fn new(layout: &Layout, followed: &PerStation<Prism>, in_drive: &[usize]) -> Self {
        let pair = |local: Pair| {
            let (a, b) = (local.first.index(), local.second.index());
            let of_drive = Pair::between(Prism::at(in_drive[a]), Prism::at(in_drive[b]))?;
            Some((of_drive.index(), (a, b)))
        };
        Self {
            of_station: followed.map(|prism| in_drive.binary_search(&layout.place_of(*prism)).ok()),
            pairs: (0..Pair::count(in_drive.len())).map(Pair::at).filter_map(pair).collect(),
            in_drive: in_drive.into(),
            of_drive: layout.prisms(),
        }
    }

    /// Number of prisms.
    pub fn count(&self) -> usize {
        self.in_drive.len()
    }

    /// Number of coordinates of a knot.
    pub fn coordinates(&self) -> usize {
        3 * self.count()
    }

    /// Returns true if the segment has all prisms of the drive.
    pub fn is_complete(&self) -> bool {
        self.count() == self.of_drive
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::{PrismChange, PrismSchedule, Station};

    #[test]
    fn places_are_those_in_the_segment_and_pairs_those_of_the_drive() {
        let prisms = |numbers: &[usize]| -> PerStation<Prism> {
            numbers.iter().map(|number| Prism::at(number - 1)).collect()
        };
        let change = PrismChange { time_s: 9.0, prism: Prism::at(3) };
        let schedule = PrismSchedule::new(prisms(&[1, 2, 4]), [(Station::at(1), change)]);
        let layout = Layout::of_schedule(&schedule);
        let all = SegmentPrisms::new(&layout, &prisms(&[1, 2, 4]), &[0, 1, 2]);
        assert_eq!(all.pairs, [(0, (0, 1)), (1, (0, 2)), (2, (1, 2))]);
        assert_eq!(all.of_station, PerStation::from([0, 1, 2].map(Some)));
        assert!(all.is_complete());
        // Prisms 1 and 4 are pair 1 of the drive.
        let some = SegmentPrisms::new(&layout, layout.followed_at(10.0), &[0, 2]);
        assert_eq!(some.pairs, [(1, (0, 1))]);
        assert_eq!(some.of_station, PerStation::from([0, 1, 1].map(Some)));
        assert_eq!((some.coordinates(), some.is_complete()), (6, false));
        // A station of its own.
        let alone = SegmentPrisms::new(&layout, layout.followed_at(0.0), &[1]);
        assert_eq!(alone.of_station, PerStation::from([None, Some(0), None]));
        assert!(alone.pairs.is_empty());
    }
}
