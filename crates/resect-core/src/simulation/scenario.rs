//! What is driven, where, and how well it is measured.

use nalgebra::{Vector2, Vector3};

use super::error_kind::ErrorKind;
use super::errors::SystematicErrors;
use super::ground::Ground;
use crate::geometry::ARCSECOND_RAD;

/// The ready-made scenarios.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preset {
    /// A Warthog-like rig (about 0.9, 0.8 and 1.0 m) wandering over uneven ground, with control points.
    Warthog,
    /// A small HD2-like rig (0.35 m) up and down a tunnel.
    Hd2Tunnel,
    /// The Warthog on flat ground, where nothing but the rig tells the mirror twin.
    FlatFloor,
    /// The Warthog where it pitches and rolls more.
    UnevenGround,
    /// One prism that all three stations follow, for method C.
    SinglePrism,
    /// Eights: turns to both sides.
    FigureEight,
    /// Eights with prisms a hand's breadth apart, where every millimetre of a distance tells.
    ShortBaselines,
    /// One straight line on flat ground: most directions stay free.
    StraightLine,
    /// Round and round on flat ground.
    Circle,
    /// Two straight legs on flat ground: only the turn between them holds the answer.
    LShape,
    /// The Warthog with all the errors of real instruments, drawn from the seed as large as in the field.
    FieldErrors,
}

/// Where the vehicle goes.
#[derive(Clone, Debug, PartialEq)]
pub enum Path {
    /// Winding about a centre (m), turning back at a radius (m).
    Wander { centre_m: [f64; 2], radius_m: f64 },
    /// Along x between two ends (m), weaving by an amplitude (m) with a wavelength (m), and back.
    Tunnel { from_x_m: f64, to_x_m: f64, amplitude_m: f64, wavelength_m: f64 },
    /// Along x from a start (m), straight but for bends, and from the beginning again where they end.
    Bends { start_m: [f64; 2], bends: &'static [Bend] },
    /// From one waypoint to the next, corners rounded by the tightest turn (m), and to stand at the last one.
    Waypoints { waypoints: Vec<Waypoint>, turn_radius_m: f64 },
}

/// A place on the way, in station 1's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waypoint {
    pub x_m: f64,
    pub y_m: f64,
    /// How fast it is driven to.
    pub speed_m_per_s: f64,
    /// How long the vehicle stands there.
    pub stand_s: f64,
}

impl Waypoint {
    pub fn place_m(&self) -> Vector2<f64> {
        Vector2::new(self.x_m, self.y_m)
    }
}

/// A piece of the way with constant curvature (1/m, left positive).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bend {
    pub length_m: f64,
    pub curvature_per_m: f64,
}

const fn bend(length_m: f64, curvature_per_m: f64) -> Bend {
    Bend { length_m, curvature_per_m }
}

/// Two full circles of radius 6 m, one to each side.
const EIGHT: &[Bend] = &[bend(37.7, 1.0 / 6.0), bend(37.7, -1.0 / 6.0)];
const STRAIGHT: &[Bend] = &[bend(1000.0, 0.0)];
const CIRCLE: &[Bend] = &[bend(1000.0, 0.1)];
/// A quarter turn of radius 1 m between the legs, as a skid-steered vehicle does it.
const TWO_LEGS: &[Bend] = &[bend(45.0, 0.0), bend(1.57, 1.0), bend(1000.0, 0.0)];

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    pub range_sigma_m: f64,
    pub angle_sigma_rad: f64,
    /// Chance of a gross error of a reading.
    pub outlier_share: f64,
    /// Lost locks of each station per minute.
    pub lost_locks_per_minute: f64,
    /// How often a minute each station follows the prism of the next one for a while.
    pub wrong_targets_per_minute: f64,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    pub name: &'static str,
    pub duration_s: f64,
    pub cruise_m_per_s: f64,
    pub path: Path,
    /// In the frame of station 1.
    pub ground: Ground,
    pub noise: Noise,
    /// Readings per second of each station.
    pub rate_hz: f64,
    /// When each station takes its first reading (s); `None` for any time within the first period, from the seed.
    pub stagger_s: Option<[f64; 3]>,
    /// Prisms about the vehicle's origin on the ground: x ahead, y left, z up (m).
    pub prisms_m: [Vector3<f64>; 3],
    /// GNSS antennas, in the same frame.
    pub antennas_m: Option<[Vector3<f64>; 3]>,
    /// Positions of stations 2 and 3 in station 1's frame (m).
    pub stations_m: [Vector3<f64>; 2],
    /// Yaws of stations 2 and 3; `None` for any, from the seed.
    pub yaws_rad: Option<[f64; 2]>,
    /// Sets of ten control points.
    pub control_point_sets: usize,
    /// Surveyed pillars on a line, for method A.
    pub pillars: bool,
    /// Times (start and end, s of the drive) in which nothing is recorded of any station, wherever the vehicle goes
    /// meanwhile.
    pub pauses_s: Vec<[f64; 2]>,
    /// Added by the user to every range; the simulated instruments leave it off.
    pub prism_constant_m: f64,
    pub errors: SystematicErrors,
    /// Kinds of errors that the seed draws, in place of those above.
    pub drawn_errors: Vec<ErrorKind>,
}

