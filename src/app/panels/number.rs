//! Parsing and input fields of typed numbers.

use std::cell::RefCell;
use std::ops::RangeInclusive;

use egui::response::Flags;
use egui::{Align2, Key, Margin, Sense, TextStyle, Vec2, emath::Numeric, vec2};

use crate::app::theme;
use resect_core::deployment::Severity;

/// Parses a number with a decimal point or comma, and optionally the field's unit: `2.5`, `2,5`, `3 s`, `−0,5 mm`.
///
/// Anything else, a number that is not finite, and another unit are errors with a one-line reason.
pub fn read(text: &str, unit: &str) -> Result<f64, String> {
    let text = text.trim();
    let digits_end = text.rfind(|c: char| c.is_ascii_digit() || c == '.').map_or(0, |at| at + 1);
    let (number, behind) = text.split_at(digits_end);
    let plain = |unit: &str| unit.replace('°', "deg").split_whitespace().collect::<String>();
    let number = number.replace('−', "-").replace([' ', '\u{a0}', '\u{202f}'], "");
    // In a number with point and comma, the comma separates thousands.
    let number =
        if number.contains('.') { number.replace(',', "") } else { number.replace(',', ".") };
    match number.parse().ok().filter(|value: &f64| value.is_finite()) {
        None => Err(format!("“{text}” is not a number")),
        Some(_) if !behind.is_empty() && plain(behind) != plain(unit) => match unit.trim() {
            "" => Err(format!("“{text}” is not a number")),
            unit => Err(format!("“{text}” is not in {unit}")),
        },
        Some(value) => Ok(value),
    }
}

/// Width of the error sign in a field (points).
const SIGN: f32 = 10.0;

/// Parses a number as [`read`] does, and rejects one outside the bounds.
fn read_within(text: &str, unit: &str, bounds: &RangeInclusive<f64>) -> Result<f64, String> {
    let value = read(text, unit)?;
    let (least, most) = (bounds.start(), bounds.end());
    if bounds.contains(&value) {
        Ok(value)
    } else if value < *least {
        Err(format!("{value} is below the minimum of {least}"))
    } else {
        Err(format!("{value} is above the maximum of {most}"))
    }
}

/// Formats a number with one decimal, or two if needed, on every screen; for `custom_formatter`.
///
/// The decimals chosen by egui depend on the pixel size, so they would differ between neighbours on small pixels.
pub fn shown(value: f64, _decimals: RangeInclusive<usize>) -> String {
    let text = format!("{value:.2}");
    text.strip_suffix('0').map(str::to_owned).unwrap_or(text)
}

/// Invalid text in a field, and the field's value meanwhile.
#[derive(Clone)]
struct Unread {
    text: String,
    value: f64,
    /// Size of the field, kept so that the layout does not move.
    size: Vec2,
    /// True if the text was entered with Enter, so that the field keeps the focus.
    goes_on: bool,
}

/// A number field, which `add` creates with the given parser. Invalid text remains in it, marked with the reason, until it is corrected or
/// Escape is pressed.
pub fn field<N: Numeric>(
    ui: &mut egui::Ui,
    (label, unit): (&str, &str),
    value: &mut N,
    range: RangeInclusive<N>,
    add: impl FnOnce(&mut egui::Ui, &mut N, &dyn Fn(&str) -> Option<f64>) -> egui::Response,
) -> egui::Response {
    let id = ui.scope_id().with(("unread", label));
    let now = value.to_f64();
    let bounds = range.start().to_f64()..=range.end().to_f64();
    let unread: Option<Unread> = ui.data(|data| data.get_temp(id));
    // If the value was set by other means since, the invalid text is dropped.
    if let Some(mut unread) = unread.filter(|unread| unread.value == now) {
        let (response, mended) = mend(ui, &mut unread, unit, &bounds);
        let escaped = ui.input(|input| input.key_pressed(Key::Escape));
        if mended.is_some() || escaped {
            ui.data_mut(|data| data.remove::<Unread>(id));
        } else {
            ui.data_mut(|data| data.insert_temp(id, unread));
        }
        let Some(new) = mended.filter(|_| !escaped) else { return response };
        *value = N::from_f64(new);
        let mut response = response;
        response.mark_changed();
        return response;
    }
    let refused = RefCell::new(None);
    let parse = |text: &str| {
        let read = read_within(text, unit, &bounds).ok();
        *refused.borrow_mut() = read.is_none().then(|| text.to_owned());
        read
    };
    let response = add(ui, value, &parse);
    let goes_on = was_entered(ui);
    // An unfinished number may be invalid. A slider does not report the focus of its number.
    if let Some(text) = refused.into_inner().filter(|text| !text.trim().is_empty())
        && !ui.ctx().text_edit_focused()
    {
        let unread = Unread { text, value: now, size: response.rect.size(), goes_on };
        ui.data_mut(|data| data.insert_temp(id, unread));
    }
    response
}

