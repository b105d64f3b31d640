//! The paper in plain loops: its pipeline and its method D, from polar readings to the transforms T12 and T13.
//!
//! ```sh
//! cargo run --release --example paper                 # the built-in sample
//! cargo run --release --example paper -- FOLDER PRISM_CONSTANT_M
//! ```
//!
//! `FOLDER` has `inter_prism.csv` with a line `timestamp,id,distance,ha,va` for each reading (s, 1 to 3, m, rad, rad), and
//! `calibration_results.csv`, whose first three numbers are the distances of prisms 1–2, 1–3 and 2–3 (m). Source: Vaidis et al. 2022,
//! "Extrinsic calibration for highly accurate trajectories reconstruction", sections III-B (pipeline) and III-C (calibration). The program
//! computes the same faster and with uncertainty, checks and verdict; a test holds the two together to 1 µm.

#![allow(clippy::print_stdout, reason = "an example prints")]

use std::error::Error;
use std::f64::consts::PI;
use std::path::Path;

use nalgebra::{SMatrix, SVector, Vector3};
use resect_core::geometry::{LevelTransform, Polar, wrap_to_pi};

/// Thresholds of the paper: rates of range, azimuth and zenith angle, longest gap, shortest interval, rate of the triplets.
const TAU_R_M_PER_S: f64 = 2.0;
const TAU_A_RAD_PER_S: f64 = PI / 180.0;
const TAU_E_RAD_PER_S: f64 = PI / 180.0;
const TAU_S_SECONDS: f64 = 1.0;
const TAU_L_SECONDS: f64 = 6.0;
const RATE_HZ: f64 = 10.0;
/// Steps of the speed limit in the search of a prior.
const TAU_V_M_PER_S: f64 = 0.1;
/// Pairs of prisms, in the order of the measured distances.
const PAIRS: [(usize, usize); 3] = [(0, 1), (0, 2), (1, 2)];

/// One reading of a station.
struct Reading {
    time_s: f64,
    polar: Polar,
}

/// The readings of one station that passed the outlier filter: stamps (s) and positions in its frame (m).
#[derive(Default)]
struct Track {
    time_s: Vec<f64>,
    position_m: Vec<Vector3<f64>>,
}

/// Positions of the three prisms at one instant, each in the frame of the station that follows it (m), and the speed of prism 1.
struct Triplet {
    point_m: [Vector3<f64>; 3],
    speed_m_per_s: f64,
}

/// The unknowns: x, y, z (m) and yaw (rad) of station 2, then of station 3, in the frame of station 1.
type Unknowns = SVector<f64, 8>;
type Jacobian = SMatrix<f64, 8, 3>;

fn main() -> Result<(), Box<dyn Error>> {
    let sample = concat!(env!("CARGO_MANIFEST_DIR"), "/crates/resect-io/assets/samples/warthog");
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (folder, prism_constant_m) = match &arguments[..] {
        [folder, constant_m] => (folder.as_str(), constant_m.parse()?),
        _ => (sample, 0.01),
    };
    let transforms = calibrate(Path::new(folder), prism_constant_m)?;
    for (station, transform) in transforms.iter().enumerate().skip(1) {
        let [x, y, z] = transform.translation_m.into();
        let yaw_rad = transform.yaw_rad;
        println!("T1{}: {x:.4} {y:.4} {z:.4} m, yaw {yaw_rad:.6} rad", station + 1);
    }
    Ok(())
}

type Transforms = [LevelTransform; 3];

/// Calibrates a folder; returns the frames of the three stations in that of station 1.
pub fn calibrate(folder: &Path, prism_constant_m: f64) -> Result<Transforms, Box<dyn Error>> {
    let readings = read(&folder.join("inter_prism.csv"), prism_constant_m)?;
    let measured = std::fs::read_to_string(folder.join("calibration_results.csv"))?;
    let numbers = measured.split_whitespace().map(str::parse).collect::<Result<Vec<f64>, _>>()?;
    let distances_m = [numbers[0], numbers[1], numbers[2]];

    let tracks = readings.map(|readings| filter_outliers(&readings));
    let mut intervals = split_intervals(&tracks);
    // Module 3 drops short intervals.
    intervals.retain(|[start_s, end_s]| end_s - start_s > TAU_L_SECONDS);
    let triplets = interpolate(&tracks, &intervals);

    let prior = search_prior(&triplets, &distances_m);
    Ok(transforms(&minimise_twins(&triplets, &distances_m, &prior)))
}

fn read(path: &Path, prism_constant_m: f64) -> Result<[Vec<Reading>; 3], Box<dyn Error>> {
    let mut readings: [Vec<Reading>; 3] = Default::default();
    for line in std::fs::read_to_string(path)?.lines().skip(1) {
        let numbers: Vec<f64> = line.split(',').map(str::parse).collect::<Result<_, _>>()?;
        let [time_s, id, range_m, azimuth_rad, zenith_rad] = numbers[..] else {
            return Err(format!("`{line}` has not five columns").into());
        };
        let polar = Polar { range_m: range_m + prism_constant_m, azimuth_rad, zenith_rad };
        let own = readings.get_mut(id as usize - 1).ok_or("a station is 1, 2 or 3")?;
        own.push(Reading { time_s, polar });
    }
    Ok(readings)
}

