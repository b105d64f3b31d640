//! What an answer means to whoever is driving: its σ where it matters, its verdict, what it leaves open.

use std::sync::Arc;

use super::findings::{clock_stepped, station_stepped};
use resect_core::analysis::{Analysis, Answer};
use resect_core::calibration::inter_prism::drive_shape::Plan;
use resect_core::calibration::inter_prism::observability::{Hold, Observability};
use resect_core::calibration::joint::Stepped;
use resect_core::calibration::{Method, Targets, TransformSigma, Verdict, distance_errors_m};
use resect_core::deployment::{Deployment, Finding, PAIRS, doubts};
use resect_core::evaluation::far_end::{FarEnd, far_end};
use resect_core::geometry::RigidTransform;
use resect_core::planning::OPENING;
use resect_core::statistics::median;

/// Readings that tell nothing for so long (s) need another remedy than more of them.
const BEGINNING_S: f64 = 30.0;
/// The last readings that tell whether the right prisms are followed (s).
const LATEST_S: f64 = 4.0;
/// Fewer triplets than this tell nothing of them.
const FEWEST: usize = 10;
/// An answer that leaves more than this open (m) tells nothing of them.
const SURE_M: f64 = 0.01;
/// Distances of triplets that are off the rig's by more (m) for seconds are those of a wrong prism.
const WRONG_PRISM_M: f64 = 0.05;
/// A station that moved by less (m), or turned by less (rad), is left to the answer's findings.
const MOVED_M: f64 = 0.003;
const TURNED_RAD: f64 = 2e-4;

/// An answer to the readings up to an instant.
#[derive(Clone, Debug)]
pub struct Judged {
    pub method: Method,
    /// Stamp of the newest reading that it knows of (s).
    pub up_to_s: f64,
    /// How many readings it is of.
    pub readings: usize,
    /// How long it took (ms).
    pub took_ms: f64,
    pub verdict: Verdict,
    pub verdict_in_words: String,
    /// What speaks against it most, if anything does.
    pub reason: Option<String>,
    /// Where on the track it leaves the most open; `None` where a direction is free.
    pub far_end: Option<FarEnd>,
    /// What the drive does not hold, in words, the least held first.
    pub open: Vec<String>,
    /// What to drive next, by what it holds least.
    pub advice: Option<&'static str>,
    pub plan: Option<Plan>,
    /// How late the stamps of stations 2 and 3 are, with σ (s).
    pub late_s: Option<[[f64; 2]; 2]>,
    /// Stations and clocks that stepped.
    pub stepped: Vec<Finding>,
    pub station1_from_station: [RigidTransform; 3],
    pub sigma: Option<[TransformSigma; 2]>,
    /// The median distance error of the answer (mm).
    pub inter_prism_mm: Option<f64>,
}

impl Judged {
    /// Tells the verdict and what speaks most against the answer: "weak: station 2's clock seems late".
    pub fn verdict_and_reason(&self) -> String {
        let why = self.reason.as_ref().map_or(String::new(), |why| format!(": {why}"));
        format!("{}{why}", self.verdict_in_words)
    }

    /// Whether later readings can be held against it.
    pub fn is_sure(&self) -> bool {
        self.far_end.is_some_and(|far_end| far_end.sigma_m < SURE_M)
    }
}

/// Why an analysis has no answer, and what to drive where it only began too early.
#[derive(Clone, Debug)]
pub struct NoAnswer {
    pub why: String,
    pub drive: Option<&'static str>,
}

/// What came of one analysis: an answer, or in one line why there is none.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Whether it was the paper's answer, which is there first, and not that of the settings.
    pub is_first: bool,
    pub judged: Result<Arc<Judged>, NoAnswer>,
    /// How far the distances of the last triplets are off (m), by pair.
    pub lately_off_m: Option<[f64; 3]>,
}

impl Outcome {
    /// Which pairs of prisms were lately off by more than any noise.
    pub fn wrong_pairs(&self) -> [bool; 3] {
        self.lately_off_m.map_or([false; 3], |off_m| off_m.map(|off_m| off_m > WRONG_PRISM_M))
    }
}

/// Judges an analysis of a deployment; `known` is an earlier answer, which holds the last readings against what it knew.
pub fn judge(
    deployment: &Deployment,
    analysis: &Analysis,
    is_first: bool,
    known: Option<&Judged>,
) -> Outcome {
    let judged = match &analysis.answer {
        Ok(answer) => Ok(Arc::new(judge_answer(deployment, analysis, answer))),
        Err(error) => Err(NoAnswer {
            why: error.finding().to_string(),
            drive: opening(deployment, analysis).filter(|_| error.wants_readings()),
        }),
    };
    let known = known.filter(|known| known.is_sure());
    let lately_off_m =
        known.and_then(|known| lately_off_m(deployment, analysis, &known.station1_from_station));
    Outcome { is_first, judged, lately_off_m }
}

/// What to drive first; `None` where that is past, or all stations follow one prism, which turns to no use.
fn opening(deployment: &Deployment, analysis: &Analysis) -> Option<&'static str> {
    let read_s = deployment.end_s()? - deployment.start_s()?;
    (read_s < BEGINNING_S && analysis.offer.targets != Targets::OnePrism).then_some(OPENING)
}

