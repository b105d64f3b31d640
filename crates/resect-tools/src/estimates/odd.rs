//! Spans in which an estimate and the ground truth contradict each other, and the one of the two that is wrong.
//!
//! Two signs show that the ground truth is wrong; no error of an estimate causes them. The readings contradict the rig, or
//! several estimates agree with each other against the ground truth. Without either sign the estimate is taken to be wrong, if
//! the readings are redundant or another estimate agrees with the ground truth. Otherwise it is inconclusive. Readings that agree with the
//! rig acquit the stations one by one, but not of a fault that all share: a shift of the recorder's clock, or a turn of all tripods.

use nalgebra::{Matrix3, Vector3};

use super::errors::EpochError;
use super::matched_pose::{TruePose, contradiction_limit_m};
use resect_core::network::{Pair, PerPair};
use resect_core::statistics::median;

/// Squared errors above this are outliers, in units of the combined variance of the estimate's usual errors and the ground
/// truth. The limit is 8 σ, because errors of both have heavier tails than normal ones. In most drives the ground truth is off
/// by 7 of its own σ at some gap.
const ODD: f64 = 64.0;
/// Drift is the median of the errors within this time before and after (s), of at most so many errors. It is computed anew for
/// each step of time (s). A longer outlier counts as drift.
const ABOUT_S: f64 = 30.0;
const MOST_ABOUT: usize = 301;
const STEP_S: f64 = 1.0;
/// Largest time between outlying epochs of one span (s).
const TOGETHER_S: f64 = 2.0;
/// Spans of fewer outlying epochs are noise.
const FEWEST: usize = 3;
/// Smaller errors (m, rad) are those of numbers that are rounded in files.
const LEAST_M: f64 = 1e-4;
const LEAST_RAD: f64 = 1e-4;
/// Estimates agree against the ground truth if their difference is below this share of the error.
const AGREE: f64 = 0.4;

/// The one that is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OddOne {
    /// The readings agree with the rig there, or other estimates agree with the ground truth.
    Estimate,
    /// The estimate's file has another convention, which its findings name.
    Convention,
    /// A single estimate contradicts a trajectory, which has no redundant readings.
    Undecided,
    /// A single estimate contradicts readings that agree with the rig, but a fault that all stations share would leave them in agreement
    /// and explain the difference.
    EstimateOrAll(SharedFault),
    /// The readings contradict the rig, or each other if all are of one prism.
    Readings,
    /// Number of estimates that agree with each other against the ground truth.
    TruthAgainst(usize),
    /// All stations have readings, but these were rejected as outliers: there is no ground truth.
    LeftOut,
}

/// Fault that all stations share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SharedFault {
    /// A shift of the recorder's clock.
    Clock,
    /// All tripods turn by one angle.
    Turn,
}

impl SharedFault {
    /// Names the fault.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Clock => "a shift of the clock that all stations share",
            Self::Turn => "a turn of all stations by one angle",
        }
    }
}

impl OddOne {
    /// Returns true if the ground truth is wrong or missing; otherwise the estimate is wrong, or may be.
    pub fn is_of_truth(self) -> bool {
        matches!(self, Self::Readings | Self::TruthAgainst(_) | Self::LeftOut)
    }
}

/// A span in which an estimate and the ground truth contradict each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OddSpan {
    /// Start and end in the ground truth's time (s).
    pub span_s: [f64; 2],
    /// Largest errors in the span, without the drift before it (m, rad); zero without ground truth.
    pub position_m: f64,
    pub rotation_rad: Option<f64>,
    pub odd_one: OddOne,
    /// True if the ground truth has redundant readings. A trajectory has none.
    pub by_readings: bool,
    /// True if the readings are compared with the rig. Readings of one prism are compared with each other.
    pub by_rig: bool,
    /// The station (0 to 2) whose distances contradict the rig; `None` if it is no single one.
    pub station: Option<usize>,
}

/// A pose this close to a triplet (s) lacks ground truth because readings were rejected, not because they are missing. Shorter
/// spans (s) are ends of segments.
const AT_TRIPLET_S: f64 = 0.15;
const SHORTEST_LEFT_OUT_S: f64 = 2.5;

