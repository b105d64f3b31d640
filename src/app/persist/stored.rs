//! File format of a session. Reading is lenient: an invalid view or layout is replaced and reported, and only the open data must be valid.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::hashes::FileMark;
use super::session::{Files, SavedDeployment, SavedPin, SavedView, Session, yes};
use crate::app::model::findings::{session_part_unknown, session_plan_invalid};
use crate::app::model::{LayoutDescription, SavedEstimate};
use resect_core::analysis::Settings;
use resect_core::deployment::Finding;
use resect_io::source::{Extras, Place, Source, TrajectoryFile};
use resect_io::windows;
use resect_tools::estimates::Options;
use resect_tools::planning::Plan;

/// Format version that this program writes.
pub const VERSION: u32 = 1;

/// Header of every version of the format.
#[derive(Deserialize)]
pub struct Version {
    pub resect_session: u32,
    #[serde(default)]
    pub resect: String,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredSession {
    /// Version of the format; [`resect_io::format::SESSION_KEY`], which identifies a session.
    resect_session: u32,
    /// Version of the program that wrote the file.
    #[serde(default)]
    resect: String,
    #[serde(default)]
    active: usize,
    #[serde(default)]
    view: Lenient<SavedView>,
    #[serde(default, rename = "deployment", skip_serializing_if = "Vec::is_empty")]
    deployments: Vec<StoredDeployment>,
    #[serde(default, rename = "pin", skip_serializing_if = "Vec::is_empty")]
    pins: Vec<Lenient<SavedPin>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    layout: Option<Lenient<LayoutDescription>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    plan: Option<Lenient<Box<Plan>>>,
}

#[derive(Serialize, Deserialize)]
struct StoredDeployment {
    #[serde(flatten)]
    source: Source,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    cursor_s: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    window_s: Option<[f64; 2]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    selection_s: Option<[f64; 2]>,
    #[serde(default)]
    settings: Settings,
    #[serde(default, rename = "file", skip_serializing_if = "Vec::is_empty")]
    files: Vec<FileMark>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    estimates: Vec<StoredEstimate>,
    /// Options of all trajectories together, in older sessions.
    #[serde(default, skip_serializing)]
    judging: Lenient<Options>,
}

/// A trajectory to evaluate; older sessions have only its path.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum StoredEstimate {
    Path(PathBuf),
    Asked {
        path: PathBuf,
        topic: Option<String>,
        #[serde(default = "yes")]
        shown: bool,
        #[serde(default)]
        options: Lenient<Options>,
    },
}

/// A field that may be unreadable without affecting the rest.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
pub enum Lenient<T> {
    Read(T),
    Unreadable(toml::Value),
}

impl<T: Default> Default for Lenient<T> {
    fn default() -> Self {
        Self::Read(T::default())
    }
}

impl<T> Lenient<T> {
    pub fn read(self, what: &str, findings: &mut Vec<Finding>) -> Option<T> {
        match self {
            Self::Read(value) => Some(value),
            Self::Unreadable(_) => {
                findings.push(session_part_unknown(what));
                None
            }
        }
    }
}

impl StoredSession {
    pub fn new(session: &Session, folder: &Path, marks: impl Fn(&Files) -> &[FileMark]) -> Self {
        let deployment = |saved: &SavedDeployment| StoredDeployment {
            source: with_paths(&saved.source, |path| relative(path, folder)),
            cursor_s: saved.cursor_s,
            window_s: saved.window_s,
            selection_s: saved.selection_s,
            settings: saved.settings,
            files: marks(&saved.files)
                .iter()
                .map(|mark| FileMark { path: relative(&mark.path, folder), ..mark.clone() })
                .collect(),
            judging: Lenient::default(),
            estimates: saved
                .estimates
                .iter()
                .map(|one| StoredEstimate::Asked {
                    path: relative(&one.path, folder),
                    topic: one.topic.clone(),
                    shown: one.shown,
                    options: Lenient::Read(one.options),
                })
                .collect(),
        };
        Self {
            resect_session: VERSION,
            resect: env!("CARGO_PKG_VERSION").to_owned(),
            active: session.active,
            view: Lenient::Read(session.view.clone()),
            deployments: session.deployments.iter().map(deployment).collect(),
            pins: session.pins.iter().cloned().map(Lenient::Read).collect(),
            plan: session.plan.clone().map(Lenient::Read),
            layout: session.layout.clone().map(Lenient::Read),
        }
    }

