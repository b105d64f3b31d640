//! Many plain rectangles as one shape; separate shapes would cost more than all readings in the plot of a long drive.

use std::ops::RangeInclusive;

use egui::{Color32, Mesh, Rect, Shape, Ui, Vec2};
use egui_plot::{PlotBounds, PlotGeometry, PlotItem, PlotItemBase, PlotPoint, PlotTransform};

use resect_core::pipeline::Interval;

/// Rectangles with sharp edges, painted as one shape.
#[derive(Default)]
pub struct Quads(Mesh);

impl Quads {
    pub fn add(&mut self, rect: Rect, colour: Color32) {
        if rect.is_positive() {
            self.0.add_colored_rect(rect, colour);
        }
    }

    /// Adds a frame of this width inside the rectangle.
    pub fn add_frame(&mut self, rect: Rect, width: f32, colour: Color32) {
        let (across, down) = (rect.width().min(width), rect.height().min(width));
        let inner = rect.shrink2(Vec2::new(0.0, down));
        for side in [
            rect.with_max_y(rect.top() + down),
            rect.with_min_y(rect.bottom() - down),
            inner.with_max_x(rect.left() + across),
            inner.with_min_x(rect.right() - across),
        ] {
            self.add(side, colour);
        }
    }

    pub fn into_shape(self) -> Shape {
        Shape::mesh(self.0)
    }
}

/// Time spans shaded over the whole height of a plot.
pub struct Shades {
    base: PlotItemBase,
    spans: Vec<Interval>,
    fill: Color32,
}

impl Shades {
    pub fn new(spans: Vec<Interval>, fill: Color32) -> Self {
        Self { base: PlotItemBase::new(String::new()), spans, fill }
    }
}

impl PlotItem for Shades {
    fn shapes(&self, _ui: &Ui, transform: &PlotTransform, shapes: &mut Vec<Shape>) {
        let bounds = transform.bounds();
        let ([left, low], [right, high]) = (bounds.min(), bounds.max());
        let mut quads = Quads::default();
        for span in self.spans.iter().filter(|span| span.end_s > left && span.start_s < right) {
            let from = PlotPoint::new(span.start_s.max(left), low);
            let to = PlotPoint::new(span.end_s.min(right), high);
            quads.add(transform.rect_from_values(&from, &to), self.fill);
        }
        shapes.push(quads.into_shape());
    }

    fn initialize(&mut self, _x_range: RangeInclusive<f64>) {}

    fn color(&self) -> Color32 {
        self.fill
    }

    fn geometry(&self) -> PlotGeometry<'_> {
        PlotGeometry::None
    }

    fn bounds(&self) -> PlotBounds {
        PlotBounds::NOTHING
    }

    fn base(&self) -> &PlotItemBase {
        &self.base
    }

    fn base_mut(&mut self) -> &mut PlotItemBase {
        &mut self.base
    }
}
