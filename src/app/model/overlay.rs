//! What lies over the panes.

/// What lies over the panes and has the keyboard.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Overlay {
    #[default]
    None,
    Palette(Palette),
    Shortcuts,
}

/// The command palette.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Palette {
    pub query: String,
    /// Line among those found.
    pub chosen: usize,
}
