//! Keyword arguments as settings, overrides and choices; remedies as keyword arguments.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use pythonize::depythonize;
use resect_core::analysis::Settings;
use resect_core::calibration::{Evidence, Method};
use resect_core::deployment::{Finding, Overrides, Remedy};
use resect_core::evaluation::no_trajectory::NoTrajectory;
use resect_core::evaluation::requested_trajectory::RequestError;
use resect_io::source::Extras;
use resect_tools::estimates::Unjudged;
use resect_tools::estimates::conventions::Convention;
use resect_tools::estimates::unfit::Unfit;
use serde::Deserialize;
use serde::de::value::{Error, StrDeserializer};
use toml::{Table, Value};

use crate::failure::Failure;

/// Tables of a settings file whose keys are keyword arguments.
const SETTINGS_TABLES: [&[&str]; 4] =
    [&["pipeline"], &["pipeline", "thresholds"], &["calibration"], &["calibration", "errors"]];

/// Returns the settings with the given ones replaced. Their names are those of a settings file, without its tables.
pub fn settings(given: &Bound<'_, PyDict>) -> Result<Settings, Failure> {
    let mut all = Table::try_from(Settings::default())?;
    for (name, value) in &plain(given)? {
        let of_name = |path: &&&[&str]| {
            // The method is absent by default.
            (name == "method" && **path == ["calibration"])
                || table(&mut all, path).get(name).is_some_and(is_number_or_word)
        };
        let Some(path) = SETTINGS_TABLES.iter().find(of_name) else {
            return Err(Failure(format!(
                "unknown setting `{name}`; settings are {}",
                names(&mut all)
            )));
        };
        let value = match (name.as_str(), value) {
            ("evidence", Value::String(words)) => {
                Value::try_from(words.parse::<Evidence>().map_err(Failure)?)?
            }
            ("method", Value::String(name)) => Value::try_from(method(name)?)?,
            _ => value.clone(),
        };
        table(&mut all, path).insert(name.clone(), value);
        // One at a time, so that an error names the setting.
        Settings::deserialize(all.clone()).map_err(|error| refused(name, &error))?;
    }
    let settings = Settings::deserialize(all)?;
    settings.check().map_err(Failure)?;
    Ok(settings)
}

/// Returns the method with a name, or with a letter of the paper in either case.
fn method(name: &str) -> Result<Method, Failure> {
    let has_letter = |method: &Method| {
        method
            .letter()
            .is_some_and(|letter| name.eq_ignore_ascii_case(letter.encode_utf8(&mut [0; 4])))
    };
    let is_named = |method: &Method| method.name() == name || has_letter(method);
    Method::ALL.into_iter().find(is_named).ok_or_else(|| {
        let names = Method::ALL.map(|method| match method.letter() {
            Some(letter) => format!("{} ({letter})", method.name()),
            None => method.name().to_owned(),
        });
        Failure(format!("unknown method `{name}`; methods are {}", names.join(", ")))
    })
}

/// Returns the names of all settings in words.
fn names(all: &mut Table) -> String {
    let mut names = Vec::new();
    for path in SETTINGS_TABLES {
        let own = table(all, path);
        names.extend(
            own.iter().filter(|(_, value)| is_number_or_word(value)).map(|(name, _)| name.clone()),
        );
    }
    names.join(", ")
}

/// Returns true for a setting, and false for a table of settings; the evidence is a table with a short form.
fn is_number_or_word(value: &Value) -> bool {
    value.as_table().is_none_or(|table| table.contains_key("control_points"))
}

/// Returns the table at a path; an empty one if it is missing.
fn table<'a>(all: &'a mut Table, path: &[&str]) -> &'a mut Table {
    let mut own = all;
    for name in path {
        let entry = own.entry(*name).or_insert_with(|| Value::Table(Table::new()));
        if !entry.is_table() {
            *entry = Value::Table(Table::new());
        }
        let Value::Table(inner) = entry else { unreachable!("it was made a table") };
        own = inner;
    }
    own
}

/// Returns the further files and overrides of a deployment.
pub fn extras(given: &Bound<'_, PyDict>) -> Result<Extras, Failure> {
    let given = plain(given)?;
    for (name, value) in given.get("corrections").and_then(Value::as_table).into_iter().flatten() {
        // One at a time, so that an error names the override.
        let single = Table::from_iter([(name.clone(), value.clone())]);
        Overrides::deserialize(single).map_err(|error| refused(name, &error))?;
    }
    Extras::deserialize(given).map_err(|error| refused("overrides", &error))
}

/// Returns the choice with a name, of those that a settings file can name.
pub fn choice<'a, T: Deserialize<'a>>(keyword: &str, name: &'a str) -> Result<T, Failure> {
    T::deserialize(StrDeserializer::<Error>::new(name))
        .map_err(|error| Failure(format!("{keyword}: {error}")))
}

