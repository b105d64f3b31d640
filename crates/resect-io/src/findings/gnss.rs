//! Findings about solutions of GNSS receivers that are read as trajectories.

use crate::findings::kinds;
use crate::gnss_solution::SolutionKind;
use nalgebra::Vector3;
use resect_core::deployment::{Finding, Subject, Unit, pairwise_distances};
use resect_core::geometry::Geodetic;

/// The positions are relative to a first position.
pub fn gnss_positions_local(file: &str, origin: &Geodetic) -> Finding {
    let message = format!(
        "{file}: positions are metres east, north and up from latitude {:.8}°, longitude {:.8}°, height {:.3} m, the first that is used",
        origin.latitude_rad.to_degrees(),
        origin.longitude_rad.to_degrees(),
        origin.height_m
    );
    Finding::new(kinds::GNSS_POSITIONS_LOCAL, message)
        .about(Subject::File(file.to_owned()))
        .quantity("latitude", origin.latitude_rad, Unit::Radian)
        .quantity("longitude", origin.longitude_rad, Unit::Radian)
        .quantity("height", origin.height_m, Unit::Metre)
}

/// `left_out` has the numbers of solutions of other kinds than those that are used.
pub fn gnss_solutions_left_out(
    file: &str,
    (used, used_kinds): (usize, &[SolutionKind]),
    left_out: &[(usize, SolutionKind)],
) -> Finding {
    let kinds_used: Vec<&str> = used_kinds.iter().map(|kind| kind.word()).collect();
    let others: Vec<String> =
        left_out.iter().map(|(count, kind)| format!("{count} {}", kind.word())).collect();
    let message = format!(
        "{file}: {used} {} solutions are the ground truth; {} are left out (`--truth-solutions all` uses them too)",
        kinds_used.join(" and "),
        others.join(", ")
    );
    Finding::new(kinds::GNSS_SOLUTIONS_LEFT_OUT, message)
        .about(Subject::File(file.to_owned()))
        .count("used", used)
        .count("left_out", left_out.iter().map(|(count, _)| count).sum())
}

/// All solutions are used, although they are of several kinds.
pub fn gnss_solutions_mixed(file: &str, counts: &[(usize, SolutionKind)]) -> Finding {
    let all: Vec<String> =
        counts.iter().map(|(count, kind)| format!("{count} {}", kind.word())).collect();
    let message = format!("{file}: all solutions are used: {}", all.join(", "));
    Finding::new(kinds::GNSS_SOLUTIONS_MIXED, message)
        .about(Subject::File(file.to_owned()))
        .count("solutions", counts.iter().map(|(count, _)| count).sum())
}

/// `without` of `all` records say that the receiver has no solution.
pub fn gnss_without_solution(file: &str, without: usize, all: usize) -> Finding {
    let message = format!("{file}: {without} of {all} records have no solution and are left out");
    Finding::new(kinds::GNSS_WITHOUT_SOLUTION, message)
        .about(Subject::File(file.to_owned()))
        .count("without_solution", without)
        .count("records", all)
}

/// The best solutions of a ground truth are coarse.
pub fn gnss_not_fixed(file: &str, best: SolutionKind) -> Finding {
    let size = match best {
        SolutionKind::Float => "decimetres",
        _ => "metres",
    };
    let message = format!(
        "{file}: no solution is fixed, the best are {}; the ground truth has errors of {size}",
        best.word()
    );
    Finding::new(kinds::GNSS_NOT_FIXED, message).about(Subject::File(file.to_owned()))
}

/// A log of NMEA has times of day only.
pub fn gnss_dates_missing(file: &str) -> Finding {
    let message = format!(
        "{file}: no sentence has a date (RMC or ZDA), so the times count from midnight UTC of the first day"
    );
    Finding::new(kinds::GNSS_DATES_MISSING, message).about(Subject::File(file.to_owned()))
}

/// `count` covariances are derived from dilution of precision.
pub fn gnss_sigma_approximated(file: &str, count: usize) -> Finding {
    let message = format!(
        "{file}: {count} covariances are approximated from the dilution of precision and not used as σ; state σ with `--truth-sigma`"
    );
    Finding::new(kinds::GNSS_SIGMA_APPROXIMATED, message)
        .about(Subject::File(file.to_owned()))
        .count("covariances", count)
}

/// `column` of a table is not read, for a reason.
pub fn gnss_column_not_read(file: &str, column: &str, reason: &str) -> Finding {
    let message = format!("{file}: column `{column}` is not read: {reason}");
    Finding::new(kinds::GNSS_COLUMN_NOT_READ, message).about(Subject::File(file.to_owned()))
}

/// Poses by antennas with these positions in the body (m), which are measured by the solutions themselves or known.
pub fn antenna_poses(antennas_m: &[Vector3<f64>], are_measured: bool) -> Finding {
    let distances_m: Vec<String> = pairwise_distances(antennas_m)
        .iter()
        .map(|distance_m| format!("{distance_m:.3}"))
        .collect();
    let distances = distances_m.join(", ");
    let source = match are_measured {
        true => "the medians of their positions; x points from antenna 1 to antenna 2",
        false => "the given positions",
    };
    let message = format!(
        "poses by {} antennas, whose distances {distances} m are {source}",
        antennas_m.len()
    );
    let finding = Finding::new(kinds::ANTENNA_POSES, message);
    finding.count("antennas", antennas_m.len())
}

/// Positions without those of the other antennas, and epochs whose distances differ by more than the limit (m).
pub fn antenna_epochs_left_out(unmatched: usize, contradicting: usize, limit_m: f64) -> Finding {
    let message = format!(
        "left out: {unmatched} positions without those of the other antennas, {contradicting} epochs whose distances between antennas are \
         off by more than {limit_m} m"
    );
    Finding::new(kinds::ANTENNA_EPOCHS_LEFT_OUT, message)
        .count("unmatched_positions", unmatched)
        .count("contradicting_epochs", contradicting)
}

/// Positions of antennas state no σ.
pub fn antennas_without_sigma() -> Finding {
    let message = "positions of the antennas state no σ, so the poses have none";
    Finding::new(kinds::ANTENNAS_WITHOUT_SIGMA, message)
}

pub(super) fn examples() -> Vec<Finding> {
    let origin = Geodetic { latitude_rad: 0.816_5, longitude_rad: -1.244, height_m: 95.2 };
    vec![
        gnss_positions_local("rover.pos", &origin),
        gnss_solutions_left_out(
            "rover.pos",
            (812, &[SolutionKind::Fixed]),
            &[(95, SolutionKind::Float), (3, SolutionKind::Single)],
        ),
        gnss_solutions_mixed("rover.pos", &[(812, SolutionKind::Fixed), (95, SolutionKind::Float)]),
        gnss_without_solution("rover.nmea", 12, 900),
        gnss_not_fixed("rover.pos", SolutionKind::Float),
        gnss_dates_missing("rover.nmea"),
        gnss_sigma_approximated("drive.bag", 900),
        gnss_column_not_read(
            "rover.csv",
            "quality",
            "the numbers of qualities differ between receivers; write fixed, float or single",
        ),
        antenna_poses(
            &[Vector3::zeros(), Vector3::new(1.2, 0.0, 0.0), Vector3::new(0.5, 0.9, 0.0)],
            true,
        ),
        antenna_epochs_left_out(31, 2, 0.1),
        antennas_without_sigma(),
    ]
}
