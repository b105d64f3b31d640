//! Possible misreadings of sense, station numbers and units, and corrections of the data for each.

use crate::geometry::FOOT_M;
use crate::network::{MOST_STATIONS, Number, PerStation, StationPair};
use nalgebra::Vector3;

use crate::deployment::{AzimuthSense, ControlPointSet, Deployment, Measurement, Overrides};
use crate::pipeline::Triplets;

/// One mistake in the interpretation of readings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Misreading {
    /// Azimuths are counter-clockwise: of all stations, or of one (from 0).
    Azimuth(Option<usize>),
    /// Ranges are in feet: of all stations, or of one (from 0).
    Feet(Option<usize>),
    /// Station numbers are permuted: the data of station k was read as that of station `numbers[k]` (from 0).
    Numbers([usize; MOST_STATIONS]),
}

impl Misreading {
    /// Returns the misreadings of some stations, the most frequent and simplest first: two exchanged stations, or three in a cycle.
    pub fn all(stations: usize) -> Vec<Self> {
        let in_order = std::array::from_fn(|station| station);
        let exchanged = StationPair::among(stations).map(|pair| {
            let mut numbers = in_order;
            let [a, b] = pair.indices();
            numbers.swap(a, b);
            Self::Numbers(numbers)
        });
        let mut cycles = Vec::new();
        if stations == 3 {
            for first_numbers in [[1, 2, 0], [2, 0, 1]] {
                let mut numbers = in_order;
                numbers[..3].copy_from_slice(&first_numbers);
                cycles.push(Self::Numbers(numbers));
            }
        }
        let each = || (0..stations).map(Some);
        [Self::Azimuth(None), Self::Feet(None)]
            .into_iter()
            .chain(exchanged)
            .chain(cycles)
            .chain(each().map(Self::Feet))
            .chain(each().map(Self::Azimuth))
            .collect()
    }

    /// Returns the station under which the data of station k was read.
    fn source(self, station: usize) -> usize {
        match self {
            Self::Numbers(numbers) => numbers[station],
            _ => station,
        }
    }

    fn reverses(self, station: usize) -> bool {
        matches!(self, Self::Azimuth(which) if which.is_none_or(|one| one == station))
    }

    fn is_feet(self, station: usize) -> bool {
        matches!(self, Self::Feet(which) if which.is_none_or(|one| one == station))
    }

    /// Returns the corrected range (m), of one that was read as metres and includes the prism constant.
    fn range_m(self, station: usize, range_m: f64, constant_m: f64) -> f64 {
        if self.is_feet(station) { (range_m - constant_m) * FOOT_M + constant_m } else { range_m }
    }

    /// Returns the triplets with the misreading undone.
    pub fn undone(self, triplets: &Triplets, constants_m: &PerStation<f64>) -> Triplets {
        let right = |station: usize, point: &Vector3<f64>| {
            let (measured_m, mut point) = (point.norm(), *point);
            if self.reverses(station) {
                point.y = -point.y;
            }
            point * (self.range_m(station, measured_m, constants_m[station]) / measured_m)
        };
        let points_m = triplets.points_m.map_each(|station, _| {
            let source = self.source(station.index());
            triplets.points_m[source].iter().map(|point| right(source, point)).collect()
        });
        Triplets::new(triplets.time_s.clone(), triplets.interval.clone(), points_m)
    }

    /// Returns the control points with the misreading undone.
    pub fn undone_in_points(
        self,
        sets: &[ControlPointSet],
        constants_m: &PerStation<f64>,
    ) -> Vec<ControlPointSet> {
        let mut sets = sets.to_vec();
        for point in sets.iter_mut().flat_map(|set| &mut set.points) {
            let read = point.readings.clone();
            point.readings = read.map_each(|station, _| {
                let source = self.source(station.index());
                let mut polar = read[source]?;
                if self.reverses(source) {
                    polar.azimuth_rad = -polar.azimuth_rad;
                }
                polar.range_m = self.range_m(source, polar.range_m, constants_m[source]);
                Some(polar)
            });
        }
        sets
    }

    /// Returns a reading with a range in feet converted to metres; other misreadings do not change it.
    pub fn undone_in_range(self, station: usize, measurement: &Measurement) -> Measurement {
        let range_m = self.range_m(station, measurement.range_m, 0.0);
        Measurement { range_m, ..*measurement }
    }

    /// Returns the misreading in words, such as "azimuths of the tracks look counter-clockwise".
    pub fn in_words(self, of: &str) -> String {
        match self {
            Self::Azimuth(None) => format!("azimuths{of} look counter-clockwise"),
            Self::Azimuth(Some(station)) => {
                format!("azimuths of station {}{of} look counter-clockwise", station + 1)
            }
            Self::Feet(None) => format!("ranges{of} look like feet"),
            Self::Feet(Some(station)) => {
                format!("ranges of station {}{of} look like feet", station + 1)
            }
            Self::Numbers(numbers) => {
                let moved: Vec<(usize, usize)> =
                    numbers.into_iter().enumerate().filter(|(own, read)| own != read).collect();
                if let [(a, _), (b, _)] = moved[..] {
                    return format!("stations {} and {}{of} look exchanged", a + 1, b + 1);
                }
                let list = |numbers: &mut dyn Iterator<Item = usize>| {
                    numbers.map(|number| (number + 1).to_string()).collect::<Vec<_>>().join(", ")
                };
                format!(
                    "stations{of} look renumbered: those read as {} look like {}",
                    list(&mut moved.iter().map(|(_, read)| *read)),
                    list(&mut moved.iter().map(|(own, _)| *own)),
                )
            }
        }
    }

