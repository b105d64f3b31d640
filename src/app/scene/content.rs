//! What is drawn: points and lines, each in the frame of its station.

use nalgebra::Vector3;

use super::{overlays, station_uncertainty};
use crate::analysis::Analysis;
use crate::app::state::Visibility;
use crate::deployment::Deployment;
use crate::geometry::RigidTransform;
use crate::palette::{self, Rgb};
use crate::pipeline::SampleFate;

/// Index of the frame in which a vertex stands: stations 1–3 are 0–2, the world (station 1) is 3.
pub const WORLD: u32 = 3;
/// How many points the camera looks at to fit everything.
const OUTLINE_POINTS: usize = 2000;
/// Length of the axes at a station (m).
const AXIS_M: f32 = 1.5;

/// A disc of constant size on the screen.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct PointVertex {
    pub position_m: [f32; 3],
    pub frame: u32,
    pub colour: [u8; 4],
    pub diameter_points: f32,
}

/// A straight line of constant width on the screen.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct LineVertex {
    pub from_m: [f32; 3],
    pub from_frame: u32,
    pub to_m: [f32; 3],
    pub to_frame: u32,
    pub colour: [u8; 4],
    pub width_points: f32,
}

/// Text at a place.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    pub position_m: Vector3<f32>,
    pub text: String,
    pub colour: Rgb,
}

/// A list of vertices and a number that changes when they do.
#[derive(Clone, Debug, Default)]
pub struct Layer {
    pub points: Vec<PointVertex>,
    pub lines: Vec<LineVertex>,
    pub version: u64,
}

/// Everything in the scene.
#[derive(Clone, Debug, Default)]
pub struct SceneContent {
    /// Changes with the analysis and the visibility.
    pub data: Layer,
    /// The prism triangle at the time cursor.
    pub cursor: Layer,
    /// Of stations 1–3 into the world.
    pub station1_from_station: [Option<RigidTransform>; 3],
    pub labels: Vec<Label>,
    /// Corners of the box around stations and tracks (m); `None` when there is nothing.
    pub bounds_m: Option<(Vector3<f32>, Vector3<f32>)>,
    /// A sample of the same, for the camera to look at.
    pub outline_m: Vec<Vector3<f32>>,
    pub grid_spacing_m: f32,
    /// How much larger than true the ellipsoids of the interpolation are, where there are any.
    pub exaggeration: Option<f64>,
    /// And those of the stations.
    pub station_exaggeration: Option<f64>,
}

pub fn f32s(p: &Vector3<f64>) -> [f32; 3] {
    [p.x as f32, p.y as f32, p.z as f32]
}

pub fn opaque([r, g, b]: Rgb) -> [u8; 4] {
    [r, g, b, 255]
}

impl SceneContent {
    /// Rebuilds the data layer. Without an answer only station 1, whose frame is the world, has a place.
    pub fn rebuild(
        &mut self,
        deployment: &Deployment,
        analysis: &Analysis,
        visibility: &Visibility,
        grid_colour: [u8; 4],
    ) {
        let transforms = match &analysis.answer {
            Ok(answer) => answer.calibration.station1_from_station.map(Some),
            Err(_) => [Some(RigidTransform::IDENTITY), None, None],
        };
        self.station1_from_station = transforms;
        self.data.points.clear();
        self.data.lines.clear();
        self.labels.clear();
        self.outline_m.clear();
        self.exaggeration = None;
        self.station_exaggeration = None;
        self.data.version += 1;
        let mut bounds: Option<(Vector3<f32>, Vector3<f32>)> = None;
        for (station, transform) in transforms.iter().enumerate() {
            let Some(transform) = transform else { continue };
            let track = &deployment.tracks[station];
            let kept = track.measurements.iter().zip(&analysis.pipeline.fates[station].each);
            let none_kept = analysis.triplets().is_empty();
            // Outliers may lie anywhere; they must not push the rest into a corner.
            let seen = kept
                .filter(|(_, fate)| none_kept || !matches!(fate, SampleFate::Rejected(_)))
                .map(|(m, _)| track.position_m(m));
            for p in std::iter::once(Vector3::zeros()).chain(seen) {
                let p = transform.apply(&p).cast::<f32>();
                let (low, high) = bounds.unwrap_or((p, p));
                bounds = Some((low.inf(&p), high.sup(&p)));
                self.outline_m.push(p);
            }
            if !visibility.stations[station] {
                continue;
            }
            if visibility.raw {
                self.add_raw(deployment, analysis, station);
            }
            if visibility.tracks {
                self.add_track(analysis, station);
            }
            if visibility.uncertainty {
                self.exaggeration = overlays::add_uncertainty(self, analysis, station);
            }
            if visibility.control_points {
                self.add_control_points(deployment, station, transform);
            }
            self.add_station(station, transform);
        }
        if visibility.poses {
            overlays::add_poses(&mut self.data.lines, deployment, analysis);
        }
        self.bounds_m = bounds;
        let step = self.outline_m.len().div_ceil(OUTLINE_POINTS).max(1);
        self.outline_m = self.outline_m.iter().step_by(step).copied().collect();
        // Thinning must not lose a station.
        let origins = transforms.iter().flatten().map(|t| t.translation_m.cast::<f32>());
        self.outline_m.extend(origins);
        self.add_what_is_known(analysis, visibility);
        // Painted from the last, while there is room: stations before all else.
        self.labels.sort_by_key(|label| label.text.starts_with("Station"));
        self.add_grid(grid_colour);
    }

