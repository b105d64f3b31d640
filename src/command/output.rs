//! The files that a command writes: never one of its inputs; a dash is standard output.

use std::path::Path;

use super::Failure;
use super::printing::print_bytes;
use resect_io::atomic::{self, WriteError};
use resect_report::trajectory::FileKind;

/// Returns true for the dash that means standard output.
pub fn is_standard_output(out: &Path) -> bool {
    out == Path::new("-")
}

/// Writes a file in one step, or to standard output for a dash.
pub fn write(out: &Path, content: impl AsRef<[u8]>) -> Result<(), WriteError> {
    if is_standard_output(out) {
        print_bytes(content.as_ref())
    } else {
        atomic::write(out, content)
    }
}

/// Refuses to overwrite any of the input files.
pub fn spare<'a>(out: &Path, read: impl IntoIterator<Item = &'a Path>) -> Result<(), Failure> {
    if is_standard_output(out) {
        return Ok(());
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

/// Refuses to overwrite any of the input files, and a dash, where only a file can be written.
pub fn spare_file<'a>(out: &Path, read: impl IntoIterator<Item = &'a Path>) -> Result<(), Failure> {
    if is_standard_output(out) {
        let line =
            "`-` is not a file, and this is not written to standard output; give a file name";
        return Err(Failure::Usage(line.to_owned()));
    }
    spare(out, read)
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
