//! egui's shapes as SVG. Text stays text, with the widths of the window's font.

use std::fmt::Write;

use egui::epaint::{
    ClippedShape, ColorMode, EllipseShape, Mesh, PathShape, PathStroke, RectShape, StrokeKind,
    TextShape,
};
use egui::{Color32, FontFamily, Pos2, Rect, Shape, Stroke};

/// Writes shapes as an SVG document of the rectangle's size. Images are left out.
pub fn svg_of_shapes(shapes: &[ClippedShape], place: Rect) -> String {
    let mut svg = Svg { elements: String::new(), clips: Vec::new() };
    for clipped in shapes {
        let clip = clipped.clip_rect.intersect(place);
        let bounds = clipped.shape.visual_bounding_rect();
        if !clip.is_positive() || !clip.intersects(bounds) {
            continue;
        }
        if clip.contains_rect(bounds) {
            svg.add(&clipped.shape);
        } else {
            let number = svg.clip(clip);
            let _ = writeln!(svg.elements, "<g clip-path=\"url(#c{number})\">");
            svg.add(&clipped.shape);
            svg.elements.push_str("</g>\n");
        }
    }
    let clips = svg.clips.iter().enumerate().map(|(number, clip)| {
        format!("<clipPath id=\"c{number}\"><rect {}/></clipPath>\n", corners(*clip))
    });
    let (width, height) = (place.width(), place.height());
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
         font-family=\"Inter, sans-serif\">\n<defs>\n{}</defs>\n{}</svg>\n",
        clips.collect::<String>(),
        svg.elements
    )
}

struct Svg {
    elements: String,
    clips: Vec<Rect>,
}

impl Svg {
    fn clip(&mut self, clip: Rect) -> usize {
        self.clips.iter().position(|known| *known == clip).unwrap_or_else(|| {
            self.clips.push(clip);
            self.clips.len() - 1
        })
    }

    fn add(&mut self, shape: &Shape) {
        match shape {
            Shape::Noop | Shape::Callback(_) => {}
            Shape::Vec(shapes) => shapes.iter().for_each(|shape| self.add(shape)),
            Shape::Circle(circle) => {
                let size = egui::Vec2::splat(circle.radius);
                self.ellipse(circle.center, size, circle.fill, circle.stroke);
            }
            Shape::Ellipse(EllipseShape { center, radius, fill, stroke, .. }) => {
                self.ellipse(*center, *radius, *fill, *stroke);
            }
            Shape::LineSegment { points, stroke } => {
                self.path(points, false, Color32::TRANSPARENT, *stroke);
            }
            Shape::Path(PathShape { points, closed, fill, stroke }) => {
                self.path(points, *closed, *fill, solid(stroke));
            }
            Shape::Band(band) => {
                let upper = band.points.iter().map(|at| Pos2::new(at.x, at.y.max));
                let lower = band.points.iter().rev().map(|at| Pos2::new(at.x, at.y.min));
                let turn = egui::emath::Rot2::from_angle(band.angle);
                let turned = |at: Pos2| (turn * at.to_vec2()).to_pos2();
                let outline: Vec<Pos2> = upper.chain(lower).map(turned).collect();
                self.path(&outline, true, band.fill, band.stroke);
            }
            Shape::Rect(rect) => self.rect(rect),
            Shape::Text(text) => self.text(text),
            Shape::Mesh(mesh) => self.mesh(mesh),
            Shape::QuadraticBezier(curve) => {
                let points = curve.flatten(None);
                self.path(&points, curve.closed, curve.fill, solid(&curve.stroke));
            }
            Shape::CubicBezier(curve) => {
                let points = curve.flatten(None);
                self.path(&points, curve.closed, curve.fill, solid(&curve.stroke));
            }
        }
    }

