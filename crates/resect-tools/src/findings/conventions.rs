//! Findings about the conventions of a trajectory's file. The flags are those of `resect evaluate`.

use crate::findings::kinds;
use resect_core::calibration::Estimate;
use resect_core::deployment::{Finding, FindingKind, Subject, Unit};

fn finding(kind: FindingKind, estimate: &str, message: &str) -> Finding {
    Finding::new(kind, format!("{estimate}: {message}")).about(Subject::Named(estimate.to_owned()))
}

/// `flag` sets the convention, described by `words`; `alternatives` fit as well. The numbers are the scatter of the subject as read and
/// with the convention (rad or m).
pub fn estimate_orientation_convention(
    estimate: &str,
    [words, flag]: [&str; 2],
    alternatives: &[String],
    [as_read, with_convention]: [f64; 2],
    (subject, unit): (&str, Unit),
) -> Finding {
    let number = |number: f64| match unit {
        Unit::Radian => format!("{:.1}°", number.to_degrees()),
        _ => format!("{:.1} mm", 1e3 * number),
    };
    let mut message = format!(
        "{words}, {subject} by {} instead of {} ({flag})",
        number(with_convention),
        number(as_read)
    );
    if !alternatives.is_empty() {
        message += &format!("; {} fits as well on this drive", alternatives.join(" or "));
    }
    finding(kinds::ESTIMATE_ORIENTATION_CONVENTION, estimate, &message)
        .quantity("as_read", as_read, unit)
        .quantity("with_convention", with_convention, unit)
}

/// `owner` has the unit; `flag` sets it.
pub fn estimate_unit(
    estimate: &str,
    times_longer: f64,
    [owner, unit]: [&str; 2],
    flag: &str,
) -> Finding {
    let message = format!(
        "its distances are {} times those of the ground truth, so {owner} seems to be in {unit} ({flag})",
        significant(times_longer)
    );
    finding(kinds::ESTIMATE_UNIT, estimate, &message).quantity(
        "times_longer",
        times_longer,
        Unit::Ratio,
    )
}

fn significant(ratio: f64) -> String {
    let places = (3 - ratio.abs().log10().floor() as i32).clamp(0, 9) as usize;
    format!("{ratio:.places$}")
}

/// `longer` is the ratio of lengths to those of the ground truth, minus one.
pub fn estimate_scale_differs(estimate: &str, longer: &Estimate, convention: &str) -> Finding {
    let size = 100.0 * longer.value.abs();
    let places = (1 - (100.0 * longer.sigma).log10().floor() as i32).clamp(0, 4) as usize;
    let word = if longer.value > 0.0 { "longer" } else { "shorter" };
    let grid = if longer.value.abs() < LARGEST_OF_GRID {
        "; coordinates of a map grid (UTM: 0.9996 to 1.0010) would explain that"
    } else {
        ""
    };
    let message = format!(
        "its distances are {size:.places$} ± {:.places$} % {word} than those of the ground truth all over the drive \
         (--convention {convention}, or --align similarity){grid}",
        100.0 * longer.sigma
    );
    finding(kinds::ESTIMATE_SCALE_DIFFERS, estimate, &message).estimate(
        "longer",
        longer,
        Unit::Ratio,
    )
}

/// Largest scale of a map grid, with a height of 1000 m above the ellipsoid. Source: UTM is 0.9996 at its central meridian and 1.0010 at the
/// edge of a zone.
const LARGEST_OF_GRID: f64 = 1.2e-3;

/// `factor` is the true time per time of the estimate, which `convention` sets; the misfits are errors relative to the size of the drive.
pub fn estimate_clock_rate(
    estimate: &str,
    factor: f64,
    convention: &str,
    [as_read, with_factor]: [Option<f64>; 2],
) -> Finding {
    let percent = |misfit: Option<f64>| match misfit {
        Some(misfit) => format!("{:.1} %", 100.0 * misfit),
        None => "no overlap".to_owned(),
    };
    let fast = significant(factor.recip());
    let clock = format!("its clock runs {fast} times as fast as that of the ground truth");
    let message = format!(
        "{clock}: at the other rate the positions fit to {} of the size of the drive instead of {} (--convention {convention})",
        percent(with_factor),
        percent(as_read)
    );
    finding(kinds::ESTIMATE_CLOCK_RATE, estimate, &message).quantity("factor", factor, Unit::Ratio)
}

/// `different` of `poses` poses are different in their `parts`, which are held for a time (s); `flag` leaves out the repeats.
pub fn estimate_poses_held(
    estimate: &str,
    parts: &str,
    [different, poses]: [usize; 2],
    (held_s, flag): (f64, &str),
) -> Finding {
    let message = format!(
        "{poses} stamps have {different} different {parts}, each held for {held_s:.2} s: the repeats are late by up to that \
         ({flag} leaves them out)"
    );
    finding(kinds::ESTIMATE_POSES_HELD, estimate, &message)
        .count("poses", poses)
        .count("different", different)
        .quantity("held", held_s, Unit::Second)
}

