//! Sizes of an estimate's noise and drift.

use std::ops::Range;

use super::state::{BY_CLOCK, BY_ORIENTATION, BY_POSITION, BY_SLOW_CLOCK, WANDERING};

/// Standard deviations of noise, random walks and clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriftSizes {
    /// Noise of a position (m) and of an orientation (rad), along an axis.
    pub position_m: f64,
    pub rotation_rad: f64,
    /// Errors that last (a Gauss–Markov process each): of a position (m), of an orientation (rad), and the time within which they change (s).
    pub lasting_m: f64,
    pub lasting_rad: f64,
    pub lasting_s: f64,
    /// Random walks: of the position (m/√s), of roll and pitch, and about the vertical (rad/√s).
    pub walk_m_per_root_s: f64,
    pub tilt_rad_per_root_s: f64,
    pub turn_rad_per_root_s: f64,
    /// Wander of the clock about the mean offset (s), and the time within which it changes (s).
    pub clock_s: f64,
    pub clock_time_s: f64,
    /// Slow wander of the clock, which changes within [`SLOW_S`] (s).
    pub slow_clock_s: f64,
    /// Rotation of the frame at the first epoch, where a filter that ran back ends (rad).
    pub first_rad: f64,
    /// True if the frame is aligned; otherwise the estimate is in the ground truth's frame.
    pub is_aligned: bool,
    /// True against few surveyed points.
    pub is_of_points: bool,
}

/// Standard deviation of the frame's rotation at the first epoch (rad), and one that is no information.
/// Effect: with a large one, the first epochs turn the frame by their noise, and the derivatives there are wrong. Simulated: on flat ground the
/// lever arm was wrong by up to 6 σ with 0.3 rad. On a circle the small one alone determines the lever arm along the motion.
const FIRST_RAD: f64 = 0.005;
const FREE_RAD: f64 = 0.1;

/// Time within which the slow wander of a clock changes (s).
/// Field: clocks without synchronisation, and delays of a link, wander within minutes.
pub const SLOW_S: f64 = 60.0;

/// Smallest and largest size in the units above.
pub const SIZE_LIMITS: [[f64; 2]; 11] = [
    [1e-5, 10.0],
    [1e-6, 1.0],
    [1e-5, 10.0],
    [1e-6, 1.0],
    [0.1, 10.0],
    [1e-6, 10.0],
    [1e-7, 0.3],
    [1e-7, 0.3],
    [1e-5, 1.0],
    [0.1, 300.0],
    [1e-5, 1.0],
];

impl DriftSizes {
    /// Sizes against few surveyed points: errors at these are independent.
    pub fn of_points(is_aligned: bool, misfit_m: f64) -> Self {
        const NONE: f64 = 1e-6;
        Self {
            position_m: misfit_m.max(1e-3),
            lasting_m: NONE,
            lasting_rad: NONE,
            walk_m_per_root_s: NONE,
            tilt_rad_per_root_s: NONE,
            turn_rad_per_root_s: NONE,
            clock_s: NONE,
            slow_clock_s: NONE,
            is_of_points: true,
            ..Self::usual(is_aligned, misfit_m)
        }
    }

    /// Size of each Gauss–Markov process, the time within which it changes (s), and its range in what wanders.
    pub fn processes(&self) -> [(f64, f64, Range<usize>); 4] {
        [
            (self.lasting_m, self.lasting_s, BY_POSITION..BY_ORIENTATION),
            (self.lasting_rad, self.lasting_s, BY_ORIENTATION..BY_CLOCK),
            (self.clock_s, self.clock_time_s, BY_CLOCK..BY_SLOW_CLOCK),
            (self.slow_clock_s, SLOW_S, BY_SLOW_CLOCK..WANDERING),
        ]
    }

    /// Sizes from which the search starts: those of a lidar odometry, or larger ones in proportion to a larger misfit (m).
    pub fn usual(is_aligned: bool, misfit_m: f64) -> Self {
        /// Misfit of a lidar odometry (m).
        const USUAL_M: f64 = 0.1;
        let times = (misfit_m / USUAL_M).clamp(1.0, 100.0);
        Self {
            position_m: 0.01 * times,
            rotation_rad: 2e-3,
            lasting_m: 0.01 * times,
            lasting_rad: 2e-3,
            lasting_s: 0.5,
            walk_m_per_root_s: 5e-3 * times,
            tilt_rad_per_root_s: 5e-4,
            turn_rad_per_root_s: 1e-3,
            clock_s: 1e-3,
            clock_time_s: 3.0,
            slow_clock_s: 2e-4,
            first_rad: FIRST_RAD,
            is_aligned,
            is_of_points: false,
        }
    }

    /// Returns the sizes with a frame that may be turned at the first epoch.
    pub fn with_free_frame(self) -> Self {
        Self { first_rad: FREE_RAD, ..self }
    }

    /// Returns the sizes with which a search begins: far below the errors, a size has no effect, so a slow wander would not be found from there.
    pub fn with_slow_clock(self) -> Self {
        const FIRST_S: f64 = 0.02;
        Self { slow_clock_s: if self.is_of_points { self.slow_clock_s } else { FIRST_S }, ..self }
    }

    /// Returns the sizes without slow wander of the clock.
    pub fn without_slow_clock(self) -> Self {
        Self { slow_clock_s: SIZE_LIMITS[10][0], ..self }
    }

    /// Number of sizes that the errors show: against few points only that of the noise.
    pub fn searched(&self) -> usize {
        if self.is_of_points { 1 } else { SIZE_LIMITS.len() }
    }

    /// Returns the sizes with a clock that walks as far in a second, but never returns to its mean.
    pub fn with_walking_clock(self) -> Self {
        const NEVER_S: f64 = 1e5;
        let walk = |size_s: f64, within_s: f64| size_s * (NEVER_S / within_s).sqrt();
        let clock_s = walk(self.clock_s, self.clock_time_s).max(walk(self.slow_clock_s, SLOW_S));
        Self { clock_s, clock_time_s: NEVER_S, ..self.without_slow_clock() }
    }

    fn all(&mut self) -> [&mut f64; 11] {
        [
            &mut self.position_m,
            &mut self.rotation_rad,
            &mut self.lasting_m,
            &mut self.lasting_rad,
            &mut self.lasting_s,
            &mut self.walk_m_per_root_s,
            &mut self.tilt_rad_per_root_s,
            &mut self.turn_rad_per_root_s,
            &mut self.clock_s,
            &mut self.clock_time_s,
            &mut self.slow_clock_s,
        ]
    }

    /// Logarithms of the sizes over others.
    pub fn ln_ratios(mut self, other: &Self) -> [f64; 11] {
        let mut other = *other;
        let (sizes, others) = (self.all(), other.all());
        std::array::from_fn(|index| (*sizes[index] / *others[index]).ln())
    }

    pub fn changed(mut self, index: usize, factor: f64) -> Self {
        let [least, most] = SIZE_LIMITS[index];
        let size = &mut self.all()[index];
        **size = (**size * factor).clamp(least, most);
        self
    }
}
