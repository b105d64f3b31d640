//! Background work: each job has its own thread, and its outcome is a function that is applied to the state between two frames. No frame
//! waits, and nothing is shared.

use std::panic::AssertUnwindSafe;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;

/// Outcome of a job.
pub type Outcome<S> = Box<dyn FnOnce(&mut S) + Send>;

/// Timeout of waiting, longer than any job in pictures and tests.
const LONGEST_WAIT: Duration = Duration::from_secs(120);

/// Jobs of a window whose state is `S`.
pub struct Jobs<S> {
    outbox: Outbox<S>,
    outcomes: Receiver<Outcome<S>>,
    newest: u64,
    /// Called with the number of a job that panicked.
    failed: fn(&mut S, u64),
}

/// Channel through which threads send the outcomes of their work.
pub struct Outbox<S> {
    sender: Sender<Outcome<S>>,
    ctx: egui::Context,
}

impl<S> Clone for Outbox<S> {
    fn clone(&self) -> Self {
        Self { sender: self.sender.clone(), ctx: self.ctx.clone() }
    }
}

impl<S> Outbox<S> {
    /// Sends an outcome, which is applied before the next frame, and requests that frame.
    pub fn put(&self, outcome: impl FnOnce(&mut S) + Send + 'static) {
        // The window may be closed.
        self.sender.send(Box::new(outcome)).ok();
        self.ctx.request_repaint();
    }
}

impl<S: 'static> Jobs<S> {
    pub fn new(ctx: egui::Context, failed: fn(&mut S, u64)) -> Self {
        let (sender, outcomes) = channel();
        Self { outbox: Outbox { sender, ctx }, outcomes, newest: 0, failed }
    }

    /// Returns a number that no other job of this window has, and that is not 0.
    pub fn next_number(&mut self) -> u64 {
        self.newest += 1;
        self.newest
    }

    /// Starts a job and returns its number. `then` receives the state, this number and the job's result.
    pub fn start<T: Send + 'static>(
        &mut self,
        job: impl FnOnce() -> T + Send + 'static,
        then: impl FnOnce(&mut S, u64, T) + Send + 'static,
    ) -> u64 {
        let number = self.next_number();
        self.spawn(number, move || {
            let found = job();
            Some((found, move |state: &mut S, found: T| then(state, number, found)))
        });
        number
    }

    /// Starts a job without a number, such as a dialog. If the job returns `None`, for example after a cancel, nothing happens.
    pub fn start_unnumbered<T: Send + 'static>(
        &self,
        job: impl FnOnce() -> Option<T> + Send + 'static,
        then: impl FnOnce(&mut S, T) + Send + 'static,
    ) {
        self.spawn(0, move || Some((job()?, then)));
    }

    fn spawn<T, F>(&self, number: u64, job: impl FnOnce() -> Option<(T, F)> + Send + 'static)
    where
        T: Send + 'static,
        F: FnOnce(&mut S, T) + Send + 'static,
    {
        let (outbox, failed) = (self.outbox.clone(), self.failed);
        std::thread::spawn(move || match std::panic::catch_unwind(AssertUnwindSafe(job)) {
            Ok(Some((found, then))) => outbox.put(move |state| then(state, found)),
            Ok(None) => {}
            Err(_) => outbox.put(move |state| failed(state, number)),
        });
    }

    /// Returns a sender for outcomes of other threads, such as a permanent one.
    pub fn outbox(&self) -> Outbox<S> {
        self.outbox.clone()
    }

    pub fn ctx(&self) -> &egui::Context {
        &self.outbox.ctx
    }

    /// Returns the next outcome; `None` if there is none yet.
    pub fn outcome(&self) -> Option<Outcome<S>> {
        self.outcomes.try_recv().ok()
    }

    /// Waits for the next outcome; for pictures and tests.
    pub fn wait(&self) -> Option<Outcome<S>> {
        self.outcomes.recv_timeout(LONGEST_WAIT).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Default)]
    struct Seen {
        sums: Vec<(u64, i32)>,
        failed: Vec<u64>,
    }

    fn jobs() -> Jobs<Seen> {
        Jobs::new(egui::Context::default(), |seen, number| seen.failed.push(number))
    }

    #[test]
    fn what_comes_of_a_job_changes_the_state_under_its_number() {
        let (mut jobs, mut seen) = (jobs(), Seen::default());
        let number = jobs.start(|| 40 + 2, |seen, number, sum| seen.sums.push((number, sum)));
        jobs.wait().expect("an outcome")(&mut seen);
        assert_eq!(seen.sums, [(number, 42)]);
        assert_ne!(jobs.next_number(), number);
    }

    #[test]
    fn a_bug_in_a_job_is_told_and_a_cancelled_dialog_is_nothing() {
        let (mut jobs, mut seen) = (jobs(), Seen::default());
        jobs.start_unnumbered(|| None::<i32>, |seen: &mut Seen, sum| seen.sums.push((0, sum)));
        let number = jobs.start(|| panic!("a bug"), |_, _, ()| {});
        jobs.wait().expect("an outcome")(&mut seen);
        assert_eq!((seen.failed, seen.sums.len()), (vec![number], 0));
    }
}
