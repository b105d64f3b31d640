//! A drawing as SVG, and SVG as PNG in the program's own font.

use std::sync::Arc;

use resvg::{tiny_skia, usvg};

use super::drawing::{Anchor, Drawing, Ink, Mark};
use crate::font::INTER;
use resect_tools::palette::Rgb;

#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    #[error("the picture is not a valid SVG")]
    Svg(#[from] usvg::Error),
    #[error("a picture of {0} × {1} pixels cannot be drawn")]
    Size(f32, f32),
    #[error("the picture could not be encoded as PNG")]
    Png(#[source] Box<dyn std::error::Error + Send + Sync>),
}

/// Source of the colours of a picture's roles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Colours {
    Light,
    Dark,
    /// CSS of the page around the picture, which sets --text, --weak, --grid and --paper.
    Page,
}

pub fn to_svg(drawing: &Drawing, colours: Colours) -> String {
    let [width, height] = drawing.size;
    let marks: String = drawing.marks.iter().map(|mark| element(mark, colours)).collect();
    let paper = colour(Ink::Paper, colours);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" font-family=\"Inter, sans-serif\">\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"{paper}\"/>\n{marks}</svg>\n"
    )
}

fn element(mark: &Mark, colours: Colours) -> String {
    match mark {
        Mark::Line { points, ink, width, dashed } => {
            let points: Vec<String> =
                points.iter().map(|[x, y]| format!("{x:.2},{y:.2}")).collect();
            let dashes = if *dashed {
                format!(" stroke-dasharray=\"{:.2} {:.2}\"", 4.0 * width, 3.0 * width)
            } else {
                String::new()
            };
            format!(
                "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{width:.2}\"{dashes}/>\n",
                points.join(" "),
                colour(*ink, colours),
            )
        }
        Mark::Rect { min, max, ink, opacity, outline } => {
            let colour = colour(*ink, colours);
            let border = outline
                .map(|width| format!(" stroke=\"{colour}\" stroke-width=\"{width:.2}\""))
                .unwrap_or_default();
            format!(
                "<rect x=\"{:.2}\" y=\"{:.2}\" width=\"{:.2}\" height=\"{:.2}\" fill=\"{colour}\" \
                 fill-opacity=\"{opacity}\"{border}/>\n",
                min[0],
                min[1],
                max[0] - min[0],
                max[1] - min[1],
            )
        }
        Mark::Text { at: [x, y], text, size, ink, anchor, strong, upwards } => {
            let colour = colour(*ink, colours);
            let anchor = match anchor {
                Anchor::Left => "start",
                Anchor::Middle => "middle",
                Anchor::Right => "end",
            };
            let turn = if *upwards { " rotate(-90)" } else { "" };
            // The program has one weight of its font; an outline makes letters bold in any viewer.
            let border = if *strong {
                format!(" stroke=\"{colour}\" stroke-width=\"{:.2}\"", 0.035 * size)
            } else {
                String::new()
            };
            // Not every SVG viewer centres text vertically; a shift by half the height of Inter's capitals does.
            format!(
                "<text transform=\"translate({x:.2} {y:.2}){turn}\" y=\"{:.2}\" font-size=\"{size:.2}\" \
                 text-anchor=\"{anchor}\" fill=\"{colour}\"{border}>{}</text>\n",
                0.364 * size,
                escaped(text),
            )
        }
    }
}

fn colour(ink: Ink, colours: Colours) -> String {
    let variable = match ink {
        Ink::Text => "var(--text)",
        Ink::Weak => "var(--weak)",
        Ink::Grid => "var(--grid)",
        Ink::Paper => "var(--paper)",
        Ink::Rgb(rgb) => return hex(rgb),
    };
    match colours {
        Colours::Page => variable.to_owned(),
        _ => hex(ink.rgb(colours == Colours::Dark)),
    }
}