/// Module 1: drops a reading that changes too fast since the reading before it, and converts the others to Cartesian coordinates.
fn filter_outliers(readings: &[Reading]) -> Track {
    let mut track = Track::default();
    for (index, reading) in readings.iter().enumerate() {
        if index > 0 {
            let before = &readings[index - 1];
            let elapsed_s = reading.time_s - before.time_s;
            let range_m = reading.polar.range_m - before.polar.range_m;
            let azimuth_rad = wrap_to_pi(reading.polar.azimuth_rad - before.polar.azimuth_rad);
            let zenith_rad = reading.polar.zenith_rad - before.polar.zenith_rad;
            if range_m.abs() / elapsed_s > TAU_R_M_PER_S
                || azimuth_rad.abs() / elapsed_s > TAU_A_RAD_PER_S
                || zenith_rad.abs() / elapsed_s > TAU_E_RAD_PER_S
            {
                continue;
            }
        }
        track.time_s.push(reading.time_s);
        track.position_m.push(reading.polar.to_cartesian());
    }
    track
}

/// Module 2: cuts each track at its gaps, and returns the intersections of the three tracks' intervals (start and end, s).
fn split_intervals(tracks: &[Track; 3]) -> Vec<[f64; 2]> {
    let mut common = vec![[f64::NEG_INFINITY, f64::INFINITY]];
    for track in tracks {
        let mut own: Vec<[f64; 2]> = Vec::new();
        for time_s in &track.time_s {
            match own.last_mut() {
                Some([_, end_s]) if time_s - *end_s <= TAU_S_SECONDS => *end_s = *time_s,
                _ => own.push([*time_s, *time_s]),
            }
        }
        let mut intersections = Vec::new();
        for [start_s, end_s] in &common {
            for [own_start_s, own_end_s] in &own {
                let overlap = [start_s.max(*own_start_s), end_s.min(*own_end_s)];
                if overlap[1] > overlap[0] {
                    intersections.push(overlap);
                }
            }
        }
        common = intersections;
    }
    common
}

/// Module 4: interpolates the three tracks linearly at the same instants, [`RATE_HZ`] from the start of each interval.
fn interpolate(tracks: &[Track; 3], intervals: &[[f64; 2]]) -> Vec<Triplet> {
    let mut triplets = Vec::new();
    for [start_s, end_s] in intervals {
        let first = triplets.len();
        let steps = ((end_s - start_s) * RATE_HZ).floor() as usize;
        for step in 0..=steps {
            let time_s = start_s + step as f64 / RATE_HZ;
            let point_m = tracks.each_ref().map(|track| {
                let after = track.time_s.partition_point(|t| *t < time_s);
                let after = after.clamp(1, track.time_s.len() - 1);
                let (t0, t1) = (track.time_s[after - 1], track.time_s[after]);
                let (p0, p1) = (track.position_m[after - 1], track.position_m[after]);
                p0 + (p1 - p0) * ((time_s - t0) / (t1 - t0))
            });
            // The speed of an interval's first triplet is unknown: it never counts as slow.
            triplets.push(Triplet { point_m, speed_m_per_s: f64::INFINITY });
        }
        for index in first + 1..triplets.len() {
            let moved_m = triplets[index].point_m[0] - triplets[index - 1].point_m[0];
            triplets[index].speed_m_per_s = moved_m.norm() * RATE_HZ;
        }
    }
    triplets
}

/// The paper's search of a prior: starts from a point-to-point alignment, as if the prisms were in one place, and admits faster and
/// faster triplets. A second pass starts each step from the best result of the first. Best is the smallest median distance error.
fn search_prior(triplets: &[Triplet], distances_m: &[f64; 3]) -> Unknowns {
    let mut start = align_points(triplets);
    let mut best = (f64::INFINITY, start);
    for pass in 0..2 {
        let mut unknowns = start;
        for step in 0..25 {
            let limit_m_per_s = 0.01 + TAU_V_M_PER_S * f64::from(step);
            let is_slow = |triplet: &&Triplet| triplet.speed_m_per_s <= limit_m_per_s;
            let slow: Vec<&Triplet> = triplets.iter().filter(is_slow).collect();
            let from = if pass == 0 { unknowns } else { start };
            let Some((_, minimum)) = minimise(&slow, distances_m, &from) else { continue };
            unknowns = minimum;
            let errors_m = triplets.iter().flat_map(|t| residuals(t, distances_m, &minimum).0);
            let mut errors_m: Vec<f64> = errors_m.map(f64::abs).collect();
            errors_m.sort_by(f64::total_cmp);
            if errors_m[errors_m.len() / 2] < best.0 {
                best = (errors_m[errors_m.len() / 2], minimum);
            }
        }
        start = best.1;
    }
    start
}