/// Returns true if Enter was pressed in this frame or the last: a field updates its value one frame later.
fn was_entered(ui: &egui::Ui) -> bool {
    let id = egui::Id::unique("frame of the last Enter");
    let frame = ui.ctx().cumulative_frame_nr();
    if ui.input(|input| input.key_pressed(Key::Enter)) {
        ui.data_mut(|data| data.insert_temp(id, frame));
    }
    let last: Option<u64> = ui.data(|data| data.get_temp(id));
    last.is_some_and(|last| last + 1 >= frame)
}

/// Edits invalid text, and returns the number once it is valid and entered.
fn mend(
    ui: &mut egui::Ui,
    unread: &mut Unread,
    unit: &str,
    bounds: &RangeInclusive<f64>,
) -> (egui::Response, Option<f64>) {
    let Unread { text, value: now, size, goes_on } = unread;
    let (colour, sign) = theme::severity(Severity::Problem, ui.visuals().dark_mode);
    let why = read_within(text, unit, bounds).err();
    let (place, _) = ui.allocate_exact_size(*size, Sense::hover());
    // The sign is inside the field.
    let room = if why.is_some() { SIGN } else { 0.0 };
    let field = egui::TextEdit::singleline(text)
        .desired_width(f32::INFINITY)
        .margin(Margin { left: 4, right: 4 + room as i8, top: 2, bottom: 2 })
        .align(Align2::LEFT_CENTER)
        .text_color(colour);
    let response = ui.put(place, field);
    if why.is_some() {
        let (at, font) =
            (place.right_center() - vec2(4.0, 0.0), TextStyle::Small.resolve(ui.style()));
        ui.painter().text(at, Align2::RIGHT_CENTER, sign, font, colour);
    }
    let read = read_within(text, unit, bounds).ok();
    let entered = response.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
    if *goes_on || entered && read.is_none() {
        response.request_focus();
        *goes_on = false;
    }
    let mended = read.filter(|_| response.lost_focus());
    let why = why.map_or(String::new(), |why| format!("{why}; "));
    let unit = unit.trim();
    let hint = format!("{why}the value is still {now} {unit}. Correct it, or press Escape");
    let mut response = response.on_hover_text(hint);
    // The caller's hover text would cover the reason.
    response.flags.remove(Flags::HOVERED | Flags::CONTAINS_POINTER);
    (response, mended)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_comma_a_unit_and_a_typographic_minus_are_understood() {
        let numbers = [
            ("2.5", "", 2.5),
            ("2,5", " m", 2.5),
            (" 3 s", " s", 3.0),
            ("−0,5 mm", " mm", -0.5),
            ("12°", " deg", 12.0),
            ("4 °/s", " deg/s", 4.0),
            ("1e-3", "", 1e-3),
            ("1,234.5 m", " m", 1234.5),
            ("7.", "", 7.0),
        ];
        for (text, unit, value) in numbers {
            assert_eq!(read(text, unit), Ok(value), "{text}");
        }
    }

    #[test]
    fn a_number_out_of_bounds_is_refused_and_not_another_one_taken_for_it() {
        assert_eq!(read_within("200", "", &(1.0..=200.0)), Ok(200.0));
        let why = read_within("10000", "", &(1.0..=200.0)).expect_err("too many");
        assert_eq!(why, "10000 is above the maximum of 200");
        assert!(
            read_within("0", "", &(1.0..=200.0)).is_err_and(|why| why.contains("minimum of 1"))
        );
    }

    #[test]
    fn what_is_no_number_or_in_another_unit_is_refused_with_the_reason() {
        for text in ["", "nan", "inf", "1e999", "two", "1..2", "-", "12 apples"] {
            assert!(read(text, "").is_err_and(|why| why.contains("not a number")), "{text}");
        }
        let why = read("5 mm", " m").expect_err("another unit");
        assert_eq!(why, "“5 mm” is not in m");
    }
}
