//! The files from which a deployment is combined, before they are parsed.

use std::io::Read;
use std::path::{Path, PathBuf};

use super::collection;
use super::station_in_name::station_in_name;
use crate::error::OpenError;
use crate::extras::Extras;
use crate::format;
use crate::format::text_encoding::{decode, decode_text, text_reader};
use crate::format::{Format, recognise};
use crate::recording::station_index;
use crate::windows;
use resect_core::deployment::Overrides;
use resect_core::progress::Progress;

/// Depth of the search for files below the given folder.
pub const FOLDER_DEPTH: usize = 3;

/// A file before it is parsed: its text in memory, or its path on disk.
pub struct FoundFile {
    /// Path relative to the folder; the whole path if the user named the file.
    pub file: String,
    pub format: Format,
    pub content: Content,
    pub bytes: u64,
    pub standing: Standing,
}

pub enum Content {
    Disk(PathBuf),
    Memory(String),
}

/// Precedence of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standing {
    /// The file is in the folder of the tracks.
    Beside,
    /// The user named it.
    Named,
    /// The file is in the folder of the tracks, and the user named another instead.
    SetAside,
}

impl FoundFile {
    /// Recognises a file on disk by its first bytes.
    pub fn at(path: &Path, file: String) -> Result<Self, OpenError> {
        let io = |error| OpenError::Io { path: path.to_owned(), error };
        let metadata = path.metadata().map_err(io)?;
        // Opening a pipe would block.
        if !metadata.is_file() && !metadata.is_dir() {
            let what = "a pipe, a socket or a device, not a file";
            return Err(OpenError::file(&file, what, "save its output as a file"));
        }
        let mut head = Vec::new();
        let opened = std::fs::File::open(path).map_err(io)?;
        opened.take(4096).read_to_end(&mut head).map_err(io)?;
        let base_name = path.file_name().unwrap_or_default().to_string_lossy();
        Ok(Self {
            file,
            format: format::bag::recognise_compressed(&head, path)
                .unwrap_or_else(|| recognise(&base_name, &head)),
            content: Content::Disk(path.to_owned()),
            bytes: metadata.len(),
            standing: Standing::Beside,
        })
    }

    /// A file of the folder that cannot be read; it may not be needed.
    fn unreadable(path: &Path, top: &Path) -> Self {
        Self {
            file: below(top, path),
            format: Format::Unreadable,
            content: Content::Disk(path.to_owned()),
            bytes: 0,
            standing: Standing::Beside,
        }
    }

    /// Returns true if the file may be read as this format.
    pub fn serves_as(&self, format: Format) -> bool {
        self.format == format && self.standing != Standing::SetAside
    }

    /// Returns true if the file is read in addition to tracks.
    pub fn is_read_beside_tracks(&self) -> bool {
        let read = [&RIG[..], &CONTROL_POINTS, &GNSS].concat();
        self.standing != Standing::SetAside && read.contains(&self.format)
    }

    /// Returns a reader of the text, as UTF-8 with line feeds.
    pub fn reader(&self) -> Result<Box<dyn Read + '_>, OpenError> {
        match &self.content {
            Content::Memory(text) => Ok(Box::new(text.as_bytes())),
            Content::Disk(path) => std::fs::File::open(path)
                .and_then(text_reader)
                .map_err(|error| OpenError::Io { path: path.clone(), error }),
        }
    }

    /// Returns the first kilobytes of the text.
    pub fn head(&self) -> Result<String, OpenError> {
        let mut head = Vec::new();
        let io = |error| {
            OpenError::file(&self.file, format!("cannot be read ({error})"), "check the disk")
        };
        self.reader()?.take(4096).read_to_end(&mut head).map_err(io)?;
        Ok(decode(&head).into_owned())
    }

    /// Returns the text without a byte-order mark, and counts its bytes as done.
    pub fn text(&self, progress: &Progress) -> Result<String, OpenError> {
        let text = self.uncounted_text()?;
        progress.advance(self.bytes)?;
        Ok(text)
    }

    /// Returns the text, for a reader that counts its bytes itself.
    pub fn uncounted_text(&self) -> Result<String, OpenError> {
        match &self.content {
            Content::Memory(text) => Ok(decode(text.as_bytes()).into_owned()),
            Content::Disk(path) => {
                let bytes = std::fs::read(path)
                    .map_err(|error| OpenError::Io { path: path.clone(), error })?;
                decode_text(&bytes).ok_or_else(|| {
                    OpenError::file(&self.file, "not a text file", "save it as text")
                })
            }
        }
    }
}

