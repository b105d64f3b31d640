//! Size and SHA-256 of the files that a deployment was read from.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use resect_core::deployment::Deployment;

/// Path, size and SHA-256 (as of `sha256sum`) of a file when it was read.
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

/// Returns the SHA-256 of a file; an error once `go_on` returns false.
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

/// Returns the marks of the files that a deployment was read from, with those of further drives. Files that can no longer be
/// read are left out.
pub fn marks_of(deployment: &Deployment) -> Vec<FileMark> {
    used_files(deployment).filter_map(|path| FileMark::of(path).ok()).collect()
}

/// Returns the files that a deployment was read from, with those of further drives; none for a sample.
pub fn used_files(deployment: &Deployment) -> impl Iterator<Item = &Path> {
    let used = deployment.ingredients.iter().filter(|ingredient| ingredient.used);
    used.filter_map(|ingredient| ingredient.path.as_deref())
}
