//! `resect check`: content and faults of deployments and trajectories.

use resect_core::network::{Number, Pair};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;

use super::frame_times::numbered_poses;
use super::remedy_flags::finding_line;
use super::{Failure, load, print};
use resect_core::analysis::{Analysis, Analyst, Settings};
use resect_core::calibration::{CalibrationError, Method};
use resect_core::deployment::{Deployment, Finding, Severity, Track};
use resect_core::statistics::median;
use resect_io::estimate_file;
use resect_io::source::Extras;
use resect_io::what_is::{Dropped, what_is};
use resect_report::estimates::{trajectories_json, trajectory_text};
use resect_report::of_run;
use resect_tools::estimates::EstimatedTrajectory;

#[derive(Args)]
pub struct CheckArguments {
    /// Folders or files of deployments, or trajectories in any format of `resect evaluate`
    #[arg(required = true)]
    path: Vec<PathBuf>,
    /// Folder or file with the rig, if it is not beside the tracks
    #[arg(long, value_name = "PATH")]
    rig: Option<PathBuf>,
    /// Print one JSON object, for trajectories
    #[arg(long)]
    json: bool,
}

/// CheckedContent of a path.
enum CheckedContent {
    Trajectories(Vec<EstimatedTrajectory>),
    /// A deployment, and the duration of opening it (ms).
    Deployment(Arc<Deployment>, f64),
}

pub fn run(arguments: &CheckArguments) -> Result<(), Failure> {
    let contents: Vec<CheckedContent> =
        arguments.path.iter().map(|path| content(path, arguments)).collect::<Result<_, _>>()?;
    if arguments.json {
        let mut trajectories = Vec::new();
        for (content, path) in contents.into_iter().zip(&arguments.path) {
            let CheckedContent::Trajectories(read) = content else {
                return Err(Failure::Usage(format!(
                    "--json is for trajectories, and {} is a deployment; `resect calibrate --json` describes it",
                    path.display()
                )));
            };
            trajectories.extend(read);
        }
        return Ok(print(&format!("{:#}\n", trajectories_json(&trajectories)))?);
    }
    for (index, content) in contents.iter().enumerate() {
        if index > 0 {
            print("\n")?;
        }
        match content {
            CheckedContent::Trajectories(trajectories) => {
                let texts: Vec<String> = trajectories.iter().map(trajectory_text).collect();
                print(&texts.join("\n"))?;
            }
            CheckedContent::Deployment(deployment, load_ms) => {
                let analysis = Analyst::new(deployment.clone()).run(&Settings::default());
                print(&report(deployment, &analysis))?;
                if of_run::tells_durations() {
                    print(&format!("opened in {load_ms:.1} ms\n"))?;
                }
            }
        }
    }
    Ok(())
}

/// Reads a trajectory, or opens a deployment. A file that is no deployment may be a trajectory of positions.
fn content(path: &Path, arguments: &CheckArguments) -> Result<CheckedContent, Failure> {
    if let Some(read) = numbered_poses(path) {
        return Ok(CheckedContent::Trajectories(vec![read?]));
    }
    if matches!(what_is(path), Dropped::Estimate | Dropped::Gnss) {
        return Ok(CheckedContent::Trajectories(estimate_file::read(path)?));
    }
    let extras = Extras { rig: arguments.rig.clone(), ..Extras::default() };
    match load(path, extras) {
        Ok((deployment, load_ms)) => Ok(CheckedContent::Deployment(deployment, load_ms)),
        Err(error) => match estimate_file::read(path) {
            Ok(trajectories) => Ok(CheckedContent::Trajectories(trajectories)),
            Err(_) => Err(error.into()),
        },
    }
}