    /// How well the stations are known.
    fn add_what_is_known(&mut self, analysis: &Analysis, visibility: &Visibility) {
        let Ok(answer) = &analysis.answer else { return };
        let (calibration, shown) = (&answer.calibration, &visibility.stations);
        if visibility.station_ellipsoids {
            self.station_exaggeration =
                station_uncertainty::add_ellipsoids(self, calibration, shown);
        }
        if visibility.weak_directions
            && let Some(details) = calibration.inter_prism()
        {
            let observed = &details.observability;
            station_uncertainty::add_weak_directions(self, calibration, observed, shown);
        }
    }

    fn add_raw(&mut self, deployment: &Deployment, analysis: &Analysis, station: usize) {
        let track = &deployment.tracks[station];
        let fates = &analysis.pipeline.fates[station].each;
        for (measurement, fate) in track.measurements.iter().zip(fates) {
            let kept = *fate == SampleFate::Kept;
            self.data.points.push(PointVertex {
                position_m: f32s(&track.position_m(measurement)),
                frame: station as u32,
                colour: opaque(palette::fate(*fate)),
                diameter_points: if kept { 2.5 } else { 4.0 },
            });
        }
    }

    fn add_track(&mut self, analysis: &Analysis, station: usize) {
        let triplets = analysis.triplets();
        let points = &triplets.points_m[station];
        for i in 1..points.len() {
            if triplets.interval[i] == triplets.interval[i - 1] {
                self.data.lines.push(LineVertex {
                    from_m: f32s(&points[i - 1]),
                    from_frame: station as u32,
                    to_m: f32s(&points[i]),
                    to_frame: station as u32,
                    colour: opaque(palette::STATIONS[station]),
                    width_points: 1.6,
                });
            }
        }
    }

    fn add_control_points(
        &mut self,
        deployment: &Deployment,
        station: usize,
        transform: &RigidTransform,
    ) {
        for set in &deployment.control_points {
            for point in &set.points {
                let Some(polar) = point.readings[station] else { continue };
                let position = polar.to_cartesian();
                let place = transform.apply(&position).cast::<f32>();
                // A cross of fixed size, so that the stations' versions of a point can be told apart.
                for axis in 0..3 {
                    let mut arm = Vector3::zeros();
                    arm[axis] = 0.35;
                    self.world_line(place - arm, place + arm, palette::STATIONS[station], 1.5);
                }
                if station == 0 {
                    self.labels.push(Label {
                        position_m: place,
                        text: if set.pillars {
                            format!("pillar {}", point.marker)
                        } else {
                            point.marker.to_string()
                        },
                        colour: palette::fate(SampleFate::Kept),
                    });
                }
            }
        }
    }

