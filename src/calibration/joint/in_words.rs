//! What the joint estimate found, in words: instruments, what did not stay as it was, and what its σ are made of.

use super::unknowns::{COLLIMATIONS, DISTANCES, INDICES, LATENCIES, LEANS, OFFSETS, SCALES};
use super::{JointEstimate, Step, Stepped};
use crate::calibration::Verdict;
use crate::calibration::{Estimate, clocks_in_words};
use crate::deployment::{Finding, Remedy, pair_label};

/// How far one estimate may be from its prior by chance (σ): once in forty thousand, by some of thirty.
const MOST_STRAIN: f64 = 4.2;
/// How far the estimates of a station, or all of them, may be from their priors together by chance (σ): once in a
/// thousand.
const MOST_STRAIN_OF_STATION: f64 = 3.0;
const MOST_STRAIN_OF_ALL: f64 = 3.3;
/// The largest errors of ranges to prisms that turn are 5 mm (Lackner & Lienhart 2016).
const MOST_WANDER_M: f64 = 0.005;
/// An instrument's error is told where it is this many of its σ, and the data narrowed what was known by this share.
const TOLD_SIGMAS: f64 = 2.5;
const TOLD_NARROWED: f64 = 0.8;
/// What is looked at before and after a step (s): its moment is known to about six seconds.
const AROUND_A_STEP_S: f64 = 20.0;

pub fn findings(found: &JointEstimate) -> Vec<Finding> {
    let mut findings = vec![noise(found)];
    findings.extend(clocks_in_words::clocks(&found.clock_offsets_s, &found.clock_drifts));
    for (number, drive) in found.drives.iter().enumerate().skip(1) {
        let clocks =
            clocks_in_words::clocks(&drive.late_s, &[Estimate { value: 0.0, sigma: 1.0 }; 2]);
        findings.extend(clocks.into_iter().map(|finding| Finding {
            message: format!("drive {}: {}", number + 1, finding.message),
            ..finding
        }));
    }
    findings.extend(instruments(found).into_iter().filter_map(|error| error.told()));
    findings.extend(dominant(found));
    findings
}

/// What speaks against the estimate itself, each with the verdict that it allows at most.
pub fn doubts(found: &JointEstimate) -> Vec<(Verdict, Finding)> {
    let mut doubts = Vec::new();
    let mut doubt = |finding: Finding| doubts.push((Verdict::Weak, finding));
    let strain = &found.strain;
    let mut strained = false;
    for error in instruments(found) {
        let sigmas = strain.of[error.place].abs();
        if sigmas > MOST_STRAIN {
            strained = true;
            doubt(Finding::warning(format!(
                "{}, where instruments in order have {:.1} {} (1 σ): {sigmas:.1} σ beyond chance, so something is wrong that \
                 this estimate takes for it",
                error.in_words(),
                error.known * error.scale,
                error.unit
            )));
        }
    }
    for pair in 0..3 {
        let sigmas = strain.of[DISTANCES + pair].abs();
        if found.distances_m.is_some() && sigmas > MOST_STRAIN {
            strained = true;
            let line = format!(
                "prisms {} would be {:+.1} mm from their measured distance, which is known to {:.1} mm (1 σ), {sigmas:.1} σ \
                 beyond chance: the rig, its units or the stations' numbers are wrong",
                pair_label(pair),
                strain.moved[DISTANCES + pair] * 1e3,
                found.sizes.inter_prism_m * 1e3
            );
            doubt(Finding::warning(line).with(Remedy::PutRight));
        }
    }
    for (station, sigmas) in strain.of_stations.into_iter().enumerate() {
        if sigmas > MOST_STRAIN_OF_STATION {
            strained = true;
            doubt(Finding::warning(format!(
                "what is wrong with station {}'s ranges, angles and lean is {sigmas:.1} σ beyond what instruments in order \
                 have, taken together: it was knocked, or something else bends the answer",
                station + 1
            )));
        }
    }
    if !strained && strain.of_all > MOST_STRAIN_OF_ALL {
        doubt(Finding::warning(format!(
            "what is wrong with all stations and distances is {:.1} σ beyond what instruments in order have, taken together: \
             something that this estimate does not know bends the answer",
            strain.of_all
        )));
    }
    if found.wander.sigma_m > MOST_WANDER_M {
        doubt(Finding::warning(format!(
            "ranges wander by {:.0} mm, more than any prism makes them: find out what else does",
            found.wander.sigma_m * 1e3
        )));
    }
    doubts.extend(found.stepped.iter().map(|step| stepped(step, found)));
    doubts.extend(
        clocks_in_words::implausible_drifts(&found.clock_drifts, &jumping(found))
            .into_iter()
            .map(|finding| (Verdict::Weak, finding)),
    );
    doubts
}

/// Whether the clocks of stations 2 and 3 jump.
fn jumping(found: &JointEstimate) -> [bool; 2] {
    [1, 2].map(|station| {
        let of_it = |step: &Step| matches!(step.what, Stepped::Clock(_)) && step.station == station;
        found.stepped.iter().any(of_it)
    })
}

