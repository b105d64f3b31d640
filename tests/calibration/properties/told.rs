//! Results of each method for a deployment, and their comparison.

use nalgebra::DMatrix;
use resect_core::analysis::Analyst;
use resect_core::calibration::{Calibration, Method, Verdict, Witness};
use resect_core::deployment::{Deployment, Severity};
use resect_core::geometry::{RigidTransform, wrap_to_pi};
use resect_core::network::PerStation;

use crate::common::by;

/// Results of a method, without numbers that cannot be compared.
#[derive(Clone, Debug)]
pub struct Answered {
    pub transforms: PerStation<RigidTransform>,
    pub covariance: Option<DMatrix<f64>>,
    pub verdict: Verdict,
    pub checked_by: Vec<Witness>,
    pub findings: Vec<Said>,
    /// Distance errors, and medians of the control points (mm).
    pub metrics_mm: Vec<f64>,
    /// The paper's calibration beside a joint estimate.
    pub published: Option<Box<Answered>>,
}

/// A finding, split into words and numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Said {
    pub severity: Severity,
    pub doubt: bool,
    pub words: String,
    pub numbers: Vec<f64>,
    /// Number and kinds of its remedies.
    pub remedies: Vec<String>,
}

/// Returns the results of every method for a deployment, or the errors.
pub fn tell(deployment: &Deployment, methods: &[Method]) -> Vec<Result<Answered, String>> {
    let mut analyst = Analyst::new(deployment.clone().into());
    let each = methods.iter().map(|method| {
        let analysis = analyst.run(&by(*method));
        let answer = analysis.answer.map_err(|error| split(&error.to_string()).0)?;
        let mut answered = answered(&answer.calibration);
        let evaluation = &answer.evaluation;
        answered
            .metrics_mm
            .extend(evaluation.inter_prism_mm.iter().flat_map(|s| [s.median, s.iqr]));
        let mut points: Vec<_> = evaluation.control_points_mm.iter().collect();
        points.sort_by(|a, b| a.file.cmp(&b.file));
        answered.metrics_mm.extend(points.iter().map(|metric| metric.spread.median));
        Ok(answered)
    });
    each.collect()
}

fn answered(calibration: &Calibration) -> Answered {
    let said = calibration.findings.iter().map(|finding| {
        let (words, numbers) = split(&finding.to_string());
        // The content of a remedy has numbers of its own.
        let remedies =
            finding.remedies.iter().map(|remedy| split(&format!("{remedy:?}")).0).collect();
        Said {
            severity: finding.severity,
            doubt: finding.kind.is_doubt(),
            words,
            numbers,
            remedies,
        }
    });
    Answered {
        transforms: calibration.station1_from_station.clone(),
        covariance: calibration.covariance.clone(),
        verdict: calibration.verdict,
        checked_by: calibration.checked_by.clone(),
        findings: said.collect(),
        metrics_mm: Vec::new(),
        published: calibration.published.as_deref().map(|beside| Box::new(answered(beside))),
    }
}

/// Returns a text with `#` in place of each number, and the numbers.
fn split(text: &str) -> (String, Vec<f64>) {
    let (mut words, mut numbers, mut digits) = (String::new(), Vec::new(), String::new());
    for character in text.chars().chain(['\n']) {
        if character.is_ascii_digit() || (character == '.' && !digits.is_empty()) {
            digits.push(character);
            continue;
        }
        if !digits.is_empty() {
            let number = digits.trim_end_matches('.');
            words += "#";
            words += &digits[number.len()..];
            numbers.push(number.parse().unwrap_or(f64::NAN));
            digits.clear();
        }
        words.push(character);
    }
    words.pop();
    (words, numbers)
}

/// Tolerances between two results.
#[derive(Clone, Copy)]
pub struct Within {
    /// Tolerance of a position or a yaw: the larger one of this many σ and this many metres or radians.
    pub sigmas: f64,
    pub metres: f64,
    /// Tolerance of the covariance, in products of σ.
    pub covariance: f64,
    /// Tolerance of distance errors (mm).
    pub millimetres: f64,
}

/// Tolerances for rounding.
pub const ROUNDING: Within =
    Within { sigmas: 1e-6, metres: 1e-9, covariance: 1e-5, millimetres: 1e-6 };

/// Present stamps have a resolution of a quarter of a microsecond, in which a vehicle moves a quarter of a micrometre.
pub const OF_STAMPS: Within =
    Within { sigmas: 1e-3, metres: 1e-6, covariance: 1e-3, millimetres: 1e-3 };

