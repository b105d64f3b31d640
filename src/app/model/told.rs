//! Which findings the user was told already: a warning comes again with other numbers while a slider moves.

use std::collections::BTreeSet;

use resect_core::deployment::{Finding, Severity};

/// Problems and warnings that were not told before; from now on they were.
pub fn new_findings<'a>(
    findings: impl IntoIterator<Item = &'a Finding>,
    told: &mut BTreeSet<String>,
) -> Vec<&'a Finding> {
    findings
        .into_iter()
        .filter(|finding| finding.severity >= Severity::Warning)
        .filter(|finding| told.insert(key(&finding.message)))
        .collect()
}

/// Forgets what was told and holds no longer: should it come again, it is news.
pub fn forget_past<'a>(now: impl Iterator<Item = &'a Finding>, told: &mut BTreeSet<String>) {
    let now: BTreeSet<String> = now.map(|finding| key(&finding.message)).collect();
    told.retain(|key| now.contains(key));
}

/// Words before numbers that name a thing, and do not say how much.
const NAMING: [&str; 10] = [
    "station", "stations", "prism", "prisms", "frame", "frames", "drive", "drives", "pillar",
    "pillars",
];

/// A message without its measures: what tells whether two say the same thing. `station 2` stays, `2.7 ms` goes.
pub fn key(message: &str) -> String {
    let mut naming = false;
    let mut words = Vec::new();
    for word in message.split_whitespace() {
        let bare = word.trim_matches(|c: char| !c.is_alphanumeric());
        let is_number = bare.starts_with(|c: char| c.is_ascii_digit());
        if is_number && !naming {
            words.push(
                word.chars().filter(|c| !c.is_ascii_digit() && !".+-−".contains(*c)).collect(),
            );
        } else {
            words.push(word.to_owned());
        }
        // "stations 1, 2 and 3", and no further than the list goes.
        let goes_on = match bare {
            "and" | "or" | "to" => true,
            _ => is_number && !word.ends_with([':', ';', '.']),
        };
        naming = NAMING.contains(&bare.to_lowercase().as_str()) || naming && goes_on;
    }
    words.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_station_is_another_finding_and_another_number_is_not() {
        assert_eq!(key("station 2: 14 duplicates"), key("station 2: 9 duplicates"));
        assert_ne!(key("station 2: 14 duplicates"), key("station 3: 14 duplicates"));
        assert_ne!(key("stations 1 and 2 differ by 3 mm"), key("stations 1 and 3 differ by 3 mm"));
        assert_eq!(
            key("stations 1, 2 and 3 differ by 3 mm"),
            key("stations 1, 2 and 3 differ by −4.5 mm")
        );
        assert_ne!(key("T12 is weak (3.1 σ)"), key("T13 is weak (3.1 σ)"));
    }
}
