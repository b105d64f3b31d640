//! From a path to a deployment: what is in a folder, which file plays which part, and what is missing.

mod control_points;
mod gnss;
mod rig;

use std::io::Read;
use std::path::{Path, PathBuf};

use super::format::{self, Format, OpenError, deployment_toml::Overrides, recognise};
use super::{Deployment, Finding, RawRecord, assemble_tracks};
use control_points::read_control_point_sets;
pub use control_points::read_control_points;
use gnss::read_gnss;
use rig::read_rig;

/// What the MT1000 prism adds to a range (m), unless `deployment.toml` says otherwise.
const PRISM_CONSTANT_M: f64 = 0.010;
/// How deep below the given folder files are looked for.
const FOLDER_DEPTH: usize = 3;

/// A file that was looked at, and what became of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ingredient {
    /// Relative to the folder.
    pub file: String,
    /// What it holds, or why it was passed over.
    pub what: &'static str,
    pub used: bool,
}

/// A file before it is parsed: small ones in memory, bags where they lie.
struct Source {
    file: String,
    format: Format,
    place: Place,
}

enum Place {
    Disk(PathBuf),
    Memory(String),
}

impl Source {
    fn text(&self) -> Result<String, OpenError> {
        self.raw_text().map(|text| text.trim_start_matches(format::BYTE_ORDER_MARK).to_owned())
    }

    fn raw_text(&self) -> Result<String, OpenError> {
        match &self.place {
            Place::Memory(text) => Ok(text.clone()),
            Place::Disk(path) => {
                let bytes = std::fs::read(path)
                    .map_err(|error| OpenError::Io { path: path.clone(), error })?;
                String::from_utf8(bytes)
                    .map_err(|_| OpenError::file(&self.file, "not UTF-8 text", "save it as UTF-8"))
            }
        }
    }
}

/// Opens a folder by looking at what is in it, or a file of tracks with the rest of its folder.
pub fn open(path: &Path) -> Result<Deployment, OpenError> {
    open_with(path, None)
}

/// Like [`open`], with the rig taken from another folder or file where the data has none beside it.
pub fn open_with(path: &Path, rig_path: Option<&Path>) -> Result<Deployment, OpenError> {
    let io = |error| OpenError::Io { path: path.to_owned(), error };
    let metadata = std::fs::metadata(path).map_err(io)?;
    let path = &path.canonicalize().map_err(io)?;
    let (folder, chosen) = if metadata.is_dir() {
        (path.as_path(), None)
    } else {
        let folder = path.parent().unwrap_or(Path::new("."));
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        (folder, Some(name))
    };
    let mut sources = if let Some(chosen) = &chosen
        && chosen != "deployment.toml"
    {
        // A single file: its neighbours can help, the folders below them are none of its business.
        list_folder(folder, 1)?
    } else {
        list_folder(folder, FOLDER_DEPTH)?
    };
    if let Some(rig_path) = rig_path {
        sources.retain(|s| !matches!(s.format, Format::RigReading | Format::RigDistances));
        let extra = if rig_path.is_dir() {
            list_folder(rig_path, FOLDER_DEPTH)?
        } else {
            vec![source_at(rig_path, rig_path.to_string_lossy().into_owned())?]
        };
        sources.extend(
            extra
                .into_iter()
                .filter(|s| matches!(s.format, Format::RigReading | Format::RigDistances)),
        );
    }
    let name = match &chosen {
        Some(file) if file != "deployment.toml" => {
            Path::new(file).file_stem().unwrap_or_default().to_string_lossy().into_owned()
        }
        _ => folder.file_name().unwrap_or_default().to_string_lossy().into_owned(),
    };
    let chosen = chosen.filter(|file| file != "deployment.toml");
    if let Some(file) = &chosen
        && let Some(source) = sources.iter().find(|s| &s.file == file)
        && !source.format.is_track()
    {
        return Err(OpenError::file(
            file,
            format!("holds no tracks of the stations ({})", source.format.describe()),
            "open its folder, or a polar CSV (timestamp,id,distance,ha,va) or a ROS 1 bag",
        ));
    }
    combine(name, chosen.as_deref(), &sources)
}

/// Opens files that are already in memory, as the built-in samples are.
pub fn open_files(name: &str, files: &[(&str, &str)]) -> Result<Deployment, OpenError> {
    let sources: Vec<_> = files
        .iter()
        .map(|(file, text)| Source {
            file: (*file).to_owned(),
            format: recognise(file, text.as_bytes()),
            place: Place::Memory((*text).to_owned()),
        })
        .collect();
    combine(name.to_owned(), None, &sources)
}

