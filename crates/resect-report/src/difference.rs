//! Differences of two answers: of a pinned result and the current one, and of the joint estimate and the paper's answer.
//!
//! **Unit σ.** Two answers from the *same readings* under other settings share most of their errors, so the σ of their
//! difference is smaller than either's own. The amount is unknown. The relevant question is another: do these settings
//! change the answer by more than its stated uncertainty? Therefore the difference is given in σ of the current answer.
//! Below 1 the choice does not matter. Above 2 or 3 one of the settings admits errors, or σ is too small. Two answers
//! from *different readings* are independent, and the difference is given in the root of the sum of their variances.

use nalgebra::{DMatrix, Matrix3, UnitQuaternion, Vector3};

use super::summary::{ResultSummary, StationSummary};
use resect_core::analysis::{SettingChange, setting_changes};
use resect_core::calibration::{Calibration, Method, Verdict};
use resect_core::evaluation::Spread;
use resect_core::evaluation::answer_rows::AnswerRow;
use resect_core::geometry::wrap_to_pi;

/// A quantity in the pinned answer and in the current one.
#[derive(Clone, Debug, PartialEq)]
pub struct Compared<T> {
    pub pinned: T,
    pub now: T,
}

/// Current minus pinned, also in units of σ if there is one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    pub value: f64,
    /// Never negative; the module's documentation defines the σ.
    pub sigmas: Option<f64>,
}

/// Difference of `station1_from_station` of one station.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StationDifference {
    /// The station, from 2 on.
    pub station: usize,
    /// Difference of the translations along the axes of station 1 (m).
    pub translation_m: [Deviation; 3],
    /// Length of the translations' difference (m), in σ along its own direction.
    pub distance_m: Deviation,
    pub yaw_rad: Deviation,
    /// Angle of the relative rotation, including roll and pitch, whose σ is unknown (rad).
    pub angle_rad: f64,
}

impl StationDifference {
    /// Formats the difference: "T12 4.20 mm (3.1 σ; x +3.10, y -2.70, z +0.80), yaw +0.0210 mrad (1.9 σ)".
    pub fn in_words(&self) -> String {
        let [x, y, z] = self.translation_m.map(|along| along.value * 1e3);
        let sigmas = |deviation: Deviation| match deviation.sigmas {
            Some(sigmas) => format!("{sigmas:.1} σ"),
            None => "no σ".to_owned(),
        };
        format!(
            "T1{} {:.2} mm ({}; x {x:+.2}, y {y:+.2}, z {z:+.2}), yaw {:+.4} mrad ({})",
            self.station,
            self.distance_m.value * 1e3,
            sigmas(self.distance_m),
            self.yaw_rad.value * 1e3,
            sigmas(self.yaw_rad),
        )
    }
}

/// Difference of two answers.
#[derive(Clone, Debug, PartialEq)]
pub struct ResultDifference {
    /// True if both use the same readings; otherwise the stations may even have other set-ups.
    pub same_data: bool,
    /// Differences of stations 2, 3, …, as far as both answers have them.
    pub stations: Vec<StationDifference>,
    pub verdict: Compared<Verdict>,
    pub method: Compared<Method>,
    pub triplets: Compared<usize>,
    /// Absolute distance errors pooled over the pairs (mm).
    pub inter_prism_mm: Compared<Option<Spread>>,
    /// Control-point metric by file (mm), the files of the current answer first.
    pub control_points_mm: Vec<(String, Compared<Option<Spread>>)>,
    /// Estimates besides the transforms that both answers have, if at least one is significant.
    pub estimates: Vec<EstimateDifference>,
    pub settings: Vec<SettingChange>,
}

/// An estimate besides the transforms, in both answers.
#[derive(Clone, Debug, PartialEq)]
pub struct EstimateDifference {
    pub rows: Compared<AnswerRow>,
    pub deviation: Deviation,
}

