//! Evaluation of an answer for the driver: σ at the far end of the track, verdict, unconstrained directions.

use std::sync::Arc;

use super::findings::{clock_stepped, station_stepped};
use resect_core::analysis::{Analysis, Answer};
use resect_core::calibration::inter_prism::PrismNetwork;
use resect_core::calibration::inter_prism::drive_shape::PlanView;
use resect_core::calibration::inter_prism::observability::{Hold, Observability};
use resect_core::calibration::joint::StepSize;
use resect_core::calibration::{Method, TransformSigma, Verdict};
use resect_core::deployment::{Deployment, Finding, doubts};
use resect_core::evaluation::far_end::{FarEnd, far_end};
use resect_core::geometry::RigidTransform;
use resect_core::network::{Number, PerStation, PerStationPair, Prism, Station};
use resect_core::statistics::median;
use resect_tools::planning::OPENING;

/// Duration of a drive (s) below which a missing answer only needs more readings; a longer drive needs another remedy.
const BEGINNING_S: f64 = 30.0;
/// Span of the last readings (s) that are tested for a wrong prism.
const LATEST_S: f64 = 4.0;
/// Smallest number of triplets for the test of the prisms.
const FEWEST: usize = 10;
/// Largest σ at the far end (m) of an answer that can test the prisms of later readings.
const SURE_M: f64 = 0.01;
/// Median distance error of the last triplets (m) above which a station follows a wrong prism.
const WRONG_PRISM_M: f64 = 0.05;
/// Displacement (m) and rotation (rad) of a station below which a step remains a finding of the answer only.
const MOVED_M: f64 = 0.003;
const TURNED_RAD: f64 = 2e-4;

/// An answer to the readings up to an instant, evaluated.
#[derive(Clone, Debug)]
pub struct Judged {
    pub method: Method,
    /// Stamp of the newest reading of the deployment (s).
    pub up_to_s: f64,
    /// Number of raw readings of the deployment.
    pub readings: usize,
    /// Duration of the analysis (ms).
    pub took_ms: f64,
    pub verdict: Verdict,
    pub verdict_in_words: String,
    /// The most severe doubt, if there is one.
    pub reason: Option<String>,
    /// Point of the track with the largest σ; `None` if a direction is unobservable.
    pub far_end: Option<FarEnd>,
    /// Directions that the drive does not constrain, in words, the least constrained first.
    pub open: Vec<String>,
    /// Manoeuvre that constrains the weakest direction.
    pub advice: Option<&'static str>,
    pub plan: Option<PlanView>,
    /// Clock offsets with σ (s), positive if a station's stamps are late; zeros for station 1.
    pub late_s: Option<PerStation<[f64; 2]>>,
    /// Detected steps of stations and clocks.
    pub stepped: Vec<Finding>,
    pub station1_from_station: PerStation<RigidTransform>,
    pub sigma: Option<PerStation<TransformSigma>>,
    /// Median distance error of the answer (mm).
    pub inter_prism_mm: Option<f64>,
}

impl Judged {
    /// Returns the verdict and the most severe doubt: "weak: station 2's clock seems late". The doubt's own advice is left out,
    /// since the coach gives one that fits the vehicle's position.
    pub fn verdict_and_reason(&self) -> String {
        let advice = self.advice.map_or(String::new(), |advice| format!("; next, {advice}"));
        let why = self.reason.as_deref().map(|why| why.strip_suffix(&advice).unwrap_or(why));
        let why = why.map_or(String::new(), |why| format!(": {why}"));
        format!("{}{why}", self.verdict_in_words)
    }

    /// Returns true if the answer is precise enough to test later readings.
    pub fn is_sure(&self) -> bool {
        self.far_end.is_some_and(|far_end| far_end.sigma_m < SURE_M)
    }
}

/// Reason why an analysis has no answer, with a manoeuvre if the drive has only begun.
#[derive(Clone, Debug)]
pub struct NoAnswer {
    pub why: String,
    pub drive: Option<&'static str>,
}

/// Result of one analysis: an answer, or the reason for its absence in one line.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// True for the answer by the paper's method, which comes first; false for that with the chosen settings.
    pub is_first: bool,
    pub judged: Result<Arc<Judged>, NoAnswer>,
    /// Median absolute errors of the distances between the prisms of two stations in the last triplets (m).
    pub lately_off_m: Option<PerStationPair<f64>>,
}

impl Outcome {
    /// Returns true for each pair of stations whose last distance errors exceed any noise.
    pub fn wrong_pairs(&self) -> PerStationPair<bool> {
        let off_m = self.lately_off_m.as_ref();
        off_m
            .map_or_else(PerStationPair::default, |off_m| off_m.map(|off_m| *off_m > WRONG_PRISM_M))
    }
}

/// Judges an analysis of a deployment. The transforms of `known`, an earlier answer, test the last readings.
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

/// Returns the first manoeuvre; `None` late in the drive, or if all stations follow one prism, for which rotations are useless.
fn opening(deployment: &Deployment, analysis: &Analysis) -> Option<&'static str> {
    let read_s = deployment.end_s()? - deployment.start_s()?;
    (read_s < BEGINNING_S && !Prism::is_one(&analysis.offer.followed)).then_some(OPENING)
}