fn report(deployment: &Deployment, analysis: &Analysis) -> String {
    let mut text = format!("{}\n\nfiles\n", deployment.name);
    let width = deployment.ingredients.iter().map(|i| i.file.chars().count()).max().unwrap_or(0);
    for ingredient in &deployment.ingredients {
        let used = if ingredient.used { "used   " } else { "ignored" };
        _ = writeln!(text, "  {used}  {:<width$}  {}", ingredient.file, ingredient.what);
    }
    text += "\ntracks\n";
    let names = deployment.tracks.map_each(|station, _| deployment.station_in_words(station));
    let width = names.iter().map(|name| name.chars().count()).max().unwrap_or(0);
    for (name, track) in names.iter().zip(&deployment.tracks) {
        _ = writeln!(text, "  {name:<width$}  {}", describe(track));
    }
    text += "\nrig\n";
    match &deployment.rig {
        None => text += "  unknown\n",
        Some(rig) => {
            for (pair, distance) in rig.inter_prism_m.iter().enumerate() {
                _ = writeln!(text, "  prisms {}  {distance:.4} m", Pair::at(pair));
            }
            if let Some(heights_m) = rig.height_differences_m() {
                let heights: Vec<String> = (2..)
                    .zip(heights_m)
                    .map(|(prism, height_m)| format!("{height_m:+.3} m above prism {prism}"))
                    .collect();
                _ = writeln!(text, "  prism 1 is {}", heights.join(", "));
            }
        }
    }
    text += "\ncontrol points\n";
    if deployment.control_points.is_empty() {
        text += "  none\n";
    }
    for set in &deployment.control_points {
        let complete = set.points.iter().filter(|p| p.readings.iter().all(Option::is_some)).count();
        let what = if set.pillars { "pillars" } else { "points" };
        let known = set.points.iter().filter(|p| p.known_m.is_some()).count();
        _ = writeln!(
            text,
            "  {}  {} {what}, {complete} seen by all stations, {known} with known coordinates",
            set.file,
            set.points.len()
        );
    }
    if let Some(antennas) = &deployment.gnss {
        text += "\nGNSS\n";
        for (index, fixes) in antennas.iter().enumerate() {
            let fixed = fixes.iter().filter(|fix| fix.quality == 1).count();
            _ = writeln!(text, "  antenna {}  {} solutions, {fixed} fixed", index + 1, fixes.len());
        }
    }
    text += "\ncalibrations\n";
    for method in Method::ALL {
        let lack = analysis.offer.lack(method);
        let possible = lack.map_or("possible".to_owned(), |lack| format!("needs {lack}"));
        _ = writeln!(text, "  {:<26} {possible}", method.label());
    }
    text += &first_look(analysis);
    text += "\nfindings\n";
    for finding in &deployment.findings {
        _ = writeln!(text, "  {} {}", finding.severity.mark(), finding_line(finding));
    }
    text
}

/// Findings of the joint estimate: only a calibration reveals a wrong sense, number
/// or unit. Empty if the data is insufficient for one, which the text above reports.
fn first_look(analysis: &Analysis) -> String {
    let mut text = format!("\nby {} with the default settings\n", Method::default());
    match &analysis.answer {
        Ok(answer) => {
            let calibration = &answer.calibration;
            _ = writeln!(text, "  {}", calibration.verdict_in_words());
            let own = |f: &&Finding| f.severity > Severity::Note && !f.kind.is_doubt();
            for finding in calibration.findings.iter().filter(own) {
                _ = writeln!(text, "  {} {}", finding.severity.mark(), finding_line(finding));
            }
        }
        // Ranges in a wrong unit may leave no triplets, as the error explains.
        Err(why @ CalibrationError::NoTriplets { .. }) => _ = writeln!(text, "  x {why}"),
        Err(_) => return String::new(),
    }
    text
}

fn describe(track: &Track) -> String {
    let readings = &track.measurements;
    let (Some(first), Some(last)) = (readings.first(), readings.last()) else {
        return "no measurement".to_owned();
    };
    let gaps_s = || readings.windows(2).map(|pair| pair[1].time_s - pair[0].time_s);
    let ranges = || readings.iter().map(|m| m.range_m);
    let (near, far) = (ranges().fold(f64::INFINITY, f64::min), ranges().fold(0.0, f64::max));
    let rate = median(gaps_s()).map_or("–".to_owned(), |gap_s| format!("{:.2}", 1.0 / gap_s));
    format!(
        "{} readings over {:.1} s at {rate} Hz, longest gap {:.1} s, range {near:.1}–{far:.1} m",
        readings.len(),
        last.time_s - first.time_s,
        gaps_s().fold(0.0, f64::max),
    )
}
