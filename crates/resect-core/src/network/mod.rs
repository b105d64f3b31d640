//! Numbers of a network: stations, prisms and pairs of prisms, and values by each of them.
//!
//! A station number, a prism number and the index of a pair are different types, so that the compiler rejects one where another belongs.

mod number;
mod per;
mod prism_schedule;

pub use self::number::{
    MOST_STATIONS, Number, Pair, PairOf, Prism, Station, StationPair, USUAL_STATIONS,
};
pub use self::per::{Per, PerPair, PerPrism, PerStation, PerStationPair};
pub use self::prism_schedule::{PrismChange, PrismSchedule};
