//! Method A: two-point resection, in closed form.
//!
//! A level station has four unknowns, and two points with a known relative position give six equations. A level alignment places
//! the station in the frame of the points (Vaidis et al. 2022, section "Static methods", "Two-point resection"). Every pair of
//! known points is tried, and judged by the points that it does not use.

use crate::deployment::findings::points::{
    known_distance_off, known_point_misplaced, resection_inconsistent, resection_pair,
    resection_unchecked,
};
use crate::network::{Number, PerStation, Station};
use nalgebra::Vector3;

use super::checks;
use super::common_errors::{self, Displaced};
use super::judgement::Judgement;
use super::method_answer::MethodAnswer;
use super::point_to_point::{self, Errors, Matches};
use super::{Alignment, CalibrationError, ErrorSizes, Method, Offer};
use crate::deployment::{ControlPoint, ControlPointSet, Deployment, Finding};
use crate::geometry::ARCSECOND_RAD;
use crate::geometry::RigidTransform;
use crate::pipeline::Triplets;
use crate::statistics::{median, quantile_of_sorted};

/// Accuracy of ranges (m). Source: the paper's nominal value (Vaidis et al. 2022).
const RANGE_SIGMA_M: f64 = 0.002;
/// Accuracy of angles (rad). Source: the paper's nominal value, an arcsecond (Vaidis et al. 2022).
const ANGLE_SIGMA_RAD: f64 = ARCSECOND_RAD;
/// A larger distance error suggests a wrong atmospheric correction, if it exceeds the limit in metres as well (ppm).
const NOTABLE_PPM: f64 = 10.0;
/// A larger distance error suggests a wrong atmospheric correction, if it exceeds the limit in ppm as well. The noise of three
/// stations together hardly reaches it.
const NOTABLE_M: f64 = 0.008;
/// A point with this many times the error of the next is reported and excluded.
const MISPLACED: f64 = 3.0;
/// Median of the sum of two squared normal errors, over their variance. Textbook: χ² of two degrees of freedom.
const MEDIAN_OF_TWO_SQUARES: f64 = 2.0 * std::f64::consts::LN_2;

/// Resection by one pair of points.
#[derive(Clone, Debug, PartialEq)]
pub struct PairResection {
    pub file: String,
    pub markers: [i64; 2],
    /// Known distance between the two points (m).
    pub baseline_m: f64,
    /// Measured minus known distance between the two points, for each station (m).
    pub baseline_errors_m: PerStation<f64>,
    pub station1_from_station: PerStation<RigidTransform>,
    /// Distances between the stations' positions of the points that the pair does not use (m), sorted.
    pub left_out_m: Vec<f64>,
    /// Points that the pair does not use.
    pub left_out: Vec<LeftOut>,
}

/// A point that the pair does not use.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeftOut {
    pub marker: i64,
    /// Mean distance of the stations' positions of the point from its known position (m).
    pub from_known_m: f64,
}

impl PairResection {
    /// Returns the largest distance of an unused point from its known position (m).
    pub fn largest_from_known_m(&self) -> Option<f64> {
        self.left_out.iter().map(|left_out| left_out.from_known_m).max_by(f64::total_cmp)
    }

    /// Returns the median distance between the stations' positions of unused points (m). The positions of one station are compared
    /// with the known ones.
    pub fn median_left_out_m(&self) -> Option<f64> {
        let from_known_m = || median(self.left_out.iter().map(|left_out| left_out.from_known_m));
        quantile_of_sorted(&self.left_out_m, 0.5).or_else(from_known_m)
    }

    fn stations(&self) -> usize {
        self.station1_from_station.len()
    }
}

/// All pairs, and the chosen one.
#[derive(Clone, Debug, PartialEq)]
pub struct TwoPointDetails {
    pub pairs: Vec<PairResection>,
    pub chosen: usize,
}

