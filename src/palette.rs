//! The colours that mean something, the same in the window, in pictures and in Rerun.
//!
//! From Okabe & Ito's set, which stays distinct for colour-blind eyes.

use crate::calibration::Verdict;
use crate::calibration::inter_prism::observability::Hold;
use crate::pipeline::{OutlierReason, SampleFate};

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

/// How a drive holds a direction: vermilion, purple, grey.
pub fn hold(hold: Hold) -> Rgb {
    match hold {
        Hold::Free => [226, 82, 40],
        Hold::Weak => [204, 121, 167],
        Hold::Held => [120, 150, 170],
    }
}
