//! What the user is asked before the window goes on: what only he can tell of the data, what files are for, and whether
//! a file of his is changed.

use std::path::PathBuf;
use std::sync::Arc;

use resect_core::deployment::{AzimuthSense, ColumnMapping};
use resect_io::format::mapped_csv;
use resect_io::format::mapped_csv::Preview;
use resect_io::source::Extras;

/// What is asked, and what of the answer is chosen so far.
#[derive(Clone, Debug)]
pub enum Asked {
    Tracks(AskedTracks),
    Stations(AskedStations),
    Columns(Box<AskedColumns>),
    Files(Box<AskedFiles>),
    Toml(Box<AskedToml>),
}

/// How a question is answered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AskedAnswer {
    /// The question is answered by what is chosen.
    AsChosen,
    /// The files are not for a deployment that is open: they are one of their own.
    OwnDeployment,
}

/// Which of several files hold the tracks.
#[derive(Clone, Debug, PartialEq)]
pub struct AskedTracks {
    pub folder: String,
    pub files: Vec<String>,
    pub chosen: Vec<bool>,
}

/// Which topic, or which file, is which station.
#[derive(Clone, Debug, PartialEq)]
pub struct AskedStations {
    /// The bag, or the folder.
    pub place: String,
    pub are: StationsAre,
    /// Names of the topics or files, and what else is known of them.
    pub choices: Vec<(String, String)>,
    /// Index among the choices for each of stations 1, 2, 3.
    pub stations: [usize; 3],
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StationsAre {
    Topics,
    Files,
}

/// Which column of a table is what.
#[derive(Clone, Debug)]
pub struct AskedColumns {
    pub file: String,
    pub path: PathBuf,
    /// Number of the request that reads the beginning of the file.
    pub request: u64,
    /// The beginning of the file, once it is read.
    pub head: Option<TableHead>,
    /// Why it is not.
    pub trouble: Option<String>,
    pub mapping: ColumnMapping,
    pub azimuth: AzimuthSense,
    pub ranges_include_prism_constant: bool,
    /// Files of stations 1, 2, 3, where each has a file of its own: indices among [`TableHead::alike`].
    pub files: Option<[usize; 3]>,
    /// The first rows by the mapping.
    pub preview: Preview,
}

/// The beginning of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct TableHead {
    pub text: Arc<str>,
    /// Files of its folder with the same header, itself among them.
    pub alike: Vec<String>,
}

/// What a rig or control points are for.
#[derive(Clone, Debug, PartialEq)]
pub struct AskedFiles {
    pub extras: Extras,
    /// Folders that hold nothing but these extras.
    pub folders: Vec<PathBuf>,
    /// Ids and names of the deployments that they could be for.
    pub targets: Vec<(u64, String)>,
    /// Index of the chosen deployment among these.
    pub target: usize,
}

/// Whether this is written to the folder's `deployment.toml`.
#[derive(Clone, Debug, PartialEq)]
pub struct AskedToml {
    /// Number of the deployment.
    pub id: u64,
    pub path: PathBuf,
    /// What is in the file, if there is one.
    pub before: Option<String>,
    pub after: String,
    /// What changes, in words.
    pub said: Vec<String>,
    /// What the deployment is read with beside the file, once it is written.
    pub stays: Extras,
}

impl Asked {
    /// Whether what is chosen is an answer.
    pub fn is_answered(&self) -> bool {
        match self {
            Self::Tracks(asked) => asked.chosen.contains(&true),
            Self::Stations(asked) => {
                let [a, b, c] = asked.stations;
                a != b && a != c && b != c && a.max(b).max(c) < asked.choices.len()
            }
            Self::Columns(asked) => asked.complaint().is_none(),
            Self::Files(asked) => !asked.targets.is_empty(),
            Self::Toml(_) => true,
        }
    }
}

impl AskedStations {
    /// The question with a proposal: stations 1, 2, 3 in the order of the numbers in the names.
    pub fn new(place: String, are: StationsAre, choices: Vec<(String, String)>) -> Self {
        Self { place, are, stations: in_natural_order(&choices), choices }
    }
}

impl AskedColumns {
    pub fn take_head(&mut self, head: TableHead) {
        if self.mapping == ColumnMapping::default() {
            self.mapping = mapped_csv::suggest(&head.text);
        }
        if self.mapping.station.is_none() && head.alike.len() >= 3 {
            let own = head.alike.iter().position(|name| self.path.ends_with(name));
            let first = own.unwrap_or(0).min(head.alike.len() - 3);
            self.files = Some([first, first + 1, first + 2]);
        }
        self.preview = mapped_csv::preview(&head.text, &self.mapping);
        self.head = Some(head);
    }

    /// Why it cannot be opened like this.
    pub fn complaint(&self) -> Option<String> {
        if let Some(trouble) = &self.trouble {
            return Some(trouble.clone());
        }
        if self.head.is_none() {
            return Some("The file is being read…".to_owned());
        }
        if self.mapping.station.is_none() {
            match self.files {
                None => {
                    return Some("Name the column of the station, or a file for each.".to_owned());
                }
                Some([a, b, c]) if a == b || a == c || b == c => {
                    return Some("Each station needs a file of its own.".to_owned());
                }
                Some(_) => {}
            }
        }
        if self.preview.read.is_empty() {
            return Some("The file has a header but no row.".to_owned());
        }
        let error = self.preview.read.iter().find_map(|row| row.as_ref().err());
        error.map(|error| format!("The first rows do not read: {error}"))
    }
}

/// The first three by the text and the numbers in their names.
fn in_natural_order(choices: &[(String, String)]) -> [usize; 3] {
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
    std::array::from_fn(|station| order.get(station).copied().unwrap_or(0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn topics_are_proposed_in_natural_order() {
        let topic = |name: &str| (name.to_owned(), String::new());
        let topics = ["/rts10/point", "/rts2/point", "/rts1/point"].map(topic);
        assert_eq!(in_natural_order(&topics), [2, 1, 0]);
        assert_eq!(in_natural_order(&topics[..1]), [0, 0, 0]);
    }
}
