//! A session: all open data and their views. Plain data, saved as versioned TOML.

use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

use serde::{Deserialize, Serialize};

use super::hashes::{FileMark, HashCache, used_files};
use crate::app::model::{
    ChannelPlots, Colouring, LayoutDescription, SavedEstimate, SceneOptions, StudyOptions, Units,
    Visibility,
};
use resect_core::analysis::Settings;
use resect_core::deployment::Deployment;
use resect_core::progress::Progress;
use resect_io::atomic::WriteError;
use resect_io::error::OpenError;
use resect_io::source::Source;
use resect_io::windows::reading_remedy;
use resect_report::summary::ResultSummary;
use resect_tools::planning::Plan;

/// Extension of a session file.
pub const EXTENSION: &str = "resect.toml";

#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    #[error("{}: {error}; {}", path.display(), reading_remedy(error))]
    Read { path: PathBuf, error: std::io::Error },
    #[error("{}:{line}: {what}; correct the line, or use an older copy of the session", path.display())]
    Line { path: PathBuf, line: usize, what: String },
    #[error("{}: {what}; correct the file, or use an older copy of the session", path.display())]
    Content { path: PathBuf, what: String },
    #[error("{}: written by a newer resect ({by}) in an unknown format; update resect", path.display())]
    Newer { path: PathBuf, by: String },
    #[error(
        "the session cannot be saved as text: {0}; rename files and folders whose names are not UTF-8"
    )]
    Text(String),
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// All open data and their views. Paths are absolute.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Session {
    pub deployments: Vec<SavedDeployment>,
    /// Index of the deployment that is shown.
    pub active: usize,
    pub view: SavedView,
    pub layout: Option<LayoutDescription>,
    pub pins: Vec<SavedPin>,
    /// The user's plan; `None` if the user has not edited it.
    pub plan: Option<Box<Plan>>,
}

/// A deployment of a session: source, settings, and view in time.
#[derive(Clone, Debug, PartialEq)]
pub struct SavedDeployment {
    pub source: Source,
    pub settings: Settings,
    /// Times in the stations' clock (s).
    pub cursor_s: Option<f64>,
    pub window_s: Option<[f64; 2]>,
    pub selection_s: Option<[f64; 2]>,
    pub files: Files,
    /// Trajectories that are evaluated against this deployment.
    pub estimates: Vec<SavedEstimate>,
}

/// Files from which a deployment was read, found and hashed once, when a session is first written.
#[derive(Clone, Debug, Default)]
pub struct Files {
    /// The deployment whose files are not hashed yet; `None` for files loaded from a session.
    read: Option<Arc<Deployment>>,
    marks: Arc<OnceLock<Vec<FileMark>>>,
}

impl PartialEq for Files {
    /// Files that are not hashed yet compare equal to any others.
    fn eq(&self, other: &Self) -> bool {
        match (self.marks.get(), other.marks.get()) {
            (Some(mine), Some(others)) => mine == others,
            _ => true,
        }
    }
}

impl Files {
    /// Files of a deployment that was just read.
    pub fn of(deployment: &Arc<Deployment>) -> Self {
        Self { read: Some(Arc::clone(deployment)), marks: Arc::default() }
    }

    /// Files with the hashes saved in a session.
    pub fn marked(marks: Vec<FileMark>) -> Self {
        Self { read: None, marks: Arc::new(OnceLock::from(marks)) }
    }

    /// Returns the hashes, computing them at the first call. Not for the window's thread. Unreadable files are left out.
    pub fn marks(&self, cache: &HashCache) -> &[FileMark] {
        self.marks.get_or_init(|| {
            let used = self.read.iter().flat_map(|read| used_files(read));
            used.filter_map(|path| cache.mark(path).ok()).collect()
        })
    }

    /// Returns the hashes computed so far.
    pub fn known_marks(&self) -> &[FileMark] {
        self.marks.get().map_or(&[], Vec::as_slice)
    }
}

impl SavedDeployment {
    /// Reads the deployment again. Findings about changed files come first.
    pub fn open(&self, cache: &HashCache, progress: &Progress) -> Result<Deployment, OpenError> {
        let mut deployment = self.source.open(progress)?;
        let changed = cache.changed(self.files.marks(cache));
        deployment.findings.splice(0..0, changed);
        Ok(deployment)
    }
}

/// View settings of the scene and of numbers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct SavedView {
    pub colouring: Colouring,
    pub units: Units,
    pub plots: ChannelPlots,
    pub visibility: Visibility,
    pub scene: SceneOptions,
    pub study: StudyOptions,
}

/// A pinned result.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SavedPin {
    pub name: String,
    #[serde(default = "yes")]
    pub shown: bool,
    pub result: ResultSummary,
}

pub(super) fn yes() -> bool {
    true
}

impl Session {
    /// Returns true if the session contains nothing worth saving.
    pub fn is_empty(&self) -> bool {
        self.deployments.is_empty() && self.pins.is_empty() && self.plan.is_none()
    }

    /// Returns true if data, settings, evaluated trajectories and pinned results are the same; the view may differ.
    pub fn is_same_work(&self, other: &Self) -> bool {
        fn of(session: &Session) -> impl Iterator<Item = (&Source, &Settings)> {
            session.deployments.iter().map(|saved| (&saved.source, &saved.settings))
        }
        let mut pairs = self.deployments.iter().zip(&other.deployments);
        let is_judged_alike = pairs.all(|(a, b)| judge_same(&a.estimates, &b.estimates));
        of(self).eq(of(other))
            && is_judged_alike
            && self.pins == other.pins
            && self.plan == other.plan
    }
}

/// Returns true if the same trajectories are evaluated with the same options, in any order, because unreadable ones come first. An entry
/// without a topic matches all trajectories of its bag.
fn judge_same(a: &[SavedEstimate], b: &[SavedEstimate]) -> bool {
    let is_same = |one: &SavedEstimate, other: &SavedEstimate| {
        let topics = one.topic.as_ref().zip(other.topic.as_ref());
        one.path == other.path && one.options == other.options && topics.is_none_or(|(a, b)| a == b)
    };
    let all_in = |a: &[SavedEstimate], b: &[SavedEstimate]| {
        a.iter().all(|one| b.iter().any(|other| is_same(one, other)))
    };
    all_in(a, b) && all_in(b, a)
}
