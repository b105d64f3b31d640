//! What the user is asked before the window goes on: what only he can tell of the data, what files are for, and whether
//! a file of his is changed.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::State;
use super::opening::Then;
use super::put_right::one_or_many;
use crate::app::worker::Reply;
use crate::deployment::format::mapped_csv::{self, Preview};
use crate::deployment::{AzimuthSense, ColumnMapping, Extras, Overrides, Question, Source, Topic};

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
    /// By what is chosen.
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
    /// Their names, and what else is known of them.
    pub choices: Vec<(String, String)>,
    /// For stations 1, 2, 3 the index among the choices.
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
    request: u64,
    /// The beginning of the file, once it is read.
    pub head: Option<TableHead>,
    /// Why it is not.
    pub trouble: Option<String>,
    pub mapping: ColumnMapping,
    pub azimuth: AzimuthSense,
    pub ranges_include_prism_constant: bool,
    /// Where each station has a file of its own, which they are: indices among [`TableHead::alike`].
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
    /// They are all that is in these.
    pub folders: Vec<PathBuf>,
    /// Ids and names of the deployments that they could be for.
    pub targets: Vec<(u64, String)>,
    /// Index among them.
    pub target: usize,
}

/// Whether this is written to the folder's `deployment.toml`.
#[derive(Clone, Debug, PartialEq)]
pub struct AskedToml {
    /// Of the deployment.
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

/// What is asked, and the reading that goes on with the answer.
pub(super) struct Waiting {
    pub asked: Asked,
    reading: Option<(Source, Then)>,
}

/// More of a file than the preview shows.
const HEAD_BYTES: u64 = 16 << 10;

impl State {
    pub(super) fn ask_user(&mut self, asked: Asked, reading: Option<(Source, Then)>) {
        self.asked.push_back(Waiting { asked, reading });
    }

    /// Asks what a reader could not know of a source, and opens it with the answer.
    pub fn ask_of_data(&mut self, question: Question, source: Source) {
        let then = Then::Show(self.start_settings);
        self.ask_and_read(question, source, then);
    }

    /// The same, and goes on as was meant.
    pub(super) fn ask_and_read(&mut self, question: Question, source: Source, then: Then) {
        let asked = match question {
            Question::Tracks { folder, files } => {
                let chosen = vec![false; files.len()];
                Asked::Tracks(AskedTracks { folder, files, chosen })
            }
            Question::Topics { file, topics } => {
                let choice = |topic: Topic| {
                    let Topic { name, message_type, messages } = topic;
                    (name, format!("{message_type}, {messages} messages"))
                };
                let choices = topics.into_iter().map(choice).collect();
                Asked::Stations(AskedStations::new(file, StationsAre::Topics, choices))
            }
            Question::StationFiles { folder, files } => {
                let choices = files.into_iter().map(|file| (file, String::new())).collect();
                Asked::Stations(AskedStations::new(folder, StationsAre::Files, choices))
            }
            Question::Columns { file, path, .. } => {
                let request = self.read_head(path.clone());
                let put_right = &source.extras.put_right;
                Asked::Columns(Box::new(AskedColumns {
                    file,
                    path,
                    request,
                    head: None,
                    trouble: None,
                    mapping: put_right.columns.clone().unwrap_or_default(),
                    azimuth: put_right.azimuth.unwrap_or_default(),
                    ranges_include_prism_constant: put_right
                        .ranges_include_prism_constant
                        .unwrap_or(false),
                    files: None,
                    preview: mapped_csv::preview("", &ColumnMapping::default()),
                }))
            }
        };
        self.ask_user(asked, Some((source, then)));
    }

    /// Asks what a rig or control points are for that came without tracks.
    pub(super) fn ask_what_for(&mut self, extras: Extras, folders: Vec<PathBuf>) {
        // What comes while it is asked is for the same.
        for waiting in &mut self.asked {
            if let Asked::Files(asked) = &mut waiting.asked {
                asked.extras.add(extras);
                asked.folders.extend(folders);
                return;
            }
        }
        let shown = self.active().map(|open| open.id);
        let targets: Vec<(u64, String)> =
            self.open.iter().map(|open| (open.id, open.deployment.name.clone())).collect();
        let target = targets.iter().position(|(id, _)| Some(*id) == shown).unwrap_or(0);
        if targets.is_empty() && folders.is_empty() {
            let line = "these files describe a deployment, but none is open; open its tracks first";
            self.toasts.error(line);
            return;
        }
        let files = AskedFiles { extras, folders, targets, target };
        self.ask_user(Asked::Files(Box::new(files)), None);
    }

    /// Reads the beginning of a table beside the worker.
    fn read_head(&mut self, path: PathBuf) -> u64 {
        let number = self.worker.numbered(Reply::HeadRead, move || read_head(&path));
        self.looking.push(number);
        number
    }

    pub(super) fn take_head(&mut self, number: u64, head: Result<TableHead, String>) {
        self.looking.retain(|looking| *looking != number);
        let asked = self.asked.iter_mut().find_map(|waiting| match &mut waiting.asked {
            Asked::Columns(asked) if asked.request == number => Some(asked),
            _ => None,
        });
        match (asked, head) {
            (Some(asked), Ok(head)) => asked.take_head(head),
            (Some(asked), Err(line)) => asked.trouble = Some(line),
            // It is no longer asked.
            (None, _) => {}
        }
    }

