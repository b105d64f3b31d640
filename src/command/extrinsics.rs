//! `resect extrinsics`: pose of a body or an antenna in another body, by their trajectories.

use std::path::PathBuf;

use clap::Args;

use super::choice::{TRANSFORM_FORMATS, choice};
use super::judging_args::{convention, one_or_each};
use super::{Failure, print};
use resect_io::estimate_file::{is_bag, read_truth};
use resect_io::gnss_solution::SolutionChoice;
use resect_report::extrinsics::{extrinsics_copy, extrinsics_json, extrinsics_text};
use resect_report::named_transform::TransformFormat;
use resect_tools::estimates::conventions::Convention;
use resect_tools::estimates::{Options, TrajectoryAlignment};
use resect_tools::extrinsics::estimate_extrinsics;

#[derive(Args)]
pub struct ExtrinsicsArguments {
    /// Trajectory of the body, with orientations: in any format that `evaluate` reads
    #[arg(value_name = "BODY")]
    body: PathBuf,
    /// Trajectory of the other body, or positions of an antenna or a prism. It may be the same bag
    #[arg(value_name = "OTHER")]
    other: PathBuf,
    /// Topic in a bag: once for BODY and once for OTHER, in their order
    #[arg(long, value_name = "TOPIC")]
    topic: Vec<String>,
    /// Convention of a file, in the words of `evaluate --convention`: once for both, or once for each
    #[arg(long, value_name = "WORDS", default_value = "xyzw", value_parser = convention)]
    convention: Vec<Convention>,
    /// Offset that is added to the times of OTHER (s); estimated without it
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, value_parser = seconds)]
    time_offset: Option<f64>,
    /// Estimate the ratio of lengths without its prior of 3 %, for a single camera
    #[arg(long)]
    free_scale: bool,
    /// Names of the frames in the transform that is copied; the names of the files otherwise
    #[arg(long, value_name = "BODY,OTHER", value_parser = frames)]
    frames: Option<[String; 2]>,
    /// Print only the transform, for another program
    #[arg(long, value_name = "FORMAT", value_parser = choice(TRANSFORM_FORMATS), conflicts_with = "json")]
    copy: Option<TransformFormat>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &ExtrinsicsArguments) -> Result<(), Failure> {
    let topics = match &arguments.topic[..] {
        [] => [None, None],
        [only] => {
            let are_bags = [is_bag(&arguments.body)?, is_bag(&arguments.other)?];
            // One topic is that of all bags. Without any, the first file refuses it.
            let are_bags = if are_bags == [false; 2] { [true, false] } else { are_bags };
            are_bags.map(|is_bag| is_bag.then_some(&**only))
        }
        [first, second] => [Some(&**first), Some(&**second)],
        _ => {
            let line = "--topic is given at most twice: for BODY and for OTHER";
            return Err(Failure::Usage(line.to_owned()));
        }
    };
    let conventions = one_or_each("--convention", &arguments.convention, 2)?;
    let read = |path: &PathBuf, topic| read_truth(path, topic, SolutionChoice::Best);
    let both = [read(&arguments.body, topics[0])?, read(&arguments.other, topics[1])?];
    let options = Options {
        alignment: match arguments.free_scale {
            true => TrajectoryAlignment::Similarity,
            false => TrajectoryAlignment::Rigid,
        },
        time_offset_s: arguments.time_offset,
        convention: conventions[1],
        ..Options::default()
    };
    let extrinsics = estimate_extrinsics(both, &options, conventions[0])
        .map_err(|why| Failure::Input(anyhow::Error::new(why)))?;
    Ok(print(&match (arguments.copy, arguments.json) {
        (Some(format), _) => extrinsics_copy(&extrinsics, arguments.frames.clone(), format),
        (None, true) => format!("{:#}\n", extrinsics_json(&extrinsics)),
        (None, false) => extrinsics_text(&extrinsics),
    })?)
}

fn frames(text: &str) -> Result<[String; 2], String> {
    let is_name = |name: &str| {
        !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || "_-./".contains(c))
    };
    match text.split_once(',').map(|(body, other)| [body.trim(), other.trim()]) {
        Some(both) if both.into_iter().all(is_name) => Ok(both.map(str::to_owned)),
        _ => Err("give two names of frames, such as base_link,gnss".to_owned()),
    }
}

fn seconds(text: &str) -> Result<f64, String> {
    let number = text.trim().parse().ok().filter(|seconds| f64::is_finite(*seconds));
    number.ok_or_else(|| "give a number of seconds".to_owned())
}
