//! Findings about the shape of a drive, and the directions that it determines.

use crate::deployment::kinds;
use crate::deployment::{
    AngleFormat, Finding, FindingKind, Message, MessageAngle, Remedy, Severity, Unit,
};

/// Numbers of directions, of 8, that a drive leaves open.
#[derive(Clone, Copy)]
pub enum OpenDirections {
    /// Unobservable ones, and weak ones.
    Open { free: usize, weak: usize },
    /// Open ones that control points determine.
    HeldByControlPoints(usize),
}

impl OpenDirections {
    /// A finding about the shape of the drive, with the severity of its consequence.
    fn finding(self, kind: FindingKind, shape: impl Into<Message>) -> Finding {
        let of_all = |count, how| match count {
            1 => format!("1 of 8 directions is {how}"),
            _ => format!("{count} of 8 directions are {how}"),
        };
        let (free, weak) = match self {
            Self::Open { free, weak } => (free, weak),
            Self::HeldByControlPoints(weak) => (0, weak),
        };
        let (severity, consequence) = match (self, free, weak) {
            (_, 0, 0) => (Severity::Note, "all 8 directions are observable".to_owned()),
            (Self::HeldByControlPoints(_), _, count) => (
                Severity::Warning,
                format!(
                    "control points alone determine {count} of 8 directions: a station that moved along them since does not show"
                ),
            ),
            (_, 0, weak) => (Severity::Warning, of_all(weak, "weakly observable")),
            (_, free, _) => (Severity::Problem, of_all(free, "unobservable")),
        };
        Finding::new(kind, shape.into().text(format!("; {consequence}")))
            .with_severity(severity)
            .count("free_directions", free)
            .count("weak_directions", weak)
    }
}

pub fn drive_standing(open: OpenDirections) -> Finding {
    open.finding(kinds::DRIVE_STANDING, "the vehicle hardly moved")
}

pub fn drive_straight_line(open: OpenDirections, length_m: f64, bends_m: f64) -> Finding {
    let shape = format!(
        "the drive is one straight line ({length_m:.0} m, bends under {:.1} m): the rig never turns",
        (bends_m * 10.0).ceil().max(1.0) / 10.0
    );
    open.finding(kinds::DRIVE_STRAIGHT_LINE, shape)
        .quantity("length", length_m, Unit::Metre)
        .quantity("bends", bends_m, Unit::Metre)
}

/// `driven_rad` is the angle driven on the circle.
pub fn drive_circle(open: OpenDirections, radius_m: f64, driven_rad: f64) -> Finding {
    let shape = if driven_rad > std::f64::consts::TAU {
        format!("the drive goes round one circle, one way (radius {radius_m:.1} m)").into()
    } else {
        Message::from("the drive is an arc of one circle (")
            .angle(MessageAngle::size(driven_rad, AngleFormat::Degrees, 0))
            .text(format!(" of radius {radius_m:.1} m)"))
    };
    open.finding(kinds::DRIVE_CIRCLE, shape).quantity("radius", radius_m, Unit::Metre).quantity(
        "driven",
        driven_rad,
        Unit::Radian,
    )
}

/// `rival_cost_ratio` is the cost of another solution over that of the answer.
pub fn drive_two_legs(
    open: OpenDirections,
    corner_m: [f64; 2],
    turn_rad: f64,
    rival_cost_ratio: Option<f64>,
) -> Finding {
    let rival = rival_cost_ratio.map_or_else(String::new, |cost_ratio| {
        format!(
            ", and another solution with the rig turned has only {cost_ratio:.1} times the cost"
        )
    });
    let dependence = match open {
        OpenDirections::Open { .. } => format!(": the answer depends on that corner alone{rival}"),
        OpenDirections::HeldByControlPoints(_) => String::new(),
    };
    let [x, y] = corner_m;
    let shape = Message::from("the drive is an L, two straight legs with one corner of ")
        .angle(MessageAngle::size(turn_rad, AngleFormat::Degrees, 0))
        .text(format!(" at ({x:.1}, {y:.1}) m{dependence}"));
    let finding =
        open.finding(kinds::DRIVE_TWO_LEGS, shape).quantity("turn", turn_rad, Unit::Radian);
    match rival_cost_ratio {
        Some(ratio) => finding.quantity("rival_cost_ratio", ratio, Unit::Ratio),
        None => finding,
    }
}

/// `free` names the directions, `advice` the next drive.
pub fn drive_leaves_direction_free(free: &str, advice: &str) -> Finding {
    Finding::new(
        kinds::DRIVE_LEAVES_DIRECTION_FREE,
        format!("the drive leaves a direction unobservable: {free}; next, {advice}"),
    )
}