/// Returns the convention of a trajectory's file in the words of the command line.
pub fn convention(keyword: &str, words: &str) -> Result<Convention, Failure> {
    words.parse().map_err(|why: String| Failure(format!("{keyword}: {why}")))
}

/// Returns keyword arguments as plain data; those that TOML cannot express are errors.
fn plain(given: &Bound<'_, PyDict>) -> Result<Table, Failure> {
    let mut table = Table::new();
    for (name, value) in given {
        let name = name.to_string();
        let value = depythonize(&value).map_err(|error| {
            let line = error.to_string();
            Failure(format!("{name}: {}", line.lines().next().unwrap_or_default()))
        })?;
        table.insert(name, value);
    }
    Ok(table)
}

fn refused(name: &str, error: &toml::de::Error) -> Failure {
    let what = error.message().lines().next().unwrap_or("not valid");
    Failure(format!("{name}: {what}; correct the argument"))
}

/// Returns the keyword argument that applies a remedy; `None` without one.
fn keyword(remedy: &Remedy) -> Option<&'static str> {
    match remedy {
        Remedy::JointEstimate => Some("method=\"joint\""),
        Remedy::ClosedFormPrior => Some("prior=\"closed-form\""),
        Remedy::LevelAlignment => Some("alignment=\"level\""),
        Remedy::GiveRig => Some("rig"),
        Remedy::GiveControlPoints => Some("gcp"),
        Remedy::PublishedMethod
        | Remedy::RelaxFilters
        | Remedy::Corrections
        | Remedy::ReadWith(_)
        | Remedy::ShowTimes(_)
        | Remedy::ShowPoint { .. } => None,
    }
}

/// Returns the message of a finding with its remedies: "…; use gcp or rig".
pub fn with_keywords(finding: &Finding) -> String {
    let keywords: Vec<&str> = finding.remedies.iter().filter_map(keyword).collect();
    match &keywords[..] {
        [] => finding.to_string(),
        _ => format!("{finding}; use {}", keywords.join(" or ")),
    }
}

/// Returns an error of a trajectory with the keyword argument that follows its advice.
pub fn of_trajectory(why: &NoTrajectory) -> Failure {
    advised(why, trajectory_keyword(why))
}

/// Returns an error of a requested trajectory with the keyword argument that follows its advice.
pub fn of_request(why: &RequestError) -> Failure {
    let keyword = match why {
        RequestError::NoTrajectory(why) => trajectory_keyword(why),
        RequestError::NoOrientation(_) => Some("lever_arm_m"),
        RequestError::NoPose { .. } => Some("max_error_m"),
        RequestError::NoSite(_) | RequestError::NoPosition(_) => None,
    };
    advised(why, keyword)
}

/// Returns the reason why an estimate is not judged, with the keyword argument that follows its advice.
pub fn of_estimate(why: &Unjudged) -> Failure {
    let keyword = match why {
        Unjudged::NoReference(why) => return of_trajectory(why),
        Unjudged::OtherConvention(_) => None,
        Unjudged::Unfit { why, .. } => match why {
            Unfit::NoOverlap | Unfit::OtherDrive(_) | Unfit::AmbiguousOffset { .. } => {
                Some("time_offset_s")
            }
            Unfit::OnALine => Some("align=\"none\""),
            Unfit::Undetermined => Some("body=\"same\""),
            Unfit::OtherScale(_) => Some("align=\"similarity\""),
            Unfit::NoOrientation => Some("body=\"found\""),
            Unfit::FewEpochs
            | Unfit::FewPoses(_)
            | Unfit::FirstOnALine(_)
            | Unfit::EmptySpan(_)
            | Unfit::Inverse { .. }
            | Unfit::TruthInverse { .. }
            | Unfit::OtherShape(_) => None,
        },
    };
    advised(why, keyword)
}

fn trajectory_keyword(why: &NoTrajectory) -> Option<&'static str> {
    match why {
        NoTrajectory::OnePrism(_) | NoTrajectory::NoMotion(_) => Some("method=\"joint\""),
        NoTrajectory::NoRig(_) => Some("rig"),
        NoTrajectory::NoMotionFits(_)
        | NoTrajectory::PrismsOnALine(_)
        | NoTrajectory::UnknownLayout(_)
        | NoTrajectory::OtherFrame(_)
        | NoTrajectory::NoAnswer { .. } => None,
    }
}

fn advised(why: &dyn std::error::Error, keyword: Option<&str>) -> Failure {
    Failure(match keyword {
        Some(keyword) => format!("{why} ({keyword})"),
        None => why.to_string(),
    })
}
