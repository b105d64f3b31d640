//! Preferences of the user for all windows. TOML in the system's configuration folder.

use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use egui::ThemePreference;
use serde::{Deserialize, Serialize};

use super::damaged_file::{keep_aside, line_of};
use super::stored::Lenient;
use super::writer::Writer;
use crate::app::model::{LayoutDescription, Units};
use resect_core::deployment::Finding;
use resect_io::atomic;
use resect_io::source::Source;

/// Format version that this program writes.
const VERSION: u32 = 1;
const FILE: &str = "preferences.toml";
/// Greatest number of recent deployments that are saved.
const MOST_RECENT: usize = 12;

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Preferences {
    pub theme: Theme,
    /// True for large type and full contrast.
    pub in_the_sun: bool,
    pub units: Units,
    /// Layout of the panes; `None` until the user changes it.
    pub layout: Option<LayoutDescription>,
    /// Size of the window (points).
    pub window_points: Option<[f32; 2]>,
    /// True if the window was maximised when it closed.
    pub maximized: bool,
    /// True if the window closes with an unsaved session without a question.
    pub closes_unasked: bool,
    /// Newest first, without duplicates.
    pub recent: Vec<Recent>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Theme {
    #[default]
    System,
    Dark,
    Light,
}

impl From<ThemePreference> for Theme {
    fn from(theme: ThemePreference) -> Self {
        match theme {
            ThemePreference::System => Self::System,
            ThemePreference::Dark => Self::Dark,
            ThemePreference::Light => Self::Light,
        }
    }
}

impl From<Theme> for ThemePreference {
    fn from(theme: Theme) -> Self {
        match theme {
            Theme::System => Self::System,
            Theme::Dark => Self::Dark,
            Theme::Light => Self::Light,
        }
    }
}

/// A deployment that was opened before.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Recent {
    /// Time at which the deployment was last opened (s since 1970).
    pub opened_unix_s: u64,
    #[serde(flatten)]
    pub source: Source,
}

/// Moves a deployment to the front of the recent ones. Samples are skipped, because the menu lists them separately.
pub fn remember(recent: &mut Vec<Recent>, source: &Source) {
    if source.path().is_none() {
        return;
    }
    let now = SystemTime::now().duration_since(UNIX_EPOCH);
    let opened_unix_s = now.map_or(0, |since| since.as_secs());
    recent.retain(|recent| recent.source.place != source.place);
    recent.insert(0, Recent { opened_unix_s, source: source.clone() });
    recent.truncate(MOST_RECENT);
}

/// Preferences in the file's format. Unreadable fields are ignored.
#[derive(Serialize, Deserialize)]
struct StoredPreferences {
    version: u32,
    #[serde(default)]
    theme: Lenient<Theme>,
    #[serde(default)]
    in_the_sun: Lenient<bool>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    window_points: Option<Lenient<[f32; 2]>>,
    #[serde(default)]
    maximized: Lenient<bool>,
    #[serde(default)]
    closes_unasked: Lenient<bool>,
    #[serde(default)]
    units: Lenient<Units>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    recent: Vec<Lenient<Recent>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    layout: Option<Lenient<LayoutDescription>>,
}

impl StoredPreferences {
    fn new(preferences: &Preferences) -> Self {
        let Preferences {
            theme,
            in_the_sun,
            units,
            layout,
            window_points,
            maximized,
            closes_unasked,
            recent,
        } = preferences.clone();
        Self {
            version: VERSION,
            theme: Lenient::Read(theme),
            in_the_sun: Lenient::Read(in_the_sun),
            window_points: window_points.map(Lenient::Read),
            maximized: Lenient::Read(maximized),
            closes_unasked: Lenient::Read(closes_unasked),
            units: Lenient::Read(units),
            recent: recent.into_iter().map(Lenient::Read).collect(),
            layout: layout.map(Lenient::Read),
        }
    }

