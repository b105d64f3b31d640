//! What the joint estimate found, in words: instruments, what did not stay as it was, and what its σ are made of.

use super::{JointEstimate, Step, Stepped};
use crate::calibration::Verdict;
use crate::calibration::inter_prism::{Estimate, refinement_in_words};
use crate::deployment::Finding;

/// An estimate further than this many σ of its prior from where that puts it has another cause than chance.
const MOST_PRIOR_SIGMAS: f64 = 5.0;
/// Five of them together are this large once in a hundred thousand times.
const MOST_TOGETHER_SIGMAS: f64 = 5.5;
/// An instrument's error is told where it is this many of its σ, and the data narrowed what was known by this share.
const TOLD_SIGMAS: f64 = 2.5;
const TOLD_NARROWED: f64 = 0.8;

pub fn findings(found: &JointEstimate) -> Vec<Finding> {
    let mut findings = vec![noise(found)];
    findings.extend(refinement_in_words::clocks(&found.clock_offsets_s, &found.clock_drifts));
    findings.extend(instruments(found).into_iter().filter_map(|error| error.told()));
    findings.extend(dominant(found));
    findings
}

/// What speaks against the estimate itself, each with the verdict that it allows at most.
pub fn doubts(found: &JointEstimate) -> Vec<(Verdict, Finding)> {
    let mut doubts = Vec::new();
    for error in instruments(found) {
        // What is held to be nothing says nothing.
        if error.known > 0.0 && error.estimate.value.abs() > MOST_PRIOR_SIGMAS * error.known {
            let line = format!(
                "{}, which instruments in order do not leave ({:.1} {}, 1 σ): something is wrong that this estimate takes \
                 for it",
                error.in_words(),
                error.known * error.scale,
                error.unit
            );
            doubts.push((Verdict::Weak, Finding::warning(line)));
        }
    }
    for station in 0..3 {
        let sigmas = instrument_sigmas(found, station);
        if sigmas > MOST_TOGETHER_SIGMAS {
            let line = format!(
                "what is wrong with station {}'s ranges, zenith angles and lean would be {sigmas:.1} σ of what instruments in \
                 order have, taken together: it was knocked, or something else bends the answer",
                station + 1
            );
            doubts.push((Verdict::Weak, Finding::warning(line)));
        }
    }
    doubts.extend(found.stepped.iter().map(|step| stepped(step, found)));
    doubts.extend(
        refinement_in_words::implausible_drifts(&found.clock_drifts, &jumping(found))
            .into_iter()
            .map(|finding| (Verdict::Weak, finding)),
    );
    doubts
}

/// How large the errors of a station are together, in units of what is known of each beforehand.
fn instrument_sigmas(found: &JointEstimate, station: usize) -> f64 {
    let sizes = &found.sizes;
    let [x, y] = found.leans_rad[station];
    let errors = [
        (found.range_offsets_m[station], sizes.range_offset_m),
        (found.range_scales[station], sizes.range_scale),
        (found.indices_rad[station], sizes.index_rad),
        (x, sizes.lean_rad),
        (y, sizes.lean_rad),
    ];
    let told = errors.iter().filter(|(_, known)| *known > 0.0);
    told.map(|(error, known)| (error.value / known).powi(2)).sum::<f64>().sqrt()
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
    let line = match &step.what {
        Stepped::Clock(by_s) => format!(
            "station {station}'s stamps jump by {:+.1} ± {:.1} ms about {:.0} s into the drive, which no offset puts right",
            by_s.value * 1e3,
            by_s.sigma * 1e3,
            step.after_s
        ),
        Stepped::Station { turned_rad, .. } => {
            let moved = step.moved_m().unwrap_or(Estimate { value: 0.0, sigma: 0.0 });
            format!(
                "station {station} turned by {:+.3} ± {:.3} mrad and moved by {:.1} ± {:.1} mm about {:.0} s into the drive",
                turned_rad.value * 1e3,
                turned_rad.sigma * 1e3,
                moved.value * 1e3,
                moved.sigma * 1e3,
                step.after_s
            )
        }
    };
    if found.is_usual(step) {
        let line = format!("{line}; no more than σ allows for");
        return (Verdict::Good, Finding::note(line));
    }
    let line = format!(
        "{line}; the estimate allows for it, but no one answer holds for the whole drive: cut the recording there"
    );
    (Verdict::Weak, Finding::warning(line))
}

/// An error of an instrument that was estimated.
struct InstrumentError {
    what: String,
    /// About zero, or what geometry says.
    estimate: Estimate,
    /// What was known of it beforehand (1 σ).
    known: f64,
    /// From the estimate's unit to the one that is shown.
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
    let mut add = |what: String, estimate: Estimate, known: f64, scale: f64, unit: &'static str| {
        errors.push(InstrumentError { what, estimate, known, scale, unit });
    };
    for station in 0..3 {
        let own = format!("station {}'s", station + 1);
        let offset = found.range_offsets_m[station];
        add(format!("{own} ranges are off by"), offset, sizes.range_offset_m, 1e3, "mm");
        let scale = found.range_scales[station];
        add(format!("{own} ranges are off by"), scale, sizes.range_scale, 1e6, "ppm");
        let index = found.indices_rad[station];
        let what = format!("{own} zenith angles are off by");
        add(what, index, sizes.index_rad, arcseconds, "″");
        let latency = found.latencies_s[station];
        let what = format!("{own} angles are older than its ranges by");
        add(what, latency, sizes.latency_s, 1e3, "ms");
        for (axis, lean) in found.leans_rad[station].into_iter().enumerate() {
            let own = format!("station {} leans about {} by", station + 1, ["x", "y"][axis]);
            add(own, lean, sizes.lean_rad, arcseconds, "″");
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
