//! The terms of the field, each explained in a sentence or two. The window shows explanations beside the terms, and
//! `resect explain` prints them.
//!
//! [`terms`] is the list. Panes mark a term by its constant, so that every marked term has an explanation.

mod search;
mod term;
mod terms;

pub use search::{find, in_text, matching};
pub use term::{Term, title};
pub use terms::*;
