//! A request for a path.

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Question {
    pub title: String,
    pub wanted: Wanted,
    /// Kinds of files by which the system's dialog can filter: name and extensions.
    pub kinds: &'static [(&'static str, &'static [&'static str])],
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// An existing file or folder. The window's dialog accepts both; the system's dialog needs to know if it is a folder.
    ToOpen { folder: bool },
    /// A file saved by this program, such as a session or plan; the dialog starts in the folder of the last save.
    Saved,
    /// A folder to write into.
    Folder,
    /// A file to write, with a proposed name, and the extension added to a name without one.
    NewFile { name: String, extension: String },
}

impl Question {
    pub fn new(title: impl Into<String>, wanted: Wanted) -> Self {
        Self { title: title.into(), wanted, kinds: &[] }
    }

    pub fn kinds(self, kinds: &'static [(&'static str, &'static [&'static str])]) -> Self {
        Self { kinds, ..self }
    }

    /// A file to write, named after a deployment; characters invalid in file names are replaced.
    pub fn new_file(title: impl Into<String>, name: &str, extension: &str) -> Self {
        let name = name.replace(['/', '\\', ':'], "_");
        let name = format!("{name}.{extension}");
        Self::new(title, Wanted::NewFile { name, extension: extension.to_owned() })
    }
}
