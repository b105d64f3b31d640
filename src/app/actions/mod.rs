//! Table of all actions of menus and keys. The menus, the command palette and the shortcut sheet are all drawn from it, so
//! that none is incomplete.

mod action;
mod all_actions;
mod edit;
mod file;
mod help;
mod keys;
pub mod remedies;
mod settings;
mod time;
mod view;

pub use action::{Action, Menu};
pub use all_actions::{all, matching};
pub use file::solved_together;
pub use keys::{from_keys, keys_in_words};
