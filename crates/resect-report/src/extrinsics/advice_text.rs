//! Advice for a better extrinsic calibration, and directions in words.

use nalgebra::Vector3;

use resect_tools::extrinsics::AdvisedMotion;

/// Longest drive that is advised, as a multiple of the present one.
const LONGEST_TIMES: f64 = 30.0;
/// Axes are named if the direction is nearer than this cosine.
const ALONG: f64 = 0.95;

/// Returns a direction of body a in words: "z of lidar", or its components.
pub fn direction_in_words(direction: &Vector3<f64>, body: &str) -> String {
    let axis = direction.iamax();
    if direction[axis].abs() > ALONG {
        return format!("{} of {body}", ["x", "y", "z"][axis]);
    }
    let [x, y, z] = [direction.x, direction.y, direction.z];
    format!("the direction ({x:+.2}, {y:+.2}, {z:+.2}) of {body}")
}

/// Returns the advice in one sentence.
pub fn advice_in_words(advised: &AdvisedMotion, body: &str) -> String {
    match advised {
        AdvisedMotion::Turn { direction, now_rad, by_rad, sigma_m, is_main_axis } => {
            let along = direction_in_words(direction, body);
            let how = match is_main_axis {
                true => "Tilt the body, over ramps or by hand",
                false => "Turn more",
            };
            format!(
                "{how}: rotations about axes across {along} were {:.1}° (rms){}",
                now_rad.to_degrees(),
                sigma_m.map_or(String::new(), |sigma_m| format!(
                    "; {:.0}° would determine it to {:.0} mm",
                    by_rad.to_degrees(),
                    (1e3 * sigma_m).max(1.0)
                ))
            )
        }
        AdvisedMotion::Longer { times } if *times > LONGEST_TIMES => {
            "Drive another way, or with smaller errors: more of the same way determines it in no reasonable time".to_owned()
        }
        AdvisedMotion::Longer { times } => {
            format!(
                "Drive {:.0} times as long in the same way, or with smaller errors",
                times.max(2.0)
            )
        }
        AdvisedMotion::ChangeSpeed { now_m_per_s2, sigma_s } => {
            let now = now_m_per_s2.map(|now| format!(": accelerations were {now:.2} m/s² (rms)"));
            format!(
                "Change speed and direction more often, for a time offset better than {:.0} ms{}",
                1e3 * sigma_s,
                now.unwrap_or_default()
            )
        }
        AdvisedMotion::TurnAll { sigma_rad } => format!(
            "Turn about all axes while driving, for a rotation better than {:.2}°",
            sigma_rad.to_degrees()
        ),
    }
}
