//! Numbers of an answer as rows, described once for every table.
//!
//! Terminal, JSON, HTML report, CSV, result pane and comparisons render these rows. A new estimate needs a row here only.

use crate::network::{Number, Pair, Prism};
use serde::{Deserialize, Serialize};

use super::Evaluation;
use crate::calibration::joint::JointEstimate;
use crate::calibration::joint::instrument_errors::instrument_errors;
use crate::calibration::{Calibration, Estimate, Quantity, SUPPORTED_SIGMAS, TransformSigma};
use crate::deployment::Deployment;
use crate::geometry::{RigidTransform, wrap_to_pi};
use crate::network::PerStation;

/// Names and symbols of the numbers of a transform.
const TRANSFORM_NUMBERS: [(&str, &str); 6] =
    [("x", "x"), ("y", "y"), ("z", "z"), ("yaw", "ψ"), ("roll", "φ"), ("pitch", "θ")];

/// The kind of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RowGroup {
    /// Frames of the other stations in station 1's.
    Transforms,
    /// Differences of the same frames between survey and drive, if a set-up changed.
    Survey,
    /// Distances between prisms.
    Distances,
    /// Clocks of the other stations against station 1's.
    Clocks,
    /// Errors of the instruments.
    Instruments,
    /// Standard deviations of the readings' noise.
    Noise,
    /// Sizes of errors: the paper's two metrics.
    Metrics,
}

impl RowGroup {
    pub fn name(self) -> &'static str {
        match self {
            Self::Transforms => "transforms",
            Self::Survey => "survey",
            Self::Distances => "distances",
            Self::Clocks => "clocks",
            Self::Instruments => "instruments",
            Self::Noise => "noise",
            Self::Metrics => "metrics",
        }
    }

    /// Returns true if the rows are estimates other than the transforms.
    pub fn is_beside_transforms(self) -> bool {
        matches!(self, Self::Survey | Self::Distances | Self::Clocks | Self::Instruments)
    }
}

/// The value that a row is compared with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReferenceValue {
    /// "measured", or "method D".
    pub name: String,
    pub value: f64,
}

/// One number of an answer, in SI units (m, rad, s, s/s, ratios).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AnswerRow {
    pub group: RowGroup,
    /// "T12", "station 2", "prisms 1–2", or a file of control points.
    pub subject: String,
    pub name: String,
    pub symbol: String,
    pub quantity: Quantity,
    pub value: f64,
    /// One standard deviation; `None` for an unobservable direction, and for numbers without σ.
    pub sigma: Option<f64>,
    /// Standard deviation before this drive.
    pub prior: Option<f64>,
    /// `None` if the value is compared with zero.
    pub reference: Option<ReferenceValue>,
    /// True if the value differs significantly from its reference.
    pub is_significant: bool,
}

impl AnswerRow {
    /// Returns the value minus its reference.
    pub fn deviation(&self) -> f64 {
        let off = self.value - self.reference.as_ref().map_or(0.0, |reference| reference.value);
        if self.quantity == Quantity::Angle { wrap_to_pi(off) } else { off }
    }

    /// Returns the deviation over σ, with its sign.
    pub fn deviation_sigmas(&self) -> Option<f64> {
        self.sigma.filter(|sigma| *sigma > 0.0).map(|sigma| self.deviation() / sigma)
    }

    /// Returns true if the other row is the same number of another answer.
    pub fn is_same_number(&self, other: &Self) -> bool {
        (self.group, &self.subject, &self.name) == (other.group, &other.subject, &other.name)
    }
}

/// Returns all rows of an answer.
pub fn answer_rows(
    deployment: &Deployment,
    calibration: &Calibration,
    evaluation: &Evaluation,
    followed: &PerStation<Prism>,
) -> Vec<AnswerRow> {
    let mut rows = transform_rows(calibration);
    rows.extend(estimate_rows(deployment, calibration));
    rows.extend(noise_rows(calibration));
    rows.extend(metric_rows(evaluation, followed));
    rows
}

/// Returns x, y, z and yaw of stations 2, 3, …, with roll and pitch where an answer is not level.
///
/// A joint estimate is compared with the published method.
pub fn transform_rows(calibration: &Calibration) -> Vec<AnswerRow> {
    let transforms = &calibration.station1_from_station;
    let is_tilted = transforms.iter().skip(1).any(|transform| transform.tilt_rad() > 0.0);
    // An answer of the published method does not differ from itself.
    let has_failed = calibration.joint_failure().is_some();
    let published = calibration.published.as_deref().filter(|_| !has_failed);
    let mut rows = Vec::new();
    for station in 1..transforms.len() {
        let number = station + 1;
        let numbers =
            |calibration: &Calibration| numbers_of(&calibration.station1_from_station[station]);
        let values = numbers(calibration);
        let before = published.map(|published| (published.method.to_string(), numbers(published)));
        let sigmas = sigmas_of(calibration.sigma.as_ref(), station);
        for (place, (name, symbol)) in TRANSFORM_NUMBERS.into_iter().enumerate() {
            if place > 3 && !is_tilted {
                break;
            }
            let row = AnswerRow {
                group: RowGroup::Transforms,
                subject: format!("T1{number}"),
                name: name.to_owned(),
                symbol: indexed(symbol, &[number]),
                quantity: if place < 3 { Quantity::Length } else { Quantity::Angle },
                value: values[place],
                sigma: sigmas.get(place).copied().flatten(),
                prior: None,
                reference: before.as_ref().map(|(name, values)| ReferenceValue {
                    name: name.clone(),
                    value: values[place],
                }),
                is_significant: false,
            };
            rows.push(row);
        }
    }
    rows
}

