//! `resect evaluate`: trajectories of other systems against the deployment's own.

use std::path::PathBuf;

use clap::Args;

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
    /// What an estimate's frame may be turned, moved and stretched by; with none it is in station 1's. This flag and the next
    /// two are given once for all estimates, or once for each in their order
    #[arg(long, value_enum, default_values_t = [Alignment::Rigid])]
    align: Vec<Alignment>,
    /// What is added to an estimate's times (s), or found
    #[arg(long, value_name = "SECONDS|found", default_value = "found", allow_negative_numbers = true, value_parser = offset)]
    time_offset: Vec<Option<f64>>,
    /// Where an estimate's body is in the vehicle: found, the same as the vehicle's frame, or its origin there, known; of one
    /// prism where that is in the body's frame (m)
    #[arg(long, alias = "lever-arm", value_name = "found|same|X,Y,Z", default_value = "found", allow_hyphen_values = true, value_parser = body)]
    body: Vec<Body>,
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

/// Width of the picture.
const WIDTH: f32 = 900.0;

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let settings = arguments.settings.settings()?;
    let mut read_estimates = Vec::new();
    for (path, options) in arguments.trajectory.iter().zip(options_of_each(arguments)?) {
        read_estimates.extend(read::read(path)?.into_iter().map(|one| (one, options)));
    }
    let (deployment, _) = load(&arguments.against, arguments.settings.extras())?;
    let analysis = Analyst::new(deployment.clone()).run(&settings);
    let answer = analysis.answer.clone()?;
    let calibration = &answer.calibration;
    let judgement = judge(&deployment, &analysis, read_estimates);
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

/// How each of the files is judged.
fn options_of_each(arguments: &Arguments) -> Result<Vec<Options>, Failure> {
    let count = arguments.trajectory.len();
    let align = one_or_each("--align", &arguments.align, count)?;
    let time_offset_s = one_or_each("--time-offset", &arguments.time_offset, count)?;
    let body = one_or_each("--body", &arguments.body, count)?;
    let each = align.into_iter().zip(time_offset_s).zip(body);
    Ok(each
        .map(|((alignment, time_offset_s), body)| Options { alignment, time_offset_s, body })
        .collect())
}

/// A value for each file, of a flag that is given once for all or once for each.
fn one_or_each<T: Copy>(flag: &str, values: &[T], count: usize) -> Result<Vec<T>, Failure> {
    match values {
        [one] => Ok(vec![*one; count]),
        each if each.len() == count => Ok(each.to_vec()),
        several => Err(Failure::Usage(format!(
            "{flag} is given {} times and the number of trajectories is {count}; give it once for all, or once for each in their \
             order",
            several.len()
        ))),
    }
}

fn offset(text: &str) -> Result<Option<f64>, String> {
    match text.trim() {
        "found" => Ok(None),
        number => match number.parse() {
            Ok(offset_s) if f64::is_finite(offset_s) => Ok(Some(offset_s)),
            _ => Err("give a number of seconds, or found".to_owned()),
        },
    }
}

fn body(text: &str) -> Result<Body, String> {
    match text.trim() {
        "found" => Ok(Body::Found),
        "same" => Ok(Body::Same),
        lever => metres(lever).map(Body::Lever).map_err(|_| {
            "give found, same, or three numbers with commas between them, in metres".to_owned()
        }),
    }
}
