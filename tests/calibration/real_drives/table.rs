//! The tables of the real drives, as Markdown.

use resect_core::calibration::joint::SetUpChange;
use resect_core::evaluation::{evaluate, known_distances_m};
use resect_core::geometry::RigidTransform;
use resect_core::network::PerStation;

use super::drive_answers::{DriveAnswers, JudgedAnswer};
use super::real_drive::RealDrive;

const ANSWERS: &str = "\
| drive | answer | plan, mm | height, mm | left-out points, mm | ratio to B | inter-prism, mm: estimated | measured | converged | verdict | ms |
|---|---|---:|---:|---:|---:|---:|---:|---|---|---:|";
const DIFFERENCES: &str = "\
| drive | χ² of 8 | x₂ | y₂ | z₂ | yaw₂ | x₃ | y₃ | z₃ | yaw₃ | change since the survey |
|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---|";
const MISSING: &str = "–";

/// Prints a row for each answer to each drive.
pub fn print_answers(all: &[DriveAnswers]) {
    println!("{ANSWERS}");
    for answers in all {
        if let Some(cells) = published_cells(answers) {
            println!("| {} |", cells.join(" | "));
        }
        for answer in answers.all() {
            println!("| {} |", answer_cells(answers, answer).join(" | "));
        }
    }
}

/// Prints the joint estimates by the drive alone, less method B, in σ of the difference.
pub fn print_differences(all: &[DriveAnswers]) {
    println!("{DIFFERENCES}");
    for answers in all {
        let Some(difference) = answers.drive_less_points() else { continue };
        let sigmas = difference.sigmas.map(|sigmas| format!("{sigmas:+.1}")).join(" | ");
        let change = answers.change().map_or_else(|| "none".to_owned(), change_in_words);
        println!("| {} | {:.1} | {sigmas} | {change} |", answers.drive.name, difference.chi_square);
    }
}

/// Returns the cells of the published transforms; `None` if there is none.
fn published_cells(answers: &DriveAnswers) -> Option<Vec<String>> {
    let published = answers.drive.published.as_ref()?;
    let (deployment, analysis) = (&answers.drive.deployment, &answers.by_everything.analysis);
    let followed = &analysis.offer.followed;
    let distances_m = known_distances_m(deployment, followed);
    let evaluation = evaluate(
        deployment,
        &analysis.pipeline.triplets,
        (followed, distances_m.as_ref()),
        &published.station1_from_station,
    );
    let measured_mm = evaluation.inter_prism_mm.map(|spread| spread.median);
    let mut cells = vec![MISSING.to_owned(); 11];
    cells[0] = answers.drive.name.clone();
    cells[1] = published.method.to_owned();
    cells[7] = format_mm(measured_mm);
    Some(cells)
}

/// Returns the cells of one answer to a drive.
fn answer_cells(answers: &DriveAnswers, judged: &JudgedAnswer) -> Vec<String> {
    let mut cells = vec![answers.drive.name.clone(), judged.name.clone()];
    let Some(answer) = judged.answer() else {
        cells.extend([MISSING; 7].map(str::to_owned));
        cells.extend(["no answer".to_owned(), MISSING.to_owned()]);
        return cells;
    };
    cells.extend(format_off_published(&answers.drive, &answer.calibration.station1_from_station));
    cells.push(format_mm(judged.median_left_out_mm()));
    let ratio = answers.ratio_to_points(judged);
    cells.push(ratio.map_or_else(|| MISSING.to_owned(), |ratio| format!("{ratio:.2}")));
    let inter_prism_mm = judged.inter_prism_mm();
    let against_measured_mm = answer.evaluation.against_measured_mm.map(|spread| spread.median);
    // An answer without estimated distances is evaluated with the measured ones.
    cells.push(format_mm(inter_prism_mm.filter(|_| against_measured_mm.is_some())));
    cells.push(format_mm(against_measured_mm.or(inter_prism_mm)));
    let joint = answer.calibration.joint();
    let converged = joint.map(|joint| format!("yes, {} steps", joint.iterations));
    cells.push(converged.unwrap_or_else(|| MISSING.to_owned()));
    cells.push(answer.calibration.verdict.name().to_owned());
    cells.push(format!("{:.0}", judged.analysis.total_ms()));
    cells
}

/// Writes distance in plan and height of the tracks of stations 2 and 3, compared with the published transforms.
fn format_off_published(drive: &RealDrive, transforms: &PerStation<RigidTransform>) -> [String; 2] {
    let off_mm = |station| drive.off_published_mm(transforms, station);
    match (off_mm(1), off_mm(2)) {
        (Some([plan2, height2]), Some([plan3, height3])) => {
            [format!("{plan2:.1} / {plan3:.1}"), format!("{height2:+.1} / {height3:+.1}")]
        }
        _ => [MISSING; 2].map(str::to_owned),
    }
}

fn format_mm(value_mm: Option<f64>) -> String {
    value_mm.map_or_else(|| MISSING.to_owned(), |value_mm| format!("{value_mm:.2}"))
}

fn change_in_words(change: &SetUpChange) -> String {
    let station = change
        .station
        .map_or_else(|| "an undecided station".to_owned(), |station| format!("station {station}"));
    let (turned, sigma) = (1e3 * change.turned_rad.value, 1e3 * change.turned_rad.sigma);
    format!("{station} turned by {turned:+.2} ± {sigma:.2} mrad")
}
