//! Findings about the rig: distances and positions of the prisms.

use crate::findings::kinds;
use resect_core::deployment::{Finding, Remedy, Subject, Unit};

pub fn rig_file_preferred() -> Finding {
    Finding::new(
        kinds::RIG_FILE_PREFERRED,
        "the given rig is used, not inter_prism_m of deployment.toml",
    )
}

pub fn rig_unknown() -> Finding {
    Finding::new(
        kinds::RIG_UNKNOWN,
        "the inter-prism distances are unknown, and method D needs them; put calibration_results.csv beside the \
         tracks, set inter_prism_m in deployment.toml, or give a file of the rig",
    )
    .with(Remedy::GiveRig)
}

pub fn rig_derived_from_reading(file: &str) -> Finding {
    Finding::new(
        kinds::RIG_DERIVED_FROM_READING,
        format!(
            "the inter-prism distances are derived from {file}, with one reading of each prism: an error of a reading \
             is an error of the answer. Give the distances in calibration_results.csv, or as inter_prism_m in \
             deployment.toml"
        ),
    )
    .about(Subject::File(file.to_owned()))
}

/// `largest_m` is the largest difference (m).
pub fn rig_reading_disagrees(file: &str, largest_m: f64) -> Finding {
    Finding::new(
        kinds::RIG_READING_DISAGREES,
        format!(
            "the inter-prism distances and the reading of the rig ({file}) differ by {:.1} mm; one of them is wrong",
            largest_m * 1e3
        ),
    )
    .about(Subject::File(file.to_owned()))
    .quantity("difference", largest_m, Unit::Metre)
}

pub fn prism_positions_of_other_rig(largest_m: f64) -> Finding {
    Finding::new(
        kinds::PRISM_POSITIONS_OF_OTHER_RIG,
        "prisms_m of deployment.toml is ignored: it belongs to another rig than the given one",
    )
    .quantity("difference", largest_m, Unit::Metre)
}

pub fn prism_positions_disagree(largest_m: f64) -> Finding {
    Finding::new(
        kinds::PRISM_POSITIONS_DISAGREE,
        format!("prisms_m and the inter-prism distances differ by {:.1} mm", largest_m * 1e3),
    )
    .quantity("difference", largest_m, Unit::Metre)
}

pub(super) fn examples() -> Vec<Finding> {
    vec![
        rig_file_preferred(),
        rig_unknown(),
        rig_derived_from_reading("rig.gsi"),
        rig_reading_disagrees("rig.gsi", 0.004),
        prism_positions_of_other_rig(0.2),
        prism_positions_disagree(0.004),
    ]
}
