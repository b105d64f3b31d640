//! How far a study is, and whether anyone still wants it.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed};

/// Shared between a study and who waits for it.
#[derive(Debug, Default)]
pub struct Control {
    cancelled: AtomicBool,
    done: AtomicUsize,
    total: AtomicUsize,
}

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StudyError {
    #[error("cancelled")]
    Cancelled,
    #[error("{0}")]
    Nothing(String),
}

impl Control {
    pub fn cancel(&self) {
        self.cancelled.store(true, Relaxed);
    }

    /// Share of the work that is done, 0 to 1.
    pub fn progress(&self) -> f32 {
        match self.total.load(Relaxed) {
            0 => 0.0,
            total => self.done.load(Relaxed) as f32 / total as f32,
        }
    }

    pub(super) fn expect(&self, steps: usize) {
        self.total.fetch_add(steps, Relaxed);
    }

    /// Does one step, unless cancelled.
    pub(super) fn step<T>(&self, work: impl FnOnce() -> T) -> Result<T, StudyError> {
        if self.cancelled.load(Relaxed) {
            return Err(StudyError::Cancelled);
        }
        let result = work();
        self.done.fetch_add(1, Relaxed);
        Ok(result)
    }
}
