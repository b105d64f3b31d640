//! Colours and spacing of the window, dark and light.

use egui::{Color32, FontFamily, FontId, TextStyle};

use resect_core::deployment::Severity;
use resect_tools::palette::Rgb;

const TEXT_LIGHT: Color32 = Color32::from_gray(40);
const TEXT_DARK: Color32 = Color32::from_gray(205);

/// Returns the monospaced font of commands and files; tables of numbers have [`TextStyle::Monospace`].
pub fn code_family() -> FontFamily {
    FontFamily::Name("code".into())
}

/// A command or a file as text.
pub fn code(text: &str) -> egui::RichText {
    egui::RichText::new(text).font(FontId::new(11.0, code_family()))
}

pub fn set_fonts(ctx: &egui::Context) {
    // Inter has the arrows and Greek letters that egui's own font lacks, and reads better at 13 points.
    let mut fonts = egui::FontDefinitions::default();
    let inter = egui::FontData::from_static(*resect_report::font::INTER);
    fonts.font_data.insert("Inter".to_owned(), std::sync::Arc::new(inter));
    fonts.families.entry(FontFamily::Proportional).or_default().insert(0, "Inter".to_owned());
    // Tables are in Inter, with figures of one width. Commands and files keep egui's own monospaced font.
    let code = fonts.families.get(&FontFamily::Monospace).cloned().unwrap_or_default();
    fonts.families.insert(code_family(), code);
    let figures = egui::FontData::from_static(resect_report::font::FIGURES);
    fonts.font_data.insert("Figures".to_owned(), std::sync::Arc::new(figures));
    let monospace = fonts.families.entry(FontFamily::Monospace).or_default();
    monospace.splice(0..0, ["Figures", "Inter"].map(str::to_owned));
    ctx.set_fonts(fonts);
}

/// Sets fonts and spacing for both themes.
pub fn apply(ctx: &egui::Context) {
    set_fonts(ctx);
    ctx.all_styles_mut(|style| {
        style.text_styles = [
            (TextStyle::Heading, FontId::new(16.0, FontFamily::Proportional)),
            (TextStyle::Body, FontId::new(13.0, FontFamily::Proportional)),
            (TextStyle::Button, FontId::new(13.0, FontFamily::Proportional)),
            (TextStyle::Monospace, FontId::new(12.0, FontFamily::Monospace)),
            (TextStyle::Small, FontId::new(11.0, FontFamily::Proportional)),
        ]
        .into();
        style.spacing.item_spacing = egui::vec2(6.0, 5.0);
        style.spacing.slider_width = 90.0;
        style.spacing.interact_size.y = 20.0;
        // egui 0.37 panics if the pointer presses beside a scroll bar that is shorter than the least length of its handle. With zero, none
        // is.
        style.spacing.scroll.handle_min_length = 0.0;
    });
    ctx.style_mut_of(egui::Theme::Light, |style| {
        style.visuals.override_text_color = Some(TEXT_LIGHT);
        // egui's own has too little contrast on a light ground.
        style.visuals.weak_text_color = Some(faint(false));
    });
    ctx.style_mut_of(egui::Theme::Dark, |style| {
        style.visuals.override_text_color = Some(TEXT_DARK);
    });
}

/// Gives the scroll bars of long lists a handle that is large enough to grab, where they are much longer than the handle.
pub fn keep_handle(ui: &mut egui::Ui) {
    const HANDLE: f32 = 12.0;
    let is_long = ui.available_size().min_elem() > 10.0 * HANDLE;
    ui.spacing_mut().scroll.handle_min_length = if is_long { HANDLE } else { 0.0 };
}

/// Smallest and largest zoom factor by Ctrl and + or −.
const ZOOM: [f32; 2] = [0.5, 3.0];

/// Limits the zoom factor; returns a message if the user reached the limit.
pub fn limit_zoom(ctx: &egui::Context) -> Option<String> {
    let (zoom, [least, most]) = (ctx.zoom_factor(), ZOOM);
    let limited = zoom.clamp(least, most);
    if limited == zoom {
        return None;
    }
    ctx.set_zoom_factor(limited);
    let end = if zoom > most { "largest" } else { "smallest" };
    Some(format!("{:.0} % is the {end} scale", 100.0 * limited))
}

/// Zoom factor in sunlight.
const IN_THE_SUN: f32 = 1.3;

/// Switches large type and full contrast on or off, in both themes.
pub fn in_the_sun(ctx: &egui::Context, on: bool) {
    let zoom = if on { IN_THE_SUN } else { 1.0 };
    // egui derives the next screen size from the last one, and assumes 10,000 by 10,000 points before the first frame.
    match ctx.cumulative_frame_nr() {
        0 => ctx.options_mut(|options| options.zoom_factor = zoom),
        _ => ctx.set_zoom_factor(zoom),
    }
    for (theme, ink, ground, text) in [
        (egui::Theme::Light, Color32::BLACK, Color32::WHITE, TEXT_LIGHT),
        (egui::Theme::Dark, Color32::WHITE, Color32::BLACK, TEXT_DARK),
    ] {
        let usual = theme.default_visuals();
        ctx.style_mut_of(theme, |style| {
            let visuals = &mut style.visuals;
            visuals.override_text_color = Some(if on { ink } else { text });
            (visuals.panel_fill, visuals.window_fill) =
                if on { (ground, ground) } else { (usual.panel_fill, usual.window_fill) };
            let usual_weak = (theme == egui::Theme::Light).then(|| faint(false));
            let (weak, width) = if on { (Some(ink), 1.5) } else { (usual_weak, 1.0) };
            visuals.weak_text_color = weak;
            let lines = &mut visuals.widgets.noninteractive.bg_stroke;
            let colour = if on { ink } else { usual.widgets.noninteractive.bg_stroke.color };
            *lines = egui::Stroke::new(width, colour);
        });
    }
}

