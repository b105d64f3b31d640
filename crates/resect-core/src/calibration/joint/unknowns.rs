//! What is unknown of stations and instruments, how well it is known beforehand, and how it moves the parts of a drive.

use nalgebra::{Matrix3, Rotation3, SMatrix, SVector, Vector3};

use super::band_rows::PART;
use crate::calibration::ErrorSizes;
use crate::geometry::LevelTransform;

/// Constants of a drive: (x, y, z, yaw) of stations 2 and 3; then by station or pair what the places below name.
pub const CONSTANTS: usize = 36;
pub const CLOCKS: usize = 8;
pub const DRIFTS: usize = 10;
pub const LATENCIES: usize = 12;
pub const DISTANCES: usize = 15;
pub const LEANS: usize = 18;
pub const OFFSETS: usize = 24;
pub const SCALES: usize = 27;
pub const INDICES: usize = 30;
pub const COLLIMATIONS: usize = 33;
/// What changes during a drive: (x, y, z, yaw) of stations 2 and 3, their clocks, and the ranges of stations 1 to 3.
pub const SLOW: usize = 13;
pub const SLOW_CLOCKS: usize = 8;
pub const SLOW_RANGES: usize = 10;

/// Places among the unknowns of a part.
pub const PART_LATE: usize = 6;
pub const PART_LATENCIES: usize = 8;
pub const PART_DISTANCES: usize = 11;

pub type Constants = SVector<f64, CONSTANTS>;
pub type Slow = SVector<f64, SLOW>;

/// The earth's radius, and how much less than it a sight bends (m, share): Gauss's coefficient.
pub const EARTH_RADIUS_M: f64 = 6.371e6;
pub const REFRACTION: f64 = 0.13;

/// 1/σ² of the constants; zero where nothing is known beforehand.
pub fn precisions(sizes: &ErrorSizes) -> Constants {
    // What is known exactly is what is hardly estimated.
    let of = |sigma: f64, least: f64| sigma.max(least).powi(-2);
    let mut precision = Constants::zeros();
    let mut fill = |places: std::ops::Range<usize>, value: f64| {
        precision.rows_mut(places.start, places.len()).fill(value);
    };
    fill(CLOCKS..DRIFTS, of(sizes.clock_offset_s, 1e-7));
    fill(DRIFTS..LATENCIES, of(sizes.clock_drift, 1e-9));
    fill(LATENCIES..DISTANCES, of(sizes.latency_s, 1e-7));
    fill(DISTANCES..LEANS, of(sizes.inter_prism_m, 1e-6));
    fill(LEANS..OFFSETS, of(sizes.lean_rad, 1e-9));
    fill(OFFSETS..SCALES, of(sizes.range_offset_m, 1e-6));
    fill(SCALES..INDICES, of(sizes.range_scale, 1e-8));
    fill(INDICES..COLLIMATIONS, of(sizes.index_rad, 1e-9));
    fill(COLLIMATIONS..CONSTANTS, of(sizes.collimation_rad, 1e-9));
    precision
}

/// The constants as the plain answer, the rig and a round earth have them.
pub fn start(plain: &[LevelTransform; 3], inter_prism_m: Option<&[f64; 3]>) -> Constants {
    let mut constants = Constants::zeros();
    for slot in 0..2 {
        let transform = &plain[slot + 1];
        constants.fixed_rows_mut::<3>(4 * slot).copy_from(&transform.translation_m);
        constants[4 * slot + 3] = transform.yaw_rad;
        // Up there leans away from station 1.
        let away = Vector3::new(transform.translation_m.x, transform.translation_m.y, 0.0);
        let lean = transform.inverse().rotate(&Vector3::z().cross(&away)) / EARTH_RADIUS_M;
        constants.fixed_rows_mut::<2>(LEANS + 2 * (slot + 1)).copy_from(&lean.xy());
    }
    constants.fixed_rows_mut::<3>(DISTANCES).copy_from_slice(inter_prism_m.unwrap_or(&[0.0; 3]));
    constants
}

/// One station's frame and instrument.
#[derive(Clone, Debug)]
pub struct Station {
    /// Turns what the station reads upright, and into station 1's directions.
    pub turn: Matrix3<f64>,
    pub place_m: Vector3<f64>,
    pub offset_m: f64,
    pub scale: f64,
    pub index_rad: f64,
    pub collimation_rad: f64,
    pub latency_s: f64,
    pub late_s: f64,
    pub drift: f64,
}