    fn ellipse(&mut self, centre: Pos2, radius: egui::Vec2, fill: Color32, line: Stroke) {
        let _ = writeln!(
            self.elements,
            "<ellipse cx=\"{:.2}\" cy=\"{:.2}\" rx=\"{:.2}\" ry=\"{:.2}\"{}{}/>",
            centre.x,
            centre.y,
            radius.x,
            radius.y,
            paint("fill", fill),
            outline(line)
        );
    }

    fn path(&mut self, points: &[Pos2], closed: bool, fill: Color32, line: Stroke) {
        let name = if closed { "polygon" } else { "polyline" };
        let points: Vec<String> =
            points.iter().map(|at| format!("{:.2},{:.2}", at.x, at.y)).collect();
        let _ = writeln!(
            self.elements,
            "<{name} points=\"{}\"{}{}/>",
            points.join(" "),
            paint("fill", fill),
            outline(line)
        );
    }

    fn rect(&mut self, shape: &RectShape) {
        let is_image = shape.brush.as_ref().is_some_and(|brush| brush.fill_texture_id != FONTS);
        if is_image {
            return;
        }
        // SVG draws an outline on the border.
        let half = 0.5 * shape.stroke.width;
        let rect = match shape.stroke_kind {
            StrokeKind::Inside => shape.rect.shrink(half),
            StrokeKind::Middle => shape.rect,
            StrokeKind::Outside => shape.rect.expand(half),
        };
        let _ = writeln!(
            self.elements,
            "<rect {} rx=\"{}\"{}{}/>",
            corners(rect),
            shape.corner_radius.nw,
            paint("fill", shape.fill),
            outline(shape.stroke)
        );
    }

    /// Writes triangles of one colour as one path, in which no seam is visible.
    fn mesh(&mut self, mesh: &Mesh) {
        if mesh.texture_id != FONTS {
            return;
        }
        let mut last: Option<Color32> = None;
        for triangle in mesh.indices.as_chunks::<3>().0 {
            let corners = triangle.map(|index| mesh.vertices[index as usize]);
            let colour = mean(corners.map(|corner| corner.color));
            if colour == Color32::TRANSPARENT {
                continue;
            }
            if last != Some(colour) {
                if last.is_some() {
                    self.elements.push_str("\"/>\n");
                }
                let _ = write!(self.elements, "<path{} d=\"", paint("fill", colour));
                last = Some(colour);
            }
            let [a, b, c] = corners.map(|corner| corner.pos);
            let _ = write!(
                self.elements,
                "M{:.2} {:.2}L{:.2} {:.2} {:.2} {:.2}Z",
                a.x, a.y, b.x, b.y, c.x, c.y
            );
        }
        if last.is_some() {
            self.elements.push_str("\"/>\n");
        }
    }

    fn text(&mut self, shape: &TextShape) {
        let job = &shape.galley.job;
        let _ = writeln!(
            self.elements,
            "<g transform=\"translate({:.2} {:.2}) rotate({:.2})\" opacity=\"{}\">",
            shape.pos.x,
            shape.pos.y,
            shape.angle.to_degrees(),
            shape.opacity_factor
        );
        // A glyph belongs to the section that has its character. The ellipsis of a shortened text continues the last one.
        let mut rest = job.text.char_indices().peekable();
        let mut section = 0;
        for row in &shape.galley.rows {
            let mut run = GlyphRun::default();
            for glyph in &row.glyphs {
                if let Some((at, _)) = rest.next_if(|(_, c)| *c == glyph.chr) {
                    let holds = |section: &egui::text::LayoutSection| {
                        section.byte_range.start.0 <= at && at < section.byte_range.end.0
                    };
                    let next = job.sections.iter().position(holds).unwrap_or(section);
                    if next != section {
                        self.run(shape, &run, section);
                        run = GlyphRun::default();
                        section = next;
                    }
                }
                run.push(glyph, row.pos);
            }
            self.run(shape, &run, section);
            if row.ends_with_newline {
                rest.next_if(|(_, c)| *c == '\n');
            }
        }
        self.elements.push_str("</g>\n");
    }