    /// Returns the session with absolute paths and findings about ignored fields, or the reason why it is invalid.
    pub fn read(self, folder: &Path) -> Result<(Session, Vec<Finding>), String> {
        let mut findings = Vec::new();
        for stored in &self.deployments {
            stored
                .settings
                .check()
                .map_err(|what| format!("settings of {}: {what}", stored.source.title()))?;
        }
        let mut deployment = |stored: StoredDeployment| SavedDeployment {
            source: with_paths(&stored.source, |path| folder.join(path)),
            settings: stored.settings,
            cursor_s: stored.cursor_s,
            window_s: stored.window_s,
            selection_s: stored.selection_s,
            estimates: read_estimates(stored.estimates, stored.judging, folder, &mut findings),
            files: Files::marked(
                stored
                    .files
                    .into_iter()
                    .map(|mark| FileMark { path: folder.join(&mark.path), ..mark })
                    .collect(),
            ),
        };
        let deployments: Vec<_> = self.deployments.into_iter().map(&mut deployment).collect();
        let pins = self.pins.into_iter();
        let session = Session {
            active: self.active.min(deployments.len().saturating_sub(1)),
            deployments,
            view: self.view.read("the session's view", &mut findings).unwrap_or_default(),
            layout: self.layout.and_then(|it| it.read("the session's layout", &mut findings)),
            pins: pins.filter_map(|pin| pin.read("a pinned result", &mut findings)).collect(),
            plan: self
                .plan
                .and_then(|it| it.read("the plan", &mut findings))
                .filter(|plan| plan_makes_sense(plan, &mut findings)),
        };
        Ok((session, findings))
    }
}

fn read_estimates(
    stored: Vec<StoredEstimate>,
    of_all: Lenient<Options>,
    folder: &Path,
    findings: &mut Vec<Finding>,
) -> Vec<SavedEstimate> {
    let mut asked = |options: Lenient<Options>| {
        options.read("the evaluation of a trajectory", findings).unwrap_or_default()
    };
    let of_all = asked(of_all);
    let one = |stored| match stored {
        StoredEstimate::Path(path) => {
            SavedEstimate { path: folder.join(path), topic: None, options: of_all, shown: true }
        }
        StoredEstimate::Asked { path, topic, shown, options } => {
            SavedEstimate { path: folder.join(path), topic, options: asked(options), shown }
        }
    };
    stored.into_iter().map(one).collect()
}

fn plan_makes_sense(plan: &Plan, findings: &mut Vec<Finding>) -> bool {
    let Err((what, _)) = plan.check() else { return true };
    findings.push(session_plan_invalid(&what));
    false
}

/// Returns the source with each of its paths changed.
fn with_paths(source: &Source, change: impl Fn(&Path) -> PathBuf) -> Source {
    let all = |paths: &[PathBuf]| paths.iter().map(|path| change(path)).collect();
    let extras = &source.extras;
    Source {
        place: match &source.place {
            Place::Path(path) => Place::Path(change(path)),
            Place::GroundTruth(file) => {
                Place::GroundTruth(TrajectoryFile { path: change(&file.path), ..file.clone() })
            }
            Place::Sample(sample) => Place::Sample(*sample),
        },
        extras: Extras {
            rig: extras.rig.as_deref().map(&change),
            gcp: all(&extras.gcp),
            gcp_instead: extras.gcp_instead,
            gnss: all(&extras.gnss),
            drives: all(&extras.drives),
            corrections: extras.corrections.clone(),
        },
    }
}

/// Returns the path relative to this folder if it is below it, and otherwise the absolute path.
fn relative(path: &Path, folder: &Path) -> PathBuf {
    let absolute = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let absolute = windows::canonical(&absolute).unwrap_or(absolute);
    match absolute.strip_prefix(folder) {
        Ok(below) if below.as_os_str().is_empty() => PathBuf::from("."),
        Ok(below) => windows::with_slashes(below),
        Err(_) => absolute,
    }
}
