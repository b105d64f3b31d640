//! The page of a report: a table of all deployments, and a section for each.

use resect_core::deployment::kinds;
use std::sync::Arc;

use jiff::Timestamp;
use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::findings::{badge, findings};
use super::{answer, input, judged};
use crate::estimates::truth_in_words;
use resect_core::analysis::{Analysis, Answer};
use resect_core::calibration::{Calibration, recommend};
use resect_core::deployment::{Deployment, Finding, MessageAngle};
use resect_core::network::USUAL_STATIONS;
use resect_io::file_mark::FileMark;
use resect_tools::estimates::{EstimatesJudgement, GroundTruth};
use resect_tools::palette;

const STYLE: &str = include_str!("style.css");

/// Result for one path.
pub enum Chapter {
    Analysed {
        deployment: Arc<Deployment>,
        analysis: Box<Analysis>,
        /// Files of the deployment; none for a sample.
        files: Vec<FileMark>,
        /// Trajectories of other systems, compared with the deployment's.
        judgement: Option<Arc<EstimatesJudgement>>,
    },
    /// Trajectories, compared with a ground truth that is no calibration.
    Evaluated(Box<EvaluationChapter>),
    /// The path could not be opened; the error is one line.
    Unopened { path: String, error: String },
}

/// Trajectories compared with another trajectory.
pub struct EvaluationChapter {
    /// Name of the ground truth.
    pub name: String,
    /// Quality of the ground truth in one line.
    pub truth: String,
    /// Findings about its file.
    pub findings: Vec<Finding>,
    pub judgement: Arc<EstimatesJudgement>,
    /// Start of the drive (s).
    pub start_s: f64,
    /// Files of the ground truth and of the trajectories.
    pub files: Vec<FileMark>,
}

impl EvaluationChapter {
    /// Returns the evaluation of trajectories against a ground truth, with the files of both.
    pub fn of(
        truth: &GroundTruth<'_>,
        judgement: Arc<EstimatesJudgement>,
        files: Vec<FileMark>,
    ) -> Self {
        let findings = match truth {
            GroundTruth::Trajectory(truth, _) => truth.findings.clone(),
            GroundTruth::Deployment { .. } => Vec::new(),
        };
        Self {
            name: truth.name().to_owned(),
            truth: truth_in_words(truth),
            findings,
            judgement,
            start_s: truth.start_s().unwrap_or_default(),
            files,
        }
    }
}

impl Chapter {
    fn name(&self) -> &str {
        match self {
            Self::Analysed { deployment, .. } => &deployment.name,
            Self::Evaluated(evaluation) => &evaluation.name,
            Self::Unopened { path, .. } => path,
        }
    }

    /// Returns the files that were read.
    pub fn files(&self) -> &[FileMark] {
        match self {
            Self::Analysed { files, .. } => files,
            Self::Evaluated(evaluation) => &evaluation.files,
            Self::Unopened { .. } => &[],
        }
    }

    /// Returns the answer, or the reason for its absence in one line.
    pub fn answer(&self) -> Result<&Answer, String> {
        match self {
            Self::Analysed { analysis, .. } => match &analysis.answer {
                Ok(answer) => Ok(answer),
                Err(error) => Err(error.to_string()),
            },
            Self::Evaluated(_) => Err("an evaluation has no calibration".to_owned()),
            Self::Unopened { error, .. } => Err(error.clone()),
        }
    }
}

/// Returns the page: a section for each chapter, after a table of all if there are several.
pub fn page(chapters: &[Chapter], date: Timestamp) -> String {
    let title = match chapters {
        [Chapter::Evaluated(evaluation)] => {
            format!("{}: evaluation of trajectories", evaluation.name)
        }
        [chapter] => format!("{}: extrinsic calibration", chapter.name()),
        _ => "Extrinsic calibration".to_owned(),
    };
    let (heading, conventions) = match chapters {
        [Chapter::Evaluated(_)] => ("Evaluation of trajectories", "± is one standard deviation"),
        _ => (
            "Extrinsic calibration of robotic total stations",
            "transforms from the frames of the other stations to that of station 1; ± is one standard deviation",
        ),
    };
    // Forbids scripts and requests, whatever the names of deployments and files contain.
    let policy = "default-src 'none'; style-src 'unsafe-inline'";
    let markup = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta http-equiv="Content-Security-Policy" content=(policy);
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                header {
                    h1 { (heading) }
                    p.weak {
                        "by resect " (env!("CARGO_PKG_VERSION")) ", "
                        (date.strftime("%Y-%m-%d %H:%M UTC"))
                        "; " (conventions)
                    }
                }
                @if chapters.len() > 1 { (summary(chapters)) }
                @for (index, chapter) in chapters.iter().enumerate() {
                    section id=(anchor(index)) { (section(chapter)) }
                }
            }
        }
    };
    // HTML allows only white space among control characters.
    let is_control = |c: char| c.is_control() && c != '\n' && c != '\t';
    markup.into_string().replace(is_control, "\u{fffd}")
}

