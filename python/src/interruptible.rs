//! Long work without the interpreter's lock, which Ctrl-C interrupts.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use pyo3::prelude::*;
use resect_core::progress::Progress;

use crate::failure::{Failure, raised};
use crate::thread_pool::thread_pool;

/// Interval at which a waiting call asks the interpreter for signals.
const SIGNAL_INTERVAL: Duration = Duration::from_millis(20);

/// Runs work in the pool of this process, so that other threads of Python go on. After Ctrl-C the call ends at once, and the
/// work at its next step.
///
/// # Errors
/// [`ResectError`](crate::failure::ResectError) with the line of a failure. A fault of resect is one too: `except Exception`
/// does not catch a panic. The exception of a signal's handler, such as `KeyboardInterrupt`.
pub fn interruptible<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(&Progress) -> Result<T, Failure> + Send + 'static,
) -> PyResult<T> {
    let progress = Arc::new(Progress::default());
    let (sender, mut receiver) = channel();
    let shared = Arc::clone(&progress);
    thread_pool(py)?.spawn(move || {
        // Nothing that the work was changing is used after a panic.
        let result = catch_unwind(AssertUnwindSafe(|| work(&shared)))
            .unwrap_or_else(|panic| Err(fault(panic.as_ref())));
        // An interrupted call receives nothing.
        let _ = sender.send(result);
    });
    loop {
        // A receiver is for one thread at a time, so that it moves there and back.
        let (waiting, received) = py.detach(move || {
            let received = receiver.recv_timeout(SIGNAL_INTERVAL);
            (receiver, received)
        });
        receiver = waiting;
        match received {
            Ok(result) => return raised(result),
            Err(RecvTimeoutError::Timeout) => {
                py.check_signals().inspect_err(|_| progress.cancel())?;
            }
            Err(RecvTimeoutError::Disconnected) => unreachable!("the work always sends its result"),
        }
    }
}

fn fault(panic: &(dyn Any + Send)) -> Failure {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    let text = text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no reason given");
    Failure(format!("a fault of resect, not of the input: {text}; report it with the input"))
}
