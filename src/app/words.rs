//! Technical terms in the interface: explained on hover, and by F1 at the pointer or the focus.

use egui::{CursorIcon, Id, RectAlign, Response, RichText, Sense, Tooltip};

use resect_core::calibration::Method;
use resect_report::glossary;
use resect_report::glossary::Term;

const WIDTH: f32 = 340.0;
/// Greatest number of terms explained on hover.
const MOST_ON_HOVER: usize = 3;

/// Place of the terms that F1 explains, in order of priority.
#[derive(Clone, Copy)]
enum At {
    Pointer,
    Focus,
}

/// Explains a term on hover and by F1.
pub fn explain(response: Response, term: &'static Term) -> Response {
    explain_all(response, &[term])
}

/// Explains the terms in a text, if there are any.
pub fn explain_text(response: Response, text: &str) -> Response {
    if !is_looked_at(&response) {
        return response;
    }
    let terms = glossary::in_text(text);
    if terms.is_empty() { response } else { explain_all(response, &terms) }
}

/// Explains several terms.
pub fn explain_all(response: Response, terms: &[&'static Term]) -> Response {
    mark(&response, terms);
    let show = |ui: &mut egui::Ui| {
        ui.set_max_width(WIDTH);
        for (index, term) in terms.iter().take(MOST_ON_HOVER).enumerate() {
            if index > 0 {
                ui.add_space(4.0);
            }
            entry(ui, term);
        }
    };
    let passive = !response.sense.intersects(Sense::CLICK | Sense::DRAG);
    // Above the word, because a card below it would cover the lines that are read next.
    for mut tooltip in [Tooltip::for_enabled(&response), Tooltip::for_disabled(&response)] {
        tooltip.popup = tooltip.popup.align(RectAlign::TOP_START);
        tooltip.show(show);
    }
    if passive { response.on_hover_cursor(CursorIcon::Help) } else { response }
}

/// Shows a text on hover beside a row of a list, where it covers no other row.
pub fn on_hover_beside(response: Response, text: &str) -> Response {
    if !text.is_empty() {
        for mut tooltip in [Tooltip::for_enabled(&response), Tooltip::for_disabled(&response)] {
            tooltip.popup = tooltip.popup.align(RectAlign::RIGHT_START);
            tooltip.show(|ui| ui.label(text));
        }
    }
    response
}

/// Lets F1 explain a widget that has its own hover text.
pub fn mark(response: &Response, terms: &[&'static Term]) {
    if terms.is_empty() {
        return;
    }
    let at = if response.contains_pointer() {
        At::Pointer
    } else if response.has_focus() {
        At::Focus
    } else {
        return;
    };
    let marked = (response.ctx.cumulative_pass_nr(), terms.to_vec());
    response.ctx.data_mut(|data| data.insert_temp(place(at), marked));
}

/// Marks the terms in a text, so that F1 explains them.
pub fn mark_text(response: &Response, text: &str) {
    if is_looked_at(response) {
        mark(response, &glossary::in_text(text));
    }
}

/// Returns true if the widget is hovered or focused. Searching a text for terms takes longer than drawing it.
pub fn is_looked_at(response: &Response) -> bool {
    response.contains_pointer() || response.has_focus()
}

/// Returns the terms marked in this frame under the pointer, or else at the focus; empty if there are none.
pub fn pointed_at(ctx: &egui::Context) -> Vec<&'static Term> {
    let now = ctx.cumulative_pass_nr();
    let marked = |at: At| {
        let marked: Option<(u64, Vec<&'static Term>)> = ctx.data(|data| data.get_temp(place(at)));
        marked.filter(|(pass, _)| *pass == now).map(|(_, terms)| terms)
    };
    marked(At::Pointer).or_else(|| marked(At::Focus)).unwrap_or_default()
}

fn place(at: At) -> Id {
    Id::unique(("explained words", at as u8))
}

/// Shows a term with its synonyms, its meaning, and its place in the paper.
pub fn entry(ui: &mut egui::Ui, term: &Term) {
    ui.horizontal_wrapped(|ui| {
        ui.strong(term.name);
        if !term.also.is_empty() {
            ui.label(RichText::new(term.also.join(", ")).small().weak());
        }
    });
    ui.add(egui::Label::new(term.means).wrap());
    if let Some(source) = term.source() {
        ui.label(RichText::new(source).small().weak());
    }
}

/// Returns the glossary entry of a method.
pub fn of_method(method: Method) -> &'static Term {
    match method {
        Method::TwoPoint => &glossary::TWO_POINT,
        Method::StaticGcp => &glossary::STATIC_GCP,
        Method::DynamicGcp => &glossary::DYNAMIC_GCP,
        Method::InterPrism => &glossary::INTER_PRISM,
        Method::Joint => &glossary::JOINT,
    }
}
