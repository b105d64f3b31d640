//! Opening of the deployments that a command names.

use std::iter::zip;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use super::progress_line::with_progress;
use resect_core::deployment::Deployment;
use resect_core::deployment::names::told_apart;
use resect_io::error::OpenError;
use resect_io::source::{Extras, Source};

/// Opens a deployment, and returns it with the duration of opening (ms).
pub fn load(path: &Path, extras: Extras) -> Result<(Arc<Deployment>, f64), OpenError> {
    let started = Instant::now();
    let source = Source::at(path).with(extras);
    let deployment = with_progress(&format!("reading {}", path.display()), |it| source.open(it))?;
    Ok((Arc::new(deployment), started.elapsed().as_secs_f64() * 1e3))
}

/// Opens several deployments; those with equal names get longer, distinct ones.
pub fn load_each(paths: &[PathBuf], extras: &Extras) -> Vec<Result<Arc<Deployment>, OpenError>> {
    let mut loaded: Vec<Result<Arc<Deployment>, OpenError>> =
        paths.iter().map(|path| Ok(load(path, extras.clone())?.0)).collect();
    let places: Vec<PathBuf> = paths
        .iter()
        .map(|path| std::path::absolute(path).unwrap_or_else(|_| path.clone()))
        .collect();
    let named: Vec<(String, Option<&Path>)> = zip(&loaded, &places)
        .filter_map(|(opened, place)| Some((opened.as_ref().ok()?.name.clone(), Some(&**place))))
        .collect();
    for (deployment, name) in zip(loaded.iter_mut().flatten(), told_apart(&named)) {
        Arc::make_mut(deployment).name = name;
    }
    loaded
}