/// What happened to a station or its clock, and the verdict that it allows.
fn stepped(step: &Step, found: &JointEstimate) -> (Verdict, Finding) {
    let station = step.station + 1;
    let when = found.when(step);
    let line = match &step.what {
        Stepped::Clock(by_s) => format!(
            "station {station}'s stamps jump by {:+.1} ± {:.1} ms {when}, which no offset puts right",
            by_s.value * 1e3,
            by_s.sigma * 1e3,
        ),
        Stepped::Station { turned_rad, .. } => {
            let moved = step.moved_m().unwrap_or(Estimate { value: 0.0, sigma: 0.0 });
            format!(
                "station {station} turned by {:+.3} ± {:.3} mrad and moved by {:.1} ± {:.1} mm {when}",
                turned_rad.value * 1e3,
                turned_rad.sigma * 1e3,
                moved.value * 1e3,
                moved.sigma * 1e3,
            )
        }
    };
    if found.is_usual(step) {
        let line = format!("{line}; no more than σ allows for");
        return (Verdict::Good, Finding::note(line));
    }
    let remedy = if step.slowly { "find out why" } else { "cut the recording there" };
    let line = format!(
        "{line}; the estimate allows for it, but no one answer holds for the whole drive: {remedy}"
    );
    let seen = (!step.slowly).then(|| {
        let at_s = found.at_s(step);
        Remedy::ShowTimes([at_s - AROUND_A_STEP_S, at_s + AROUND_A_STEP_S])
    });
    (Verdict::Weak, seen.into_iter().fold(Finding::warning(line), Finding::with))
}

/// An error of an instrument that was estimated.
struct InstrumentError {
    what: String,
    place: usize,
    /// The error about zero, or about what geometry says.
    estimate: Estimate,
    /// What was known of it beforehand (1 σ).
    known: f64,
    /// Factor from the estimate's unit to the one that is shown.
    scale: f64,
    unit: &'static str,
}

impl InstrumentError {
    fn in_words(&self) -> String {
        format!(
            "{} {:+.1} ± {:.1} {}",
            self.what,
            self.estimate.value * self.scale,
            self.estimate.sigma * self.scale,
            self.unit
        )
    }

    fn told(&self) -> Option<Finding> {
        let told = self.estimate.sigmas_from(0.0).abs() > TOLD_SIGMAS
            && self.estimate.sigma < TOLD_NARROWED * self.known;
        told.then(|| Finding::note(self.in_words()))
    }
}

fn instruments(found: &JointEstimate) -> Vec<InstrumentError> {
    let (sizes, arcseconds) = (&found.sizes, 3600.0_f64.to_degrees());
    let mut errors = Vec::new();
    let mut add = |what: String, place, estimate, known, scale, unit| {
        errors.push(InstrumentError { what, place, estimate, known, scale, unit });
    };
    for station in 0..3 {
        let own = format!("station {}'s", station + 1);
        let ranges = || format!("{own} ranges are off by");
        let offset = found.range_offsets_m[station];
        add(ranges(), OFFSETS + station, offset, sizes.range_offset_m, 1e3, "mm");
        let scale = found.range_scales[station];
        add(ranges(), SCALES + station, scale, sizes.range_scale, 1e6, "ppm");
        let index = found.indices_rad[station];
        let what = format!("{own} zenith angles are off by");
        add(what, INDICES + station, index, sizes.index_rad, arcseconds, "″");
        let sight = found.collimations_rad[station];
        let what = format!("{own} line of sight is off by");
        add(what, COLLIMATIONS + station, sight, sizes.collimation_rad, arcseconds, "″");
        let latency = found.latencies_s[station];
        let what = format!("{own} angles are older than its ranges by");
        add(what, LATENCIES + station, latency, sizes.latency_s, 1e3, "ms");
        for (axis, lean) in found.leans_rad[station].into_iter().enumerate() {
            let what = format!("station {} leans about {} by", station + 1, ["x", "y"][axis]);
            let place = LEANS + 2 * station + axis;
            add(what, place, lean, sizes.lean_rad, arcseconds, "″");
        }
    }
    errors
}

/// "what makes σ of station 2: in x settling 0.6 of 0.9 mm, …".
fn dominant(found: &JointEstimate) -> Vec<Finding> {
    let line = |slot: usize| {
        let part = |axis: usize| {
            let place = 4 * slot + axis;
            let largest = found.budget.iter().max_by(|a, b| a.1[place].total_cmp(&b.1[place]));
            let (what, variance) = largest.map_or(("", 0.0), |(what, all)| (*what, all[place]));
            let (scale, unit) = if axis == 3 { (1e3, "mrad") } else { (1e3, "mm") };
            let digits = if axis == 3 { 3 } else { 1 };
            format!(
                "{} {what} ({:.digits$} of {:.digits$} {unit})",
                ["x", "y", "z", "yaw"][axis],
                variance.sqrt() * scale,
                found.covariance[(place, place)].sqrt() * scale,
            )
        };
        let parts: Vec<String> = (0..4).map(part).collect();
        format!("what dominates σ of station {}: {}", slot + 2, parts.join(", "))
    };
    [0, 1].map(line).into_iter().map(Finding::note).collect()
}

fn noise(found: &JointEstimate) -> Finding {
    let levels = &found.levels;
    Finding::note(format!(
        "readings scatter about the motion by {:.1} mm in range, {:.1}″ in angle and {:.1} ms in time; ranges wander by {:.1} mm",
        levels.range_m() * 1e3,
        levels.angle_rad.to_degrees() * 3600.0,
        levels.jitter_s * 1e3,
        found.wander.sigma_m * 1e3,
    ))
}
