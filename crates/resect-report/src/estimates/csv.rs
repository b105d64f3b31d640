//! The errors of a judgement as CSV.

use std::fmt::Write;

use resect_tools::estimates::EstimatesJudgement;

/// Formats a line for each epoch of each estimate: the error and σ of the ground truth along each axis, in the ground truth's
/// frame.
pub fn csv(judgement: &EstimatesJudgement) -> String {
    let mut text =
        "estimate,timestamp_s,true_x_m,true_y_m,true_z_m,error_x_m,error_y_m,error_z_m,error_m,\
                    error_rotation_rad,sigma_x_m,sigma_y_m,sigma_z_m,undecided,contradiction_m\n"
            .to_owned();
    for judged in &judgement.judged {
        let name = format!("\"{}\"", judged.estimate.name.replace('"', "\"\""));
        for error in &judged.errors {
            let (at, off) = (error.true_position_m, error.position_m);
            // Without a stated uncertainty, the fields are empty.
            let sigma_m = match error.covariance_m2 {
                Some(covariance) => {
                    let sigma_m = covariance.diagonal().map(|variance| variance.max(0.0).sqrt());
                    format!("{:.6},{:.6},{:.6}", sigma_m.x, sigma_m.y, sigma_m.z)
                }
                None => ",,".to_owned(),
            };
            let undecided =
                error.is_undecided().map_or("", |undecided| if undecided { "1" } else { "0" });
            let contradiction =
                error.contradiction_m.map_or(String::new(), |error_m| format!("{error_m:.6}"));
            let turn =
                error.rotation_rad.map_or(String::new(), |turn| format!("{:.9}", turn.norm()));
            _ = writeln!(
                text,
                "{name},{:.6},{:.6},{:.6},{:.6},{:.6},{:.6},{:.6},{:.6},{turn},{sigma_m},{undecided},{contradiction}",
                error.time_s,
                at.x,
                at.y,
                at.z,
                off.x,
                off.y,
                off.z,
                off.norm(),
            );
        }
    }
    text
}
