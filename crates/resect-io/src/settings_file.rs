//! The file of settings (`--config`): TOML with the fields of [`Settings`].

use std::path::Path;

use resect_core::analysis::Settings;

use crate::error::OpenError;
use crate::format::deployment_toml::parse_toml;

/// Reads settings; fields that the file does not name have their defaults.
///
/// # Errors
/// [`OpenError::Io`] for a file that cannot be read, [`OpenError::Line`] for a wrong value or key.
pub fn read(path: &Path) -> Result<Settings, OpenError> {
    let text = std::fs::read_to_string(path)
        .map_err(|error| OpenError::Io { path: path.to_owned(), error })?;
    parse_toml(&path.display().to_string(), &text)
}