/// Spans with poses of an estimate and readings of the stations, but without ground truth. Both lists of times ascend (s).
pub fn left_out_spans(without_truth_s: &[f64], triplet_s: &[f64], by_rig: bool) -> Vec<OddSpan> {
    let is_read = |time_s: &&f64| {
        let after = triplet_s.partition_point(|other| other < *time_s);
        let beside = triplet_s[after.saturating_sub(1)..triplet_s.len().min(after + 1)].iter();
        beside.map(|other| (other - **time_s).abs()).any(|apart_s| apart_s <= AT_TRIPLET_S)
    };
    let read_s: Vec<f64> = without_truth_s.iter().filter(is_read).copied().collect();
    let spans = read_s.chunk_by(|a, b| b - a <= TOGETHER_S);
    spans
        .map(|span| [span[0], span[span.len() - 1]])
        .filter(|[from_s, to_s]| to_s - from_s >= SHORTEST_LEFT_OUT_S)
        .map(|span_s| OddSpan {
            span_s,
            position_m: 0.0,
            rotation_rad: None,
            odd_one: OddOne::LeftOut,
            by_readings: true,
            by_rig,
            station: None,
        })
        .collect()
}

/// A pair of prisms is not involved in a contradiction if its distance error is below this share of the others'.
const NO_PART: f64 = 0.4;
/// Triplets within this time before and after a span count (s): those on either side of it.
const BESIDE_S: f64 = 0.3;

/// Returns the station whose distances to all others are wrong in a span; `None` if it is no single one.
///
/// The distance errors are those of all pairs of stations at the times of the triplets.
pub fn station_at_fault(
    span_s: [f64; 2],
    triplet_s: &[f64],
    distance_errors_mm: &PerPair<Vec<f64>>,
) -> Option<usize> {
    let from = triplet_s.partition_point(|time_s| *time_s < span_s[0] - BESIDE_S);
    let to = triplet_s.partition_point(|time_s| *time_s <= span_s[1] + BESIDE_S);
    let off = distance_errors_mm.map(|errors| {
        let of_span = errors.get(from..to).unwrap_or_default().iter();
        of_span.map(|error| error * error).sum::<f64>().sqrt()
    });
    (0..Pair::prisms_of(off.len())?).find(|station| {
        let (own, other): (Vec<Pair>, Vec<Pair>) =
            off.numbers().partition(|pair| pair.indices().contains(station));
        // Two stations have no other pair, so neither is at fault alone.
        !other.is_empty()
            && own.iter().all(|own| other.iter().all(|other| off[*other] < NO_PART * off[*own]))
    })
}

/// Spans in which one of the estimates contradicts the ground truth, without stations; `truths` are at the times of its errors.
///
/// Estimates drift, so the drift is subtracted from their errors. `sources` has the index of the estimate whose poses each one has:
/// copies count once among those that agree. `stations_m` are the stations in the ground truth's frame (m).
pub fn spans(
    own: usize,
    (all, sources): (&[&[EpochError]], &[usize]),
    truths: &[TruePose],
    stations_m: &[Vector3<f64>],
) -> Vec<OddSpan> {
    let all: Vec<Vec<EpochError>> = all.iter().map(|errors| without_drift(errors)).collect();
    let errors = &all[own][..];
    let usual = Usual::of(errors);
    let mut spans: Vec<Vec<usize>> = Vec::new();
    for index in (0..errors.len()).filter(|index| usual.is_odd(&errors[*index])) {
        match spans.last_mut() {
            Some(span)
                if errors[index].time_s - errors[span[span.len() - 1]].time_s <= TOGETHER_S =>
            {
                span.push(index);
            }
            _ => spans.push(vec![index]),
        }
    }
    let by_rig = truths.iter().any(|truth| truth.rotation.is_some());
    let is_redundant = truths.iter().any(|truth| truth.contradiction_m.is_some());
    let limit_m = contradiction_limit_m(truths.iter());
    let is_seen = |index: &usize| {
        let turn = errors[*index].rotation_rad.unwrap_or_default();
        errors[*index].position_m.norm() > LEAST_M || turn.norm() > LEAST_RAD
    };
    spans
        .into_iter()
        .filter(|span| span.len() >= FEWEST && span.iter().any(is_seen))
        .map(|span| {
            let largest = |of: &dyn Fn(&EpochError) -> f64| {
                span.iter().map(|index| of(&errors[*index])).fold(0.0, f64::max)
            };
            let turned = errors[span[0]].rotation_rad.is_some();
            let rotation = |e: &EpochError| e.rotation_rad.map_or(0.0, |turn| turn.norm());
            let contradiction_m =
                median(span.iter().filter_map(|index| errors[*index].contradiction_m))
                    .unwrap_or_default();
            let others: Vec<f64> = (0..all.len())
                .filter(|other| sources[*other] == *other && sources[*other] != sources[own])
                .filter_map(|other| difference(&span, errors, &all[other]))
                .collect();
            let agreeing = others.iter().filter(|apart| **apart < AGREE).count();
            // Without an error, an estimate differs from this one by its whole error.
            let with_truth = others.iter().filter(|apart| (**apart - 1.0).abs() < AGREE).count();
            let shared = || shared_fault(&span, errors, truths, stations_m);
            OddSpan {
                span_s: [errors[span[0]].time_s, errors[span[span.len() - 1]].time_s],
                position_m: largest(&|error| error.position_m.norm()),
                rotation_rad: turned.then(|| largest(&rotation)),
                odd_one: if contradiction_m > limit_m {
                    OddOne::Readings
                } else if agreeing > 0 {
                    OddOne::TruthAgainst(agreeing + 1)
                } else if with_truth > 0 {
                    OddOne::Estimate
                } else if is_redundant {
                    shared().map_or(OddOne::Estimate, OddOne::EstimateOrAll)
                } else {
                    OddOne::Undecided
                },
                by_readings: is_redundant,
                by_rig,
                station: None,
            }
        })
        .collect()
}

