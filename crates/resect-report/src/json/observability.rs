//! Observability of the drive, as JSON.

use serde_json::{Value, json};

use resect_core::calibration::inter_prism::drive_shape::{DriveShape, PlanView};
use resect_core::calibration::inter_prism::observability::{
    Direction, Observability, StationMotion,
};
use resect_core::network::Station;

/// Returns the observability. `relative_eigenvalue` is that of the scaled JᵀJ over the largest. `motion` is that of
/// each station for one metre along the direction (station 1's frame).
pub fn observability(observed: &Observability) -> Value {
    json!({
        "drive": drive(&observed.drive),
        "directions": observed.directions.iter().map(direction).collect::<Vec<_>>(),
        "advice": observed.advice,
    })
}

fn direction(direction: &Direction) -> Value {
    let motion = |(station, motion): (Station, &StationMotion)| {
        json!({
            "station": station.number(),
            "translation_m": motion.translation_m.as_slice(),
            "yaw_rad": motion.yaw_rad,
        })
    };
    json!({
        "words": direction.words,
        "hold": direction.hold.name(),
        "relative_eigenvalue": direction.relative,
        "sigma_m": direction.sigma_m,
        "motion": direction.motion.each().skip(1).map(motion).collect::<Vec<_>>(),
    })
}

fn drive(shape: &DriveShape) -> Value {
    let mut value = json!({
        "shape": shape.name(),
        "flat": shape.is_flat(),
        "height_range_m": shape.relief_m,
        "tilt_rad": shape.tilt_rad,
    });
    let plan = match shape.plan {
        PlanView::Standing | PlanView::Winding => json!({}),
        PlanView::StraightLine { length_m, bends_m } => {
            json!({ "length_m": length_m, "bends_m": bends_m })
        }
        PlanView::Circle { centre_m, radius_m, driven_rad } => {
            json!({ "centre_m": centre_m.as_slice(), "radius_m": radius_m, "driven_rad": driven_rad })
        }
        PlanView::TwoLegs { corner_m, turn_rad } => {
            json!({ "corner_m": corner_m.as_slice(), "turn_rad": turn_rad })
        }
    };
    if let (Some(value), Value::Object(plan)) = (value.as_object_mut(), plan) {
        value.extend(plan);
    }
    value
}
