//! CSV export of the channels pane.

use std::path::Path;
use std::sync::Arc;

use super::State;
use crate::app::file_dialog::Question;
use crate::app::model::{ChannelPlots, Horizontal, Visibility};
use crate::app::prepared::channels::{Channel, Sources, Subject};
use resect_core::network::PerStation;
use resect_core::pipeline::Fates;
use resect_io::atomic;
use resect_report::csv::io_error;

/// The values to be written.
struct ChannelTable {
    plots: ChannelPlots,
    visible: Visibility,
    /// Time since the first measurement (s).
    window_s: [f64; 2],
    /// Fate of each raw reading, by station; `None` without that column.
    fates: Option<Arc<PerStation<Fates>>>,
}

impl State {
    /// Asks for a file and writes all values within the time window, in metres, radians and seconds of the stations' clock
    /// as in all files.
    pub(super) fn save_channels(&mut self) {
        let Some((open, analysis)) = self.analysed() else {
            self.toasts.error("there is nothing to save yet; open a deployment first");
            return;
        };
        let (plots, visible) = (self.time.plots.clone(), self.scene.visibility);
        let sources = open.sources();
        if plots.channels().all(|channel| plots.seen(channel, sources, &visible).is_empty()) {
            self.toasts.error(
                "no channel with values is shown; choose one under Show… in the Channels pane",
            );
            return;
        }
        let (prepared, way) = (Arc::clone(&open.plots), open.way.newest.clone());
        let start_s = open.start_s();
        let window_s = open.timeline.window_s.map(|time_s| time_s - start_s);
        let fates = plots.fates && plots.channels().any(Channel::is_of_readings);
        let fates = fates.then(|| Arc::clone(&analysis.pipeline.fates));
        let table = ChannelTable { plots, visible, window_s, fates };
        // The name distinguishes several tables of one deployment.
        let (what, of) = (table.plots.in_words(), open.deployment.name.clone());
        let title = format!("Save {what} (CSV)");
        let answer = self.ask(Question::new_file(&title, &format!("{of} {what}"), "csv"));
        self.tell_when_done(move || {
            let path = answer.wait()?;
            let sources = Sources { plots: &prepared, way: way.as_deref(), start_s };
            let written = write(&path, sources, &table);
            Some(written.map(|rows| format!("{rows} rows written to {}", path.display())))
        });
    }
}

/// Writes one channel under the name of its column, or several as rows with their names; returns the number of rows.
fn write(path: &Path, sources: Sources<'_>, table: &ChannelTable) -> Result<usize, String> {
    let plots = &table.plots;
    let channels: Vec<Channel> = plots.channels().collect();
    let has_sigma = channels.iter().any(|channel| channel.subject() == Subject::Vehicle);
    let mut rows = 0;
    let written = atomic::write_with(path, |file| {
        let mut writer = csv::Writer::from_writer(file);
        let against = plots.against.map(Horizontal::column);
        let mut header = vec!["series", "time_s"];
        header.extend(against.as_deref());
        match channels[..] {
            [only] => header.push(only.describe().column),
            _ => header.extend(["channel", "value"]),
        }
        header.extend(has_sigma.then_some("sigma"));
        header.extend(table.fates.is_some().then_some("fate"));
        writer.write_record(header).map_err(io_error)?;
        for channel in &channels {
            for seen in plots.seen(*channel, sources, &table.visible) {
                for values in seen.series.rows(seen.against, table.window_s) {
                    let time_s = sources.start_s + values.since_s;
                    let mut row = vec![seen.name.clone(), time_s.to_string()];
                    if plots.against.is_some() {
                        row.push(optional(values.other));
                    }
                    if channels.len() > 1 {
                        row.push(channel.describe().column.to_owned());
                    }
                    row.push(values.value.to_string());
                    if has_sigma {
                        row.push(optional(values.sigma));
                    }
                    if let Some(fates) = &table.fates {
                        let own = fates[seen.subject.1].each.get(values.index);
                        let fate = own.filter(|_| channel.is_of_readings());
                        row.push(fate.map_or_else(String::new, |fate| fate.label().to_owned()));
                    }
                    writer.write_record(row).map_err(io_error)?;
                    rows += 1;
                }
            }
        }
        writer.flush()
    });
    written.map(|()| rows).map_err(|error| error.to_string())
}

/// Formats a value; an empty cell for `None`.
fn optional(value: Option<f64>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}
