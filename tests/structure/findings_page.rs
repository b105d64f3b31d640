//! The page of the findings, `docs/src/findings.md`, compared with the kinds of the core.
//!
//! `UPDATE_GOLDEN=1 cargo test --test structure findings_page` writes it again.

use std::fmt::Write;

use crate::documents::{anchor, assert_written};
use resect::app::kinds::of_all_crates;
use resect_core::deployment::advice::{ADVICE, Advice};
use resect_core::deployment::{FindingKind, Severity};

/// Sections of the page, each with the code of its first kind.
const SECTIONS: [(&str, &str); 22] = [
    ("file-unreadable", "Files"),
    ("table-columns", "Readings"),
    ("bag-damaged", "Bags and tables"),
    ("tracks-in-station-frames", "Frames of the tracks"),
    ("control-point-station-unknown", "Control points"),
    ("survey-readings-unusable", "Surveys"),
    ("rig-file-preferred", "Rig"),
    ("gnss-antennas-missing", "GNSS"),
    ("estimate-out-of-order", "Trajectories of other systems"),
    ("stations-without-common-time", "Clocks of the files"),
    ("no-triplets", "Answers that are missing"),
    ("estimate-not-converged", "Convergence and agreement of methods"),
    ("points-leave-direction-free", "Observability"),
    ("mirror-same-height", "Mirror ambiguity"),
    ("control-points-contradict", "Contradictions and outliers"),
    ("clock-offset", "Clocks and set-ups"),
    ("noise-levels", "Instrument errors and distances"),
    ("tracks-aligned", "One prism, control points and resection"),
    ("estimate-clock-far-off", "Evaluation and studies"),
    ("earlier-calibration-weak", "Validation and plans"),
    ("no-connection", "Live drive"),
    ("autosave-unavailable", "Window"),
];

