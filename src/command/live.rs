//! `resect live`: calibration during the drive, a line of results a second.

use resect_core::network::{MOST_STATIONS, PerStation};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::{Duration, Instant};

use clap::Args;
use serde_json::json;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use super::remedy_flags::finding_line;
use super::settings_args::AnswerArguments;
use super::{Failure, complain, print};
use resect_core::analysis::{Analyst, Settings};
use resect_core::deployment::Finding;
use resect_io::atomic::WriteError;
use resect_io::source::{Extras, Source};
use resect_live::{Feed, Finished, Link, LiveError, Session, View, Wanted};
use resect_report::{json, live as told, text};

/// Interval between two lines.
const EVERY: Duration = Duration::from_secs(1);
/// Interval at which the command checks for its end.
const NAP: Duration = Duration::from_millis(50);
/// Exit code of a program that Ctrl-C ended, by the shells' convention.
const INTERRUPTED: i32 = 130;

#[derive(Args)]
pub struct LiveArguments {
    /// Address of a stream: ws://robot:8765 of foxglove_bridge, or …/ws/measurements/stream of rts-network
    #[arg(required_unless_present = "replay")]
    url: Option<String>,
    /// Replay a deployment instead, in real time
    #[arg(long, value_name = "PATH", conflicts_with = "url")]
    replay: Option<PathBuf>,
    /// Speed of the replay, relative to the drive
    #[arg(long, default_value_t = 1.0, requires = "replay", allow_negative_numbers = true)]
    speed: f64,
    /// Folder with the prior data: rig, control points, deployment.toml
    #[arg(long, value_name = "PATH")]
    deployment: Option<PathBuf>,
    /// Topics with the positions of stations 1, 2, …
    #[arg(long, value_name = "A,B,C", value_delimiter = ',')]
    topics: Vec<String>,
    /// Ids of the instruments of rts-network that are stations 1, 2, …
    #[arg(long, value_name = "A,B,C", value_delimiter = ',')]
    instruments: Vec<String>,
    /// Record the stream to a new file
    #[arg(long, value_name = "FILE.mcap")]
    record: Option<PathBuf>,
    /// Target σ at the far end of the track, at which the data suffices (mm)
    #[arg(long, value_name = "MM", default_value_t = 2.0, allow_negative_numbers = true)]
    target_mm: f64,
    /// End after so many seconds; a replay ends by itself
    #[arg(long, value_name = "S")]
    seconds: Option<f64>,
    /// End as soon as the target is reached
    #[arg(long)]
    until_enough: bool,
    /// Print the calibration from all data at the end, as calibrate does
    #[arg(long)]
    answer: bool,
    /// Print a line of JSON a second
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    settings: AnswerArguments,
}

pub fn run(arguments: &LiveArguments) -> Result<(), Failure> {
    let wanted = wanted(arguments)?;
    let settings = wanted.settings;
    let stop = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        // A second signal ends the program at once, without waiting for the end of a recording.
        flag::register_conditional_shutdown(signal, INTERRUPTED, Arc::clone(&stop))?;
        flag::register(signal, Arc::clone(&stop))?;
    }
    let session = Session::start(&wanted).map_err(|error| match error {
        LiveError::Address(_) | LiveError::Speed(_) | LiveError::Target(_) => {
            Failure::Usage(error.to_string())
        }
        error => Failure::from(error),
    })?;
    tell(&session, arguments, &stop)?;
    let finished = session.stop().ok_or_else(|| {
        anyhow::anyhow!("the live deployment stopped unexpectedly; this is a bug in resect")
    })?;
    end(finished, arguments, &settings)
}

fn wanted(arguments: &LiveArguments) -> Result<Wanted, Failure> {
    let settings = arguments.settings.settings()?;
    let mut extras = arguments.settings.extras();
    extras.corrections.topics = of_each_station("--topics", &arguments.topics)?;
    let feed = match (&arguments.url, &arguments.replay) {
        (Some(url), _) if extras.drives.is_empty() => Feed::Url(url.clone()),
        (None, Some(path)) => {
            let source = Source::at(path).with(extras.clone());
            Feed::Replay { source: Box::new(source), speed: arguments.speed }
        }
        _ => {
            let line =
                "--drive needs a finished drive; use it when you open the recording afterwards";
            return Err(Failure::Usage(line.to_owned()));
        }
    };
    if arguments.seconds.is_some_and(|seconds| !(seconds >= 0.0 && seconds.is_finite())) {
        return Err(Failure::Usage(
            "--seconds is not a duration; give a number of seconds".to_owned(),
        ));
    }
    Ok(Wanted {
        feed,
        deployment: arguments.deployment.clone(),
        extras: Extras { drives: Vec::new(), ..extras },
        instruments: of_each_station("--instruments", &arguments.instruments)?,
        settings,
        record: arguments.record.clone(),
        target_m: arguments.target_mm * 1e-3,
        calculates: true,
    })
}

