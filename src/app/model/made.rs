//! What is made beside the window from an answer, for who looks at it.

use std::sync::Arc;

/// What something was made of: the count of the answer, and that of the other things it depends on.
pub type MadeOf = (u64, u64);

/// The newest of its kind, and whether a newer one is on its way.
pub struct Made<T> {
    pub newest: Option<Arc<T>>,
    of: Option<MadeOf>,
    /// The number of the job, and what it makes it of.
    running: Option<(u64, MadeOf)>,
}

impl<T> Default for Made<T> {
    fn default() -> Self {
        Self { newest: None, of: None, running: None }
    }
}

impl<T> Made<T> {
    /// Whether it is to be made anew; one at a time.
    pub fn is_wanted(&self, of: MadeOf) -> bool {
        self.running.is_none() && self.of != Some(of)
    }

    pub fn start(&mut self, number: u64, of: MadeOf) {
        self.running = Some((number, of));
    }

    pub fn is_running(&self) -> bool {
        self.running.is_some()
    }

    /// Whether what is there is of this.
    pub fn is_of(&self, of: MadeOf) -> bool {
        self.of == Some(of)
    }

    /// Takes it in, if it is the one that was started last.
    pub fn take(&mut self, number: u64, made: T) {
        if let Some((_, of)) = self.running.take_if(|(running, _)| *running == number) {
            (self.newest, self.of) = (Some(Arc::new(made)), Some(of));
        }
    }

    /// The job ended in a bug of the program: it would do so again.
    pub fn failed(&mut self, number: u64) {
        if let Some((_, of)) = self.running.take_if(|(running, _)| *running == number) {
            (self.newest, self.of) = (None, Some(of));
        }
    }

    /// Forgets it, and what is on its way.
    pub fn clear(&mut self) {
        *self = Self::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_is_made_at_a_time_and_the_newest_once() {
        let mut made = Made::default();
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
