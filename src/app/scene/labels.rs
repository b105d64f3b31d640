//! Labels over the picture, placed without overlap.

use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Shape, Vec2};

use super::SceneContent;
use super::grid::GridNumber;
use super::projection::Projection;
use super::vertices::{Label, Rank};
use crate::app::theme;

/// Size of a station's point in the picture.
const STATION: Vec2 = Vec2::splat(9.0);

/// Assigns free rectangles to labels.
pub struct Placer {
    area: Rect,
    /// Overlays on the picture.
    over: Vec<Rect>,
    taken: Vec<Rect>,
    /// Rectangles to cover only if there is no other room.
    spared: Vec<Rect>,
}

impl Placer {
    /// Returns a placer that avoids the overlays and everything outside of the area.
    pub fn new(area: Rect, over: Vec<Rect>) -> Self {
        Self { area: area.shrink(4.0), taken: over.clone(), over, spared: Vec::new() }
    }

    /// Returns the first free rectangle of a list, and marks it as taken.
    pub fn place(&mut self, places: impl IntoIterator<Item = Rect>) -> Option<Rect> {
        let is_on = |some: &[Rect], place: &Rect| some.iter().any(|it| it.intersects(*place));
        let free = places
            .into_iter()
            .filter(|place| self.area.contains_rect(*place) && !is_on(&self.taken, place));
        let free: Vec<Rect> = free.collect();
        let place = *free.iter().find(|place| !is_on(&self.spared, place)).or(free.first())?;
        // Neighbours on one line are apart by about a blank.
        self.taken.push(place.expand2(Vec2::new(4.0, 0.0)));
        Some(place)
    }

    /// Returns a rectangle beside a point, shifted into the area; `None` if an overlay covers the point itself.
    pub fn beside(&mut self, at: Pos2, size: Vec2) -> Option<Rect> {
        let is_seen = !self.over.iter().any(|over| over.contains(at));
        is_seen.then(|| self.place_about(at, size, &PLACES[..6])).flatten()
    }

    /// Returns a rectangle beside a point, or a little further off if others are there already.
    pub fn near(&mut self, at: Pos2, size: Vec2) -> Option<Rect> {
        self.place_about(at, size, &PLACES)
    }

    fn place_about(&mut self, at: Pos2, size: Vec2, places: &[(Align2, Vec2)]) -> Option<Rect> {
        if !self.area.contains(at) {
            return None;
        }
        let area = self.area;
        let place =
            |(align, offset): &(Align2, Vec2)| inside(align.anchor_size(at + *offset, size), area);
        self.place(places.iter().map(place))
    }
}

/// Positions of a label relative to its point: anchor and offset (points). The last ones are for labels that must be visible.
const PLACES: [(Align2, Vec2); 16] = [
    (Align2::CENTER_BOTTOM, Vec2::new(0.0, -6.0)),
    (Align2::CENTER_TOP, Vec2::new(0.0, 14.0)),
    (Align2::LEFT_CENTER, Vec2::new(10.0, 0.0)),
    (Align2::RIGHT_CENTER, Vec2::new(-10.0, 0.0)),
    (Align2::CENTER_BOTTOM, Vec2::new(0.0, -22.0)),
    (Align2::CENTER_TOP, Vec2::new(0.0, 30.0)),
    (Align2::LEFT_BOTTOM, Vec2::new(8.0, -2.0)),
    (Align2::RIGHT_BOTTOM, Vec2::new(-8.0, -2.0)),
    (Align2::LEFT_TOP, Vec2::new(8.0, 6.0)),
    (Align2::RIGHT_TOP, Vec2::new(-8.0, 6.0)),
    (Align2::LEFT_BOTTOM, Vec2::new(12.0, -14.0)),
    (Align2::RIGHT_BOTTOM, Vec2::new(-12.0, -14.0)),
    (Align2::LEFT_TOP, Vec2::new(12.0, 18.0)),
    (Align2::RIGHT_TOP, Vec2::new(-12.0, 18.0)),
    (Align2::CENTER_BOTTOM, Vec2::new(0.0, -38.0)),
    (Align2::CENTER_TOP, Vec2::new(0.0, 46.0)),
];

/// Shifts a rectangle into an area.
pub fn inside(place: Rect, area: Rect) -> Rect {
    let over = (area.min - place.min).max(Vec2::ZERO) + (area.max - place.max).min(Vec2::ZERO);
    place.translate(over)
}

/// Returns a background for text over the picture.
pub fn ground_shape(place: Rect, dark: bool) -> Shape {
    let colour = theme::scene_background(dark).gamma_multiply(0.85);
    Shape::rect_filled(place, 4.0, colour)
}

