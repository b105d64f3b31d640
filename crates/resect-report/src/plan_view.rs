//! Plan view of stations, tracks and control points in the frame of station 1: equal axes, in metres.

use std::collections::BTreeSet;

use nalgebra::Vector3;

use super::axis::{number, round_down};
use super::drawing::{Anchor, Drawing, Ink, Mark, text_width};
use super::frame::{Frame, NUMBER};
use resect_core::deployment::ControlPointSet;
use resect_core::geometry::RigidTransform;
use resect_core::network::{PerStation, USUAL_STATIONS};
use resect_core::pipeline::Triplets;
use resect_tools::palette;

const LABEL: f32 = 11.0;
/// Smallest and largest height of the plot, for drives along and across the view.
const HEIGHTS: [f32; 2] = [150.0, 460.0];
/// Margins to the left, top, right and bottom of the plot, for numbers, legend and label.
const LEFT: f32 = 58.0;
const TOP: f32 = 26.0;
const RIGHT: f32 = 12.0;
const BOTTOM: f32 = 38.0;
/// Margin on each side, as a share of the range.
const FREE: f64 = 0.06;
/// Distance from the centre of a station's triangle to its corners.
const CORNER: f32 = 8.0;
/// Smallest distance between points of a track in the picture.
const STEP: f32 = 1.0;

/// Positions of the prisms.
pub struct Tracks<'a> {
    pub triplets: &'a Triplets,
    /// Unused readings of each station, in its own frame (m).
    pub unused_m: &'a PerStation<Vec<Vector3<f64>>>,
}

/// Draws the plan view in a given width; its height follows from the scene. The transforms must be valid for the
/// tracks and control points.
pub fn draw(
    control_points: &[ControlPointSet],
    Tracks { triplets, unused_m }: &Tracks<'_>,
    station1_from_station: &PerStation<RigidTransform>,
    width: f32,
) -> Drawing {
    let stations = station1_from_station.map(|transform| transform.translation_m);
    let control_points = control_points_m(control_points, station1_from_station);
    let tracks = tracks_m(triplets, station1_from_station);
    // Control points may be far away, so they do not extend the range.
    let all = || stations.iter().chain(tracks.iter().flatten().flatten());
    let (x, y) = (range(all().map(|point| point.x)), range(all().map(|point| point.y)));
    let plot_width = width - LEFT - RIGHT;
    let per_metre = (f64::from(plot_width) / length(x)).min(f64::from(HEIGHTS[1]) / length(y));
    let plot_height = ((length(y) * per_metre) as f32).max(HEIGHTS[0]);
    let height = TOP + plot_height + BOTTOM;
    let [x, y] = [(x, plot_width), (y, plot_height)]
        .map(|(range, pixels)| about_middle(range, f64::from(pixels) / per_metre));
    let plot = Area { min: [LEFT, TOP], max: [LEFT + plot_width, TOP + plot_height] };
    let frame = Frame::new(x, y, plot.min, plot.max);
    let place = |point: &Vector3<f64>| frame.place(point.x, point.y);

    let mut marks = Vec::new();
    frame.draw_rows(true, &mut marks);
    frame.draw_columns(true, &mut marks);
    for (track, rgb) in tracks.iter().zip((0..).map(palette::station)) {
        for interval in track {
            let points = thinned(interval.iter().map(place));
            marks.push(Mark::Line { points, ink: Ink::Rgb(rgb), width: 1.3, dashed: false });
        }
    }
    let inside = |point: &&Vector3<f64>| {
        (x[0]..=x[1]).contains(&point.x) && (y[0]..=y[1]).contains(&point.y)
    };
    for (station, unused_m) in unused_m.iter().enumerate() {
        let unused_m = unused_m.iter().map(|point| station1_from_station[station].apply(point));
        let seen: Vec<Vector3<f64>> = unused_m.filter(|point| inside(&point)).collect();
        draw_unused(seen.iter().map(place), palette::station(station), &mut marks);
    }
    for point in control_points.iter().filter(inside) {
        draw_cross(place(point), &mut marks);
    }
    draw_stations(&stations.map(place), &plot, &mut marks);
    draw_scale_bar(plot_width, per_metre, [LEFT + 10.0, TOP + plot_height - 12.0], &mut marks);
    let unused = unused_m.iter().any(|unused_m| !unused_m.is_empty());
    let seen = control_points.iter().filter(inside).count();
    draw_legend(stations.len(), unused, [seen, control_points.len()], &mut marks);
    let at = [LEFT + 0.5 * plot_width, height - 9.0];
    let text = "x of station 1 (m), along its azimuth 0";
    marks.push(Mark::text(at, text, LABEL, Ink::Text, Anchor::Middle));
    let at = [10.0, TOP + 0.5 * plot_height];
    marks.push(Mark::upwards(at, "y of station 1 (m)", LABEL, Ink::Text, Anchor::Middle));
    Drawing { size: [width, height], marks }
}

