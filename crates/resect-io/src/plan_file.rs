//! The file of a plan: TOML with the fields of [`Plan`].

use std::path::Path;

use crate::error::OpenError;
use crate::format::deployment_toml::parse_toml;
use resect_tools::planning::Plan;

/// Reads a plan; an invalid value is an error with its line.
pub fn read(path: &Path) -> Result<Plan, OpenError> {
    let text = std::fs::read_to_string(path)
        .map_err(|error| OpenError::Io { path: path.to_owned(), error })?;
    parse(&path.display().to_string(), &text)
}

/// Parses a plan; `file` is its name in errors.
pub fn parse(file: &str, text: &str) -> Result<Plan, OpenError> {
    let plan: Plan = parse_toml(file, text)?;
    plan.check().map_err(|(what, remedy)| OpenError::file(file, what, remedy))?;
    Ok(plan)
}

/// Returns the text of a plan, which [`parse`] reads.
pub fn text(plan: &Plan) -> String {
    toml::to_string(plan).expect("plain data")
}
