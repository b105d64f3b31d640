//! Overlays above the panes.

use std::sync::Arc;

use super::PictureOrder;
use resect_report::glossary::Term;

/// The overlay above the panes, which receives the keyboard input.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Overlay {
    #[default]
    None,
    Palette(Palette),
    Shortcuts,
    Glossary(Lookup),
    /// The lines of all licences.
    Licences(Arc<[String]>),
    /// The question before the window closes.
    Closing,
    /// Size, scale and format of a picture.
    Picture(PictureOrder),
}

/// The command palette.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Palette {
    pub query: String,
    /// Index of the selected line among the matches.
    pub chosen: usize,
}

/// A search in the glossary.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Lookup {
    pub query: String,
    /// Terms to show while the query is empty; empty for all terms.
    pub of: Vec<&'static Term>,
}
