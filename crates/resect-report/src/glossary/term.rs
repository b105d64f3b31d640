//! A term of the field and its explanation.

/// A word of the field and what it means.
#[derive(Debug, PartialEq, Eq)]
pub struct Term {
    /// As the window writes it.
    pub name: &'static str,
    /// What else it is called, or how it stands in sentences.
    pub also: &'static [&'static str],
    /// One to three sentences.
    pub means: &'static str,
    /// Where the paper (Vaidis et al. 2022) has it; empty where it goes beyond the paper.
    pub paper: &'static str,
}

impl Term {
    /// All that the term goes by.
    pub fn names(&self) -> impl Iterator<Item = &'static str> {
        std::iter::once(self.name).chain(self.also.iter().copied())
    }

    /// Where the paper has it, as a line; `None` where it goes beyond the paper.
    pub fn source(&self) -> Option<String> {
        (!self.paper.is_empty()).then(|| format!("Vaidis et al. 2022, {}", self.paper))
    }
}

/// The name, and behind it what else the term is called.
pub fn title(term: &Term) -> String {
    match term.also {
        [] => term.name.to_owned(),
        also => format!("{} ({})", term.name, also.join(", ")),
    }
}