/// Remedies of the warnings for which the Guide has no advice.
const REMEDIES: &[(&str, &str)] = &[
    ("file-unreadable", "Check its permissions if it belongs to the deployment."),
    ("records-dropped", "Look at the first record that the message names; a few are usual."),
    ("stamps-out-of-order", "Check the recorder if many readings are concerned."),
    ("stamps-repeated", "Check that no file was added twice."),
    ("ranges-repeated", "Use a faster tracking mode of the instrument for the next drive."),
    (
        "masked-readings-missing",
        "Remove `masked` from `deployment.toml`, or open the data that it was made for.",
    ),
    ("bag-damaged", "Copy the bag again from the robot; otherwise use the readable part."),
    ("bag-messages-malformed", "Check the version of the message definitions that were recorded."),
    ("stamps-jumped", "Split the file into one file for each drive, and open them separately."),
    ("rows-skipped", "Correct the line that the message names."),
    ("bag-splits-unread", "Open the folder, or list all bags under `tracks` in `deployment.toml`."),
    ("bag-missing", "Copy the missing bag beside the others."),
    (
        "readings-without-stamp",
        "Record `header.stamp`; until then look at the clock offsets of the joint estimate.",
    ),
    (
        "topic-without-positions",
        "Correct `topics` in `deployment.toml`; the message lists the topics with positions.",
    ),
    (
        "tracks-in-common-frame",
        "Add the transforms that were applied as `list_tf/*.csv`, or use the original readings.",
    ),
    ("transforms-unreadable", "Correct the line that the message names."),
    ("transforms-not-confirmed", "Use the original readings, or the transforms of the same day."),
    ("transform-tilts-station", "Use the original readings."),
    (
        "control-point-station-unknown",
        "Write the number of a station with a track in the first column.",
    ),
    ("control-point-status-invalid", "Measure the point again if too few remain."),
    ("control-point-reading-implausible", "Correct the line, or measure the point again."),
    ("control-point-repeated", "Delete the reading that is not wanted."),
    (
        "control-points-empty",
        "Check the columns: station, marker, status, zenith angle, azimuth, distance.",
    ),
    ("pillar-coordinates-unknown", "Add the pillar to the survey of pillars."),
    (
        "pillars-without-readings",
        "Rename the file with the readings of the pillars to `Two_points.txt`.",
    ),
    ("known-point-not-measured", "Check the file name and the marker in the list of coordinates."),
    ("survey-readings-unusable", "Measure the points again if too few remain."),
    ("survey-points-inconsistent", "Give each point its own name, and each set-up its own file."),
    ("survey-other-set-ups", "Save each set-up in its own file."),
    ("survey-readings-incomplete", "Export distance and both angles of each reading."),
    ("survey-points-deleted", "Restore them in the job if they were deleted by mistake."),
    (
        "survey-prism-constant-missing",
        "State `prism_constant_m` in `deployment.toml` if the survey used another prism.",
    ),
    ("survey-empty", "Export the readings, not only the coordinates."),
    (
        "survey-coordinates-left-out",
        "Add the file to `control_points` in `deployment.toml` if they are surveyed.",
    ),
    (
        "survey-station-unknown",
        "End the name of the file with the number of the station, or list the files under `surveys`.",
    ),
    ("survey-station-repeated", "Remove one of the two files, or correct the number in its name."),
    ("prism-positions-of-other-rig", "Measure the positions of the prisms on this rig."),
    (
        "prism-positions-disagree",
        "Measure the positions and the distances again; one of them is wrong.",
    ),
    ("gnss-antennas-missing", "List three solution files under `gnss` in `deployment.toml`."),
    ("gnss-origins-differ", "Solve all antennas with the same settings."),
    ("gnss-stamps-out-of-order", "Check the settings of the solver if many fixes are concerned."),
    ("gnss-stamps-repeated", "Check that the file was not joined from overlapping files."),
    (
        "gnss-solutions-left-out",
        "Use `--truth-solutions float` or `all`, or compute a better solution (PPK with a near base).",
    ),
    ("gnss-without-solution", "Compare only the span that has solutions."),
    (
        "gnss-not-fixed",
        "Compute the solution with a base station (PPK), or use another ground truth.",
    ),
    ("gnss-dates-missing", "Let the receiver write RMC or ZDA beside GGA."),
    ("gnss-sigma-approximated", "State σ with `--truth-sigma`."),
    ("gnss-column-not-read", "Write qualities as words; export orientations as a table of poses."),
    (
        "antenna-epochs-left-out",
        "Compute the solutions of all antennas from the same base; look for wrong ambiguities if many epochs contradict.",
    ),
    ("antennas-without-sigma", "Export the solutions with standard deviations."),
    ("estimate-out-of-order", "Write the poses in order of time."),
    ("estimate-stamps-joined", "Write nanoseconds with nine digits."),
    ("estimate-columns-unread", "Name the columns as the message says, or remove them."),
    ("estimate-times-repeated", "Write one pose for each time."),
    ("estimate-orientations-missing", "Write an orientation for each pose, or for none."),
    ("estimate-positions-rounded", "Write positions with millimetres or more digits."),
    ("estimate-covariances-missing", "Write a covariance for each pose, or for none."),
    ("estimate-quaternions-normalised", "Write quaternions with more digits."),
    ("estimate-angles-not-read", "Export the rotations as quaternions."),
    ("published-answer-missing", "Follow the reason that the message names."),
    ("tracks-not-transformed", "Apply the answer to the original readings only."),
    ("prior-search-unconfirmed", "Use the closed-form prior (`--prior closed-form`)."),
    (
        "estimate-orientation-convention",
        "Give the convention that the message names, or write the orientations of the body in the world of the positions.",
    ),
    ("estimate-unit", "Give the unit that the message names, or write metres."),
    ("estimate-clock-rate", "Give the unit or rate that the message names, or write seconds."),
    (
        "estimate-poses-held",
        "Write each pose once, with its own stamp; `--convention held` does that.",
    ),
    (
        "estimate-poses-unset",
        "Begin the file with the first real pose; `--convention unset` does that.",
    ),
    (
        "estimate-mirrored",
        "Give the convention that the message names, or write right-handed positions and orientations.",
    ),
    ("estimate-bodies-mixed", "Write one file for each body or child frame."),
    ("deployment-left-out", "Calibrate this deployment by itself; its findings name the cause."),
    ("earlier-calibration-weak", "Validate a calibration with the verdict *good*."),
    ("compared-in-unknown-frame", "Compare runs with the original readings."),
    ("rig-differs-from-earlier", "Use the rig of the run; compare the transforms only."),
    ("plan-readings-lost", "Change the route or the speed where the message says."),
    ("no-connection", "Check address, port and network; the program connects again by itself."),
    ("lost-lock", "Stop until the station has found its prism again."),
    ("straight-line", "Turn, as the advice says."),
    ("no-station", "Name the topics or instruments with `--topics` or `--instruments`."),
    ("not-recorded", "Free space on the disk, and start a new recording."),
    (
        "autosave-unavailable",
        "Save the session by hand; check the space and the permissions of the folder.",
    ),
    ("earlier-session-kept", "Open it from the menu File, or delete it."),
    ("session-part-unknown", "Open the session with the version that wrote it."),
    ("session-plan-invalid", "Correct the plan in its own file, and open that."),
    ("unusable-file-kept", "Copy from it by hand what is needed, and delete it."),
    ("session-file-changed", "Check that the change was intended, and save the session."),
    ("session-file-missing", "Put the file back, or open its new place."),
    ("layout-invalid", "Choose a layout under View > Layout."),
];

