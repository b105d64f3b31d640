//! Progress and cancellation of a calculation.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

/// Progress of a calculation, shared with its caller. Each kind of calculation has its own unit: bytes of files, steps of a
/// study.
#[derive(Debug, Default)]
pub struct Progress {
    cancelled: AtomicBool,
    done: AtomicU64,
    total: AtomicU64,
}

/// The calculation was cancelled; nothing is reported to the user.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cancelled")]
pub struct Cancelled;

impl Progress {
    /// Cancels the calculation, which stops at its next step.
    pub fn cancel(&self) {
        self.cancelled.store(true, Relaxed);
    }

    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Relaxed)
    }

    /// Returns an error once the calculation is cancelled, for `?` in its loops.
    pub fn check(&self) -> Result<(), Cancelled> {
        if self.is_cancelled() { Err(Cancelled) } else { Ok(()) }
    }

    pub fn done(&self) -> u64 {
        self.done.load(Relaxed)
    }

    pub fn total(&self) -> u64 {
        self.total.load(Relaxed)
    }

    /// Share that is done, 0 to 1; `None` while the total is unknown.
    pub fn share(&self) -> Option<f32> {
        let total = self.total();
        (total > 0).then(|| (self.done() as f32 / total as f32).min(1.0))
    }

    /// Adds to the total.
    pub fn expect(&self, amount: u64) {
        self.total.fetch_add(amount, Relaxed);
    }

    /// Adds to the amount done; returns an error once cancelled.
    pub fn advance(&self, amount: u64) -> Result<(), Cancelled> {
        self.done.fetch_add(amount, Relaxed);
        self.check()
    }

    /// Does one step, unless cancelled.
    pub fn step<T>(&self, work: impl FnOnce() -> T) -> Result<T, Cancelled> {
        self.check()?;
        let result = work();
        self.done.fetch_add(1, Relaxed);
        Ok(result)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_cancelled_does_no_further_step() {
        let progress = Progress::default();
        assert_eq!(progress.share(), None);
        progress.expect(4);
        assert_eq!(progress.step(|| "done"), Ok("done"));
        assert_eq!(progress.share(), Some(0.25));
        progress.cancel();
        assert_eq!(progress.step(|| "done"), Err(Cancelled));
        assert_eq!(progress.advance(1), Err(Cancelled));
        assert_eq!((progress.done(), progress.total()), (2, 4));
    }
}
