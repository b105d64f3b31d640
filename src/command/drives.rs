//! `resect evaluate --drives`: several drives in one table, and their errors as boxes.

use std::path::Path;

use clap::Parser;

use super::comparison_args::{ComparisonArguments, NamedEstimates};
use super::output::{is_standard_output, spare, write};
use super::picture_file::picture;
use super::{Failure, print};
use resect_io::drives_file::{self, Drive};
use resect_report::box_chart;
use resect_report::estimates::{
    DriveErrors, drives_csv, drives_json, drives_latex, drives_study, drives_text,
};

/// Help of `--drives`.
pub const DRIVES_HELP: &str = "\
Evaluate several drives, which this TOML file lists with their options. Each [[drive]] has a truth, estimates (a list of files, or a
table of names and files) and perhaps a name. Options are named as the flags without dashes, for all drives or for one of them. The
result is one table, also as --csv and --latex; --plot draws a box for each drive and estimate";

/// Size of the box plot (points).
const SIZE: [f32; 2] = [1000.0, 600.0];

/// The arguments of one drive.
#[derive(Parser)]
#[command(no_binary_name = true, disable_help_flag = true)]
struct DriveCommand {
    #[command(flatten)]
    comparison: ComparisonArguments,
    // The required files are never replaced by this argument.
    #[arg(long, hide = true)]
    drives: bool,
}

/// Files with the errors of all drives.
pub struct DrivesFiles<'a> {
    pub csv: Option<&'a Path>,
    pub latex: Option<&'a Path>,
    pub plot: Option<&'a Path>,
}

impl DrivesFiles<'_> {
    /// Writes the files; returns true if one of them is the standard output.
    fn write(&self, evaluated: &[DriveErrors], read: &[&Path]) -> Result<bool, Failure> {
        let all: Vec<&Path> = [self.csv, self.latex, self.plot].into_iter().flatten().collect();
        for file in &all {
            spare(file, read.iter().copied())?;
        }
        if let Some(csv) = self.csv {
            write(csv, drives_csv(evaluated).into_bytes())?;
        }
        if let Some(latex) = self.latex {
            write(latex, drives_latex(evaluated).into_bytes())?;
        }
        if let Some(plot) = self.plot {
            let drawing = box_chart::draw(&drives_study(evaluated), SIZE);
            write(plot, picture(plot, &drawing)?)?;
        }
        Ok(all.iter().any(|file| is_standard_output(file)))
    }
}

/// Evaluates the drives of a file, writes the files, and prints the table or one JSON object.
pub fn write_drives(file: &Path, files: &DrivesFiles<'_>, json: bool) -> Result<(), Failure> {
    let drives = drives_file::read(file)?;
    // All options are checked before the first drive is evaluated.
    let commands: Vec<DriveCommand> = drives
        .iter()
        .map(|drive| command(drive).map_err(|why| wrong_option(file, drive, &why)))
        .collect::<Result<_, _>>()?;
    let evaluated: Vec<DriveErrors> =
        drives.iter().zip(&commands).map(|(drive, command)| evaluate(drive, command)).collect();
    let read = drives.iter().flat_map(|drive| drive.truths.iter().chain(&drive.estimates));
    let read: Vec<&Path> = read.map(|path| &**path).chain([file]).collect();
    if files.write(&evaluated, &read)? {
        return Ok(());
    }
    print(&match json {
        true => format!("{:#}\n", drives_json(&evaluated)),
        false => drives_text(&evaluated),
    })?;
    if !evaluated.iter().any(DriveErrors::has_errors) {
        let line = format!("{}: no drive could be evaluated; see the reasons", file.display());
        return Err(Failure::Input(anyhow::Error::msg(line)));
    }
    Ok(())
}

fn command(drive: &Drive) -> Result<DriveCommand, clap::Error> {
    let mut words: Vec<std::ffi::OsString> = drive.flags.iter().map(Into::into).collect();
    for truth in &drive.truths {
        words.extend(["--against".into(), truth.into()]);
    }
    words.push("--".into());
    words.extend(drive.estimates.iter().map(Into::into));
    DriveCommand::try_parse_from(words)
}

fn wrong_option(file: &Path, drive: &Drive, why: &clap::Error) -> Failure {
    let why = why.to_string();
    let line = why.lines().next().unwrap_or_default();
    let line = line.strip_prefix("error: ").unwrap_or(line);
    Failure::Usage(format!("{}: drive {}: {line}", file.display(), drive.name))
}

/// Evaluates a drive; if it fails, each of its estimates has the reason.
fn evaluate(drive: &Drive, command: &DriveCommand) -> DriveErrors {
    let mut named = NamedEstimates { names: drive.names.clone(), ..NamedEstimates::default() };
    let mut errors = DriveErrors::new(&drive.name);
    let judged = command.comparison.judge(Some(&mut named), &mut |truth, judgement, _| {
        errors.add(truth, &judgement);
        Ok(())
    });
    match judged {
        Ok(()) => {}
        Err(Failure::Usage(why)) => errors.fail(&drive.names, &why),
        Err(Failure::Input(why)) => errors.fail(&drive.names, &format!("{why:#}")),
    }
    for (name, why) in &named.unreadable {
        errors.fail(std::slice::from_ref(name), why);
    }
    errors
}