/// Largest share of the squared errors in a span that a shared fault leaves.
/// Effect: a larger share leaves open who is wrong, although an estimate slipped sideways. Simulated: shifts leave a few hundredths.
const LEFT_BY_FAULT: f64 = 0.1;
/// Largest turn of all tripods (rad) that the rig does not show, because slow errors of each station explain it.
/// Simulated: at 60 m, 0.7 to 1.4 mrad mostly stay unseen, and 3 mrad contradict the rig.
const LARGEST_TURN_RAD: f64 = 2e-3;

/// Returns the fault that all stations share and that explains the errors in a span.
fn shared_fault(
    span: &[usize],
    errors: &[EpochError],
    truths: &[TruePose],
    stations_m: &[Vector3<f64>],
) -> Option<SharedFault> {
    // As large as the vehicle is fast, and along its motion.
    let by_clock = |truth: &TruePose| truth.velocity_m_per_s;
    // Each station sees its prism turned about itself; the vehicle is placed by their mean.
    let middle_m = stations_m.iter().sum::<Vector3<f64>>() / stations_m.len().max(1) as f64;
    let by_turn = |truth: &TruePose| Vector3::z().cross(&(truth.position_m - middle_m));
    if size_of_fault(span, errors, truths, &by_clock).is_some() {
        return Some(SharedFault::Clock);
    }
    let turn_rad = size_of_fault(span, errors, truths, &by_turn).filter(|_| !stations_m.is_empty());
    turn_rad.filter(|turn_rad| turn_rad.abs() < LARGEST_TURN_RAD).map(|_| SharedFault::Turn)
}

/// Returns the size of a fault, if it explains the errors in a span.
fn size_of_fault(
    span: &[usize],
    errors: &[EpochError],
    truths: &[TruePose],
    by_fault: &dyn Fn(&TruePose) -> Vector3<f64>,
) -> Option<f64> {
    let [mut product, mut effect, mut square] = [0.0; 3];
    for index in span {
        let truth = truths.get(*index)?;
        let (error_m, by_fault) = (errors[*index].position_m, by_fault(truth));
        product += error_m.dot(&by_fault);
        effect += by_fault.norm_squared();
        square += error_m.norm_squared();
    }
    let is_explained = effect > 0.0 && square - product * product / effect < LEFT_BY_FAULT * square;
    is_explained.then(|| product / effect)
}

/// Errors minus the median of those around them, along each axis.
fn without_drift(errors: &[EpochError]) -> Vec<EpochError> {
    let mut left = errors.to_vec();
    let place = |error: &EpochError| (error.time_s / STEP_S).floor();
    let mut at = 0;
    for step in errors.chunk_by(|a, b| place(a) == place(b)) {
        let (from_s, to_s) = (step[0].time_s - ABOUT_S, step[step.len() - 1].time_s + ABOUT_S);
        let from = errors.partition_point(|error| error.time_s < from_s);
        let about = &errors[from..errors.partition_point(|error| error.time_s <= to_s)];
        let middle = |of: &dyn Fn(&EpochError) -> Option<Vector3<f64>>| {
            Vector3::from_fn(|axis, _| {
                let some = about.iter().step_by(about.len().div_ceil(MOST_ABOUT));
                median(some.filter_map(|error| Some(of(error)?[axis]))).unwrap_or_default()
            })
        };
        let moved = middle(&|error| Some(error.position_m));
        let turned = middle(&|error| error.rotation_rad);
        for error in &mut left[at..at + step.len()] {
            error.position_m -= moved;
            error.rotation_rad = error.rotation_rad.map(|turn| turn - turned);
        }
        at += step.len();
    }
    left
}

/// Usual errors of an estimate: σ along an axis.
struct Usual {
    position_m: f64,
    rotation_rad: f64,
}

