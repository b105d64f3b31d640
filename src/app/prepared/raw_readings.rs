//! Rates of the raw readings, computed once for each deployment by the worker: they do not depend on the settings.

use super::clock_series::ClockSeries;
use super::pyramid::Values;
use resect_core::deployment::{Deployment, Measurement, Track};
use resect_core::network::PerStation;
use resect_core::pipeline::outlier_filter::{Rates, rates};
use resect_core::pipeline::{OutlierReason, Thresholds};
use resect_core::statistics::quantile_of_sorted;

/// A measured quantity, with its rate and its threshold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    Range,
    Azimuth,
    Zenith,
}

impl Quantity {
    /// All quantities in the order of the pipeline's rule.
    pub const ALL: [Self; 3] = [Self::Range, Self::Azimuth, Self::Zenith];

    pub fn name(self) -> &'static str {
        match self {
            Self::Range => "range rate",
            Self::Azimuth => "azimuth rate",
            Self::Zenith => "zenith rate",
        }
    }

    pub fn symbol(self) -> &'static str {
        match self {
            Self::Range => "τ_r",
            Self::Azimuth => "τ_a",
            Self::Zenith => "τ_e",
        }
    }

    /// Returns the reason for which a reading is rejected by this quantity.
    pub fn reason(self) -> OutlierReason {
        match self {
            Self::Range => OutlierReason::Range,
            Self::Azimuth => OutlierReason::Azimuth,
            Self::Zenith => OutlierReason::Zenith,
        }
    }

    /// Returns the quantity's threshold (m/s, °/s).
    pub fn threshold(self, thresholds: &mut Thresholds) -> &mut f64 {
        match self {
            Self::Range => &mut thresholds.tau_r_m_per_s,
            Self::Azimuth => &mut thresholds.tau_a_deg_per_s,
            Self::Zenith => &mut thresholds.tau_e_deg_per_s,
        }
    }

    fn of(self, rates: &Rates) -> f64 {
        match self {
            Self::Range => rates.range_m_per_s,
            Self::Azimuth => rates.azimuth_deg_per_s,
            Self::Zenith => rates.zenith_deg_per_s,
        }
    }
}

/// Raw readings of all stations, for the plots.
#[derive(Clone, Debug, Default)]
pub struct RawReadings {
    /// Time of the first measurement of any station (s, in the stations' clock).
    pub start_s: f64,
    pub stations: PerStation<StationReadings>,
    /// Differences of the stations' own clocks.
    pub clocks: PerStation<ClockSeries>,
    /// Default range of each quantity's rates in a plot; no rate exceeds the upper end.
    pub shown: [[f64; 2]; 3],
}

/// Raw readings of one station, for the plots.
#[derive(Clone, Debug, Default)]
pub struct StationReadings {
    /// Time of each raw reading, since the first measurement of any station (s).
    pub time_s: Vec<f64>,
    /// True for each reading that the user excluded, as in [`Track::left_out`].
    pub left_out: Vec<bool>,
    /// Range (m), azimuth and zenith angle (rad) of each raw reading, as measured.
    pub measured: [Values; 3],
    /// Rates of each quantity.
    pub rates: [RateSeries; 3],
}

/// Absolute rates of each raw reading since the previous one, in the quantity's unit; 0
/// for the first. Excluded readings have no rate and are skipped as previous readings.
#[derive(Clone, Debug, Default)]
pub struct RateSeries {
    pub values: Values,
    sorted: Vec<f64>,
}

impl RawReadings {
    pub fn of(deployment: &Deployment) -> Self {
        let start_s = deployment.start_s().unwrap_or(0.0);
        let stations = deployment.tracks.map(|track| StationReadings::of(track, start_s));
        let clocks = (deployment.tracks).zip(&deployment.time_corrections, |track, corrections| {
            ClockSeries::of(track, corrections, start_s)
        });
        let mut paper = Thresholds::default();
        let shown = Quantity::ALL.map(|quantity| {
            let paper = *quantity.threshold(&mut paper);
            let of_each = |share: f64| {
                stations.iter().filter_map(move |s| s.rates[quantity as usize].quantile(share))
            };
            // A decade below the usual rate; slower rates only mean that the vehicle stood still.
            let usual = of_each(0.6).fold(f64::INFINITY, f64::min);
            let low = (usual / 10.0).clamp(paper / 500.0, paper / 10.0);
            let high = of_each(1.0).fold(3.0 * paper, f64::max);
            [low, 1.5 * high]
        });
        Self { start_s, stations, clocks, shown }
    }

    /// Returns the time from the first measurement of any station to the last (s).
    pub fn length_s(&self) -> f64 {
        self.stations.iter().filter_map(|own| own.time_s.last()).copied().fold(0.0, f64::max)
    }
}