fn anchor(index: usize) -> String {
    format!("deployment-{}", index + 1)
}

/// One row for each chapter.
fn summary(chapters: &[Chapter]) -> Markup {
    let answers = chapters.iter().filter_map(|chapter| chapter.answer().ok());
    let stations = answers.map(|answer| answer.calibration.station1_from_station.len()).max();
    let stations = stations.unwrap_or(USUAL_STATIONS);
    html! {
        h2 { "Summary" }
        div.wide { table.summary {
            thead {
                tr {
                    th rowspan="2" { "deployment" }
                    th rowspan="2" { "verdict" }
                    @for station in 2..=stations { th.group colspan="4" { "T1" (station) } }
                    th.group colspan="2" { "medians (mm)" }
                }
                tr {
                    @for _ in 2..=stations {
                        @for heading in ["x (m)", "y (m)", "z (m)", "yaw (deg)"] {
                            th.number { (heading) }
                        }
                    }
                    th.number { "distances" }
                    th.number.points { "control points" }
                }
            }
            tbody {
                @for (index, chapter) in chapters.iter().enumerate() {
                    tr {
                        td { a href={ "#" (anchor(index)) } { (chapter.name()) } }
                        @match chapter.answer() {
                            Ok(answer) => (summary_cells(answer, stations)),
                            Err(error) => {
                                td { (no_answer()) }
                                td.prose colspan=(4 * (stations - 1) + 2) { (error) }
                            }
                        }
                    }
                }
            }
        } }
    }
}

/// Cells of an answer, with empty ones for stations that only other answers have.
fn summary_cells(Answer { calibration, evaluation, .. }: &Answer, stations: usize) -> Markup {
    html! {
        td { (verdict(calibration)) }
        @for transform in calibration.station1_from_station.iter().skip(1) {
            @for metres in &transform.translation_m { td.number { (format!("{metres:.3}")) } }
            td.number { (format!("{:.4}", transform.yaw_rad().to_degrees())) }
        }
        @for _ in calibration.station1_from_station.len()..stations { td colspan="4" {} }
        td.number {
            @if let Some(spread) = &evaluation.inter_prism_mm { (format!("{:.2}", spread.median)) }
            @else { "–" }
        }
        td.number {
            @for (index, metric) in evaluation.control_points_mm.iter().enumerate() {
                @if index > 0 { ", " }
                (format!("{:.2}", metric.spread.median))
            }
            @if evaluation.control_points_mm.is_empty() { "–" }
        }
    }
}

/// Returns a section: the recommendation, the verdict, the results, then the input.
fn section(chapter: &Chapter) -> Markup {
    if let Chapter::Evaluated(evaluation) = chapter {
        return html! {
            (judged::verdict(&evaluation.judgement))
            p { "Ground truth: " (evaluation.truth) }
            (findings(&evaluation.findings))
            (judged::details(&evaluation.judgement, evaluation.start_s))
            (input::hashes(&evaluation.files))
        };
    }
    html! {
        h2 { (chapter.name()) }
        @match chapter.answer() {
            Ok(answer) => {
                @if let Chapter::Analysed { deployment, .. } = chapter {
                    (recommendation(&answer.calibration, deployment))
                }
                p.verdict {
                    (verdict(&answer.calibration))
                    " · " (answer.calibration.method_in_words())
                }
                (findings(&answer.calibration.findings))
            }
            Err(error) => {
                p.verdict { (no_answer()) }
                (findings(&[Finding::new(kinds::NO_ANSWER, error.as_str())]))
            }
        }
        @if let Chapter::Analysed { deployment, analysis, files, judgement } = chapter {
            @if let Ok(answer) = &analysis.answer {
                (answer::markup(deployment, analysis, answer))
            }
            @if let Some(judgement) = judgement {
                (judged::markup(judgement, deployment.start_s().unwrap_or(0.0)))
            }
            (input::markup(deployment, analysis, files))
        }
    }
}

fn recommendation(calibration: &Calibration, deployment: &Deployment) -> Markup {
    let recommendation = recommend(calibration, deployment);
    let [conclusion, reason, next_step] = recommendation.sentences(MessageAngle::to_string);
    html! {
        p.recommendation { strong { (conclusion) } " " (reason) " " (next_step) }
    }
}

fn verdict(calibration: &Calibration) -> Markup {
    let [ground, ink] = palette::verdict(calibration.verdict);
    html! {
        (badge(&calibration.verdict.name().to_uppercase(), ground, ink))
        (calibration.verdict.caveat(calibration.is_independently_checked()))
    }
}

fn no_answer() -> Markup {
    badge("NO ANSWER", [90, 94, 100], [255; 3])
}
