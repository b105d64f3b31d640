//! A question for a path.

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Question {
    pub title: String,
    pub wanted: Wanted,
    /// Kinds of file that the system's dialog offers to show alone: name and extensions.
    pub kinds: &'static [(&'static str, &'static [&'static str])],
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// Something that is there. In the window it may be either; the system's dialog must know whether it is a folder.
    ToOpen { folder: bool },
    /// A file that was saved from here, as sessions and plans are: it is looked for where files were saved last.
    Saved,
    /// A folder to write into.
    Folder,
    /// A file to write, with the name that is proposed, and what is put behind a name that is typed without any ending.
    NewFile { name: String, extension: String },
}

impl Question {
    pub fn new(title: impl Into<String>, wanted: Wanted) -> Self {
        Self { title: title.into(), wanted, kinds: &[] }
    }

    pub fn kinds(self, kinds: &'static [(&'static str, &'static [&'static str])]) -> Self {
        Self { kinds, ..self }
    }

    /// A file to write, named after a deployment, which may be called anything.
    pub fn new_file(title: impl Into<String>, name: &str, extension: &str) -> Self {
        let name = name.replace(['/', '\\', ':'], "_");
        let name = format!("{name}.{extension}");
        Self::new(title, Wanted::NewFile { name, extension: extension.to_owned() })
    }
}
