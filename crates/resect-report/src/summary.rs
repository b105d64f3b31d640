//! One answer as plain data, for pins, the history of runs and session files.

use nalgebra::{DMatrix, Quaternion, Rotation3, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use super::rows;
use resect_core::analysis::{Analysis, Answer, Settings};
use resect_core::calibration::{Calibration, Method, TransformSigma, Verdict};
use resect_core::deployment::{Deployment, Severity};
use resect_core::evaluation::answer_rows::{AnswerRow, estimate_rows};
use resect_core::evaluation::{ControlPointMetric, Spread};
use resect_core::geometry::RigidTransform;
use resect_core::network::{PerStation, Prism, Station};

/// An answer without its triplets and residuals: small, and unchanged by a round trip through TOML.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ResultSummary {
    pub deployment: String,
    /// Numbers of raw readings of the stations; with the name they identify the data.
    pub readings: PerStation<usize>,
    /// The requested method.
    pub method: Method,
    /// The published method that answers instead of a joint estimate that failed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fallback: Option<Method>,
    pub verdict: Verdict,
    /// True if data that the answer does not use confirms it; missing in sessions of older versions.
    #[serde(default)]
    pub independently_checked: bool,
    /// Findings above a note, in words, which limit the answer.
    pub doubts: Vec<String>,
    pub triplets: usize,
    /// True if all stations followed one prism: the inter-prism metric then compares the stations' positions of it.
    pub one_prism: bool,
    /// Transforms of stations 2, 3, …
    pub stations: Vec<StationSummary>,
    /// Covariance of (x, y, z, yaw) of station 2, then of station 3, … (m, rad), by rows.
    pub covariance: Option<Vec<Vec<f64>>>,
    /// Absolute distance errors pooled over the pairs (mm).
    pub inter_prism_mm: Option<Spread>,
    /// Control-point metric by file (mm).
    pub control_points_mm: Vec<ControlPointMetric>,
    /// Estimates besides the transforms; missing in sessions of older versions.
    #[serde(default)]
    pub estimates: Vec<AnswerRow>,
    pub settings: Settings,
}

/// `station1_from_station` of one station, with its σ.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StationSummary {
    /// The station, from 2 on.
    pub station: usize,
    pub translation_m: [f64; 3],
    /// Complete rotation (x, y, z, w); its yaw is [`StationSummary::yaw_rad`].
    pub quaternion_xyzw: [f64; 4],
    /// σ of x, y, z (m) and yaw (rad); `None` if a direction is unobservable.
    pub sigma: Option<[f64; 4]>,
}

impl ResultSummary {
    pub fn of(deployment: &Deployment, analysis: &Analysis, answer: &Answer) -> Self {
        let Answer { calibration, evaluation, .. } = answer;
        let doubts = calibration.findings.iter().filter(|one| one.severity > Severity::Note);
        Self {
            deployment: deployment.name.clone(),
            readings: deployment.tracks.map(|track| track.measurements.len()),
            method: calibration.method,
            fallback: calibration.joint_failure().map(|_| calibration.answered_by()),
            verdict: calibration.verdict,
            independently_checked: calibration.is_independently_checked(),
            doubts: doubts.map(ToString::to_string).collect(),
            triplets: analysis.pipeline.triplets.len(),
            one_prism: Prism::is_one(&analysis.offer.followed),
            stations: StationSummary::of(calibration),
            covariance: calibration.covariance.as_ref().map(rows::of_matrix),
            inter_prism_mm: evaluation.inter_prism_mm,
            control_points_mm: evaluation.control_points_mm.clone(),
            estimates: estimate_rows(deployment, calibration),
            settings: analysis.settings,
        }
    }

    /// Returns the method of the answer: the published one if the joint estimate failed.
    pub fn answered_by(&self) -> Method {
        self.fallback.unwrap_or(self.method)
    }

    /// Returns "good", "good, not independently checked", "weak" …
    pub fn verdict_in_words(&self) -> String {
        self.verdict.in_words(self.independently_checked)
    }

    /// Returns the file of control points with the largest median.
    pub fn worst_control_points(&self) -> Option<&ControlPointMetric> {
        ControlPointMetric::worst(&self.control_points_mm)
    }

    /// Returns true if two answers use the same readings, judged by their names and counts.
    pub fn has_same_data(&self, other: &Self) -> bool {
        self.deployment == other.deployment && self.readings == other.readings
    }

