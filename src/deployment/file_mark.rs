//! Which files a deployment was read from, and what was in them: size and SHA-256.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::{Deployment, Place, Source};

/// What a file was when it was read; `sha256sum` gives the same.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FileMark {
    pub path: PathBuf,
    pub bytes: u64,
    pub sha256: String,
}

impl FileMark {
    /// Reads the whole file.
    pub fn of(path: &Path) -> std::io::Result<Self> {
        let bytes = path.metadata()?.len();
        Ok(Self { path: path.to_owned(), bytes, sha256: sha256(path, || true)? })
    }
}

/// The SHA-256 of a file, as long as `go_on` says so.
pub fn sha256(path: &Path, go_on: impl Fn() -> bool) -> std::io::Result<String> {
    let mut file = File::open(path)?;
    let mut hasher = Sha256::new();
    let mut buffer = vec![0; 1 << 16];
    loop {
        if !go_on() {
            return Err(std::io::Error::other("resect is being closed"));
        }
        match file.read(&mut buffer)? {
            0 => break,
            read => hasher.update(&buffer[..read]),
        }
    }
    Ok(hasher.finalize().iter().map(|byte| format!("{byte:02x}")).collect())
}

/// The marks of the files that a deployment was read from; what cannot be read any more is left out.
pub fn marks_of(source: &Source, deployment: &Deployment) -> Vec<FileMark> {
    let files = used_files(source, deployment).into_iter();
    files.filter_map(|path| FileMark::of(&path).ok()).collect()
}

/// The files that a deployment was read from; none of a sample.
pub fn used_files(source: &Source, deployment: &Deployment) -> Vec<PathBuf> {
    let Place::Path(path) = &source.place else { return Vec::new() };
    let folder =
        if path.is_dir() { path.as_path() } else { path.parent().unwrap_or(Path::new("")) };
    let extras = &source.extras;
    let named: Vec<&PathBuf> = extras.rig.iter().chain(&extras.gcp).chain(&extras.gnss).collect();
    let place = |file: &str| {
        // What the user named is told as it was named, or from the named folder on.
        let candidates = named.iter().map(|named| match named.is_dir() {
            true => named.join(file),
            false => (*named).clone(),
        });
        let own = folder.join(file);
        let mut named = candidates.filter(|path| path.ends_with(file) && path.is_file());
        if own.is_file() { Some(own) } else { named.next() }
    };
    let used = deployment.ingredients.iter().filter(|ingredient| ingredient.used);
    used.filter_map(|ingredient| place(&ingredient.file)).collect()
}