fn list_folder(folder: &Path, depth: usize) -> Result<Vec<Source>, OpenError> {
    fn visit(
        top: &Path,
        folder: &Path,
        depth: usize,
        into: &mut Vec<Source>,
    ) -> Result<(), OpenError> {
        let io = |error| OpenError::Io { path: folder.to_owned(), error };
        for entry in std::fs::read_dir(folder).map_err(io)? {
            let path = entry.map_err(io)?.path();
            let hidden =
                path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
            if hidden {
                continue;
            } else if path.is_dir() {
                if depth > 1 {
                    visit(top, &path, depth - 1, into)?;
                }
            } else if path.is_file() {
                let file = path.strip_prefix(top).unwrap_or(&path).to_string_lossy().into_owned();
                into.push(source_at(&path, file)?);
            }
        }
        Ok(())
    }
    let mut sources = Vec::new();
    visit(folder, folder, depth, &mut sources)?;
    sources.sort_by(|a, b| a.file.cmp(&b.file));
    Ok(sources)
}

fn source_at(path: &Path, file: String) -> Result<Source, OpenError> {
    let io = |error| OpenError::Io { path: path.to_owned(), error };
    let mut head = Vec::new();
    std::fs::File::open(path).and_then(|f| f.take(4096).read_to_end(&mut head)).map_err(io)?;
    let base_name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    Ok(Source { file, format: recognise(&base_name, &head), place: Place::Disk(path.to_owned()) })
}

/// Gives every source its part, reads those that have one, and says what was passed over.
fn combine(
    name: String,
    chosen: Option<&str>,
    sources: &[Source],
) -> Result<Deployment, OpenError> {
    // Only the folder's own: one further down belongs to another deployment.
    let is_overrides =
        |s: &&Source| s.format == Format::DeploymentToml && s.file == "deployment.toml";
    let overrides = match sources.iter().find(is_overrides) {
        Some(source) => format::deployment_toml::read(&source.file, &source.text()?)?,
        None => Overrides::default(),
    };
    let prism_constant_m = overrides.prism_constant_m.unwrap_or(PRISM_CONSTANT_M);
    if !(-1.0..=1.0).contains(&prism_constant_m) {
        return Err(OpenError::file(
            "deployment.toml",
            format!("prism_constant_m is {prism_constant_m}"),
            "prism constants are a few hundredths of a metre",
        ));
    }
    let name = overrides.name.clone().unwrap_or(name);
    let mut findings = Vec::new();
    let mut used: Vec<&str> = Vec::new();
    used.extend(sources.iter().filter(is_overrides).map(|s| s.file.as_str()));

    let track_source = choose_tracks(&name, chosen.or(overrides.tracks.as_deref()), sources)?;
    used.push(&track_source.file);
    let (records, place_word) = read_records(track_source)?;
    let (tracks, track_findings) =
        assemble_tracks(&records, prism_constant_m, &track_source.file, place_word);
    findings.extend(track_findings);
    if tracks.iter().all(|track| track.measurements.is_empty()) {
        return Err(OpenError::file(
            &track_source.file,
            "no usable measurement of any station",
            "stations are numbered 1, 2, 3 and a valid reading has status 0",
        ));
    }

    let (control_points, used_sets) =
        read_control_point_sets(sources, &overrides, prism_constant_m, &mut findings)?;
    used.extend(used_sets);

    let rig = read_rig(sources, &overrides, prism_constant_m, &mut used, &mut findings)?;
    let gnss = read_gnss(sources, &overrides, &mut used, &mut findings)?;
    let constant_from =
        if overrides.prism_constant_m.is_some() { "deployment.toml" } else { "the MT1000" };
    findings.push(Finding::note(format!(
        "prism constant of {constant_from}, {:+.1} mm, added to every range",
        prism_constant_m * 1e3
    )));

    let ingredients = sources
        .iter()
        .map(|s| Ingredient {
            file: s.file.clone(),
            what: s.format.describe(),
            used: used.contains(&s.file.as_str()),
        })
        .collect();
    if overrides.prisms.is_some_and(|prisms| prisms != 1 && prisms != 3) {
        return Err(OpenError::file(
            "deployment.toml",
            "prisms must be 1 (all stations follow one) or 3",
            "leave it out to have it recognised",
        ));
    }
    let prisms = overrides.prisms;
    Ok(Deployment { name, tracks, control_points, rig, prisms, gnss, ingredients, findings })
}

