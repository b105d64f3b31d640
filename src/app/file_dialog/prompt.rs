//! The state of the dialog inside the window: plain data, changed by commands.

use std::path::{Component, MAIN_SEPARATOR, Path, PathBuf};

use super::{Entry, Listing, Question, Wanted};

/// A path being chosen.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PathPrompt {
    pub question: Question,
    /// The path as it is typed: the folder that is shown, then what its entries are filtered by, or a new file's name.
    pub text: String,
    folder: PathBuf,
    /// Where a path begins that is typed without a root: the folder that was shown when its typing began.
    starts_at: PathBuf,
    /// `None` until the folder has been read.
    listing: Option<Listing>,
    /// Line among those shown.
    pub chosen: Option<usize>,
    /// A file that is there already, while it is asked whether to replace it.
    pub overwrite: Option<PathBuf>,
    /// The name of a folder that is to be made, while it is typed.
    pub new_folder: Option<String>,
    /// Why what was typed cannot be taken.
    pub complaint: Option<String>,
    /// Folders to go to at once, with their names.
    pub places: Vec<(String, PathBuf)>,
}

/// What the user does to it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PromptCommand {
    Type(String),
    GoTo(PathBuf),
    GoUp,
    /// The line among those shown; none of them.
    Choose(Option<usize>),
    /// Enter, or the button: the chosen line, else what is typed.
    Accept,
    /// The folder that is shown, whatever line is chosen in it.
    AcceptFolder,
    Replace,
    KeepFile,
    /// A folder is to be made in the one that is shown, under this name so far.
    NameFolder(String),
    MakeFolder,
    MakeNoFolder,
    Cancel,
}

/// What becomes of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PromptStep {
    Stay,
    /// This folder is to be read, and handed back by [`PathPrompt::take`].
    Read(PathBuf),
    Chosen(PathBuf),
    Cancelled,
}

impl PathPrompt {
    /// Starts in a folder, which is to be read. `recent`: places opened before, with their names.
    pub fn new(
        question: Question,
        folder: PathBuf,
        recent: Vec<(String, PathBuf)>,
    ) -> (Self, PromptStep) {
        let mut places: Vec<(String, PathBuf)> = Vec::new();
        places.extend(home().map(|home| ("Home".to_owned(), home)));
        places.extend(recent);
        let mut prompt = Self {
            question,
            text: String::new(),
            folder: PathBuf::new(),
            starts_at: PathBuf::new(),
            listing: None,
            chosen: None,
            overwrite: None,
            new_folder: None,
            complaint: None,
            places,
        };
        let step = prompt.go_to(folder);
        (prompt, step)
    }

    /// What a folder holds, once it has been read.
    pub fn take(&mut self, listing: Listing) {
        if listing.folder == self.folder {
            self.listing = Some(listing);
        }
    }

    /// Whether the folder is still being read.
    pub fn is_reading(&self) -> bool {
        self.listing.is_none()
    }

    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Why the folder cannot be shown.
    pub fn trouble(&self) -> Option<&str> {
        let listing = self.listing.as_ref()?;
        self.complaint.as_deref().or(listing.entries.as_ref().err().map(String::as_str))
    }

    /// The lines: what is in the folder and has what is typed in its name.
    pub fn shown(&self) -> Vec<&Entry> {
        let typed = self.typed_name().to_lowercase();
        let new = matches!(self.question.wanted, Wanted::NewFile { .. });
        let entries = self.listing.as_ref().and_then(|listing| listing.entries.as_ref().ok());
        let hidden = typed.starts_with('.');
        // In a folder that is not there, nothing is.
        let here = new || self.typed_folder() == self.folder;
        entries
            .into_iter()
            .flatten()
            .filter(|_| here)
            .filter(|entry| hidden || !entry.name.starts_with('.'))
            .filter(|entry| new || entry.name.to_lowercase().contains(&typed))
            .filter(|entry| entry.is_folder || self.question.wanted != Wanted::Folder)
            .collect()
    }

    /// Does what the user asks.
    pub fn handle(&mut self, command: PromptCommand) -> PromptStep {
        self.complaint = None;
        match command {
            PromptCommand::Type(text) => self.type_text(text),
            PromptCommand::GoTo(folder) => self.go_to(folder),
            PromptCommand::GoUp => match self.folder.parent() {
                Some(parent) => self.go_to(parent.to_owned()),
                None => PromptStep::Stay,
            },
            PromptCommand::Choose(line) => {
                self.chosen = line.filter(|line| *line < self.shown().len());
                PromptStep::Stay
            }
            PromptCommand::Accept => self.accept(),
            PromptCommand::AcceptFolder => {
                // A folder that is typed without the last separator is meant itself.
                let typed = self.typed_path();
                PromptStep::Chosen(if typed.is_dir() { typed } else { self.folder.clone() })
            }
            PromptCommand::Replace => {
                self.overwrite.take().map_or(PromptStep::Stay, PromptStep::Chosen)
            }
            PromptCommand::KeepFile => {
                self.overwrite = None;
                PromptStep::Stay
            }
            PromptCommand::NameFolder(name) => {
                self.new_folder = Some(name);
                PromptStep::Stay
            }
            PromptCommand::MakeFolder => self.make_folder(),
            PromptCommand::MakeNoFolder => {
                self.new_folder = None;
                PromptStep::Stay
            }
            PromptCommand::Cancel => PromptStep::Cancelled,
        }
    }