/// `noise` is the share of the information on the heights that is noise.
pub fn heights_undetermined(noise: f64) -> Finding {
    Finding::new(
        kinds::DRIVE_LEAVES_DIRECTION_FREE,
        format!(
            "the drive does not determine the heights of the stations: {:.0} % of what it says of them is noise of the vehicle's \
             tilts; measure the distances of the prisms or control points, or drive over ramps",
            noise * 100.0
        ),
    )
    .with(Remedy::GiveRig)
    .with(Remedy::GiveControlPoints)
    .quantity("noise", noise, Unit::Ratio)
}

pub fn stations_far_from_track(largest_sigma_m: f64) -> Finding {
    Finding::new(
        kinds::STATIONS_FAR_FROM_TRACK,
        format!(
            "weakly observable: the stations stand far from the track, where an error of yaw grows (σ up to {:.0} mm); drive \
             nearer to them or over a larger area, if the place allows",
            largest_sigma_m * 1e3
        ),
    )
    .quantity("largest_sigma", largest_sigma_m, Unit::Metre)
}

/// `direction` is the weakest one in words, `advice` the next drive.
pub fn drive_weak(direction: &str, largest_sigma_m: f64, advice: &str) -> Finding {
    Finding::new(
        kinds::DRIVE_WEAK,
        format!(
            "weakly observable: {direction} (σ up to {:.0} mm); next, {advice}",
            largest_sigma_m * 1e3
        ),
    )
    .quantity("largest_sigma", largest_sigma_m, Unit::Metre)
}

pub fn weakest_direction(direction: &str, sigma_m: f64) -> Finding {
    Finding::new(
        kinds::WEAKEST_DIRECTION,
        format!("least certain at the track: {direction} (σ {:.1} mm)", sigma_m * 1e3),
    )
    .quantity("sigma", sigma_m, Unit::Metre)
}

/// Ground on which only the rig or control points resolve the mirror twin.
#[derive(Clone, Copy)]
pub enum Flat {
    /// The heights of the track vary by this (m).
    Floor { relief_m: f64 },
    /// The rig tilts by this at most (rad).
    Tilt { tilt_rad: f64 },
}

/// A warning if nothing resolves the twin, else a note.
pub fn flat_ground(flat: Flat, is_resolved: bool) -> Finding {
    let (ground, name, value, unit) = match flat {
        Flat::Floor { relief_m } => {
            let ground = format!("the floor is flat (heights vary by {:.0} mm)", relief_m * 1e3);
            (Message::from(ground), "relief", relief_m, Unit::Metre)
        }
        Flat::Tilt { tilt_rad } => {
            let ground = Message::from("the rig hardly pitches or rolls (")
                .angle(MessageAngle::size(tilt_rad, AngleFormat::Degrees, 2))
                .text(" at most)");
            (ground, "tilt", tilt_rad, Unit::Radian)
        }
    };
    let message =
        ground.text(": only the rig or control points resolve the mirror ambiguity of the heights");
    let severity = if is_resolved { Severity::Note } else { Severity::Warning };
    Finding::new(kinds::FLAT_GROUND, message).with_severity(severity).quantity(name, value, unit)
}

pub fn rival_minimum(apart_m: f64, cost_ratio: f64) -> Finding {
    Finding::new(
        kinds::RIVAL_MINIMUM,
        format!(
            "another solution {apart_m:.2} m away has only {cost_ratio:.2} times the cost; turn to both sides while driving"
        ),
    )
    .quantity("apart", apart_m, Unit::Metre)
    .quantity("cost_ratio", cost_ratio, Unit::Ratio)
}

/// `median_m` is the median error of the inter-prism distances.
pub fn distances_fit_poorly(median_m: f64) -> Finding {
    Finding::new(
        kinds::DISTANCES_FIT_POORLY,
        format!(
            "the distances fit poorly (median {:.1} mm): check the order of the prisms, the distances, the clocks and the \
             filters",
            median_m * 1e3
        ),
    )
    .quantity("median", median_m, Unit::Metre)
    .with(Remedy::Corrections)
}

pub(super) fn examples() -> Vec<Finding> {
    let open = OpenDirections::Open { free: 1, weak: 2 };
    vec![
        drive_standing(open),
        drive_straight_line(open, 42.0, 0.23),
        drive_circle(OpenDirections::Open { free: 0, weak: 1 }, 8.0, 7.0),
        drive_circle(open, 8.0, 2.0),
        drive_straight_line(OpenDirections::HeldByControlPoints(3), 42.0, 0.23),
        drive_two_legs(OpenDirections::Open { free: 0, weak: 0 }, [4.0, 5.0], 1.57, Some(3.0)),
        drive_leaves_direction_free("station 2 can slide along x", "drive a figure-eight"),
        heights_undetermined(0.84),
        stations_far_from_track(0.04),
        drive_weak("station 2 can slide along x", 0.03, "drive a figure-eight"),
        weakest_direction("station 2 along x", 0.002),
        flat_ground(Flat::Floor { relief_m: 0.02 }, true),
        flat_ground(Flat::Tilt { tilt_rad: 0.005 }, false),
        rival_minimum(0.7, 1.3),
        distances_fit_poorly(0.009),
    ]
}
