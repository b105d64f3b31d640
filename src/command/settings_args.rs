//! Flags that change settings, shared by every command that runs the pipeline.

use std::path::PathBuf;

use clap::Args;
use nalgebra::Vector3;

use super::Failure;
use super::choice::{ALIGNMENTS, INTERPOLATIONS, METHODS, PRIORS, choice};
use super::number_flags::NumberFlags;
use resect_core::analysis::Settings;
use resect_core::calibration::{Alignment, Evidence, Method, PriorMethod};
use resect_core::pipeline::Interpolation;
use resect_io::error::OpenError;
use resect_io::source::Extras;

/// Method and settings of a command that calibrates.
#[derive(Args)]
pub struct AnswerArguments {
    /// Calibration method [default: joint]; `calibrate` accepts several
    #[arg(long, value_parser = choice(METHODS))]
    method: Vec<Method>,
    /// The same as --method joint
    #[arg(long)]
    robust: bool,
    #[command(flatten)]
    settings: SettingsArguments,
}

impl AnswerArguments {
    /// Returns the settings; an error if there are several methods.
    pub fn settings(&self) -> Result<Settings, Failure> {
        match &self.settings_of_each()?[..] {
            [settings] => Ok(*settings),
            several => Err(Failure::Usage(format!(
                "{} methods are given, but one is allowed; calibrate accepts several",
                several.len()
            ))),
        }
    }

    /// Returns the settings of each given method, or of the default one; never empty.
    pub fn settings_of_each(&self) -> Result<Vec<Settings>, Failure> {
        let settings = self.settings.settings()?;
        let mut methods: Vec<Option<Method>> = self.method.iter().copied().map(Some).collect();
        if self.robust && !self.method.contains(&Method::Joint) {
            methods.push(Some(Method::Joint));
        }
        if methods.is_empty() {
            methods.push(settings.calibration.method);
        }
        let with = |method| {
            let mut settings = settings;
            settings.calibration.method = method;
            settings
        };
        Ok(methods.into_iter().map(with).collect())
    }

    pub fn extras(&self) -> Extras {
        self.settings.extras()
    }
}

#[derive(Args)]
#[command(next_help_heading = "Settings (the pipeline's defaults are the paper's)")]
pub struct SettingsArguments {
    #[command(flatten)]
    numbers: NumberFlags,
    /// Omit module 1, the outlier filter
    #[arg(long)]
    no_outlier_filter: bool,
    /// Omit module 3, the interval filter
    #[arg(long)]
    no_interval_filter: bool,
    /// Give the joint estimate the readings of the kept intervals alone, as methods A to D have them
    #[arg(long)]
    kept_readings: bool,
    /// Module 4, interpolation between readings [default: linear]
    #[arg(long, value_parser = choice(INTERPOLATIONS))]
    interpolation: Option<Interpolation>,
    /// Initial value of method D and of the joint estimate [default: closed-form]
    #[arg(long, value_parser = choice(PRIORS))]
    prior: Option<PriorMethod>,
    /// Measurements that the joint estimate uses, separated by commas [default: drive,control-points,rig]
    #[arg(long, value_name = "GROUPS")]
    evidence: Option<Evidence>,
    /// Rotations that methods B and C estimate: yaw, or roll and pitch as well [default: level]
    #[arg(long, value_parser = choice(ALIGNMENTS))]
    alignment: Option<Alignment>,
    /// Control-point files to use instead of those beside the tracks
    #[arg(long, value_name = "FILE", num_args = 1..)]
    gcp: Vec<PathBuf>,
    /// Folder or file with the rig (calibration_results.csv, calibration_raw.csv)
    #[arg(long, value_name = "PATH")]
    rig: Option<PathBuf>,
    /// Folder or file of a further drive with unmoved stations: solved together, each with its own clocks
    #[arg(long, value_name = "PATH")]
    drive: Vec<PathBuf>,
    /// Settings as TOML; flags take precedence
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
}