    fn read(self) -> (Preferences, Vec<Finding>) {
        let mut findings = Vec::new();
        let size = |it: Lenient<_>| it.read("preferences: the window's size", &mut findings);
        let window_points = self
            .window_points
            .and_then(size)
            .filter(|size: &[f32; 2]| size.iter().all(|side| (100.0..=100_000.0).contains(side)));
        let recent = self.recent.into_iter();
        let mut recent: Vec<Recent> = recent
            .filter_map(|it| it.read("preferences: a recent deployment", &mut findings))
            .collect();
        recent.truncate(MOST_RECENT);
        let preferences = Preferences {
            theme: self.theme.read("preferences: the theme", &mut findings).unwrap_or_default(),
            in_the_sun: self
                .in_the_sun
                .read("preferences: readable in the sun", &mut findings)
                .unwrap_or_default(),
            units: self.units.read("preferences: the units", &mut findings).unwrap_or_default(),
            layout: self.layout.and_then(|it| it.read("preferences: the layout", &mut findings)),
            window_points,
            maximized: self
                .maximized
                .read("preferences: the maximised window", &mut findings)
                .unwrap_or_default(),
            closes_unasked: self
                .closes_unasked
                .read("preferences: closing without a question", &mut findings)
                .unwrap_or_default(),
            recent,
        };
        (preferences, findings)
    }
}

/// The preferences file: read once, written in the background when preferences change.
pub struct PreferencesFile {
    path: PathBuf,
    /// False if the file is unreadable and could not be renamed, so that it must not be overwritten.
    may_write: bool,
    last: Preferences,
    writer: Writer,
}

impl PreferencesFile {
    /// Reads the file in a folder. An unusable file is renamed, never overwritten, and reported.
    pub fn open(folder: &Path) -> (Self, Preferences, Vec<Finding>) {
        let path = folder.join(FILE);
        let (preferences, findings, may_write) = read(&path);
        let writer = Writer::start("resect preferences");
        let file = Self { path, may_write, last: preferences.clone(), writer };
        (file, preferences, findings)
    }

    /// Saves the preferences in the background if they changed. Cheap enough for every possible change.
    pub fn keep(&mut self, preferences: &Preferences) {
        if !self.may_write || *preferences == self.last {
            return;
        }
        self.last = preferences.clone();
        let (path, preferences) = (self.path.clone(), preferences.clone());
        self.writer.write(move || {
            let text = toml::to_string(&StoredPreferences::new(&preferences))
                .map_err(|error| format!("preferences cannot be saved as text: {error}"))?;
            if let Some(folder) = path.parent() {
                atomic::make_folder(folder).map_err(|error| error.to_string())?;
            }
            atomic::write(&path, text).map_err(|error| error.to_string())
        });
    }

    /// Returns the error of the last write, once.
    pub fn take_error(&self) -> Option<String> {
        self.writer.take_error()
    }

    /// Waits until the preferences are written, as dropping this does.
    pub fn finish(&self) {
        self.writer.finish();
    }
}

