//! Files that are either the old one or the new one, never half of it, whenever the program or the machine stops.

use std::ffi::OsString;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

#[derive(Debug, thiserror::Error)]
#[error("{}: cannot be written: {error}; choose a folder that is there and that you may write to", path.display())]
pub struct WriteError {
    pub path: PathBuf,
    pub error: std::io::Error,
}

/// Writes beside the file, waits until that is on the disk, then lets it take the file's place.
///
/// Behind a link, what it points to is replaced; a pipe or a device is written to as it is.
pub fn write(path: &Path, bytes: impl AsRef<[u8]>) -> Result<(), WriteError> {
    write_with(path, |part| std::fs::write(part, bytes.as_ref()))
}

/// Writes like [`write()`] what is too large to be held in memory, or written by others: `fill` makes the file that it is
/// given.
pub fn write_with(
    path: &Path,
    fill: impl FnOnce(&Path) -> std::io::Result<()>,
) -> Result<(), WriteError> {
    let result = match path.metadata() {
        Ok(metadata) if metadata.is_file() => path.canonicalize().and_then(|target| {
            let permissions = metadata.permissions();
            // Whoever may not write to a file may not replace it either.
            if permissions.readonly() {
                return Err(std::io::ErrorKind::PermissionDenied.into());
            }
            replace(&target, Some(permissions), fill)
        }),
        Ok(_) => fill(path),
        Err(_) => match path.symlink_metadata() {
            // A link to a file that is not there yet.
            Ok(_) => fill(path),
            Err(_) => replace(path, None, fill),
        },
    };
    result.map_err(|error| WriteError { path: path.to_owned(), error })
}

fn replace(
    path: &Path,
    permissions: Option<std::fs::Permissions>,
    fill: impl FnOnce(&Path) -> std::io::Result<()>,
) -> std::io::Result<()> {
    let part = part_of(path);
    let written = fill(&part).and_then(|()| {
        let file = File::options().write(true).open(&part)?;
        if let Some(permissions) = permissions {
            // Some file systems have none to set; that is no reason not to save.
            _ = file.set_permissions(permissions);
        }
        file.sync_all()
    });
    let result = written.and_then(|()| std::fs::rename(&part, path));
    if result.is_err() {
        // What is to be told is the first error, not that the part is not there either.
        _ = std::fs::remove_file(&part);
        return result;
    }
    sync_folder(path);
    Ok(())
}

/// A name of its own for each write, so that two at once do not mix; hidden, and told by its ending.
fn part_of(path: &Path) -> PathBuf {
    static WRITES: AtomicU64 = AtomicU64::new(0);
    let mut name = OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    let number = WRITES.fetch_add(1, Ordering::Relaxed);
    name.push(format!(".{}-{number}.part", std::process::id()));
    path.with_file_name(name)
}

/// The file that a half-written one, left by a program that was killed, was to become.
pub fn target_of_part(part: &Path) -> Option<PathBuf> {
    let name = part.file_name()?.to_str()?.strip_prefix('.')?.strip_suffix(".part")?;
    let (target, _) = name.rsplit_once('.')?;
    Some(part.with_file_name(target))
}

/// Makes the new name outlive a power cut, where a folder can be synced; the file itself is there either way.
fn sync_folder(path: &Path) {
    #[cfg(unix)]
    {
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        _ = File::open(folder).and_then(|folder| folder.sync_all());
    }
    #[cfg(not(unix))]
    {
        _ = path;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(folder).expect("a folder");
        let mut names: Vec<_> = entries
            .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn the_new_file_takes_the_old_ones_place_and_nothing_else_stays() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("a.toml");
        write(&file, "one").expect("written");
        write(&file, "two").expect("written");
        assert_eq!(std::fs::read_to_string(&file).expect("there"), "two");
        assert_eq!(names(folder.path()), ["a.toml"]);
    }

    #[test]
    fn a_part_tells_what_it_was_to_become() {
        let file = Path::new("folder/a.b.toml");
        assert_eq!(target_of_part(&part_of(file)).as_deref(), Some(file));
        assert_eq!(target_of_part(file), None);
    }

    #[test]
    fn what_cannot_be_written_is_one_line_and_leaves_nothing() {
        let folder = tempfile::tempdir().expect("a folder");
        let error = write(&folder.path().join("no/such/a.toml"), "x").expect_err("no folder");
        let line = error.to_string();
        assert!(line.contains("a.toml: cannot be written: "), "{line}");
        assert!(!line.contains('\n'), "{line}");
        assert_eq!(names(folder.path()), Vec::<String>::new());
    }

    #[test]
    fn what_fails_half_way_leaves_the_old_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("a.csv");
        write(&file, "old").expect("written");
        let error = write_with(&file, |part| {
            std::fs::write(part, "half of the ne")?;
            Err(std::io::ErrorKind::StorageFull.into())
        });
        assert!(error.expect_err("full").to_string().contains("a.csv: cannot be written"));
        assert_eq!(std::fs::read_to_string(&file).expect("there"), "old");
        assert_eq!(names(folder.path()), ["a.csv"]);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_a_link_and_permissions_stay() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = tempfile::tempdir().expect("a folder");
        let (target, link) = (folder.path().join("target"), folder.path().join("link"));
        std::fs::write(&target, "old").expect("written");
        let owner_only = std::fs::Permissions::from_mode(0o600);
        std::fs::set_permissions(&target, owner_only).expect("set");
        symlink(&target, &link).expect("linked");
        write(&link, "new").expect("written");
        assert!(link.symlink_metadata().expect("there").is_symlink());
        let metadata = target.metadata().expect("there");
        assert_eq!(metadata.permissions().mode() & 0o777, 0o600);
        assert_eq!(std::fs::read_to_string(&target).expect("there"), "new");
    }

    #[test]
    fn writers_at_once_do_not_mix() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("a.toml");
        let texts = ["a", "b", "c", "d"].map(|letter| letter.repeat(100_000));
        std::thread::scope(|scope| {
            let file = &file;
            for text in &texts {
                scope.spawn(move || {
                    for _ in 0..5 {
                        write(file, text).expect("written");
                    }
                });
            }
        });
        assert!(texts.contains(&std::fs::read_to_string(&file).expect("there")));
        assert_eq!(names(folder.path()), ["a.toml"]);
    }
}