impl TwoPointDetails {
    /// Returns the root mean square of the chosen pair's baseline errors (m).
    pub fn rms_m(&self) -> f64 {
        let errors = &self.pairs[self.chosen].baseline_errors_m;
        (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt()
    }
}

/// Calibrates by the pair of points whose resection fits the other points best.
pub fn solve(
    deployment: &Deployment,
    triplets: &Triplets,
    sizes: &ErrorSizes,
    offer: &Offer,
) -> Result<MethodAnswer<TwoPointDetails>, CalibrationError> {
    let mut pairs = Vec::new();
    let mut placed = Vec::new();
    for set in &deployment.control_points {
        let points: Vec<&ControlPoint> =
            set.points.iter().filter(|point| point.serves_resection()).collect();
        for a in 0..points.len() {
            for b in a + 1..points.len() {
                if let Some((pair, worlds)) = resect(set, &points, [a, b]) {
                    pairs.push(pair);
                    placed.push(worlds);
                }
            }
        }
    }
    let misplaced = misplaced(&pairs);
    let sound = |i: &usize| misplaced.as_ref().is_none_or(|point| !point.is_in(&pairs[*i]));
    // Unused points are the best criterion; without them, the longest baseline determines yaw best.
    let by_left_out = |i: &usize| pairs[*i].median_left_out_m().unwrap_or(f64::INFINITY);
    let chosen = (0..pairs.len())
        .filter(sound)
        .min_by(|i, j| {
            let by_baseline = pairs[*j].baseline_m.total_cmp(&pairs[*i].baseline_m);
            by_left_out(i).total_cmp(&by_left_out(j)).then(by_baseline)
        })
        .ok_or_else(|| CalibrationError::lacking(deployment, Method::TwoPoint, offer))?;

    let same_file = |i: &usize| pairs[*i].file == pairs[chosen].file;
    let alike = (0..pairs.len()).filter(same_file).filter(sound);
    let sigma_m = point_sigma_m(alike.map(|index| &placed[index]));
    let matches = &placed[chosen].matches;
    let aligned = point_to_point::align(matches, Alignment::Level, Errors::Known(sigma_m));
    let covariance = aligned.and_then(|aligned| aligned.covariance);
    let (station1_from_station, covariance) = point_to_point::relative_to_station1(
        &placed[chosen].world_from_station,
        covariance.as_ref(),
    );
    // Two points have hardly any residuals.
    let common = common_errors::effect(sizes, matches.len(), 0, &[], |displace| {
        let displaced: Vec<Matches> = (matches.iter().enumerate())
            .map(|(station, matches)| {
                let read = matches.from_m.iter();
                let from_m = read.map(|point| displace(Station::at(station), point)).collect();
                Matches { from_m, ..matches.clone() }
            })
            .collect();
        let worlds = point_to_point::transforms(&displaced, Alignment::Level)?;
        let worlds = worlds.into_iter().collect();
        let station1_from_station = point_to_point::relative_to_station1(&worlds, None).0;
        Some(Displaced::new(station1_from_station, &[]))
    });
    let settling = common_errors::settling(sizes, &station1_from_station);
    let covariance = covariance
        .zip(common)
        .map(|(own, common)| point_to_point::level_part(&own) + common.covariance + settling);
    let mut judgement = Judgement::good(findings(&pairs, chosen));
    let doubt = match pairs[chosen].median_left_out_m() {
        None => Some(resection_unchecked()),
        Some(median_m) => {
            let stations = pairs[chosen].stations();
            (median_m > checks::WEAK_SIGMA_M).then(|| resection_inconsistent(median_m, stations))
        }
    };
    judgement.doubt(doubt);
    judgement.doubt(misplaced.map(|point| point.finding()));
    let mut answer = MethodAnswer {
        method: Method::TwoPoint,
        station1_from_station,
        covariance,
        judgement,
        checked_by: Vec::new(),
        details: TwoPointDetails { pairs, chosen },
        prior_ms: 0.0,
    };
    let rms_m = answer.details.rms_m();
    checks::check_with_unused_data(&mut answer, rms_m, deployment, triplets, None);
    Ok(answer)
}

struct PlacedStation {
    world_from_station: PerStation<RigidTransform>,
    matches: Vec<Matches>,
    /// Sum of squared residuals of each station (m²).
    squares_m2: Vec<f64>,
    /// The largest range (m).
    range_m: f64,
}

fn resect(
    set: &ControlPointSet,
    points: &[&ControlPoint],
    chosen: [usize; 2],
) -> Option<(PairResection, PlacedStation)> {
    let mut matches = vec![Matches::default(); points.first()?.readings.len()];
    for (order, index) in chosen.into_iter().enumerate() {
        for (matches, reading) in matches.iter_mut().zip(&points[index].readings) {
            let (known_m, reading) = (points[index].known_m?, reading.as_ref()?);
            matches.push(known_m, reading.to_cartesian(), order as u32);
        }
    }
    let aligned = point_to_point::align(&matches, Alignment::Level, Errors::Known(1.0))?;
    // Two points at one place, or one above the other, do not determine yaw.
    aligned.covariance.as_ref()?;
    let world_from_station: PerStation<RigidTransform> = aligned.to_from.into_iter().collect();
    let residuals_m = aligned.residuals_m.iter();
    let squares_m2 = residuals_m
        .map(|residuals_m| residuals_m.iter().map(Vector3::norm_squared).sum())
        .collect();
    let range_m = matches.iter().flat_map(|m| &m.from_m).map(Vector3::norm).fold(0.0, f64::max);

    let (mut left_out_m, mut left_out) = (Vec::new(), Vec::new());
    for (_, point) in points.iter().enumerate().filter(|(i, _)| !chosen.contains(i)) {
        let read = world_from_station.iter().zip(&point.readings);
        let placed: Vec<Vector3<f64>> = read
            .filter_map(|(world_from_station, reading)| {
                Some(world_from_station.apply(&reading.as_ref()?.to_cartesian()))
            })
            .collect();
        left_out_m.extend(point.disagreements_m(&world_from_station));
        let known_m = point.known_m?;
        let from_known_m =
            placed.iter().map(|p| (p - known_m).norm()).sum::<f64>() / placed.len().max(1) as f64;
        left_out.push(LeftOut { marker: point.marker, from_known_m });
    }
    left_out_m.sort_by(f64::total_cmp);
    let baseline_m = (matches[0].to_m[0] - matches[0].to_m[1]).norm();
    let pair = PairResection {
        file: set.file.clone(),
        markers: chosen.map(|index| points[index].marker),
        baseline_m,
        baseline_errors_m: matches
            .iter()
            .map(|matches| (matches.from_m[0] - matches.from_m[1]).norm() - baseline_m)
            .collect(),
        station1_from_station: point_to_point::relative_to_station1(&world_from_station, None).0,
        left_out_m,
        left_out,
    };
    Some((pair, PlacedStation { world_from_station, matches, squares_m2, range_m }))
}

/// Returns the σ of a point of a file on each axis (m): from the residuals of its pairs, but at least that of the instruments. Each
/// pair gives a sum of squares with two degrees of freedom.
fn point_sigma_m<'a>(placed: impl Iterator<Item = &'a PlacedStation>) -> f64 {
    let (mut squares_m2, mut range_m) = (Vec::new(), 0.0_f64);
    for one in placed {
        squares_m2.extend(&one.squares_m2);
        range_m = range_m.max(one.range_m);
    }
    let shown_m = (median(squares_m2).unwrap_or(0.0) / MEDIAN_OF_TWO_SQUARES).sqrt();
    shown_m.max(RANGE_SIGMA_M).max(ANGLE_SIGMA_RAD * range_m)
}

