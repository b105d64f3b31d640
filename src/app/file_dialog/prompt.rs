//! State of the path dialog inside the window: plain data, changed by commands.

use std::path::{Component, MAIN_SEPARATOR, Path, PathBuf};

use super::{Entry, Listing, Question, Wanted};

/// A path that the user is choosing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PathPrompt {
    pub question: Question,
    /// The typed path: the folder shown, then a filter for its entries or a new file's name.
    pub text: String,
    folder: PathBuf,
    /// Base of a relative typed path: the folder shown when its typing began.
    starts_at: PathBuf,
    /// `None` until the folder has been read.
    listing: Option<Listing>,
    /// Index of the selected line among those shown.
    pub chosen: Option<usize>,
    /// Existing file for which the dialog asks permission to replace it.
    pub overwrite: Option<PathBuf>,
    /// Name of a folder to create, while it is typed.
    pub new_folder: Option<String>,
    /// Reason why the typed path was rejected.
    pub complaint: Option<String>,
    /// Shortcut folders with their names.
    pub places: Vec<(String, PathBuf)>,
}

/// An action of the user in the dialog.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PromptCommand {
    Type(String),
    GoTo(PathBuf),
    GoUp,
    /// Selects a line among those shown; `None` clears the selection.
    Choose(Option<usize>),
    /// Enter, or the button: accepts the selected line, or else the typed path.
    Accept,
    /// Accepts the folder shown, ignoring the selected line.
    AcceptFolder,
    Replace,
    KeepFile,
    /// Starts or edits the name of a new folder inside the folder shown.
    NameFolder(String),
    MakeFolder,
    MakeNoFolder,
    Cancel,
}

/// Result of an action.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PromptStep {
    Stay,
    /// The caller must read this folder and return it by [`PathPrompt::take`].
    Read(PathBuf),
    Chosen(PathBuf),
    Cancelled,
}

impl PathPrompt {
    /// Starts in a folder, which the caller must read. `recent`: places opened before, with their names.
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

    /// Takes the listing of a folder; ignores it if the dialog shows another folder by now.
    pub fn take(&mut self, listing: Listing) {
        if listing.folder == self.folder {
            self.listing = Some(listing);
        }
    }

    /// True while the folder is being read.
    pub fn is_reading(&self) -> bool {
        self.listing.is_none()
    }

    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Reason why the typed path was rejected, or why the folder cannot be shown.
    pub fn trouble(&self) -> Option<&str> {
        let listing = self.listing.as_ref()?;
        self.complaint.as_deref().or(listing.entries.as_ref().err().map(String::as_str))
    }

    /// Lines shown: entries of the folder whose names contain the typed text.
    pub fn shown(&self) -> Vec<&Entry> {
        let typed = self.typed_name().to_lowercase();
        let new = matches!(self.question.wanted, Wanted::NewFile { .. });
        let entries = self.listing.as_ref().and_then(|listing| listing.entries.as_ref().ok());
        let hidden = typed.starts_with('.');
        // A folder that does not exist has no entries.
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

    /// Carries out an action of the user.
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
                // A typed folder is accepted without the final separator as well.
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

    /// Returns true if the path is for writing, and its folder may not exist yet.
    pub fn saves(&self) -> bool {
        !matches!(self.question.wanted, Wanted::ToOpen { .. } | Wanted::Saved)
    }

    /// Creates the named folder and enters it, or shows a one-line reason for the failure.
    fn make_folder(&mut self) -> PromptStep {
        let name = self.new_folder.clone().unwrap_or_default();
        let path = self.folder.join(name.trim());
        let made = match Path::new(name.trim()).components().collect::<Vec<_>>()[..] {
            [Component::Normal(_)] => std::fs::create_dir(&path).map_err(|error| {
                format!("{}: {error}; choose another name or place", path.display())
            }),
            [] => Err("Type a name for the folder.".to_owned()),
            _ => Err(format!("{}: enter the name of one folder", name.trim())),
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
        if let Wanted::NewFile { name, .. } = &self.question.wanted {
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
        if let Wanted::NewFile { extension, .. } = &self.question.wanted {
            let mut typed = self.typed_path();
            // Adds the extension if there is none, because other programs identify files by it. An existing folder is entered instead.
            if typed.extension().is_none() && !self.typed_name().is_empty() && !typed.is_dir() {
                typed.set_extension(extension);
            }
            return self.take_file(typed);
        }
        let typed = self.typed_path();
        // "…/folder/" selects the folder itself; without the separator, the dialog enters it first.
        if typed == self.folder && self.typed_name().is_empty() {
            return match self.question.wanted {
                Wanted::Saved => PromptStep::Stay,
                _ => PromptStep::Chosen(typed),
            };
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
            Wanted::ToOpen { .. } | Wanted::Saved => PromptStep::Chosen(path),
            Wanted::Folder => PromptStep::Stay,
            Wanted::NewFile { .. } if path.is_dir() => self.go_to(path),
            Wanted::NewFile { .. }
                if path.file_name().is_none() || self.typed_name().is_empty() =>
            {
                self.complaint = Some("Type a name for the file.".to_owned());
                PromptStep::Stay
            }
            Wanted::NewFile { .. } if path.exists() => {
                self.overwrite = Some(path);
                PromptStep::Stay
            }
            Wanted::NewFile { .. } => match path.parent().map_or(Ok(()), std::fs::create_dir_all) {
                Ok(()) => PromptStep::Chosen(path),
                Err(error) => {
                    let complaint = format!("{}: no folder for it ({error})", path.display());
                    self.complaint = Some(complaint);
                    PromptStep::Stay
                }
            },
        }
    }

    /// The typed path up to the last separator.
    fn typed_folder(&self) -> PathBuf {
        let typed = self.typed_path();
        match typed.parent() {
            Some(parent) if !self.typed_name().is_empty() => parent.to_owned(),
            _ => typed,
        }
    }

    /// The typed text behind the last separator.
    pub fn typed_name(&self) -> &str {
        self.text.rsplit(std::path::is_separator).next().unwrap_or_default()
    }

    /// The typed path, relative to the folder in which its typing began unless it starts at the root or at home (`~`).
    fn typed_path(&self) -> PathBuf {
        let from_home = self
            .text
            .strip_prefix('~')
            .filter(|rest| rest.is_empty() || rest.starts_with(std::path::is_separator));
        let path = match (from_home, home()) {
            (Some(rest), Some(home)) => home.join(rest.trim_start_matches(std::path::is_separator)),
            _ => self.starts_at.join(&self.text),
        };
        // Collecting the components removes a final separator, so that paths compare equal.
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

/// Returns true if a typed path starts at the root or at home.
fn has_start(text: &str) -> bool {
    text.starts_with('~') || Path::new(text).has_root()
}

/// Keeps the text from the last `/` or `~/` that starts a new path typed behind an existing one.
fn from_the_last_start(text: String) -> String {
    let starts = text.match_indices("//").map(|(at, _)| at + 1);
    let homes = text.match_indices("/~/").map(|(at, _)| at + 1);
    match starts.chain(homes).max() {
        Some(at) if !cfg!(windows) => text[at..].to_owned(),
        _ => text,
    }
}

#[cfg(test)]
#[path = "prompt_tests.rs"]
mod tests;
