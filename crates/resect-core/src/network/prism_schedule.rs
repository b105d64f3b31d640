//! The prisms that the stations follow over time.

use super::{Number, PerPrism, PerStation, Prism, Station};

/// The prisms that the stations follow: the same all the time, or others from some instants on.
#[derive(Clone, Debug, PartialEq)]
pub struct PrismSchedule {
    first: PerStation<Prism>,
    /// Instants (s) in increasing order, and the prisms from there on.
    changes: Vec<(f64, PerStation<Prism>)>,
}

/// A station follows another prism from an instant on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrismChange {
    /// As stamped (s).
    pub time_s: f64,
    pub prism: Prism,
}

impl PrismSchedule {
    pub fn constant(followed: PerStation<Prism>) -> Self {
        Self { first: followed, changes: Vec::new() }
    }

    /// The schedule of stations that begin with some prisms, and change them.
    pub fn new(
        first: PerStation<Prism>,
        changes: impl IntoIterator<Item = (Station, PrismChange)>,
    ) -> Self {
        let mut ordered: Vec<_> = changes.into_iter().collect();
        ordered.sort_by(|(_, a), (_, b)| a.time_s.total_cmp(&b.time_s));
        let mut schedule = Self::constant(first);
        for (station, PrismChange { time_s, prism }) in ordered {
            let mut followed = schedule.at(time_s).clone();
            followed[station] = prism;
            schedule.changes.push((time_s, followed));
        }
        schedule
    }

    pub fn stations(&self) -> usize {
        self.first.len()
    }

    pub fn is_constant(&self) -> bool {
        self.changes.is_empty()
    }

    /// Returns the prisms of the stations at an instant (s).
    pub fn at(&self, time_s: f64) -> &PerStation<Prism> {
        let last = self.changes.iter().rfind(|(from_s, _)| *from_s <= time_s);
        last.map_or(&self.first, |(_, followed)| followed)
    }

    /// Returns the instants of the changes (s), in order.
    pub fn changes_s(&self) -> impl Iterator<Item = f64> {
        self.changes.iter().map(|(time_s, _)| *time_s)
    }

    /// Returns all prisms that are followed at some time, in order.
    pub fn prisms(&self) -> PerPrism<Prism> {
        let changed = self.changes.iter().map(|(_, followed)| followed);
        let mut prisms: Vec<Prism> =
            std::iter::once(&self.first).chain(changed).flatten().copied().collect();
        prisms.sort_unstable_by_key(|prism| prism.index());
        prisms.dedup();
        prisms.into_iter().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stations_change_their_prisms_in_any_order_of_the_list() {
        let prisms = |numbers: [usize; 3]| PerStation::from(numbers.map(Prism::at));
        let change = |station: usize, time_s: f64, prism: usize| {
            (Station::at(station), PrismChange { time_s, prism: Prism::at(prism) })
        };
        let changes = [change(2, 20.0, 4), change(1, 10.0, 2), change(1, 30.0, 1)];
        let schedule = PrismSchedule::new(prisms([0, 1, 2]), changes);
        let at = |time_s: f64| schedule.at(time_s).clone();
        assert_eq!(at(9.9), prisms([0, 1, 2]));
        assert_eq!(at(10.0), prisms([0, 2, 2]));
        assert_eq!(at(25.0), prisms([0, 2, 4]));
        assert_eq!(at(1e9), prisms([0, 1, 4]));
        let all: Vec<usize> = schedule.prisms().iter().map(|prism| prism.index()).collect();
        assert_eq!(all, [0, 1, 2, 4]);
    }
}
