//! Errors of opening: what, where, and what to do about it.

use std::path::PathBuf;

use resect_core::deployment::OtherSetUp;
use resect_core::deployment::printable::{excerpt, printable};
use resect_core::progress::Cancelled;

/// Why a file or folder did not become a deployment: what, where, and what to do about it.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    #[error("{}: {error}; check the path and its permissions", path.display())]
    Io { path: PathBuf, error: std::io::Error },
    #[error("{file}: {what}; {remedy}")]
    File { file: String, what: String, remedy: String },
    #[error("{file}:{line}: {what}; {remedy}")]
    Line { file: String, line: usize, what: String, remedy: String },
    /// What only the user can tell; the window asks, a command names the key of `deployment.toml`.
    #[error("{0}")]
    Question(Box<Question>),
    /// Opening was cancelled by who asked for it: not to be shown as an error.
    #[error("cancelled")]
    Cancelled,
}

/// What only the user can tell, and the key of `deployment.toml` that answers it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Question {
    /// A bag has topics of positions that do not name their station.
    #[error(
        "{file}: which topic is which station? there are {}; name those of stations 1, 2, 3 in deployment.toml: \
         topics = [\"…\", \"…\", \"…\"]",
        topics_in_words(topics)
    )]
    Topics { file: String, topics: Vec<Topic> },
    /// A table has a header that no reader knows.
    #[error(
        "{file}: which column is what? its header is `{}`; say so under [columns] in deployment.toml, or open it in \
         the window",
        excerpt(header)
    )]
    Columns { file: String, path: PathBuf, header: String },
    /// Several files hold tracks.
    #[error(
        "{folder}: several files hold tracks: {}; open one of these files, or name it in deployment.toml: tracks = \"…\"",
        files.join(", ")
    )]
    Tracks { folder: String, files: Vec<String> },
    /// Each file holds the track of one station, and none says of which.
    #[error(
        "{folder}: which file is which station? there are {}; name those of stations 1, 2, 3 in deployment.toml: \
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