pub fn rgb([r, g, b]: Rgb) -> Color32 {
    Color32::from_rgb(r, g, b)
}

/// Converts a data colour to a text colour, darkened on a light background.
pub fn readable(colour: Rgb, dark: bool) -> Color32 {
    let colour = rgb(colour);
    if dark { colour } else { colour.lerp_to_gamma(Color32::BLACK, 0.4) }
}

pub fn scene_background(dark: bool) -> Color32 {
    if dark { Color32::from_rgb(17, 20, 24) } else { Color32::from_rgb(250, 250, 252) }
}

pub fn scene_grid(dark: bool) -> Color32 {
    if dark { Color32::from_rgb(42, 47, 54) } else { Color32::from_rgb(218, 222, 228) }
}

/// Colour of the time cursor: the prism triangle in the scene, and the line in the plots.
pub fn cursor(dark: bool) -> Rgb {
    if dark { [245, 245, 245] } else { [30, 30, 30] }
}

/// Colour of secondary text; its contrast to the panels is at least 4.5 (WCAG 2, level AA).
pub fn faint(dark: bool) -> Color32 {
    if dark { Color32::from_gray(140) } else { Color32::from_gray(105) }
}

/// Colour and sign of a finding; the sign identifies it without colour.
pub fn severity(severity: Severity, dark: bool) -> (Color32, &'static str) {
    match severity {
        Severity::Note => (faint(dark), "•"),
        Severity::Warning => (readable([230, 159, 0], dark), "⚠"),
        Severity::Problem => (readable([240, 90, 50], dark), "✗"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_frame_in_the_sun_is_as_large_as_its_window() {
        let ctx = egui::Context::default();
        in_the_sun(&ctx, true);
        let size = egui::vec2(1280.0, 800.0) / ctx.zoom_factor();
        let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, size);
        let input = egui::RawInput { screen_rect: Some(screen), ..Default::default() };
        let mut output = ctx.run_ui(input, |ui| {
            let shown = ui.ctx().content_rect().size();
            assert!((shown - size).length() < 1.0, "{shown}");
        });
        output.textures_delta.clear();
        assert_eq!(output.pixels_per_point, IN_THE_SUN);
    }

    #[test]
    fn the_zoom_has_limits_and_they_are_told() {
        let ctx = egui::Context::default();
        let after = |zoom: f32| {
            ctx.set_zoom_factor(zoom);
            ctx.run_ui(egui::RawInput::default(), |_| {}).textures_delta.clear();
            let message = limit_zoom(&ctx);
            ctx.run_ui(egui::RawInput::default(), |_| {}).textures_delta.clear();
            (ctx.zoom_factor(), message)
        };
        assert_eq!(after(2.5), (2.5, None));
        assert_eq!(after(3.1), (3.0, Some("300 % is the largest scale".to_owned())));
        assert_eq!(after(0.4), (0.5, Some("50 % is the smallest scale".to_owned())));
    }

    #[test]
    fn secondary_text_has_enough_contrast() {
        // Relative luminance and contrast by WCAG 2.2.
        let luminance = |colour: Color32| {
            let [r, g, b, _] = egui::Rgba::from(colour).to_array();
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        let ctx = egui::Context::default();
        apply(&ctx);
        for theme in [egui::Theme::Light, egui::Theme::Dark] {
            let style = ctx.style_of(theme);
            for ground in [style.visuals.panel_fill, style.visuals.extreme_bg_color] {
                // A transparent ink shows a part of the ground.
                let weak = ground.blend(style.visuals.weak_text_color());
                let (weak, ground) = (luminance(weak), luminance(ground));
                let contrast = (weak.max(ground) + 0.05) / (weak.min(ground) + 0.05);
                assert!(contrast >= 4.5, "{theme:?}: {contrast}");
            }
        }
    }

    #[test]
    fn a_scroll_bar_of_a_few_points_can_be_pressed() {
        let ctx = egui::Context::default();
        apply(&ctx);
        let frame = |events: Vec<egui::Event>| {
            let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(100.0, 100.0));
            let input = egui::RawInput { screen_rect: Some(screen), events, ..Default::default() };
            let mut output = ctx.run_ui(input, |ui| {
                let solid = egui::style::ScrollStyle::solid();
                let handle_min_length = ui.spacing().scroll.handle_min_length;
                ui.spacing_mut().scroll = egui::style::ScrollStyle { handle_min_length, ..solid };
                ui.add_space(40.0);
                let area = egui::ScrollArea::vertical().auto_shrink(false).max_height(6.0);
                area.min_scrolled_height(6.0)
                    .show(ui, |ui| ui.allocate_space(egui::vec2(20.0, 500.0)));
            });
            output.textures_delta.clear();
        };
        let press = |pos: egui::Pos2, pressed: bool| egui::Event::PointerButton {
            pos,
            button: egui::PointerButton::Primary,
            pressed,
            modifiers: egui::Modifiers::NONE,
        };
        (0..3).for_each(|_| frame(Vec::new()));
        for (x, y) in (88..100).flat_map(|x| (32..56).map(move |y| (x as f32, y as f32))) {
            let at = egui::pos2(x, y);
            // A press beside a scroll bar moves it, too.
            frame(vec![egui::Event::PointerMoved(at)]);
            frame(vec![press(at, true)]);
            frame(vec![press(at, false)]);
        }
    }
}
