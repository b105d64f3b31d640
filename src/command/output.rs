//! Checks of the files that a command writes: never one of its inputs, and never without a name.

use std::path::Path;

use super::Failure;
use resect_report::trajectory::FileKind;

/// Refuses to overwrite any of the input files, and refuses a dash, which elsewhere means standard output.
pub fn spare<'a>(out: &Path, read: impl IntoIterator<Item = &'a Path>) -> Result<(), Failure> {
    if out == Path::new("-") {
        let line = "`-` is not a file, and standard output is not supported; give a file name";
        return Err(Failure::Usage(line.to_owned()));
    }
    let Ok(target) = out.canonicalize() else { return Ok(()) };
    let is_target = |path: &Path| path.canonicalize().is_ok_and(|path| path == target);
    match read.into_iter().any(is_target) {
        true => Err(Failure::Input(anyhow::anyhow!(
            "{}: this is an input file and is not overwritten; choose another file",
            out.display()
        ))),
        false => Ok(()),
    }
}

/// Returns the file format of a trajectory, by the extension of its name.
pub fn kind_of(file: &Path) -> Result<FileKind, Failure> {
    FileKind::of(file).map_err(|why| Failure::Usage(format!("{}: {why}", file.display())))
}

/// Returns an error with the flag, or the command, that follows its advice.
pub fn advised(why: &dyn std::error::Error, flag: Option<&str>) -> anyhow::Error {
    match flag {
        Some(flag) => anyhow::anyhow!("{why} ({flag})"),
        None => anyhow::anyhow!("{why}"),
    }
}
