//! Sizes of text and margins.

/// Text sizes on a medium canvas; everything else is relative to them.
pub const LABEL: f32 = 11.5;
pub const SMALL: f32 = 9.5;
pub const TITLE: f32 = 15.0;
pub const MARGIN: f32 = 12.0;
/// Room for the number above the highest whisker.
pub const HEADROOM: f32 = 20.0;
