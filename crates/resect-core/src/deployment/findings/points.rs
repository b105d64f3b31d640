//! Findings of the methods from points: control points (A, B), and the aligned tracks of one prism (C).

use crate::deployment::kinds;
use crate::deployment::{
    AngleFormat, Finding, FollowedPrisms, Message, MessageAngle, Overrides, Remedy, Severity,
    Subject, Unit,
};
use crate::statistics::estimate::{Estimate, decimals_of};

/// `is_global` is true if the points have known coordinates.
pub fn control_points_aligned(count: usize, is_global: bool, rms_m: f64) -> Finding {
    Finding::new(
        kinds::CONTROL_POINTS_ALIGNED,
        format!(
            "{count} control points aligned {}, {:.1} mm rms",
            if is_global { "to their global coordinates" } else { "to station 1" },
            rms_m * 1e3
        ),
    )
    .count("points", count)
    .quantity("rms", rms_m, Unit::Metre)
}

/// A problem if the fit is hopeless, else a warning.
pub fn control_points_fit_poorly(rms_m: f64, is_hopeless: bool) -> Finding {
    let severity = if is_hopeless { Severity::Problem } else { Severity::Warning };
    Finding::new(
        kinds::CONTROL_POINTS_FIT_POORLY,
        format!(
            "the control points fit poorly ({:.1} mm rms): check markers, coordinates and prism constant, and if a \
             station moved",
            rms_m * 1e3
        ),
    )
    .with_severity(severity)
    .quantity("rms", rms_m, Unit::Metre)
    .with(Remedy::Corrections)
}

/// `typical_m` is the median residual of all points.
pub fn control_point_outlier(file: &str, marker: i64, off_m: f64, typical_m: f64) -> Finding {
    Finding::new(
        kinds::CONTROL_POINT_OUTLIER,
        format!(
            "marker {marker} of {file} is an outlier: it is off by {:.0} mm, half of the points by less than {:.0} mm; check its \
             readings, or leave it out",
            off_m * 1e3,
            typical_m * 1e3
        ),
    )
    .about(Subject::Point { file: file.to_owned(), marker })
    .quantity("residual", off_m, Unit::Metre)
    .quantity("median", typical_m, Unit::Metre)
    .with(Remedy::ShowPoint { file: file.to_owned(), marker })
}

/// `axis` is along the sight (0), to its right (1) or up (2); `bias_m` is the error of the reading by all others.
pub fn control_point_reading_off(
    (file, marker): (&str, i64),
    station: usize,
    axis: usize,
    bias_m: &Estimate,
) -> Finding {
    let side = ["along the sight", "to the right", "upward"][axis];
    let decimals = decimals_of(bias_m.sigma * 1e3).unwrap_or(1);
    Finding::new(
        kinds::CONTROL_POINT_OUTLIER,
        format!(
            "marker {marker} of {file} is an outlier: station {}'s reading is off by {:+.decimals$} ± {:.decimals$} mm {side}; \
             check it, or leave it out",
            station + 1,
            bias_m.value * 1e3,
            bias_m.sigma * 1e3
        ),
    )
    .about(Subject::Point { file: file.to_owned(), marker })
    .estimate("bias", bias_m, Unit::Metre)
    .with(Remedy::ShowPoint { file: file.to_owned(), marker })
}

/// `excess_m` is the station's ranges to control points less those that the others allow.
pub fn control_point_ranges_off(station: usize, excess_m: &Estimate) -> Finding {
    let decimals = decimals_of(excess_m.sigma * 1e3).unwrap_or(1);
    Finding::new(
        kinds::CONTROL_POINT_RANGES_OFF,
        format!(
            "station {}'s ranges to the control points are off by {:+.decimals$} ± {:.decimals$} mm; check its prism constant, and the \
             target that it measured",
            station + 1,
            excess_m.value * 1e3,
            excess_m.sigma * 1e3
        ),
    )
    .about(Subject::Station(station))
    .estimate("excess", excess_m, Unit::Metre)
    .with(Remedy::Corrections)
}

/// The change is the station's pose at the points of `file` less that at the others.
pub fn station_moved_between_sets(
    station: usize,
    file: &str,
    turned_rad: &Estimate,
    moved_m: &Estimate,
) -> Finding {
    let decimals = decimals_of(turned_rad.sigma * 1e3).unwrap_or(3);
    let turned = MessageAngle::signed(turned_rad.value, AngleFormat::Milliradians, decimals)
        .sigma(turned_rad.sigma);
    let decimals = decimals_of(moved_m.sigma * 1e3).unwrap_or(1);
    let (value_mm, sigma_mm) = (moved_m.value * 1e3, moved_m.sigma * 1e3);
    let message = Message::from(format!("station {} turned by ", station + 1)).angle(turned).text(format!(
        " and moved by {value_mm:.decimals$} ± {sigma_mm:.decimals$} mm between {file} and the other control points; measure them \
         again, or leave out those that it did not measure from where it stood in the drive"
    ));
    Finding::new(kinds::STATION_MOVED_BETWEEN_SETS, message)
        .about(Subject::Station(station))
        .estimate("turned", turned_rad, Unit::Radian)
        .estimate("moved", moved_m, Unit::Metre)
}

pub fn known_point_misplaced(file: &str, marker: i64, off_m: f64) -> Finding {
    Finding::new(
        kinds::KNOWN_POINT_MISPLACED,
        format!(
            "marker {marker} of {file} is left out: it lies {:.0} mm from the position by the other points; check its \
             coordinates and marker",
            off_m * 1e3
        ),
    )
    .about(Subject::Point { file: file.to_owned(), marker })
    .quantity("apart", off_m, Unit::Metre)
    .with(Remedy::ShowPoint { file: file.to_owned(), marker })
}

