//! Colours with a meaning, the same in the window, in pictures and in Rerun.
//!
//! From Okabe & Ito's set, which colour-blind people can distinguish.

use crate::validation::Outcome;
use resect_core::calibration::Verdict;
use resect_core::calibration::inter_prism::observability::Hold;
use resect_core::network::MOST_STATIONS;
use resect_core::pipeline::{Interpolation, OutlierReason, SampleFate};

/// Red, green, blue, sRGB.
pub type Rgb = [u8; 3];

/// Stations (and their prisms): blue, orange, green, mauve, moss, gold, pink, brick. The last ones are similar to fates of readings.
const STATIONS: [Rgb; MOST_STATIONS] = [
    [86, 160, 233],
    [230, 159, 0],
    [0, 178, 130],
    [150, 120, 170],
    [95, 130, 60],
    [235, 220, 90],
    [240, 160, 190],
    [190, 60, 50],
];

/// Pairs 12, 13, 23: violet, raspberry, olive, none of them similar to those of stations 1 to 3. Further pairs repeat them, lighter
/// and darker.
const PAIRS: [Rgb; 3] = [[172, 128, 248], [205, 55, 115], [150, 140, 50]];

/// Metrics of a study: control points blue, inter-prism distances vermilion.
pub const METRICS: [Rgb; 2] = [[60, 130, 200], [213, 94, 0]];

/// Answers of a sweep: of the published method sand, the joint estimate teal.
pub const ANSWERS: [Rgb; 2] = [[200, 150, 90], [20, 140, 140]];

/// The two steps of the paper's search of the prior: steel and rust.
pub const STEPS: [Rgb; 2] = [[110, 150, 190], [190, 110, 70]];

/// Interpolations of positions, the same in every study: linear slate, the Gaussian process plum, the motion model ochre.
pub fn interpolation(interpolation: Interpolation) -> Rgb {
    match interpolation {
        Interpolation::Linear => [112, 128, 150],
        Interpolation::Gp => [150, 70, 150],
        Interpolation::Wnoa => [185, 130, 30],
    }
}

/// Correlation of two errors: vermilion if positive, blue if negative.
pub fn correlation(value: f64) -> Rgb {
    if value > 0.0 { [213, 94, 0] } else { [60, 130, 200] }
}

/// A station, numbered from 0, and the prism of this number.
pub fn station(station: usize) -> Rgb {
    STATIONS[station % STATIONS.len()]
}

/// A pair of prisms, by its index.
pub fn pair(pair: usize) -> Rgb {
    let own = PAIRS[pair % PAIRS.len()];
    match (pair / PAIRS.len()) % 3 {
        0 => own,
        1 => own.map(|channel| channel / 2 + 127),
        _ => own.map(|channel| channel / 5 * 3),
    }
}

/// Fate of a raw reading.
pub fn fate(fate: SampleFate) -> Rgb {
    match fate {
        SampleFate::Kept => [150, 160, 170],
        SampleFate::Rejected(OutlierReason::Range) => [230, 70, 30],
        SampleFate::Rejected(OutlierReason::Azimuth) => [226, 120, 190],
        SampleFate::Rejected(OutlierReason::Zenith) => [240, 215, 50],
        SampleFate::InNoInterval => [110, 90, 200],
        SampleFate::IntervalTooShort => [60, 130, 160],
        SampleFate::LeftOut => [150, 110, 80],
    }
}

/// Background of a verdict's badge, and black or white text that is legible on it.
pub fn verdict(verdict: Verdict) -> [Rgb; 2] {
    match verdict {
        Verdict::Good => [[0, 140, 100], [255; 3]],
        Verdict::Weak => [[230, 159, 0], [0; 3]],
        Verdict::Ambiguous => [[204, 121, 167], [0; 3]],
        Verdict::Degenerate => [[200, 60, 30], [255; 3]],
    }
}

/// Background of the badge of a validation's outcome, and text that is legible on it.
pub fn outcome(outcome: &Outcome) -> [Rgb; 2] {
    verdict(match outcome {
        Outcome::Holds => Verdict::Good,
        Outcome::CannotBeTold(_) => Verdict::Weak,
        Outcome::DoesNotHold(_) => Verdict::Degenerate,
    })
}

/// Observability of a direction by a drive: unobservable vermilion, weak purple, constrained grey.
pub fn hold(hold: Hold) -> Rgb {
    match hold {
        Hold::Free => [226, 82, 40],
        Hold::Weak => [204, 121, 167],
        Hold::Held => [120, 150, 170],
    }
}

/// Values that are missing on a scale.
pub const NO_VALUE: Rgb = [110, 118, 128];

