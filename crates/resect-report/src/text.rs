//! An answer as plain text, for the terminal and the clipboard.

use std::fmt::Write;

use crate::difference::moved_from_published;
use crate::of_run;
use crate::rows::{Pivot, deviation, pivot, prior};
use resect_core::analysis::{Analysis, Answer};
use resect_core::calibration::inter_prism::PriorSearch;
use resect_core::calibration::{Calibration, Details, SUPPORTED_SIGMAS, recommend};
use resect_core::deployment::{Deployment, Finding, MessageAngle};
use resect_core::evaluation::Spread;
use resect_core::evaluation::answer_rows::{AnswerRow, RowGroup, transform_rows};
use resect_core::network::Prism;
use resect_core::pipeline::{PipelineOutput, SampleFate};

/// Formats a finding as one line: its message, on the command line with the flags of its remedies.
pub type FindingLine = fn(&Finding) -> String;

/// Formats recommendation, verdict, transforms with their σ, metrics and findings.
pub fn calibration(
    deployment: &Deployment,
    analysis: &Analysis,
    answer: &Answer,
    finding_line: FindingLine,
) -> String {
    let Answer { calibration, evaluation, .. } = answer;
    let out = &analysis.pipeline;
    let raw = deployment.tracks.map(|track| track.measurements.len());
    let mut text = format!(
        "{} · {} · verdict: {}{}\n\n",
        deployment.name,
        calibration.method_in_words(),
        calibration.verdict.name().to_uppercase(),
        calibration.verdict.caveat(calibration.is_independently_checked())
    );
    for sentence in recommend(calibration, deployment).sentences(MessageAngle::to_string) {
        _ = writeln!(text, "{sentence}");
    }
    text.push('\n');
    let kept = out.counts(SampleFate::Kept);
    _ = writeln!(
        text,
        "pipeline    {} of {} readings kept ({}: {}), {} intervals, {} triplets",
        kept.iter().sum::<usize>(),
        raw.iter().sum::<usize>(),
        all_stations(kept.len()),
        kept.zip(&raw, |kept, raw| format!("{kept}/{raw}")).as_slice().join(", "),
        out.kept_intervals.len(),
        out.triplets.len(),
    );
    if let Some(unused) = unused_readings(out) {
        _ = writeln!(text, "            not used: {unused}");
    }
    if let Some(joint) = calibration.joint() {
        let taken = joint.solution.readings();
        _ = writeln!(
            text,
            "joint       {} readings taken ({}: {})",
            taken.iter().sum::<usize>(),
            all_stations(taken.len()),
            taken.zip(&raw, |taken, raw| format!("{taken}/{raw}")).as_slice().join(", "),
        );
    }
    let named = deployment.tracks.each().filter(|(_, track)| track.name.is_some());
    let named: Vec<String> = named.map(|(at, _)| deployment.station_in_words(at)).collect();
    if !named.is_empty() {
        _ = writeln!(text, "names       {}", named.join(", "));
    }
    text.push('\n');
    if calibration.station1_from_station.len() > 1 {
        text += &transforms(calibration);
        text += &mirror_twin(calibration);
        text.push('\n');
    }
    text += &published(calibration);
    text += &estimates(&analysis.rows(deployment));
    text += &details(calibration);
    if let Some(spread) = &evaluation.inter_prism_mm {
        let name = match Prism::is_one(&analysis.offer.followed) {
            true => "same prism ",
            false => "inter-prism",
        };
        _ = writeln!(text, "{name}   {}", spread_text(spread));
    }
    if let Some(spread) = &evaluation.against_measured_mm {
        _ = writeln!(
            text,
            "as measured   {}   with the measured distances, not the estimated ones",
            spread_text(spread)
        );
    }
    for metric in &evaluation.control_points_mm {
        _ = writeln!(text, "control pts   {}   {}", spread_text(&metric.spread), metric.file);
    }
    text.push('\n');
    // Doubts about the data are also among the answer's own findings.
    let of_data = deployment.findings.iter().filter(|finding| !finding.kind.is_doubt());
    for finding in of_data.chain(&calibration.findings) {
        _ = writeln!(text, "  {} {}", finding.severity.mark(), finding_line(finding));
    }
    text
}

/// Formats the durations of an answer as a line; empty if outputs are compared.
pub fn durations(analysis: &Analysis, answer: &Answer) -> String {
    if !of_run::tells_durations() {
        return String::new();
    }
    format!(
        "\n{:.1} ms: pipeline {:.1}, prior {:.1}, solve {:.1}, metrics {:.1}\n",
        analysis.total_ms(),
        analysis.pipeline_ms,
        answer.calibration.prior_ms,
        answer.calibration.solve_ms,
        analysis.evaluation_ms
    )
}