/// Returns a name for each station, or `None` without any.
fn of_each_station(flag: &str, names: &[String]) -> Result<Option<PerStation<String>>, Failure> {
    match names.len() {
        0 => Ok(None),
        1..=MOST_STATIONS => Ok(Some(names.iter().cloned().collect())),
        count => Err(Failure::Usage(format!(
            "{flag} has {count} names; give those of stations 1 to {MOST_STATIONS} at most"
        ))),
    }
}

/// Writes a line a second until the session ends.
fn tell(session: &Session, arguments: &LiveArguments, stop: &AtomicBool) -> Result<(), WriteError> {
    let begun = Instant::now();
    let mut next = begun + EVERY;
    let mut before = View::default();
    let is_over = || {
        let late = arguments.seconds.is_some_and(|s| begun.elapsed().as_secs_f64() >= s);
        late || stop.load(Relaxed) || session.has_ended()
    };
    while !is_over() {
        let now = Instant::now();
        if now < next {
            std::thread::sleep(NAP.min(next - now));
            continue;
        }
        next += EVERY;
        let view = session.view();
        let is_heard = if arguments.json {
            say(&format!("{}\n", told::json(&view)))?
        } else {
            say(&lines(&before, &view))?
        };
        if !is_heard || (arguments.until_enough && view.enough) {
            break;
        }
        before = (*view).clone();
    }
    Ok(())
}

/// Returns true if the view has this warning already, with any numbers.
fn is_known(view: &View, finding: &Finding) -> bool {
    view.warnings.iter().any(|known| known.finding.identity() == finding.identity())
}

/// Returns the news since the previous line, and the line.
fn lines(before: &View, view: &View) -> String {
    let mut text = String::new();
    if before.link != view.link {
        text += &format!("- {}\n", told::link(view));
    }
    for warning in &view.warnings {
        if !is_known(before, &warning.finding) {
            text += &format!("! {}\n", finding_line(&warning.finding));
        }
    }
    for left in &view.left_out {
        if !before.left_out.iter().any(|known| known.what == left.what) {
            text += &format!("! left out ({}): {}\n", left.what, left.first);
        }
    }
    text + &told::line(view) + "\n"
}

/// Prints; returns false if the reader has closed the pipe.
fn say(text: &str) -> Result<bool, WriteError> {
    let mut out = std::io::stdout();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(false),
        Err(error) => Err(WriteError::of_file(Path::new("standard output"), error)),
    }
}

/// Prints the final result.
fn end(finished: Finished, arguments: &LiveArguments, settings: &Settings) -> Result<(), Failure> {
    let Finished { deployment, view, recorded, closing } = finished;
    let answered = deployment.map(Arc::new).map(|deployment| {
        // The final calibration uses all readings, as the last line does.
        let analysis =
            arguments.answer.then(|| Analyst::new(Arc::clone(&deployment)).run(settings));
        (deployment, analysis)
    });
    let view = match &answered {
        Ok((deployment, Some(analysis))) => closing.judged(&view, deployment, analysis),
        _ => view,
    };
    if arguments.json {
        print(&format!("{}\n", told::json(&view)))?;
    } else {
        print(&lines(&view, &view))?;
    }
    match recorded {
        Some(Ok(recorded)) if !arguments.json => {
            let path = recorded.path.display();
            print(&format!("- recorded {} messages: {path}\n", recorded.messages))?;
        }
        Some(Err(error)) => complain(&error.to_string()),
        _ => {}
    }
    if view.messages == 0
        && let Link::Lost { why, .. } = &view.link
    {
        return Err(Failure::Input(anyhow::anyhow!("{why}")));
    }
    if !arguments.answer {
        return Ok(());
    }
    let (deployment, Some(analysis)) = answered? else { return Ok(()) };
    let answer = analysis.answer.clone()?;
    if arguments.json {
        let answer = json::calibration(&deployment, &analysis, &answer, 0.0);
        print(&format!("{}\n", json!({ "schema": json::SCHEMA, "answer": answer })))?;
    } else {
        print(&text::calibration(&deployment, &analysis, &answer, finding_line))?;
    }
    Ok(())
}
