//! The program's one font, for the window and for pictures.

/// Inter Regular (SIL Open Font License, see `assets/fonts/Inter-copyright.txt`).
pub static INTER: &[u8] = include_bytes!("../assets/fonts/Inter-Regular.otf");