/// Returns the prisms' positions by station and interval (m, station 1's frame).
fn tracks_m(
    triplets: &Triplets,
    station1_from_station: &PerStation<RigidTransform>,
) -> PerStation<Vec<Vec<Vector3<f64>>>> {
    let indices: Vec<usize> = (0..triplets.len()).collect();
    triplets.points_m.zip(station1_from_station, |points_m, transform| {
        let point = |index: &usize| transform.apply(&points_m[*index]);
        indices
            .chunk_by(|a, b| triplets.interval[*a] == triplets.interval[*b])
            .map(|interval| interval.iter().map(point).collect())
            .collect()
    })
}

/// Returns each control point, from the first station that read it (m, station 1's frame). Pillars may be kilometres
/// away, so they are left out.
fn control_points_m(
    control_points: &[ControlPointSet],
    station1_from_station: &PerStation<RigidTransform>,
) -> Vec<Vector3<f64>> {
    let sets = control_points.iter().filter(|set| !set.pillars);
    sets.flat_map(|set| &set.points)
        .filter_map(|point| {
            let read = point.readings.iter().zip(station1_from_station);
            read.filter_map(|(polar, transform)| {
                Some(transform.apply(&polar.as_ref()?.to_cartesian()))
            })
            .next()
        })
        .collect()
}

pub fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    // Stations at one place, or nearly so, still need a plot.
    let free = FREE * (high - low).max(5.0);
    [low - free, high + free]
}

pub fn length([low, high]: [f64; 2]) -> f64 {
    high - low
}

/// Returns a range of this length with the same middle.
pub fn about_middle([low, high]: [f64; 2], length: f64) -> [f64; 2] {
    let middle = 0.5 * (low + high);
    [middle - 0.5 * length, middle + 0.5 * length]
}

/// Drops points that are closer than [`STEP`] to the last one; keeps both ends.
pub fn thinned(points: impl Iterator<Item = [f32; 2]>) -> Vec<[f32; 2]> {
    let mut kept: Vec<[f32; 2]> = Vec::new();
    let mut skipped = None;
    for point in points {
        let near =
            kept.last().is_some_and(|last| (point[0] - last[0]).hypot(point[1] - last[1]) < STEP);
        skipped = near.then_some(point);
        if !near {
            kept.push(point);
        }
    }
    kept.extend(skipped);
    kept
}

/// Draws stations as triangles, as surveyors do, with names that cover neither each other nor a triangle.
fn draw_stations(places: &PerStation<[f32; 2]>, plot: &Area, marks: &mut Vec<Mark>) {
    let mut taken: Vec<Area> = places.iter().map(|&at| Area::about(at, [CORNER; 2])).collect();
    for (station, &[x, y]) in places.iter().enumerate() {
        let (half, foot) = (0.866 * CORNER, 0.5 * CORNER);
        let top = [x, y - CORNER];
        let right = [x + half, y + foot];
        marks.push(Mark::Line {
            // Drawing the first side twice closes the corner.
            points: vec![top, right, [x - half, y + foot], top, right],
            ink: Ink::Rgb(palette::station(station)),
            width: 2.2,
            dashed: false,
        });
        let name = format!("station {}", station + 1);
        let half = [0.5 * text_width(&name, LABEL) + 1.0, 0.55 * LABEL];
        let aside = CORNER + 3.0 + half[0];
        let beside = [[x + aside, y], [x - aside, y]].into_iter();
        // Then above and below, at increasing distances.
        let steps = (0..6).map(|step| CORNER + 3.0 + half[1] + 2.0 * half[1] * step as f32);
        let spots = beside.chain(steps.flat_map(|step| [[x, y - step], [x, y + step]]));
        let free = |area: &Area| plot.holds(area) && !taken.iter().any(|other| area.covers(other));
        let area = spots.map(|at| Area::about(at, half)).find(free);
        let Some(Area { min, max }) = area else { continue };
        taken.push(Area { min, max });
        marks.push(Mark::Rect { min, max, ink: Ink::Paper, opacity: 0.8, outline: None });
        let at = [min[0] + 1.0, 0.5 * (min[1] + max[1])];
        marks.push(Mark::text(at, name, LABEL, Ink::Text, Anchor::Left));
    }
}

