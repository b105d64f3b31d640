//! Where a command may write: never over what it read, and to what has a name.

use std::path::Path;

use super::Failure;
use resect_report::trajectory::FileKind;

/// Refuses to write over any of the files that were read, and a dash, which elsewhere means standard output.
pub fn spare<'a>(out: &Path, read: impl IntoIterator<Item = &'a Path>) -> Result<(), Failure> {
    if out == Path::new("-") {
        let line = "`-` is no file, and nothing is written to standard output; name a file";
        return Err(Failure::Usage(line.to_owned()));
    }
    let Ok(target) = out.canonicalize() else { return Ok(()) };
    let is_target = |path: &Path| path.canonicalize().is_ok_and(|path| path == target);
    match read.into_iter().any(is_target) {
        true => Err(Failure::Input(anyhow::anyhow!(
            "{}: this is what was read, and is not written over; name another file",
            out.display()
        ))),
        false => Ok(()),
    }
}

/// What a trajectory's file is to be, by the ending of its name.
pub fn kind_of(file: &Path) -> Result<FileKind, Failure> {
    FileKind::of(file).map_err(|why| Failure::Usage(format!("{}: {why}", file.display())))
}

/// An error with the flag, or the command, that does what it advises.
pub fn advised(why: &dyn std::error::Error, flag: Option<&str>) -> anyhow::Error {
    match flag {
        Some(flag) => anyhow::anyhow!("{why} ({flag})"),
        None => anyhow::anyhow!("{why}"),
    }
}