/// Formats the difference of a joint estimate and the paper's answer; empty for any other answer.
fn published(joint: &Calibration) -> String {
    let (Some(published), Some(moved)) = (&joint.published, moved_from_published(joint)) else {
        return String::new();
    };
    let mut text = format!(
        "difference from the paper's {} (method {}, verdict {}):\n",
        published.method.short_name(),
        published.method.name(),
        published.verdict_in_words()
    );
    for station in moved {
        _ = writeln!(text, "  {}", station.in_words());
    }
    text.push('\n');
    text
}

/// Formats the details of the method; empty if it has none.
fn details(calibration: &Calibration) -> String {
    let mut text = String::new();
    match &calibration.details {
        Details::TwoPoint(details) => {
            let stations = all_stations(calibration.station1_from_station.len());
            _ = writeln!(
                text,
                "pairs of known points    length (m)   baseline errors of {stations} (mm)   other points, max (mm)   from known (mm)"
            );
            for (index, pair) in details.pairs.iter().enumerate() {
                let [first, second] = pair.markers;
                let chosen = if index == details.chosen { "*" } else { " " };
                let errors = pair.baseline_errors_m.map(|error| format!("{:>+10.1}", error * 1e3));
                let largest = |sorted: &[f64]| {
                    sorted.last().map_or("–".to_owned(), |m| format!("{:.1}", m * 1e3))
                };
                _ = writeln!(
                    text,
                    "{chosen} {first:>3}–{second:<3} {:<16} {:>9.3}   {}   {:>22}   {:>15}",
                    pair.file,
                    pair.baseline_m,
                    errors.as_slice().join(" "),
                    largest(&pair.left_out_m),
                    pair.largest_from_known_m()
                        .map_or("–".to_owned(), |m| format!("{:.1}", m * 1e3)),
                );
            }
            text.push('\n');
        }
        Details::StaticGcp(details) => {
            if let Some(world) = &details.world_from_station1 {
                let t = world.translation_m;
                _ = writeln!(
                    text,
                    "station 1 in the points' frame: {:.4}, {:.4}, {:.4} m, yaw {:.6} rad\n",
                    t.x,
                    t.y,
                    t.z,
                    world.yaw_rad()
                );
            }
        }
        Details::DynamicGcp(_) | Details::InterPrism(_) | Details::Joint(_) => {}
    }
    if let Some(details) = calibration.inter_prism() {
        if let Some(search) = &details.prior_search {
            text += &search_table(search);
        }
        let next = details.basins.iter().find(|basin| **basin != details.basin);
        let next = next.map_or(String::new(), |basin| {
            format!("; cost ratio of the next best {:.2}", details.cost_ratio(basin))
        });
        _ = writeln!(text, "minima        {} found{next}", details.basins.len());
    }
    text
}

/// Formats both steps of the search of the prior, a line for each speed limit.
fn search_table(search: &PriorSearch) -> String {
    let mut text = String::from(
        "search of the prior   τ_v (m/s)   triplets   cost rms (mm)   median of all (mm)   runs that agree\n",
    );
    for (step, (runs, best)) in search.steps.iter().zip(search.best).enumerate() {
        for (index, run) in runs.iter().enumerate() {
            let chosen = if best == Some(index) { "*" } else { " " };
            _ = writeln!(
                text,
                "{chosen} step {}              {:>9.2}   {:>8}   {:>13.2}   {:>18.2}   {:>15}",
                step + 1,
                run.tau_v_m_per_s,
                run.triplets,
                run.rms_m * 1e3,
                run.metric_m * 1e3,
                run.agreeing,
            );
        }
    }
    text.push('\n');
    text
}

/// Counts the readings that interpolation does not use, by reason: "912 in no interval, 18 left out by hand"; `None` if all
/// are used.
pub fn unused_readings(out: &PipelineOutput) -> Option<String> {
    let unused = SampleFate::ALL.into_iter().filter(|fate| *fate != SampleFate::Kept);
    let counts = unused.map(|fate| (fate, out.counts(fate).iter().sum()));
    let words: Vec<String> = counts
        .filter(|(_, count): &(SampleFate, usize)| *count > 0)
        .map(|(fate, count)| format!("{count} {}", fate.label()))
        .collect();
    (!words.is_empty()).then(|| words.join(", "))
}