struct Area {
    min: [f32; 2],
    max: [f32; 2],
}

impl Area {
    fn about([x, y]: [f32; 2], [across, up]: [f32; 2]) -> Self {
        Self { min: [x - across, y - up], max: [x + across, y + up] }
    }

    fn holds(&self, other: &Self) -> bool {
        (0..2).all(|axis| self.min[axis] <= other.min[axis] && other.max[axis] <= self.max[axis])
    }

    fn covers(&self, other: &Self) -> bool {
        (0..2).all(|axis| self.min[axis] < other.max[axis] && other.min[axis] < self.max[axis])
    }
}

/// Draws a bar of a round length, at most a quarter of the plot.
fn draw_scale_bar(plot_width: f32, per_metre: f64, [x, y]: [f32; 2], marks: &mut Vec<Mark>) {
    let metres = round_down(0.25 * f64::from(plot_width) / per_metre);
    let end = x + (metres * per_metre) as f32;
    marks.push(Mark::Rect {
        min: [x - 5.0, y - 20.0],
        max: [end + 5.0, y + 7.0],
        ink: Ink::Paper,
        opacity: 0.85,
        outline: None,
    });
    let points = vec![[x, y - 4.0], [x, y], [end, y], [end, y - 4.0]];
    marks.push(Mark::Line { points, ink: Ink::Text, width: 1.5, dashed: false });
    let at = [0.5 * (x + end), y - 11.0];
    let text = format!("{} m", number(metres, 1));
    marks.push(Mark::text(at, text, NUMBER, Ink::Text, Anchor::Middle));
}

/// Draws the legend; `seen` of `all` control points are within the plot.
fn draw_legend(stations: usize, unused: bool, [seen, all]: [usize; 2], marks: &mut Vec<Mark>) {
    let (mut x, y) = (LEFT, 11.0);
    for station in 0..stations {
        let ink = Ink::Rgb(palette::station(station));
        marks.push(Mark::line([x, y], [x + 16.0, y], ink, 2.5));
        x += 21.0;
        // Four of the long names do not fit.
        let text = match station {
            1.. if stations > USUAL_STATIONS => format!("{}", station + 1),
            _ => format!("track of station {}", station + 1),
        };
        marks.push(Mark::text([x, y], &*text, LABEL, Ink::Text, Anchor::Left));
        x += text_width(&text, LABEL) + 18.0;
    }
    if unused {
        draw_unused([[x + 4.0, y]].into_iter(), [150, 160, 170], marks);
        let text = "not used";
        marks.push(Mark::text([x + 12.0, y], text, LABEL, Ink::Text, Anchor::Left));
        x += 12.0 + text_width(text, LABEL) + 18.0;
    }
    if all > 0 {
        draw_cross([x + 4.0, y], marks);
        let text = if seen == all {
            "control point".to_owned()
        } else {
            format!("control point ({} of {all} lie outside)", all - seen)
        };
        marks.push(Mark::text([x + 13.0, y], text, LABEL, Ink::Text, Anchor::Left));
    }
}

/// Draws small slanted crosses, one for each place, so that a drive left out completely does not enlarge the picture.
fn draw_unused(places: impl Iterator<Item = [f32; 2]>, rgb: palette::Rgb, marks: &mut Vec<Mark>) {
    const HALF: f32 = 2.2;
    let mut taken = BTreeSet::new();
    for [x, y] in places {
        if taken.insert([x, y].map(|at| (at / (2.0 * STEP)).round() as i32)) {
            for up in [HALF, -HALF] {
                marks.push(Mark::line([x - HALF, y - up], [x + HALF, y + up], Ink::Rgb(rgb), 0.9));
            }
        }
    }
}

fn draw_cross([x, y]: [f32; 2], marks: &mut Vec<Mark>) {
    marks.push(Mark::line([x - 4.0, y], [x + 4.0, y], Ink::Text, 1.2));
    marks.push(Mark::line([x, y - 4.0], [x, y + 4.0], Ink::Text, 1.2));
}

#[cfg(test)]
mod tests {
    use resect_core::network::Station;

    use super::*;

