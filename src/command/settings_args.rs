//! The flags that change settings, shared by every command that runs the pipeline.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::Failure;
use crate::analysis::Settings;
use crate::calibration::{Alignment, CalibrationSettings, Loss, PriorMethod};
use crate::deployment::{Extras, OpenError};
use crate::pipeline::Interpolation;

#[derive(Clone, Copy, ValueEnum)]
enum EstimateName {
    Clocks,
    Distances,
    Tilt,
}

#[derive(Args)]
#[command(next_help_heading = "Settings (defaults are the paper's)")]
pub struct SettingsArguments {
    /// Fastest believable change of range (m/s)
    #[arg(long, value_name = "M_PER_S", allow_negative_numbers = true)]
    tau_r: Option<f64>,
    /// Fastest believable change of azimuth (deg/s)
    #[arg(long, value_name = "DEG_PER_S", allow_negative_numbers = true)]
    tau_a: Option<f64>,
    /// Fastest believable change of the zenith angle (deg/s)
    #[arg(long, value_name = "DEG_PER_S", allow_negative_numbers = true)]
    tau_e: Option<f64>,
    /// Longest gap inside an interval (s)
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    tau_s: Option<f64>,
    /// Intervals up to this length are dropped (s)
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    tau_l: Option<f64>,
    /// Triplets per second
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    rate: Option<f64>,
    /// Leave module 1 out
    #[arg(long)]
    no_outlier_filter: bool,
    /// Leave module 3 out
    #[arg(long)]
    no_interval_filter: bool,
    /// Module 4
    #[arg(long, value_enum)]
    interpolation: Option<Interpolation>,
    /// Where method D starts from
    #[arg(long, value_enum)]
    prior: Option<PriorMethod>,
    /// What a large error costs method D
    #[arg(long, value_enum)]
    loss: Option<Loss>,
    /// Let each distance count by the noise that the instruments state for it
    #[arg(long)]
    weigh_by_noise: bool,
    /// Estimate the motion from the readings themselves (method D), instead of interpolating before
    #[arg(long)]
    continuous_time: bool,
    /// What method D estimates beside the transforms: clocks, distances, tilt
    #[arg(long, value_enum, value_delimiter = ',', value_name = "WHAT")]
    estimate: Vec<EstimateName>,
    /// The best estimate known: --continuous-time --loss cauchy --estimate clocks,distances,tilt
    #[arg(long)]
    robust: bool,
    /// What methods B and C may turn: yaw, or roll and pitch as well
    #[arg(long, value_enum)]
    alignment: Option<Alignment>,
    /// Control-point files to use instead of those beside the tracks
    #[arg(long, value_name = "FILE", num_args = 1..)]
    gcp: Vec<PathBuf>,
    /// Folder or file with the rig (calibration_results.csv, calibration_raw.csv)
    #[arg(long, value_name = "PATH")]
    rig: Option<PathBuf>,
    /// Settings as TOML; flags overrule it
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
}

impl SettingsArguments {
    /// The settings: defaults, then the config file, then the flags.
    pub fn settings(&self) -> Result<Settings, Failure> {
        let mut settings = match &self.config {
            None => Settings::default(),
            Some(path) => Settings::read(path).map_err(|error| match error {
                OpenError::Io { .. } => Failure::from(error),
                error => Failure::Usage(error.to_string()),
            })?,
        };
        let thresholds = &mut settings.pipeline.thresholds;
        for (flag, setting) in [
            (self.tau_r, &mut thresholds.tau_r_m_per_s),
            (self.tau_a, &mut thresholds.tau_a_deg_per_s),
            (self.tau_e, &mut thresholds.tau_e_deg_per_s),
            (self.tau_s, &mut thresholds.tau_s_seconds),
            (self.tau_l, &mut thresholds.tau_l_seconds),
            (self.rate, &mut settings.pipeline.rate_hz),
        ] {
            if let Some(value) = flag {
                *setting = value;
            }
        }
        if self.no_outlier_filter {
            settings.pipeline.outlier_filter = false;
        }
        if self.no_interval_filter {
            settings.pipeline.interval_filter = false;
        }
        let calibration = &mut settings.calibration;
        settings.pipeline.interpolation =
            self.interpolation.unwrap_or(settings.pipeline.interpolation);
        calibration.prior = self.prior.unwrap_or(calibration.prior);
        calibration.alignment = self.alignment.unwrap_or(calibration.alignment);
        if self.robust {
            let robust = CalibrationSettings::robust();
            calibration.loss = robust.loss;
            calibration.estimate = robust.estimate;
            calibration.continuous_time = robust.continuous_time;
        }
        calibration.loss = self.loss.unwrap_or(calibration.loss);
        calibration.weigh_by_noise |= self.weigh_by_noise;
        calibration.continuous_time |= self.continuous_time;
        for name in &self.estimate {
            match name {
                EstimateName::Clocks => calibration.estimate.clocks = true,
                EstimateName::Distances => calibration.estimate.distances = true,
                EstimateName::Tilt => calibration.estimate.tilt = true,
            }
        }
        settings.check().map_err(Failure::Usage)?;
        Ok(settings)
    }

    /// The files of `--rig` and `--gcp`.
    pub fn extras(&self) -> Extras {
        Extras {
            rig: self.rig.clone(),
            gcp: self.gcp.clone(),
            gcp_instead: !self.gcp.is_empty(),
            ..Extras::default()
        }
    }
}