impl ResultDifference {
    pub fn between(pinned: &ResultSummary, now: &ResultSummary) -> Self {
        let same_data = pinned.has_same_data(now);
        Self {
            same_data,
            stations: (0..pinned.stations.len().min(now.stations.len()))
                .map(|k| station_difference(pinned, now, k, same_data))
                .collect(),
            verdict: Compared { pinned: pinned.verdict, now: now.verdict },
            method: Compared { pinned: pinned.answered_by(), now: now.answered_by() },
            triplets: Compared { pinned: pinned.triplets, now: now.triplets },
            inter_prism_mm: Compared { pinned: pinned.inter_prism_mm, now: now.inter_prism_mm },
            control_points_mm: control_points(pinned, now),
            estimates: estimates(pinned, now, same_data),
            settings: setting_changes(&pinned.settings, &now.settings),
        }
    }
}

fn control_points(
    pinned: &ResultSummary,
    now: &ResultSummary,
) -> Vec<(String, Compared<Option<Spread>>)> {
    let spread = |summary: &ResultSummary, file: &str| {
        summary.control_points_mm.iter().find(|metric| metric.file == file).map(|m| m.spread)
    };
    let mut files: Vec<&str> = Vec::new();
    for metric in now.control_points_mm.iter().chain(&pinned.control_points_mm) {
        if !files.contains(&metric.file.as_str()) {
            files.push(&metric.file);
        }
    }
    let compared = |file| Compared { pinned: spread(pinned, file), now: spread(now, file) };
    files.into_iter().map(|file| (file.to_owned(), compared(file))).collect()
}

fn estimates(
    pinned: &ResultSummary,
    now: &ResultSummary,
    same_data: bool,
) -> Vec<EstimateDifference> {
    let both = |after: &AnswerRow| {
        let before = pinned.estimates.iter().find(|row| row.is_same_number(after))?;
        (before.is_significant || after.is_significant).then(|| {
            let value = after.value - before.value;
            let sigma = match (same_data, before.sigma, after.sigma) {
                (true, _, sigma) => sigma,
                (false, Some(before), Some(after)) => Some(before.hypot(after)),
                (false, ..) => None,
            };
            EstimateDifference {
                rows: Compared { pinned: before.clone(), now: after.clone() },
                deviation: Deviation {
                    value,
                    sigmas: sigma.and_then(|sigma| in_sigmas(value, sigma)),
                },
            }
        })
    };
    now.estimates.iter().filter_map(both).collect()
}

fn station_difference(
    pinned: &ResultSummary,
    now: &ResultSummary,
    k: usize,
    same_data: bool,
) -> StationDifference {
    let (before, after) = (&pinned.stations[k], &now.stations[k]);
    let sigma: Option<[f64; 4]> = if same_data {
        after.sigma
    } else {
        after.sigma.zip(before.sigma).map(|(a, b)| std::array::from_fn(|i| a[i].hypot(b[i])))
    };
    let covariance = |summary: &ResultSummary| -> Option<Matrix3<f64>> {
        Some(of_translation(&summary.covariance_matrix()?, k))
    };
    let covariance = if same_data {
        covariance(now)
    } else {
        covariance(now).zip(covariance(pinned)).map(|(a, b)| a + b)
    };
    moved(before, after, sigma, covariance)
}

/// Returns the joint estimate minus the paper's answer for stations 2, 3, …, in σ of both combined: a difference from an uncertain
/// answer is no evidence against the joint estimate. `None` for an answer without another beside it, if the joint estimate failed,
/// and if the readings do not determine the paper's answer.
pub fn moved_from_published(joint: &Calibration) -> Option<Vec<StationDifference>> {
    let published = joint.published.as_deref().filter(|_| joint.joint_failure().is_none())?;
    if published.verdict == Verdict::Degenerate {
        return None;
    }
    let covariance = joint.covariance.as_ref().zip(published.covariance.as_ref());
    let covariance = covariance.map(|(a, b)| a + b);
    let [before, after] = [published, joint].map(StationSummary::of);
    let both = before.iter().zip(&after).enumerate().map(|(k, (before, after))| {
        let sigma = after.sigma.zip(before.sigma);
        let sigma = sigma.map(|(a, b)| std::array::from_fn(|i| a[i].hypot(b[i])));
        let covariance = covariance.as_ref().map(|covariance| of_translation(covariance, k));
        moved(before, after, sigma, covariance)
    });
    Some(both.collect())
}

