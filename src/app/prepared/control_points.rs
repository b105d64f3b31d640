//! Residuals of a calibration at the control points.

use nalgebra::Vector3;

use resect_core::analysis::Analysis;
use resect_core::calibration::{Calibration, Details, Method};
use resect_core::deployment::{ControlPoint, ControlPointSet, Deployment};
use resect_core::network::PerStation;

/// A control point by a calibration: its position by each station, relative to their mean.
#[derive(Clone, Debug, PartialEq)]
pub struct PointResidual {
    /// Letter of the point's set, and its number in the set: "P3".
    pub name: String,
    pub file: String,
    /// Number of the point in its file.
    pub marker: i64,
    pub pillar: bool,
    /// Mean of its positions by the stations (m, station 1's frame).
    pub mean_m: Vector3<f64>,
    /// The point's position by each station, relative to the mean (m); `None` if the station did not measure it.
    pub residuals_m: PerStation<Option<Vector3<f64>>>,
    /// True if the calibration is estimated from it; otherwise it is an independent check.
    pub used: bool,
}

/// Returns the letter of a set in the scene and in the table: P to Z, then numbers. A to D are the methods.
pub fn set_letter(set: usize) -> String {
    ('P'..='Z').nth(set).map_or_else(|| format!("{}·", set + 1), String::from)
}

/// Returns the name of a point: its number alone if there is only one set.
pub fn point_name(deployment: &Deployment, set: usize, marker: i64) -> String {
    if deployment.control_points.len() > 1 {
        format!("{}{marker}", set_letter(set))
    } else {
        marker.to_string()
    }
}

/// Returns every control point that at least two stations measured; empty if the calibration does not determine their positions.
pub fn residuals(deployment: &Deployment, analysis: &Analysis) -> Vec<PointResidual> {
    let Ok(answer) = &analysis.answer else { return Vec::new() };
    let calibration = &answer.calibration;
    let Some(transforms) = calibration.placing_control_points(deployment) else {
        return Vec::new();
    };
    let mut all = Vec::new();
    for (number, set) in deployment.control_points.iter().enumerate() {
        for point in &set.points {
            let placed_m = point.readings.zip(&transforms, |polar, transform| {
                Some(transform.apply(&polar.as_ref()?.to_cartesian()))
            });
            let count = placed_m.iter().flatten().count();
            if count < 2 {
                continue;
            }
            let mean_m = placed_m.iter().flatten().sum::<Vector3<f64>>() / count as f64;
            all.push(PointResidual {
                name: point_name(deployment, number, point.marker),
                file: set.file.clone(),
                marker: point.marker,
                pillar: set.pillars,
                mean_m,
                residuals_m: placed_m.map(|placed_m| Some(placed_m.as_ref()? - mean_m)),
                used: rests_on(calibration, set, point),
            });
        }
    }
    all
}

/// Returns true if a calibration is estimated from this point: A from two of them, B from all but pillars, C and D from none. The joint
/// estimate uses all or none.
fn rests_on(calibration: &Calibration, set: &ControlPointSet, point: &ControlPoint) -> bool {
    match (&calibration.details, calibration.method) {
        (Details::TwoPoint(details), _) => {
            let pair = &details.pairs[details.chosen];
            pair.file == set.file && pair.markers.contains(&point.marker)
        }
        (_, Method::StaticGcp) => !set.pillars,
        _ => calibration.survey().is_some(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use resect_core::analysis::{Analyst, Settings};
    use resect_core::network::Pair;
    use resect_core::statistics::median;
    use resect_io::sample::Sample;

    fn with(method: Option<Method>) -> (Deployment, Vec<PointResidual>, Analysis) {
        let deployment = Sample::Warthog.open().expect("built in");
        let mut settings = Settings::default();
        settings.calibration.method = method;
        let analysis = Analyst::new(deployment.clone().into()).run(&settings);
        let found = residuals(&deployment, &analysis);
        (deployment, found, analysis)
    }

    #[test]
    fn the_versions_of_a_point_are_as_far_apart_as_the_metric_says() {
        let (_, found, analysis) = with(None);
        let answer = analysis.answer.expect("an answer");
        for metric in &answer.evaluation.control_points_mm {
            let of_file = found.iter().filter(|point| point.file == metric.file);
            let apart_mm = of_file.flat_map(|point| {
                Pair::among(3).map(Pair::indices).filter_map(|[a, b]| {
                    let apart_m = point.residuals_m[a]? - point.residuals_m[b]?;
                    Some(1e3 * apart_m.norm())
                })
            });
            let median_mm = median(apart_mm).expect("points");
            assert!((median_mm - metric.spread.median).abs() < 1e-6, "{median_mm} {metric:?}");
        }
        // Their sum is zero, since they are relative to the mean.
        for point in &found {
            let sum: Vector3<f64> = point.residuals_m.iter().flatten().sum();
            assert!(sum.norm() < 1e-9, "{point:?}");
        }
    }

    #[test]
    fn points_are_named_by_their_set_and_it_is_said_which_the_answer_rests_on() {
        let (deployment, found, _) = with(None);
        assert!(deployment.control_points.len() > 1);
        assert!(found.iter().all(|point| point.used), "the joint estimate uses all");
        let (_, by_drive, _) = with(Some(Method::InterPrism));
        assert!(by_drive.iter().all(|point| !point.used), "the drive alone decides");
        let mut names: Vec<&str> = found.iter().map(|point| point.name.as_str()).collect();
        let count = names.len();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), count, "no name twice");
        let (_, found, _) = with(Some(Method::StaticGcp));
        assert!(found.iter().all(|point| point.used != point.pillar));
        let (_, found, _) = with(Some(Method::TwoPoint));
        assert_eq!(found.iter().filter(|point| point.used).count(), 2);
        assert_eq!([0, 10, 11].map(set_letter), ["P", "Z", "12·"]);
    }
}
