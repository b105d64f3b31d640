//! Which files a deployment was read from, and what was in them: size and SHA-256.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use resect_core::deployment::Deployment;

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

/// The marks of the files that a deployment was read from, those of further drives among them; what cannot be read any
/// more is left out.
pub fn marks_of(deployment: &Deployment) -> Vec<FileMark> {
    used_files(deployment).filter_map(|path| FileMark::of(path).ok()).collect()
}

/// The files that a deployment was read from, those of further drives among them; none of a sample.
pub fn used_files(deployment: &Deployment) -> impl Iterator<Item = &Path> {
    let used = deployment.ingredients.iter().filter(|ingredient| ingredient.used);
    used.filter_map(|ingredient| ingredient.path.as_deref())
}
