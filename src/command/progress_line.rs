//! Progress of long work, as a line on the terminal.

use std::io::{IsTerminal, Write};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::mpsc;
use std::time::Duration;

use resect_core::progress::Progress;

/// Work shorter than this shows nothing.
const FIRST: Duration = Duration::from_millis(500);
const NEXT: Duration = Duration::from_millis(200);
/// Width of the bar (characters).
const BAR: usize = 24;
/// Erases the line. A console of Windows prints escape sequences unless a program switches them on.
const ERASE: &str = if cfg!(windows) {
    "\r                                                                      \r"
} else {
    "\r\x1b[2K"
};

static IS_QUIET: AtomicBool = AtomicBool::new(false);

/// Suppresses progress and notes from now on, by the flag of the command line.
pub fn be_quiet() {
    IS_QUIET.store(true, Relaxed);
}

pub fn is_quiet() -> bool {
    IS_QUIET.load(Relaxed)
}

/// Does work and shows its progress on standard error, if that is a terminal.
pub fn with_progress<T>(what: &str, work: impl FnOnce(&Progress) -> T) -> T {
    let progress = Progress::default();
    if is_quiet() || !std::io::stderr().is_terminal() {
        return work(&progress);
    }
    std::thread::scope(|scope| {
        let (ended, wait) = mpsc::channel::<()>();
        let progress = &progress;
        scope.spawn(move || show_until(&wait, what, progress));
        let result = work(progress);
        drop(ended);
        result
    })
}

/// Draws the line until the work ends, and removes it.
fn show_until(ended: &mpsc::Receiver<()>, what: &str, progress: &Progress) {
    let mut every = FIRST;
    let mut err = std::io::stderr();
    while ended.recv_timeout(every) == Err(mpsc::RecvTimeoutError::Timeout) {
        _ = write!(err, "{ERASE}{}", line(what, progress.share()));
        _ = err.flush();
        every = NEXT;
    }
    if every == NEXT {
        _ = write!(err, "{ERASE}");
        _ = err.flush();
    }
}

fn line(what: &str, share: Option<f32>) -> String {
    let Some(share) = share else { return format!("{what} …") };
    let full = (share * BAR as f32).round() as usize;
    let (full, empty) = ("#".repeat(full), "·".repeat(BAR - full.min(BAR)));
    format!("{what} [{full}{empty}] {:3.0} %", 100.0 * share)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_has_a_bar_once_the_total_is_known() {
        assert_eq!(line("reading", None), "reading …");
        let half = line("reading", Some(0.5));
        assert!(half.contains("############····") && half.ends_with(" 50 %"), "{half}");
        assert_eq!(line("a", Some(1.0)).chars().count(), line("a", Some(0.0)).chars().count());
    }
}
