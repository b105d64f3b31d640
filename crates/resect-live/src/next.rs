//! Next manoeuvres from the vehicle's position, searched in a thread of their own.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};

use nalgebra::Vector3;

use super::judged::Judged;
use resect_core::analysis::Analysis;
use resect_core::calibration::ErrorSizes;
use resect_core::calibration::joint::ExpectedNoise;
use resect_core::deployment::Deployment;
use resect_core::evaluation::rig_layout::prisms_in_vehicle;
use resect_core::geometry::LevelTransform;
use resect_core::network::Prism;
use resect_core::progress::Progress;
use resect_tools::planning::{NextMove, SoFar, what_next};

/// Default speed and turning radius of a vehicle.
const SPEED_M_PER_S: f64 = 0.8;
const TURN_RADIUS_M: f64 = 3.5;
/// Relative decrease of σ below which a manoeuvre is hardly worth its time.
pub const LITTLE: f64 = 0.05;
/// Time for a manoeuvre until another replaces it, relative to its predicted duration: the driver has to read it first.
const PATIENCE: f64 = 1.5;
/// Ratio of predicted σ below which another manoeuvre is clearly better.
const CLEARLY_BETTER: f64 = 0.75;
/// Default rate of readings without a joint estimate (Hz).
const RATE_HZ: f64 = 2.5;

/// A thread that searches for manoeuvres, one answer at a time.
pub struct Advising {
    jobs: Sender<(Arc<Deployment>, Arc<Analysis>, f64)>,
    found: Receiver<Vec<NextMove>>,
}

impl Advising {
    pub fn start(progress: &Arc<Progress>) -> Self {
        let (jobs, waiting) = channel::<(Arc<Deployment>, Arc<Analysis>, f64)>();
        let (send, found) = channel();
        let progress = Arc::clone(progress);
        std::thread::spawn(move || {
            for (deployment, analysis, target_m) in waiting {
                let moves = moves(&deployment, &analysis, target_m, &progress);
                if send.send(moves).is_err() {
                    return;
                }
            }
        });
        Self { jobs, found }
    }

    /// Passes an answer to the thread.
    pub fn think(&self, deployment: &Arc<Deployment>, analysis: &Arc<Analysis>, target_m: f64) {
        // A thread that was cancelled accepts nothing.
        _ = self.jobs.send((Arc::clone(deployment), Arc::clone(analysis), target_m));
    }

    /// Returns the manoeuvres of a search that has finished since the last call, the best first.
    pub fn found(&self) -> Option<Vec<NextMove>> {
        self.found.try_recv().ok()
    }
}

/// Returns manoeuvres that would improve an answer; none without an answer, a rig or a moving vehicle.
fn moves(
    deployment: &Deployment,
    analysis: &Analysis,
    target_m: f64,
    progress: &Progress,
) -> Vec<NextMove> {
    let Ok(answer) = &analysis.answer else { return Vec::new() };
    let calibration = &answer.calibration;
    let given = deployment.rig.as_ref().and_then(prisms_in_vehicle);
    let followed = &analysis.offer.followed;
    let prisms_m = match (Prism::count(followed), given) {
        (1, _) => [Vector3::zeros()].into(),
        (_, Some((prisms_m, _))) => prisms_m,
        (_, None) => return Vec::new(),
    };
    let transforms = calibration
        .station1_from_station
        .map(|at| LevelTransform::new(at.translation_m, at.yaw_rad()));
    let settings = &analysis.settings;
    let joint = calibration.joint();
    let expected = joint.map_or_else(ExpectedNoise::default, |joint| ExpectedNoise {
        levels: joint.levels,
        ranges: joint.slow_ranges,
        across: joint.slow_across,
        upward: joint.slow_upward,
    });
    let so_far = SoFar {
        triplets: analysis.triplets(),
        station1_from_station: &transforms,
        followed,
        prisms_m: &prisms_m,
        sizes: &ErrorSizes {
            inter_prism_m: settings.calibration.inter_prism_sigma_m,
            ..settings.calibration.errors
        },
        expected,
        rate_hz: joint.map_or(RATE_HZ, |joint| joint.solution.readings_hz()),
        thresholds: settings.pipeline.thresholds,
        places_m: &[],
        target_m,
        speed_m_per_s: SPEED_M_PER_S,
        turn_radius_m: TURN_RADIUS_M,
    };
    let found = what_next(&so_far, progress);
    found.ok().flatten().map_or_else(Vec::new, |advice| advice.moves)
}

/// Returns true if manoeuvres are known, and none decreases σ at the far end by [`LITTLE`].
pub fn gain_little(moves: &[NextMove]) -> bool {
    let gains = |one: &NextMove| {
        one.before_m.is_none_or(|before_m| one.after_m < (1.0 - LITTLE) * before_m)
    };
    !moves.is_empty() && !moves.iter().any(gains)
}

/// Returns true if new manoeuvres replace earlier ones: if these are reached or their time is over, or if the new best one is clearly
/// better. `age_s` is the time since the advice (s), and `sigma_m` the present σ at the far end (m).
pub fn replaces(new: &[NextMove], earlier: &[NextMove], age_s: f64, sigma_m: Option<f64>) -> bool {
    let ([new, ..], [earlier, ..]) = (new, earlier) else { return true };
    age_s > PATIENCE * earlier.takes_s
        || sigma_m.is_some_and(|sigma_m| sigma_m <= earlier.after_m)
        || new.open < earlier.open
        || new.after_m < CLEARLY_BETTER * earlier.after_m
}

/// Returns the most useful advice in one sentence; `None` without any.
pub fn sentence(moves: &[NextMove], judged: &Judged) -> Option<String> {
    // Advice takes longer than answers, so a manoeuvre is omitted if a newer answer has already reached its σ.
    let is_worth_it = |one: &&NextMove| {
        judged.far_end.is_none_or(|far| one.after_m < (1.0 - LITTLE) * far.sigma_m)
    };
    let best = moves.iter().find(is_worth_it).map(|best| best.sentence.clone());
    best.or_else(|| judged.advice.map(str::to_owned))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn advice_stays_until_it_is_driven_or_something_is_clearly_better() {
        let one = |after_mm: f64, open: usize| NextMove {
            sentence: format!("drive a loop: {after_mm} mm predicted"),
            waypoints_m: Vec::new(),
            before_m: None,
            after_m: after_mm * 1e-3,
            takes_s: 40.0,
            open,
            gain_per_m2_s: 1.0,
        };
        let earlier = [one(2.0, 1)];
        let replaced_by = |new: &[NextMove], age_s: f64, sigma_mm: f64| {
            replaces(new, &earlier, age_s, Some(sigma_mm * 1e-3))
        };
        assert!(!replaced_by(&[one(1.9, 1)], 20.0, 3.0), "hardly better");
        assert!(replaced_by(&[one(1.9, 1)], 61.0, 3.0), "its time is over");
        assert!(replaced_by(&[one(1.9, 1)], 20.0, 1.9), "reached");
        assert!(replaced_by(&[one(1.4, 1)], 20.0, 3.0), "clearly better");
        assert!(replaced_by(&[one(2.5, 0)], 20.0, 3.0), "determines a direction");
        assert!(replaced_by(&[], 20.0, 3.0), "nothing gains any more");
        assert!(replaces(&[one(9.0, 3)], &[], 0.0, None), "the first one");
    }
}
