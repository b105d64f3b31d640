//! Numbers of stations, prisms, and pairs of prisms.

use std::cmp::Ordering;
use std::fmt::{Display, Formatter, Result};

use serde::{Deserialize, Serialize};

/// Number of stations where no file names more, as in the paper.
pub const USUAL_STATIONS: usize = 3;

/// Largest number of stations, and of prisms.
pub const MOST_STATIONS: usize = 8;

/// A number that values are listed by.
pub trait Number: Copy {
    /// Returns the place in a list, from 0.
    fn index(self) -> usize;

    /// Returns the number at a place in a list.
    fn at(index: usize) -> Self;
}

/// A total station. People count from 1, lists from 0.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
#[serde(transparent)]
pub struct Station(u8);

/// A prism on the vehicle. People count from 1, lists from 0.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
#[serde(transparent)]
pub struct Prism(u8);

/// Two different numbers of a kind, the lower one first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PairOf<N> {
    pub first: N,
    pub second: N,
}

/// Two different prisms.
pub type Pair = PairOf<Prism>;

/// Two different stations, which may follow the same prism.
pub type StationPair = PairOf<Station>;

impl Station {
    /// The station whose frame is the reference.
    pub const FIRST: Self = Self(0);

    /// Returns the station that people call by this number, from 1.
    pub fn numbered(number: usize) -> Option<Self> {
        Some(Self(u8::try_from(number.checked_sub(1)?).ok()?))
    }

    /// Returns the number for people, from 1.
    pub fn number(self) -> usize {
        usize::from(self.0) + 1
    }

    /// Returns the place among the stations whose transforms are estimated; `None` for the reference.
    pub fn slot(self) -> Option<usize> {
        usize::from(self.0).checked_sub(1)
    }
}

impl Prism {
    /// Returns the number for people, from 1.
    pub fn number(self) -> usize {
        usize::from(self.0) + 1
    }
}

impl<N: Number> PairOf<N> {
    /// Returns the pair of two numbers in any order; `None` if they are equal.
    pub fn between(a: N, b: N) -> Option<Self> {
        match a.index().cmp(&b.index()) {
            Ordering::Less => Some(Self { first: a, second: b }),
            Ordering::Equal => None,
            Ordering::Greater => Some(Self { first: b, second: a }),
        }
    }

    /// Returns the pairs of some prisms or stations.
    pub fn among(numbers: usize) -> impl DoubleEndedIterator<Item = Self> + ExactSizeIterator {
        (0..Self::count(numbers)).map(Self::at)
    }

    /// Returns the places of both in a list, from 0.
    pub fn indices(self) -> [usize; 2] {
        [self.first.index(), self.second.index()]
    }

    /// Returns the number of pairs of some prisms or stations.
    pub fn count(numbers: usize) -> usize {
        numbers * numbers.saturating_sub(1) / 2
    }
}

impl<N: PartialEq> PairOf<N> {
    /// Returns true if a number is one of the two.
    pub fn contains(&self, number: &N) -> bool {
        self.first == *number || self.second == *number
    }
}

impl Pair {
    /// Returns the number of prisms that have this number of pairs; `None` if none has.
    pub fn prisms_of(pairs: usize) -> Option<usize> {
        (2..)
            .take_while(|prisms| Self::count(*prisms) <= pairs)
            .find(|prisms| Self::count(*prisms) == pairs)
    }
}

impl Number for Station {
    fn index(self) -> usize {
        usize::from(self.0)
    }

    fn at(index: usize) -> Self {
        Self(u8::try_from(index).expect("fewer than 256 stations"))
    }
}

impl Number for Prism {
    fn index(self) -> usize {
        usize::from(self.0)
    }

    fn at(index: usize) -> Self {
        Self(u8::try_from(index).expect("fewer than 256 prisms"))
    }
}

/// Pairs are in the order 12, 13, 23, 14, 24, 34, …, which does not depend on how many numbers there are.
impl<N: Number> Number for PairOf<N> {
    fn index(self) -> usize {
        Self::count(self.second.index()) + self.first.index()
    }

    fn at(index: usize) -> Self {
        let second = (1..).find(|second| Self::count(second + 1) > index).expect("a larger count");
        Self { first: N::at(index - Self::count(second)), second: N::at(second) }
    }
}

impl Display for Station {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> Result {
        self.number().fmt(formatter)
    }
}

impl Display for Prism {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> Result {
        self.number().fmt(formatter)
    }
}

/// "1–2", for people.
impl<N: Display> Display for PairOf<N> {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> Result {
        write!(formatter, "{}–{}", self.first, self.second)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_are_in_the_order_of_their_second_prism() {
        let labels: Vec<String> = (0..6).map(|index| Pair::at(index).to_string()).collect();
        assert_eq!(labels, ["1–2", "1–3", "2–3", "1–4", "2–4", "3–4"]);
        for index in 0..Pair::count(8) {
            let pair = Pair::at(index);
            assert_eq!(pair.index(), index);
            assert_eq!(Pair::between(pair.second, pair.first), Some(pair));
            assert_eq!(Pair::between(pair.first, pair.first), None);
        }
    }

    #[test]
    fn people_count_from_one() {
        let second = Station::numbered(2).expect("a station");
        assert_eq!((second.index(), second.number(), second.to_string()), (1, 2, "2".to_owned()));
        assert_eq!(
            (Station::numbered(0), Station::FIRST.slot(), second.slot()),
            (None, None, Some(0))
        );
    }
}
