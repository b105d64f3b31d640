//! Comparison of the stations' stamps and own clocks with the recorder's clock.

use crate::deployment::Finding;
use crate::deployment::findings::recordings::stamps_contradict_recorder;
use crate::network::MOST_STATIONS;
use crate::statistics::median;

/// Smallest number of readings for a drift; half as many on either side of a jump.
pub const FEWEST_READINGS: usize = 10;
/// Stamps are doubted if they disagree by this much (s) by the recorder's clock, and the own clocks do not.
pub const DOUBTED_S: f64 = 0.05;
/// Largest number of arrivals kept for a station.
const KEPT_ARRIVALS: usize = 4096;

/// Arrival times of readings at the recorder, relative to both of their times: independent evidence.
#[derive(Clone, Debug, Default)]
pub struct Arrivals {
    /// Delay of the readings of each station after the stamp and after the own clock (s); every `every`-th reading.
    kept: [Vec<(f64, f64)>; MOST_STATIONS],
    seen: [usize; MOST_STATIONS],
    every: [usize; MOST_STATIONS],
}

impl Arrivals {
    pub fn push(&mut self, station: usize, after_stamp_s: f64, after_own_s: f64) {
        let every = self.every[station].max(1);
        if self.seen[station].is_multiple_of(every) {
            let kept = &mut self.kept[station];
            kept.push((after_stamp_s, after_own_s));
            if kept.len() == KEPT_ARRIVALS {
                let mut odd = false;
                kept.retain(|_| {
                    odd = !odd;
                    odd
                });
                self.every[station] = every * 2;
            }
        }
        self.seen[station] += 1;
    }

    /// Returns a doubt if the stations' stamps disagree by the recorder's clock, and their own clocks do not.
    pub fn finding(&self) -> Option<Finding> {
        let stations =
            self.kept.iter().enumerate().filter(|(_, kept)| kept.len() >= FEWEST_READINGS);
        let medians: Vec<(usize, f64, f64)> = stations
            .filter_map(|(station, kept)| {
                let stamp_s = median(kept.iter().map(|(stamp_s, _)| *stamp_s))?;
                Some((station, stamp_s, median(kept.iter().map(|(_, own_s)| *own_s))?))
            })
            .collect();
        let range = |value: fn(&(usize, f64, f64)) -> f64| {
            let values = || medians.iter().map(value);
            values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
        };
        let (stamps_s, own_s) = (range(|m| m.1), range(|m| m.2));
        if medians.len() < 2 || stamps_s < DOUBTED_S || own_s > stamps_s / 5.0 {
            return None;
        }
        let first_s = medians[0].1;
        let against_first_s: Vec<(usize, f64)> =
            medians.iter().map(|(station, stamp_s, _)| (*station, first_s - stamp_s)).collect();
        Some(stamps_contradict_recorder(&against_first_s, stamps_s, own_s))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deployment::kinds;

    #[test]
    fn the_recorder_tells_wrong_stamps_from_wrong_clocks() {
        let arrivals = |stamps_s: [f64; 3], own_s: [f64; 3]| {
            let mut arrivals = Arrivals::default();
            for k in 0..10_000 {
                let delay_s = 0.01 + 1e-3 * f64::from(k % 7);
                for station in 0..3 {
                    arrivals.push(station, delay_s - stamps_s[station], delay_s - own_s[station]);
                }
            }
            assert!(arrivals.kept.iter().all(|kept| kept.len() < KEPT_ARRIVALS));
            arrivals.finding()
        };
        assert_eq!(arrivals([0.0; 3], [0.0, 0.3, -0.2]), None);
        assert_eq!(arrivals([0.0; 3], [0.0; 3]), None);
        let said = arrivals([0.0, 0.3, -0.2], [0.0; 3]).expect("the stamps are off");
        assert_eq!(said.kind, kinds::STAMPS_CONTRADICT_RECORDER);
        assert!(said.to_string().contains("station 2 +0.300 s, station 3 -0.200 s"), "{said}");
    }
}