/// Returns x, y, z, yaw, roll and pitch of a transform.
fn numbers_of(transform: &RigidTransform) -> [f64; 6] {
    let (roll, pitch, _) = transform.rotation.euler_angles();
    let t = transform.translation_m;
    [t.x, t.y, t.z, transform.yaw_rad(), roll, pitch]
}

/// Returns σ of x, y, z and yaw of a station (from 0).
fn sigmas_of(sigma: Option<&PerStation<TransformSigma>>, station: usize) -> [Option<f64>; 4] {
    let sigma = sigma.map(|sigma| sigma[station]);
    [0, 1, 2, 3]
        .map(|place| sigma.map(|s| if place == 3 { s.yaw_rad } else { s.translation_m[place] }))
}

/// Returns x, y, z and yaw of stations 2, 3, … at the survey less those of the drive; empty unless a set-up changed.
fn survey_rows(calibration: &Calibration) -> Vec<AnswerRow> {
    let changed = |joint: &&JointEstimate| joint.set_up_change().is_some();
    let Some(survey) = calibration.joint().filter(changed).and_then(|joint| joint.survey.as_ref())
    else {
        return Vec::new();
    };
    let mut rows = Vec::new();
    for station in 1..calibration.station1_from_station.len() {
        let [at_survey, of_drive] = [&survey.transforms(), &calibration.station1_from_station]
            .map(|transforms| numbers_of(&transforms[station]));
        let sigmas =
            [Some(&survey.sigma()), calibration.sigma.as_ref()].map(|all| sigmas_of(all, station));
        for (place, (name, symbol)) in TRANSFORM_NUMBERS.into_iter().take(4).enumerate() {
            let off = at_survey[place] - of_drive[place];
            let value = if place < 3 { off } else { wrap_to_pi(off) };
            // Errors that both have in common cancel, so this is an upper limit.
            let [survey_sigma, drive_sigma] = sigmas.map(|all| all[place].unwrap_or(0.0));
            let estimate = Estimate { value, sigma: survey_sigma.hypot(drive_sigma) };
            let subject = format!("T1{}", station + 1);
            let mut row = AnswerRow {
                name: format!("{name} survey − drive"),
                symbol: format!("Δ{}", indexed(symbol, &[station + 1])),
                quantity: if place < 3 { Quantity::Length } else { Quantity::Angle },
                ..estimated(RowGroup::Survey, subject, estimate)
            };
            row.is_significant = is_far(&row);
            rows.push(row);
        }
    }
    rows
}

/// Returns the estimates other than the transforms of a joint estimate: a change since the survey, clocks and instruments by
/// station, then the distances.
pub fn estimate_rows(deployment: &Deployment, calibration: &Calibration) -> Vec<AnswerRow> {
    let Some(joint) = calibration.joint() else { return Vec::new() };
    let mut rows = survey_rows(calibration);
    for station in 0..calibration.station1_from_station.len() {
        if station > 0 {
            rows.extend(clock_rows(joint, station));
        }
        let errors = instrument_errors(joint);
        rows.extend(errors.iter().filter(|error| error.station.index() == station).map(|error| {
            let symbol = indexed(error.unknown.symbol, &[station + 1]);
            let row = estimated(RowGroup::Instruments, of_station(station), error.estimate);
            AnswerRow {
                name: error.unknown.name.to_owned(),
                symbol,
                quantity: error.unknown.quantity,
                prior: Some(error.prior_sigma),
                is_significant: error.is_significant(),
                ..row
            }
        }));
    }
    let measured_m = deployment.rig.as_ref().map(|rig| &rig.inter_prism_m);
    for (place, distance_m) in joint.distances_m().into_iter().flatten().enumerate() {
        let prisms = joint.layout().pair(Pair::at(place));
        let subject = format!("prisms {prisms}");
        let mut row = AnswerRow {
            name: "distance".to_owned(),
            symbol: indexed("d", &prisms.indices().map(|prism| prism + 1)),
            quantity: Quantity::Length,
            prior: Some(joint.sizes.inter_prism_m),
            reference: measured_m
                .map(|all| ReferenceValue { name: "measured".to_owned(), value: all[prisms] }),
            ..estimated(RowGroup::Distances, subject, distance_m)
        };
        row.is_significant = is_far(&row);
        rows.push(row);
    }
    rows
}

