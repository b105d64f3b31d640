//! Refusal to open a folder of many deployments, such as a clone of the authors' repository, as one.

use std::path::{Path, PathBuf};

use crate::error::OpenError;

/// Folder in each deployment of the authors' layout.
const MARK: &str = "total_stations";
/// Folder of the deployments in the authors' repository.
const DATA: &str = "data";

/// Refuses a folder with several deployments; the error names a few.
pub fn refuse(folder: &Path) -> Result<(), OpenError> {
    let deployments = deployments(folder);
    if deployments.len() < 2 {
        return Ok(());
    }
    let names: Vec<String> = deployments.iter().map(|path| path.display().to_string()).collect();
    let few = names[..names.len().min(3)].join(", ");
    let more = if names.len() > 3 { ", …" } else { "" };
    Err(OpenError::file(
        &folder.display().to_string(),
        format!("{} deployments in one folder", names.len()),
        format!("open the folder of one of them: {few}{more}"),
    ))
}

/// Returns true if a folder contains several deployments.
pub fn holds_many(folder: &Path) -> bool {
    deployments(folder).len() > 1
}

/// Returns the folders of deployments in this folder or in its `data`, sorted, without opening any file. Empty if the folder has a
/// `deployment.toml`.
fn deployments(folder: &Path) -> Vec<PathBuf> {
    if folder.join("deployment.toml").exists() {
        return Vec::new();
    }
    let below = |folder: &Path| {
        // Opening the folder reports unreadable folders.
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        entries.map(|entry| entry.path()).filter(|path| path.join(MARK).is_dir())
    };
    let mut found: Vec<PathBuf> = below(folder).chain(below(&folder.join(DATA))).collect();
    found.sort();
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clone_is_not_opened_as_one_deployment() {
        let clone = tempfile::tempdir().expect("a folder");
        let one = clone.path().join("data/20220711-1/total_stations");
        std::fs::create_dir_all(&one).expect("writable");
        assert!(refuse(clone.path()).is_ok());
        for name in ["20220711-2", "20220525-1"] {
            let path = clone.path().join("data").join(name).join("total_stations");
            std::fs::create_dir_all(path).expect("writable");
        }
        for folder in [clone.path().to_owned(), clone.path().join("data")] {
            let error = refuse(&folder).expect_err("three").to_string();
            assert!(error.contains("3 deployments in one folder; open"), "{error}");
            assert!(error.contains("20220711-2") && !error.contains('\n'), "{error}");
            assert!(holds_many(&folder));
        }
        assert!(refuse(&clone.path().join("data/20220711-2")).is_ok());
    }
}