    /// A tripod with its frame's axes, x red, y green, z blue, and the name.
    fn add_station(&mut self, station: usize, transform: &RigidTransform) {
        let origin = transform.translation_m.cast::<f32>();
        let turn = |v: Vector3<f64>| transform.rotate(&v).cast::<f32>();
        for (axis, colour) in overlays::AXES {
            self.world_line(origin, origin + AXIS_M * turn(axis), colour, 2.0);
        }
        for leg in 0..3 {
            let angle = f64::from(leg) * std::f64::consts::TAU / 3.0;
            let foot = turn(Vector3::new(0.55 * angle.cos(), 0.55 * angle.sin(), -1.5));
            self.world_line(origin, origin + foot, palette::STATIONS[station], 1.5);
        }
        self.data.points.push(PointVertex {
            position_m: origin.into(),
            frame: WORLD,
            colour: opaque(palette::STATIONS[station]),
            diameter_points: 9.0,
        });
        self.labels.push(Label {
            position_m: origin + Vector3::new(0.0, 0.0, 0.4),
            text: format!("Station {}", station + 1),
            colour: palette::STATIONS[station],
        });
    }

    /// A square grid under everything, spaced 1, 2 or 5 times a power of ten.
    fn add_grid(&mut self, colour: [u8; 4]) {
        let Some((low, high)) = self.bounds_m else { return };
        let extent = (high.x - low.x).max(high.y - low.y).max(1.0);
        let rough = extent / 10.0;
        let decade = 10_f32.powf(rough.log10().floor());
        let spacing = [1.0, 2.0, 5.0, 10.0]
            .map(|step| step * decade)
            .into_iter()
            .find(|step| *step >= rough)
            .unwrap_or(decade * 10.0);
        self.grid_spacing_m = spacing;
        let z = low.z - 0.02 * extent.min(20.0);
        let from = |v: f32| (v / spacing).floor() as i32 - 1;
        let to = |v: f32| (v / spacing).ceil() as i32 + 1;
        let (x0, x1, y0, y1) = (from(low.x), to(high.x), from(low.y), to(high.y));
        let place = |i: i32, j: i32| Vector3::new(i as f32 * spacing, j as f32 * spacing, z);
        for i in x0..=x1 {
            self.grid_line(place(i, y0), place(i, y1), colour);
        }
        for j in y0..=y1 {
            self.grid_line(place(x0, j), place(x1, j), colour);
        }
    }

    fn grid_line(&mut self, from: Vector3<f32>, to: Vector3<f32>, colour: [u8; 4]) {
        self.data.lines.push(LineVertex {
            from_m: from.into(),
            from_frame: WORLD,
            to_m: to.into(),
            to_frame: WORLD,
            colour,
            width_points: 1.0,
        });
    }

    fn world_line(&mut self, from: Vector3<f32>, to: Vector3<f32>, colour: Rgb, width_points: f32) {
        self.data.lines.push(LineVertex {
            from_m: from.into(),
            from_frame: WORLD,
            to_m: to.into(),
            to_frame: WORLD,
            colour: opaque(colour),
            width_points,
        });
    }

    /// Puts the prism triangle and the vehicle's axes at an instant of the triplets, or takes them away.
    pub fn set_cursor(
        &mut self,
        deployment: &Deployment,
        analysis: &Analysis,
        instant: Option<usize>,
        colour: Rgb,
    ) {
        self.cursor.points.clear();
        self.cursor.lines.clear();
        self.cursor.version += 1;
        let Some(instant) = instant else { return };
        let placed: Vec<usize> =
            (0..3).filter(|s| self.station1_from_station[*s].is_some()).collect();
        let corners = analysis.triplets().triplet_m(instant).map(|p| f32s(&p));
        for &station in &placed {
            self.cursor.points.push(PointVertex {
                position_m: corners[station],
                frame: station as u32,
                colour: opaque(palette::STATIONS[station]),
                diameter_points: 10.0,
            });
        }
        if placed.len() == 3 {
            overlays::add_pose_at(&mut self.cursor.lines, deployment, analysis, instant);
            for (a, b) in crate::deployment::PAIRS {
                self.cursor.lines.push(LineVertex {
                    from_m: corners[a],
                    from_frame: a as u32,
                    to_m: corners[b],
                    to_frame: b as u32,
                    colour: opaque(colour),
                    width_points: 2.5,
                });
            }
        }
    }
}