    /// Returns the correction as a phrase, such as "with 0.3048 m per foot".
    pub fn assuming(self) -> &'static str {
        match self {
            Self::Azimuth(_) => "with azimuths reversed",
            Self::Feet(_) => "with 0.3048 m per foot",
            Self::Numbers(_) => "with the numbers corrected",
        }
    }

    /// Returns the correction of the tracks as a key of `deployment.toml`; `None` if there is no such key.
    pub fn remedy(self, deployment: &Deployment) -> Option<String> {
        if self == Self::Feet(None) {
            return Some("length_unit = \"feet\" in [columns]".to_owned());
        }
        let Overrides { azimuth, stations, .. } = self.read_with(deployment)?;
        azimuth
            .map(|sense| format!("azimuth = \"{}\"", sense.title()))
            .or(stations.map(|numbers| format!("stations = {:?}", numbers.as_slice())))
    }

    /// Returns the correction of the tracks as overrides of the files; `None` if overrides are not sufficient.
    pub fn read_with(self, deployment: &Deployment) -> Option<Overrides> {
        let Overrides { azimuth, .. } = &deployment.overrides;
        match self {
            Self::Azimuth(None) => {
                let sense = match azimuth {
                    Some(AzimuthSense::CounterClockwise) => AzimuthSense::Clockwise,
                    _ => AzimuthSense::CounterClockwise,
                };
                Some(Overrides { azimuth: Some(sense), ..Overrides::default() })
            }
            Self::Numbers(numbers) => {
                let own = deployment.station_numbers();
                let stations = Some(own.map_each(|station, _| own[numbers[station.index()]]));
                Some(Overrides { stations, ..Overrides::default() })
            }
            Self::Azimuth(Some(_)) | Self::Feet(_) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulated_drives::{Preset, simulated};

    fn triplets() -> Triplets {
        let points = |x: f64| vec![Vector3::new(x, 3.0, -1.0), Vector3::new(x, 4.0, -1.5)];
        Triplets::new(vec![0.0, 0.1], vec![0, 0], [points(10.0), points(20.0), points(30.0)])
    }

    #[test]
    fn what_is_undone_twice_or_made_and_undone_is_as_it_was() {
        let right = triplets();
        for misreading in [Misreading::Azimuth(None), Misreading::Azimuth(Some(1))] {
            let twice = misreading.undone(
                &misreading.undone(&right, &PerStation::repeat(3, 0.01)),
                &PerStation::repeat(3, 0.01),
            );
            assert!((twice.points_m[1][0] - right.points_m[1][0]).norm() < 1e-12);
            assert_ne!(
                misreading.undone(&right, &PerStation::repeat(3, 0.01)).points_m[1],
                right.points_m[1]
            );
        }
        let turned = Misreading::Numbers([1, 2, 0, 3, 4, 5, 6, 7])
            .undone(&right, &PerStation::repeat(3, 0.0));
        assert_eq!(turned.points_m[0], right.points_m[1]);
        assert_eq!(
            Misreading::Numbers([2, 0, 1, 3, 4, 5, 6, 7])
                .undone(&turned, &PerStation::repeat(3, 0.0)),
            right
        );
    }

    #[test]
    fn the_prism_constant_is_metres_whatever_the_range_was() {
        let mut feet = triplets();
        for point in &mut feet.points_m[2] {
            let metres = point.norm();
            *point *= ((metres - 0.01) / FOOT_M + 0.01) / metres;
        }
        let undone = Misreading::Feet(Some(2)).undone(&feet, &PerStation::repeat(3, 0.01));
        assert!((undone.points_m[2][0] - triplets().points_m[2][0]).norm() < 1e-12);
        assert_eq!(undone.points_m[0], triplets().points_m[0]);
    }

    #[test]
    fn the_remedy_says_what_to_write() {
        assert_eq!([2, 3, 4].map(|stations| Misreading::all(stations).len()), [7, 13, 16]);
        let deployment = simulated(Preset::Warthog, 1);
        let mut renumbered = deployment.clone();
        renumbered.overrides.stations = Some([7, 8, 9].into());
        let swap = Misreading::Numbers([0, 2, 1, 3, 4, 5, 6, 7]);
        assert_eq!(swap.in_words(""), "stations 2 and 3 look exchanged");
        assert_eq!(swap.remedy(&deployment).as_deref(), Some("stations = [1, 3, 2]"));
        assert_eq!(swap.remedy(&renumbered).as_deref(), Some("stations = [7, 9, 8]"));
    }
}
