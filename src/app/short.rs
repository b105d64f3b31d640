//! Shortening of names to the available width.

use egui::{FontId, Response, Ui};

/// Least number of letters kept.
const FEWEST: usize = 2;

/// Returns a text no wider than `width` (points); "…" replaces its middle if it is too long.
///
/// Names of deployments often begin alike and differ at their ends, so more of the end is kept.
pub fn in_the_middle(ui: &Ui, text: &str, font: &FontId, width: f32) -> String {
    let fits = |text: &str| {
        let colour = egui::Color32::PLACEHOLDER;
        ui.painter().layout_no_wrap(text.to_owned(), font.clone(), colour).size().x <= width
    };
    let letters: Vec<char> = text.chars().collect();
    if letters.len() <= FEWEST || fits(text) {
        return text.to_owned();
    }
    let with = |kept: usize| {
        let (head, tail) = (kept / 3, kept - kept / 3);
        let ends = [&letters[..head], &letters[letters.len() - tail..]];
        ends.map(|part| part.iter().collect::<String>()).join("…")
    };
    // Bisection of the greatest number of letters that fit.
    let (mut fitting, mut too_many) = (FEWEST, letters.len());
    while fitting + 1 < too_many {
        let middle = usize::midpoint(fitting, too_many);
        if fits(&with(middle)) {
            fitting = middle;
        } else {
            too_many = middle;
        }
    }
    with(fitting)
}

/// Shows the whole name on hover if it is shortened.
pub fn whole_on_hover(response: Response, shown: &str, whole: &str) -> Response {
    if shown == whole { response } else { response.on_hover_text(whole) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_name_keeps_both_of_its_ends() {
        let ctx = egui::Context::default();
        let mut output = ctx.run_ui(egui::RawInput::default(), |ui| {
            let font = FontId::proportional(13.0);
            let short = |text: &str, width: f32| in_the_middle(ui, text, &font, width);
            assert_eq!(short("field", 200.0), "field");
            let [first, second] =
                ["morning", "evening"].map(|end| short(&format!("2022-07-11-survey-{end}"), 90.0));
            assert!(first.starts_with('2') && first.contains('…'), "{first}");
            assert!(first.ends_with("ning") && first != second, "{first}, {second}");
            assert_eq!(short("a long name", 1.0), "…me");
            assert_eq!(short("ä", 1.0), "ä");
        });
        output.textures_delta.clear();
    }
}
