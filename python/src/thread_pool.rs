//! The threads of a process. rayon's global pool does not survive a fork, because a child has the pool but not its threads.

use std::num::NonZero;
use std::process;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::failure::{Failure, raised};

/// Stack of a thread (bytes). A thread that waits for its parts begins a call of another Python thread on the same stack.
const STACK_BYTES: usize = 16 << 20;

/// The process that imported the module.
static IMPORTED_BY: OnceLock<u32> = OnceLock::new();
/// The pool, and the process that has its threads. It is locked with the interpreter's lock only, so that no fork finds it locked.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// Remembers the process that imports the module.
pub fn remember_process() {
    IMPORTED_BY.get_or_init(process::id);
}

/// Returns the pool of this process.
pub fn thread_pool(py: Python<'_>) -> PyResult<Arc<ThreadPool>> {
    let process = process::id();
    let mut pool = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((owner, pool)) = &*pool
        && *owner == process
    {
        return Ok(Arc::clone(pool));
    }
    let builder = ThreadPoolBuilder::new()
        .num_threads(threads(py)?)
        .stack_size(STACK_BYTES)
        .thread_name(|index| format!("resect {index}"));
    let built = builder.build().map_err(|error| Failure(format!("no threads: {error}")));
    let made = Arc::new(raised(built)?);
    // The parent's pool has locks that nobody opens in this process; dropping it could wait for them.
    std::mem::forget(pool.replace((process, Arc::clone(&made))));
    Ok(made)
}

/// Returns the number of threads of a pool; 0 is one for each core.
fn threads(py: Python<'_>) -> PyResult<usize> {
    if let Some(threads) = stated_threads() {
        return Ok(threads.get());
    }
    // Whoever starts several processes starts one for each core.
    Ok(usize::from(is_forked() || is_worker(py)?))
}

/// The number of threads in the environment, as rayon reads it.
fn stated_threads() -> Option<NonZero<usize>> {
    std::env::var("RAYON_NUM_THREADS").ok()?.parse().ok()
}

/// Returns true in a process that was forked after the import.
fn is_forked() -> bool {
    IMPORTED_BY.get().is_some_and(|importer| *importer != process::id())
}

/// Returns true in a process that `multiprocessing` started: those of `concurrent.futures`, joblib and dask too.
fn is_worker(py: Python<'_>) -> PyResult<bool> {
    let modules = py.import("sys")?.getattr("modules")?;
    // A worker has imported it before everything else.
    let module = modules.call_method1("get", ("multiprocessing.process",))?;
    Ok(!module.is_none() && !module.call_method0("parent_process")?.is_none())
}
