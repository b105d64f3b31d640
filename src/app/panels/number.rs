//! Numbers as people type them.

/// A number with a decimal point or comma, with or without its unit after it: `2.5`, `2,5`, `3 s`, `−0,5 mm`.
///
/// `None` for everything else, and for what is not finite, so that the field keeps what it had.
pub fn parse(text: &str) -> Option<f64> {
    let number = text.trim().trim_end_matches(|c: char| !c.is_ascii_digit() && c != '.');
    let number = number.replace('−', "-").replace([' ', '\u{a0}', '\u{202f}'], "");
    // With both, the comma parts thousands.
    let number =
        if number.contains('.') { number.replace(',', "") } else { number.replace(',', ".") };
    number.parse().ok().filter(|value: &f64| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_comma_a_unit_and_a_typographic_minus_are_understood_and_no_number_is_none() {
        let read = [
            ("2.5", 2.5),
            ("2,5", 2.5),
            (" 3 s", 3.0),
            ("−0,5 mm", -0.5),
            ("12°", 12.0),
            ("1e-3", 1e-3),
            ("1,234.5 m", 1234.5),
            ("7.", 7.0),
        ];
        for (text, value) in read {
            assert_eq!(parse(text), Some(value), "{text}");
        }
        for text in ["", "nan", "inf", "1e999", "two", "1..2", "-"] {
            assert_eq!(parse(text), None, "{text}");
        }
    }
}
