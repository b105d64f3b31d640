//! Minima of the cost of method D.

use super::centred::CentredTriplets;
use super::levenberg_marquardt::Minimum;
use crate::geometry::LevelTransform;
use crate::network::PerStation;

/// A minimum of the cost.
#[derive(Clone, Debug, PartialEq)]
pub struct Basin {
    pub station1_from_station: PerStation<LevelTransform>,
    /// Mean squared inter-prism error (m²): the paper's `cost_function_2`.
    pub mean_square_m2: f64,
    /// Mean height of station 1's prism above that of each station in this solution (m); zero for station 1.
    pub height_differences_m: PerStation<f64>,
}

impl Basin {
    /// Returns true for the mirror twin of a solution: most of its prisms are on the other side of station 1's in height.
    pub fn is_mirrored(&self, other: &Self) -> bool {
        let both = self.height_differences_m.iter().zip(&other.height_differences_m);
        both.map(|(own_m, other_m)| own_m * other_m).sum::<f64>() < 0.0
    }

    /// Returns the largest distance between the positions of a station in two solutions (m).
    pub fn apart_m(&self, other: &Self) -> f64 {
        self.station1_from_station
            .iter()
            .zip(&other.station1_from_station)
            .map(|(a, b)| (a.translation_m - b.translation_m).norm())
            .fold(0.0, f64::max)
    }
}

/// Largest difference of a station's heights in two solutions (m).
pub fn heights_apart_m(a: &PerStation<LevelTransform>, b: &PerStation<LevelTransform>) -> f64 {
    let both = a.iter().zip(b);
    both.map(|(a, b)| (a.translation_m - b.translation_m).z.abs()).fold(0.0, f64::max)
}

/// Returns a minimum as a solution with its cost.
pub fn basin(data: &CentredTriplets, minimum: &Minimum) -> Basin {
    Basin {
        station1_from_station: data.transforms(&minimum.parameters),
        mean_square_m2: data.mean_square_m2(minimum.normal.cost),
        height_differences_m: data.height_differences_m(&minimum.parameters),
    }
}
