//! Rebuilds the scene from a calibration: stations, control points, poses, and their uncertainties.

use nalgebra::Vector3;

use super::content::SceneContent;
use super::grid::Grid;
use super::vertices::{Label, Landmark, LineVertex, PointVertex, Rank, WORLD, opaque};
use super::{overlays, station_uncertainty, vehicle};
use crate::app::model::{Camera, SceneOptions, Visibility};
use crate::app::prepared::placing::{placed, placed_tracks};
use resect_core::analysis::Analysis;
use resect_core::deployment::Deployment;
use resect_core::geometry::RigidTransform;
use resect_core::network::Number;
use resect_core::pipeline::SampleFate;
use resect_tools::palette;
use resect_tools::palette::Rgb;

/// Length of the axes at a station (m).
const AXIS_M: f32 = 1.5;

impl SceneContent {
    /// Highlights the readings, tracks and poses of a span of time (s, in the stations' clock).
    pub fn set_selection(&mut self, selected_s: Option<[f64; 2]>, origin_s: f64) {
        self.selection_s = selected_s.map(|span_s| span_s.map(|t| (t - origin_s) as f32));
        if self.selected_s != selected_s {
            self.selected_s = selected_s;
            self.along.clear();
            overlays::add_poses(&mut self.along.lines, &self.poses, selected_s);
        }
    }

    /// Rebuilds everything but readings and tracks, of which it samples some points.
    pub fn rebuild(
        &mut self,
        deployment: &Deployment,
        analysis: &Analysis,
        visibility: &Visibility,
        options: &SceneOptions,
    ) {
        self.station1_from_station = placed(deployment, analysis);
        self.station1_from_tracks = placed_tracks(deployment, analysis);
        self.data.clear();
        self.labels.clear();
        self.landmarks.clear();
        self.set_ground_truth(deployment);
        self.find_bounds(analysis);
        (self.track_ellipsoids, self.station_ellipsoids) = (false, false);
        self.arrows = None;
        let transforms = self.station1_from_station.clone();
        let shown = |station: usize| transforms[station].is_some() && visibility.stations[station];
        let tracks = self.station1_from_tracks.clone();
        let track_shown = |station: usize| tracks[station].is_some() && shown(station);
        let followed = &analysis.offer.followed;
        self.raw_shown = transforms.map_each(|k, _| visibility.raw && track_shown(k.index()));
        self.tracks_shown = transforms.map_each(|k, _| {
            visibility.shows_track(k.index(), followed[k].index()) && track_shown(k.index())
        });
        let fates = (0..SampleFate::ALL.len()).filter(|fate| visibility.fates[*fate]);
        self.shown_fates = fates.map(|fate| 1 << fate).sum();
        let points_placed = match &analysis.answer {
            Ok(answer) => answer.calibration.placing_control_points(deployment).is_some(),
            Err(_) => true,
        };
        if visibility.uncertainty {
            // A hidden track has no ellipsoids.
            let drawn = |station: &usize| {
                track_shown(*station) && visibility.prisms[followed[*station].index()]
            };
            let stations: Vec<usize> = (0..transforms.len()).filter(drawn).collect();
            let scale = f64::from(options.ellipsoid_scale);
            self.track_ellipsoids = overlays::add_uncertainty(self, analysis, &stations, scale);
        }
        for (station, transform) in transforms.iter().enumerate() {
            let Some(transform) = transform.filter(|_| shown(station)) else { continue };
            if visibility.control_points && points_placed {
                self.add_control_points(deployment, station, &transform);
            }
            self.add_station(station, &transform);
        }
        if visibility.control_points && visibility.residuals {
            let shown = transforms.map_each(|station, _| shown(station.index()));
            self.arrows = self.add_residuals(deployment, analysis, &shown, options.residual_scale);
        }
        self.poses =
            if visibility.poses { vehicle::poses_along(deployment, analysis) } else { Vec::new() };
        self.along.clear();
        overlays::add_poses(&mut self.along.lines, &self.poses, self.selected_s);
        self.find_outline(analysis, visibility);
        self.add_what_is_known(analysis, visibility, options);
        // Among equal ranks the last is placed first, as when there were only control points and stations.
        self.labels.sort_by_key(|label| label.rank);
    }

    /// Rebuilds the grid if the camera needs another one.
    pub fn set_grid(&mut self, camera: &Camera, viewport_height: f32, colour: [u8; 4]) {
        let grid = self.bounds_m.map(|(low, high)| Grid::of(camera, viewport_height, &low, &high));
        let drawn = self.ground.lines.first().map(|line| line.colour);
        if grid == self.grid && drawn.is_none_or(|drawn| drawn == colour) {
            return;
        }
        self.ground.clear();
        if let Some(grid) = &grid {
            grid.add_lines(&mut self.ground.lines, colour);
        }
        self.grid = grid;
    }

    /// Adds the uncertainties of the stations.
    fn add_what_is_known(
        &mut self,
        analysis: &Analysis,
        visibility: &Visibility,
        options: &SceneOptions,
    ) {
        let Ok(answer) = &analysis.answer else { return };
        let (calibration, shown) = (&answer.calibration, &visibility.stations);
        if visibility.station_ellipsoids {
            let scale = f64::from(options.ellipsoid_scale);
            self.station_ellipsoids =
                station_uncertainty::add_ellipsoids(self, calibration, shown, scale);
        }
        if visibility.weak_directions
            && let Some(details) = calibration.inter_prism()
        {
            let observed = &details.observability;
            station_uncertainty::add_weak_directions(self, calibration, observed, shown);
        }
    }

    /// Adds a tripod with its frame's axes, x red, y green, z blue, and the name.
    fn add_station(&mut self, station: usize, transform: &RigidTransform) {
        let origin = transform.translation_m.cast::<f32>();
        let turn = |v: Vector3<f64>| transform.rotate(&v).cast::<f32>();
        for (axis, colour) in overlays::AXES {
            self.world_line(origin, origin + AXIS_M * turn(axis), colour, 2.0);
        }
        for leg in 0..3 {
            let angle = f64::from(leg) * std::f64::consts::TAU / 3.0;
            let foot = turn(Vector3::new(0.55 * angle.cos(), 0.55 * angle.sin(), -1.5));
            self.world_line(origin, origin + foot, palette::station(station), 1.5);
        }
        self.data.points.push(PointVertex {
            position_m: origin.into(),
            frame: WORLD,
            colour: opaque(palette::station(station)),
            diameter_points: 9.0,
        });
        self.labels.push(Label {
            position_m: origin + Vector3::new(0.0, 0.0, 0.4),
            text: format!("Station {}", station + 1),
            colour: palette::station(station),
            rank: Rank::Station,
        });
        self.landmarks.push(Landmark {
            position_m: transform.translation_m,
            name: format!("station {}", station + 1),
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
}
