//! A term of the field and its explanation.

/// A term of the field, with its explanation.
#[derive(Debug, PartialEq, Eq)]
pub struct Term {
    /// Name in the window.
    pub name: &'static str,
    /// Synonyms, and forms in sentences.
    pub also: &'static [&'static str],
    /// Explanation in one to three sentences.
    pub means: &'static str,
    /// Section or figure of the paper (Vaidis et al. 2022); empty for terms beyond the paper.
    pub paper: &'static str,
}

impl Term {
    /// Returns the name and all synonyms.
    pub fn names(&self) -> impl Iterator<Item = &'static str> {
        std::iter::once(self.name).chain(self.also.iter().copied())
    }

    /// Returns the reference to the paper as a line; `None` for terms beyond the paper.
    pub fn source(&self) -> Option<String> {
        (!self.paper.is_empty()).then(|| format!("Vaidis et al. 2022, {}", self.paper))
    }
}

/// Returns the name, followed by the synonyms in brackets.
pub fn title(term: &Term) -> String {
    match term.also {
        [] => term.name.to_owned(),
        also => format!("{} ({})", term.name, also.join(", ")),
    }
}