impl SettingsArguments {
    /// Returns the settings: defaults, then the config file, then the flags.
    pub fn settings(&self) -> Result<Settings, Failure> {
        let mut settings = match &self.config {
            None => Settings::default(),
            Some(path) => resect_io::settings_file::read(path).map_err(|error| match error {
                OpenError::Io { .. } => Failure::from(error),
                error => Failure::Usage(error.to_string()),
            })?,
        };
        self.numbers.apply(&mut settings.pipeline);
        if self.no_outlier_filter {
            settings.pipeline.outlier_filter = false;
        }
        if self.no_interval_filter {
            settings.pipeline.interval_filter = false;
        }
        if self.kept_readings {
            settings.pipeline.all_readings = false;
        }
        let calibration = &mut settings.calibration;
        settings.pipeline.interpolation =
            self.interpolation.unwrap_or(settings.pipeline.interpolation);
        calibration.prior = self.prior.unwrap_or(calibration.prior);
        calibration.evidence = self.evidence.unwrap_or(calibration.evidence);
        calibration.alignment = self.alignment.unwrap_or(calibration.alignment);
        settings.check().map_err(Failure::Usage)?;
        Ok(settings)
    }

    /// Returns the files of `--rig`, `--gcp` and `--drive`.
    pub fn extras(&self) -> Extras {
        Extras {
            rig: self.rig.clone(),
            gcp: self.gcp.clone(),
            gcp_instead: !self.gcp.is_empty(),
            drives: self.drive.clone(),
            ..Extras::default()
        }
    }
}

/// Parses a position, three numbers separated by commas (m).
pub fn metres(text: &str) -> Result<Vector3<f64>, String> {
    let values: Option<Vec<f64>> = text.split(',').map(|v| v.trim().parse().ok()).collect();
    values
        .and_then(|values| <[f64; 3]>::try_from(values).ok())
        .filter(|values| values.iter().all(|value| value.is_finite()))
        .map(Vector3::from)
        .ok_or_else(|| "give three numbers separated by commas, in metres".to_owned())
}

#[cfg(test)]
mod tests {
    use clap::FromArgMatches;

    use super::*;

    #[test]
    fn the_help_names_the_defaults_that_are_used() {
        let settings = Settings::default();
        let (pipeline, calibration) = (settings.pipeline, settings.calibration);
        let defaults = [
            ("interpolation", word(INTERPOLATIONS, pipeline.interpolation)),
            ("prior", word(PRIORS, calibration.prior)),
            ("evidence", calibration.evidence.to_string()),
            ("alignment", word(ALIGNMENTS, calibration.alignment)),
        ];
        let command = SettingsArguments::augment_args(clap::Command::new("resect"));
        for (flag, default) in defaults {
            let argument = command.get_arguments().find(|argument| argument.get_id() == flag);
            let help = argument.and_then(|argument| argument.get_help()).expect("help").to_string();
            assert!(help.ends_with(&format!("[default: {default}]")), "--{flag}: {help}");
        }
    }

    #[test]
    fn evidence_is_given_by_the_names_of_its_groups() {
        let parse = |flags: &[&str]| {
            let command = SettingsArguments::augment_args(clap::Command::new("resect"));
            command
                .try_get_matches_from(["resect"].iter().chain(flags))
                .and_then(|matches| SettingsArguments::from_arg_matches(&matches))
        };
        let evidence = |flags: &[&str]| {
            let arguments = parse(flags).expect("valid flags");
            arguments.settings().expect("valid settings").calibration.evidence
        };
        assert_eq!(evidence(&[]), Evidence::ALL);
        let given = evidence(&["--evidence", "rig,drive"]);
        assert_eq!(given, Evidence { control_points: false, ..Evidence::ALL });
        let message = |given: &str| parse(&["--evidence", given]).err().expect("wrong").to_string();
        for wrong in ["drives", "drive rig"] {
            let error = message(wrong);
            assert!(error.contains("name some of drive, control-points, rig"), "{error}");
        }
        for too_little in ["rig", ",", ""] {
            let error = message(too_little);
            assert!(error.contains("needs drive or control-points"), "{error}");
        }
    }

    fn word<T: Copy + PartialEq>(choices: &[(T, &str, &str)], value: T) -> String {
        let choice = choices.iter().find(|(own, ..)| *own == value);
        choice.expect("a word for each value").1.to_owned()
    }
}
