//! A thread that writes for the window, so that no frame waits for a disk. The newest request replaces earlier ones that have not begun.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

type WriteJob = Box<dyn FnOnce() -> Result<(), String> + Send>;

#[derive(Default)]
struct Slot {
    next: Option<WriteJob>,
    writing: bool,
    closed: bool,
    /// Error of the last job that failed, until it is read.
    error: Option<String>,
}

#[derive(Default)]
struct Shared {
    slot: Mutex<Slot>,
    changed: Condvar,
}

impl Shared {
    fn slot(&self) -> MutexGuard<'_, Slot> {
        // The slot is valid even after a job panicked.
        self.slot.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wait<'a>(&self, slot: MutexGuard<'a, Slot>) -> MutexGuard<'a, Slot> {
        self.changed.wait(slot).unwrap_or_else(PoisonError::into_inner)
    }
}

/// The window's handle of the thread. Dropping it waits for pending jobs.
pub struct Writer {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

impl Writer {
    /// Starts the writing thread; without a thread, jobs run in the caller's thread.
    pub fn start(name: &str) -> Self {
        let shared = Arc::new(Shared::default());
        let inner = Arc::clone(&shared);
        let thread = std::thread::Builder::new().name(name.to_owned()).spawn(move || work(&inner));
        Self { shared, thread: thread.ok() }
    }

    /// Queues a job, in place of a queued one that has not begun.
    pub fn write(&self, job: impl FnOnce() -> Result<(), String> + Send + 'static) {
        if self.thread.is_none() {
            let result = job();
            self.shared.slot().error = result.err();
            return;
        }
        self.shared.slot().next = Some(Box::new(job));
        self.shared.changed.notify_all();
    }

    /// Returns the error of the last job that failed, once.
    pub fn take_error(&self) -> Option<String> {
        self.shared.slot().error.take()
    }

    /// Waits until all requested jobs are done.
    pub fn finish(&self) {
        let mut slot = self.shared.slot();
        while self.thread.is_some() && (slot.next.is_some() || slot.writing) {
            slot = self.shared.wait(slot);
        }
    }
}

impl Drop for Writer {
    fn drop(&mut self) {
        self.shared.slot().closed = true;
        self.shared.changed.notify_all();
        if let Some(thread) = self.thread.take() {
            // A panic of the thread has printed its own message.
            _ = thread.join();
        }
    }
}

fn work(shared: &Shared) {
    loop {
        let mut slot = shared.slot();
        let job = loop {
            if let Some(job) = slot.next.take() {
                break job;
            }
            if slot.closed {
                return;
            }
            slot = shared.wait(slot);
        };
        slot.writing = true;
        drop(slot);
        let result = std::panic::catch_unwind(std::panic::AssertUnwindSafe(job))
            .unwrap_or_else(|_| Err("a bug in resect stopped the writing".to_owned()));
        let mut slot = shared.slot();
        slot.writing = false;
        if let Err(error) = result {
            slot.error = Some(error);
        }
        shared.changed.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::channel;

    use super::*;

    #[test]
    fn while_one_is_written_only_the_newest_waits_and_none_is_lost_at_the_end() {
        let (go, wait) = channel::<()>();
        let (done, written) = channel();
        let writer = Writer::start("test");
        let first = done.clone();
        let (begun, has_begun) = channel();
        writer.write(move || {
            begun.send(()).map_err(|e| e.to_string())?;
            wait.recv().map_err(|e| e.to_string())?;
            first.send(1).map_err(|e| e.to_string())
        });
        has_begun.recv().expect("it begins");
        for number in 2..10 {
            let done = done.clone();
            writer.write(move || done.send(number).map_err(|e| e.to_string()));
        }
        go.send(()).expect("it waits");
        drop(writer);
        assert_eq!(written.try_iter().collect::<Vec<_>>(), [1, 9]);
    }

    #[test]
    fn a_failure_is_told_once_and_the_next_job_is_done() {
        let writer = Writer::start("test");
        writer.write(|| Err("disk full".to_owned()));
        writer.finish();
        assert_eq!(writer.take_error().as_deref(), Some("disk full"));
        assert_eq!(writer.take_error(), None);
        writer.write(|| panic!("on purpose"));
        writer.finish();
        assert!(writer.take_error().expect("told").contains("bug"));
        writer.write(|| Ok(()));
        writer.finish();
        assert_eq!(writer.take_error(), None);
    }
}
