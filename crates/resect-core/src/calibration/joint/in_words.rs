//! What the joint estimate found, in words: instruments, what did not stay as it was, and what its σ are made of.

use super::contradiction::Contradiction;
use super::instruments::{InstrumentError, instruments};
use super::unknowns::{CLOCKS, DISTANCES, DRIFTS, LATENCIES};
use super::{Dominant, JointEstimate, Step, Stepped};
use crate::calibration::Verdict;
use crate::calibration::estimate::sigmas_in_words;
use crate::calibration::{Estimate, clocks_in_words};
use crate::deployment::{Finding, Remedy, ToldAngle, ToldIn, pair_label};

/// How far one estimate may be from its prior by chance (σ): once in forty thousand, by some of thirty.
const MOST_STRAIN: f64 = 4.2;
/// How far the estimates of a station, or all of them, may be from their priors together by chance (σ): once in a
/// thousand.
const MOST_STRAIN_OF_STATION: f64 = 3.0;
const MOST_STRAIN_OF_ALL: f64 = 3.3;
/// A distance this far from its measurement asks for a new one (m).
const NOTABLE_DISTANCE_M: f64 = 0.003;
/// The largest errors of ranges to prisms that turn are 5 mm (Lackner & Lienhart 2016).
const MOST_WANDER_M: f64 = 0.005;
/// What becomes of a clock that drifts as none does.
const ALLOWED_FOR: &str = "the estimate allows for a drift, and for no more than that";
/// What is looked at before and after a step (s): its moment is known to about six seconds.
const AROUND_A_STEP_S: f64 = 20.0;

/// Estimated distances, and the distances measured on the vehicle (m).
pub fn distances(found: &JointEstimate, inter_prism_m: &[f64; 3]) -> Vec<Finding> {
    let estimated = found.distances_m.iter().flatten().zip(inter_prism_m).enumerate();
    estimated
        .map(|(pair, (distance, measured_m))| {
            let off_m = distance.value - measured_m;
            let line = format!(
                "prisms {}: {:+.1} ± {:.1} mm against the measured distance{}",
                pair_label(pair),
                off_m * 1e3,
                distance.sigma * 1e3,
                sigmas_in_words(distance.sigmas_from(*measured_m)),
            );
            if off_m.abs() > NOTABLE_DISTANCE_M {
                Finding::warning(format!("{line}; measure the rig again")).with(Remedy::PutRight)
            } else {
                Finding::note(line).tabled()
            }
        })
        .collect()
}

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
    findings.extend(instruments(found).iter().filter(|error| error.is_told()).map(|error| {
        let (line, angle) = error.in_words();
        Finding::note(line).telling(angle)
    }));
    findings.extend(dominant(found));
    findings.into_iter().map(Finding::tabled).collect()
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
            doubt(strained_in_words(&error, sigmas));
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
    if !strained && found.distances_m.is_some() && strain.of_distances > MOST_STRAIN_OF_STATION {
        strained = true;
        let moved_mm =
            [0, 1, 2].map(|pair| format!("{:+.1}", strain.moved[DISTANCES + pair] * 1e3));
        let line = format!(
            "prisms 1–2, 1–3, 2–3 would be {} mm from their measured distances, which is {:.1} σ beyond chance, taken \
             together: a station followed another prism for a while, or the rig is not as it was measured",
            moved_mm.join(", "),
            strain.of_distances
        );
        doubt(Finding::warning(line).with(Remedy::PutRight));
    }
    for contradiction in &found.contradictions {
        if contradiction.sigmas.abs() > MOST_STRAIN {
            strained = true;
            doubt(contradicted(contradiction, found));
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
        clocks_in_words::implausible_drifts(&found.clock_drifts, &jumping(found), ALLOWED_FOR)
            .into_iter()
            .map(|finding| (Verdict::Weak, finding)),
    );
    doubts
}

/// An error that is larger than instruments in order have.
fn strained_in_words(error: &InstrumentError, sigmas: f64) -> Finding {
    let ((line, angle), (known, known_angle)) = (error.in_words(), error.known_in_words());
    Finding::warning(format!(
        "{line}, where instruments in order have {known} (1 σ): {sigmas:.1} σ beyond chance, so something is wrong that this \
         estimate takes for it"
    ))
    .telling(angle.into_iter().chain(known_angle))
}

