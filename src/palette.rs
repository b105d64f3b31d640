//! The colours that mean something, the same in the window, in pictures and in Rerun.
//!
//! From Okabe & Ito's set, which stays distinct for colour-blind eyes.

use crate::calibration::Verdict;
use crate::calibration::inter_prism::observability::Hold;
use crate::pipeline::{OutlierReason, SampleFate};
use crate::validation::Outcome;

/// Red, green, blue, sRGB.
pub type Rgb = [u8; 3];

/// Stations (and their prisms) 1, 2, 3: blue, orange, green.
pub const STATIONS: [Rgb; 3] = [[86, 160, 233], [230, 159, 0], [0, 178, 130]];

/// Pairs 12, 13, 23: cyan, vermilion, purple, none of them a station's.
pub const PAIRS: [Rgb; 3] = [[70, 190, 205], [224, 100, 30], [176, 120, 214]];

/// Series of a study: blue, vermilion, green.
pub const SERIES: [Rgb; 3] = [[60, 130, 200], [213, 94, 0], [0, 150, 110]];

/// What became of a raw reading.
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

/// Ground of a verdict's badge, and black or white text that can be read on it.
pub fn verdict(verdict: Verdict) -> [Rgb; 2] {
    match verdict {
        Verdict::Good => [[0, 140, 100], [255; 3]],
        Verdict::Weak => [[230, 159, 0], [0; 3]],
        Verdict::Ambiguous => [[204, 121, 167], [0; 3]],
        Verdict::Degenerate => [[200, 60, 30], [255; 3]],
    }
}

/// Ground of the badge of whether a calibration holds for another run, and text that can be read on it.
pub fn outcome(outcome: &Outcome) -> [Rgb; 2] {
    verdict(match outcome {
        Outcome::Holds => Verdict::Good,
        Outcome::CannotBeTold(_) => Verdict::Weak,
        Outcome::DoesNotHold(_) => Verdict::Degenerate,
    })
}

/// How a drive holds a direction: vermilion, purple, grey.
pub fn hold(hold: Hold) -> Rgb {
    match hold {
        Hold::Free => [226, 82, 40],
        Hold::Weak => [204, 121, 167],
        Hold::Held => [120, 150, 170],
    }
}

/// What has no value on a scale.
pub const NO_VALUE: Rgb = [110, 118, 128];

/// Intervals, over and over: all of Okabe & Ito's set but black.
pub const INTERVALS: [Rgb; 7] = [
    [86, 180, 233],
    [230, 159, 0],
    [0, 158, 115],
    [204, 121, 167],
    [240, 228, 66],
    [213, 94, 0],
    [0, 114, 178],
];

/// What went well: the set's green.
pub const DONE: Rgb = INTERVALS[2];

/// An interval, numbered from 0.
pub fn interval(number: u32) -> Rgb {
    INTERVALS[number as usize % INTERVALS.len()]
}

/// Viridis (Smith & van der Walt, matplotlib 2.0; perceptually uniform, safe for colour-blind eyes) at every eighth from
/// 1/4 to 1: its darkest quarter cannot be seen on a dark ground.
const VIRIDIS: [Rgb; 7] = [
    [59, 82, 139],
    [44, 114, 142],
    [33, 144, 140],
    [39, 173, 129],
    [93, 200, 99],
    [170, 220, 50],
    [253, 231, 37],
];

/// A place on a scale from 0 to 1; beyond its ends, theirs.
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
