//! Test for a file dialog on Linux.
//!
//! `rfd` asks the desktop portal over D-Bus and, failing that, runs `zenity`; with neither, it answers as if the user had cancelled. This
//! module looks for both beforehand, at the places that the specifications of the portal and of D-Bus define. An installed portal may
//! still not answer, as under another desktop than its own, and `rfd` would wait half a minute for it. So it is asked for its version.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Longest wait for the answer of the portal. The bus may have to start it first.
const PATIENCE: Duration = Duration::from_secs(5);

/// Returns true if a dialog of this system appears at once.
pub fn answers() -> bool {
    match provider(|name| std::env::var_os(name), Path::new("/")) {
        Provider::None => false,
        Provider::Zenity => true,
        Provider::Portal => portal_answers().is_ok(),
    }
}

/// Asks the desktop portal for the version of its file chooser; fails if it does not answer within [`PATIENCE`].
fn portal_answers() -> zbus::Result<()> {
    pollster::block_on(async {
        let bus = zbus::connection::Builder::session()?.method_timeout(PATIENCE).build().await?;
        let wanted = ("org.freedesktop.portal.FileChooser", "version");
        bus.call_method(
            Some("org.freedesktop.portal.Desktop"),
            "/org/freedesktop/portal/desktop",
            Some("org.freedesktop.DBus.Properties"),
            "Get",
            &wanted,
        )
        .await?;
        Ok(())
    })
}

/// Provider of the dialog on Linux.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Provider {
    None,
    Portal,
    Zenity,
}

/// Returns the provider that `rfd` asks first, by these environment variables and this root of the file system.
fn provider(variable: impl Fn(&str) -> Option<OsString>, root: &Path) -> Provider {
    let set = |name: &str| variable(name).filter(|value| !value.is_empty());
    // Over ssh, a portal would open its dialog on the remote machine's own screen.
    let remote = ["SSH_CONNECTION", "SSH_TTY"].iter().any(|name| set(name).is_some());
    let bus = set("DBUS_SESSION_BUS_ADDRESS").is_some()
        || set("XDG_RUNTIME_DIR").is_some_and(|folder| Path::new(&folder).join("bus").exists());
    // A sandbox can use the portal but does not see its files.
    let sandboxed = root.join(".flatpak-info").exists() || set("SNAP").is_some();
    if bus && !remote && (sandboxed || has_portal(&data_folders(set, root))) {
        return Provider::Portal;
    }
    let on_path = set("PATH").is_some_and(|path| {
        std::env::split_paths(&path).any(|folder| folder.join("zenity").is_file())
    });
    if on_path { Provider::Zenity } else { Provider::None }
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
        let found = |variables: &[(&str, &str)]| {
            let value = |name: &str| variables.iter().find(|(known, _)| *known == name);
            provider(|name| Some(OsString::from(value(name)?.1)), root.path())
        };
        let bus = ("DBUS_SESSION_BUS_ADDRESS", "unix:path=/run/user/1000/bus");
        assert_eq!(found(&[]), Provider::None, "a bare X server");
        assert_eq!(found(&[bus]), Provider::None, "a bus without a portal");
        write("usr/share/dbus-1/services/org.freedesktop.portal.Desktop.service", "");
        write("usr/share/xdg-desktop-portal/portals/lxqt.portal", "Interfaces=impl.Screenshot\n");
        assert_eq!(found(&[bus]), Provider::None, "a portal that chooses no files");
        let interface = "Interfaces=org.freedesktop.impl.portal.FileChooser;\n";
        write("usr/share/xdg-desktop-portal/portals/gtk.portal", interface);
        assert_eq!(found(&[bus]), Provider::Portal, "a desktop");
        assert_eq!(found(&[]), Provider::None, "no bus");
        let ssh = ("SSH_CONNECTION", "10.0.0.1 1 10.0.0.2 22");
        assert_eq!(found(&[bus, ssh]), Provider::None, "over ssh");
        write("bin/zenity", "");
        let bin = root.path().join("bin");
        let path = ("PATH", bin.to_str().expect("UTF-8"));
        assert_eq!(found(&[path]), Provider::Zenity);
        assert_eq!(found(&[path, ("SSH_TTY", "/dev/pts/0")]), Provider::Zenity);
        assert_eq!(found(&[path, bus]), Provider::Portal, "the portal is asked first");
    }
}
