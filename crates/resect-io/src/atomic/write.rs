//! Writing of files: a temporary file first, which then replaces the target.

use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use super::error::WriteError;
use super::part::{self, Part, folder_of};

/// Writes a temporary file beside the target, syncs it to disk, then replaces the target.
///
/// The target of a symbolic link is replaced, not the link. A pipe or a device is written to directly.
pub fn write(path: &Path, bytes: impl AsRef<[u8]>) -> Result<(), WriteError> {
    ready(path, bytes)?.place().map(drop)
}

/// Writes like [`write()`], from a closure, for content too large for memory.
pub fn write_with(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) -> Result<(), WriteError> {
    ready_with(path, fill)?.place().map(drop)
}

/// Creates a folder and its missing parents.
pub fn make_folder(path: &Path) -> Result<(), WriteError> {
    std::fs::create_dir_all(path).map_err(|error| WriteError::of_folder(path, error))
}

/// A new file, synced to disk, that has not replaced its target yet. Dropping it removes it.
#[must_use]
pub struct Ready {
    path: PathBuf,
    /// `None` for a device or a pipe, which is already written.
    part: Option<Part>,
}

impl Ready {
    /// Replaces the target; returns the path.
    pub fn place(self) -> Result<PathBuf, WriteError> {
        let Self { path, part } = self;
        match part.map_or(Ok(()), Part::place) {
            Ok(()) => Ok(path),
            Err(error) => Err(WriteError::of_file(&path, error)),
        }
    }
}

/// Replaces the targets of files that belong together; returns their paths.
pub fn place_all(all: Vec<Ready>) -> Result<Vec<PathBuf>, WriteError> {
    all.into_iter().map(Ready::place).collect()
}

/// Does all of [`write()`] except the replacement. Files that belong together are replaced only when all are on disk.
pub fn ready(path: &Path, bytes: impl AsRef<[u8]>) -> Result<Ready, WriteError> {
    ready_with(path, |file| file.write_all(bytes.as_ref()))
}

/// Does all of [`write_with`] but the last step.
pub fn ready_with(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) -> Result<Ready, WriteError> {
    match fill_beside(path, fill) {
        Ok(part) => Ok(Ready { path: path.to_owned(), part }),
        Err(error) => Err(WriteError::of_file(path, error)),
    }
}

fn fill_beside(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) -> std::io::Result<Option<Part>> {
    let target = behind_links(path)?;
    let old = target.metadata().ok();
    if let Some(old) = &old
        && !old.is_file()
    {
        let mut device = BufWriter::new(std::fs::File::create(&target)?);
        fill(&mut device)?;
        device.flush()?;
        return Ok(None);
    }
    let permissions = old.map(|old| old.permissions());
    // A read-only file must not be replaced either.
    if permissions.as_ref().is_some_and(std::fs::Permissions::readonly) {
        return Err(std::io::ErrorKind::PermissionDenied.into());
    }
    // Before writing, since abandoned files may be what fills the disk.
    part::remove_left_of(&target);
    let part = Part::beside(&target)?;
    let mut file = BufWriter::new(part.file());
    fill(&mut file)?;
    file.flush()?;
    drop(file);
    if let Some(permissions) = permissions {
        // Some file systems have no permissions; that does not prevent saving.
        _ = part.file().set_permissions(permissions);
    }
    part.file().sync_all()?;
    Ok(Some(part))
}

/// Returns the final target of symbolic links, existing or not.
fn behind_links(path: &Path) -> std::io::Result<PathBuf> {
    let mut target = path.to_owned();
    // The limit that operating systems have.
    for _ in 0..40 {
        if let Ok(target) = target.canonicalize() {
            return Ok(target);
        }
        match target.read_link() {
            Ok(next) => target = folder_of(&target).join(next),
            Err(_) => return Ok(target),
        }
    }
    // The links form a cycle.
    path.canonicalize()
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
        // Left by a process that was killed.
        std::fs::write(folder.path().join(".a.toml.4194999-0.part"), "tw").expect("written");
        write(&file, "two").expect("written");
        assert_eq!(std::fs::read_to_string(&file).expect("there"), "two");
        assert_eq!(names(folder.path()), ["a.toml"]);
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
            part.write_all(b"half of the ne")?;
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

    #[cfg(unix)]
    #[test]
    fn a_link_to_what_is_not_there_yet_leads_there_and_one_in_a_circle_is_an_error() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| folder.path().join(name);
        symlink("new", path("link")).expect("linked");
        write(&path("link"), "new").expect("written");
        assert!(path("link").symlink_metadata().expect("there").is_symlink());
        assert_eq!(std::fs::read_to_string(path("new")).expect("there"), "new");
        symlink("b", path("a")).expect("linked");
        symlink("a", path("b")).expect("linked");
        write(&path("a"), "x").expect_err("leads nowhere");
        assert_eq!(names(folder.path()), ["a", "b", "link", "new"]);
    }

    #[test]
    fn files_that_belong_together_stay_as_they_were_until_all_are_ready() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("a.csv");
        write(&file, "old").expect("written");
        let first = ready(&file, "new").expect("ready");
        assert_eq!(std::fs::read_to_string(&file).expect("there"), "old");
        drop(first);
        assert_eq!(names(folder.path()), ["a.csv"]);
        ready(&file, "new").expect("ready").place().expect("placed");
        assert_eq!(std::fs::read_to_string(&file).expect("there"), "new");
    }

    #[test]
    fn each_reason_has_its_remedy() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("a.csv");
        write(&file, "old").expect("written");
        let mut permissions = file.metadata().expect("there").permissions();
        permissions.set_readonly(true);
        std::fs::set_permissions(&file, permissions).expect("set");
        for (path, remedy) in [
            (folder.path().join("no/such.csv"), "no does not exist; create it, or choose another"),
            (folder.path().to_owned(), "this is a folder; give a file name in it"),
            (file.join("x.csv"), "uses a file as a folder"),
            (file.clone(), "with write permission"),
            (folder.path().join("x".repeat(300)), "choose a shorter name"),
            (PathBuf::new(), "the name is empty; give one"),
        ] {
            let line = write(&path, "new").expect_err("cannot be").to_string();
            assert!(line.contains(remedy) && line.contains("cannot be written: "), "{line}");
        }
        for (path, remedy) in
            [(file.clone(), "a file has this name"), (file.join("x"), "uses a file as a folder")]
        {
            let line = make_folder(&path).expect_err("cannot be").to_string();
            assert!(line.contains(remedy) && line.contains("cannot be created: "), "{line}");
        }
        assert_eq!(std::fs::read_to_string(&file).expect("there"), "old");
        assert_eq!(names(folder.path()), ["a.csv"]);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_device_is_an_error_with_its_remedy() {
        let error = write(Path::new("/dev/full"), "x").expect_err("full").to_string();
        assert!(
            error.contains("/dev/full: cannot be written: ") && error.contains("free space"),
            "{error}"
        );
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