    /// Returns true if the answer uses this deployment's readings, judged by name and counts.
    pub fn is_of(&self, deployment: &Deployment) -> bool {
        let readings = deployment.tracks.map(|track| track.measurements.len());
        self.deployment == deployment.name && self.readings == readings
    }

    /// Returns [`ResultSummary::covariance`] as a matrix.
    pub fn covariance_matrix(&self) -> Option<DMatrix<f64>> {
        let rows = self.covariance.as_ref()?;
        Some(DMatrix::from_fn(rows.len(), rows.len(), |row, column| rows[row][column]))
    }
}

impl StationSummary {
    /// Summarises the transforms of stations 2, 3, …
    pub fn of(calibration: &Calibration) -> Vec<Self> {
        let transforms = calibration.station1_from_station.each().skip(1);
        let summary = |(station, transform): (Station, &RigidTransform)| {
            let sigma = calibration.sigma.as_ref().map(|sigma| sigma[station]);
            Self::new(station.number(), transform, sigma)
        };
        transforms.map(summary).collect()
    }

    /// Summarises the transform of a station, by its number (from 1).
    pub fn new(
        station: usize,
        station1_from_station: &RigidTransform,
        sigma: Option<TransformSigma>,
    ) -> Self {
        let rotation =
            UnitQuaternion::from_rotation_matrix(&station1_from_station.rotation).into_inner();
        // A rotation has two quaternions; the one with w ≥ 0 makes equal rotations look equal.
        let rotation = if rotation.w < 0.0 { -rotation } else { rotation };
        Self {
            station,
            translation_m: station1_from_station.translation_m.into(),
            // Adding zero removes negative zeros.
            quaternion_xyzw: rotation.coords.map(|part| part + 0.0).into(),
            sigma: sigma
                .map(|TransformSigma { translation_m: t, yaw_rad }| [t.x, t.y, t.z, yaw_rad]),
        }
    }

    /// Returns the transform from this station's frame to station 1's.
    pub fn station1_from_station(&self) -> RigidTransform {
        let rotation =
            UnitQuaternion::from_quaternion(Quaternion::from_vector(self.quaternion_xyzw.into()));
        RigidTransform {
            rotation: Rotation3::from(rotation),
            translation_m: Vector3::from(self.translation_m),
        }
    }

    /// Rotation about z, the last of roll, pitch and yaw (rad); in [−π, π].
    pub fn yaw_rad(&self) -> f64 {
        self.station1_from_station().yaw_rad()
    }

    /// Returns σ of the transform; `None` if a direction is unobservable.
    pub fn transform_sigma(&self) -> Option<TransformSigma> {
        let [x, y, z, yaw_rad] = self.sigma?;
        Some(TransformSigma { translation_m: Vector3::new(x, y, z), yaw_rad })
    }

    /// The transform's name: "T12", "T13" …
    pub fn name(&self) -> String {
        format!("T1{}", self.station)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use resect_core::analysis::Analyst;
    use resect_core::calibration::Alignment;
    use resect_io::sample::Sample;

    fn summary(settings: &Settings) -> (ResultSummary, PerStation<RigidTransform>) {
        let deployment = Sample::Warthog.open().expect("built in");
        let analysis = Analyst::new(deployment.clone().into()).run(settings);
        let answer = analysis.answer.as_ref().expect("an answer");
        let transforms = answer.calibration.station1_from_station.clone();
        (ResultSummary::of(&deployment, &analysis, answer), transforms)
    }

    #[test]
    fn nothing_is_lost_on_the_way_through_a_file() {
        let (summary, _) = summary(&Settings::default());
        assert!(summary.covariance.is_some() && !summary.control_points_mm.is_empty());
        let text = toml::to_string(&summary).expect("plain data");
        assert_eq!(toml::from_str::<ResultSummary>(&text).expect("its own text"), summary);
    }

    #[test]
    fn a_rigid_answer_keeps_its_tilt() {
        let mut settings = Settings::default();
        settings.calibration.method = Some(Method::StaticGcp);
        settings.calibration.alignment = Alignment::Rigid;
        let (summary, transforms) = summary(&settings);
        for (kept, whole) in summary.stations.iter().zip(transforms.iter().skip(1)) {
            assert!(whole.tilt_rad() > 1e-7, "the sample's control points are noisy");
            let off = kept.station1_from_station().matrix() - whole.matrix();
            assert!(off.norm() < 1e-12, "{off}");
            // The quaternion has w ≥ 0, also if the yaw is beyond 90 degrees.
            assert!(kept.quaternion_xyzw[3] >= 0.0, "{:?}", kept.quaternion_xyzw);
        }
    }
}
