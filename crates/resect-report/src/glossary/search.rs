//! Search of terms by name, by words, and in sentences.

use super::term::Term;
use super::terms::ALL;

/// Returns the term with this name, in any spelling: `τ_s`, `tau-s`, `Tau_S`.
pub fn find(name: &str) -> Option<&'static Term> {
    let wanted = plain(name);
    ALL.iter().copied().find(|term| term.names().any(|name| plain(name) == wanted))
}

/// Returns the terms with every word of a query in names or explanation; matches in names come first.
pub fn matching(query: &str) -> Vec<&'static Term> {
    let words: Vec<String> = query.split_whitespace().map(plain).collect();
    let rank = |term: &Term| {
        let names = plain(&term.names().collect::<Vec<_>>().join(" "));
        let means = plain(term.means);
        if words.iter().all(|word| names.contains(word)) {
            Some(0)
        } else {
            words.iter().all(|word| names.contains(word) || means.contains(word)).then_some(1)
        }
    };
    let mut found: Vec<_> =
        ALL.iter().copied().filter_map(|term| Some((rank(term)?, term))).collect();
    found.sort_by_key(|(rank, _)| *rank);
    // A complete name comes first.
    if let Some(exact) = find(query)
        && let Some(at) = found.iter().position(|(_, term)| *term == exact)
    {
        found[..=at].rotate_right(1);
    }
    found.into_iter().map(|(_, term)| term).collect()
}

/// Names that need no explanation in a sentence.
const EVERYDAY: [&str; 13] = [
    "reading",
    "measurement",
    "deployment",
    "calibration",
    "level",
    "levelled",
    "rig",
    "stamp",
    "time stamp",
    "gap",
    "silence",
    "jump",
    "verdict",
];

/// Returns the terms in a text that may need an explanation, in their order; a longer name hides those within it.
pub fn in_text(text: &str) -> Vec<&'static Term> {
    let text = plain(text);
    let mut places: Vec<(usize, usize, &'static Term)> = Vec::new();
    for &term in ALL {
        for name in term.names().filter(|name| !EVERYDAY.contains(name)).map(plain) {
            let found = text.match_indices(&name).map(|(at, _)| [at, at + name.len()]);
            places.extend(
                found.filter(|ends| is_word(&text, *ends)).map(|[from, to]| (from, to, term)),
            );
        }
    }
    places.sort_by_key(|(from, to, _)| (*from, usize::MAX - to));
    let mut end = 0;
    let mut found: Vec<&'static Term> = Vec::new();
    for (from, to, term) in places {
        if from >= end {
            end = to;
            if !found.contains(&term) {
                found.push(term);
            }
        }
    }
    found
}

/// Returns true if a range of a text is a whole word, or its plural.
fn is_word(text: &str, [from, to]: [usize; 2]) -> bool {
    let is_part = |c: char| c.is_alphanumeric();
    let before = text[..from].chars().next_back();
    let mut after = text[to..].chars();
    let next = after.next();
    let plural = next == Some('s') && !after.next().is_some_and(is_part);
    !before.is_some_and(is_part) && (plural || !next.is_some_and(is_part))
}

/// Removes differences of spelling: case, hyphens, Greek letters.
fn plain(text: &str) -> String {
    text.trim()
        .to_lowercase()
        .replace('τ', "tau")
        .replace('σ', "sigma")
        .replace(['-', '_', '–', '\u{2011}'], " ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::glossary::terms::*;

    #[test]
    fn every_name_is_of_one_term_and_every_term_is_explained_shortly() {
        let mut names: Vec<String> = Vec::new();
        for term in ALL {
            for name in term.names() {
                let name = plain(name);
                assert!(!names.contains(&name), "{name} is twice");
                names.push(name);
            }
            let length = term.means.chars().count();
            assert!((40..=420).contains(&length), "{}: {length} letters", term.name);
            assert!(term.means.ends_with('.'), "{}", term.name);
        }
    }

    #[test]
    fn a_term_is_found_however_it_is_spelt() {
        for name in ["τ_s", "tau-s", "TAU_S", " tau s "] {
            assert_eq!(find(name), Some(&TAU_S), "{name}");
        }
        assert_eq!(find("GCP"), Some(&CONTROL_POINT));
        assert_eq!(find("no such thing"), None);
    }

    #[test]
    fn a_query_puts_names_before_meanings_and_the_exact_name_first() {
        assert_eq!(matching("sigma")[0], &SIGMA);
        assert_eq!(matching("mirror")[0], &MIRROR_TWIN);
        let found = matching("prism constant");
        assert_eq!(found[0], &PRISM_CONSTANT);
        assert!(matching("surveyors").contains(&&RESECTION));
        assert!(matching("xyzzy").is_empty());
        assert_eq!(matching("").len(), ALL.len());
    }

    #[test]
    fn terms_are_seen_in_sentences_as_whole_words_and_the_longest_counts() {
        let line = "prisms 1–2: inter-prism distances are off by 5.1 mm (median), σ of the mirror twin is not known";
        assert_eq!(in_text(line), [&INTER_PRISM_DISTANCES, &SIGMA, &MIRROR_TWIN]);
        assert_eq!(in_text("station 2's ranges are off by +7.1 ppm"), [&PPM]);
        // "terms" does not contain RMS, nor "leaning" a lean.
        assert_eq!(in_text("in terms of a leaning tripod"), [] as [&Term; 0]);
        assert_eq!(in_text("994 triplets of readings"), [&TRIPLET]);
    }
}
