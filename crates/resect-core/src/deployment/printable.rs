//! Text of files, made safe for names and messages: it cannot move a terminal's cursor or fill its screen.

/// Largest number of characters of an excerpt in an error.
const LONGEST: usize = 400;

/// Returns a text with control characters as escape codes.
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

/// Returns a printable text, truncated if it is longer than any message of this program.
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