impl Station {
    pub fn of(constants: &Constants, station: usize) -> Self {
        let lean = LEANS + 2 * station;
        let lean = Rotation3::new(Vector3::new(constants[lean], constants[lean + 1], 0.0));
        let slot = station.checked_sub(1);
        let yaw_rad = slot.map_or(0.0, |slot| constants[4 * slot + 3]);
        let yaw = Rotation3::from_axis_angle(&Vector3::z_axis(), yaw_rad);
        Self {
            turn: *(yaw * lean).matrix(),
            place_m: slot
                .map_or_else(Vector3::zeros, |slot| constants.fixed_rows::<3>(4 * slot).into()),
            offset_m: constants[OFFSETS + station],
            scale: constants[SCALES + station],
            index_rad: constants[INDICES + station],
            collimation_rad: constants[COLLIMATIONS + station],
            latency_s: constants[LATENCIES + station],
            late_s: slot.map_or(0.0, |slot| constants[CLOCKS + slot]),
            drift: slot.map_or(0.0, |slot| constants[DRIFTS + slot]),
        }
    }

    /// Where a reading really points at (m, the upright station's own axes not yet turned).
    pub fn corrected(&self, sight: &Sight) -> Vector3<f64> {
        let range_m = sight.range_m * (1.0 - self.scale) - self.offset_m;
        let raised = self.index_rad - 0.5 * REFRACTION * sight.range_m / EARTH_RADIUS_M;
        sight.along * range_m + sight.up * (raised * sight.range_m)
            - sight.side * (self.collimation_rad * sight.range_m)
    }
}

/// A reading's direction in the station's own frame: unit vectors along it, to its right, and up.
#[derive(Clone, Copy, Debug)]
pub struct Sight {
    pub range_m: f64,
    pub along: Vector3<f64>,
    pub side: Vector3<f64>,
    pub up: Vector3<f64>,
}

impl Sight {
    pub fn at(point_m: &Vector3<f64>) -> Self {
        let range_m = point_m.norm().max(1e-9);
        let along = point_m / range_m;
        let side = along.cross(&Vector3::z()).try_normalize(1e-6).unwrap_or_else(Vector3::x);
        Self { range_m, along, side, up: side.cross(&along) }
    }
}

/// Where the readings of one station point at during a part, on average.
#[derive(Clone, Copy, Debug, Default)]
pub struct Outlook {
    pub along: Vector3<f64>,
    /// Lengths of the ranges along, up and to the right (m).
    pub point_m: Vector3<f64>,
    pub up_m: Vector3<f64>,
    pub side_m: Vector3<f64>,
}

impl Outlook {
    pub fn over(sights: impl Iterator<Item = Sight>) -> Option<Self> {
        let mut sum = Self::default();
        let mut count = 0.0;
        for sight in sights {
            sum.along += sight.along;
            sum.point_m += sight.along * sight.range_m;
            sum.up_m += sight.up * sight.range_m;
            sum.side_m += sight.side * sight.range_m;
            count += 1.0;
        }
        (count > 0.0).then(|| Self {
            along: sum.along / count,
            point_m: sum.point_m / count,
            up_m: sum.up_m / count,
            side_m: sum.side_m / count,
        })
    }
}

/// How what a station reads during a part moves with its own constants, and with its own slow states (m).
pub fn shifts(
    own: &Station,
    outlook: &Outlook,
    station: usize,
) -> (SMatrix<f64, 3, CONSTANTS>, SMatrix<f64, 3, SLOW>) {
    let turned = |vector: Vector3<f64>| own.turn * vector;
    let along = -turned(outlook.along);
    let columns = [
        (LEANS + 2 * station, turned(Vector3::x().cross(&outlook.point_m))),
        (LEANS + 2 * station + 1, turned(Vector3::y().cross(&outlook.point_m))),
        (OFFSETS + station, along),
        (SCALES + station, -turned(outlook.point_m)),
        (INDICES + station, turned(outlook.up_m)),
        (COLLIMATIONS + station, -turned(outlook.side_m)),
    ];
    let mut by_constants = SMatrix::<f64, 3, CONSTANTS>::zeros();
    for (column, vector) in &columns {
        by_constants.fixed_view_mut::<3, 1>(0, *column).copy_from(vector);
    }
    let mut by_slow = SMatrix::<f64, 3, SLOW>::zeros();
    by_slow.fixed_view_mut::<3, 1>(0, SLOW_RANGES + station).copy_from(&along);
    (by_constants, by_slow)
}

/// The constants that turn all that station 1 sees about its place, and the axes of that.
pub fn turns_of_station_1(own: &Station) -> [(usize, Vector3<f64>); 3] {
    let axes = [(LEANS, Vector3::x()), (LEANS + 1, Vector3::y()), (COLLIMATIONS, Vector3::z())];
    axes.map(|(column, axis)| (column, own.turn * axis))
}

