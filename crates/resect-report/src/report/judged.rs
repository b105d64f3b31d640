//! Trajectories of other systems against the deployment's own.

use maud::{Markup, html};

use super::charts::figure;
use super::findings::findings;
use crate::estimates::{
    Angles, VERDICTS_IN_WORDS, agreed, contradiction, draw, draw_map, rows, verdict_sentence,
    verdicts, why_empty,
};
use resect_core::deployment::Finding;
use resect_tools::estimates::EstimatesJudgement;

const WIDTH: f32 = 800.0;

/// The verdict in one sentence.
pub fn verdict(judgement: &EstimatesJudgement) -> Markup {
    html! {
        @if let Some(sentence) = verdict_sentence(judgement, Angles::DEGREES) {
            p.recommendation { strong { (sentence) } }
        }
    }
}

/// A section of a calibration's page: the verdict, and all numbers; `start_s` is the start of the drive (s).
pub fn markup(judgement: &EstimatesJudgement, start_s: f64) -> Markup {
    html! {
        h3 { "Trajectories of other systems" }
        (verdict(judgement))
        (details(judgement, start_s))
    }
}

/// The ranking, the contradictions, all numbers, and the errors over time; `start_s` is the start of the drive (s).
pub fn details(judgement: &EstimatesJudgement, start_s: f64) -> Markup {
    let judged = &judgement.judged;
    let notes: Vec<Finding> = judged
        .iter()
        .flat_map(|one| one.estimate.findings.iter().chain(&one.fit.findings).cloned())
        .chain(judgement.unjudged.iter().map(|(_, why)| why.finding()))
        .collect();
    let rows = rows(judgement, Angles::DEGREES);
    let names: Vec<&str> = judged.iter().map(|one| &*one.estimate.name).collect();
    html! {
        (verdict_tables(judgement))
        @for both in &judgement.agreements { p { (agreed(judgement, both)) } }
        (findings(&notes))
        @if !judged.is_empty() {
            div.wide { table {
                thead { tr {
                    th { "" }
                    @for one in judged { th.number { (one.estimate.name) } }
                } }
                tbody {
                    @for row in &rows {
                        tr {
                            td { (row.label) }
                            @for cell in &row.cells { td.number { (cell) } }
                        }
                    }
                }
            } }
            @for line in why_empty(&rows, &names) { p { (line) } }
            (figure(
                &draw_map(judgement, WIDTH),
                "estimates over the ground truth",
                &html! { "View from above, coloured by the position error." },
            ))
            (figure(
                &draw(judgement, start_s, WIDTH),
                "position errors over time",
                &html! { "Size of each trajectory's position error; grey: 1.96 σ of the ground truth along an axis." },
            ))
        }
        @for one in judged {
            @for span in &one.odd {
                p {
                    strong { (one.estimate.name) }
                    (format!(
                        ", {:.1} to {:.1} s: {}",
                        span.span_s[0] - start_s,
                        span.span_s[1] - start_s,
                        contradiction(span, Angles::DEGREES)
                    ))
                }
            }
        }
    }
}

/// The verdicts on each pair, with their evidence as titles.
fn verdict_tables(judgement: &EstimatesJudgement) -> Markup {
    let tables = verdicts(judgement, Angles::DEGREES);
    html! {
        @if !tables.is_empty() { p { (VERDICTS_IN_WORDS) } }
        @for table in &tables {
            div.wide { table {
                thead { tr {
                    th { "" }
                    @for name in &table.names { th.number { (name) } }
                    th { "verdict" }
                } }
                tbody {
                    @for row in &table.rows {
                        tr {
                            td { (row.label) }
                            @for cell in &row.cells { td.number { (cell) } }
                            td title=(row.reason) { (row.verdict) }
                        }
                    }
                }
            } }
        }
    }
}
