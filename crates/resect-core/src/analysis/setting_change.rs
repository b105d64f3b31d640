//! Differences of two sets of settings, in words: for undo, for pinned results and for the history of runs.

use std::fmt;

use super::settings::Settings;
use crate::calibration::{Alignment, CALIBRATION_NUMBERS, PriorMethod};
use crate::number_setting::NumberSetting;
use crate::pipeline::PIPELINE_NUMBERS;

/// One setting that differs. Displays as "τ_r 2 → 1.5 m/s".
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SettingChange {
    /// Name of the setting in the window; no two settings share one.
    pub name: &'static str,
    pub before: String,
    pub after: String,
    /// The unit of both values; empty for words.
    pub unit: &'static str,
}

impl fmt::Display for SettingChange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, before, after, unit } = self;
        write!(f, "{name} {before} → {after}")?;
        if unit.is_empty() { Ok(()) } else { write!(f, " {unit}") }
    }
}

/// All settings that differ, in the order of the pipeline.
pub fn setting_changes(before: &Settings, after: &Settings) -> Vec<SettingChange> {
    named_values(before)
        .into_iter()
        .zip(named_values(after))
        .filter(|(before, after)| before.value != after.value)
        .map(|(before, after)| SettingChange {
            name: after.name,
            before: before.value,
            after: after.value,
            unit: after.unit,
        })
        .collect()
}

/// The changes as one line: "τ_r 2 → 1.5 m/s, prior closed form → search"; empty where nothing differs.
pub fn changes_in_words(changes: &[SettingChange]) -> String {
    changes.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}

struct NamedValue {
    name: &'static str,
    value: String,
    unit: &'static str,
}

/// Returns every setting, in the order of the pipeline. A test detects missing ones.
fn named_values(settings: &Settings) -> Vec<NamedValue> {
    let Settings { pipeline, calibration } = settings;
    let method = calibration.method.unwrap_or_default();
    let method = method
        .letter()
        .map_or(method.title().to_owned(), |letter| format!("{letter} ({})", method.title()));
    let mut values = vec![
        switch("outlier filter", pipeline.outlier_filter),
        switch("interval filter", pipeline.interval_filter),
    ];
    values.extend(PIPELINE_NUMBERS.map(|setting| number(setting, pipeline)));
    values.push(switch("all readings", pipeline.all_readings));
    values.extend([
        word("interpolation", pipeline.interpolation.title()),
        NamedValue { name: "method", value: method, unit: "" },
        word("alignment", alignment_name(calibration.alignment)),
        word("prior", prior_name(calibration.prior)),
        word("evidence", &calibration.evidence.to_string()),
    ]);
    values.extend(CALIBRATION_NUMBERS.map(|setting| number(setting, calibration)));
    values.push(switch("slow errors", calibration.errors.ranges_wander));
    values
}

fn word(name: &'static str, value: &str) -> NamedValue {
    NamedValue { name, value: value.to_owned(), unit: "" }
}

fn switch(name: &'static str, on: bool) -> NamedValue {
    word(name, if on { "on" } else { "off" })
}

fn number<S: Copy + Default>(setting: &NumberSetting<S>, settings: &S) -> NamedValue {
    let value = setting.shown(settings).to_string();
    NamedValue { name: setting.name, value, unit: setting.unit }
}

fn alignment_name(alignment: Alignment) -> &'static str {
    match alignment {
        Alignment::Level => "level",
        Alignment::Rigid => "rigid",
    }
}

fn prior_name(prior: PriorMethod) -> &'static str {
    match prior {
        PriorMethod::ClosedForm => "closed form",
        PriorMethod::Search => "search",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibration::Method;

    fn words(change: impl FnOnce(&mut Settings)) -> String {
        let before = Settings::default();
        let mut after = before;
        change(&mut after);
        changes_in_words(&setting_changes(&before, &after))
    }

    #[test]
    fn a_change_is_named_with_its_values_and_unit() {
        assert_eq!(words(|s| s.pipeline.thresholds.tau_r_m_per_s = 1.5), "τ_r 2 → 1.5 m/s");
        assert_eq!(words(|s| s.pipeline.outlier_filter = false), "outlier filter on → off");
        let search = words(|s| s.calibration.prior = PriorMethod::Search);
        assert_eq!(search, "prior closed form → search");
        let evidence = words(|s| s.calibration.evidence.control_points = false);
        assert_eq!(evidence, "evidence drive,control-points,rig → drive,rig");
        // 0.0041 m in mm is 4.1000000000000005 in floating point.
        assert_eq!(words(|s| s.calibration.inter_prism_sigma_m = 0.0041), "σ distances 3 → 4.1 mm");
        assert_eq!(
            words(|s| s.calibration.method = Some(Method::StaticGcp)),
            "method joint estimate → B (static control points)"
        );
        assert_eq!(words(|_| ()), "");
    }

    #[test]
    fn several_changes_come_in_the_order_of_the_pipeline() {
        let text = words(|s| {
            s.calibration.prior = PriorMethod::Search;
            s.pipeline.rate_hz = 5.0;
        });
        assert_eq!(text, "rate 10 → 5 Hz, prior closed form → search");
    }

    /// Changes every leaf of the serialised settings, one by one: each change must be reported, and no other. The groups of
    /// evidence share one name.
    #[test]
    fn every_setting_is_seen_and_under_its_own_name() {
        let default = serde_json::to_value(Settings::default()).expect("plain data");
        let mut names = std::collections::BTreeSet::new();
        let mut leaves = Vec::new();
        find_leaves(&default, &mut Vec::new(), &mut leaves);
        for leaf in &leaves {
            let pointer = format!("/{}", leaf.join("/"));
            let key = leaf.last().expect("a leaf has a name").as_str();
            let mut changed = default.clone();
            let value = changed.pointer_mut(&pointer).expect("a leaf");
            *value = another(key, value);
            let changed: Settings = serde_json::from_value(changed).expect("valid settings");
            let changes = setting_changes(&Settings::default(), &changed);
            assert_eq!(changes.len(), 1, "{pointer}: {changes:?}");
            let name = changes[0].name;
            let is_evidence = pointer.starts_with("/calibration/evidence/");
            assert_eq!(name == "evidence", is_evidence, "{pointer}: {name}");
            assert!(names.insert(name) || is_evidence, "{pointer}: {name} twice");
        }
        assert_eq!(names.len(), named_values(&Settings::default()).len());
    }

    fn find_leaves(value: &serde_json::Value, at: &mut Vec<String>, leaves: &mut Vec<Vec<String>>) {
        let Some(object) = value.as_object() else { return leaves.push(at.clone()) };
        for (key, value) in object {
            at.push(key.clone());
            find_leaves(value, at, leaves);
            at.pop();
        }
    }

    fn another(key: &str, value: &serde_json::Value) -> serde_json::Value {
        use serde_json::{Value, json};
        match value {
            Value::Bool(on) => json!(!on),
            Value::Number(number) => json!(number.as_f64().expect("a number") + 0.25),
            _ => json!(match key {
                "interpolation" => "gp",
                "method" => "static-gcp",
                "alignment" => "rigid",
                "prior" => "search",
                _ => panic!("what else can {key} be?"),
            }),
        }
    }
}