/// How the unknowns of a part move with the constants, and with what is slow.
pub fn moves(
    stations: &[Station; 3],
    outlooks: &[Outlook; 3],
    since_middle_s: f64,
) -> (SMatrix<f64, PART, CONSTANTS>, SMatrix<f64, PART, SLOW>) {
    let mut by_constants = SMatrix::<f64, PART, CONSTANTS>::zeros();
    let mut by_slow = SMatrix::<f64, PART, SLOW>::zeros();
    for (station, (own, outlook)) in stations.iter().zip(outlooks).enumerate() {
        let (shift_by_constants, shift_by_slow) = shifts(own, outlook, station);
        // A shift of station 1 is one of the other two, the other way.
        let shifted: &[(usize, f64)] = match station {
            0 => &[(0, -1.0), (3, -1.0)],
            1 => &[(0, 1.0)],
            _ => &[(3, 1.0)],
        };
        for (row, sign) in shifted {
            let mut rows = by_constants.fixed_rows_mut::<3>(*row);
            rows += shift_by_constants * *sign;
            let mut rows = by_slow.fixed_rows_mut::<3>(*row);
            rows += shift_by_slow * *sign;
        }
        by_constants[(PART_LATENCIES + station, LATENCIES + station)] = 1.0;
        by_constants[(PART_DISTANCES + station, DISTANCES + station)] = 1.0;
        let Some(slot) = station.checked_sub(1) else { continue };
        let point_m = own.turn * outlook.point_m;
        // What turns all that station 1 sees turns the rig as well, from moment to moment, and not as it stands on average.
        // Told as a turn of the others where they are, it is the same for the data, and nothing of it is left where yaws and
        // places make up for it.
        let apart_m = point_m + own.place_m - stations[0].turn * outlooks[0].point_m;
        for (column, axis) in turns_of_station_1(&stations[0]) {
            let mut rows = by_constants.fixed_view_mut::<3, 1>(3 * slot, column);
            rows -= axis.cross(&apart_m);
        }
        let arm = Vector3::z().cross(&point_m);
        for axis in 0..3 {
            by_constants[(3 * slot + axis, 4 * slot + axis)] = 1.0;
            by_slow[(3 * slot + axis, 4 * slot + axis)] = 1.0;
            by_constants[(3 * slot + axis, 4 * slot + 3)] = arm[axis];
            by_slow[(3 * slot + axis, 4 * slot + 3)] = arm[axis];
        }
        by_constants[(PART_LATE + slot, CLOCKS + slot)] = 1.0;
        by_constants[(PART_LATE + slot, DRIFTS + slot)] = since_middle_s;
        by_slow[(PART_LATE + slot, SLOW_CLOCKS + slot)] = 1.0;
    }
    (by_constants, by_slow)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Stations that see a rig which turns: nowhere near level, and the rig's own directions all but averaged out.
    fn some() -> (Constants, [Station; 3], [Outlook; 3]) {
        let mut constants = Constants::zeros();
        for (place, value) in
            [60.0, -12.0, 1.5, 0.7, 35.0, 48.0, -2.0, -2.1].into_iter().enumerate()
        {
            constants[place] = value;
        }
        let stations = [0, 1, 2].map(|station| Station::of(&constants, station));
        let outlooks = [0, 1, 2].map(|k: usize| {
            let own = &stations[k];
            let sights = (0..15).map(|i| {
                let (t, turned) = (0.4 * f64::from(i), 0.3 * f64::from(i) + 2.1 * k as f64);
                let rig_m = Vector3::new(0.6 * turned.cos(), 0.6 * turned.sin(), 0.2 * k as f64);
                let prism_m = Vector3::new(30.0 + t, 20.0 - 0.5 * t, 0.8) + rig_m;
                Sight::at(&own.turn.tr_mul(&(prism_m - own.place_m)))
            });
            Outlook::over(sights).expect("sights")
        });
        (constants, stations, outlooks)
    }

    /// What moves if all turns about an axis through station 1, each station by its lean, or by its yaw and station 1 by
    /// its collimation.
    fn all_turned(axis: &Vector3<f64>, lean: bool) -> f64 {
        let (constants, stations, outlooks) = some();
        let mut turn = Constants::zeros();
        for slot in 0..2 {
            let place: Vector3<f64> = constants.fixed_rows::<3>(4 * slot).into();
            turn.fixed_rows_mut::<3>(4 * slot).copy_from(&axis.cross(&place));
        }
        if lean {
            for station in 0..3 {
                let own = stations[station].turn.tr_mul(axis);
                turn.fixed_rows_mut::<2>(LEANS + 2 * station).copy_from(&own.xy());
            }
        } else {
            (turn[3], turn[7], turn[COLLIMATIONS]) = (1.0, 1.0, 1.0);
        }
        (moves(&stations, &outlooks, 0.0).0 * turn).amax()
    }

    #[test]
    fn what_turns_all_stations_alike_is_nothing_to_the_data() {
        assert!(all_turned(&Vector3::x(), true) < 1e-9);
        assert!(all_turned(&Vector3::y(), true) < 1e-9);
        // A collimation acts on the slope, and a yaw on the distance over ground: they differ where sights are steep.
        let steep = all_turned(&Vector3::z(), false);
        assert!(steep > 1e-4 && steep < 0.03, "{steep} m a radian");
    }
}