/// The joint estimate estimates its noise with random probes along the axes of station 1 and prism by prism. In another frame, or with
/// other numbers, it draws others, which changes the result by thousandths of σ.
pub const OF_PROBES: Within =
    Within { sigmas: 0.03, metres: 1e-9, covariance: 0.03, millimetres: 0.03 };

/// Returns the tolerances for a calibration in another frame, or with other numbers.
pub fn in_another_frame(method: Method) -> Within {
    if method == Method::Joint { OF_PROBES } else { ROUNDING }
}

impl Answered {
    /// Returns the differences from another result, apart from frames and numbers of the stations.
    pub fn says_else(&self, other: &Self, within: Within) -> Vec<String> {
        let mut all = Vec::new();
        if self.verdict != other.verdict {
            all.push(format!("{:?}, not {:?}", self.verdict, other.verdict));
        }
        if self.checked_by != other.checked_by {
            all.push(format!("checked by {:?}, not {:?}", self.checked_by, other.checked_by));
        }
        // With an unconstrained direction, any position along it is equally good, and findings for that position apply to no other.
        if self.verdict == Verdict::Degenerate {
            return all;
        }
        let (own, others) = (self.sayings(), other.sayings());
        all.extend(own.iter().filter(|s| !others.contains(s)).map(|s| format!("new: {s}")));
        all.extend(others.iter().filter(|s| !own.contains(s)).map(|s| format!("missing: {s}")));
        let far = |(a, b): &(&f64, &f64)| (*a - *b).abs() > within.millimetres;
        let metrics = self.metrics_mm.iter().zip(&other.metrics_mm);
        all.extend(metrics.filter(far).map(|(a, b)| format!("{a} mm, not {b}")));
        match (&self.published, &other.published) {
            (Some(own), Some(others)) => {
                let beside = own.says_else(others, within);
                all.extend(beside.into_iter().map(|what| format!("the paper's: {what}")));
            }
            (None, None) => {}
            _ => all.push("only one has the paper's answer beside it".to_owned()),
        }
        all
    }

    fn sayings(&self) -> Vec<String> {
        let each = self.findings.iter();
        let mut all: Vec<_> = each
            .map(|f| format!("{:?} {} {} {:?}", f.severity, f.doubt, f.words, f.remedies))
            .collect();
        all.sort();
        all
    }

    /// Returns the findings with other numbers, beyond one in the last digit or a hundredth.
    pub fn tells_other_numbers(&self, other: &Self) -> Vec<String> {
        let far = |(a, b): &(&Said, &Said)| {
            let both = a.numbers.iter().zip(&b.numbers);
            both.into_iter().any(|(x, y)| (x - y).abs() > 0.011 * x.abs().max(1.0))
        };
        let both = self.findings.iter().zip(&other.findings).filter(far);
        both.map(|(a, b)| format!("{a:?}, not {b:?}")).collect()
    }

    /// Returns the differences from the expected transforms.
    pub fn stands_elsewhere(
        &self,
        transforms: &PerStation<RigidTransform>,
        covariance: Option<&DMatrix<f64>>,
        within: Within,
    ) -> Vec<String> {
        let mut all = Vec::new();
        if self.verdict == Verdict::Degenerate {
            return all;
        }
        let sigma = self.covariance.as_ref().map(|c| c.diagonal().map(|v| v.max(0.0).sqrt()));
        for station in 1..3 {
            let (found, expected) = (&self.transforms[station], &transforms[station]);
            let metres = found.translation_m - expected.translation_m;
            let turned = wrap_to_pi(found.yaw_rad() - expected.yaw_rad());
            for (k, off) in [metres.x, metres.y, metres.z, turned].into_iter().enumerate() {
                let sigma = sigma.as_ref().map_or(0.0, |sigma| sigma[4 * (station - 1) + k]);
                if off.abs() > (within.sigmas * sigma).max(within.metres) {
                    let (which, number) = (["x", "y", "z", "yaw"][k], station + 1);
                    let sigmas = off / sigma;
                    all.push(format!(
                        "{which} of station {number} off by {off:.1e}, {sigmas:.1e} σ"
                    ));
                }
            }
        }
        if let (Some(found), Some(expected)) = (&self.covariance, covariance) {
            let off = DMatrix::from_fn(expected.nrows(), expected.ncols(), |i, j| {
                let scale = (expected[(i, i)] * expected[(j, j)]).sqrt();
                (found[(i, j)] - expected[(i, j)]) / scale
            });
            if off.amax() > within.covariance {
                all.push(format!("covariance off by {:.1e} σ²", off.amax()));
            }
        } else if self.covariance.is_some() != covariance.is_some() {
            all.push("only one has a covariance".to_owned());
        }
        all
    }
}
