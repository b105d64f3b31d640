//! Colours of readings and tracks, and their meaning.

use rayon::prelude::*;
use resect_core::network::{Number, PerStation, Prism};

use crate::app::model::Colouring;
use crate::app::prepared::nearest_triplets;
use resect_core::analysis::Analysis;
use resect_core::deployment::{Deployment, Measurement};
use resect_core::pipeline::SampleFate;
use resect_tools::palette;
use resect_tools::palette::Rgb;

/// The colours of a continuous scale, from `low` to `high`.
#[derive(Clone, Debug, PartialEq)]
pub struct Scale {
    /// Name of the quantity, with its unit.
    pub title: &'static str,
    pub low: f64,
    pub high: f64,
    /// True if some values exceed `high`; they have its colour.
    pub exceeded: bool,
}

/// Red, green, blue, and flags of the point for the shader.
pub type PointColour = [u8; 4];

/// Bit of a large point. The lowest three bits of a colour's last byte are the station's index.
const LARGE: u8 = 8;
/// Bit of a point that is joined to the one before.
const JOINED: u8 = 16;
/// Bits above this one are the number of a reading's fate.
const FATE_SHIFT: u8 = 5;

/// Returns the fate of a reading of this colour, as its index in [`SampleFate::ALL`].
pub fn fate_of(colour: PointColour) -> usize {
    usize::from(colour[3] >> FATE_SHIFT)
}

/// Colours of every reading and of every point of the tracks, in the order of the clouds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Colours {
    pub raw: Vec<PointColour>,
    pub tracks: Vec<PointColour>,
    pub scale: Option<Scale>,
    /// True if some points have no value and are grey.
    pub some_without_value: bool,
}

impl Colours {
    /// Computes the colours of all points, one thread for each station. It takes 10 to
    /// 40 ms for a million readings and as many triplets, too long for every frame.
    pub fn of(deployment: &Deployment, analysis: &Analysis, colouring: Colouring) -> Self {
        match colouring {
            Colouring::Fate => Self::by_group(
                analysis,
                |_, _, fate| (palette::fate(fate), fate != SampleFate::Kept),
                |station, _| palette::station(station),
            ),
            Colouring::Station => Self::by_group(
                analysis,
                |station, _, _| (palette::station(station), false),
                |station, _| palette::station(station),
            ),
            Colouring::Interval => {
                let owners = (deployment.tracks)
                    .map_each(|station, _| intervals(deployment, analysis, station.index()));
                let of =
                    |interval: Option<u32>| interval.map_or(palette::NO_VALUE, palette::interval);
                let mut colours = Self::by_group(
                    analysis,
                    |station, index, _| (of(owners[station].get(index).copied().flatten()), false),
                    |_, index| palette::interval(analysis.triplets().interval[index]),
                );
                colours.some_without_value = owners.iter().flatten().any(Option::is_none);
                colours
            }
            Colouring::Speed => {
                let speeds = deployment.tracks.map(|_| &analysis.triplets().speed_m_per_s);
                Self::by_triplet(deployment, analysis, "speed (m/s)", &speeds)
            }
            Colouring::Residual => {
                let residuals = residuals_mm(analysis);
                let residuals = residuals.iter().collect();
                Self::by_triplet(deployment, analysis, "residual (mm)", &residuals)
            }
            Colouring::Time => Self::by_time(deployment, analysis),
        }
    }

    /// Computes the colours of each station's readings and tracks.
    fn by_station(
        analysis: &Analysis,
        raw: impl Fn(usize) -> Vec<PointColour> + Sync,
        track: impl Fn(usize, usize) -> Rgb + Sync,
    ) -> Self {
        let interval = &analysis.triplets().interval;
        let tracks = |station: usize| {
            let colour = |index: usize| {
                let joined = index > 0 && interval[index] == interval[index - 1];
                point(track(station, index), station, if joined { JOINED } else { 0 })
            };
            (0..interval.len()).map(colour).collect::<Vec<_>>()
        };
        let raw = |station: usize| {
            let mut colours = raw(station);
            for (colour, fate) in colours.iter_mut().zip(&analysis.pipeline.fates[station].each) {
                let number = SampleFate::ALL.iter().position(|one| one == fate).unwrap_or(0);
                colour[3] |= (number as u8) << FATE_SHIFT;
            }
            colours
        };
        let stations = analysis.pipeline.fates.len();
        let of_each: Vec<_> =
            (0..stations).into_par_iter().map(|station| (raw(station), tracks(station))).collect();
        let (raw, tracks): (Vec<_>, Vec<_>) = of_each.into_iter().unzip();
        Self { raw: raw.concat(), tracks: tracks.concat(), ..Self::default() }
    }

