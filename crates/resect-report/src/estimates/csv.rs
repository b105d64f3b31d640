//! The errors of a judgement as CSV.

use std::fmt::Write;

use resect_core::estimates::EstimatesJudgement;

/// Formats a line for each epoch of each estimate: the error and σ of the ground truth along each axis, in station 1's frame.
pub fn csv(judgement: &EstimatesJudgement) -> String {
    let mut text =
        "estimate,timestamp_s,true_x_m,true_y_m,true_z_m,error_x_m,error_y_m,error_z_m,error_m,\
                    error_rotation_rad,sigma_x_m,sigma_y_m,sigma_z_m,undecided,contradiction_m\n"
            .to_owned();
    for judged in &judgement.judged {
        let name = format!("\"{}\"", judged.estimate.name.replace('"', "\"\""));
        for error in &judged.errors {
            let (at, off) = (error.true_position_m, error.position_m);
            let sigma_m = error.covariance_m2.diagonal().map(|variance| variance.max(0.0).sqrt());
            let turn =
                error.rotation_rad.map_or(String::new(), |turn| format!("{:.9}", turn.norm()));
            _ = writeln!(
                text,
                "{name},{:.6},{:.6},{:.6},{:.6},{:.6},{:.6},{:.6},{:.6},{turn},{:.6},{:.6},{:.6},{},{:.6}",
                error.time_s,
                at.x,
                at.y,
                at.z,
                off.x,
                off.y,
                off.z,
                off.norm(),
                sigma_m.x,
                sigma_m.y,
                sigma_m.z,
                u8::from(error.is_undecided()),
                error.contradiction_m,
            );
        }
    }
    text
}