impl StationReadings {
    fn of(track: &Track, start_s: f64) -> Self {
        let readings = &track.measurements;
        let mut previous: Option<&Measurement> = None;
        let all: Vec<Option<Rates>> = readings
            .iter()
            .enumerate()
            .map(|(index, reading)| {
                if track.is_left_out(index) {
                    return None;
                }
                let rates = previous.map(|previous| rates(previous, reading));
                previous = Some(reading);
                rates
            })
            .collect();
        let series = |quantity: Quantity| {
            let value =
                |rates: &Option<Rates>| rates.as_ref().map_or(0.0, |r| quantity.of(r).abs());
            RateSeries::of(all.iter().map(value).collect())
        };
        let measured: [fn(&Measurement) -> f64; 3] =
            [|m| m.range_m, |m| m.azimuth_rad, |m| m.zenith_rad];
        Self {
            time_s: readings.iter().map(|m| m.time_s - start_s).collect(),
            measured: measured.map(|of| Values::of(readings.iter().map(of).collect())),
            left_out: track.left_out.clone(),
            rates: Quantity::ALL.map(series),
        }
    }

    /// Returns the absolute rates of a reading.
    pub fn rates_at(&self, index: usize) -> Rates {
        let [range_m_per_s, azimuth_deg_per_s, zenith_deg_per_s] =
            self.rates.each_ref().map(|series| series.values.values[index]);
        Rates { range_m_per_s, azimuth_deg_per_s, zenith_deg_per_s }
    }

    pub fn is_left_out(&self, index: usize) -> bool {
        self.left_out.get(index).copied().unwrap_or(false)
    }

    /// Returns the indices of the readings within a window (s since the first measurement).
    pub fn within(&self, [from_s, to_s]: [f64; 2]) -> std::ops::Range<usize> {
        let from = self.time_s.partition_point(|t| *t < from_s);
        from..self.time_s.partition_point(|t| *t <= to_s).max(from)
    }
}

impl RateSeries {
    fn of(values: Vec<f64>) -> Self {
        let mut sorted: Vec<f64> = values.iter().skip(1).copied().collect();
        sorted.sort_unstable_by(f64::total_cmp);
        Self { values: Values::of(values), sorted }
    }

    /// Returns the number of rates above a threshold.
    pub fn above(&self, threshold: f64) -> usize {
        self.sorted.len() - self.sorted.partition_point(|value| *value <= threshold)
    }

    fn quantile(&self, share: f64) -> Option<f64> {
        quantile_of_sorted(&self.sorted, share)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use resect_core::pipeline;
    use resect_core::pipeline::outlier_filter::too_fast;
    use resect_core::pipeline::{PipelineSettings, SampleFate};
    use resect_io::sample::Sample;

    /// The plots mark and count the readings that the pipeline rejects.
    #[test]
    fn the_lines_reject_what_the_pipeline_rejects() {
        let mut deployment = Sample::Warthog.open().expect("built in");
        // Every seventh reading is excluded: no rate refers to it.
        for track in &mut deployment.tracks {
            track.left_out = (0..track.measurements.len()).map(|index| index % 7 == 3).collect();
        }
        let readings = RawReadings::of(&deployment);
        for (tau_r, tau_a, tau_e) in [(2.0, 1.0, 1.0), (0.4, 0.6, 0.2), (1.3, 5.0, 0.05)] {
            let mut settings = PipelineSettings::default();
            settings.thresholds.tau_r_m_per_s = tau_r;
            settings.thresholds.tau_a_deg_per_s = tau_a;
            settings.thresholds.tau_e_deg_per_s = tau_e;
            let out = pipeline::run(&deployment, &settings);
            for (station, own) in readings.stations.iter().enumerate() {
                for (index, fate) in out.fates[station].each.iter().enumerate() {
                    let reason = too_fast(&own.rates_at(index), &settings.thresholds);
                    let rejected = match fate {
                        SampleFate::Rejected(reason) => Some(*reason),
                        _ => None,
                    };
                    assert_eq!(reason, rejected, "station {station}, reading {index}");
                }
                let mut thresholds = settings.thresholds;
                for quantity in Quantity::ALL {
                    let rejected = out.count(station, SampleFate::Rejected(quantity.reason()));
                    let above =
                        own.rates[quantity as usize].above(*quantity.threshold(&mut thresholds));
                    // Only the first of the three is tested for every reading.
                    assert!(rejected <= above);
                    assert!(quantity != Quantity::Range || rejected == above);
                }
            }
        }
    }

    #[test]
    fn every_rate_has_room_in_its_plot() {
        let readings = RawReadings::of(&Sample::Hd2Tunnel.open().expect("built in"));
        for quantity in Quantity::ALL {
            let [low, high] = readings.shown[quantity as usize];
            assert!(0.0 < low && low < high);
            for station in &readings.stations {
                assert_eq!(station.rates[quantity as usize].above(high), 0);
            }
        }
    }
}