    /// Whether something is to be written, perhaps into a folder that is not there yet.
    pub fn saves(&self) -> bool {
        !matches!(self.question.wanted, Wanted::ToOpen { .. })
    }

    /// Makes the folder that was named and goes into it, or says in one line why not.
    fn make_folder(&mut self) -> PromptStep {
        let name = self.new_folder.clone().unwrap_or_default();
        let path = self.folder.join(name.trim());
        let made = match Path::new(name.trim()).components().collect::<Vec<_>>()[..] {
            [Component::Normal(_)] => std::fs::create_dir(&path).map_err(|error| {
                format!("{}: {error}; choose another name or place", path.display())
            }),
            [] => Err("Type a name for the folder.".to_owned()),
            _ => Err(format!("{}: a name of one folder is wanted", name.trim())),
        };
        if let Err(complaint) = made {
            self.complaint = Some(complaint);
            return PromptStep::Stay;
        }
        self.new_folder = None;
        let file = self.typed_name().to_owned();
        let step = self.go_to(path);
        if let Wanted::NewFile { .. } = self.question.wanted {
            self.text = with_separator(&self.folder) + &file;
        }
        step
    }

    fn type_text(&mut self, text: String) -> PromptStep {
        let goes_on = !self.text.is_empty() && !text.is_empty() && !has_start(&self.text);
        if !goes_on {
            self.starts_at.clone_from(&self.folder);
        }
        self.text = from_the_last_start(text);
        self.chosen = None;
        let folder = self.typed_folder();
        if folder == self.folder || !folder.is_dir() {
            return PromptStep::Stay;
        }
        self.show(folder)
    }

    fn go_to(&mut self, folder: PathBuf) -> PromptStep {
        // Recent places may be files.
        let folder = match folder.parent() {
            Some(parent) if folder.is_file() => parent.to_owned(),
            _ => folder,
        };
        self.text = with_separator(&folder);
        if let Wanted::NewFile { name } = &self.question.wanted {
            self.text += name;
        }
        self.starts_at.clone_from(&folder);
        self.show(folder)
    }

    fn show(&mut self, folder: PathBuf) -> PromptStep {
        self.chosen = None;
        self.listing = None;
        self.folder.clone_from(&folder);
        PromptStep::Read(folder)
    }

    fn accept(&mut self) -> PromptStep {
        let shown = self.shown();
        if let Some(entry) = self.chosen.and_then(|line| shown.get(line)) {
            let path = self.folder.join(&entry.name);
            return if entry.is_folder { self.go_to(path) } else { self.take_file(path) };
        }
        if let Wanted::NewFile { .. } = self.question.wanted {
            return self.take_file(self.typed_path());
        }
        let typed = self.typed_path();
        // "…/folder/" is the folder itself; without the separator one looks into it first.
        if typed == self.folder && self.typed_name().is_empty() {
            return PromptStep::Chosen(typed);
        }
        if typed.is_dir() {
            return self.go_to(typed);
        }
        if typed.is_file() {
            return self.take_file(typed);
        }
        match shown[..] {
            [only] => {
                let path = self.folder.join(&only.name);
                if only.is_folder { self.go_to(path) } else { self.take_file(path) }
            }
            [] => {
                self.complaint = Some(format!("{}: there is no such file or folder", self.text));
                PromptStep::Stay
            }
            _ => {
                self.chosen = Some(0);
                PromptStep::Stay
            }
        }
    }

    fn take_file(&mut self, path: PathBuf) -> PromptStep {
        match self.question.wanted {
            Wanted::ToOpen { .. } => PromptStep::Chosen(path),
            Wanted::Folder => PromptStep::Stay,
            Wanted::NewFile { .. } if path.is_dir() => self.go_to(path),
            Wanted::NewFile { .. }
                if path.file_name().is_none() || self.typed_name().is_empty() =>
            {
                self.complaint = Some("Type a name for the file.".to_owned());
                PromptStep::Stay
            }
            Wanted::NewFile { .. } if !path.parent().is_some_and(Path::is_dir) => {
                self.complaint = Some(format!("{}: there is no such folder", path.display()));
                PromptStep::Stay
            }
            Wanted::NewFile { .. } if path.exists() => {
                self.overwrite = Some(path);
                PromptStep::Stay
            }
            Wanted::NewFile { .. } => PromptStep::Chosen(path),
        }
    }

