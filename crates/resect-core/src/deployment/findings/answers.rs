//! Findings about answers as a whole: none, not converged, or far from another.

use crate::deployment::kinds;
use crate::deployment::{AngleFormat, Finding, Message, MessageAngle, Remedy, Subject, Unit};

pub fn no_triplets(deployment: &str, why: &str) -> Finding {
    Finding::new(kinds::NO_TRIPLETS, format!("{deployment}: no triplets: {why}"))
        .with(Remedy::RelaxFilters)
}

pub fn too_few_triplets(deployment: &str, found: usize, needed: usize) -> Finding {
    Finding::new(
        kinds::TOO_FEW_TRIPLETS,
        format!(
            "{deployment}: only {found} triplets, {needed} needed for 8 unknowns; record longer, or relax the filters"
        ),
    )
    .count("triplets", found)
    .count("needed", needed)
    .with(Remedy::RelaxFilters)
}

pub fn no_rig(deployment: &str) -> Finding {
    Finding::new(
        kinds::NO_RIG,
        format!(
            "{deployment}: the inter-prism distances are not known; put calibration_results.csv beside the tracks, set \
             inter_prism_m in deployment.toml, or name a file of the rig"
        ),
    )
    .with(Remedy::GiveRig)
}

/// `method` is its name for people, `lack` the missing data.
pub fn method_lacks_data(deployment: &str, method: &str, lack: &str) -> Finding {
    Finding::new(kinds::METHOD_LACKS_DATA, format!("{deployment}: {method} needs {lack}"))
        .about(Subject::Named(method.to_owned()))
}

/// `method` is its name for people.
pub fn points_on_a_line(deployment: &str, method: &str) -> Finding {
    Finding::new(
        kinds::POINTS_ON_A_LINE,
        format!(
            "{deployment}: the points of {method} lie in one place or on a line and do not determine a rigid transform; use a \
             level alignment, or more points"
        ),
    )
    .about(Subject::Named(method.to_owned()))
    .with(Remedy::LevelAlignment)
}

/// `why` is the reason; `published` are the name for people and the short name of the published method, which has an answer.
pub fn no_joint_estimate(why: Finding, published: [&str; 2]) -> Finding {
    let [name, short] = published;
    let message = format!("{why}; {name} has an answer: choose it ({short})");
    let finding = Finding::new(kinds::NO_JOINT_ESTIMATE, message).with(Remedy::PublishedMethod);
    why.remedies.into_iter().fold(finding, Finding::with)
}

/// `joint` is the reason in words why there is no joint estimate, `why` that of the published method.
pub fn neither_method(joint: &str, why: Finding) -> Finding {
    let message = format!("{joint}, and the published method has no answer either: {why}");
    why.remedies.into_iter().fold(Finding::new(why.kind, message), Finding::with)
}

pub fn cancelled() -> Finding {
    Finding::new(kinds::CANCELLED, "cancelled")
}

/// `published` is the name for people of the method that answers instead.
pub fn estimate_not_converged(published: &str) -> Finding {
    Finding::new(
        kinds::ESTIMATE_NOT_CONVERGED,
        format!("The joint estimate did not converge. This is the answer of {published}."),
    )
}

/// `published` is the name for people of the method that answers instead.
pub fn estimate_diverged(published: &str) -> Finding {
    Finding::new(
        kinds::ESTIMATE_DIVERGED,
        format!(
            "The joint estimate diverged: a station moved 30 m or more from where it began. This is the answer of {published}."
        ),
    )
}

/// `published` is the name for people of the method that answers instead.
pub fn no_common_readings(published: &str) -> Finding {
    Finding::new(
        kinds::NO_COMMON_READINGS,
        format!(
            "The joint estimate has no span in which each prism is read at least every 2 s. This is the answer of {published}."
        ),
    )
}

/// `published` is the name for people of the method that answers instead.
pub fn priors_tightened(published: &str) -> Finding {
    Finding::new(
        kinds::PRIORS_TIGHTENED,
        format!(
            "The joint estimate converged only with tighter priors of slow changes, so its σ would be too small. This is the answer of {published}."
        ),
    )
}

pub fn solver_not_converged() -> Finding {
    Finding::new(
        kinds::SOLVER_NOT_CONVERGED,
        "the solver did not converge: it stopped before it reached the minimum",
    )
}

/// `published` is the name for people of the method that answers instead.
pub fn joint_estimate_undetermined(published: &str) -> Finding {
    Finding::new(
        kinds::JOINT_ESTIMATE_UNDETERMINED,
        format!(
            "The readings do not determine all parameters of the joint estimate. This is the answer of {published}."
        ),
    )
}

