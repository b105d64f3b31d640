//! The words of this field, each explained in a sentence or two: the window shows them where they stand, and `resect explain`
//! prints them.
//!
//! [`terms`] is the list. Panes mark a word by its constant, so that no word that is marked can lack its explanation.

mod search;
mod term;
mod terms;

pub use search::{find, in_text, matching};
pub use term::{Term, title};
pub use terms::*;