fn clock_rows(joint: &JointEstimate, station: usize) -> Vec<AnswerRow> {
    let row = |name: String, symbol: &str, quantity, estimate, prior| {
        let mut row = AnswerRow {
            name,
            symbol: indexed(symbol, &[station + 1]),
            quantity,
            prior: Some(prior),
            ..estimated(RowGroup::Clocks, of_station(station), estimate)
        };
        row.is_significant = is_far(&row);
        row
    };
    let mut rows = Vec::new();
    for (number, drive) in joint.drives.iter().enumerate() {
        let name = match joint.drives.len() {
            1 => "clock offset".to_owned(),
            _ => format!("clock offset, drive {}", number + 1),
        };
        let prior_s = joint.sizes.clock_offset_s;
        rows.push(row(name, "Δt", Quantity::Time, drive.offsets_s[station], prior_s));
    }
    let (drift, prior) = (joint.clock_drifts()[station], joint.sizes.clock_drift);
    rows.push(row("clock drift".to_owned(), "Δf", Quantity::Drift, drift, prior));
    rows
}

/// Returns the noise levels of the readings by a joint estimate; empty for other methods.
pub fn noise_rows(calibration: &Calibration) -> Vec<AnswerRow> {
    let Some(joint) = calibration.joint() else { return Vec::new() };
    let levels = &joint.levels;
    [
        ("range", "σ_ρ", Quantity::Length, levels.range_m()),
        ("horizontal angle", "σ_h", Quantity::Angle, levels.horizontal_rad),
        ("vertical angle", "σ_v", Quantity::Angle, levels.vertical_rad),
        ("time", "σ_t", Quantity::Time, levels.jitter_s),
        ("slow error of ranges", "σ_sρ", Quantity::Length, joint.slow_ranges.sigma_m),
        ("slow error across the sights", "σ_sh", Quantity::Length, joint.slow_across.sigma_m),
        ("slow error upward", "σ_sv", Quantity::Length, joint.slow_upward.sigma_m),
    ]
    .map(|(name, symbol, quantity, value)| AnswerRow {
        group: RowGroup::Noise,
        subject: "readings".to_owned(),
        name: name.to_owned(),
        symbol: symbol.to_owned(),
        quantity,
        value,
        sigma: None,
        prior: None,
        reference: None,
        is_significant: false,
    })
    .to_vec()
}

/// Returns median and interquartile range of both metrics.
fn metric_rows(evaluation: &Evaluation, followed: &PerStation<Prism>) -> Vec<AnswerRow> {
    let distances = match Prism::is_one(followed) {
        true => "same prism",
        false => "inter-prism distances",
    };
    let measured = "inter-prism distances as measured";
    let both = [(distances, evaluation.inter_prism_mm), (measured, evaluation.against_measured_mm)];
    let both = both.into_iter().filter_map(|(name, spread)| Some((name, spread?)));
    let points = evaluation.control_points_mm.iter();
    let points = points.map(|metric| (metric.file.as_str(), metric.spread));
    let row = |subject: &str, name: &str, mm: f64| AnswerRow {
        group: RowGroup::Metrics,
        subject: subject.to_owned(),
        name: name.to_owned(),
        symbol: String::new(),
        quantity: Quantity::Length,
        value: mm * 1e-3,
        sigma: None,
        prior: None,
        reference: None,
        is_significant: false,
    };
    both.chain(points)
        .flat_map(|(subject, spread)| {
            [row(subject, "median", spread.median), row(subject, "IQR", spread.iqr)]
        })
        .collect()
}

/// A row of an estimate; the caller gives its name, symbol and quantity.
fn estimated(group: RowGroup, subject: String, estimate: Estimate) -> AnswerRow {
    AnswerRow {
        group,
        subject,
        name: String::new(),
        symbol: String::new(),
        quantity: Quantity::Length,
        value: estimate.value,
        sigma: Some(estimate.sigma),
        prior: None,
        reference: None,
        is_significant: false,
    }
}

fn is_far(row: &AnswerRow) -> bool {
    row.deviation_sigmas().is_some_and(|sigmas| sigmas.abs() > SUPPORTED_SIGMAS)
}

fn of_station(station: usize) -> String {
    format!("station {}", station + 1)
}

/// A symbol with subscript digits: "d₁₂".
fn indexed(symbol: &str, numbers: &[usize]) -> String {
    let digits =
        numbers.iter().map(|number| ['₀', '₁', '₂', '₃', '₄', '₅', '₆', '₇', '₈'][*number]);
    symbol.chars().chain(digits).collect()
}
