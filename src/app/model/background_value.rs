//! Quantities that are computed in the background from a result while they are visible.

use std::sync::Arc;

/// Identifies the inputs of a computation: the count of the result, and the count of its other inputs.
pub type InputVersion = (u64, u64);

/// The newest computed value, and the job for a newer one.
pub struct BackgroundValue<T> {
    pub newest: Option<Arc<T>>,
    of: Option<InputVersion>,
    /// Number and inputs of the running job.
    running: Option<(u64, InputVersion)>,
}

impl<T> Default for BackgroundValue<T> {
    fn default() -> Self {
        Self { newest: None, of: None, running: None }
    }
}

impl<T> BackgroundValue<T> {
    /// Returns true if it has to be computed anew; only one job runs at a time.
    pub fn is_wanted(&self, of: InputVersion) -> bool {
        self.running.is_none() && self.of != Some(of)
    }

    pub fn start(&mut self, number: u64, of: InputVersion) {
        self.running = Some((number, of));
    }

    pub fn is_running(&self) -> bool {
        self.running.is_some()
    }

    /// Returns true if the newest value was computed from these inputs.
    pub fn is_of(&self, of: InputVersion) -> bool {
        self.of == Some(of)
    }

    /// Stores the value of the job that was started last; ignores any other.
    pub fn take(&mut self, number: u64, made: T) {
        if let Some((_, of)) = self.running.take_if(|(running, _)| *running == number) {
            (self.newest, self.of) = (Some(Arc::new(made)), Some(of));
        }
    }

    /// Ends a job that failed because of a bug; the same inputs are not tried again.
    pub fn failed(&mut self, number: u64) {
        if let Some((_, of)) = self.running.take_if(|(running, _)| *running == number) {
            (self.newest, self.of) = (None, Some(of));
        }
    }

    /// Forgets the value and the running job.
    pub fn clear(&mut self) {
        *self = Self::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_is_made_at_a_time_and_the_newest_once() {
        let mut made = BackgroundValue::default();
        assert!(made.is_wanted((1, 0)));
        made.start(7, (1, 0));
        assert!(!made.is_wanted((2, 0)) && made.is_running());
        made.take(6, "of another");
        assert!(made.newest.is_none());
        made.take(7, "the first");
        assert!(!made.is_wanted((1, 0)) && made.is_wanted((2, 0)) && made.is_wanted((1, 1)));
        made.start(8, (2, 0));
        made.failed(8);
        assert!(made.newest.is_none() && !made.is_wanted((2, 0)) && !made.is_running());
    }
}