/// Level alignment of the points of stations 2 and 3 with those of station 1 in closed form.
fn align_points(triplets: &[Triplet]) -> Unknowns {
    let sum = |k: usize| triplets.iter().map(|triplet| triplet.point_m[k]).sum::<Vector3<f64>>();
    let mean = |station: usize| sum(station) / triplets.len() as f64;
    let mut unknowns = Unknowns::zeros();
    for slot in 0..2 {
        let (mean_1, mean_own) = (mean(0), mean(slot + 1));
        let (mut sin, mut cos) = (0.0, 0.0);
        for triplet in triplets {
            let (a, b) = (triplet.point_m[0] - mean_1, triplet.point_m[slot + 1] - mean_own);
            cos += a.x * b.x + a.y * b.y;
            sin += a.y * b.x - a.x * b.y;
        }
        let yaw = LevelTransform::new(Vector3::zeros(), f64::atan2(sin, cos));
        let translation_m = mean_1 - yaw.rotate(&mean_own);
        unknowns.fixed_rows_mut::<3>(4 * slot).copy_from(&translation_m);
        unknowns[4 * slot + 3] = yaw.yaw_rad;
    }
    unknowns
}

/// Minimises over all triplets, also from other heights of stations 2 and 3: on level ground a mirror image of the rig fits nearly as
/// well. Returns the lowest minimum.
fn minimise_twins(triplets: &[Triplet], distances_m: &[f64; 3], prior: &Unknowns) -> Unknowns {
    let all: Vec<&Triplet> = triplets.iter().collect();
    let mut best = (f64::INFINITY, *prior);
    for (dz_2_m, dz_3_m) in [(0.0, 0.0), (0.5, 0.5), (0.5, -0.5), (-0.5, 0.5), (-0.5, -0.5)] {
        let mut start = *prior;
        start[2] += dz_2_m;
        start[6] += dz_3_m;
        let minimum = minimise(&all, distances_m, &start);
        best = minimum.filter(|(cost, _)| *cost < best.0).unwrap_or(best);
    }
    best.1
}

/// Minimises the paper's cost, Σ (‖q₁ − T₁₂q₂‖ − d₁₂)² + (‖q₁ − T₁₃q₃‖ − d₁₃)² + (‖T₁₂q₂ − T₁₃q₃‖ − d₂₃)², by Levenberg–Marquardt
/// steps. Returns the cost (m²) and the unknowns.
fn minimise(triplets: &[&Triplet], d_m: &[f64; 3], start: &Unknowns) -> Option<(f64, Unknowns)> {
    let cost = |unknowns: &Unknowns| -> f64 {
        let all_m = triplets.iter().flat_map(|triplet| residuals(triplet, d_m, unknowns).0);
        all_m.map(|residual_m| residual_m * residual_m).sum()
    };
    let (mut unknowns, mut damping) = (*start, 1e-3);
    let mut least = cost(&unknowns);
    for _ in 0..200 {
        let (mut normal, mut gradient) = (SMatrix::<f64, 8, 8>::zeros(), Unknowns::zeros());
        for triplet in triplets {
            let (residuals_m, jacobian) = residuals(triplet, d_m, &unknowns);
            normal += jacobian * jacobian.transpose();
            gradient += jacobian * SVector::from(residuals_m);
        }
        for index in 0..8 {
            normal[(index, index)] *= 1.0 + damping;
        }
        let step = normal.cholesky()?.solve(&gradient);
        let next = unknowns - step;
        let next_cost = cost(&next);
        if next_cost <= least {
            (unknowns, least, damping) = (next, next_cost, damping * 0.1);
        } else {
            damping *= 10.0;
        }
        if step.amax() < 1e-11 || damping > 1e12 {
            break;
        }
    }
    Some((least, unknowns))
}

/// Residuals of a triplet's three distances (m), and their Jacobian, a column for each residual.
fn residuals(triplet: &Triplet, d_m: &[f64; 3], unknowns: &Unknowns) -> ([f64; 3], Jacobian) {
    let transforms = transforms(unknowns);
    let prisms_m = [0, 1, 2].map(|station| transforms[station].apply(&triplet.point_m[station]));
    let (mut residuals_m, mut jacobian) = ([0.0; 3], Jacobian::zeros());
    for (pair, (a, b)) in PAIRS.into_iter().enumerate() {
        let between_m = prisms_m[a] - prisms_m[b];
        let along = between_m / between_m.norm();
        residuals_m[pair] = between_m.norm() - d_m[pair];
        for (station, sign) in [(a, 1.0), (b, -1.0)] {
            // Station 1 has no unknowns.
            let Some(slot) = station.checked_sub(1) else { continue };
            let rotated_m = transforms[station].rotate(&triplet.point_m[station]);
            let by_yaw_m = Vector3::z().cross(&rotated_m);
            jacobian.fixed_view_mut::<3, 1>(4 * slot, pair).copy_from(&(along * sign));
            jacobian[(4 * slot + 3, pair)] = sign * along.dot(&by_yaw_m);
        }
    }
    (residuals_m, jacobian)
}

fn transforms(u: &Unknowns) -> Transforms {
    let transform = |k: usize| LevelTransform::new(u.fixed_rows::<3>(k).into(), u[k + 3]);
    [LevelTransform::IDENTITY, transform(0), transform(4)]
}
