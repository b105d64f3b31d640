//! The native part of the Python module `resect`: the functions of the crates with numpy arrays and plain data as results.
//!
//! The package in `resect/` has the classes that users see, with their types and docstrings.
//!
//! | module | content | next change |
//! |---|---|---|
//! | [`failure`] | errors as one line | |
//! | [`thread_pool`], [`interruptible`] | the threads of a process; work without the interpreter's lock, which Ctrl-C interrupts | |
//! | [`keywords`] | keyword arguments as settings, overrides and choices; remedies as keyword arguments | a remedy: `keywords.rs` |
//! | [`arrays`] | numpy arrays | |
//! | [`deployment`], [`analysis`], [`trajectory`], [`evaluation`], [`extrinsics`], [`planning`], [`simulation`] | one file for each part of the module | an array of a result: its file here, its field in `resect/` |

mod analysis;
mod arrays;
mod deployment;
mod evaluation;
mod extrinsics;
mod failure;
mod interruptible;
mod keywords;
mod planning;
mod simulation;
mod thread_pool;
mod trajectory;

/// Native functions of `resect`; use the package itself.
#[pyo3::pymodule]
mod _native {
    #[pymodule_export]
    use super::analysis::AnalysisHandle;
    #[pymodule_export]
    use super::deployment::{DeploymentHandle, open, open_truth};
    #[pymodule_export]
    use super::evaluation::evaluate;
    #[pymodule_export]
    use super::extrinsics::extrinsics;
    #[pymodule_export]
    use super::failure::ResectError;
    #[pymodule_export]
    use super::planning::plan;
    #[pymodule_export]
    use super::simulation::{SimulationHandle, simulate};

    #[pymodule_init]
    fn init(_module: &pyo3::Bound<'_, pyo3::types::PyModule>) -> pyo3::PyResult<()> {
        super::thread_pool::remember_process();
        Ok(())
    }
}