fn of_translation(covariance: &DMatrix<f64>, k: usize) -> Matrix3<f64> {
    covariance.fixed_view::<3, 3>(4 * k, 4 * k).into_owned()
}

/// Returns `after` minus `before`, in units of these σ of (x, y, z, yaw) and of this covariance of the translation.
fn moved(
    before: &StationSummary,
    after: &StationSummary,
    sigma: Option<[f64; 4]>,
    covariance: Option<Matrix3<f64>>,
) -> StationDifference {
    let deviation = |value: f64, part: usize| Deviation {
        value,
        sigmas: sigma.and_then(|sigma| in_sigmas(value, sigma[part])),
    };
    let off = Vector3::from(after.translation_m) - Vector3::from(before.translation_m);
    let distance_sigmas = covariance.and_then(|covariance| {
        // Without a displacement any direction will do.
        let along = off.try_normalize(0.0).unwrap_or_else(Vector3::x);
        in_sigmas(off.norm(), along.dot(&(covariance * along)).max(0.0).sqrt())
    });
    StationDifference {
        station: after.station,
        translation_m: std::array::from_fn(|axis| deviation(off[axis], axis)),
        distance_m: Deviation { value: off.norm(), sigmas: distance_sigmas },
        yaw_rad: deviation(wrap_to_pi(after.yaw_rad() - before.yaw_rad()), 3),
        angle_rad: angle_between_rad(before, after),
    }
}

fn in_sigmas(value: f64, sigma: f64) -> Option<f64> {
    (sigma > 0.0).then(|| value.abs() / sigma)
}

