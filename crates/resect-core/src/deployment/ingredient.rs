use std::path::PathBuf;

/// A file that was looked at, and what became of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ingredient {
    /// Relative to the folder.
    pub file: String,
    /// Where it lies; `None` of what was never a file.
    pub path: Option<PathBuf>,
    /// What it holds, or why it was passed over.
    pub what: &'static str,
    pub used: bool,
}