/// All files of a deployment.
pub struct Found {
    /// Name of the deployment, unless `deployment.toml` names it.
    pub name: String,
    /// The file of tracks that was opened; `None` for a folder.
    pub chosen: Option<String>,
    /// Overrides of the user, which take precedence over `deployment.toml`.
    pub corrections: Overrides,
    pub files: Vec<FoundFile>,
}

/// Finds the files at a path: all of a folder, or a file of tracks and the other files of its folder.
pub fn find(path: &Path, progress: &Progress) -> Result<Found, OpenError> {
    let io = |error| OpenError::Io { path: path.to_owned(), error };
    let metadata = std::fs::metadata(path).map_err(io)?;
    let path = windows::canonical(path).map_err(io)?;
    let chosen = if metadata.is_dir() {
        None
    } else {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let format = FoundFile::at(&path, name.clone())?.format;
        // These represent their folder.
        (!matches!(format, Format::DeploymentToml | Format::RosbagMetadata)).then_some(name)
    };
    let folder = if metadata.is_dir() { &path } else { path.parent().unwrap_or(Path::new(".")) };
    if metadata.is_dir() {
        collection::refuse(folder)?;
    }
    // For a single file, the other files of its folder are used, but no subfolders.
    let files = list_folder(folder, if chosen.is_some() { 1 } else { FOLDER_DEPTH }, progress)?;
    let name = match &chosen {
        Some(file) => Path::new(file).file_stem(),
        None => folder.file_name(),
    };
    let name = name.unwrap_or_default().to_string_lossy().into_owned();
    if let Some(file) = &chosen
        && let Some(found) = files.iter().find(|f| &f.file == file)
        && !found.format.may_be_track()
    {
        return Err(OpenError::file(
            file,
            format!("contains no tracks of the stations ({})", found.format.describe()),
            "open its folder, a polar CSV (timestamp,id,distance,ha,va), or a ROS 1 or ROS 2 bag",
        ));
    }
    Ok(Found { name, chosen, corrections: Overrides::default(), files })
}

/// Returns files in memory, such as those of the built-in samples.
pub fn in_memory(name: &str, files: &[(&str, &str)]) -> Found {
    let mut files: Vec<FoundFile> = files
        .iter()
        .map(|(file, text)| FoundFile {
            file: (*file).to_owned(),
            format: recognise(file, text.as_bytes()),
            content: Content::Memory((*text).to_owned()),
            bytes: text.len() as u64,
            standing: Standing::Beside,
        })
        .collect();
    pass_over_derived(&mut files);
    Found { name: name.to_owned(), chosen: None, corrections: Overrides::default(), files }
}

/// Marks positions that were computed from tracks as ignored, by the name of their folder, or if their own name has no station.
fn pass_over_derived(files: &mut [FoundFile]) {
    const FOLDERS: [&str; 5] =
        ["filtered_prediction", "raw_prediction", "ground_truth", "uncertainty", "gps_data"];
    let place =
        |f: &FoundFile| f.file.split(['/', '\\']).rev().skip(1).any(|p| FOLDERS.contains(&p));
    for file in files.iter_mut().filter(|f| f.format == Format::CartesianTrack) {
        if place(file) || station_in_name(&file.file).and_then(|(_, n)| station_index(n)).is_none()
        {
            file.format = Format::Ignored("positions computed from tracks, not measured");
        }
    }
}

/// Returns a path relative to the folder, as `deployment.toml` names it.
fn below(top: &Path, path: &Path) -> String {
    let below = path.strip_prefix(top).map_or_else(|_| path.to_owned(), windows::with_slashes);
    below.to_string_lossy().into_owned()
}

/// Returns true if a folder is a link to one of its parents, which would cause an endless search.
fn leads_back(path: &Path, lies_in: &Path) -> bool {
    match (path.is_symlink(), path.canonicalize(), lies_in.canonicalize()) {
        (true, Ok(target), Ok(lies_in)) => lies_in.starts_with(target),
        _ => false,
    }
}

