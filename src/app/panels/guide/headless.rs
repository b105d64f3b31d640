//! The command that repeats the present result.

use std::path::Path;

use resect_core::analysis::Settings;
use resect_io::source::Source;

/// File of the settings that the command reads.
pub const SETTINGS_FILE: &str = "settings.toml";

/// Returns `resect calibrate …` for a source; `None` for a sample, which has no path.
pub fn command(source: &Source, settings: &Settings) -> Option<String> {
    let mut words = vec!["resect calibrate".to_owned(), quoted(source.path()?)];
    words.extend(source.extras.drives.iter().map(|drive| format!("--drive {}", quoted(drive))));
    if *settings != Settings::default() {
        words.push(format!("--config {SETTINGS_FILE}"));
    }
    words.push("--json > calibration.json".to_owned());
    Some(words.join(" "))
}

/// Quotes a path as one word for a shell.
fn quoted(path: &Path) -> String {
    let text = path.display().to_string();
    let plain = |c: char| c.is_alphanumeric() || "/._-+:\\".contains(c);
    if !text.is_empty() && text.chars().all(plain) {
        text
    } else {
        format!("'{}'", text.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use resect_io::sample::Sample;
    use resect_io::source::Extras;

    #[test]
    fn the_command_names_path_drives_and_settings_that_differ() {
        let settings = Settings::default();
        let source = Source::at("/data/run_1");
        assert_eq!(
            command(&source, &settings).as_deref(),
            Some("resect calibrate /data/run_1 --json > calibration.json")
        );
        let drives = vec!["/data/it's here".into()];
        let source = source.with(Extras { drives, ..Extras::default() });
        let mut changed = settings;
        changed.pipeline.rate_hz = 5.0;
        assert_eq!(
            command(&source, &changed).as_deref(),
            Some(
                r"resect calibrate /data/run_1 --drive '/data/it'\''s here' --config settings.toml --json > calibration.json"
            )
        );
        assert_eq!(command(&Source::sample(Sample::Warthog), &settings), None);
    }

    /// The copied text of the settings file is read as the same settings.
    #[test]
    fn the_settings_come_back_from_their_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut settings = Settings::default();
        settings.pipeline.thresholds.tau_s_seconds = 1.7;
        settings.calibration.method = Some(resect_core::calibration::Method::InterPrism);
        let path = folder.path().join(SETTINGS_FILE);
        std::fs::write(&path, toml::to_string(&settings).expect("TOML")).expect("writable");
        assert_eq!(resect_io::settings_file::read(&path).expect("settings"), settings);
    }
}