impl Preset {
    pub const ALL: [Self; 11] = [
        Self::Warthog,
        Self::Hd2Tunnel,
        Self::FlatFloor,
        Self::UnevenGround,
        Self::SinglePrism,
        Self::FigureEight,
        Self::ShortBaselines,
        Self::StraightLine,
        Self::Circle,
        Self::LShape,
        Self::FieldErrors,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Self::Warthog => "warthog",
            Self::Hd2Tunnel => "hd2-tunnel",
            Self::FlatFloor => "flat-floor",
            Self::UnevenGround => "uneven-ground",
            Self::SinglePrism => "single-prism",
            Self::FigureEight => "figure-eight",
            Self::ShortBaselines => "short-baselines",
            Self::StraightLine => "straight-line",
            Self::Circle => "circle",
            Self::LShape => "l-shape",
            Self::FieldErrors => "field-errors",
        }
    }

    #[expect(clippy::too_many_lines, reason = "one list; not split yet")]
    pub fn scenario(self) -> Scenario {
        let flat = || Ground { slope_rms_rad: 0.0, ..Ground::default() };
        let warthog = || Self::Warthog.scenario();
        // Bends are driven on flat ground, so that nothing but their shape matters.
        let driven = |bends: &'static [Bend], duration_s: f64| Scenario {
            name: self.name(),
            duration_s,
            ground: flat(),
            path: Path::Bends { start_m: [50.0, -25.0], bends },
            ..warthog()
        };
        let noise = Noise {
            range_sigma_m: 0.002,
            angle_sigma_rad: ARCSECOND_RAD,
            outlier_share: 0.004,
            lost_locks_per_minute: 0.4,
            wrong_targets_per_minute: 0.0,
        };
        match self {
            Self::Warthog => Scenario {
                name: "warthog",
                duration_s: 420.0,
                cruise_m_per_s: 0.9,
                path: Path::Wander { centre_m: [62.0, 8.0], radius_m: 24.0 },
                ground: Ground::default(),
                noise,
                rate_hz: 2.5,
                stagger_s: None,
                prisms_m: [
                    Vector3::new(0.45, 0.05, 1.55),
                    Vector3::new(-0.28, 0.47, 1.20),
                    Vector3::new(-0.13, -0.47, 1.38),
                ],
                antennas_m: Some([
                    Vector3::new(0.40, -0.30, 1.10),
                    Vector3::new(-0.35, -0.28, 1.12),
                    Vector3::new(0.02, 0.38, 1.31),
                ]),
                stations_m: [Vector3::new(5.2, -2.6, -0.28), Vector3::new(-5.4, 0.4, -0.22)],
                yaws_rad: None,
                control_point_sets: 2,
                pillars: true,
                pauses_s: Vec::new(),
                prism_constant_m: 0.010,
                errors: SystematicErrors::default(),
                drawn_errors: Vec::new(),
            },
            Self::FlatFloor => Scenario { name: self.name(), ground: flat(), ..warthog() },
            Self::UnevenGround => Scenario {
                name: self.name(),
                ground: Ground { slope_rms_rad: 0.09, ..Ground::default() },
                ..warthog()
            },
            Self::SinglePrism => Scenario {
                name: self.name(),
                prisms_m: [Vector3::new(0.0, 0.0, 1.5); 3],
                antennas_m: None,
                ..warthog()
            },
            Self::FigureEight => driven(EIGHT, 300.0),
            Self::ShortBaselines => Scenario {
                prisms_m: [
                    Vector3::new(0.10, 0.00, 0.62),
                    Vector3::new(-0.05, 0.09, 0.55),
                    Vector3::new(-0.05, -0.09, 0.59),
                ],
                antennas_m: None,
                ..driven(EIGHT, 300.0)
            },
            Self::StraightLine => driven(STRAIGHT, 100.0),
            Self::Circle => driven(CIRCLE, 300.0),
            Self::LShape => driven(TWO_LEGS, 150.0),
            Self::FieldErrors => {
                Scenario { name: self.name(), drawn_errors: ErrorKind::ALL.to_vec(), ..warthog() }
            }
            Self::Hd2Tunnel => Scenario {
                name: "hd2-tunnel",
                duration_s: 400.0,
                cruise_m_per_s: 0.6,
                path: Path::Tunnel {
                    from_x_m: 14.0,
                    to_x_m: 70.0,
                    amplitude_m: 0.9,
                    wavelength_m: 17.0,
                },
                ground: Ground {
                    height_m: -1.5,
                    slope_rms_rad: 0.012,
                    wavelengths_m: [4.0, 20.0],
                    ..Ground::default()
                },
                noise: Noise { lost_locks_per_minute: 0.25, ..noise },
                rate_hz: 2.5,
                stagger_s: None,
                prisms_m: [
                    Vector3::new(0.20, 0.00, 0.62),
                    Vector3::new(-0.08, 0.17, 0.50),
                    Vector3::new(-0.08, -0.17, 0.57),
                ],
                antennas_m: None,
                stations_m: [Vector3::new(1.6, 1.3, -0.05), Vector3::new(-0.9, -1.2, 0.04)],
                yaws_rad: None,
                control_point_sets: 0,
                pillars: false,
                pauses_s: Vec::new(),
                prism_constant_m: 0.010,
                errors: SystematicErrors::default(),
                drawn_errors: Vec::new(),
            },
        }
    }
}
