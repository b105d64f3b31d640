//! A picture as plain data, for SVG files and for the window. The background is [`Ink::Paper`].

#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    pub size: [f32; 2],
    /// Marks from back to front; x to the right, y down, in the units of `size`.
    pub marks: Vec<Mark>,
}

/// A colour, or a role that light and dark pictures colour differently.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ink {
    Text,
    Weak,
    Grid,
    Paper,
    Rgb([u8; 3]),
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Anchor {
    Left,
    Middle,
    Right,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    Line {
        points: Vec<[f32; 2]>,
        ink: Ink,
        width: f32,
        dashed: bool,
    },
    /// `opacity` applies to the fill; `outline` is the width of an opaque border.
    Rect {
        min: [f32; 2],
        max: [f32; 2],
        ink: Ink,
        opacity: f32,
        outline: Option<f32>,
    },
    /// One line of text. `anchor` selects the end or the middle that is at `at`, along the text's direction; across,
    /// the text is centred. `upwards` reads from bottom to top.
    Text {
        at: [f32; 2],
        text: String,
        size: f32,
        ink: Ink,
        anchor: Anchor,
        strong: bool,
        upwards: bool,
    },
}

impl Ink {
    pub fn rgb(self, dark: bool) -> [u8; 3] {
        match (self, dark) {
            (Self::Text, false) => [32, 34, 38],
            (Self::Text, true) => [218, 221, 226],
            (Self::Weak, false) => [95, 99, 105],
            (Self::Weak, true) => [150, 154, 160],
            (Self::Grid, false) => [222, 225, 230],
            (Self::Grid, true) => [46, 51, 58],
            (Self::Paper, false) => [255, 255, 255],
            (Self::Paper, true) => [17, 20, 24],
            (Self::Rgb(rgb), _) => rgb,
        }
    }
}

impl Mark {
    /// Plain text that reads from left to right.
    pub fn text(
        at: [f32; 2],
        text: impl Into<String>,
        size: f32,
        ink: Ink,
        anchor: Anchor,
    ) -> Self {
        Self::Text { at, text: text.into(), size, ink, anchor, strong: false, upwards: false }
    }

    /// Plain text that reads from bottom to top.
    pub fn upwards(
        at: [f32; 2],
        text: impl Into<String>,
        size: f32,
        ink: Ink,
        anchor: Anchor,
    ) -> Self {
        Self::Text { at, text: text.into(), size, ink, anchor, strong: false, upwards: true }
    }

    pub fn line(from: [f32; 2], to: [f32; 2], ink: Ink, width: f32) -> Self {
        Self::Line { points: vec![from, to], ink, width, dashed: false }
    }

    fn scale(&mut self, scale: f32) {
        let grow = |at: &mut [f32; 2]| at.iter_mut().for_each(|x| *x *= scale);
        match self {
            Self::Line { points, width, .. } => {
                points.iter_mut().for_each(grow);
                *width *= scale;
            }
            Self::Rect { min, max, outline, .. } => {
                grow(min);
                grow(max);
                outline.iter_mut().for_each(|width| *width *= scale);
            }
            Self::Text { at, size, .. } => {
                grow(at);
                *size *= scale;
            }
        }
    }
}

impl Drawing {
    /// Scales the picture with its texts and lines.
    pub fn scaled(mut self, scale: f32) -> Self {
        self.size = self.size.map(|side| side * scale);
        self.marks.iter_mut().for_each(|mark| mark.scale(scale));
        self
    }
}

/// Advance widths of Inter's characters from the space to the tilde, in thousandths of the size.
#[rustfmt::skip]
const ADVANCES: [u16; 95] = [
    281, 278, 403, 631, 638, 813, 639, 222, 362, 362, 500, 659, 280, 460, 276, 357, 625, 464, 605,
    636, 642, 608, 624, 571, 616, 624, 276, 280, 659, 659, 659, 507, 936, 676, 651, 727, 719, 598,
    587, 743, 740, 264, 543, 652, 563, 889, 753, 761, 635, 761, 639, 638, 642, 741, 676, 949, 642,
    665, 625, 362, 357, 362, 469, 452, 497, 564, 621, 558, 621, 582, 361, 609, 591, 237, 237, 544,
    237, 869, 585, 597, 609, 609, 372, 523, 364, 581, 557, 813, 540, 557, 541, 362, 327, 362, 659,
];

/// Estimates the width of a text in Inter, for layout: without kerning, and with the width of a digit for characters beyond ASCII.
pub fn text_width(text: &str, size: f32) -> f32 {
    let advance = |c: char| {
        let known = (c as usize).checked_sub(32).and_then(|index| ADVANCES.get(index));
        f32::from(known.copied().unwrap_or(660))
    };
    text.chars().map(advance).sum::<f32>() * size / 1000.0
}

/// Breaks a text between words into at most `most` lines, and shortens lines wider than `width`.
pub fn wrap(text: &str, size: f32, width: f32, most: usize) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match words.last_mut() {
            // A unit remains with its number.
            Some(last)
                if word.chars().count() <= 2 && last.starts_with(|c: char| c.is_numeric()) =>
            {
                *last += &format!(" {word}");
            }
            _ => words.push(word.to_owned()),
        }
    }
    let mut lines: Vec<String> = Vec::new();
    for word in words {
        let full = lines.len() >= most;
        match lines.last_mut() {
            Some(line) if full || text_width(&format!("{line} {word}"), size) <= width => {
                *line += &format!(" {word}");
            }
            _ => lines.push(word),
        }
    }
    lines.iter().map(|line| shortened(line, size, width)).collect()
}

/// Returns the text, or its two ends with an ellipsis if it is wider, because names may differ at either end.
pub fn shortened(text: &str, size: f32, width: f32) -> String {
    if text_width(text, size) <= width {
        return text.to_owned();
    }
    let letters: Vec<char> = text.chars().collect();
    let ends = |kept: usize| {
        let start: String = letters[..kept.div_ceil(2)].iter().collect();
        let end: String = letters[letters.len() - kept / 2..].iter().collect();
        format!("{}…{}", start.trim_end(), end.trim_start())
    };
    let fits = |short: &String| text_width(short, size) <= width;
    (1..letters.len()).rev().map(ends).find(fits).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_break_between_words_but_not_before_a_unit() {
        assert_eq!(wrap("range noise 2 mm", 10.0, 60.0, 3), ["range noise", "2 mm"]);
        assert_eq!(wrap("one two three four", 10.0, 30.0, 2), ["one", "tw…ur"]);
        assert!(wrap("  ", 10.0, 60.0, 3).is_empty());
    }

    #[test]
    fn what_is_too_wide_keeps_its_ends() {
        assert_eq!(shortened("deployment 12", 10.0, 100.0), "deployment 12");
        assert_eq!(shortened("deployment 12", 10.0, 50.0), "depl…t 12");
        assert_eq!(shortened("deployment 12", 10.0, 3.0), "");
    }
}
