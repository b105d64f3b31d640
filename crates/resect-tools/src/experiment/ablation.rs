//! Effect of each module of the pipeline (Vaidis et al. 2022, section "Sensitivity and ablation tests").

use std::sync::Arc;

use rayon::prelude::*;

use super::StudyError;
use super::reference::{self, Reference};
use super::split::Splits;
use super::study::{Group, Quantiles, Series, Study};
use crate::palette;
use resect_core::analysis::Settings;
use resect_core::deployment::Deployment;
use resect_core::pipeline::{Interpolation, PipelineSettings};
use resect_core::progress::Progress;

/// Combinations of the optional modules, with their names.
const COMBINATIONS: [(&str, bool, bool); 4] = [
    ("no filter", false, false),
    ("filter 1 (outliers)", true, false),
    ("filter 3 (intervals)", false, true),
    ("both filters", true, true),
];

/// Inter-prism errors for every combination of modules 1 and 3 and every interpolation.
pub fn ablate(
    deployments: &[Arc<Deployment>],
    settings: &Settings,
    reference: Reference,
    splits: Option<Splits>,
    progress: &Progress,
) -> Result<Study, StudyError> {
    let steps = deployments.len().min(1) + COMBINATIONS.len() * Interpolation::ALL.len();
    progress.expect(steps as u64);
    let (judges, findings) =
        progress.step(|| reference::judges(deployments, settings, reference, splits))??;
    let variants: Vec<(usize, Interpolation)> = (0..COMBINATIONS.len())
        .flat_map(|combination| {
            Interpolation::ALL.map(|interpolation| (combination, interpolation))
        })
        .collect();
    let results = variants
        .par_iter()
        .map(|(combination, interpolation)| {
            let (_, outlier_filter, interval_filter) = COMBINATIONS[*combination];
            let variant = PipelineSettings {
                outlier_filter,
                interval_filter,
                interpolation: *interpolation,
                ..settings.pipeline
            };
            progress.step(|| reference::pooled(&judges, &variant))
        })
        .collect::<Result<Vec<_>, _>>()?;
    let mut results = results.into_iter();
    let groups = COMBINATIONS
        .iter()
        .map(|(label, ..)| {
            let row: Vec<(Vec<f64>, usize)> =
                results.by_ref().take(Interpolation::ALL.len()).collect();
            Group {
                label: (*label).to_owned(),
                note: row.first().map_or(String::new(), |(_, count)| format!("{count} triplets")),
                boxes: row
                    .into_iter()
                    .map(|(errors, _)| {
                        Quantiles::of(errors).ok_or_else(|| "no triplets".to_owned())
                    })
                    .collect(),
            }
        })
        .collect();
    Ok(Study {
        name: "ablation".to_owned(),
        title: "Effect of the pipeline modules".to_owned(),
        subtitle: reference::in_words(&judges, splits),
        value_label: "inter-prism error (mm)".to_owned(),
        group_label: "active optional modules".to_owned(),
        series: Interpolation::ALL
            .into_iter()
            .map(|interpolation| Series {
                name: interpolation.title().to_owned(),
                rgb: palette::interpolation(interpolation),
            })
            .collect(),
        groups,
        levels: Vec::new(),
        findings,
        settings: *settings,
    })
}
