//! Standard output and standard error.

use std::io::Write;
use std::path::Path;

use super::progress_line::is_quiet;
use resect_core::deployment::printable::printable;
use resect_io::atomic::WriteError;

/// Prints an error in one line, whatever characters the names in it have.
pub fn complain(line: &str) {
    // Standard error may be closed; the exit code reports the failure as well.
    _ = writeln!(std::io::stderr(), "resect: {}", printable(line));
}

/// Prints a note on the work that is done, unless the user wants none.
pub fn note(line: &str) {
    if !is_quiet() {
        complain(line);
    }
}

/// Prints; ends quietly if the reader has closed the pipe (`resect … | head`).
pub fn print(text: &str) -> Result<(), WriteError> {
    print_bytes(text.as_bytes())
}

/// Prints a file.
pub fn print_bytes(content: &[u8]) -> Result<(), WriteError> {
    let mut out = std::io::stdout();
    match out.write_all(content).and_then(|()| out.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(WriteError::of_file(Path::new("standard output"), error))
        }
        _ => Ok(()),
    }
}
