//! `resect desktop`: adds the program to the menus of the system, with its icon and the file type of its sessions.

use clap::Args;

use super::Failure;
#[cfg(target_os = "linux")]
use super::desktop_entry as menus;
#[cfg(windows)]
use super::start_menu as menus;

#[derive(Args)]
pub struct DesktopArguments {
    /// Remove it from the menus
    #[arg(long)]
    remove: bool,
}

#[cfg(any(target_os = "linux", windows))]
pub fn run(arguments: &DesktopArguments) -> Result<(), Failure> {
    if arguments.remove { menus::remove() } else { menus::add() }
}

#[cfg(not(any(target_os = "linux", windows)))]
pub fn run(arguments: &DesktopArguments) -> Result<(), Failure> {
    let what = if arguments.remove { "removed" } else { "added" };
    let line = format!("desktop: menu entries can be {what} on Linux and Windows only");
    Err(Failure::Usage(line))
}