    /// What is typed up to the last separator.
    fn typed_folder(&self) -> PathBuf {
        let typed = self.typed_path();
        match typed.parent() {
            Some(parent) if !self.typed_name().is_empty() => parent.to_owned(),
            _ => typed,
        }
    }

    /// What is typed behind the last separator.
    fn typed_name(&self) -> &str {
        self.text.rsplit(std::path::is_separator).next().unwrap_or_default()
    }

    /// What is typed as a path: from the folder where its typing began, unless it starts at the root or at home (`~`).
    fn typed_path(&self) -> PathBuf {
        let from_home = self
            .text
            .strip_prefix('~')
            .filter(|rest| rest.is_empty() || rest.starts_with(std::path::is_separator));
        let path = match (from_home, home()) {
            (Some(rest), Some(home)) => home.join(rest.trim_start_matches(std::path::is_separator)),
            _ => self.starts_at.join(&self.text),
        };
        // Without a separator at its end, so that it compares.
        path.components().collect()
    }
}

fn with_separator(folder: &Path) -> String {
    let mut text = folder.display().to_string();
    if !text.ends_with(std::path::is_separator) {
        text.push(MAIN_SEPARATOR);
    }
    text
}

fn home() -> Option<PathBuf> {
    directories::BaseDirs::new().map(|folders| folders.home_dir().to_owned())
}

/// Whether a typed path starts at the root or at home.
fn has_start(text: &str) -> bool {
    text.starts_with('~') || Path::new(text).has_root()
}

