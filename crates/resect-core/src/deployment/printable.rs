//! What files say, made fit to be told: in names and messages it must not move a terminal's cursor or fill its screen.

/// The most characters of an error that repeats what a file says.
const LONGEST: usize = 400;

/// A text with control characters as their codes.
pub fn printable(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for character in text.chars() {
        if character.is_control() {
            shown.extend(character.escape_default());
        } else {
            shown.push(character);
        }
    }
    shown
}

/// A printable text, cut where it is longer than any message of ours.
pub fn excerpt(text: &str) -> String {
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => printable(&text[..end]) + "…",
        None => printable(text),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_moves_a_terminal_is_told_by_its_code() {
        assert_eq!(printable("3,2 m — ″"), "3,2 m — ″");
        assert_eq!(printable("\u{1b}[31mred\r\n"), "\\u{1b}[31mred\\r\\n");
        assert_eq!(excerpt(&"ä".repeat(5000)).chars().count(), LONGEST + 1);
    }
}