/// The one source of tracks. Two representations in one folder are a question to the user.
fn choose_tracks<'a>(
    name: &str,
    chosen: Option<&str>,
    sources: &'a [Source],
) -> Result<&'a Source, OpenError> {
    let candidates: Vec<_> = sources.iter().filter(|s| s.format.is_track()).collect();
    let names = || candidates.iter().map(|s| s.file.as_str()).collect::<Vec<_>>().join(", ");
    if let Some(chosen) = chosen {
        return candidates.iter().find(|s| s.file == chosen).copied().ok_or_else(|| {
            OpenError::file(
                name,
                format!("`{chosen}` is no file with tracks (hidden files are not looked at)"),
                format!("the candidates here: {}", names()),
            )
        });
    }
    match candidates[..] {
        [only] => Ok(only),
        [] => {
            let mut seen: Vec<_> =
                sources.iter().map(|s| format!("{} ({})", s.file, s.format.describe())).collect();
            seen.truncate(4);
            let seen = if seen.is_empty() { "no file".to_owned() } else { seen.join(", ") };
            Err(OpenError::file(
                name,
                format!("no tracks of the stations among: {seen}"),
                "open a folder with a polar CSV (timestamp,id,distance,ha,va) or a ROS 1 bag",
            ))
        }
        _ => Err(OpenError::file(
            name,
            format!("several files hold tracks: {}", names()),
            "open one of these files, or name it in deployment.toml: tracks = \"…\"",
        )),
    }
}

fn read_records(source: &Source) -> Result<(Vec<RawRecord>, &'static str), OpenError> {
    match (&source.place, source.format) {
        (Place::Disk(path), Format::Ros1Bag) => {
            Ok((format::ros1_bag::read(path, &source.file)?, "message"))
        }
        _ => Ok((format::polar_csv::read(&source.file, &source.text()?)?, "line")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRACKS: &str =
        "timestamp,id,distance,ha,va\n0.0,1,10,0.1,1.5\n0.1,2,11,0.1,1.5\n0.2,3,12,0.1,1.5\n";

    #[test]
    fn two_representations_are_a_question() {
        let error =
            open_files("d", &[("a.csv", TRACKS), ("b.csv", TRACKS)]).expect_err("ambiguous");
        assert!(error.to_string().contains("several files hold tracks: a.csv, b.csv"), "{error}");
        let toml = "tracks = \"b.csv\"\nprism_constant_m = 0.0\ninter_prism_m = [0.7, 0.9, 1.0]\n";
        let files = [("a.csv", TRACKS), ("b.csv", TRACKS), ("deployment.toml", toml)];
        let deployment = open_files("d", &files).expect("the override decides");
        assert_eq!(deployment.tracks[0].prism_constant_m, 0.0);
        assert_eq!(deployment.rig.expect("given").inter_prism_m, [0.7, 0.9, 1.0]);
        let unused: Vec<_> = deployment.ingredients.iter().filter(|i| !i.used).collect();
        assert_eq!(unused.len(), 1);
        assert_eq!(unused[0].file, "a.csv");
    }

    #[test]
    fn errors_name_file_line_and_remedy() {
        let cases: [(&str, &str); 5] = [
            (
                "timestamp;id;distance;ha;va\n0;1;2;3;4\n",
                "a.csv:1: the columns are separated by semicolons",
            ),
            (
                "timestamp,id,distance,ha,va\n0.0,1,10,x,1.5\n",
                "a.csv:2: `x` in column `ha` is not a number",
            ),
            ("timestamp,id,distance,ha,va\n0.0,1,10\n", "a.csv:2: 3 fields where the header has 5"),
            ("timestamp,id,distance,ha,va\n", "a.csv: has a header but no measurement"),
            ("", "no tracks of the stations"),
        ];
        for (text, expected) in cases {
            let error = open_files("d", &[("a.csv", text)]).expect_err(expected).to_string();
            assert!(error.contains(expected), "expected `{expected}`, got `{error}`");
            assert!(error.contains("; "), "no remedy in `{error}`");
        }
    }

    #[test]
    fn an_impossible_rig_is_refused() {
        let error = open_files("d", &[("a.csv", TRACKS), ("rig.txt", "0.1 0.2 1.0")])
            .expect_err("triangle");
        assert!(error.to_string().contains("not the sides of a triangle"), "{error}");
    }

    #[test]
    fn a_typo_in_the_overrides_is_refused() {
        let files =
            [("a.csv", TRACKS), ("deployment.toml", "name = \"x\"\nprism_constant = 0.0\n")];
        let error = open_files("d", &files).expect_err("unknown key").to_string();
        assert!(error.starts_with("deployment.toml:2: unknown field"), "{error}");
    }
}
