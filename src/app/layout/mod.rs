//! Where the panes are: docked, split, tabbed and closed by the user, sized by the window until then.
//!
//! [`description`] is a layout as plain data, [`presets`] the ready-made ones; [`tree`] goes between descriptions and
//! the docking library, [`fit`] lets sizes follow the window, [`reopen`] brings closed panes back.

mod behaviour;
mod fit;
mod pane_layout;
mod reopen;
mod tree;

pub use pane_layout::Layout;
