use std::path::PathBuf;

/// A file of the folder, and its use.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ingredient {
    /// Relative to the folder.
    pub file: String,
    /// Path on disk; `None` for data that was never a file.
    pub path: Option<PathBuf>,
    /// Content in words, or the reason why it was not used.
    pub what: &'static str,
    pub used: bool,
}
