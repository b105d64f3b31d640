//! Thousands of dots or crosses as one shape; separate shapes, as in `egui_plot::Points`, cost ten times as much.

use std::ops::RangeInclusive;

use egui::{Color32, Mesh, Pos2, Rect, Shape, Ui, Vec2};
use egui_plot::{PlotBounds, PlotGeometry, PlotItem, PlotItemBase, PlotPoint, PlotTransform};

/// Points of a plot with the same mark.
pub struct Marks {
    base: PlotItemBase,
    at: Vec<PlotPoint>,
    colour: Color32,
    mark: Mark,
}

#[derive(Clone, Copy)]
enum Mark {
    /// A square of a few whole pixels, because its shape is not visible among thousands.
    Dot,
    /// Two thin diagonal lines with this extent from the centre along each axis (points).
    Cross(f32),
}

/// Side of a dot (points).
const DOT: f32 = 2.0;

impl Marks {
    pub fn dots(name: impl Into<String>, at: Vec<PlotPoint>, colour: Color32) -> Self {
        Self { base: PlotItemBase::new(name.into()), at, colour, mark: Mark::Dot }
    }

    pub fn crosses(
        name: impl Into<String>,
        at: Vec<PlotPoint>,
        colour: Color32,
        reach: f32,
    ) -> Self {
        Self { base: PlotItemBase::new(name.into()), at, colour, mark: Mark::Cross(reach) }
    }
}

/// Adds a square aligned to pixel boundaries, so that all have the same size.
fn add_dot(mesh: &mut Mesh, at: Pos2, colour: Color32, pixels_per_point: f32) {
    let side = (DOT * pixels_per_point).round().max(1.0) / pixels_per_point;
    let whole = |point: f32| (point * pixels_per_point).round() / pixels_per_point;
    let corner = Pos2::new(whole(at.x - 0.5 * side), whole(at.y - 0.5 * side));
    mesh.add_colored_rect(Rect::from_min_size(corner, Vec2::splat(side)), colour);
}

/// Adds lines that fade out to both sides over a pixel, like the painter's own thin lines.
fn add_cross(mesh: &mut Mesh, at: Pos2, colour: Color32, reach: f32, pixels_per_point: f32) {
    let fade = std::f32::consts::FRAC_1_SQRT_2 / pixels_per_point;
    for along in [Vec2::new(reach, reach), Vec2::new(reach, -reach)] {
        let aside = fade * along.rot90() / reach;
        let first = mesh.vertices.len() as u32;
        for end in [at - along, at + along] {
            mesh.colored_vertex(end - aside, Color32::TRANSPARENT);
            mesh.colored_vertex(end, colour);
            mesh.colored_vertex(end + aside, Color32::TRANSPARENT);
        }
        for side in [first, first + 1] {
            mesh.add_triangle(side, side + 1, side + 3);
            mesh.add_triangle(side + 1, side + 3, side + 4);
        }
    }
}

impl PlotItem for Marks {
    fn shapes(&self, ui: &Ui, transform: &PlotTransform, shapes: &mut Vec<Shape>) {
        let pixels_per_point = ui.ctx().pixels_per_point();
        let seen = transform.frame().expand(DOT);
        let mut mesh = Mesh::default();
        let places = self.at.iter().map(|at| transform.position_from_point(at));
        for at in places.filter(|at| seen.contains(*at)) {
            match self.mark {
                Mark::Dot => add_dot(&mut mesh, at, self.colour, pixels_per_point),
                Mark::Cross(reach) => {
                    add_cross(&mut mesh, at, self.colour, reach, pixels_per_point);
                }
            }
        }
        shapes.push(Shape::mesh(mesh));
    }

    fn initialize(&mut self, _x_range: RangeInclusive<f64>) {}

    fn color(&self) -> Color32 {
        self.colour
    }

    fn geometry(&self) -> PlotGeometry<'_> {
        PlotGeometry::Points(&self.at)
    }

    fn bounds(&self) -> PlotBounds {
        let mut bounds = PlotBounds::NOTHING;
        self.at.iter().for_each(|at| bounds.extend_with(at));
        bounds
    }

    fn base(&self) -> &PlotItemBase {
        &self.base
    }

    fn base_mut(&mut self) -> &mut PlotItemBase {
        &mut self.base
    }
}
