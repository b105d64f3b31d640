//! What the pane of channels shows, as a table for other programs.

use std::path::Path;

use super::State;
use crate::app::file_dialog::Question;
use crate::app::model::{Plotted, Visibility};
use crate::app::prepared::PreparedPlots;
use crate::app::prepared::channels::Channel;
use resect_io::atomic;
use resect_report::csv::io_error;

/// What is written.
struct Shown {
    plotted: Plotted,
    visible: Visibility,
    /// Since the first measurement (s).
    window_s: [f64; 2],
}

impl State {
    /// Asks for a file and has every value written that is within the window of time: metres, radians and seconds of the
    /// stations' clock, as in all files.
    pub(super) fn save_channels(&mut self) {
        let Some((open, _)) = self.analysed() else {
            self.toasts.error("there is nothing to save yet; open a deployment first");
            return;
        };
        if self.time.plotted.seen(&open.plots, &self.scene.visibility).is_empty() {
            let what = self.time.plotted.in_words();
            self.toasts.error(&format!(
                "{what}: the data has none, or all are hidden; show another in the pane Channels"
            ));
            return;
        }
        let (plots, start_s) = (std::sync::Arc::clone(&open.plots), open.start_s());
        let window_s = open.timeline.window_s.map(|time_s| time_s - start_s);
        let shown = Shown { plotted: self.time.plotted, visible: self.scene.visibility, window_s };
        // Several of one deployment are saved beside each other.
        let (what, of) = (self.time.plotted.in_words(), open.deployment.name.clone());
        let title = format!("Save {what} (CSV)");
        let answer = self.ask(Question::new_file(&title, &format!("{of} {what}"), "csv"));
        self.tell_when_done(move || {
            let path = answer.wait()?;
            let written = write(&path, &plots, &shown, start_s);
            Some(written.map(|rows| format!("{rows} rows written to {}", path.display())))
        });
    }
}

/// Gives how many rows there are below the names of the columns.
fn write(path: &Path, plots: &PreparedPlots, shown: &Shown, start_s: f64) -> Result<usize, String> {
    let Plotted { channel, against } = shown.plotted;
    let mut rows = 0;
    let written = atomic::write_with(path, |file| {
        let mut table = csv::Writer::from_writer(file);
        let mut header = vec!["series", "time_s"];
        header.extend(against.map(Channel::column));
        header.push(channel.column());
        table.write_record(header).map_err(io_error)?;
        for seen in shown.plotted.seen(plots, &shown.visible) {
            for (since_s, other, value) in seen.series.rows(seen.against, shown.window_s) {
                let mut row = vec![seen.name.clone(), (start_s + since_s).to_string()];
                if against.is_some() {
                    // Where the other has no value at that time, its cell is empty.
                    row.push(other.map_or_else(String::new, |other| other.to_string()));
                }
                row.push(value.to_string());
                table.write_record(row).map_err(io_error)?;
                rows += 1;
            }
        }
        table.flush()
    });
    written.map(|()| rows).map_err(|error| error.to_string())
}
