//! Asks for a path: by the system's dialog if there is one ([`system`], and on Linux `linux.rs` finds out), otherwise inside the window ([`PathPrompt`], drawn by
//! `panels/path_prompt.rs`). Both answer the same [`Question`].

mod answer;
#[cfg(target_os = "linux")]
mod linux;
mod listing;
mod prompt;
mod question;
pub mod system;

pub use answer::Answer;
pub use listing::{Entry, Listing};
pub use prompt::{PathPrompt, PromptCommand, PromptStep};
pub use question::{Question, Wanted};
