//! Trajectories of other systems that are held against an open deployment.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::made::Made;
use crate::estimates::{Estimate, Judged, Judgement, Options};

/// What was added, and what came of it.
#[derive(Default)]
pub struct Judging {
    /// In the order in which they were added, none twice.
    pub estimates: Vec<Arc<Estimate>>,
    /// The colour of each, by its number: it stays when another is taken away.
    colours: Vec<usize>,
    /// Files of the session that could not be read; they stay in it.
    pub missing: Vec<PathBuf>,
    pub options: Options,
    pub judgement: Made<Judgement>,
    /// Counts the changes of what is to be judged.
    pub version: u64,
}

impl Judging {
    /// Adds estimates; one that was read from the same file before gives way.
    pub fn add(&mut self, estimates: Vec<Arc<Estimate>>) {
        for estimate in estimates {
            let is_same = |old: &&mut Arc<Estimate>| is_same(old, &estimate);
            match self.estimates.iter_mut().find(is_same) {
                Some(old) => *old = estimate,
                None => {
                    let free = (0..).find(|colour| !self.colours.contains(colour));
                    self.colours.push(free.unwrap_or_default());
                    self.estimates.push(estimate);
                }
            }
        }
        self.version += 1;
    }

    /// Takes one away, by its name and its file.
    pub fn remove(&mut self, name: &str, path: &Path) {
        let is_it = |one: &Arc<Estimate>| one.path == path && one.name == name;
        if let Some(index) = self.estimates.iter().position(is_it) {
            self.estimates.remove(index);
            self.colours.remove(index);
        }
        self.version += 1;
        if self.estimates.is_empty() {
            self.judgement.clear();
        }
    }

    pub fn set(&mut self, options: Options) {
        self.options = options;
        self.version += 1;
    }

    /// The files that they were read from, each once.
    pub fn files(&self) -> Vec<PathBuf> {
        let mut files: Vec<PathBuf> = self.missing.clone();
        for estimate in &self.estimates {
            if !files.contains(&estimate.path) {
                files.push(estimate.path.clone());
            }
        }
        files
    }

    /// The estimates that were added, each with the number of its colour.
    pub fn coloured(&self) -> impl Iterator<Item = (usize, &Arc<Estimate>)> {
        self.colours.iter().copied().zip(&self.estimates)
    }

    /// The estimates that could be judged, each with the number of its colour.
    pub fn judged(&self) -> impl Iterator<Item = (usize, &Judged)> {
        let judged = self.judgement.newest.iter().flat_map(|judgement| &judgement.judged);
        judged.filter_map(|one| Some((self.colour(&one.estimate)?, one)))
    }

    /// The number of an estimate's colour; `None` once it was taken away.
    pub fn colour(&self, of: &Estimate) -> Option<usize> {
        self.coloured().find(|(_, estimate)| is_same(estimate, of)).map(|(colour, _)| colour)
    }
}

/// A bag may hold several, which its topics name.
fn is_same(a: &Estimate, b: &Estimate) -> bool {
    a.path == b.path && a.name == b.name
}