/// Formats the transforms of the mirror twin, a line for each station; empty if there is none.
fn mirror_twin(calibration: &Calibration) -> String {
    let twin = calibration.inter_prism().and_then(|details| details.mirror.twin.as_ref());
    let Some(twin) = twin else { return String::new() };
    let mut text = String::new();
    for station in 1..twin.station1_from_station.len() {
        let transform = &twin.station1_from_station[station];
        _ = write!(text, "mirror T1{}", station + 1);
        for axis in 0..3 {
            let width = if axis == 0 { 11 } else { 20 };
            _ = write!(text, "{:>width$.4}", transform.translation_m[axis]);
        }
        _ = writeln!(text, "{:>20.5}", transform.yaw_rad);
    }
    text
}

/// Formats the transforms as a table; a missing σ is a dash.
pub fn transforms(calibration: &Calibration) -> String {
    let mut text = String::from(
        "              x (m) ± mm          y (m) ± mm          z (m) ± mm          yaw (rad) ± mrad\n",
    );
    let rows = transform_rows(calibration);
    let Pivot { subjects, lines } = pivot(&rows);
    for (column, subject) in subjects.into_iter().enumerate() {
        _ = write!(text, "{subject}     ");
        for row in lines.iter().filter_map(|line| line.cells[column]) {
            match row.name.as_str() {
                "x" | "y" | "z" => {
                    _ = write!(text, "{:>11.4} ± {:<6}", row.value, sigma_text(row.sigma, 1));
                }
                "yaw" => _ = writeln!(text, "{:>11.5} ± {}", row.value, sigma_text(row.sigma, 3)),
                name => {
                    _ = writeln!(text, "{name:>8} {:>11.5} rad", row.value);
                }
            }
        }
    }
    text
}

/// Formats the estimates besides the transforms, a column for each station and pair; empty without any.
fn estimates(rows: &[AnswerRow]) -> String {
    let mut text = String::new();
    let of = |groups: &[RowGroup]| {
        pivot(rows.iter().filter(|row| groups.contains(&row.group)).collect::<Vec<_>>())
    };
    let groups: [&[RowGroup]; 3] =
        [&[RowGroup::Survey], &[RowGroup::Clocks, RowGroup::Instruments], &[RowGroup::Distances]];
    for table in groups.map(of) {
        if table.lines.is_empty() {
            continue;
        }
        _ = write!(text, "{:<24}", "other estimates");
        table.subjects.iter().for_each(|subject| _ = write!(text, "{subject:>22}"));
        text += "            prior\n";
        for line in &table.lines {
            _ = write!(text, "  {:<22}", format!("{} ({})", line.name, line.quantity.told().1));
            for row in &line.cells {
                let cell = row.map_or("–".to_owned(), |row| {
                    deviation(row) + if row.is_significant { " *" } else { "  " }
                });
                _ = write!(text, "{cell:>22}");
            }
            let known = line.cells.iter().flatten().find(|row| row.prior.is_some());
            let known = known.map_or("–".to_owned(), |row| format!("± {}", prior(row)));
            _ = writeln!(text, "{known:>17}");
        }
        text.push('\n');
    }
    if !text.is_empty() {
        let mut notes = Vec::new();
        if rows.iter().any(|row| row.group.is_beside_transforms() && row.is_significant) {
            notes.push(format!("* significant: more than {SUPPORTED_SIGMAS} σ"));
        }
        if rows.iter().any(|row| row.group == RowGroup::Distances) {
            notes.push("distances: difference from the measured distances".to_owned());
        }
        if !notes.is_empty() {
            _ = writeln!(text, "{}\n", notes.join("; "));
        }
    }
    text
}

/// Returns "stations 1–3", or "station 1" if it is the only one.
pub fn all_stations(count: usize) -> String {
    if count > 1 { format!("stations 1–{count}") } else { "station 1".to_owned() }
}

/// Formats σ in thousandths (mm or mrad) with `digits` decimals, one more if those would all be zero.
pub fn sigma_text(sigma: Option<f64>, digits: usize) -> String {
    sigma.map_or("–".to_owned(), |sigma| {
        let thousandths = sigma * 1e3;
        let least = 0.95 * 10_f64.powi(-(digits as i32));
        let digits = if thousandths < least { digits + 1 } else { digits };
        format!("{thousandths:.digits$}")
    })
}

/// Formats the homogeneous matrix from a station's frame to station 1's, in four rows.
pub fn matrix(calibration: &Calibration, station: usize) -> String {
    let matrix = calibration.station1_from_station[station].matrix();
    (0..4)
        .map(|row| {
            let cells: Vec<_> =
                (0..4).map(|column| format!("{:>12.8}", matrix[(row, column)])).collect();
            cells.join(" ") + "\n"
        })
        .collect()
}

/// Formats a spread: "1.31 mm median, 2.54 mm IQR, n 6096".
pub fn spread_text(spread: &Spread) -> String {
    format!("{:.2} mm median, {:.2} mm IQR, n {}", spread.median, spread.iqr, spread.n)
}