/// A point with wrong coordinates, by all pairs of the other points.
struct Misplaced {
    file: String,
    marker: i64,
    off_m: f64,
}

impl Misplaced {
    fn is_in(&self, pair: &PairResection) -> bool {
        pair.file == self.file && pair.markers.contains(&self.marker)
    }

    fn finding(&self) -> Finding {
        known_point_misplaced(&self.file, self.marker, self.off_m)
    }
}

/// Returns the point that even the best pair without it places far from its known position, clearly further than any other.
fn misplaced(pairs: &[PairResection]) -> Option<Misplaced> {
    let mut off: Vec<Misplaced> = Vec::new();
    for pair in pairs {
        for left_out in &pair.left_out {
            let known = off
                .iter_mut()
                .find(|point| point.file == pair.file && point.marker == left_out.marker);
            match known {
                Some(point) => point.off_m = point.off_m.min(left_out.from_known_m),
                None => off.push(Misplaced {
                    file: pair.file.clone(),
                    marker: left_out.marker,
                    off_m: left_out.from_known_m,
                }),
            }
        }
    }
    off.sort_by(|a, b| b.off_m.total_cmp(&a.off_m));
    let next_m = off.get(1)?.off_m;
    off.into_iter()
        .next()
        .filter(|worst| worst.off_m > (MISPLACED * next_m).max(checks::WEAK_SIGMA_M))
}

fn findings(pairs: &[PairResection], chosen: usize) -> Vec<Finding> {
    let pair = &pairs[chosen];
    let median_m = pair.median_left_out_m();
    let agreement_m = median_m.map(|median_m| (median_m, pair.stations()));
    let mut findings =
        vec![resection_pair(&pair.file, pair.markers, pair.baseline_m, pairs.len(), agreement_m)];
    let longest = pairs.iter().max_by(|a, b| a.baseline_m.total_cmp(&b.baseline_m));
    if let Some(longest) = longest {
        let error_m =
            longest.baseline_errors_m.iter().sum::<f64>() / longest.baseline_errors_m.len() as f64;
        let ppm = error_m / longest.baseline_m * 1e6;
        if ppm.abs() > NOTABLE_PPM && error_m.abs() > NOTABLE_M {
            findings.push(known_distance_off(longest.markers, error_m, longest.baseline_m));
        }
    }
    findings
}