impl Usual {
    fn of(errors: &[EpochError]) -> Self {
        // The median length of three normal errors is 1.538 σ.
        let axis =
            |lengths: &mut dyn Iterator<Item = f64>| median(lengths).unwrap_or_default() / 1.538;
        Self {
            position_m: axis(&mut errors.iter().map(|error| error.position_m.norm())),
            rotation_rad: axis(&mut errors.iter().filter_map(|e| Some(e.rotation_rad?.norm()))),
        }
    }

    fn is_odd(&self, error: &EpochError) -> bool {
        let open_rad2 = error.covariance_rad2.unwrap_or_default();
        is_odd(&error.position_m, error.covariance_m2.unwrap_or_default(), self.position_m)
            || error.rotation_rad.is_some_and(|turn| is_odd(&turn, open_rad2, self.rotation_rad))
    }
}

fn is_odd(error: &Vector3<f64>, open: Matrix3<f64>, usual: f64) -> bool {
    let expected = open + Matrix3::identity() * usual.powi(2);
    expected.cholesky().is_some_and(|root| error.dot(&root.solve(error)) > ODD)
}

/// Returns the median difference from another estimate's errors in a span, as a share of this one's; `None` if it has none there.
fn difference(span: &[usize], errors: &[EpochError], other: &[EpochError]) -> Option<f64> {
    let apart = span.iter().filter_map(|index| {
        let error = &errors[*index];
        let after = other.partition_point(|e| e.time_s < error.time_s);
        let near = [after.checked_sub(1), Some(after)].into_iter().flatten();
        let near = near.filter_map(|at| other.get(at));
        let near = near.min_by(|a, b| gap(a, error).total_cmp(&gap(b, error)))?;
        let moved = (near.position_m - error.position_m).norm() / error.position_m.norm();
        (gap(near, error) < TOGETHER_S).then_some(moved)
    });
    median(apart)
}

fn gap(a: &EpochError, b: &EpochError) -> f64 {
    (a.time_s - b.time_s).abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_station_of_both_pairs_that_are_off_is_at_fault() {
        let triplet_s: Vec<f64> = (0..100).map(|i| 0.1 * f64::from(i)).collect();
        // Distance errors of 1 mm, and of 30 mm for the given pairs from 4 to 6 s.
        let errors = |off: [bool; 3]| {
            off.map(|off| {
                let error =
                    |time_s: &f64| if off && (4.0..6.0).contains(time_s) { 30.0 } else { 1.0 };
                triplet_s.iter().map(error).collect::<Vec<f64>>()
            })
        };
        let at_fault = |off, span_s| station_at_fault(span_s, &triplet_s, &errors(off).into());
        assert_eq!(at_fault([true, true, false], [4.2, 5.0]), Some(0));
        assert_eq!(at_fault([true, false, true], [4.2, 5.0]), Some(1));
        assert_eq!(at_fault([false, true, true], [4.2, 5.0]), Some(2));
        // One pair alone, or all three, identify no station. Elsewhere nothing is wrong.
        assert_eq!(at_fault([true, false, false], [4.2, 5.0]), None);
        assert_eq!(at_fault([true; 3], [4.2, 5.0]), None);
        assert_eq!(at_fault([true, true, false], [8.0, 9.0]), None);
        assert_eq!(at_fault([true, true, false], [20.0, 21.0]), None);
    }

    #[test]
    fn poses_without_truth_where_the_stations_read_are_told_and_gaps_are_not() {
        // Read from 0 to 10 s and from 30 to 40 s.
        let read = |from: u32| (0..=100).map(move |i| f64::from(from) + 0.1 * f64::from(i));
        let triplet_s: Vec<f64> = read(0).chain(read(30)).collect();
        let poses = |from_s: f64, to_s: f64| {
            (0..400).map(|i| 0.1 * f64::from(i) + 0.03).filter(move |t| (from_s..to_s).contains(t))
        };
        let spans = |without: Vec<f64>| -> Vec<[f64; 2]> {
            left_out_spans(&without, &triplet_s, true).iter().map(|span| span.span_s).collect()
        };
        assert!(spans(poses(10.2, 30.0).collect()).is_empty(), "a gap is a gap");
        assert!(spans(poses(9.6, 30.3).collect()).is_empty(), "the ends of stretches are no news");
        let found = spans(poses(3.0, 6.0).chain(poses(32.0, 35.0)).collect());
        let near = |span: [f64; 2], from_s: f64, to_s: f64| {
            (span[0] - from_s).abs() < 0.15 && (span[1] - to_s).abs() < 0.15
        };
        assert!(
            found.len() == 2 && near(found[0], 3.0, 6.0) && near(found[1], 32.0, 35.0),
            "{found:?}"
        );
    }
}
