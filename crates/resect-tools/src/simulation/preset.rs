//! Ready-made scenarios.

use nalgebra::Vector3;

use super::error_kind::ErrorKind;
use super::errors::SystematicErrors;
use super::ground::Ground;
use super::scenario::{Bend, Noise, Path, Scenario};
use resect_core::geometry::ARCSECOND_RAD;

/// A ready-made scenario.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preset {
    /// A Warthog-like rig (about 0.9, 0.8 and 1.0 m) wandering over uneven ground, with control points.
    Warthog,
    /// A small HD2-like rig (0.35 m) that drives up and down a tunnel.
    Hd2Tunnel,
    /// The Warthog on flat ground, where only the rig excludes the mirror twin.
    FlatFloor,
    /// The Warthog on ground with larger slopes, and so larger pitch and roll.
    UnevenGround,
    /// One prism tracked by all stations, for method C.
    SinglePrism,
    /// Figure-eights: turns to both sides.
    FigureEight,
    /// Figure-eights with prisms a hand's breadth apart, sensitive to a millimetre of error in their distances.
    ShortBaselines,
    /// One straight line on flat ground: most directions are not observable.
    StraightLine,
    /// Circles on flat ground.
    Circle,
    /// Two straight legs on flat ground with one turn between them.
    LShape,
    /// The Warthog with systematic errors of all kinds, drawn from the seed as large as in the field.
    FieldErrors,
}

const fn bend(length_m: f64, curvature_per_m: f64) -> Bend {
    Bend { length_m, curvature_per_m }
}

/// Two full circles of radius 6 m, one to each side.
const EIGHT: &[Bend] = &[bend(37.7, 1.0 / 6.0), bend(37.7, -1.0 / 6.0)];
const STRAIGHT: &[Bend] = &[bend(1000.0, 0.0)];
const CIRCLE: &[Bend] = &[bend(1000.0, 0.1)];
/// A quarter turn of radius 1 m between the legs, as by a skid-steered vehicle.
const TWO_LEGS: &[Bend] = &[bend(45.0, 0.0), bend(1.57, 1.0), bend(1000.0, 0.0)];

const NOISE: Noise = Noise {
    range_sigma_m: 0.002,
    angle_sigma_rad: ARCSECOND_RAD,
    outlier_share: 0.004,
    lost_locks_per_minute: 0.4,
    wrong_targets_per_minute: 0.0,
};

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

    pub fn scenario(self) -> Scenario {
        let name = self.name();
        match self {
            Self::Warthog => warthog(),
            Self::Hd2Tunnel => hd2_tunnel(),
            Self::FlatFloor => Scenario { name, ground: flat_ground(), ..warthog() },
            Self::UnevenGround => Scenario {
                name,
                ground: Ground { slope_rms_rad: 0.09, ..Ground::default() },
                ..warthog()
            },
            Self::SinglePrism => Scenario {
                name,
                prisms_m: [Vector3::new(0.0, 0.0, 1.5); 3].into(),
                antennas_m: None,
                ..warthog()
            },
            Self::FigureEight => drive_bends(name, EIGHT, 300.0),
            Self::ShortBaselines => Scenario {
                prisms_m: [
                    Vector3::new(0.10, 0.00, 0.62),
                    Vector3::new(-0.05, 0.09, 0.55),
                    Vector3::new(-0.05, -0.09, 0.59),
                ]
                .into(),
                antennas_m: None,
                ..drive_bends(name, EIGHT, 300.0)
            },
            Self::StraightLine => drive_bends(name, STRAIGHT, 100.0),
            Self::Circle => drive_bends(name, CIRCLE, 300.0),
            Self::LShape => drive_bends(name, TWO_LEGS, 150.0),
            Self::FieldErrors => {
                Scenario { name, drawn_errors: ErrorKind::ALL.to_vec(), ..warthog() }
            }
        }
    }
}

fn flat_ground() -> Ground {
    Ground { slope_rms_rad: 0.0, ..Ground::default() }
}

/// Returns a scenario of bends on flat ground, to isolate the effect of their shape.
fn drive_bends(name: &'static str, bends: &'static [Bend], duration_s: f64) -> Scenario {
    Scenario {
        name,
        duration_s,
        ground: flat_ground(),
        path: Path::Bends { start_m: [50.0, -25.0], bends },
        ..warthog()
    }
}

fn warthog() -> Scenario {
    Scenario {
        name: "warthog",
        duration_s: 420.0,
        cruise_m_per_s: 0.9,
        path: Path::Wander { centre_m: [62.0, 8.0], radius_m: 24.0 },
        ground: Ground::default(),
        noise: NOISE,
        rate_hz: 2.5,
        stagger_s: None,
        prisms_m: [
            Vector3::new(0.45, 0.05, 1.55),
            Vector3::new(-0.28, 0.47, 1.20),
            Vector3::new(-0.13, -0.47, 1.38),
        ]
        .into(),
        antennas_m: Some([
            Vector3::new(0.40, -0.30, 1.10),
            Vector3::new(-0.35, -0.28, 1.12),
            Vector3::new(0.02, 0.38, 1.31),
        ]),
        stations_m: vec![Vector3::new(5.2, -2.6, -0.28), Vector3::new(-5.4, 0.4, -0.22)],
        yaws_rad: None,
        control_point_sets: 2,
        pillars: true,
        pauses_s: Vec::new(),
        prism_constant_m: 0.010,
        errors: SystematicErrors::default(),
        drawn_errors: Vec::new(),
    }
}

fn hd2_tunnel() -> Scenario {
    Scenario {
        name: "hd2-tunnel",
        duration_s: 400.0,
        cruise_m_per_s: 0.6,
        path: Path::Tunnel { from_x_m: 14.0, to_x_m: 70.0, amplitude_m: 0.9, wavelength_m: 17.0 },
        ground: Ground {
            height_m: -1.5,
            slope_rms_rad: 0.012,
            wavelengths_m: [4.0, 20.0],
            ..Ground::default()
        },
        noise: Noise { lost_locks_per_minute: 0.25, ..NOISE },
        rate_hz: 2.5,
        stagger_s: None,
        prisms_m: [
            Vector3::new(0.20, 0.00, 0.62),
            Vector3::new(-0.08, 0.17, 0.50),
            Vector3::new(-0.08, -0.17, 0.57),
        ]
        .into(),
        antennas_m: None,
        stations_m: vec![Vector3::new(1.6, 1.3, -0.05), Vector3::new(-0.9, -1.2, 0.04)],
        yaws_rad: None,
        control_point_sets: 0,
        pillars: false,
        pauses_s: Vec::new(),
        prism_constant_m: 0.010,
        errors: SystematicErrors::default(),
        drawn_errors: Vec::new(),
    }
}
