//! The prisms that the stations follow, as files and users state them.

use serde::{Deserialize, Serialize};

use crate::network::{MOST_STATIONS, Number, PerStation, Prism, PrismChange, Station};

/// The prisms that the stations follow.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum FollowedPrisms {
    /// Their number: 1 (all stations follow one), or as many as there are stations (each its own).
    Count(u8),
    /// The number of the prism of each station, from 1.
    Each(PerStation<u8>),
}

impl FollowedPrisms {
    /// Returns the number of prisms that are followed.
    pub fn count(&self) -> u8 {
        match self {
            Self::Count(count) => *count,
            Self::Each(prisms) => (1..=MOST_STATIONS as u8)
                .filter(|prism| prisms.as_slice().contains(prism))
                .count() as u8,
        }
    }

    /// Returns the prism of a station; `None` if the station is not in the list.
    pub fn of_station(&self, station: Station) -> Option<Prism> {
        match self {
            Self::Count(1) => Some(Prism::default()),
            Self::Count(_) => Some(Prism::at(station.index())),
            Self::Each(prisms) => {
                Some(Prism::at(usize::from(*prisms.get(station)?).checked_sub(1)?))
            }
        }
    }

    /// Returns "3", or the prism of each station: "1 2 2".
    pub fn in_words(&self) -> String {
        match self {
            Self::Count(count) => count.to_string(),
            Self::Each(prisms) => prisms.map(ToString::to_string).as_slice().join(" "),
        }
    }

    pub(super) fn is_valid(&self) -> bool {
        let numbers = 1..=MOST_STATIONS as u8;
        match self {
            Self::Count(count) => numbers.contains(count),
            Self::Each(prisms) => {
                !prisms.is_empty() && prisms.iter().all(|prism| numbers.contains(prism))
            }
        }
    }
}

/// A station follows another prism from an instant on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StatedPrismChange {
    /// The station's number from 1, in the deployment's numbering.
    pub station: u8,
    /// The first stamp at which it follows the prism (s).
    pub time_s: f64,
    /// The prism's number from 1.
    pub prism: u8,
}

impl StatedPrismChange {
    /// Returns the station, and the change of its prism; `None` for a number that there is not.
    pub fn change(&self) -> Option<(Station, PrismChange)> {
        let station = Station::numbered(usize::from(self.station))?;
        let prism = Prism::at(usize::from(self.prism).checked_sub(1)?);
        Some((station, PrismChange { time_s: self.time_s, prism }))
    }

    /// Returns "station 2 to prism 3 at 12.5 s".
    pub(super) fn in_words(&self) -> String {
        format!("station {} to prism {} at {} s", self.station, self.prism, self.time_s)
    }
}