/// Intervals, in cyclic order: all of Okabe & Ito's set but black.
pub const INTERVALS: [Rgb; 7] = [
    [86, 180, 233],
    [230, 159, 0],
    [0, 158, 115],
    [204, 121, 167],
    [240, 228, 66],
    [213, 94, 0],
    [0, 114, 178],
];

/// Trajectories of other systems: purple, violet, vermilion, brown. None is similar to a station's colour, or to the scale that
/// colours their errors.
const ESTIMATES: [Rgb; 4] = [[204, 121, 167], [130, 80, 220], [213, 94, 0], [140, 84, 50]];

/// A trajectory of another system, numbered from 0.
pub fn estimate(number: usize) -> Rgb {
    ESTIMATES[number % ESTIMATES.len()]
}

/// Another open run, numbered from 0: tints that no station, pair or trajectory has.
pub fn run_beside(number: usize) -> Rgb {
    const TINTS: [Rgb; 4] = [[190, 190, 120], [150, 190, 190], [200, 160, 170], [170, 170, 215]];
    TINTS[number % TINTS.len()]
}

/// Success: the set's green.
pub const DONE: Rgb = INTERVALS[2];

/// An interval, numbered from 0.
pub fn interval(number: u32) -> Rgb {
    INTERVALS[number as usize % INTERVALS.len()]
}

/// Viridis (Smith & van der Walt, matplotlib 2.0; perceptually uniform, safe for colour-blind eyes) at every eighth from 1/4 to
/// 1. The darkest quarter is invisible on a dark background.
const VIRIDIS: [Rgb; 7] = [
    [59, 82, 139],
    [44, 114, 142],
    [33, 144, 140],
    [39, 173, 129],
    [93, 200, 99],
    [170, 220, 50],
    [253, 231, 37],
];

/// Colour on a scale from 0 to 1; values outside are clamped.
pub fn continuous(share: f32) -> Rgb {
    let last = VIRIDIS.len() - 1;
    let at = share.clamp(0.0, 1.0) * last as f32;
    let below = (at as usize).min(last - 1);
    let part = at - below as f32;
    let mix = |c: usize| {
        let (low, high) = (f32::from(VIRIDIS[below][c]), f32::from(VIRIDIS[below + 1][c]));
        (low + part * (high - low)).round() as u8
    };
    [mix(0), mix(1), mix(2)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Perceived difference of two colours (Ottosson 2020, "A perceptual color space for image processing": OKLab).
    fn difference(a: Rgb, b: Rgb) -> f64 {
        let lab = |rgb: Rgb| {
            let [r, g, b] = rgb.map(|c| {
                let c = f64::from(c) / 255.0;
                if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
            });
            let l = (0.412_22 * r + 0.536_33 * g + 0.051_45 * b).cbrt();
            let m = (0.211_90 * r + 0.680_70 * g + 0.107_40 * b).cbrt();
            let s = (0.088_30 * r + 0.281_72 * g + 0.629_98 * b).cbrt();
            [
                0.210_45 * l + 0.793_62 * m - 0.004_07 * s,
                1.978_00 * l - 2.428_59 * m + 0.450_59 * s,
                0.025_90 * l + 0.782_77 * m - 0.808_68 * s,
            ]
        };
        let (a, b) = (lab(a), lab(b));
        (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
    }

    #[test]
    fn a_pair_of_prisms_is_not_taken_for_a_station() {
        for (index, pair) in PAIRS.into_iter().enumerate() {
            for station in &STATIONS[..3] {
                assert!(difference(pair, *station) > 0.12, "{pair:?} {station:?}");
            }
            for other in &PAIRS[..index] {
                assert!(difference(pair, *other) > 0.2, "{pair:?} {other:?}");
            }
        }
    }

    #[test]
    fn a_trajectory_is_not_taken_for_a_station_or_for_an_error() {
        for (index, own) in ESTIMATES.into_iter().enumerate() {
            for other in STATIONS[..3].iter().chain(&VIRIDIS).chain(&ESTIMATES[..index]) {
                assert!(difference(own, *other) > 0.12, "{own:?} {other:?}");
            }
        }
    }

    #[test]
    fn stations_differ_from_each_other() {
        for (index, own) in STATIONS.into_iter().enumerate() {
            for other in &STATIONS[..index] {
                assert!(difference(own, *other) > 0.1, "{own:?} {other:?}");
            }
        }
    }

    #[test]
    fn interpolations_are_told_apart() {
        let [a, b, c] = Interpolation::ALL.map(interpolation);
        assert!([difference(a, b), difference(a, c), difference(b, c)].iter().all(|d| *d > 0.12));
    }
}
