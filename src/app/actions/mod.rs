//! Everything that can be done by menu, palette or key, in one table: the menus, the command palette and the sheet
//! of shortcuts are all drawn from it, so that none of them can forget one.

mod action;
mod all_actions;
mod edit;
mod file;
mod help;
mod keys;
pub mod remedies;
mod time;
mod view;

pub use action::{Action, Menu};
pub use all_actions::{all, matching};
pub use keys::{from_keys, keys_in_words};