/// `interpolated` of `poses` poses lie on lines between others.
pub fn estimate_poses_interpolated(
    estimate: &str,
    [interpolated, poses]: [usize; 2],
    interval_s: f64,
) -> Finding {
    let message = format!(
        "{interpolated} of {poses} poses are interpolated on straight lines, over {interval_s:.2} s each; errors between are those \
         of the interpolation"
    );
    finding(kinds::ESTIMATE_POSES_INTERPOLATED, estimate, &message)
        .count("poses", poses)
        .count("interpolated", interpolated)
        .quantity("interval", interval_s, Unit::Second)
}

/// `flag` leaves out the poses.
pub fn estimate_poses_unset(
    estimate: &str,
    (count, at_start): (usize, bool),
    jump_m: f64,
    flag: &str,
) -> Finding {
    let position = if at_start { " before the start" } else { "" };
    let message = format!(
        "{count} poses{position} are zeros, {jump_m:.1} m from the next pose: they were never set \
         ({flag} leaves them out)"
    );
    finding(kinds::ESTIMATE_POSES_UNSET, estimate, &message).count("poses", count).quantity(
        "jump",
        jump_m,
        Unit::Metre,
    )
}

/// The largest of the outliers is so far from the pose before (m), at a time (s).
pub fn estimate_outliers(estimate: &str, count: usize, (largest_m, time_s): (f64, f64)) -> Finding {
    let poses = if count == 1 { "1 pose is" } else { &format!("{count} poses are") };
    let message = format!(
        "{poses} up to {} from the poses before and after, the farthest at stamp {time_s:.3}: delete rows that are no positions",
        length(largest_m)
    );
    finding(kinds::ESTIMATE_JUMPS, estimate, &message)
        .count("outliers", count)
        .quantity("largest", largest_m, Unit::Metre)
        .quantity("time", time_s, Unit::Second)
}

/// The largest of the jumps (m) is at a time (s).
pub fn estimate_jumps(estimate: &str, count: usize, (largest_m, time_s): (f64, f64)) -> Finding {
    let times = if count == 1 { "once".to_owned() } else { format!("{count} times") };
    let message = format!(
        "it jumps {times} and continues elsewhere, at most by {} at stamp {time_s:.3}: if its map began anew there, evaluate the parts \
         as files of their own",
        length(largest_m)
    );
    finding(kinds::ESTIMATE_JUMPS, estimate, &message)
        .count("jumps", count)
        .quantity("largest", largest_m, Unit::Metre)
        .quantity("time", time_s, Unit::Second)
}

/// Usual interval between poses, and that within bursts (s).
pub fn estimate_bursts(estimate: &str, [usual_s, within_s]: [f64; 2]) -> Finding {
    let message = format!(
        "its poses come in bursts: many follow after {within_s:.3} s instead of {usual_s:.3} s, so the stamps seem to be those of arrival"
    );
    finding(kinds::ESTIMATE_STAMPS_JITTER, estimate, &message)
        .quantity("interval", usual_s, Unit::Second)
        .quantity("within", within_s, Unit::Second)
}

/// A length to a decimetre, or in kilometres.
fn length(length_m: f64) -> String {
    if length_m < 1000.0 {
        format!("{length_m:.1} m")
    } else {
        format!("{:.1} km", 1e-3 * length_m)
    }
}

pub fn estimate_planar(estimate: &str) -> Finding {
    let message = "all its heights are equal, so it is an estimate in a plane: errors of heights are heights of the ground truth \
                   (--plane xy compares in the plane)";
    finding(kinds::ESTIMATE_PLANAR, estimate, message)
}

pub fn estimate_motions(estimate: &str) -> Finding {
    let message = "its poses are motions since the pose before: one after the other they have the shape of the ground truth; write \
                   all poses in one frame";
    finding(kinds::ESTIMATE_UNIT, estimate, message)
}

/// `names` are those of x and y.
pub fn estimate_geographic(estimate: &str, [x, y]: [&str; 2]) -> Finding {
    let message = format!(
        "its x and y are degrees of {x} and {y}: in metres they have the shape of the ground truth; name the columns \
         timestamp, {x}, {y}, altitude"
    );
    finding(kinds::ESTIMATE_UNIT, estimate, &message)
}

/// `words` state what is wrong with the degrees in a file, and the remedy.
pub fn estimate_degrees(estimate: &str, file: &str, [what, remedy]: [&str; 2]) -> Finding {
    let message =
        format!("in {file}, {what}: so the two trajectories have the same shape; {remedy}");
    finding(kinds::ESTIMATE_UNIT, estimate, &message)
}

