//! Questions to the user: facts about the data that no file contains, the purpose of files, and confirmation before a file is changed.

use std::path::{Path, PathBuf};

use super::State;
use super::corrections::one_or_many;
use super::deployments::Then;
use super::dialogs::PendingQuestion;
use crate::app::model::{
    Asked, AskedAnswer, AskedColumns, AskedFiles, AskedStations, AskedTracks, StationsAre,
    TableHead,
};
use resect_core::deployment::{AzimuthSense, ColumnMapping, Overrides};
use resect_io::error::{Question, Topic};
use resect_io::format::mapped_csv;
use resect_io::format::text_encoding::decode;
use resect_io::source::{Extras, Source};

/// Bytes read from the head of a file, more than the preview shows.
const HEAD_BYTES: u64 = 16 << 10;

impl State {
    pub(super) fn ask_user(&mut self, asked: Asked, reading: Option<(Source, Then)>) {
        self.dialogs.asked.push_back(PendingQuestion { asked, reading });
    }

    /// Asks a reader's question about a source, and opens the source with the answer.
    pub fn ask_of_data(&mut self, question: Question, source: Source) {
        let then = Then::Show(self.deployments.start_settings);
        self.ask_and_read(question, source, then);
    }

    /// Asks a reader's question, and continues the reading with the answer.
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
                let corrections = &source.extras.corrections;
                Asked::Columns(Box::new(AskedColumns {
                    file,
                    path,
                    request,
                    head: None,
                    trouble: None,
                    mapping: corrections.columns.clone().unwrap_or_default(),
                    azimuth: corrections.azimuth.unwrap_or_default(),
                    ranges_include_prism_constant: corrections
                        .ranges_include_prism_constant
                        .unwrap_or(false),
                    files: None,
                    preview: mapped_csv::preview("", &ColumnMapping::default()),
                }))
            }
        };
        self.ask_user(asked, Some((source, then)));
    }

    /// Asks for the deployment of a rig or control points that came without tracks.
    pub(super) fn ask_what_for(&mut self, extras: Extras, folders: Vec<PathBuf>) {
        // Further files are added to the pending question.
        for waiting in &mut self.dialogs.asked {
            if let Asked::Files(asked) = &mut waiting.asked {
                asked.extras.add(extras);
                asked.folders.extend(folders);
                return;
            }
        }
        let shown = self.active().map(|open| open.id);
        let targets: Vec<(u64, String)> =
            self.deployments.open.iter().map(|open| open.id).zip(self.names()).collect();
        let target = targets.iter().position(|(id, _)| Some(*id) == shown).unwrap_or(0);
        if targets.is_empty() && folders.is_empty() {
            let line = "no deployment is open for these files; open its tracks first";
            self.toasts.error(line);
            return;
        }
        let files = AskedFiles { extras, folders, targets, target };
        self.ask_user(Asked::Files(Box::new(files)), None);
    }

    /// Reads the head of a table in the background.
    fn read_head(&mut self, path: PathBuf) -> u64 {
        let number = self.jobs.start(move || read_head(&path), Self::take_head);
        self.path_requests.push(number);
        number
    }

    pub(super) fn take_head(&mut self, number: u64, head: Result<TableHead, String>) {
        self.path_requests.retain(|looking| *looking != number);
        let asked = self.dialogs.asked.iter_mut().find_map(|waiting| match &mut waiting.asked {
            Asked::Columns(asked) if asked.request == number => Some(asked),
            _ => None,
        });
        match (asked, head) {
            (Some(asked), Ok(head)) => asked.take_head(head),
            (Some(asked), Err(line)) => asked.trouble = Some(line),
            // The question was withdrawn.
            (None, _) => {}
        }
    }

    pub(super) fn edit_asked(&mut self, mut asked: Asked) {
        let Some(waiting) = self.dialogs.asked.front_mut() else { return };
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
        let Some(PendingQuestion { reading, .. }) = self.dialogs.asked.pop_front() else { return };
        if let Some((source, Then::Restore)) = reading {
            self.not_restored(&format!("{}: the question about it was cancelled", source.title()));
        }
    }

    /// Withdraws the questions about the session that is being restored.
    pub(super) fn ask_nothing_of_restoring(&mut self) {
        let of_restoring =
            |waiting: &PendingQuestion| matches!(waiting.reading, Some((_, Then::Restore)));
        self.dialogs.asked.retain(|waiting| !of_restoring(waiting));
    }

    pub(super) fn answer_asked(&mut self, answer: AskedAnswer) {
        if answer == AskedAnswer::AsChosen && self.asked().is_none_or(|asked| !asked.is_answered())
        {
            return;
        }
        let Some(PendingQuestion { asked, reading }) = self.dialogs.asked.pop_front() else {
            return;
        };
        let mut corrections = Overrides::default();
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
                corrections.tracks = Some(one_or_many(files.map(|(file, _)| file).collect()));
            }
            Asked::Stations(AskedStations { are, choices, stations, .. }) => {
                let names = stations.iter().map(|index| choices[*index].0.clone());
                match are {
                    StationsAre::Topics => corrections.topics = Some(names.collect()),
                    StationsAre::Files => corrections.tracks = Some(one_or_many(names.collect())),
                }
            }
            Asked::Columns(columns) => {
                let AskedColumns { mapping, azimuth, ranges_include_prism_constant, .. } =
                    &*columns;
                corrections.columns = Some(mapping.clone());
                corrections.azimuth =
                    Some(*azimuth).filter(|sense| *sense != AzimuthSense::default());
                corrections.ranges_include_prism_constant =
                    Some(*ranges_include_prism_constant).filter(|include| *include);
                if let (Some(head), Some(files)) = (&columns.head, &columns.files) {
                    let names = files.iter().map(|index| head.alike[*index].clone());
                    corrections.tracks = Some(one_or_many(names.collect()));
                }
            }
        }
        if let Some((mut source, then)) = reading {
            source.extras.add(Extras { corrections, ..Extras::default() });
            match then {
                Then::Restore => self.restore_with(source),
                then => self.read(source, then),
            }
        }
    }
}

fn read_head(path: &Path) -> Result<TableHead, String> {
    use std::io::Read;
    let head_of = |path: &Path| -> std::io::Result<String> {
        let mut bytes = Vec::new();
        let file = std::fs::File::open(path)?;
        let whole = file.metadata()?.len() <= HEAD_BYTES;
        file.take(HEAD_BYTES).read_to_end(&mut bytes)?;
        let text = decode(&bytes).into_owned();
        // Drops an incomplete last line.
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
