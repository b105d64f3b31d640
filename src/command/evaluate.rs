//! `resect evaluate`: trajectories of other systems against the deployment's own.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use nalgebra::Vector3;

use super::output::{advised, spare};
use super::settings_args::{AnswerArguments, metres};
use super::{Failure, load, print};
use crate::analysis::Analyst;
use crate::atomic;
use crate::deployment::file_mark::used_files;
use crate::estimates::{Alignment, Body, Options, judge, read};
use crate::export::{estimates, svg};

#[derive(Args)]
pub struct Arguments {
    /// Trajectories to judge: TUM, EuRoC, KITTI (times.txt beside it), CSV with a header, or bags with Odometry
    /// or PoseStamped
    #[arg(required = true, value_name = "ESTIMATE")]
    trajectory: Vec<PathBuf>,
    /// Folder or file with the stations' tracks: the ground truth
    #[arg(long, value_name = "PATH")]
    against: PathBuf,
    /// What an estimate's frame may be turned, moved and stretched by; with none it is in station 1's
    #[arg(long, value_enum, default_value_t = Alignment::Rigid)]
    align: Alignment,
    /// What is added to the estimates' times (s); found if not given
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    time_offset: Option<f64>,
    /// Where the estimates' body is in the vehicle: found, or the vehicle's own frame
    #[arg(long, value_enum, default_value_t = BodyArgument::Found)]
    body: BodyArgument,
    /// The origin of the estimates' body in the vehicle's frame, or of one prism in the body's (m), in place of one that is
    /// found
    #[arg(long, value_name = "X,Y,Z", conflicts_with = "body", allow_hyphen_values = true, value_parser = metres)]
    lever_arm: Option<Vector3<f64>>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Write a line for each epoch: its error, and the ground truth's σ
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Write a picture of the errors over time
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
    #[command(flatten)]
    settings: AnswerArguments,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum BodyArgument {
    Found,
    Same,
}

/// Width of the picture.
const WIDTH: f32 = 900.0;

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let settings = arguments.settings.settings()?;
    if let Some(offset_s) = arguments.time_offset.filter(|offset_s| !offset_s.is_finite()) {
        return Err(Failure::Usage(format!("--time-offset is {offset_s} s; it must be a number")));
    }
    let options = Options {
        alignment: arguments.align,
        time_offset_s: arguments.time_offset,
        body: match (arguments.lever_arm, arguments.body) {
            (Some(lever_m), _) => Body::Lever(lever_m),
            (None, BodyArgument::Found) => Body::Found,
            (None, BodyArgument::Same) => Body::Same,
        },
    };
    let mut read_estimates = Vec::new();
    for path in &arguments.trajectory {
        read_estimates.extend(read::read(path)?);
    }
    let (deployment, _) = load(&arguments.against, arguments.settings.extras())?;
    let analysis = Analyst::new(deployment.clone()).run(&settings);
    let answer = analysis.answer.clone()?;
    let calibration = &answer.calibration;
    let judgement = judge(&deployment, &analysis, read_estimates, &options);
    if judgement.judged.is_empty() {
        let whys: Vec<String> = judgement
            .unjudged
            .iter()
            .map(|(_, why)| advised(why, why.flag()).to_string())
            .collect();
        return Err(Failure::Input(anyhow::Error::msg(whys.join("; "))));
    }
    let start_s = deployment.start_s().unwrap_or_default();
    let read_files =
        || used_files(&deployment).chain(arguments.trajectory.iter().map(|path| &**path));
    let picture = || svg::to_svg(&estimates::draw(&judgement, start_s, WIDTH), svg::Colours::Light);
    let files: [(&Option<PathBuf>, &dyn Fn() -> String); 2] =
        [(&arguments.csv, &|| estimates::csv(&judgement)), (&arguments.svg, &picture)];
    for (file, text) in files {
        if let Some(file) = file {
            spare(file, read_files())?;
            atomic::write(file, text())?;
        }
    }
    Ok(print(&if arguments.json {
        format!("{:#}\n", estimates::json(&deployment.name, calibration, &judgement))
    } else {
        estimates::text(&deployment.name, calibration, &judgement, start_s)
    })?)
}
