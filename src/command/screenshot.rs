//! `resect screenshot`: an image of the window, without a display.

use std::path::PathBuf;
use std::sync::Arc;

use clap::{Args, ValueEnum};

use super::judging_args::JudgingArguments;
use super::output::{is_standard_output, spare, write};
use super::progress_line::with_progress;
use super::settings_args::AnswerArguments;
use super::truth_args::TruthArguments;
use super::{Failure, print};
use crate::app::{self, Pane, PictureFormat, PictureOrder, ScreenshotOrder};
use resect_core::deployment::Deployment;
use resect_io::file_mark::used_files;
use resect_io::sample::Sample;
use resect_io::source::{Source, TrajectoryFile};

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum ThemeArgument {
    Dark,
    Light,
}

#[derive(Args)]
pub struct ScreenshotArguments {
    /// Folder or file with the stations' tracks, the built-in sample if none; with --against, trajectories of other systems
    path: Vec<PathBuf>,
    /// Ground truth of the trajectories, as in `resect evaluate`: a deployment, or a trajectory
    #[arg(long, value_name = "PATH")]
    against: Vec<PathBuf>,
    #[command(flatten)]
    truth: TruthArguments,
    #[command(flatten)]
    judging: JudgingArguments,
    /// File to write: PNG, or SVG of a pane by the ending .svg; - for PNG on standard output
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// One pane without its controls instead of the window: scene, result, residuals, …
    #[arg(long, value_parser = parse_pane)]
    pane: Option<Pane>,
    /// Width and height in points; a pixel each unless --scale is larger
    #[arg(long, default_value = "1600x1000", value_parser = parse_size)]
    size: [u32; 2],
    /// Pixels per point
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=4))]
    scale: u32,
    #[arg(long, value_enum, default_value = "dark")]
    theme: ThemeArgument,
    #[command(flatten)]
    settings: AnswerArguments,
}

pub fn run(arguments: &ScreenshotArguments) -> Result<(), Failure> {
    let settings = arguments.settings.settings()?;
    let (deployment, source) = arguments.open()?;
    let estimates = match arguments.against[..] {
        [] => Vec::new(),
        _ => arguments.judging.read_each(&arguments.path)?,
    };
    let read = arguments.path.iter().chain(&arguments.against).map(PathBuf::as_path);
    spare(&arguments.out, used_files(&deployment).chain(read))?;
    let is_svg = arguments.out.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("svg"));
    if is_svg && !arguments.pane.is_some_and(PictureOrder::has_svg) {
        let what = if arguments.pane.is_some() { "the scene has" } else { "the window has" };
        let file = arguments.out.display();
        return Err(Failure::Usage(format!("--out {file}: {what} no SVG; write a .png")));
    }
    let order = ScreenshotOrder {
        pane: arguments.pane,
        format: if is_svg { PictureFormat::Svg } else { PictureFormat::Png },
        size_points: arguments.size,
        scale: arguments.scale,
        dark: arguments.theme == ThemeArgument::Dark,
    };
    let start = app::Start::Partly {
        deployments: vec![(deployment, source)],
        estimates: estimates.into_iter().map(|(one, options)| (Arc::new(one), options)).collect(),
        why_not: Vec::new(),
    };
    let picture = app::picture(&start, settings, &order)?;
    write(&arguments.out, picture.encoded().map_err(anyhow::Error::msg)?)?;
    if is_standard_output(&arguments.out) {
        return Ok(());
    }
    let [width, height] = arguments.size.map(|side| if is_svg { side } else { side * order.scale });
    print(&format!("{}: {width}×{height}\n", arguments.out.display()))?;
    Ok(())
}

impl ScreenshotArguments {
    /// Opens the deployment, or the ground truth of trajectories.
    fn open(&self) -> Result<(Arc<Deployment>, Source), Failure> {
        let source = match (&self.path[..], &self.against[..]) {
            (_, [_, _, ..]) | ([], [_]) => {
                let line = "--against is given once, with trajectories to evaluate";
                return Err(Failure::Usage(line.to_owned()));
            }
            (_, [truth]) => {
                let deployment = self.truth.open(&self.against, self.settings.extras(), None)?;
                let source = match deployment.ground_truth {
                    Some(_) => Source::ground_truth(TrajectoryFile::at(truth, None)),
                    None => Source::at(truth).with(self.settings.extras()),
                };
                return Ok((deployment, source));
            }
            _ if self.truth.are_given() || self.judging.are_given() => {
                let line = "the flags of an evaluation need --against; give it too";
                return Err(Failure::Usage(line.to_owned()));
            }
            ([], []) => Source::sample(Sample::Warthog),
            ([path], []) => Source::at(path),
            (_, []) => {
                let line = "several paths are trajectories; give their ground truth by --against";
                return Err(Failure::Usage(line.to_owned()));
            }
        };
        let source = source.with(self.settings.extras());
        let deployment = with_progress("reading", |it| source.open(it))?;
        Ok((Arc::new(deployment), source))
    }
}

fn parse_pane(text: &str) -> Result<Pane, String> {
    Pane::of_name(text).ok_or_else(|| {
        let names = Pane::ALL.map(Pane::name).join(", ");
        format!("`{text}` is no pane; the panes are {names}")
    })
}

fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let (width, height) = text.split_once(['x', '×']).ok_or("give it as 1600x1000")?;
    let side = |side: &str| match side.trim().parse::<u32>() {
        Ok(pixels) if (200..=8192).contains(&pixels) => Ok(pixels),
        _ => Err(format!("`{side}` is not a number of pixels from 200 to 8192")),
    };
    Ok([side(width)?, side(height)?])
}