/// Lists the files in a folder and its subfolders, without hidden ones, sorted by name. Unreadable ones have the format
/// [`Format::Unreadable`].
pub fn list_folder(
    folder: &Path,
    depth: usize,
    progress: &Progress,
) -> Result<Vec<FoundFile>, OpenError> {
    fn visit(
        top: &Path,
        folder: &Path,
        depth: usize,
        progress: &Progress,
        into: &mut Vec<FoundFile>,
    ) -> Result<(), OpenError> {
        let io = |error| OpenError::Io { path: folder.to_owned(), error };
        for entry in std::fs::read_dir(folder).map_err(io)? {
            progress.check()?;
            let path = entry.map_err(io)?.path();
            let hidden =
                path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
            if hidden {
                continue;
            } else if path.is_dir() {
                if depth > 1 && !leads_back(&path, folder) {
                    match visit(top, &path, depth - 1, progress, into) {
                        Err(OpenError::Io { .. }) => into.push(FoundFile::unreadable(&path, top)),
                        visited => visited?,
                    }
                }
            } else if path.is_file() {
                into.push(match FoundFile::at(&path, below(top, &path)) {
                    Err(OpenError::Io { .. }) => FoundFile::unreadable(&path, top),
                    found => found?,
                });
            }
        }
        Ok(())
    }
    let mut files = Vec::new();
    visit(folder, folder, depth, progress, &mut files)?;
    files.sort_by(|a, b| a.file.cmp(&b.file));
    pass_over_derived(&mut files);
    Ok(files)
}

/// Formats of the files that the user can name in addition to the tracks.
const RIG: [Format; 3] = [Format::RigReading, Format::SensorPositions, Format::RigDistances];
const CONTROL_POINTS: [Format; 5] =
    [Format::ControlPoints, Format::Gsi, Format::JobXml, Format::Pillars, Format::SurveyedPoints];
const GNSS: [Format; 1] = [Format::RtklibPos];

impl Found {
    /// Adds the files that the user named, and sets aside those that they replace.
    pub fn add(&mut self, extras: &Extras) -> Result<(), OpenError> {
        self.corrections = extras.corrections.clone();
        if let Some(rig) = &extras.rig {
            self.set_aside(&RIG);
            let shown = rig.display().to_string();
            let files = if rig.is_dir() {
                // Only the rig's files, sorted.
                let mut files = list_folder(rig, FOLDER_DEPTH, &Progress::default())?;
                files.retain(|f| RIG.contains(&f.format));
                for file in &mut files {
                    file.file = rig.join(&file.file).display().to_string();
                }
                files
            } else {
                vec![FoundFile::at(rig, shown.clone())?]
            };
            if !files.iter().any(|f| RIG.contains(&f.format)) {
                let what = files.first().map_or("no such file in it", |f| f.format.describe());
                return Err(OpenError::file(
                    &shown,
                    format!("does not describe the rig ({what})"),
                    "give calibration_results.csv (distances 12, 13, 23 in m), calibration_raw.csv, or their folder",
                ));
            }
            files.into_iter().for_each(|file| self.name_file(file));
        }
        if extras.gcp_instead {
            self.set_aside(&CONTROL_POINTS);
        }
        for path in &extras.gcp {
            self.name_one(
                path,
                &CONTROL_POINTS,
                "contains no control points",
                "give readings (theodolite_number,marker_number,…), pillars or coordinates of control points",
            )?;
        }
        if !extras.gnss.is_empty() {
            self.set_aside(&GNSS);
        }
        for path in &extras.gnss {
            let remedy = "give the .pos files of antennas 1, 2 and 3";
            self.name_one(path, &GNSS, "contains no GNSS solutions", remedy)?;
        }
        Ok(())
    }

    fn set_aside(&mut self, formats: &[Format]) {
        for file in self.files.iter_mut().filter(|f| formats.contains(&f.format)) {
            file.standing = Standing::SetAside;
        }
    }

    fn name_one(
        &mut self,
        path: &Path,
        formats: &[Format],
        wrong: &str,
        remedy: &str,
    ) -> Result<(), OpenError> {
        let file = FoundFile::at(path, path.display().to_string())?;
        if !formats.contains(&file.format) {
            let what = format!("{wrong} ({})", file.format.describe());
            return Err(OpenError::file(&file.file, what, remedy));
        }
        self.name_file(file);
        Ok(())
    }

    /// Adds a file that the user named; the same file in the folder of the tracks is set aside.
    fn name_file(&mut self, file: FoundFile) {
        let same = |other: &FoundFile| match (&file.content, &other.content) {
            (Content::Disk(a), Content::Disk(b)) => {
                a.canonicalize().is_ok_and(|a| b.canonicalize().is_ok_and(|b| a == b))
            }
            _ => false,
        };
        for other in self.files.iter_mut().filter(|other| same(other)) {
            other.standing = Standing::SetAside;
        }
        self.files.push(FoundFile { standing: Standing::Named, ..file });
    }
}