/// Returns the angle between two rotations in [0, π] (rad), accurate to the last digit near zero, unlike an arc cosine.
fn angle_between_rad(a: &StationSummary, b: &StationSummary) -> f64 {
    let rotation = |station: &StationSummary| {
        UnitQuaternion::from_rotation_matrix(&station.station1_from_station().rotation)
    };
    let turn = rotation(a).inverse() * rotation(b);
    2.0 * turn.imag().norm().atan2(turn.w.abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use nalgebra::Rotation3;
    use resect_core::analysis::Settings;
    use resect_core::calibration::TransformSigma;
    use resect_core::geometry::RigidTransform;

    const SIGMA: TransformSigma =
        TransformSigma { translation_m: Vector3::new(0.001, 0.002, 0.004), yaw_rad: 1e-5 };

    fn summary(x_m: f64, yaw_rad: f64, roll_rad: f64) -> ResultSummary {
        let station = |station| {
            let transform = RigidTransform {
                rotation: Rotation3::from_euler_angles(roll_rad, 0.0, yaw_rad),
                translation_m: Vector3::new(x_m, 5.0, -1.0),
            };
            StationSummary::new(station, &transform, Some(SIGMA))
        };
        let sigma = [0.001, 0.002, 0.004, 1e-5];
        let entry = |i: usize, j: usize| if i == j { f64::powi(sigma[i % 4], 2) } else { 0.0 };
        let covariance = (0..8).map(|i| (0..8).map(|j| entry(i, j)).collect()).collect();
        ResultSummary {
            deployment: "field".to_owned(),
            readings: [100; 3].into(),
            method: Method::InterPrism,
            fallback: None,
            verdict: Verdict::Good,
            independently_checked: true,
            doubts: Vec::new(),
            triplets: 50,
            one_prism: false,
            stations: vec![station(2), station(3)],
            covariance: Some(covariance),
            inter_prism_mm: None,
            control_points_mm: Vec::new(),
            estimates: Vec::new(),
            settings: Settings::default(),
        }
    }

    /// Doubles all σ of a summary.
    fn less_certain(mut summary: ResultSummary) -> ResultSummary {
        for station in &mut summary.stations {
            station.sigma = station.sigma.map(|sigma| sigma.map(|s| 2.0 * s));
        }
        let entries = summary.covariance.iter_mut().flatten().flatten();
        entries.for_each(|entry| *entry *= 4.0);
        summary
    }

    #[test]
    fn the_same_data_is_counted_in_sigmas_of_the_current_answer() {
        let mut now = summary(10.003, 0.5 + 2e-5, 0.0);
        now.settings.pipeline.rate_hz = 5.0;
        let pinned = less_certain(summary(10.0, 0.5, 0.0));
        let difference = ResultDifference::between(&pinned, &now);
        assert!(difference.same_data);
        for station in &difference.stations {
            let [x, y, _] = station.translation_m;
            assert_relative_eq!(x.value, 0.003, epsilon = 1e-12);
            assert_relative_eq!(x.sigmas.expect("σ"), 3.0, epsilon = 1e-9);
            assert_eq!((y.value, y.sigmas), (0.0, Some(0.0)));
            // The whole displacement is along x.
            assert_relative_eq!(station.distance_m.sigmas.expect("σ"), 3.0, epsilon = 1e-9);
            assert_relative_eq!(station.yaw_rad.value, 2e-5, epsilon = 1e-12);
            assert_relative_eq!(station.yaw_rad.sigmas.expect("σ"), 2.0, epsilon = 1e-6);
            assert_relative_eq!(station.angle_rad, 2e-5, epsilon = 1e-12);
        }
        assert_eq!(difference.settings.len(), 1);
        assert_eq!(difference.settings[0].to_string(), "rate 10 → 5 Hz");
    }

    #[test]
    fn other_data_is_independent() {
        let mut pinned = less_certain(summary(10.0, 0.5, 0.0));
        pinned.readings[1] = 99;
        let difference = ResultDifference::between(&pinned, &summary(10.003, 0.5, 0.0));
        assert!(!difference.same_data);
        for deviation in
            [difference.stations[0].distance_m, difference.stations[1].translation_m[0]]
        {
            let sigmas = deviation.sigmas.expect("σ");
            assert_relative_eq!(sigmas, 3.0 / 5_f64.sqrt(), epsilon = 1e-9);
        }
    }

    #[test]
    fn without_sigma_there_is_a_difference_but_no_count() {
        let mut now = summary(10.5, 0.5, 0.0);
        now.verdict = Verdict::Degenerate;
        now.covariance = None;
        now.stations.iter_mut().for_each(|station| station.sigma = None);
        let difference = ResultDifference::between(&summary(10.0, 0.5, 0.0), &now);
        let station = &difference.stations[1];
        assert_eq!(station.distance_m, Deviation { value: 0.5, sigmas: None });
        assert_eq!(
            difference.verdict,
            Compared { pinned: Verdict::Good, now: Verdict::Degenerate }
        );
    }

    #[test]
    fn yaw_takes_the_short_way_and_the_angle_holds_the_roll() {
        let pi = std::f64::consts::PI;
        let difference =
            ResultDifference::between(&summary(0.0, pi - 1e-4, 0.0), &summary(0.0, 1e-4 - pi, 0.0));
        assert_relative_eq!(difference.stations[0].yaw_rad.value, 2e-4, epsilon = 1e-12);
        let difference =
            ResultDifference::between(&summary(0.0, 0.5, 0.0), &summary(0.0, 0.5, 1e-4));
        assert_relative_eq!(difference.stations[0].angle_rad, 1e-4, epsilon = 1e-12);
        assert_relative_eq!(difference.stations[0].yaw_rad.value, 0.0, epsilon = 1e-12);
    }

    #[test]
    fn control_points_are_matched_by_file() {
        let metric = |file: &str, median| resect_core::evaluation::ControlPointMetric {
            file: file.to_owned(),
            spread: Spread { median, q25: 0.0, q75: 1.0, iqr: 1.0, n: 3 },
        };
        let (mut pinned, mut now) = (summary(0.0, 0.0, 0.0), summary(0.0, 0.0, 0.0));
        pinned.control_points_mm = vec![metric("a", 1.0), metric("b", 2.0)];
        now.control_points_mm = vec![metric("b", 3.0), metric("c", 4.0)];
        let difference = ResultDifference::between(&pinned, &now);
        let medians: Vec<_> = difference
            .control_points_mm
            .iter()
            .map(|(file, both)| {
                let median = |spread: Option<Spread>| spread.map(|spread| spread.median);
                (file.as_str(), median(both.pinned), median(both.now))
            })
            .collect();
        let expected =
            [("b", Some(2.0), Some(3.0)), ("c", None, Some(4.0)), ("a", Some(1.0), None)];
        assert_eq!(medians, expected);
    }
}