const HEAD: &str = "\
# Findings

A finding is a note, a warning or a problem, with a stable code, a message and quantities ([JSON and CSV](json.md)).
This page is generated from the source: `UPDATE_GOLDEN=1 cargo test --test structure findings_page`.

| severity | meaning |
|---|---|
| note | information; needs no remedy unless one is given |
| warning | may bias the answer, or loses data |
| warning, *weak* | a warning about the data: the verdict of every answer from it is *weak* at best; `warning` in JSON |
| problem | no answer, or an answer with an unobservable direction |

The table has the usual severity. Some findings have a lower or higher one by their size, so scripts should read `severity` from the output.
The last column links to the advice of the Guide (Help in the window), which is below.

## Findings that limit the verdict
Any finding with one of these codes limits the verdict of every answer from the data to *weak*:
";

const LIMITS: &str = ".

`rig-derived-from-reading` and `rig-reading-disagrees` do not limit a joint estimate with control points, which tests the distances of the rig. Other warnings
limit the verdict of some answers only. `diagnosis.verdict` of the JSON has the verdict, and `diagnosis.doubts` the warnings and problems about the answer.
";

fn severity(kind: FindingKind) -> &'static str {
    match kind.severity() {
        _ if kind.is_doubt() => "warning, *weak*",
        Severity::Note => "note",
        Severity::Warning => "warning",
        Severity::Problem => "problem",
    }
}

fn remedy(kind: FindingKind) -> String {
    if let Some(Advice { title, step, .. }) = kind.advice {
        return format!("{step} [Why](#{})", anchor(title));
    }
    let own = REMEDIES.iter().find(|(code, _)| *code == kind.code);
    own.map_or("–", |(_, remedy)| remedy).to_owned()
}

fn page() -> String {
    let kinds = of_all_crates();
    let doubts = kinds.iter().filter(|kind| kind.is_doubt());
    let codes: Vec<String> = doubts.map(|kind| format!("`{}`", kind.code)).collect();
    let mut page = format!("{HEAD}{}{LIMITS}", codes.join(",\n"));
    for kind in &kinds {
        if let Some((_, title)) = SECTIONS.iter().find(|(first, _)| *first == kind.code) {
            _ = write!(
                page,
                "\n## {title}\n\n| code | severity | cause | remedy |\n|---|---|---|---|\n"
            );
        }
        let (code, severity) = (kind.code, severity(*kind));
        _ = writeln!(page, "| `{code}` | {severity} | {} | {} |", kind.cause, remedy(*kind));
    }
    page += "\n## Advice\n";
    for Advice { title, meaning, step, .. } in ADVICE {
        _ = write!(page, "\n### {title}\n{meaning} {step}\n");
    }
    page
}

#[test]
fn the_page_has_every_kind_as_the_code_does() {
    assert_written("docs/src/findings.md", &page());
}

#[test]
fn every_section_begins_with_a_kind() {
    for (first, title) in SECTIONS {
        assert!(of_all_crates().iter().any(|kind| kind.code == first), "{title}: {first}");
    }
}

/// The remedies are those of the warnings without advice, in the order of the kinds.
#[test]
fn every_warning_without_advice_has_a_remedy() {
    let needs = |kind: &&FindingKind| kind.severity() > Severity::Note && kind.advice.is_none();
    let expected: Vec<_> = of_all_crates().iter().filter(needs).map(|kind| kind.code).collect();
    let written: Vec<_> = REMEDIES.iter().map(|(code, _)| *code).collect();
    let first = expected.iter().zip(&written).find(|(expected, written)| expected != written);
    assert_eq!(expected.len(), written.len(), "{first:?}");
    assert_eq!(first, None, "expected, written");
}
