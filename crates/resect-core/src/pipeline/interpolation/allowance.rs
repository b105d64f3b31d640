//! Expected work of a search for hyper-parameters.

use std::cell::Cell;

use crate::progress::{Cancelled, Progress};

/// Expected number of readings that a search evaluates; the number of evaluations is unknown beforehand.
pub struct Allowance<'a> {
    progress: &'a Progress,
    left: Cell<u64>,
}

impl<'a> Allowance<'a> {
    /// Announces a search over this many readings to `progress`.
    pub fn new(progress: &'a Progress, readings: usize) -> Self {
        const USUAL_LOOKS: u64 = 30;
        let left = USUAL_LOOKS * readings as u64;
        progress.expect(left);
        Self { progress, left: Cell::new(left) }
    }

    /// Counts another evaluation of readings. Returns true if the search shall continue.
    pub fn spend(&self, readings: usize) -> bool {
        if self.progress.is_cancelled() {
            return false;
        }
        let amount = self.left.get().min(readings as u64);
        self.left.set(self.left.get() - amount);
        self.progress.advance(amount).is_ok()
    }

    /// Ends the search and counts the rest of its expected work as done.
    pub fn end(self) -> Result<(), Cancelled> {
        self.progress.check()?;
        self.progress.advance(self.left.get())
    }
}