/// Formats a colour for CSS and SVG.
pub fn hex([r, g, b]: Rgb) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Escapes a text for XML.
pub fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            // XML cannot represent these characters, not even escaped.
            '\0'..='\u{1f}' | '\u{fffe}' | '\u{ffff}' => escaped.push(' '),
            c => escaped.push(c),
        }
    }
    escaped
}

/// Renders an SVG as PNG, with `scale` pixels for each unit. Texts are in Inter, whatever fonts the machine has.
pub fn to_png(svg: &str, scale: f32) -> Result<Vec<u8>, PictureError> {
    let mut options = usvg::Options { font_family: "Inter".into(), ..Default::default() };
    let font = usvg::fontdb::Source::Binary(Arc::new(*INTER));
    options.fontdb_mut().load_font_source(font);
    let tree = usvg::Tree::from_str(svg, &options)?;
    let [width, height] = [tree.size().width(), tree.size().height()].map(|side| side * scale);
    let mut pixels = tiny_skia::Pixmap::new(width.round() as u32, height.round() as u32)
        .ok_or(PictureError::Size(width, height))?;
    let transform = tiny_skia::Transform::from_scale(scale, scale);
    resvg::render(&tree, transform, &mut pixels.as_mut());
    pixels.encode_png().map_err(|error| PictureError::Png(error.into()))
}

#[cfg(test)]
mod tests {
    use resvg::usvg::roxmltree::Document;

    use super::*;
    use crate::drawing::text_width;

    fn one_text(text: &str) -> Drawing {
        let at = [20.0, 20.0];
        let text = Mark::text(at, text, 12.0, Ink::Text, Anchor::Left);
        Drawing { size: [300.0, 40.0], marks: vec![text] }
    }

    #[test]
    fn any_text_survives() -> Result<(), Box<dyn std::error::Error>> {
        let text = "a<b & \"c\" > 'd' ]]> µ °";
        let svg = to_svg(&one_text(text), Colours::Light);
        let document = Document::parse(&svg)?;
        let found = document.descendants().find(|node| node.has_tag_name("text"));
        assert_eq!(found.and_then(|node| node.text()), Some(text));
        Document::parse(&to_svg(&one_text("\0 \u{1b} \u{ffff}"), Colours::Dark))?;
        Ok(())
    }

    #[test]
    fn a_png_has_the_scaled_size() -> Result<(), Box<dyn std::error::Error>> {
        let png = to_png(&to_svg(&one_text("1.93"), Colours::Dark), 2.0)?;
        let pixels = tiny_skia::Pixmap::decode_png(&png)?;
        assert_eq!((pixels.width(), pixels.height()), (600, 80));
        let paper = Ink::Paper.rgb(true);
        let written = pixels.pixels().iter().any(|p| p.red().abs_diff(paper[0]) > 100);
        assert!(written, "no font, no letters");
        Ok(())
    }

    #[test]
    fn what_cannot_be_drawn_is_an_error() {
        assert!(matches!(to_png("<svg", 1.0), Err(PictureError::Svg(_))));
        assert!(matches!(
            to_png(&to_svg(&one_text(""), Colours::Dark), 0.0),
            Err(PictureError::Size(..))
        ));
    }

    #[test]
    fn estimated_widths_are_those_drawn() -> Result<(), Box<dyn std::error::Error>> {
        let mut options = usvg::Options::default();
        options.fontdb_mut().load_font_data(INTER.to_vec());
        for text in ["inter-prism error (mm)", "RTK GNSS 8.1 mm", "WAVE To 0123456789", "±3σ ≤ 5 °"]
        {
            let tree = usvg::Tree::from_str(&to_svg(&one_text(text), Colours::Light), &options)?;
            let drawn = tree.root().children()[1].bounding_box().width();
            let estimated = text_width(text, 12.0);
            assert!((drawn / estimated - 1.0).abs() < 0.06, "{text}: {drawn} not {estimated}");
        }
        Ok(())
    }
}
