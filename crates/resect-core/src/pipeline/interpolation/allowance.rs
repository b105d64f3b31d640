//! The work that a search for hyper-parameters is expected to take.

use std::cell::Cell;

use crate::progress::{Cancelled, Progress};

/// What a search is taken to cost, in readings looked at: how often it will look, nobody knows beforehand.
pub struct Allowance<'a> {
    progress: &'a Progress,
    left: Cell<u64>,
}

impl<'a> Allowance<'a> {
    /// Tells `progress` of a search through so many readings.
    pub fn new(progress: &'a Progress, readings: usize) -> Self {
        const USUAL_LOOKS: u64 = 30;
        let left = USUAL_LOOKS * readings as u64;
        progress.expect(left);
        Self { progress, left: Cell::new(left) }
    }

    /// Counts readings that were looked at once more, and says whether the search shall go on.
    pub fn spend(&self, readings: usize) -> bool {
        if self.progress.is_cancelled() {
            return false;
        }
        let amount = self.left.get().min(readings as u64);
        self.left.set(self.left.get() - amount);
        self.progress.advance(amount).is_ok()
    }

    /// The search is over, sooner than thought or not.
    pub fn end(self) -> Result<(), Cancelled> {
        self.progress.check()?;
        self.progress.advance(self.left.get())
    }
}
