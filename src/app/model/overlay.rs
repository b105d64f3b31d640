//! What lies over the panes.

use resect_report::glossary::Term;

/// What lies over the panes and has the keyboard.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Overlay {
    #[default]
    None,
    Palette(Palette),
    Shortcuts,
    Glossary(Lookup),
}

/// The command palette.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Palette {
    pub query: String,
    /// Line among those found.
    pub chosen: usize,
}

/// What is looked up among the words of the field.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Lookup {
    pub query: String,
    /// Shown while nothing is typed; all words where there is none.
    pub of: Vec<&'static Term>,
}
