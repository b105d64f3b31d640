//! Rows of tables and messages of bags that are not valid.

use crate::error::OpenError;

/// Rows that are not valid and were skipped.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SkippedRows {
    pub count: usize,
    /// Line and reason of the first.
    pub first: Option<(usize, String)>,
}

impl SkippedRows {
    pub fn add(&mut self, line: usize, reason: String) {
        self.count += 1;
        self.first.get_or_insert((line, reason));
    }

    /// Returns the error of a table in which the rows that are not valid outnumber the others.
    pub fn refuse_if_most(&self, file: &str, valid: usize, remedy: &str) -> Result<(), OpenError> {
        match &self.first {
            Some((line, reason)) if self.count > valid => {
                let what = match self.count {
                    1 => reason.clone(),
                    count => format!("{reason}; {count} rows of {} are like that", count + valid),
                };
                Err(OpenError::line(file, *line, what, remedy))
            }
            _ => Ok(()),
        }
    }
}
