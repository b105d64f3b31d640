//! The file of several drives (`resect evaluate --drives`): for each the ground truth, the estimates and options.

use std::path::{Path, PathBuf};

use toml::{Table, Value};

use crate::error::OpenError;
use crate::format::deployment_toml::parse_toml;
use resect_core::deployment::names::without_common_words;

/// A drive with its files and options.
#[derive(Clone, Debug, PartialEq)]
pub struct Drive {
    pub name: String,
    pub truths: Vec<PathBuf>,
    pub estimates: Vec<PathBuf>,
    /// Names of the estimates.
    pub names: Vec<String>,
    /// Options as flags of the command line: "--align", "rigid".
    pub flags: Vec<String>,
}

/// Reads the drives of a file. Its paths are relative to its folder.
///
/// # Errors
/// If the file cannot be read, lists no drives, or two drives have one name.
pub fn read(path: &Path) -> Result<Vec<Drive>, OpenError> {
    let text = std::fs::read_to_string(path)
        .map_err(|error| OpenError::Io { path: path.to_owned(), error })?;
    parse(path, &text)
}

fn parse(path: &Path, text: &str) -> Result<Vec<Drive>, OpenError> {
    let file = path.display().to_string();
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut options: Table = parse_toml(&file, text)?;
    let wrong = |(what, remedy): (String, &str)| OpenError::file(&file, what, remedy);
    let Some(Value::Array(entries)) = options
        .remove("drive")
        .filter(|drives| drives.as_array().is_some_and(|drives| !drives.is_empty()))
    else {
        return Err(wrong(("no drives".to_owned(), "list each drive as [[drive]]")));
    };
    let mut drives: Vec<Drive> = Vec::new();
    for entry in entries {
        let Value::Table(entry) = entry else {
            return Err(wrong(("a drive is no table".to_owned(), "list each drive as [[drive]]")));
        };
        let drive = drive(folder, &options, entry).map_err(wrong)?;
        if drives.iter().any(|known| known.name == drive.name) {
            let what = format!("two drives are named {}", drive.name);
            return Err(wrong((what, "give each drive its own name")));
        }
        drives.push(drive);
    }
    Ok(drives)
}

/// Returns the drive of a table, or the mistake and its remedy.
fn drive(
    folder: &Path,
    options: &Table,
    mut entry: Table,
) -> Result<Drive, (String, &'static str)> {
    let stem =
        |path: &str| Path::new(path).file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let truths = entry.remove("truth").map_or(Vec::new(), texts);
    let (names, estimates): (Vec<String>, Vec<String>) = match entry.remove("estimates") {
        Some(Value::Table(named)) => {
            let named = named.into_iter().map(|(name, path)| (name, texts(path)));
            named
                .flat_map(|(name, paths)| paths.into_iter().map(move |path| (name.clone(), path)))
                .unzip()
        }
        listed => {
            // The name of the drive in each file is left out, so that a system has one name in all drives.
            let paths = listed.map_or(Vec::new(), texts);
            let mut stems: Vec<String> =
                paths.iter().chain(truths.first()).map(|path| stem(path)).collect();
            stems = without_common_words(&stems, 0);
            stems.into_iter().zip(paths).unzip()
        }
    };
    let name = entry.remove("name").map_or(Vec::new(), texts).pop();
    let name = name.or_else(|| truths.first().map(|path| stem(path))).unwrap_or_default();
    if truths.is_empty() || estimates.is_empty() {
        let what = format!("drive {name} has no truth or no estimates");
        return Err((what, "give the paths of both as texts"));
    }
    let mut options = options.clone();
    options.extend(entry);
    let flags = flags(&options).map_err(|key| {
        let what = format!("drive {name}: `{key}` is neither a text, a number, true or false");
        (what, "name options as the flags of resect evaluate, without dashes")
    })?;
    let below = |paths: Vec<String>| paths.iter().map(|path| folder.join(path)).collect();
    Ok(Drive { name, truths: below(truths), estimates: below(estimates), names, flags })
}

/// Returns a text, or those of a list. Another kind of value is the name of a file that cannot be read, so that its row remains.
fn texts(value: Value) -> Vec<String> {
    match value {
        Value::String(text) => vec![text],
        Value::Array(values) => values.into_iter().flat_map(texts).collect(),
        other => vec![other.to_string()],
    }
}

/// Returns options as flags; a list repeats its flag. The error is the key of another kind of value.
fn flags(options: &Table) -> Result<Vec<String>, String> {
    let mut flags = Vec::new();
    for (key, value) in options {
        let values = match value {
            Value::Array(values) => &values[..],
            value => std::slice::from_ref(value),
        };
        for value in values {
            let text = match value {
                Value::Boolean(false) => continue,
                Value::Boolean(true) => {
                    flags.push(format!("--{key}"));
                    continue;
                }
                Value::String(text) => text.clone(),
                Value::Integer(number) => number.to_string(),
                Value::Float(number) => number.to_string(),
                _ => return Err(key.clone()),
            };
            flags.push(format!("--{key}={text}"));
        }
    }
    Ok(flags)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_of_a_drive_replace_those_of_all() {
        let text = "align = \"rigid\"\ndelta = [\"5m\", \"10s\"]\nall-pairs = true\n\n\
                    [[drive]]\nname = \"grass\"\ntruth = \"prism.tum\"\nestimates = { lio = \"a.tum\", dlo = \"b.tum\" }\n\
                    align = \"none\"\nall-pairs = false\nfrom = 3.5\n\n\
                    [[drive]]\ntruth = [\"1.pos\", \"2.pos\", \"3.pos\"]\nestimates = [\"c/slam.tum\"]\n";
        let drives = parse(Path::new("day/drives.toml"), text).expect("valid");
        assert_eq!(drives[0].names, ["dlo", "lio"]);
        assert_eq!(drives[0].estimates[1], Path::new("day/a.tum"));
        assert_eq!(drives[0].flags, ["--align=none", "--delta=5m", "--delta=10s", "--from=3.5"]);
        assert_eq!((&*drives[1].name, drives[1].truths.len()), ("1", 3));
        assert_eq!(drives[1].names, ["slam"]);
        assert!(drives[1].flags.contains(&"--all-pairs".to_owned()), "{drives:?}");
    }

    #[test]
    fn a_system_has_one_name_in_all_drives() {
        let drive = |area: &str| {
            format!(
                "[[drive]]\ntruth = \"{area}_prism.tum\"\nestimates = [\"{area}_fastlio2.tum\"]\n"
            )
        };
        let text = drive("handheld_room00") + &drive("ugv_parking00");
        let drives = parse(Path::new("drives.toml"), &text).expect("valid");
        assert!(drives.iter().all(|drive| drive.names == ["fastlio2"]), "{drives:?}");
    }

    #[test]
    fn an_incomplete_file_is_an_error_with_its_reason() {
        let one = "[[drive]]\ntruth = \"t.tum\"\nestimates = [\"a.tum\"]\n";
        for (text, why) in [
            ("align = \"rigid\"\n", "no drives"),
            ("drive = []\n", "no drives"),
            ("[[drive]]\nestimates = [\"a.tum\"]\n", "has no truth or no estimates"),
            ("[[drive]]\ntruth = \"t.tum\"\nestimates = []\n", "has no truth or no estimates"),
            (&format!("{one}{one}"), "two drives are named t"),
            (&format!("{one}body = {{ x = 1 }}\n"), "`body` is neither a text"),
        ] {
            let error = parse(Path::new("drives.toml"), text).expect_err(text).to_string();
            assert!(error.contains(why) && error.contains("drives.toml"), "{error}");
        }
    }
}
