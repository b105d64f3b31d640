//! The display server of the window, on systems that may have two.

use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};

use winit::platform::x11::EventLoopBuilderExtX11;

/// Chooses X11 if `WAYLAND_DISPLAY` names a socket that nobody listens on and there is an X server: the window would not open.
pub fn choose(options: &mut eframe::NativeOptions) {
    let variable = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty());
    let socket = variable("WAYLAND_DISPLAY").map(PathBuf::from);
    let folder = variable("XDG_RUNTIME_DIR").map(PathBuf::from);
    let is_given = variable("WAYLAND_SOCKET").is_some();
    if !is_given
        && variable("DISPLAY").is_some()
        && socket.is_some_and(|socket| is_dead(&socket, folder.as_deref()))
    {
        options.event_loop_builder = Some(Box::new(|builder| {
            builder.with_x11();
        }));
    }
}

/// Returns true if no Wayland server answers at a socket, whose path is absolute or relative to the folder of runtime files.
fn is_dead(socket: &Path, folder: Option<&Path>) -> bool {
    let path = folder.map_or_else(|| socket.to_owned(), |folder| folder.join(socket));
    UnixStream::connect(path).is_err()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::net::UnixListener;

    #[test]
    fn a_socket_is_dead_once_nobody_listens() {
        let folder = tempfile::tempdir().expect("a folder");
        let socket = Path::new("wayland-7");
        assert!(is_dead(socket, Some(folder.path())), "absent");
        let listener = UnixListener::bind(folder.path().join(socket)).expect("bound");
        assert!(!is_dead(socket, Some(folder.path())));
        assert!(!is_dead(&folder.path().join(socket), None), "an absolute path");
        drop(listener);
        assert!(is_dead(socket, Some(folder.path())), "left over");
    }
}