/// Paints the names of stations, axes and points as far as there is room, then the grid's numbers.
pub fn paint(
    painter: &Painter,
    projection: &Projection,
    eye_m: &nalgebra::Vector3<f32>,
    content: &SceneContent,
    placer: &mut Placer,
    dark: bool,
) {
    let (stations, points): (Vec<_>, Vec<_>) =
        content.labels.iter().rev().partition(|label| label.rank == Rank::Station);
    let (directions, points): (Vec<_>, Vec<_>) =
        points.into_iter().partition(|label| label.rank == Rank::Direction);
    for at in stations.iter().filter_map(|label| projection.screen(&label.position_m)) {
        placer.spared.push(Rect::from_center_size(at, STATION));
    }
    for label in stations {
        beside_its_point(painter, projection, placer, label, 13.0, dark);
    }
    let covered = [placer.taken.as_slice(), &placer.spared].concat();
    let numbers: Vec<GridNumber> =
        content.grid.iter().flat_map(|grid| grid.numbers(projection, eye_m, &covered)).collect();
    let (names, numbers): (Vec<_>, Vec<_>) =
        numbers.into_iter().partition(|number| number.text.contains('='));
    let colour = theme::faint(dark);
    // Numbers are useless without the name of their axis.
    for name in names {
        text_at(painter, placer, name.at, name.text, 10.0, colour);
    }
    for label in &content.estimate_labels {
        beside_its_point(painter, projection, placer, label, 10.5, dark);
    }
    // Names of directions have an opaque background and would hide the path, which is projected once for all of them.
    if !directions.is_empty() {
        let before = placer.spared.len();
        let outline = content.outline_m.iter().filter_map(|place_m| projection.screen(place_m));
        placer.spared.extend(outline.map(|at| Rect::from_center_size(at, STATION)));
        for label in directions {
            beside_its_point(painter, projection, placer, label, 10.5, dark);
        }
        placer.spared.truncate(before);
    }
    for label in points {
        beside_its_point(painter, projection, placer, label, 10.5, dark);
    }
    for number in numbers {
        text_at(painter, placer, number.at, number.text, 10.0, colour);
    }
}

/// Paints a name beside its point, if there is room.
fn beside_its_point(
    painter: &Painter,
    projection: &Projection,
    placer: &mut Placer,
    label: &Label,
    size: f32,
    dark: bool,
) {
    let Some(at) = projection.screen(&label.position_m) else { return };
    let colour = theme::readable(label.colour, dark);
    let galley = painter.layout_no_wrap(label.text.clone(), FontId::proportional(size), colour);
    let place = match label.rank {
        Rank::Station | Rank::Direction => placer.near(at, galley.size()),
        _ => placer.beside(at, galley.size()),
    };
    if let Some(place) = place {
        if matches!(label.rank, Rank::Station | Rank::Direction) {
            // Tracks and arrows may cross it among the stations.
            painter.add(ground_shape(place, dark));
        }
        painter.galley(place.min, galley, colour);
    }
}

/// Paints a line of text in the middle of the picture.
pub fn paint_in_the_middle(painter: &Painter, rect: Rect, text: &str, dark: bool) {
    let colour = theme::rgb(theme::cursor(dark));
    let galley = painter.layout(text.to_owned(), FontId::proportional(13.0), colour, rect.width());
    let place = Rect::from_center_size(rect.center(), galley.size());
    painter.add(ground_shape(place.expand(6.0), dark));
    painter.galley(place.min, galley, colour);
}

/// Paints text centred on a point, if there is room.
fn text_at(
    painter: &Painter,
    placer: &mut Placer,
    at: Pos2,
    text: String,
    size: f32,
    colour: Color32,
) {
    let galley = painter.layout_no_wrap(text, FontId::proportional(size), colour);
    let place = Align2::CENTER_CENTER.anchor_size(at, galley.size());
    if let Some(place) = placer.place([place]) {
        painter.galley(place.min, galley, colour);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_label_lies_on_another_under_a_button_or_outside() {
        let area = Rect::from_min_max(Pos2::ZERO, Pos2::new(300.0, 200.0));
        let button = Rect::from_min_max(Pos2::new(240.0, 6.0), Pos2::new(292.0, 30.0));
        let mut placer = Placer::new(area, vec![button]);
        let mut places = vec![button];
        for i in 0..40_u8 {
            // Ten points repeatedly; some under the button.
            let at = Pos2::new(f32::from(i % 10) * 33.0, 20.0 + f32::from(i % 3) * 15.0);
            places.extend(placer.beside(at, Vec2::new(40.0, 12.0)));
        }
        assert!(places.len() > 8, "{}", places.len());
        for (index, place) in places.iter().enumerate() {
            assert!(area.contains_rect(*place));
            assert!(places[..index].iter().all(|other| !other.intersects(*place)), "{place}");
        }
        // A label covers a station's point only if everything else is taken.
        let mut placer = Placer::new(area, Vec::new());
        let at = Pos2::new(100.0, 100.0);
        let above = placer.beside(at, Vec2::new(40.0, 12.0)).expect("room");
        let mut placer = Placer::new(area, Vec::new());
        placer.spared.push(above);
        let elsewhere = placer.beside(at, Vec2::new(40.0, 12.0)).expect("room");
        assert!(!elsewhere.intersects(above));
        let mut placer = Placer::new(area, Vec::new());
        placer.spared.push(area);
        assert_eq!(placer.beside(at, Vec2::new(40.0, 12.0)), Some(above));
        // A station among others has its name, too.
        for steps in [[6.0, 4.0], [-6.0, 1.5], [0.0, 0.0], [0.0, 7.0], [9.0, -1.0]] {
            let mut placer = Placer::new(area, Vec::new());
            let at = |station: u8| Pos2::new(150.0, 100.0) + Vec2::from(steps) * f32::from(station);
            let dots = (0..3).map(|station| Rect::from_center_size(at(station), STATION));
            placer.spared.extend(dots);
            let named =
                (0..3).filter_map(|station| placer.near(at(station), Vec2::new(52.0, 16.0)));
            assert_eq!(named.count(), 3, "{steps:?}");
        }
        // Points outside of the picture have no label.
        assert_eq!(placer.beside(Pos2::new(150.0, -30.0), Vec2::new(40.0, 12.0)), None);
    }
}
