//! Questions to the user: facts about the data that no file contains, the purpose of files, and confirmation before a file is changed.

use std::path::PathBuf;
use std::sync::Arc;

use resect_core::deployment::{AzimuthSense, ColumnMapping};
use resect_core::network::USUAL_STATIONS;
use resect_io::format::mapped_csv;
use resect_io::format::mapped_csv::Preview;
use resect_io::source::Extras;

/// A question, with the choices made so far.
#[derive(Clone, Debug)]
pub enum Asked {
    Tracks(AskedTracks),
    Stations(AskedStations),
    Columns(Box<AskedColumns>),
    Files(Box<AskedFiles>),
    Toml(Box<AskedToml>),
}

/// Answer to a question.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AskedAnswer {
    /// Accepts the present choices.
    AsChosen,
    /// The files belong to no open deployment, but to one of their own.
    OwnDeployment,
}

/// Selection of the files that contain tracks.
#[derive(Clone, Debug, PartialEq)]
pub struct AskedTracks {
    pub folder: String,
    pub files: Vec<String>,
    pub chosen: Vec<bool>,
}

/// Assignment of topics or files to stations.
#[derive(Clone, Debug, PartialEq)]
pub struct AskedStations {
    /// The bag, or the folder.
    pub place: String,
    pub are: StationsAre,
    /// Names of the topics or files, with further information.
    pub choices: Vec<(String, String)>,
    /// Index of the choice for each station.
    pub stations: Vec<usize>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StationsAre {
    Topics,
    Files,
}

/// Assignment of the columns of a table.
#[derive(Clone, Debug)]
pub struct AskedColumns {
    pub file: String,
    pub path: PathBuf,
    /// Number of the request that reads the head of the file.
    pub request: u64,
    /// Head of the file; `None` until it is read.
    pub head: Option<TableHead>,
    /// Reason why it could not be read.
    pub trouble: Option<String>,
    pub mapping: ColumnMapping,
    pub azimuth: AzimuthSense,
    pub ranges_include_prism_constant: bool,
    /// Files of the stations if each has its own: indices in [`TableHead::alike`].
    pub files: Option<Vec<usize>>,
    /// The first rows, read with the mapping.
    pub preview: Preview,
}

/// Head of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct TableHead {
    pub text: Arc<str>,
    /// Files with the same header in the folder, including this one.
    pub alike: Vec<String>,
}

/// Assignment of a rig or control points to a deployment.
#[derive(Clone, Debug, PartialEq)]
pub struct AskedFiles {
    pub extras: Extras,
    /// Folders that contain only these extras.
    pub folders: Vec<PathBuf>,
    /// Ids and names of the deployments to choose from.
    pub targets: Vec<(u64, String)>,
    /// Index of the chosen deployment in `targets`.
    pub target: usize,
}

/// Confirmation before the folder's `deployment.toml` is written.
#[derive(Clone, Debug, PartialEq)]
pub struct AskedToml {
    /// Id of the deployment.
    pub id: u64,
    pub path: PathBuf,
    /// Present content of the file, if it exists.
    pub before: Option<String>,
    pub after: String,
    /// Descriptions of the changes.
    pub said: Vec<String>,
    /// Extras of the deployment once the file is written.
    pub stays: Extras,
}

impl Asked {
    /// Returns true if the present choices are a valid answer.
    pub fn is_answered(&self) -> bool {
        match self {
            Self::Tracks(asked) => asked.chosen.contains(&true),
            Self::Stations(asked) => {
                are_different(&asked.stations)
                    && asked.stations.iter().all(|choice| *choice < asked.choices.len())
            }
            Self::Columns(asked) => asked.complaint().is_none(),
            Self::Files(asked) => !asked.targets.is_empty(),
            Self::Toml(_) => true,
        }
    }
}

impl AskedStations {
    /// Creates the question and proposes stations 1, 2, … in the natural order of the names.
    pub fn new(place: String, are: StationsAre, choices: Vec<(String, String)>) -> Self {
        Self { place, are, stations: in_natural_order(&choices), choices }
    }
}

impl AskedColumns {
    pub fn take_head(&mut self, head: TableHead) {
        if self.mapping == ColumnMapping::default() {
            self.mapping = mapped_csv::suggest(&head.text);
        }
        let stations = head.alike.len().min(USUAL_STATIONS);
        if self.mapping.station.is_none() && stations >= LEAST_FILES {
            let own = head.alike.iter().position(|name| self.path.ends_with(name));
            let first = own.unwrap_or(0).min(head.alike.len() - stations);
            self.files = Some((first..first + stations).collect());
        }
        self.preview = mapped_csv::preview(&head.text, &self.mapping);
        self.head = Some(head);
    }

    /// Returns the reason why the table cannot be opened with these choices.
    pub fn complaint(&self) -> Option<String> {
        if let Some(trouble) = &self.trouble {
            return Some(trouble.clone());
        }
        if self.head.is_none() {
            return Some("The file is being read…".to_owned());
        }
        if self.mapping.station.is_none() {
            match &self.files {
                None => {
                    return Some("Choose the station column, or one file per station.".to_owned());
                }
                Some(files) if !are_different(files) => {
                    return Some("Each station needs its own file.".to_owned());
                }
                Some(_) => {}
            }
        }
        if self.preview.read.is_empty() {
            return Some("The file has a header but no rows.".to_owned());
        }
        let error = self.preview.read.iter().find_map(|row| row.as_ref().err());
        error.map(|error| format!("The first rows cannot be read: {error}"))
    }
}

/// Fewest files with one header that are proposed as those of the stations.
pub const LEAST_FILES: usize = 2;

fn are_different(chosen: &[usize]) -> bool {
    chosen.iter().enumerate().all(|(place, own)| !chosen[..place].contains(own))
}

/// Returns the first choices in natural order, as many as there are usually stations: by the text and the numbers in their names.
fn in_natural_order(choices: &[(String, String)]) -> Vec<usize> {
    let key = |index: &usize| {
        let name = &choices[*index].0;
        let digits = |text: &str| text.chars().all(|c| c.is_ascii_digit());
        let mut parts: Vec<(u64, String)> = Vec::new();
        let mut rest = name.as_str();
        while let Some(first) = rest.chars().next() {
            let digit = first.is_ascii_digit();
            let end = rest.find(|c: char| c.is_ascii_digit() != digit).unwrap_or(rest.len());
            let (part, tail) = rest.split_at(end);
            let number = if digits(part) { part.parse().unwrap_or(u64::MAX) } else { 0 };
            parts.push((number, if digit { String::new() } else { part.to_owned() }));
            rest = tail;
        }
        parts
    };
    let mut order: Vec<usize> = (0..choices.len()).collect();
    order.sort_by_cached_key(key);
    order.truncate(USUAL_STATIONS);
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn topics_are_proposed_in_natural_order() {
        let topic = |name: &str| (name.to_owned(), String::new());
        let topics = ["/rts10/point", "/rts2/point", "/rts1/point"].map(topic);
        assert_eq!(in_natural_order(&topics), [2, 1, 0]);
        assert_eq!(in_natural_order(&topics[..1]), [0]);
    }
}