    pub(super) fn edit_asked(&mut self, mut asked: Asked) {
        let Some(waiting) = self.asked.front_mut() else { return };
        if let Asked::Columns(columns) = &mut asked
            && let Some(head) = &columns.head
        {
            if let Asked::Columns(before) = &waiting.asked {
                mapped_csv::suggest_meanings(&head.text, &before.mapping, &mut columns.mapping);
            }
            columns.preview = mapped_csv::preview(&head.text, &columns.mapping);
        }
        waiting.asked = asked;
    }

    pub(super) fn cancel_asked(&mut self) {
        self.asked.pop_front();
    }

    pub(super) fn answer_asked(&mut self, answer: AskedAnswer) {
        if answer == AskedAnswer::AsChosen && self.asked().is_none_or(|asked| !asked.is_answered())
        {
            return;
        }
        let Some(Waiting { asked, reading }) = self.asked.pop_front() else { return };
        let mut put_right = Overrides::default();
        match asked {
            Asked::Toml(proposed) => self.write_deployment_toml(proposed),
            Asked::Files(files) => match answer {
                AskedAnswer::AsChosen => {
                    if let Some((id, _)) = files.targets.get(files.target) {
                        self.add_files(*id, files.extras);
                    }
                }
                AskedAnswer::OwnDeployment => {
                    for folder in files.folders {
                        self.open_source(Source::at(folder));
                    }
                }
            },
            Asked::Tracks(AskedTracks { files, chosen, .. }) => {
                let files = files.into_iter().zip(chosen).filter(|(_, chosen)| *chosen);
                put_right.tracks = Some(one_or_many(files.map(|(file, _)| file).collect()));
            }
            Asked::Stations(AskedStations { are, choices, stations, .. }) => {
                let names = stations.map(|index| choices[index].0.clone());
                match are {
                    StationsAre::Topics => put_right.topics = Some(names),
                    StationsAre::Files => put_right.tracks = Some(one_or_many(names.to_vec())),
                }
            }
            Asked::Columns(columns) => {
                let AskedColumns { mapping, azimuth, ranges_include_prism_constant, .. } =
                    &*columns;
                put_right.columns = Some(mapping.clone());
                put_right.azimuth =
                    Some(*azimuth).filter(|sense| *sense != AzimuthSense::default());
                put_right.ranges_include_prism_constant =
                    Some(*ranges_include_prism_constant).filter(|include| *include);
                if let (Some(head), Some(files)) = (&columns.head, columns.files) {
                    let names = files.map(|index| head.alike[index].clone());
                    put_right.tracks = Some(one_or_many(names.to_vec()));
                }
            }
        }
        if let Some((mut source, then)) = reading {
            source.extras.add(Extras { put_right, ..Extras::default() });
            self.read(source, then);
        }
    }
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
    /// With a proposal: stations 1, 2, 3 in the order of the numbers in the names.
    fn new(place: String, are: StationsAre, choices: Vec<(String, String)>) -> Self {
        Self { place, are, stations: in_natural_order(&choices), choices }
    }
}

impl AskedColumns {
    fn take_head(&mut self, head: TableHead) {
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

fn read_head(path: &Path) -> Result<TableHead, String> {
    use std::io::Read;
    let head_of = |path: &Path| -> std::io::Result<String> {
        let mut bytes = Vec::new();
        let file = std::fs::File::open(path)?;
        let whole = file.metadata()?.len() <= HEAD_BYTES;
        file.take(HEAD_BYTES).read_to_end(&mut bytes)?;
        let text = String::from_utf8_lossy(&bytes).into_owned();
        // Half a line is no row.
        let end =
            if whole { text.len() } else { text.rfind('\n').map_or(text.len(), |end| end + 1) };
        Ok(text[..end].to_owned())
    };
    let text = head_of(path).map_err(|error| {
        format!("{}: {error}; check the path and its permissions", path.display())
    })?;
    let header = text.lines().next().unwrap_or_default().to_owned();
    let folder = path.parent().unwrap_or(Path::new("."));
    let mut alike: Vec<String> = std::fs::read_dir(folder)
        .into_iter()
        .flatten()
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| path.is_file() && path.extension().is_some())
        .filter(|path| head_of(path).is_ok_and(|text| text.lines().next() == Some(&header)))
        .filter_map(|path| Some(path.file_name()?.to_str()?.to_owned()))
        .collect();
    alike.sort();
    Ok(TableHead { text: text.into(), alike })
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

    #[test]
    fn the_beginning_of_a_table_has_whole_lines_and_knows_its_likes() {
        let folder = tempfile::tempdir().expect("a folder");
        let long = format!("t,d\n{}", "1.0,2.0\n".repeat(4000));
        for (name, text) in [("a.csv", long.as_str()), ("b.csv", "t,d\n1,2\n"), ("c.csv", "x\n")] {
            std::fs::write(folder.path().join(name), text).expect("written");
        }
        let head = read_head(&folder.path().join("a.csv")).expect("readable");
        assert_eq!(head.alike, ["a.csv", "b.csv"]);
        assert!(head.text.ends_with("1.0,2.0\n") && head.text.len() as u64 <= HEAD_BYTES);
        assert!(read_head(&folder.path().join("none.csv")).is_err());
    }
}