    fn by_group(
        analysis: &Analysis,
        raw: impl Fn(usize, usize, SampleFate) -> (Rgb, bool) + Sync,
        track: impl Fn(usize, usize) -> Rgb + Sync,
    ) -> Self {
        let raw = |station: usize| {
            let of = |(index, fate): (usize, &SampleFate)| {
                let (colour, large) = raw(station, index, *fate);
                point(colour, station, if large { LARGE } else { 0 })
            };
            analysis.pipeline.fates[station].each.iter().enumerate().map(of).collect()
        };
        Self::by_station(analysis, raw, track)
    }

    /// Computes colours from values of each station at every triplet; a reading has the value of the nearest triplet.
    fn by_triplet(
        deployment: &Deployment,
        analysis: &Analysis,
        title: &'static str,
        values: &PerStation<&Vec<f64>>,
    ) -> Self {
        let scale = scale_of(title, values);
        let ramp = Ramp::new(&scale);
        let of = |station: usize, index: usize| {
            values[station].get(index).map_or(palette::NO_VALUE, |value| ramp.colour(*value))
        };
        let raw = |station: usize| {
            nearest_triplets(deployment, analysis, station)
                .map(|nearest| nearest.map_or(palette::NO_VALUE, |index| of(station, index)))
                .map(|colour| point(colour, station, 0))
                .collect()
        };
        let mut colours = Self::by_station(analysis, raw, of);
        colours.some_without_value = colours.raw.iter().any(|c| c[..3] == palette::NO_VALUE);
        colours.scale = values.iter().any(|values| !values.is_empty()).then_some(scale);
        colours
    }

    fn by_time(deployment: &Deployment, analysis: &Analysis) -> Self {
        let start_s = deployment.start_s().unwrap_or(0.0);
        let high = deployment.end_s().unwrap_or(0.0) - start_s;
        let scale = Scale { title: "time (s)", low: 0.0, high, exceeded: false };
        let ramp = Ramp::new(&scale);
        let raw = |station: usize| {
            let of = |m: &Measurement| point(ramp.colour(m.time_s - start_s), station, 0);
            deployment.tracks[station].measurements.iter().map(of).collect()
        };
        let time_s = &analysis.triplets().time_s;
        let colours =
            Self::by_station(analysis, raw, |_, index| ramp.colour(time_s[index] - start_s));
        Self { scale: Some(scale), ..colours }
    }
}

/// A colour scale with as many steps as the eye can distinguish, tabulated.
struct Ramp {
    low: f64,
    steps_per_unit: f64,
    steps: [Rgb; 256],
}

impl Ramp {
    fn new(scale: &Scale) -> Self {
        let span = (scale.high - scale.low).max(f64::MIN_POSITIVE);
        let steps = std::array::from_fn(|step| palette::continuous(step as f32 / 255.0));
        Self { low: scale.low, steps_per_unit: 255.0 / span, steps }
    }

    fn colour(&self, value: f64) -> Rgb {
        // The cast saturates at 0 and 255.
        self.steps[usize::from(((value - self.low) * self.steps_per_unit + 0.5) as u8)]
    }
}

fn point([r, g, b]: Rgb, station: usize, style: u8) -> PointColour {
    [r, g, b, station as u8 | style]
}

/// Returns the kept interval of each reading that interpolation uses.
fn intervals(deployment: &Deployment, analysis: &Analysis, station: usize) -> Vec<Option<u32>> {
    let kept = &analysis.pipeline.kept_intervals;
    let fates = &analysis.pipeline.fates[station].each;
    let mut at = 0;
    (deployment.tracks[station].measurements.iter().zip(fates))
        .map(|(m, fate)| {
            while at + 1 < kept.len() && m.time_s > kept[at].end_s {
                // The reading that brackets the end still belongs to this interval.
                if *fate == SampleFate::Kept && m.time_s < kept[at + 1].start_s {
                    let (after, before) =
                        (m.time_s - kept[at].end_s, kept[at + 1].start_s - m.time_s);
                    if after <= before {
                        break;
                    }
                }
                at += 1;
            }
            (*fate == SampleFate::Kept && at < kept.len()).then_some(at as u32)
        })
        .collect()
}

/// Largest |distance error| of the pairs that contain a station's prism, at every triplet
/// (mm); empty without a calibration, or without a distance to compare with.
fn residuals_mm(analysis: &Analysis) -> PerStation<Vec<f64>> {
    let of_prism = |prism: Prism| {
        let answer = analysis.answer.as_ref().ok()?;
        let errors_mm = answer.evaluation.distance_errors_mm.each();
        let own = errors_mm.filter(|(pair, _)| pair.contains(&prism));
        let own = own.map(|(_, errors_mm)| errors_mm.iter().map(|error| error.abs()).collect());
        own.reduce(|a: Vec<f64>, b| a.iter().zip(b).map(|(a, b)| a.max(b)).collect())
    };
    analysis.offer.followed.map(|prism| of_prism(*prism).unwrap_or_default())
}