/// A path typed behind the one that stands there begins anew at its own `/` or `~/`.
fn from_the_last_start(text: String) -> String {
    let starts = text.match_indices("//").map(|(at, _)| at + 1);
    let homes = text.match_indices("/~/").map(|(at, _)| at + 1);
    match starts.chain(homes).max() {
        Some(at) if !cfg!(windows) => text[at..].to_owned(),
        _ => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Desk {
        folder: tempfile::TempDir,
        prompt: PathPrompt,
    }

    impl Desk {
        fn new(wanted: Wanted) -> Self {
            let folder = tempfile::tempdir().expect("a folder");
            std::fs::create_dir_all(folder.path().join("field/day 1")).expect("writable");
            let tracks = "timestamp,id,distance,ha,va\n0.0,1,10,0.1,1.5\n";
            std::fs::write(folder.path().join("field/tracks.csv"), tracks).expect("writable");
            std::fs::write(folder.path().join("field/notes.txt"), "rain\n").expect("writable");
            std::fs::write(folder.path().join("field/.hidden"), "").expect("writable");
            let question = Question::new("Open", wanted);
            let (prompt, step) = PathPrompt::new(question, folder.path().join("field"), vec![]);
            let mut desk = Self { folder, prompt };
            desk.follow(step);
            desk
        }

        fn path(&self, name: &str) -> PathBuf {
            self.folder.path().join(name)
        }

        /// Reads what is to be read.
        fn follow(&mut self, step: PromptStep) -> PromptStep {
            if let PromptStep::Read(folder) = &step {
                assert!(self.prompt.is_reading());
                self.prompt.take(Listing::read(folder));
            }
            step
        }

        fn handle(&mut self, command: PromptCommand) -> PromptStep {
            let step = self.prompt.handle(command);
            self.follow(step)
        }

        fn enter(&mut self, text: &str) -> PromptStep {
            self.handle(PromptCommand::Type(text.to_owned()));
            self.handle(PromptCommand::Accept)
        }

        fn names(&self) -> Vec<(&str, &str)> {
            self.prompt.shown().iter().map(|e| (e.name.as_str(), e.what)).collect()
        }
    }

    #[test]
    fn folders_come_first_and_files_say_what_they_are() {
        let mut desk = Desk::new(Wanted::ToOpen { folder: true });
        assert_eq!(desk.names(), [("day 1", ""), ("notes.txt", ""), ("tracks.csv", "deployment")]);
        let text = desk.prompt.text.clone();
        desk.handle(PromptCommand::Type(format!("{text}TRACK")));
        assert_eq!(desk.names(), [("tracks.csv", "deployment")]);
        // What is left is what is meant.
        let tracks = desk.path("field/tracks.csv");
        assert_eq!(desk.handle(PromptCommand::Accept), PromptStep::Chosen(tracks));
        desk.handle(PromptCommand::Type(format!("{text}.h")));
        assert_eq!(desk.names(), [(".hidden", "")]);
    }

    #[test]
    fn a_folder_is_entered_and_then_taken() {
        let mut desk = Desk::new(Wanted::ToOpen { folder: true });
        let day = desk.path("field/day 1");
        desk.handle(PromptCommand::Choose(Some(0)));
        assert_eq!(desk.handle(PromptCommand::Accept), PromptStep::Read(day.clone()));
        assert_eq!(desk.handle(PromptCommand::Accept), PromptStep::Chosen(day));
        desk.handle(PromptCommand::GoUp);
        desk.handle(PromptCommand::GoUp);
        assert_eq!(desk.prompt.folder(), desk.folder.path());
        // Typed from here, as in a shell.
        let field = desk.path("field");
        assert_eq!(desk.enter("field"), PromptStep::Read(field));
        assert_eq!(desk.enter("nowhere/x"), PromptStep::Stay);
        assert!(desk.prompt.trouble().is_some_and(|why| why.contains("nowhere/x")));
    }

    #[test]
    fn a_path_without_a_root_is_followed_as_it_is_typed() {
        let mut desk = Desk::new(Wanted::ToOpen { folder: true });
        desk.handle(PromptCommand::GoUp);
        let step = desk.handle(PromptCommand::Type("field/".to_owned()));
        assert_eq!(step, PromptStep::Read(desk.path("field")));
        assert_eq!(desk.names(), [("day 1", ""), ("notes.txt", ""), ("tracks.csv", "deployment")]);
        desk.handle(PromptCommand::Type("field/tr".to_owned()));
        assert_eq!(desk.names(), [("tracks.csv", "deployment")]);
        assert_eq!(desk.enter("field/day 1/"), PromptStep::Chosen(desk.path("field/day 1")));
        // Once it is taken away, one is still there, and the next begins there.
        desk.handle(PromptCommand::Type(String::new()));
        assert_eq!(desk.prompt.folder(), desk.path("field/day 1"));
        assert_eq!(desk.enter("../tr"), PromptStep::Chosen(desk.path("field/day 1/../tracks.csv")));
    }

    #[test]
    fn a_file_that_is_there_is_not_replaced_unasked() {
        let mut desk = Desk::new(Wanted::NewFile { name: "run.html".to_owned() });
        let fresh = desk.path("field/run.html");
        assert_eq!(desk.handle(PromptCommand::Accept), PromptStep::Chosen(fresh));
        let notes = desk.path("field/notes.txt");
        let typed = notes.display().to_string();
        assert_eq!(desk.enter(&typed), PromptStep::Stay);
        assert_eq!(desk.prompt.overwrite.as_ref(), Some(&notes));
        desk.handle(PromptCommand::KeepFile);
        assert_eq!(desk.prompt.overwrite, None);
        desk.handle(PromptCommand::Accept);
        assert_eq!(desk.handle(PromptCommand::Replace), PromptStep::Chosen(notes));
        let nowhere = desk.path("gone/x.html").display().to_string();
        assert_eq!(desk.enter(&nowhere), PromptStep::Stay);
        assert!(desk.prompt.trouble().is_some_and(|why| why.contains("no such folder")));
    }

    #[test]
    fn a_folder_is_made_where_something_is_saved() {
        let mut desk = Desk::new(Wanted::NewFile { name: "run.html".to_owned() });
        let typed = desk.path("field/other.html").display().to_string();
        desk.handle(PromptCommand::Type(typed));
        for (name, said) in
            [("", "Type a name"), ("day 1", "exists"), ("a/b", "one folder"), ("..", "one")]
        {
            desk.handle(PromptCommand::NameFolder(name.to_owned()));
            assert_eq!(desk.handle(PromptCommand::MakeFolder), PromptStep::Stay);
            let complaint = desk.prompt.complaint.clone().expect("refused");
            assert!(complaint.contains(said) && complaint.lines().count() == 1, "{complaint}");
        }
        let made = desk.path("field/day 2");
        desk.handle(PromptCommand::NameFolder(" day 2 ".to_owned()));
        assert_eq!(desk.handle(PromptCommand::MakeFolder), PromptStep::Read(made.clone()));
        assert!(made.is_dir());
        // The name that was typed for the file stays.
        let chosen = PromptStep::Chosen(made.join("other.html"));
        assert_eq!(desk.handle(PromptCommand::Accept), chosen);
    }

    #[test]
    fn what_was_read_too_late_is_dropped() {
        let mut desk = Desk::new(Wanted::Folder);
        assert_eq!(desk.names(), [("day 1", "")], "only folders can be written into");
        let old = Listing::read(&desk.path("field"));
        assert!(matches!(desk.prompt.handle(PromptCommand::GoUp), PromptStep::Read(_)));
        desk.prompt.take(old);
        assert!(desk.prompt.is_reading());
    }
}
