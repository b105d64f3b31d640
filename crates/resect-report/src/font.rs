//! The program's fonts, for the window and for pictures.

/// Inter Regular (SIL Open Font License, see `assets/fonts/Inter-copyright.txt`).
pub static INTER: &[u8] = include_bytes!("../assets/fonts/Inter-Regular.otf");

/// Inter's tabular figures with their plain zero, as wide as the monospaced letters beside them; made by
/// `assets/fonts/figures.py`, under Inter's licence.
pub static FIGURES: &[u8] = include_bytes!("../assets/fonts/Figures-Regular.otf");
