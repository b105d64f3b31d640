//! A study as a table, CSV, JSON, and pictures.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::box_chart;
use super::json::{SCHEMA, findings, recommendation};
use super::svg::{Colours, PictureError, to_png, to_svg};
use super::text::{FindingLine, sigma_text};
use resect_core::deployment::Severity;
use resect_io::atomic;
use resect_io::atomic::WriteError;
use resect_tools::experiment::{Comparison, Quantiles, Study};

/// Size of the pictures in units of SVG; the PNG has twice as many pixels along each side.
const PICTURE_SIZE: [f32; 2] = [1000.0, 600.0];
const PIXELS_PER_UNIT: f32 = 2.0;

#[derive(Debug, thiserror::Error)]
pub enum StudyFileError {
    #[error(transparent)]
    Write(#[from] WriteError),
    #[error(transparent)]
    Picture(#[from] PictureError),
}

/// Formats groups as rows and series as columns: median and interquartile range in mm.
pub fn table(study: &Study) -> String {
    let mut text = format!("{}\n{}\n\n", study.title, study.subtitle);
    let label_width = study.groups.iter().map(|g| g.label.chars().count()).max().unwrap_or(0);
    let note_width = study.groups.iter().map(|g| g.note.chars().count()).max().unwrap_or(0);
    let column = study.series.iter().map(|s| s.name.chars().count() + 3).max().unwrap_or(0).max(22);
    _ = write!(text, "{:<label_width$}  {:<note_width$}", "", "");
    for series in &study.series {
        _ = write!(text, "  {:>column$}", series.name);
    }
    text.push('\n');
    _ = write!(text, "{:<label_width$}  {:<note_width$}", group_label_or_empty(study), "");
    for _ in &study.series {
        _ = write!(text, "  {:>column$}", "median  ( IQR )  mm");
    }
    text.push('\n');
    for group in &study.groups {
        _ = write!(text, "{:<label_width$}  {:<note_width$}", group.label, group.note);
        for cell in &group.boxes {
            let cell = match cell {
                Ok(q) => format!("{:.2}  ({:>5.2})   ", q.median, q.iqr()),
                Err(why) => format!("– {why}"),
            };
            _ = write!(text, "  {cell:>column$}");
        }
        text.push('\n');
    }
    if !study.levels.is_empty() {
        text.push('\n');
    }
    for level in &study.levels {
        _ = writeln!(text, "{}", level.label);
    }
    if !study.findings.is_empty() {
        text.push('\n');
    }
    for finding in &study.findings {
        _ = writeln!(text, "  {} {finding}", finding.severity.mark());
    }
    text
}

/// The axis title fits into a table's corner only if it is short.
fn group_label_or_empty(study: &Study) -> &str {
    let widest = study.groups.iter().map(|g| g.label.chars().count()).max().unwrap_or(0);
    if study.group_label.chars().count() <= widest { &study.group_label } else { "" }
}

/// Formats the transforms of every method and deployment, with the disagreements between methods.
pub fn transforms_table(comparison: &Comparison, finding_line: FindingLine) -> String {
    let mut text = String::new();
    for compared in &comparison.deployments {
        _ = writeln!(text, "\n{}", compared.deployment);
        if let Some(recommendation) = &compared.recommendation {
            _ = writeln!(text, "{recommendation}");
        }
        _ = writeln!(
            text,
            "       station      x (m) ± mm         y (m) ± mm         z (m) ± mm         yaw (rad) ± mrad    verdict"
        );
        for (method, answer) in resect_core::calibration::Method::ALL.iter().zip(&compared.answers)
        {
            let answer = match answer {
                Ok(answer) => answer,
                Err(why) => {
                    _ = writeln!(text, "{}: {why}", method.label());
                    continue;
                }
            };
            let calibration = &answer.calibration;
            for (station, transform) in calibration.station1_from_station.each().skip(1) {
                let sigma = calibration.sigma.as_ref().map(|sigma| sigma[station]);
                _ = write!(text, "{:<5}  T1{}    ", method.short_name(), station);
                for axis in 0..3 {
                    let sigma = sigma_text(sigma.map(|s| s.translation_m[axis]), 1);
                    _ = write!(text, "{:>10.4} ± {sigma:<6}", transform.translation_m[axis]);
                }
                let sigma = sigma_text(sigma.map(|s| s.yaw_rad), 3);
                let verdict = if station.slot() == Some(0) {
                    calibration.verdict_in_words()
                } else {
                    String::new()
                };
                _ = writeln!(text, "{:>11.5} ± {sigma:<8} {verdict}", transform.yaw_rad());
            }
            let doubts = calibration.findings.iter().filter(|f| f.severity > Severity::Note);
            for finding in doubts {
                _ = writeln!(text, "   {} {}", finding.severity.mark(), finding_line(finding));
            }
        }
    }
    text
}

pub fn json(study: &Study) -> Value {
    let quantiles = |q: &Quantiles| {
        json!({ "median_mm": q.median, "q25_mm": q.q25, "q75_mm": q.q75, "iqr_mm": q.iqr(),
                "q05_mm": q.q05, "q95_mm": q.q95, "n": q.n })
    };
    let groups: Vec<Value> = study
        .groups
        .iter()
        .map(|group| {
            let boxes: Vec<Value> = group
                .boxes
                .iter()
                .zip(&study.series)
                .map(|(cell, series)| match cell {
                    Ok(q) => {
                        json!({ "series": series.name, "errors": quantiles(q), "why_none": null })
                    }
                    Err(why) => json!({ "series": series.name, "errors": null, "why_none": why }),
                })
                .collect();
            json!({ "label": group.label, "note": group.note, "boxes": boxes })
        })
        .collect();
    json!({
        "schema": SCHEMA,
        "study": study.name,
        "title": study.title,
        "subtitle": study.subtitle,
        "group_label": study.group_label,
        "settings": study.settings,
        "groups": groups,
        "levels": study.levels.iter().map(|l| json!({ "label": l.label, "mm": l.value })).collect::<Vec<_>>(),
        "findings": findings(&study.findings),
    })
}

/// Returns the study's JSON with every deployment's answers.
pub fn comparison_json(comparison: &Comparison) -> Value {
    let deployments: Vec<Value> = comparison
        .deployments
        .iter()
        .map(|compared| {
            let methods: Vec<Value> = resect_core::calibration::Method::ALL
                .iter()
                .zip(&compared.answers)
                .map(|(method, answer)| match answer {
                    Ok(answer) => json!({
                        "method": method.name(),
                        "answered_by": answer.calibration.answered_by().name(),
                        "verdict": answer.calibration.verdict,
                        "independently_checked": answer.calibration.is_independently_checked(),
                        "transforms": super::json::transforms(&answer.calibration),
                        "inter_prism_mm": answer.evaluation.inter_prism_mm,
                        "gcp_mm": answer.evaluation.control_points_mm,
                        "why_none": null,
                    }),
                    Err(why) => json!({ "method": method.name(), "why_none": why }),
                })
                .collect();
            let disagreements: Vec<Value> = compared
                .disagreements
                .iter()
                .map(|d| {
                    json!({
                        "methods": d.methods.map(resect_core::calibration::Method::name),
                        "station": d.station,
                        "translation_m": d.translation_m,
                        "yaw_rad": d.yaw_rad,
                        "yaw_sigmas": d.yaw_sigmas,
                        "largest_sigmas": d.largest_sigmas,
                        "moved_m": d.moved_m,
                        "range_m": d.range_m,
                        "in_words": d.finding().to_string(),
                    })
                })
                .collect();
            json!({
                "deployment": compared.deployment,
                "recommendation": compared.recommendation.as_ref().map(recommendation),
                "methods": methods,
                "disagreements": disagreements,
            })
        })
        .collect();
    let mut object = json(&comparison.study);
    object["deployments"] = Value::Array(deployments);
    object
}

/// Writes NAME.csv, NAME.svg and NAME.png into a folder, which is created if missing, and returns their paths.
pub fn write(study: &Study, folder: &Path) -> Result<Vec<PathBuf>, StudyFileError> {
    atomic::make_folder(folder)?;
    let svg = to_svg(&box_chart::draw(study, PICTURE_SIZE), Colours::Light);
    let png = to_png(&svg, PIXELS_PER_UNIT)?;
    let files = [("csv", csv(study).into_bytes()), ("svg", svg.into_bytes()), ("png", png)];
    let ready = files.into_iter().map(|(extension, bytes)| {
        atomic::ready(&folder.join(format!("{}.{extension}", study.name)), bytes)
    });
    Ok(atomic::place_all(ready.collect::<Result<_, _>>()?)?)
}

/// Formats one line a box; a missing box has empty numbers and a reason.
pub fn csv(study: &Study) -> String {
    let mut text =
        String::from("group,note,series,median_mm,q25_mm,q75_mm,iqr_mm,q05_mm,q95_mm,n,why_none\n");
    let quoted = |field: &str| format!("\"{}\"", field.replace('"', "\"\""));
    for group in &study.groups {
        for (cell, series) in group.boxes.iter().zip(&study.series) {
            let names =
                [&group.label, &group.note, &series.name].map(|field| quoted(field)).join(",");
            _ = match cell {
                Ok(q) => writeln!(
                    text,
                    "{names},{:.4},{:.4},{:.4},{:.4},{:.4},{:.4},{},",
                    q.median,
                    q.q25,
                    q.q75,
                    q.iqr(),
                    q.q05,
                    q.q95,
                    q.n
                ),
                Err(why) => writeln!(text, "{names},,,,,,,0,{}", quoted(why)),
            };
        }
    }
    text
}