/// Returns the preferences, the findings, and true if the file may be overwritten.
fn read(path: &Path) -> (Preferences, Vec<Finding>, bool) {
    let place = path.display();
    let (preferences, mut findings, wrong) = match std::fs::read_to_string(path) {
        Ok(text) => match toml::from_str::<StoredPreferences>(&text) {
            Ok(stored) => {
                // Only some fields of a newer version are known: these are used, and the file is preserved.
                let newer = stored.version > VERSION;
                let (preferences, findings) = stored.read();
                let wrong = match newer {
                    true => Some(format!("{place}: written by a newer resect")),
                    false if findings.is_empty() => None,
                    false => Some(format!("{place}: only partly readable")),
                };
                (preferences, findings, wrong)
            }
            Err(error) => {
                let line = error.span().map_or(1, |span| line_of(&text, span.start));
                let what = error.message().lines().next().unwrap_or_default();
                let why = format!("{place}:{line}: {what}; resect starts with default preferences");
                (Preferences::default(), Vec::new(), Some(why))
            }
        },
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            (Preferences::default(), Vec::new(), None)
        }
        Err(error) => {
            let why = format!("{place}: {error}; resect starts with default preferences");
            (Preferences::default(), Vec::new(), Some(why))
        }
    };
    let Some(why) = wrong else { return (preferences, findings, true) };
    let (moved, finding) = keep_aside(path, &why);
    findings.push(finding);
    (preferences, findings, moved)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::layout::Layout;
    use crate::app::model::LayoutPreset;
    use crate::app::model::{LengthUnit, TimeUnit};
    use resect_io::sample::Sample;

    fn changed() -> Preferences {
        let mut preferences = Preferences {
            theme: Theme::Light,
            in_the_sun: true,
            units: Units {
                length: LengthUnit::Millimetre,
                time: TimeUnit::Utc,
                ..Units::default()
            },
            layout: Some(Layout::from(LayoutPreset::Tune).describe()),
            window_points: Some([1200.0, 800.0]),
            maximized: true,
            closes_unasked: true,
            recent: Vec::new(),
        };
        remember(&mut preferences.recent, &Source::at("/data/one"));
        preferences
    }

    fn written(folder: &Path, preferences: &Preferences) -> String {
        let (mut file, ..) = PreferencesFile::open(folder);
        file.keep(preferences);
        file.finish();
        assert_eq!(file.take_error(), None);
        std::fs::read_to_string(folder.join(FILE)).expect("written")
    }

    #[test]
    fn what_was_set_is_there_the_next_time_and_written_only_when_it_is_another() {
        let top = tempfile::tempdir().expect("a folder");
        let folder = &top.path().join("not/there/yet");
        let (mut file, preferences, findings) = PreferencesFile::open(folder);
        assert_eq!((&preferences, findings), (&Preferences::default(), vec![]));
        file.keep(&preferences);
        drop(file);
        assert!(!folder.exists(), "nothing was changed, nothing is written");
        let preferences = changed();
        written(folder, &preferences);
        let (mut file, again, findings) = PreferencesFile::open(folder);
        assert_eq!((&again, findings), (&preferences, vec![]));
        std::fs::remove_file(folder.join(FILE)).expect("there");
        file.keep(&again);
        file.finish();
        assert!(!folder.join(FILE).exists());
    }

    #[test]
    fn recent_deployments_are_the_newest_first_each_once_and_not_too_many() {
        let mut preferences = Preferences::default();
        for number in 0..20 {
            remember(&mut preferences.recent, &Source::at(format!("/data/{number}")));
        }
        remember(&mut preferences.recent, &Source::sample(Sample::Warthog));
        remember(&mut preferences.recent, &Source::at("/data/15"));
        let titles: Vec<String> = preferences.recent.iter().map(|r| r.source.title()).collect();
        assert_eq!(titles.len(), MOST_RECENT);
        assert_eq!(titles[..4], ["15", "19", "18", "17"]);
        assert_eq!(titles.iter().filter(|title| *title == "15").count(), 1);
    }

    #[test]
    fn a_file_that_cannot_be_read_is_kept_aside_and_said() {
        let top = tempfile::tempdir().expect("a folder");
        let folder = top.path();
        let good = written(folder, &changed());
        let newer = good.replacen("version = 1", "version = 2", 1);
        let odd = good.replacen("\"light\"", "\"sepia\"", 1);
        // Readable fields are used.
        for (text, said, theme, recent) in [
            ("version = 1\ntheme = [", ":2: ", Theme::System, 0),
            (newer.as_str(), "newer resect", Theme::Light, 1),
            (odd.as_str(), "the theme", Theme::System, 1),
            ("\u{0}\u{1}", "starts with default", Theme::System, 0),
        ] {
            std::fs::write(folder.join(FILE), text).expect("written");
            let (file, preferences, findings) = PreferencesFile::open(folder);
            let lines: Vec<String> = findings.iter().map(ToString::to_string).collect();
            assert!(lines.iter().any(|line| line.contains(said)), "{lines:?}");
            let kept = lines.iter().find_map(|line| line.split_once("kept as ")).expect("kept").1;
            assert_eq!(std::fs::read_to_string(kept).expect("there"), text);
            assert_eq!((preferences.theme, preferences.recent.len()), (theme, recent), "{text}");
            drop(file);
        }
        let backups = std::fs::read_dir(folder).expect("a folder").count();
        assert_eq!(backups, 4, "each is kept");
    }
}
