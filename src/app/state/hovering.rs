//! Files that hover over the window: what they are is found out beside the worker, as for those that are dropped.

use std::path::PathBuf;

use super::State;
use resect_io::what_is::Sorted;

/// What hovered last.
#[derive(Debug, Default)]
pub struct Hovering {
    pub paths: Vec<PathBuf>,
    /// What they are, once that is known.
    pub sorted: Option<Sorted>,
    /// Number of the request that finds it out.
    asked: Option<u64>,
}

impl State {
    pub(super) fn hover_paths(&mut self, paths: Vec<PathBuf>) {
        self.look_at(paths.clone());
        self.hovering = Hovering { paths, sorted: None, asked: self.looking.last().copied() };
    }

    pub(super) fn is_of_hovering(&self, number: u64) -> bool {
        self.hovering.asked == Some(number)
    }

    pub(super) fn take_hovering(&mut self, number: u64, sorted: Sorted) {
        self.looking.retain(|looking| *looking != number);
        self.hovering.sorted = Some(sorted);
    }
}