/// Greatest number of values to sample, and the share of them that the scale spans.
const MOST_LOOKED_AT: usize = 20_000;
const SPANNED: f64 = 0.98;

/// Returns a scale from zero to a bound of nearly all values: a few outliers must not give the rest one colour.
fn scale_of(title: &'static str, values: &PerStation<&Vec<f64>>) -> Scale {
    let count: usize = values.iter().map(|values| values.len()).sum();
    let step = count.div_ceil(MOST_LOOKED_AT).max(1);
    let mut some: Vec<f64> = values.iter().flat_map(|v| v.iter().step_by(step)).copied().collect();
    some.sort_by(f64::total_cmp);
    let high = resect_core::statistics::quantile_of_sorted(&some, SPANNED).unwrap_or(1.0);
    let high = round_up(high);
    Scale { title, low: 0.0, high, exceeded: some.last().is_some_and(|most| *most > high) }
}

/// Rounds up to two significant digits.
fn round_up(value: f64) -> f64 {
    let unit = 10_f64.powf(value.max(1e-6).log10().floor() - 1.0);
    (value / unit).ceil() * unit
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::prepared::Cloud;
    use resect_core::analysis::{Analyst, Settings};
    use resect_io::sample::Sample;

    fn warthog() -> (Deployment, Analysis) {
        let deployment = Sample::Warthog.open().expect("built in");
        let analysis = Analyst::new(deployment.clone().into()).run(&Settings::default());
        (deployment, analysis)
    }

    #[test]
    fn every_point_has_a_colour_and_its_station() {
        let (deployment, analysis) = warthog();
        let raw = Cloud::of_readings(&deployment);
        let tracks = Cloud::of_triplets(analysis.triplets(), 0.0);
        for colouring in Colouring::ALL {
            let colours = Colours::of(&deployment, &analysis, colouring);
            assert_eq!(colours.raw.len(), raw.points.len(), "{colouring:?}");
            assert_eq!(colours.tracks.len(), tracks.points.len(), "{colouring:?}");
            for (cloud, colours) in [(&raw, &colours.raw), (&tracks, &colours.tracks)] {
                for (station, range) in cloud.ranges.iter().enumerate() {
                    assert!(colours[range.clone()].iter().all(|c| c[3] & 7 == station as u8));
                }
            }
            let fates = analysis.pipeline.fates.iter().flat_map(|fates| &fates.each);
            assert!(fates.zip(&colours.raw).all(|(fate, c)| SampleFate::ALL[fate_of(*c)] == *fate));
        }
    }

    #[test]
    fn the_worse_pair_of_a_prism_colours_it() {
        let (deployment, analysis) = warthog();
        let answer = analysis.answer.as_ref().expect("an answer");
        let errors = &answer.evaluation.distance_errors_mm;
        let of = residuals_mm(&analysis);
        for index in [0, 700, 3000] {
            let [e12, e13, e23] = [0, 1, 2].map(|pair| errors[pair][index].abs());
            assert_eq!(
                of.map(|own| own[index]).as_slice(),
                [e12.max(e13), e12.max(e23), e13.max(e23)]
            );
        }
        let colours = Colours::of(&deployment, &analysis, Colouring::Residual);
        let scale = colours.scale.expect("a scale");
        assert!(scale.exceeded && scale.high > 2.0 && scale.high < 20.0, "{scale:?}");
        // Readings far from any triplet are grey.
        assert!(colours.some_without_value);
        assert!(colours.raw.iter().any(|c| c[..3] == palette::NO_VALUE));
    }

    #[test]
    fn a_reading_has_the_colour_of_its_interval() {
        let (deployment, analysis) = warthog();
        let kept = &analysis.pipeline.kept_intervals;
        for station in 0..3 {
            let owners = intervals(&deployment, &analysis, station);
            let mut seen = vec![false; kept.len()];
            for (m, owner) in deployment.tracks[station].measurements.iter().zip(owners) {
                let inside = kept.iter().position(|i| i.start_s <= m.time_s && m.time_s <= i.end_s);
                let Some(owner) = owner else { continue };
                seen[owner as usize] = true;
                // Readings that bracket an interval belong to it, and lie just outside.
                let own = kept[owner as usize];
                let beside = (own.start_s - m.time_s).max(m.time_s - own.end_s);
                assert!(inside == Some(owner as usize) || beside < 2.0, "{beside}");
            }
            assert!(seen.iter().all(|seen| *seen));
        }
    }

    #[test]
    fn scales_end_at_round_numbers() {
        for (value, wanted) in [(0.123, 0.13), (7.41, 7.5), (99.2, 100.0), (1234.0, 1300.0)] {
            assert!((round_up(value) - wanted).abs() < 1e-9, "{value}: {}", round_up(value));
        }
    }
}