fn judge_answer(deployment: &Deployment, analysis: &Analysis, answer: &Answer) -> Judged {
    let calibration = &answer.calibration;
    let observability = calibration.inter_prism().map(|details| &details.observability);
    let open = |observability: &Observability| {
        let not_held = observability.directions.iter().filter(|d| d.hold != Hold::Held);
        not_held.map(|d| format!("{} ({})", d.short(), d.hold.name())).collect()
    };
    let far_end = calibration.covariance.and_then(|covariance| {
        let points_m = &answer.triplets.points_m;
        far_end(&calibration.station1_from_station, &covariance, points_m)
    });
    let joint = calibration.joint();
    let stepped = joint.map_or_else(Vec::new, |joint| {
        let told = joint.stepped.iter().filter_map(|step| {
            let (station, when) = (step.station, joint.when(step));
            match &step.what {
                Stepped::Station { turned_rad, .. } => {
                    let moved_m = step.moved_m()?;
                    let is_small = moved_m.value < MOVED_M && turned_rad.value.abs() < TURNED_RAD;
                    (!is_small).then(|| station_stepped(station, &moved_m, turned_rad, &when))
                }
                Stepped::Clock(by_s) => Some(clock_stepped(station, by_s, &when)),
            }
        });
        told.collect()
    });
    Judged {
        method: calibration.method,
        up_to_s: deployment.end_s().unwrap_or(f64::NAN),
        readings: deployment.tracks.iter().map(|track| track.measurements.len()).sum(),
        took_ms: analysis.total_ms(),
        verdict: calibration.verdict,
        verdict_in_words: calibration.verdict_in_words(),
        reason: doubts(&calibration.findings).first().map(ToString::to_string),
        far_end,
        open: observability.map_or_else(Vec::new, open),
        advice: observability.map(|observability| observability.advice),
        plan: observability.map(|observability| observability.drive.plan),
        late_s: calibration
            .clock_estimates()
            .map(|clocks| clocks.map(|(offset_s, _)| [offset_s.value, offset_s.sigma])),
        stepped,
        station1_from_station: calibration.station1_from_station,
        sigma: calibration.sigma,
        inter_prism_mm: answer.evaluation.inter_prism_mm.map(|spread| spread.median),
    }
}

/// How far the distances of the last triplets are off the rig's, by pair: their median (m).
fn lately_off_m(
    deployment: &Deployment,
    analysis: &Analysis,
    transforms: &[RigidTransform; 3],
) -> Option<[f64; 3]> {
    let rig_m = deployment.rig.as_ref()?.inter_prism_m;
    let triplets = &analysis.pipeline.triplets;
    let last_s = triplets.time_s.last()?;
    let from = triplets.time_s.partition_point(|time_s| *time_s < last_s - LATEST_S);
    let latest: Vec<usize> = (from..triplets.len()).collect();
    // What is long past says nothing of now.
    let is_now = deployment.end_s()? - last_s < LATEST_S;
    if latest.len() < FEWEST || !is_now {
        return None;
    }
    let errors_m = distance_errors_m(&triplets.select(&latest), transforms, &rig_m);
    let off_m = errors_m.map(|errors| median(errors.into_iter().map(f64::abs)).unwrap_or(0.0));
    Some(off_m)
}

/// The station, 0 to 2, that the pairs which are off have in common; `None` where all are, or none.
pub fn station_in_common(is_off: [bool; 3]) -> Option<usize> {
    (0..3).find(|station| {
        (0..3).all(|pair| is_off[pair] == (PAIRS[pair].0 == *station || PAIRS[pair].1 == *station))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use resect_core::analysis::{Analyst, Settings};
    use resect_core::simulation::{EPOCH_S, Preset, simulate_scenario};

    /// What is to be driven where so much of a drive (s) has no answer.
    fn to_drive(
        until_s: f64,
        change: impl FnOnce(&mut Deployment, &mut Settings),
    ) -> Option<&'static str> {
        let mut simulated = simulate_scenario(&Preset::FlatFloor.scenario(), 1);
        simulated.records.retain(|record| record.measurement.time_s < EPOCH_S + until_s);
        let mut deployment = resect_io::simulation_files::open(&simulated).expect("valid");
        let mut settings = Settings::default();
        change(&mut deployment, &mut settings);
        let analysis = Analyst::new(deployment.clone().into()).run(&settings);
        judge(&deployment, &analysis, true, None).judged.expect_err("too little").drive
    }

    #[test]
    fn the_opening_is_said_where_a_drive_only_began() {
        assert_eq!(to_drive(5.0, |_, _| ()), Some(OPENING));
        // Who read for long wants another remedy, one prism turns to no use, and no drive makes up for a rig.
        let no_interval = |_: &mut Deployment, settings: &mut Settings| {
            settings.pipeline.thresholds.tau_l_seconds = 1e3;
        };
        assert_eq!(to_drive(60.0, no_interval), None);
        assert_eq!(to_drive(5.0, |deployment, _| deployment.prisms = Some(1)), None);
        assert_eq!(to_drive(25.0, |deployment, _| deployment.rig = None), None);
    }

    #[test]
    fn the_station_of_two_bad_pairs_is_named() {
        assert_eq!(station_in_common([true, true, false]), Some(0));
        assert_eq!(station_in_common([true, false, true]), Some(1));
        assert_eq!(station_in_common([false, true, true]), Some(2));
        assert_eq!(station_in_common([true, true, true]), None);
        assert_eq!(station_in_common([false; 3]), None);
    }
}