fn judge_answer(deployment: &Deployment, analysis: &Analysis, answer: &Answer) -> Judged {
    let calibration = &answer.calibration;
    let observability = calibration.inter_prism().map(|details| &details.observability);
    let open = |observability: &Observability| {
        let not_held = observability.directions.iter().filter(|d| d.hold != Hold::Held);
        not_held.map(|d| format!("{} ({})", d.short(), d.hold.name())).collect()
    };
    let far_end = calibration.covariance.as_ref().and_then(|covariance| {
        let points_m = &answer.triplets.points_m;
        far_end(&calibration.station1_from_station, covariance, points_m)
    });
    let joint = calibration.joint();
    let stepped = joint.map_or_else(Vec::new, |joint| {
        let told = joint.steps.iter().filter_map(|step| {
            let (station, when) = (step.station.index(), joint.describe_time(step));
            match &step.size {
                StepSize::Station { turned_rad, .. } => {
                    let moved_m = step.moved_m()?;
                    let is_small = moved_m.value < MOVED_M && turned_rad.value.abs() < TURNED_RAD;
                    (!is_small).then(|| station_stepped(station, &moved_m, turned_rad, &when))
                }
                StepSize::Clock(by_s) => Some(clock_stepped(station, by_s, &when)),
            }
        });
        told.collect()
    });
    Judged {
        method: calibration.answered_by(),
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
        station1_from_station: calibration.station1_from_station.clone(),
        sigma: calibration.sigma.clone(),
        inter_prism_mm: answer.evaluation.inter_prism_mm.map(|spread| spread.median),
    }
}

/// Returns the median absolute distance errors of the last triplets against the rig, by pair of stations (m).
fn lately_off_m(
    deployment: &Deployment,
    analysis: &Analysis,
    transforms: &PerStation<RigidTransform>,
) -> Option<PerStationPair<f64>> {
    let rig_m = &deployment.rig.as_ref()?.inter_prism_m;
    let triplets = &analysis.pipeline.triplets;
    let last_s = triplets.time_s.last()?;
    let from = triplets.time_s.partition_point(|time_s| *time_s < last_s - LATEST_S);
    let latest: Vec<usize> = (from..triplets.len()).collect();
    // Old triplets give no information about the present.
    let is_now = deployment.end_s()? - last_s < LATEST_S;
    if latest.len() < FEWEST || !is_now {
        return None;
    }
    let network = PrismNetwork::new(analysis.offer.followed.clone(), rig_m);
    let mut errors_m = vec![Vec::with_capacity(latest.len()); network.pairs.len()];
    for index in latest {
        let placed_m: Vec<_> = transforms
            .zip(&triplets.points_m, |transform, points_m| transform.apply(&points_m[index]))
            .into_iter()
            .collect();
        errors_m.iter_mut().zip(network.errors_m(&placed_m)).for_each(|(all, own)| all.push(own));
    }
    let median_m = |errors_m: Vec<f64>| median(errors_m.into_iter().map(f64::abs));
    Some(errors_m.into_iter().map(|errors_m| median_m(errors_m).unwrap_or(0.0)).collect())
}

/// Returns the station that the deviating pairs have in common; `None` if all pairs deviate, none, or the only one.
pub fn station_in_common(is_off: &PerStationPair<bool>) -> Option<Station> {
    if is_off.len() < 2 {
        return None;
    }
    let last = is_off.numbers().last()?.second;
    (0..=last.index())
        .map(Station::at)
        .find(|station| is_off.each().all(|(pair, is_off)| *is_off == pair.contains(station)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use resect_core::analysis::{Analyst, Settings};
    use resect_tools::simulation::{EPOCH_S, Preset, simulate_scenario};

    /// Returns the advised manoeuvre after the first `until_s` seconds of a drive that has no answer yet.
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
        // A long drive needs another remedy, rotations are useless with one prism, and no drive replaces a rig.
        let no_interval = |_: &mut Deployment, settings: &mut Settings| {
            settings.pipeline.all_readings = false;
            settings.pipeline.thresholds.tau_l_seconds = 1e3;
        };
        assert_eq!(to_drive(60.0, no_interval), None);
        assert_eq!(to_drive(5.0, |deployment, _| deployment.prisms = Some(1)), None);
        assert_eq!(to_drive(25.0, |deployment, _| deployment.rig = None), None);
    }

    #[test]
    fn the_station_of_two_bad_pairs_is_named() {
        assert_eq!(station_in_common(&[true, true, false].into()), Some(Station::at(0)));
        assert_eq!(station_in_common(&[true, false, true].into()), Some(Station::at(1)));
        assert_eq!(station_in_common(&[false, true, true].into()), Some(Station::at(2)));
        assert_eq!(station_in_common(&[true, true, true].into()), None);
        assert_eq!(station_in_common(&[false; 3].into()), None);
        // Two stations do not tell which of them is wrong; four do.
        assert_eq!(station_in_common(&[true].into()), None);
        let with_fourth = [false, false, false, true, true, true];
        assert_eq!(station_in_common(&with_fourth.into()), Some(Station::at(3)));
    }
}
