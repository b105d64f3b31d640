//! Input of an answer: counts of the pipeline, data, settings.

use maud::{Markup, html};
use resect_core::network::{Number, Pair};
use serde_json::Value;

use super::findings::findings;
use resect_core::analysis::{Analysis, Settings};
use resect_core::deployment::Deployment;
use resect_core::network::PerStation;
use resect_core::pipeline::SampleFate;
use resect_io::file_mark::FileMark;

pub fn markup(deployment: &Deployment, analysis: &Analysis, files: &[FileMark]) -> Markup {
    html! {
        (pipeline(deployment, analysis))
        (data(deployment))
        (hashes(files))
        (settings(&analysis.settings))
    }
}

/// Counts from raw readings to triplets, one column a station.
fn pipeline(deployment: &Deployment, analysis: &Analysis) -> Markup {
    let out = &analysis.pipeline;
    let row = |name: &str, counts: PerStation<usize>| {
        html! { tr {
            th { (name) }
            @for count in &counts { td.number { (count) } }
            td.number { (counts.iter().sum::<usize>()) }
        } }
    };
    let dropped = SampleFate::ALL.into_iter().filter(|fate| *fate != SampleFate::Kept);
    html! {
        h3 { "Pipeline" }
        table {
            thead { tr {
                th { "readings" }
                @for station in deployment.tracks.numbers() { th.number { "station " (station) } }
                th.number { "all" }
            } }
            tbody {
                (row("raw", deployment.tracks.map(|track| track.measurements.len())))
                @for fate in dropped {
                    (row(fate.label(), out.counts(fate)))
                }
                (row(SampleFate::Kept.label(), out.counts(SampleFate::Kept)))
            }
        }
        p {
            (out.intervals.len()) " intervals, " (out.kept_intervals.len()) " of them kept; "
            (out.triplets.len()) " triplets."
        }
    }
}

fn data(deployment: &Deployment) -> Markup {
    html! {
        h3 { "Data" }
        table {
            thead { tr { th { "file" } th { "content" } th { "" } } }
            tbody {
                @for ingredient in &deployment.ingredients { tr {
                    td { code { (ingredient.file) } }
                    td { (ingredient.what) }
                    td.weak[!ingredient.used] { @if ingredient.used { "used" } @else { "ignored" } }
                } }
            }
        }
        p {
            @if deployment.tracks.len() == 1 { "Prism constant of station " } @else { "Prism constants of stations " }
            (deployment.tracks.map_each(|station, _| station.to_string()).as_slice().join(", ")) ": "
            (deployment.tracks.map(|track| format!("{:+.1}", track.prism_constant_m * 1e3)).as_slice().join(", "))
            " mm. "
            @match &deployment.rig {
                Some(rig) => {
                    "Inter-prism distances: "
                    @for (pair, metres) in rig.inter_prism_m.iter().enumerate() {
                        @if pair > 0 { ", " }
                        (Pair::at(pair)) " " (format!("{metres:.4}")) " m"
                    }
                    "."
                }
                None => "The inter-prism distances are unknown.",
            }
        }
        (findings(&deployment.findings))
    }
}

/// Hashes of the files, by which anyone can verify the data.
pub fn hashes(files: &[FileMark]) -> Markup {
    html! {
        @if !files.is_empty() {
            table.hashes {
                thead { tr { th { "file" } th.number { "bytes" } th { "SHA-256" } } }
                tbody {
                    @for file in files { tr {
                        td { code { (file.path.display()) } }
                        td.number { (file.bytes) }
                        td { code { (file.sha256) } }
                    } }
                }
            }
        }
    }
}

/// All settings by the names of a `--config` file; those that differ from the defaults are highlighted.
fn settings(settings: &Settings) -> Markup {
    let rows = listed(settings).into_iter().zip(listed(&Settings::default()));
    html! {
        h3 { "Settings" }
        table.settings {
            thead { tr { th { "setting" } th.number { "value" } th.number { "default" } } }
            tbody {
                @for ((name, value), (_, default)) in rows {
                    tr.chosen[value != default] {
                        td { code { (name) } }
                        td.number { (value) }
                        td.number.weak { (default) }
                    }
                }
            }
        }
        p.weak { "Marked: settings that differ from the default." }
    }
}

/// Returns names, preceded by those of their tables, and readable values.
fn listed(settings: &Settings) -> Vec<(String, String)> {
    let mut list = Vec::new();
    let mut settings = *settings;
    settings.calibration.method.get_or_insert_default();
    // JSON can represent settings, which are plain numbers, words and booleans.
    let value = serde_json::to_value(settings).unwrap_or_default();
    list_into(&mut list, "", &value);
    list
}

fn list_into(list: &mut Vec<(String, String)>, name: &str, value: &Value) {
    match value {
        Value::Object(object) => {
            for (key, value) in object {
                let name = if name.is_empty() { key.clone() } else { format!("{name}.{key}") };
                list_into(list, &name, value);
            }
        }
        Value::Bool(on) => list.push((name.to_owned(), if *on { "yes" } else { "no" }.to_owned())),
        Value::String(word) => list.push((name.to_owned(), word.clone())),
        other => list.push((name.to_owned(), other.to_string())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_setting_is_listed_and_a_changed_one_stands_out() {
        let mut changed = Settings::default();
        changed.pipeline.thresholds.tau_s_seconds = 1.5;
        changed.calibration.inter_prism_sigma_m = 0.002;
        changed.calibration.evidence.rig = false;
        let list = listed(&changed);
        assert!(list.contains(&("calibration.method".to_owned(), "joint".to_owned())));
        assert!(list.contains(&("pipeline.thresholds.tau_s_seconds".to_owned(), "1.5".to_owned())));
        assert!(list.contains(&("calibration.evidence.rig".to_owned(), "no".to_owned())));
        let html = settings(&changed).into_string();
        assert_eq!(html.matches("class=\"chosen\"").count(), 3, "{html}");
        assert_eq!(html.matches("<code>").count(), list.len());
    }
}
