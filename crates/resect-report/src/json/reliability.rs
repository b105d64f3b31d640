//! Reliability of the groups of readings, as JSON.

use serde_json::{Value, json};

use resect_core::calibration::Quantity;
use resect_core::calibration::joint::JointEstimate;
use resect_core::calibration::joint::reliability::{
    DetectableBias, GroupReliability, NormalisedResidual, PoseEffect,
};
use resect_core::calibration::joint::survey::SurveyReading;
use resect_core::deployment::{ControlPointSet, Deployment};
use resect_core::network::Number;

/// Axes of a reading of a control point.
const AXES: [&str; 3] = ["along", "right", "up"];

/// Returns an object for each group of readings. Groups of control points list their readings.
pub fn reliability(deployment: &Deployment, joint: &JointEstimate) -> Vec<Value> {
    let sets = deployment.comparable_control_points();
    let readings = joint.control_points().map_or(&[][..], |survey| &survey.readings[..]);
    joint.reliability.iter().map(|group| of_group(group, sets, readings)).collect()
}

fn of_group(
    group: &GroupReliability,
    sets: &[ControlPointSet],
    readings: &[SurveyReading],
) -> Value {
    let mut value = json!({
        "group": group.code(),
        "redundancy": group.redundancy,
        "effect": group.bias.as_ref().map(effect),
    });
    // In the unit of the readings; angles to control points in m across the sight.
    let size = match group.kind.quantity() {
        Quantity::Length => "minimal_detectable_bias_m",
        Quantity::Angle => "minimal_detectable_bias_rad",
        _ => "minimal_detectable_bias",
    };
    value[size] = json!(group.bias.as_ref().map(|bias| bias.size));
    match group.residual {
        Some(NormalisedResidual::RootMeanSquare(sigmas)) => {
            value["normalised_residual_rms"] = json!(sigmas);
        }
        Some(NormalisedResidual::Single(sigmas)) => value["normalised_residual"] = json!(sigmas),
        Some(NormalisedResidual::Largest { sigmas, set, point }) => {
            let mut largest = place(sets, set, point);
            largest["value"] = json!(sigmas);
            value["largest_normalised_residual"] = largest;
        }
        None => {}
    }
    if !group.kind.axes().is_empty() {
        let own = readings.iter().filter(|reading| reading.station.index() == group.index);
        let numbers = own.flat_map(|reading| group.kind.axes().map(move |axis| (reading, axis)));
        let numbers = numbers.map(|(reading, axis)| number(reading, axis, sets));
        value["readings"] = numbers.collect();
    }
    value
}

/// Returns the range or an angle of a reading; angles in m across the sight.
fn number(reading: &SurveyReading, axis: usize, sets: &[ControlPointSet]) -> Value {
    let mut value = place(sets, reading.set, reading.point);
    value["axis"] = json!(AXES[axis]);
    value["residual_m"] = json!(reading.residual_m[axis]);
    value["sigma_m"] = json!(reading.sigma_m[axis]);
    value["weight"] = json!(reading.weight);
    value["redundancy"] = json!(reading.redundancy[axis]);
    value["normalised_residual"] = json!(reading.normalised_residual(axis));
    value["minimal_detectable_bias_m"] = json!(reading.detectable_bias_m(axis));
    value
}

/// Returns file and marker of a control point.
fn place(sets: &[ControlPointSet], set: usize, point: usize) -> Value {
    let set = sets.get(set);
    let point = set.and_then(|set| set.points.get(point));
    json!({ "file": set.map(|set| &set.file), "marker": point.map(|point| point.marker) })
}

/// Returns the changes of the poses of stations 2, 3, … by an undetected bias.
fn effect(bias: &DetectableBias) -> Value {
    let of_station = |(slot, effect): (usize, &PoseEffect)| {
        json!({
            "station": slot + 2,
            "position_m": effect.position_m,
            "yaw_rad": effect.yaw_rad,
        })
    };
    bias.effect.iter().enumerate().map(of_station).collect()
}
