//! Errors of opening, with their place and a remedy.

use std::path::PathBuf;

use crate::windows::reading_remedy;
use resect_core::deployment::OtherSetUp;
use resect_core::deployment::printable::{excerpt, printable};
use resect_core::progress::Cancelled;

/// Error of opening a file or folder as a deployment, with its place and a remedy.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    #[error("{}: {error}; {}", path.display(), reading_remedy(error))]
    Io { path: PathBuf, error: std::io::Error },
    #[error("{file}: {what}; {remedy}")]
    File { file: String, what: String, remedy: String },
    #[error("{file}:{line}: {what}; {remedy}")]
    Line { file: String, line: usize, what: String, remedy: String },
    /// Needs an answer of the user: the window asks, a command names the key of `deployment.toml`.
    #[error("{0}")]
    Question(Box<Question>),
    /// The user cancelled opening; not to be shown as an error.
    #[error("cancelled")]
    Cancelled,
}

/// A question that only the user can answer, with the key of `deployment.toml` that answers it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Question {
    /// A bag has topics of positions that do not name their station.
    #[error(
        "{file}: the stations of its topics are unknown: {}; list the topics of stations 1, 2, … in deployment.toml: \
         topics = [\"…\", \"…\", \"…\"]",
        topics_in_words(topics)
    )]
    Topics { file: String, topics: Vec<Topic> },
    /// A table has an unknown header.
    #[error(
        "{file}: its columns are unknown, the header is `{}`; assign them under [columns] in deployment.toml, or open \
         it in the window",
        excerpt(header)
    )]
    Columns { file: String, path: PathBuf, header: String },
    /// Several files contain tracks.
    #[error(
        "{folder}: several files contain tracks: {}; open one of these files, or name it in deployment.toml: tracks = \
         \"…\"",
        files.join(", ")
    )]
    Tracks { folder: String, files: Vec<String> },
    /// Each file contains the track of one station, and none names the station.
    #[error(
        "{folder}: the stations of these files are unknown: {}; list those of stations 1, 2, … in deployment.toml: \
         tracks = [\"…\", \"…\", \"…\"]",
        files.join(", ")
    )]
    StationFiles { folder: String, files: Vec<String> },
}

/// A topic of a bag.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Topic {
    pub name: String,
    /// Type of the topic's messages, such as `geometry_msgs/PointStamped`.
    pub message_type: String,
    pub messages: u64,
}

fn topics_in_words(topics: &[Topic]) -> String {
    let said =
        topics.iter().map(|t| format!("{} ({}, {} messages)", t.name, t.message_type, t.messages));
    said.collect::<Vec<_>>().join(", ")
}

impl From<Question> for OpenError {
    fn from(question: Question) -> Self {
        Self::Question(Box::new(question))
    }
}

impl From<OtherSetUp> for OpenError {
    fn from(refused: OtherSetUp) -> Self {
        let OtherSetUp { drive: file, what, remedy } = refused;
        Self::File { file, what, remedy }
    }
}

impl From<Cancelled> for OpenError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl OpenError {
    pub fn file(file: &str, what: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self::File { file: printable(file), what: excerpt(&what.into()), remedy: remedy.into() }
    }

    pub fn line(
        file: &str,
        line: usize,
        what: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        Self::Line {
            file: printable(file),
            line,
            what: excerpt(&what.into()),
            remedy: remedy.into(),
        }
    }
}