/// `words` state the error, and `convention` corrects it; the numbers are root mean square errors of positions as read and with it (m).
/// `of_truth` corrects a ground truth that is mirrored instead.
pub fn estimate_mirrored(
    estimate: &str,
    [words, convention]: [&str; 2],
    [as_read_m, with_convention_m]: [f64; 2],
    of_truth: Option<&str>,
) -> Finding {
    let or_truth = of_truth.map_or_else(String::new, |convention| {
        format!("; if the ground truth is mirrored, --truth-convention {convention}")
    });
    let message = format!(
        "its positions are mirrored, as if {words}: corrected they differ from the ground truth by {:.1} mm instead of {:.1} mm \
         (--convention {convention}{or_truth})",
        1e3 * with_convention_m,
        1e3 * as_read_m
    );
    finding(kinds::ESTIMATE_MIRRORED, estimate, &message)
        .quantity("as_read", as_read_m, Unit::Metre)
        .quantity("with_convention", with_convention_m, Unit::Metre)
}

/// Time by which orientations follow the positions of the same poses (s); negative if they precede.
pub fn estimate_orientations_late(estimate: &str, delay_s: &Estimate) -> Finding {
    let word = if delay_s.value > 0.0 { "later" } else { "earlier" };
    let message = format!(
        "its orientations are {:.0} ± {:.0} ms {word} than its positions: angles of errors contain the rotation within that time",
        1e3 * delay_s.value.abs(),
        (1e3 * delay_s.sigma).ceil()
    );
    finding(kinds::ESTIMATE_ORIENTATIONS_LATE, estimate, &message).estimate(
        "delay",
        delay_s,
        Unit::Second,
    )
}

/// Distances are medians from the motion of the other body, and of the same body (m).
pub fn estimate_bodies_mixed(
    estimate: &str,
    poses: [usize; 2],
    [between_m, within_m]: [f64; 2],
) -> Finding {
    let [first, second] = poses;
    let message = format!(
        "its poses seem to be those of two bodies ({first} and {second}): they are {between_m:.3} m from the motion of the other \
         and {within_m:.3} m from that of their own; write one file for each body"
    );
    finding(kinds::ESTIMATE_BODIES_MIXED, estimate, &message)
        .count("of_first", first)
        .count("of_second", second)
        .quantity("between", between_m, Unit::Metre)
        .quantity("within", within_m, Unit::Metre)
}

/// `original` has the same poses but for `apart_m`, where their errors are `error_m`.
pub fn estimate_copy(estimate: &str, original: &str, [apart_m, error_m]: [f64; 2]) -> Finding {
    let message = format!(
        "it has the poses of {original}: they differ by {:.1} mm from each other and by {:.1} mm from the ground truth; both count as \
         one estimate",
        1e3 * apart_m,
        1e3 * error_m
    );
    finding(kinds::ESTIMATE_COPY, estimate, &message)
        .quantity("apart", apart_m, Unit::Metre)
        .quantity("error", error_m, Unit::Metre)
}

pub fn estimate_exchanged(estimate: &str, truth: &str) -> Finding {
    let message = format!(
        "its name is that of a ground truth, and {truth} has the name of an estimate: if they are exchanged, give {truth} as the \
         estimate and {estimate} after --against"
    );
    finding(kinds::ESTIMATE_EXCHANGED, estimate, &message)
}

pub(super) fn examples() -> Vec<Finding> {
    vec![
        estimate_orientation_convention(
            "slam",
            ["read as w x y z", "--convention wxyz"],
            &[],
            [1.62, 0.01],
            ("the orientations scatter", Unit::Radian),
        ),
        estimate_unit("slam", 100.02, ["it", "centimetres"], "--convention cm"),
        estimate_scale_differs("slam", &Estimate { value: 0.05, sigma: 0.001 }, "length=0.9524"),
        estimate_clock_rate("slam", 0.5, "time=0.5", [Some(0.4), Some(0.002)]),
        estimate_poses_held("slam", "poses", [710, 7088], (0.5, "--convention held")),
        estimate_poses_interpolated("slam", [6378, 7088], 0.5),
        estimate_poses_unset("slam", (12, true), 14.3, "--convention unset"),
        estimate_outliers("slam", 42, (17_320.5, 1_760_000_012.3)),
        estimate_jumps("slam", 1, (57.2, 1_760_000_209.6)),
        estimate_bursts("slam", [0.1, 0.002]),
        estimate_planar("slam"),
        estimate_motions("slam"),
        estimate_geographic("slam", ["latitude", "longitude"]),
        estimate_degrees(
            "slam",
            "rtk",
            ["latitude and longitude are exchanged", "exchange their names in the header"],
        ),
        estimate_mirrored(
            "slam",
            ["all axes are left-handed", "left-handed"],
            [0.329, 0.026],
            None,
        ),
        estimate_orientations_late("slam", &Estimate { value: 0.2, sigma: 0.004 }),
        estimate_bodies_mixed("slam", [3551, 3550], [0.52, 0.09]),
        estimate_copy("copy", "slam", [0.0001, 0.3855]),
        estimate_exchanged("ground_truth", "slam"),
    ]
}