    /// Writes glyphs of one row in one format.
    fn run(&mut self, shape: &TextShape, run: &GlyphRun, section: usize) {
        let Some(format) = shape.galley.job.sections.get(section).map(|section| &section.format)
        else {
            return;
        };
        let [left, right] = run.x;
        if run.text.is_empty() || right <= left {
            return;
        }
        if format.background != Color32::TRANSPARENT {
            let back = Rect::from_min_max(Pos2::new(left, run.top), Pos2::new(right, run.bottom));
            let fill = paint("fill", format.background);
            let _ = writeln!(self.elements, "<rect {}{fill}/>", corners(back));
        }
        if run.text.trim().is_empty() {
            return;
        }
        let own =
            if format.color == Color32::PLACEHOLDER { shape.fallback_color } else { format.color };
        let family = match &format.font_id.family {
            FontFamily::Name(_) => " font-family=\"monospace\"",
            FontFamily::Monospace => " font-variant-numeric=\"tabular-nums\"",
            FontFamily::Proportional => "",
        };
        let _ = writeln!(
            self.elements,
            "<text x=\"{left:.2}\" y=\"{:.2}\" font-size=\"{}\"{family} textLength=\"{:.2}\" \
             lengthAdjust=\"spacingAndGlyphs\" xml:space=\"preserve\"{}>{}</text>",
            run.baseline,
            format.font_id.size,
            right - left,
            paint("fill", shape.override_text_color.unwrap_or(own)),
            resect_report::svg::escaped(&run.text),
        );
    }
}

/// Consecutive glyphs of a row, relative to the text's origin (points).
#[derive(Default)]
struct GlyphRun {
    text: String,
    x: [f32; 2],
    baseline: f32,
    top: f32,
    bottom: f32,
}

impl GlyphRun {
    fn push(&mut self, glyph: &egui::epaint::text::Glyph, row: Pos2) {
        let x = row.x + glyph.pos.x;
        if self.text.is_empty() {
            self.x[0] = x;
            self.baseline = row.y + glyph.pos.y;
            self.top = self.baseline - glyph.font_ascent;
            self.bottom = self.top + glyph.line_height;
        }
        self.x[1] = x + glyph.advance_width;
        self.text.push(glyph.chr);
    }
}

/// The texture of plain colours and glyphs.
const FONTS: egui::TextureId = egui::TextureId::Managed(0);

fn solid(stroke: &PathStroke) -> Stroke {
    match stroke.color {
        ColorMode::Solid(colour) => Stroke::new(stroke.width, colour),
        ColorMode::UV(_) => Stroke::NONE,
    }
}

fn mean(colours: [Color32; 3]) -> Color32 {
    let channel = |index: usize| {
        let sum: u16 = colours.iter().map(|colour| u16::from(colour.to_array()[index])).sum();
        (sum / 3) as u8
    };
    Color32::from_rgba_premultiplied(channel(0), channel(1), channel(2), channel(3))
}

fn corners(rect: Rect) -> String {
    format!(
        "x=\"{:.2}\" y=\"{:.2}\" width=\"{:.2}\" height=\"{:.2}\"",
        rect.left(),
        rect.top(),
        rect.width(),
        rect.height()
    )
}

fn outline(line: Stroke) -> String {
    if line.width == 0.0 || line.color == Color32::TRANSPARENT {
        return String::new();
    }
    format!("{} stroke-width=\"{:.2}\"", paint("stroke", line.color), line.width)
}

/// Formats a fill or a stroke with its opacity.
fn paint(attribute: &str, colour: Color32) -> String {
    let [r, g, b, opacity] = colour.to_srgba_unmultiplied();
    match opacity {
        0 => format!(" {attribute}=\"none\""),
        255 => format!(" {attribute}=\"#{r:02x}{g:02x}{b:02x}\""),
        _ => format!(
            " {attribute}=\"#{r:02x}{g:02x}{b:02x}\" {attribute}-opacity=\"{:.3}\"",
            f32::from(opacity) / 255.0
        ),
    }
}
