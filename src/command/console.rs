//! The console of the window's program on Windows.
//!
//! resect belongs to the console subsystem: shells wait for such a program and see its exit code. They do neither for a program of the
//! GUI subsystem, even if it attaches itself to their console. In return, Explorer opens a console with the program. Windows 11 24H2
//! and later do not, because `packaging/windows.manifest` says so; on older systems this module leaves the console, which closes it.

use std::io::IsTerminal;
use std::os::windows::io::{AsRawHandle, IntoRawHandle};
use std::sync::atomic::{AtomicBool, Ordering};

use win32console::console::{HandleType, WinConsole};
use win32console::structs::handle::Handle;

/// True if nobody sees what the program prints.
static IS_UNSEEN: AtomicBool = AtomicBool::new(false);

/// Leaves the console if it was opened for this process alone.
pub fn leave_own() {
    let stderr = std::io::stderr();
    let is_unseen = match WinConsole::get_process_list() {
        // The list is padded with zeros.
        Ok(processes) if processes.iter().filter(|id| **id != 0).count() == 1 => {
            let was_seen = stderr.is_terminal();
            leave();
            was_seen
        }
        Ok(_) => false,
        // Without a console, output can still be redirected.
        Err(_) => stderr.as_raw_handle().is_null(),
    };
    IS_UNSEEN.store(is_unseen, Ordering::Relaxed);
}

fn leave() {
    let streams: [(HandleType, bool); 2] = [
        (HandleType::Output, std::io::stdout().is_terminal()),
        (HandleType::Error, std::io::stderr().is_terminal()),
    ];
    if WinConsole::free_console().is_err() {
        return;
    }
    for (stream, was_console) in streams {
        // Another file may get the number of the closed handle, and would then get the output.
        if was_console && let Ok(nowhere) = std::fs::File::options().write(true).open("NUL") {
            let nowhere = Handle::new(nowhere.into_raw_handle().cast());
            _ = WinConsole::set_std_handle(stream, nowhere);
        }
    }
}

/// Shows why the window did not open, if nobody sees what the program prints.
pub fn show(why: &str) {
    if IS_UNSEEN.load(Ordering::Relaxed) {
        let dialog = rfd::MessageDialog::new().set_level(rfd::MessageLevel::Error);
        dialog.set_title("resect").set_description(why).show();
    }
}
