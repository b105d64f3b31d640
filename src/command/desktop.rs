//! `resect desktop`: adds the program to the menus of a Linux desktop, with its icon and the file type of its sessions.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, anyhow};
use clap::Args;

use super::{Failure, print};
use resect_io::atomic;

#[derive(Args)]
pub struct DesktopArguments {
    /// Remove it from the menus
    #[arg(long)]
    remove: bool,
}

/// The MIME type of `*.resect.toml`: a program that does not know it opens a session as text.
const FILE_TYPE: &str = include_str!("../../assets/resect-session.xml");

/// The entry of packages, whose program is in the search path.
const ENTRY: &str = include_str!("../../packaging/resect.desktop");

/// Programs that make a running desktop read the new files, with the folder that is their argument.
const READ_ANEW: [(&str, &str); 2] =
    [("update-desktop-database", "applications"), ("update-mime-database", "mime")];

pub fn run(arguments: &DesktopArguments) -> Result<(), Failure> {
    if !cfg!(target_os = "linux") {
        let line = "desktop: menus and file types can be set on Linux only";
        return Err(Failure::Usage(line.to_owned()));
    }
    let folders = directories::BaseDirs::new()
        .ok_or_else(|| anyhow!("the home folder is unknown; set HOME or XDG_DATA_HOME"))?;
    let data = folders.data_dir();
    let program = std::env::current_exe().context("the program's own file is not found")?;
    let mut changed = false;
    for (path, bytes) in files(data, &program)? {
        if arguments.remove {
            match std::fs::remove_file(&path) {
                Err(error) if error.kind() == std::io::ErrorKind::NotFound => continue,
                other => other.with_context(|| {
                    format!("{}: cannot be removed; remove it by hand", path.display())
                })?,
            }
            print(&format!("{}: removed\n", path.display()))?;
        } else {
            if let Some(folder) = path.parent() {
                // The write below reports the same failure in a line of its own.
                _ = std::fs::create_dir_all(folder);
            }
            atomic::write(&path, bytes)?;
            print(&format!("{}\n", path.display()))?;
        }
        changed = true;
    }
    if !changed {
        return Ok(print("nothing to remove\n")?);
    }
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
fn files(data: &Path, program: &Path) -> Result<[(PathBuf, Vec<u8>); 3], Failure> {
    let icon = include_bytes!("../../assets/icon.png").to_vec();
    Ok([
        (data.join("applications/resect.desktop"), entry(program)?.into_bytes()),
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
