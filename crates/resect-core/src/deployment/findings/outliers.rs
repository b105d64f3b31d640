//! Findings about outlying triplets, and about the search of the prior.

use crate::deployment::{Finding, FindingKind, Remedy, Unit};

/// `count` of `all` triplets were left out; `is_many` where the rest may be wrong too.
pub fn outliers_left_out(count: usize, all: usize, is_many: bool) -> Finding {
    let share = count as f64 / all as f64;
    let line = format!("{count} triplets that cannot be right were left out");
    let finding = if is_many {
        Finding::new(
            FindingKind::ManyOutliersLeftOut,
            format!(
                "{line}, {:.0} % of all: the rest may be wrong as well; find out what station followed another prism, or whose \
                 distances are another rig's",
                1e2 * share
            ),
        )
    } else {
        Finding::new(FindingKind::OutliersLeftOut, line)
    };
    finding.count("triplets", count).quantity("share", share, Unit::Ratio)
}

/// A span (s, in the stations' clock) of a drive that begins at `start_s`.
pub fn span_left_out(span_s: [f64; 2], start_s: f64) -> Finding {
    let [from_s, to_s] = span_s;
    Finding::new(
        FindingKind::SpanLeftOut,
        format!(
            "most of what is from {:.0} to {:.0} s of the drive does not fit the rest and was left out: a station moved, or \
             followed another prism for that long; cut the recording there",
            from_s - start_s,
            to_s - start_s
        ),
    )
    .quantity("from", from_s, Unit::Second)
    .quantity("to", to_s, Unit::Second)
    .with(Remedy::ShowTimes(span_s))
}

/// `largest_m` is the largest error of a distance, where it is known.
pub fn outliers_shift_answer(count: usize, largest_m: Option<f64>, shift_m: f64) -> Finding {
    let message = match largest_m {
        Some(largest_m) => format!(
            "{count} triplets with distances off by up to {largest_m:.2} m pull this answer by {:.0} mm: a station lost its \
             prism or followed another; the joint estimate leaves them out",
            shift_m * 1e3
        ),
        None => format!(
            "{count} triplets that cannot be right pull this answer by {:.0} mm; the joint estimate leaves them out",
            shift_m * 1e3
        ),
    };
    Finding::new(FindingKind::OutliersShiftAnswer, message)
        .count("triplets", count)
        .quantity("shift", shift_m, Unit::Metre)
        .with(Remedy::JointEstimate)
}

pub fn prior_search_unconfirmed() -> Finding {
    Finding::new(
        FindingKind::PriorSearchUnconfirmed,
        "the search of the prior found no optimum that three other runs agree with; compare with the closed form",
    )
    .with(Remedy::ClosedFormPrior)
}

pub fn prior_search_elsewhere(apart_m: f64) -> Finding {
    Finding::new(
        FindingKind::PriorSearchElsewhere,
        format!(
            "the search of the prior ended {apart_m:.2} m from this answer (in another minimum, such as the mirror twin); the \
             answer does not rest on it"
        ),
    )
    .quantity("apart", apart_m, Unit::Metre)
}

pub(super) fn examples() -> Vec<Finding> {
    vec![
        outliers_left_out(5, 1000, false),
        outliers_left_out(300, 1000, true),
        span_left_out([120.0, 160.0], 20.0),
        outliers_shift_answer(5, Some(2.0), 0.04),
        outliers_shift_answer(5, None, 0.04),
        prior_search_unconfirmed(),
        prior_search_elsewhere(0.8),
    ]
}