pub fn other_minimum_fits_better(cost_ratio: f64) -> Finding {
    Finding::new(
        kinds::OTHER_MINIMUM_FITS_BETTER,
        "another minimum fits better than this answer, with all estimated errors corrected; nothing decides between them",
    )
    .quantity("cost_ratio", cost_ratio, Unit::Ratio)
}

pub fn published_answer_far_apart(station: usize, apart_m: f64) -> Finding {
    Finding::new(
        kinds::PUBLISHED_ANSWER_FAR_APART,
        format!(
            "the paper's method puts station {} {:.0} mm away from this answer, with the same readings: instrument errors do not \
             explain that, so find the wrong readings",
            station + 1,
            apart_m * 1e3
        ),
    )
    .about(Subject::Station(station))
    .quantity("apart", apart_m, Unit::Metre)
}

/// `method` is its name for people.
pub fn published_answer_missing(method: &str, why: &Finding) -> Finding {
    Finding::new(
        kinds::PUBLISHED_ANSWER_MISSING,
        format!("no answer of the paper to compare with: {method} has none ({why})"),
    )
    .about(Subject::Named(method.to_owned()))
}

pub fn tracks_not_transformed() -> Finding {
    Finding::new(
        kinds::TRACKS_NOT_TRANSFORMED,
        "this answer refers to the stations' own frames, but the tracks are in another: it does not place the tracks, and \
         the drive does not check it",
    )
}

/// Difference of two methods for a station that exceeds their σ.
pub struct MethodDifference<'a> {
    pub methods: [&'a str; 2],
    /// The station, 0 to 2.
    pub station: usize,
    pub translation_m: [f64; 3],
    pub yaw_rad: f64,
    /// Difference of the yaw in σ; `None` if the methods do not disagree about the yaw.
    pub yaw_sigmas: Option<f64>,
    pub largest_sigmas: f64,
    /// Difference on the station's track (m, rms), and the mean distance to the track (m).
    pub moved_m: f64,
    pub range_m: f64,
}

pub fn methods_disagree(difference: &MethodDifference<'_>) -> Finding {
    let MethodDifference {
        station, translation_m, yaw_rad, largest_sigmas, moved_m, range_m, ..
    } = *difference;
    let [first, second] = difference.methods;
    let number = station + 1;
    let moved = format!("{:.0} mm on its track at {range_m:.0} m on average", moved_m * 1e3);
    let message = match difference.yaw_sigmas {
        Some(sigmas) => Message::from(format!(
            "{first} and {second} disagree about the yaw of station {number}: "
        ))
        .angle(MessageAngle::signed(yaw_rad, AngleFormat::Milliradians, 2))
        .text(format!(" ({sigmas:.0} σ), {moved}")),
        None => {
            let [x, y, z] = translation_m.map(|m| m * 1e3);
            Message::from(format!(
                "{first} and {second} disagree about the position of station {number}: {x:+.1}, {y:+.1}, {z:+.1} mm in x, y, \
                 z (up to {largest_sigmas:.0} σ), {moved}"
            ))
        }
    };
    let [x, y, z] = translation_m;
    Finding::new(kinds::METHODS_DISAGREE, message)
        .about(Subject::OfStation { station, part: format!("{first} and {second}") })
        .quantity("x", x, Unit::Metre)
        .quantity("y", y, Unit::Metre)
        .quantity("z", z, Unit::Metre)
        .quantity("yaw", yaw_rad, Unit::Radian)
        .quantity("largest_sigmas", largest_sigmas, Unit::Ratio)
        .quantity("apart_on_track", moved_m, Unit::Metre)
}

pub(super) fn examples() -> Vec<Finding> {
    let difference = MethodDifference {
        methods: ["B", "D"],
        station: 1,
        translation_m: [0.01, 0.02, 0.0],
        yaw_rad: 8.7e-4,
        yaw_sigmas: Some(7.0),
        largest_sigmas: 7.0,
        moved_m: 0.03,
        range_m: 40.0,
    };
    let of_position = MethodDifference { yaw_sigmas: None, ..difference };
    vec![
        no_triplets("drive", "the filters left none"),
        too_few_triplets("drive", 4, 10),
        no_rig("drive"),
        method_lacks_data("drive", "method B", "control points"),
        points_on_a_line("drive", "method B"),
        no_joint_estimate(too_few_triplets("drive", 4, 10), ["method D", "inter-prism"]),
        cancelled(),
        estimate_not_converged("method D"),
        estimate_diverged("method D"),
        no_common_readings("method D"),
        priors_tightened("method D"),
        solver_not_converged(),
        joint_estimate_undetermined("method C"),
        other_minimum_fits_better(0.8),
        published_answer_far_apart(2, 0.4),
        published_answer_missing("method D", &too_few_triplets("drive", 4, 10)),
        tracks_not_transformed(),
        methods_disagree(&difference),
        methods_disagree(&of_position),
    ]
}
