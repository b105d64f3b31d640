//! The program on Windows: its entry in the start menu, and "Open with" for sessions. All of it is the user's own, without an administrator.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, anyhow};

use super::registry_file::{self, KEYS};
use super::{Failure, print};

/// Writes a link. The paths are in the environment, where nothing must be quoted.
const WRITE_LINK: &str = "$link = (New-Object -ComObject WScript.Shell).CreateShortcut($env:RESECT_LINK); \
                          $link.TargetPath = $env:RESECT_PROGRAM; $link.Save()";

/// Adds the program to the start menu and to "Open with".
pub fn add() -> Result<(), Failure> {
    let program = std::env::current_exe().context("the program's own file is not found")?;
    let name = program.to_str().ok_or_else(|| {
        anyhow!("{}: the registry cannot name this path; move the program", program.display())
    })?;
    import(&registry_file::adding(name))?;
    for key in KEYS {
        print(&format!("{key}\n"))?;
    }
    let link = link()?;
    if write_link(&link, &program) {
        return Ok(print(&format!("{}\n", link.display()))?);
    }
    let line = "powershell did not run: pin the program to the start menu in Explorer\n";
    Ok(print(line)?)
}

/// Removes both.
pub fn remove() -> Result<(), Failure> {
    import(&registry_file::removing())?;
    for key in KEYS {
        print(&format!("{key}: removed\n"))?;
    }
    let link = link()?;
    match std::fs::remove_file(&link) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(()),
        other => {
            other.with_context(|| {
                format!("{}: cannot be removed; remove it by hand", link.display())
            })?;
            Ok(print(&format!("{}: removed\n", link.display()))?)
        }
    }
}

fn link() -> Result<PathBuf, Failure> {
    let folders = directories::BaseDirs::new()
        .ok_or_else(|| anyhow!("the folder of the user's data is unknown; set APPDATA"))?;
    Ok(folders.data_dir().join(r"Microsoft\Windows\Start Menu\Programs\resect.lnk"))
}

/// Returns true if the link was written.
fn write_link(link: &Path, program: &Path) -> bool {
    let mut command = Command::new("powershell");
    command.args(["-NoProfile", "-NonInteractive", "-Command", WRITE_LINK]);
    command.env("RESECT_LINK", link).env("RESECT_PROGRAM", program);
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.status().is_ok_and(|status| status.success()) && link.exists()
}

/// Runs `reg import`, a part of Windows.
fn import(text: &str) -> Result<(), Failure> {
    let folder = tempfile::tempdir().context("no temporary file can be written; set TEMP")?;
    let file = folder.path().join("resect.reg");
    std::fs::write(&file, registry_file::encoded(text))
        .with_context(|| format!("{}: cannot be written; free space there", file.display()))?;
    let mut command = Command::new("reg");
    command.arg("import").arg(&file).stdin(Stdio::null()).stdout(Stdio::null());
    let output = command.output().context("reg.exe did not run; check the search path")?;
    if output.status.success() {
        return Ok(());
    }
    let said = String::from_utf8_lossy(&output.stderr).trim().to_owned();
    Err(anyhow!("reg.exe changed nothing ({said}); ask for permission to write to the registry"))?
}
