//! `resect screenshot`: an image of the window, without a display.

use std::path::PathBuf;
use std::sync::Arc;

use clap::{Args, ValueEnum};

use super::output::spare;
use super::settings_args::AnswerArguments;
use super::{Failure, print};
use crate::app;
use resect_core::progress::Progress;
use resect_io::atomic;
use resect_io::file_mark::used_files;
use resect_io::sample::Sample;
use resect_io::source::Source;

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum ThemeArgument {
    Dark,
    Light,
}

#[derive(Args)]
pub struct ScreenshotArguments {
    /// Folder or file with the stations' tracks; the built-in sample if none
    path: Option<PathBuf>,
    /// PNG file to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Width and height in pixels
    #[arg(long, default_value = "1600x1000", value_parser = parse_size)]
    size: [u32; 2],
    #[arg(long, value_enum, default_value = "dark")]
    theme: ThemeArgument,
    #[command(flatten)]
    settings: AnswerArguments,
}

pub fn run(arguments: &ScreenshotArguments) -> Result<(), Failure> {
    let settings = arguments.settings.settings()?;
    let source = match &arguments.path {
        Some(path) => Source::at(path),
        None => Source::sample(Sample::Warthog),
    };
    let source = source.with(arguments.settings.extras());
    let deployment = source.open(&Progress::default())?;
    spare(&arguments.out, used_files(&deployment))?;
    let dark = arguments.theme == ThemeArgument::Dark;
    let image = app::picture(vec![(Arc::new(deployment), source)], settings, arguments.size, dark)?;
    let mut png = std::io::Cursor::new(Vec::new());
    image.write_to(&mut png, image::ImageFormat::Png)?;
    atomic::write(&arguments.out, png.into_inner())?;
    let [width, height] = arguments.size;
    print(&format!("{}: {width}×{height}\n", arguments.out.display()))?;
    Ok(())
}

fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let (width, height) = text.split_once(['x', '×']).ok_or("give it as 1600x1000")?;
    let side = |side: &str| match side.trim().parse::<u32>() {
        Ok(pixels) if (200..=8192).contains(&pixels) => Ok(pixels),
        _ => Err(format!("`{side}` is not a number of pixels from 200 to 8192")),
    };
    Ok([side(width)?, side(height)?])
}
