//! The answers to one drive: of the paper's methods, and of the joint estimate by the drive alone and by everything.

use nalgebra::DVector;
use resect_core::analysis::{Analysis, Answer, Settings};
use resect_core::calibration::joint::SetUpChange;
use resect_core::calibration::{Calibration, Evidence, Method};
use resect_core::geometry::wrap_to_pi;
use resect_core::statistics::median;

use super::control_point_half::{ControlPointHalf, control_point_halves};
use super::real_drive::RealDrive;
use crate::common::{analyse, by};

/// The answers to one drive.
pub struct DriveAnswers {
    pub drive: RealDrive,
    /// Method D, or C where all stations follow one prism.
    pub paper: JudgedAnswer,
    /// Method B; `None` if no control points can be compared with the drive.
    pub from_points: Option<JudgedAnswer>,
    /// The joint estimate without control points.
    pub by_drive: JudgedAnswer,
    pub by_everything: JudgedAnswer,
}

/// An answer with its metrics on control points that it has not used.
pub struct JudgedAnswer {
    pub name: String,
    pub analysis: Analysis,
    /// Control-point metric of the left-out points (mm), by half.
    left_out_mm: Vec<Option<f64>>,
}

/// Difference of two answers relative to their joint covariance.
pub struct AnswerDifference {
    /// χ² of all eight parameters.
    pub chi_square: f64,
    /// Differences of (x, y, z, yaw) of stations 2 and 3, in σ.
    pub sigmas: [f64; 8],
}

impl DriveAnswers {
    pub fn new(drive: RealDrive) -> Self {
        let halves = control_point_halves(&drive.deployment);
        let judged = |name: &str, settings: &Settings| {
            JudgedAnswer::new(name.to_owned(), &drive, settings, &halves)
        };
        let by_everything = judged("joint, everything", &Settings::default());
        let by_drive = judged("joint, drive", &drive_alone());
        let method = by_everything.analysis.offer.published_method();
        let paper = judged(&method.short_name(), &by(method));
        let from_points = (!halves.is_empty()).then(|| judged("B", &by(Method::StaticGcp)));
        Self { drive, paper, from_points, by_drive, by_everything }
    }

    pub fn all(&self) -> impl Iterator<Item = &JudgedAnswer> {
        let joint = [&self.by_drive, &self.by_everything];
        std::iter::once(&self.paper).chain(&self.from_points).chain(joint)
    }

    /// Returns the change of a set-up between survey and drive that the joint estimate reports.
    pub fn change(&self) -> Option<&SetUpChange> {
        set_up_change(&self.by_everything.answer()?.calibration)
    }

    /// Returns the median ratio of an answer's metric to that of method B from the same half.
    pub fn ratio_to_points(&self, answer: &JudgedAnswer) -> Option<f64> {
        let from_points = self.from_points.as_ref()?;
        let pairs = answer.left_out_mm.iter().zip(&from_points.left_out_mm);
        median(pairs.filter_map(|(own, reference)| Some((*own)? / (*reference)?)))
    }

    /// Returns the joint estimate by the drive alone, less method B; `None` if either is missing or has no covariance.
    pub fn drive_less_points(&self) -> Option<AnswerDifference> {
        let by_points = &self.from_points.as_ref()?.answer()?.calibration;
        AnswerDifference::new(by_points, &self.by_drive.answer()?.calibration)
    }
}

impl JudgedAnswer {
    fn new(
        name: String,
        drive: &RealDrive,
        settings: &Settings,
        halves: &[ControlPointHalf],
    ) -> Self {
        let analysis = analyse(&drive.deployment, settings);
        let left_out_mm = halves.iter().map(|half| half.left_out_mm(settings)).collect();
        Self { name, analysis, left_out_mm }
    }

    /// Returns the answer to the whole drive; `None` if there is none.
    pub fn answer(&self) -> Option<&Answer> {
        self.analysis.answer.as_deref().ok()
    }

    /// Returns the median metric of left-out control points (mm).
    pub fn median_left_out_mm(&self) -> Option<f64> {
        median(self.left_out_mm.iter().copied().flatten())
    }

    /// Returns the inter-prism metric, with estimated distances if the answer estimates them (mm).
    pub fn inter_prism_mm(&self) -> Option<f64> {
        Some(self.answer()?.evaluation.inter_prism_mm?.median)
    }
}

impl AnswerDifference {
    fn new(a: &Calibration, b: &Calibration) -> Option<Self> {
        let covariance = a.covariance.as_ref()? + b.covariance.as_ref()?;
        let difference = DVector::from_fn(covariance.nrows(), |k, _| {
            let [a, b] = [a, b].map(|answer| &answer.station1_from_station[k / 4 + 1]);
            match k % 4 {
                3 => wrap_to_pi(b.yaw_rad() - a.yaw_rad()),
                axis => b.translation_m[axis] - a.translation_m[axis],
            }
        });
        let chi_square = difference.dot(&covariance.clone().cholesky()?.solve(&difference));
        let sigmas = std::array::from_fn(|k| difference[k] / covariance[(k, k)].sqrt());
        Some(Self { chi_square, sigmas })
    }
}

/// Returns the settings of the joint estimate without control points.
fn drive_alone() -> Settings {
    let mut settings = Settings::default();
    settings.calibration.evidence = Evidence { control_points: false, ..Evidence::ALL };
    settings
}

/// Returns the change of a set-up that a joint estimate reports.
pub fn set_up_change(calibration: &Calibration) -> Option<&SetUpChange> {
    calibration.joint()?.survey.as_ref()?.change.as_ref()
}
