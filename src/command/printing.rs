//! Standard output and standard error.

use std::io::Write;
use std::path::Path;

use resect_core::deployment::printable::printable;
use resect_io::atomic::WriteError;

/// Says what is wrong, in one line whatever the names in it hold.
pub fn complain(line: &str) {
    // Nobody may be there to read it; the exit code says so much as well.
    _ = writeln!(std::io::stderr(), "resect: {}", printable(line));
}

/// Prints, and ends quietly when the reader has gone (`resect … | head`).
pub fn print(text: &str) -> Result<(), WriteError> {
    let mut out = std::io::stdout();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(WriteError::of_file(Path::new("standard output"), error))
        }
        _ => Ok(()),
    }
}