    fn scene(x_m: f64, y_m: f64) -> Drawing {
        let corners = [[0.0, 0.0], [x_m, 0.0], [x_m, y_m]];
        let points: Vec<_> = corners.map(|[x, y]| Vector3::new(x, y, 0.0)).to_vec();
        let triplets = Triplets::new(
            vec![0.0, 1.0, 2.0],
            vec![0; 3],
            [points.clone(), points.clone(), points],
        );
        let tracks = Tracks { triplets: &triplets, unused_m: &Default::default() };
        draw(&[], &tracks, &PerStation::repeat(3, RigidTransform::IDENTITY), 700.0)
    }

    fn tracks(drawing: &Drawing) -> Vec<Vec<[f32; 2]>> {
        let track = |mark: &Mark| match mark {
            Mark::Line { points, width, .. } if *width == 1.3 => Some(points.clone()),
            _ => None,
        };
        drawing.marks.iter().filter_map(track).collect()
    }

    #[test]
    fn a_metre_is_as_long_up_as_across_and_all_is_inside() {
        for [x_m, y_m] in [[10.0, 10.0], [900.0, 4.0], [4.0, 900.0], [0.3, 0.1]] {
            let drawing = scene(x_m, y_m);
            let tracks = tracks(&drawing);
            assert_eq!(tracks.len(), 3);
            let [a, b, c] = tracks[0][..] else { panic!("three corners") };
            let (across, up) = (f64::from(b[0] - a[0]) / x_m, f64::from(b[1] - c[1]) / y_m);
            assert!((across / up - 1.0).abs() < 1e-3, "{x_m} × {y_m}: {across} {up}");
            for [x, y] in [a, b, c] {
                assert!((LEFT..=700.0 - RIGHT).contains(&x), "{x_m} × {y_m}: {x}");
                assert!((TOP..=drawing.size[1] - BOTTOM).contains(&y), "{x_m} × {y_m}: {y}");
            }
            assert!(drawing.size[1] <= TOP + HEIGHTS[1] + BOTTOM + 1.0);
        }
    }

    #[test]
    fn names_of_stations_in_one_place_stand_apart() {
        let drawing = scene(100.0, 50.0);
        let name = |mark: &Mark| match mark {
            Mark::Text { at, text, .. } if text.starts_with("station ") => {
                Some((*at, text_width(text, LABEL)))
            }
            _ => None,
        };
        let names: Vec<_> = drawing.marks.iter().filter_map(name).collect();
        assert_eq!(names.len(), 3);
        for (a, b) in [(0, 1), (0, 2), (1, 2)] {
            let ([at, other], width) = ([names[a].0, names[b].0], names[a].1);
            let apart = (at[0] - other[0]).abs() >= width || (at[1] - other[1]).abs() >= LABEL;
            assert!(apart, "stations {} and {}: {names:?}", a + 1, b + 1);
        }
    }

    #[test]
    fn what_is_not_used_is_drawn_where_it_was_and_presses_nothing_aside() {
        let triplets = Triplets::new(
            vec![0.0, 1.0],
            vec![0; 2],
            [0, 1, 2].map(|_| [0.0, 10.0].map(|x| Vector3::new(x, x, 0.0)).to_vec()),
        );
        let with = |unused: &[f64]| {
            let unused_m = PerStation::from_fn(3, |station: Station| match station.number() {
                2 => unused.iter().map(|x| Vector3::new(*x, *x, 0.0)).collect(),
                _ => Vec::new(),
            });
            let tracks = Tracks { triplets: &triplets, unused_m: &unused_m };
            let drawing =
                draw(&[], &tracks, &PerStation::repeat(3, RigidTransform::IDENTITY), 700.0);
            let of_station_2 = |mark: &&Mark| {
                matches!(mark, Mark::Line { ink, width, .. }
                if *ink == Ink::Rgb(palette::station(1)) && *width == 0.9)
            };
            (drawing.size, drawing.marks.iter().filter(of_station_2).count())
        };
        let (size, none) = with(&[]);
        assert_eq!(none, 0);
        // One of them is far away; two are at one place.
        assert_eq!(with(&[3.0, 7.0, 7.0001, 5000.0]), (size, 4));
    }

    #[test]
    fn thinning_keeps_both_ends() {
        let points: Vec<[f32; 2]> = (0..=101).map(|i| [0.3 * i as f32, 5.0]).collect();
        let kept = thinned(points.iter().copied());
        assert!(kept.len() < 30, "{}", kept.len());
        assert_eq!((kept.first(), kept.last()), (points.first(), points.last()));
    }
}
