//! The system's file dialog, and the test for its existence.
//!
//! On Linux, `rfd` asks the desktop portal over D-Bus and, failing that, runs `zenity`; with neither, it answers as if the user had
//! cancelled. This module therefore looks for both beforehand, at the places that the specifications of the portal and of D-Bus define.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::pin::Pin;

use super::{Question, Wanted};

/// The chosen path; `None` if the user cancels.
pub type DialogAnswer = Pin<Box<dyn Future<Output = Option<rfd::FileHandle>> + Send>>;

/// Opens the system's dialog. Some systems require a call on the window's thread; the answer is awaited on another.
pub fn ask(question: &Question) -> DialogAnswer {
    let mut dialog = rfd::AsyncFileDialog::new().set_title(&question.title);
    for (name, extensions) in question.kinds {
        dialog = dialog.add_filter(*name, extensions);
    }
    if !question.kinds.is_empty() {
        dialog = dialog.add_filter("All files", &["*"]);
    }
    match &question.wanted {
        Wanted::ToOpen { folder: true } | Wanted::Folder => Box::pin(dialog.pick_folder()),
        Wanted::ToOpen { folder: false } | Wanted::Saved => Box::pin(dialog.pick_file()),
        Wanted::NewFile { name, .. } => Box::pin(dialog.set_file_name(name).save_file()),
    }
}

/// Returns true if [`ask`] can show a dialog.
pub fn is_there() -> bool {
    !cfg!(target_os = "linux") || is_there_on_linux(|name| std::env::var_os(name), Path::new("/"))
}

/// Returns true if Linux has a dialog, by these environment variables and this root of the file system.
fn is_there_on_linux(variable: impl Fn(&str) -> Option<OsString>, root: &Path) -> bool {
    let set = |name: &str| variable(name).filter(|value| !value.is_empty());
    // Over ssh, a portal would open its dialog on the remote machine's own screen.
    let remote = ["SSH_CONNECTION", "SSH_TTY"].iter().any(|name| set(name).is_some());
    let on_path = set("PATH").is_some_and(|path| {
        std::env::split_paths(&path).any(|folder| folder.join("zenity").is_file())
    });
    if on_path || remote {
        return on_path;
    }
    let bus = set("DBUS_SESSION_BUS_ADDRESS").is_some()
        || set("XDG_RUNTIME_DIR").is_some_and(|folder| Path::new(&folder).join("bus").exists());
    // A sandbox can use the portal but does not see its files.
    let sandboxed = root.join(".flatpak-info").exists() || set("SNAP").is_some();
    bus && (sandboxed || has_portal(&data_folders(set, root)))
}

/// Data folders of programs (XDG base directories).
fn data_folders(set: impl Fn(&str) -> Option<OsString>, root: &Path) -> Vec<PathBuf> {
    let mut folders = Vec::new();
    let home = set("HOME").map(|home| PathBuf::from(home).join(".local/share"));
    folders.extend(set("XDG_DATA_HOME").map(PathBuf::from).or(home));
    match set("XDG_DATA_DIRS") {
        Some(several) => folders.extend(std::env::split_paths(&several)),
        None => folders.extend(["usr/local/share", "usr/share"].map(|folder| root.join(folder))),
    }
    folders
}

/// Returns true if D-Bus can start the portal, and a desktop provides a file chooser for it.
fn has_portal(data_folders: &[PathBuf]) -> bool {
    let service = "dbus-1/services/org.freedesktop.portal.Desktop.service";
    let chooses_files = |folder: &PathBuf| {
        let entries = std::fs::read_dir(folder.join("xdg-desktop-portal/portals"));
        entries.into_iter().flatten().flatten().any(|entry| {
            std::fs::read_to_string(entry.path())
                .is_ok_and(|text| text.contains("org.freedesktop.impl.portal.FileChooser"))
        })
    };
    data_folders.iter().any(|folder| folder.join(service).is_file())
        && data_folders.iter().any(chooses_files)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dialog_needs_zenity_or_a_portal_with_a_file_chooser() {
        let root = tempfile::tempdir().expect("a folder");
        let write = |name: &str, text: &str| {
            let path = root.path().join(name);
            std::fs::create_dir_all(path.parent().expect("inside")).expect("writable");
            std::fs::write(path, text).expect("writable");
        };
        let is_there = |variables: &[(&str, &str)]| {
            let value = |name: &str| variables.iter().find(|(known, _)| *known == name);
            is_there_on_linux(|name| Some(OsString::from(value(name)?.1)), root.path())
        };
        let bus = ("DBUS_SESSION_BUS_ADDRESS", "unix:path=/run/user/1000/bus");
        assert!(!is_there(&[]), "a bare X server");
        assert!(!is_there(&[bus]), "a bus without a portal");
        write("usr/share/dbus-1/services/org.freedesktop.portal.Desktop.service", "");
        write("usr/share/xdg-desktop-portal/portals/lxqt.portal", "Interfaces=impl.Screenshot\n");
        assert!(!is_there(&[bus]), "a portal that chooses no files");
        let interface = "Interfaces=org.freedesktop.impl.portal.FileChooser;\n";
        write("usr/share/xdg-desktop-portal/portals/gtk.portal", interface);
        assert!(is_there(&[bus]), "a desktop");
        assert!(!is_there(&[]), "no bus");
        assert!(!is_there(&[bus, ("SSH_CONNECTION", "10.0.0.1 1 10.0.0.2 22")]), "over ssh");
        write("bin/zenity", "");
        let bin = root.path().join("bin");
        let path = ("PATH", bin.to_str().expect("UTF-8"));
        assert!(is_there(&[path]) && is_there(&[path, ("SSH_TTY", "/dev/pts/0")]), "zenity");
    }
}
