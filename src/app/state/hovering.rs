//! Files that hover over the window; their kinds are determined in the background, as for dropped files.

use std::path::PathBuf;

use super::State;
use super::dialogs::Hovering;
use resect_io::what_is::Sorted;

impl State {
    pub(super) fn hover_paths(&mut self, paths: Vec<PathBuf>) {
        self.look_at(paths.clone());
        self.dialogs.hovering =
            Hovering { paths, sorted: None, asked: self.path_requests.last().copied() };
    }

    pub(super) fn is_of_hovering(&self, number: u64) -> bool {
        self.dialogs.hovering.asked == Some(number)
    }

    pub(super) fn take_hovering(&mut self, number: u64, sorted: Sorted) {
        self.path_requests.retain(|looking| *looking != number);
        self.dialogs.hovering.sorted = Some(sorted);
    }
}