/// The best of `pairs` pairs of known points; `agreement_m` is the median disagreement at the points left out, and the number of
/// stations.
pub fn resection_pair(
    file: &str,
    markers: [i64; 2],
    baseline_m: f64,
    pairs: usize,
    agreement_m: Option<(f64, usize)>,
) -> Finding {
    let [first, second] = markers;
    let agreement = agreement_m.map_or(String::new(), |(median_m, stations)| {
        let agree = match stations {
            1 => "station 1 agrees there with the known positions",
            _ => "the stations agree there",
        };
        format!(": {agree} within {:.1} mm (median)", median_m * 1e3)
    });
    let finding = Finding::new(
        kinds::RESECTION_PAIR,
        format!(
            "points {first} and {second} of {file} ({baseline_m:.0} m apart), the best of {pairs} pairs by the other \
             points{agreement}"
        ),
    )
    .about(Subject::File(file.to_owned()))
    .quantity("baseline", baseline_m, Unit::Metre)
    .count("pairs", pairs);
    match agreement_m {
        Some((median_m, _)) => finding.quantity("median", median_m, Unit::Metre),
        None => finding,
    }
}

pub fn resection_unchecked() -> Finding {
    Finding::new(
        kinds::RESECTION_UNCHECKED,
        "this resection is unchecked: without a third known point, a wrong coordinate or marker does not show",
    )
}

pub fn resection_inconsistent(median_m: f64, stations: usize) -> Finding {
    let disagree = match stations {
        1 => "station 1 disagrees with the known positions",
        _ => "the stations disagree",
    };
    Finding::new(
        kinds::RESECTION_INCONSISTENT,
        format!(
            "the resection is inconsistent: with the best pair {disagree} by {:.0} mm (median) at the other points",
            median_m * 1e3
        ),
    )
    .quantity("median", median_m, Unit::Metre)
}

/// `error_m` is the measured minus the known distance between two points.
pub fn known_distance_off(markers: [i64; 2], error_m: f64, distance_m: f64) -> Finding {
    let [first, second] = markers;
    let ppm = error_m / distance_m * 1e6;
    Finding::new(
        kinds::KNOWN_DISTANCE_OFF,
        format!(
            "the measured distance of points {first} and {second} is off by {:+.0} mm ({ppm:+.0} ppm) from the known one: check \
             temperature, pressure and prism constant, or the survey",
            error_m * 1e3
        ),
    )
    .quantity("error", error_m, Unit::Metre)
    .quantity("scale_error", ppm * 1e-6, Unit::Ratio)
    .with(Remedy::Corrections)
}

/// `blocks` are independent segments of time.
pub fn tracks_aligned(rms_m: f64, blocks: usize) -> Finding {
    Finding::new(
        kinds::TRACKS_ALIGNED,
        format!("tracks of one prism aligned, {:.1} mm rms over {blocks} segments", rms_m * 1e3),
    )
    .quantity("rms", rms_m, Unit::Metre)
    .count("blocks", blocks)
}

pub fn prism_count_undecided() -> Finding {
    let one_prism = Overrides { prisms: Some(FollowedPrisms::Count(1)), ..Overrides::default() };
    Finding::new(
        kinds::PRISM_COUNT_UNDECIDED,
        "the number of prisms is not determined, because the drive hardly turns; if it was one, set `prisms = 1` in \
         deployment.toml",
    )
    .with(Remedy::ReadWith(Box::new(one_prism)))
}

pub fn tracks_apart(rms_m: f64) -> Finding {
    Finding::new(
        kinds::TRACKS_APART,
        format!(
            "the tracks lie {rms_m:.2} m apart (rms): the stations did not follow one prism, or their clocks are far off"
        ),
    )
    .quantity("rms", rms_m, Unit::Metre)
    .with(Remedy::Corrections)
}

pub fn tracks_fit_poorly(rms_m: f64) -> Finding {
    Finding::new(
        kinds::TRACKS_FIT_POORLY,
        format!(
            "the tracks fit poorly ({:.1} mm rms): check the clocks and the filters",
            rms_m * 1e3
        ),
    )
    .quantity("rms", rms_m, Unit::Metre)
}

/// `fewest` is the number of segments of time for a good standard deviation.
pub fn few_time_blocks(blocks: usize, fewest: usize) -> Finding {
    Finding::new(
        kinds::FEW_TIME_BLOCKS,
        format!(
            "only {blocks} independent segments of time; σ is rough below {fewest}: record longer"
        ),
    )
    .count("blocks", blocks)
}

pub(super) fn examples() -> Vec<Finding> {
    let file = "GCP.txt";
    vec![
        control_points_aligned(7, true, 0.004),
        control_points_fit_poorly(0.03, false),
        control_point_outlier(file, 3, 0.08, 0.004),
        control_point_reading_off((file, 3), 1, 0, &Estimate { value: 0.012, sigma: 0.002 }),
        control_point_ranges_off(1, &Estimate { value: 0.01, sigma: 0.001 }),
        station_moved_between_sets(
            1,
            file,
            &Estimate { value: 3e-4, sigma: 2e-5 },
            &Estimate { value: 1e-3, sigma: 1e-3 },
        ),
        known_point_misplaced(file, 3, 0.08),
        resection_pair(file, [1, 2], 40.0, 6, Some((0.003, 3))),
        resection_unchecked(),
        resection_inconsistent(0.04, 3),
        known_distance_off([1, 2], 0.01, 100.0),
        tracks_aligned(0.004, 30),
        prism_count_undecided(),
        tracks_apart(0.5),
        tracks_fit_poorly(0.02),
        few_time_blocks(7, 12),
    ]
}