/// An error that was said to be smaller than the data has it.
fn contradicted(contradiction: &Contradiction, found: &JointEstimate) -> Finding {
    let Contradiction { place, found: by_data, sigmas } = *contradiction;
    let said = |line: String, angles: Vec<ToldAngle>, said: String| {
        Finding::warning(format!(
            "{line} by the data, which was said to be within {said} (1 σ): {:.1} σ beyond that, so this answer is bent; let it \
             have its usual size",
            sigmas.abs()
        ))
        .telling(angles)
    };
    let of_instruments = instruments(found);
    if let Some(error) = of_instruments.into_iter().find(|error| error.place == place) {
        let error = InstrumentError { estimate: by_data, ..error };
        let ((line, angle), (known, known_angle)) = (error.in_words(), error.known_in_words());
        return said(line, angle.into_iter().chain(known_angle).collect(), known);
    }
    let Estimate { value, sigma } = by_data;
    let sizes = &found.sizes;
    let (what, scale, unit, size) = match place {
        CLOCKS..DRIFTS => {
            let station = place - CLOCKS + 2;
            (format!("station {station}'s stamps are late"), 1e3, "ms", sizes.clock_offset_s)
        }
        DRIFTS..LATENCIES => {
            let station = place - DRIFTS + 2;
            (format!("station {station}'s clock drifts"), 1e6, "µs a second", sizes.clock_drift)
        }
        _ => {
            let pair = pair_label(place - DISTANCES);
            (format!("prisms {pair} are farther apart"), 1e3, "mm", sizes.inter_prism_m)
        }
    };
    let line = format!("{what} by {:+.2} ± {:.2} {unit}", value * scale, sigma * scale);
    said(line, Vec::new(), format!("{:.2} {unit}", size * scale))
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
    let (line, angle) = match &step.what {
        Stepped::Clock(by_s) => (
            format!(
                "station {station}'s stamps jump by {:+.1} ± {:.1} ms {when}, which no offset puts right",
                by_s.value * 1e3,
                by_s.sigma * 1e3,
            ),
            None,
        ),
        Stepped::Station { turned_rad, .. } => {
            let moved = step.moved_m().unwrap_or(Estimate { value: 0.0, sigma: 0.0 });
            let turned = ToldAngle::signed(turned_rad.value, ToldIn::Milliradians, 3)
                .sigma(turned_rad.sigma);
            let line = format!(
                "station {station} turned by {turned} and moved by {:.1} ± {:.1} mm {when}",
                moved.value * 1e3,
                moved.sigma * 1e3,
            );
            (line, Some(turned))
        }
    };
    if found.is_usual(step) {
        let line = format!("{line}; no more than σ allows for");
        return (Verdict::Good, Finding::note(line).telling(angle));
    }
    let remedy = if step.slowly { "find out why" } else { "cut the recording there" };
    let line = format!(
        "{line}; the estimate allows for it, but no one answer holds for the whole drive: {remedy}"
    );
    let seen = (!step.slowly).then(|| {
        let at_s = found.at_s(step);
        Remedy::ShowTimes([at_s - AROUND_A_STEP_S, at_s + AROUND_A_STEP_S])
    });
    let finding = Finding::warning(line).telling(angle);
    (Verdict::Weak, seen.into_iter().fold(finding, Finding::with))
}

/// "what dominates σ of station 2: x settling (0.6 of 0.9 mm), …".
fn dominant(found: &JointEstimate) -> Vec<Finding> {
    let line = |slot: usize| {
        let mut angles = Vec::new();
        let mut part = |axis: usize| {
            let Dominant { what, part, whole } = found.dominant(4 * slot + axis);
            let axis_name = ["x", "y", "z", "yaw"][axis];
            if axis < 3 {
                return format!("{axis_name} {what} ({:.1} of {:.1} mm)", part * 1e3, whole * 1e3);
            }
            let [part, whole] =
                [part, whole].map(|rad| ToldAngle::size(rad, ToldIn::Milliradians, 3));
            angles.extend([part, whole]);
            format!("{axis_name} {what} ({part} of {whole})")
        };
        let parts: Vec<String> = (0..4).map(&mut part).collect();
        let line = format!("what dominates σ of station {}: {}", slot + 2, parts.join(", "));
        Finding::note(line).telling(angles)
    };
    [0, 1].map(line).into()
}

fn noise(found: &JointEstimate) -> Finding {
    let levels = &found.levels;
    let angle = ToldAngle::size(levels.angle_rad, ToldIn::Arcseconds, 1);
    Finding::note(format!(
        "readings scatter about the motion by {:.1} mm in range, {angle} in angle and {:.1} ms in time; ranges wander by {:.1} mm",
        levels.range_m() * 1e3,
        levels.jitter_s * 1e3,
        found.wander.sigma_m * 1e3,
    ))
    .telling([angle])
}
