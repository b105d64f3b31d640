//! The program in the menus of a Linux desktop: desktop entry, icon, and the file type of sessions.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, anyhow};

use super::{Failure, print};
use resect_io::atomic;

/// The MIME type of `*.resect.toml`: a program that does not know it opens a session as text.
const FILE_TYPE: &str = include_str!("../../assets/resect-session.xml");

/// The entry of packages, whose program is in the search path.
const ENTRY: &str = include_str!("../../packaging/resect.desktop");

/// Programs that make a running desktop read the new files, with the folder that is their argument.
const READ_ANEW: [(&str, &str); 2] =
    [("update-desktop-database", "applications"), ("update-mime-database", "mime")];

/// Writes the files, and tells the desktop to read them.
pub fn add() -> Result<(), Failure> {
    let data = data_folder()?;
    for (path, bytes) in files(&data)? {
        if let Some(folder) = path.parent() {
            // The write below reports the same failure in a line of its own.
            _ = std::fs::create_dir_all(folder);
        }
        atomic::write(&path, bytes)?;
        print(&format!("{}\n", path.display()))?;
    }
    read_anew(&data)
}

/// Removes the files.
pub fn remove() -> Result<(), Failure> {
    let data = data_folder()?;
    let mut changed = false;
    for (path, _) in files(&data)? {
        match std::fs::remove_file(&path) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => continue,
            other => other.with_context(|| {
                format!("{}: cannot be removed; remove it by hand", path.display())
            })?,
        }
        print(&format!("{}: removed\n", path.display()))?;
        changed = true;
    }
    if changed { read_anew(&data) } else { Ok(print("nothing to remove\n")?) }
}

fn data_folder() -> Result<PathBuf, Failure> {
    let folders = directories::BaseDirs::new()
        .ok_or_else(|| anyhow!("the home folder is unknown; set HOME or XDG_DATA_HOME"))?;
    Ok(folders.data_dir().to_owned())
}

fn read_anew(data: &Path) -> Result<(), Failure> {
    for (updater, folder) in READ_ANEW {
        let mut command = Command::new(updater);
        command.arg(data.join(folder)).stdout(Stdio::null()).stderr(Stdio::null());
        if !command.status().is_ok_and(|status| status.success()) {
            print(&format!("{updater} did not run: the desktop sees it at the next login\n"))?;
        }
    }
    Ok(())
}

/// The files to install in the user's data folder (freedesktop.org: desktop entry, icon theme and shared MIME info).
fn files(data: &Path) -> Result<[(PathBuf, Vec<u8>); 3], Failure> {
    let program = std::env::current_exe().context("the program's own file is not found")?;
    let icon = include_bytes!("../../assets/icon.png").to_vec();
    Ok([
        (data.join("applications/resect.desktop"), entry(&program)?.into_bytes()),
        (data.join("icons/hicolor/256x256/apps/resect.png"), icon),
        (data.join("mime/packages/resect.xml"), FILE_TYPE.into()),
    ])
}

/// The desktop entry. It contains the absolute path of the program, since not every desktop has the folder of `cargo install` in its path.
fn entry(program: &Path) -> Result<String, Failure> {
    let program =
        program.to_str().filter(|path| !path.contains(char::is_control)).ok_or_else(|| {
            anyhow!("{}: no desktop entry can name this path; move the program", program.display())
        })?;
    let mut quoted = String::new();
    for letter in program.chars() {
        match letter {
            // Quoted once as an argument and once more as a string.
            '\\' => quoted.push_str(r"\\\\"),
            '"' | '`' | '$' => quoted.extend(['\\', '\\', letter]),
            '%' => quoted.push_str("%%"),
            _ => quoted.push(letter),
        }
    }
    Ok(ENTRY.replace("Exec=resect", &format!("Exec=\"{quoted}\"")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_program_is_named_as_desktop_entries_quote_it() {
        let entry = entry(Path::new("/home/a b/100%/$x/resect")).expect("an entry");
        assert!(entry.contains("Exec=\"/home/a b/100%%/\\\\$x/resect\" %F\n"), "{entry}");
        super::entry(Path::new("/home/a\nb/resect")).expect_err("no line may break");
    }
}
