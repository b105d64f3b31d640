//! One answer as plain data: what a pin and the history of runs remember of it, and what a session file keeps.

use nalgebra::{Quaternion, Rotation3, SMatrix, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use resect_core::analysis::{Analysis, Answer, Settings};
use resect_core::calibration::{Method, Targets, TransformSigma, Verdict};
use resect_core::deployment::{Deployment, Severity};
use resect_core::evaluation::answer_rows::{AnswerRow, estimate_rows};
use resect_core::evaluation::{ControlPointMetric, Spread};
use resect_core::geometry::RigidTransform;

/// An answer without its triplets and residuals: small, and the same after a round through TOML.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ResultSummary {
    pub deployment: String,
    /// Raw readings of stations 1, 2, 3; with the name, what tells one deployment's data from another's.
    pub readings: [usize; 3],
    pub method: Method,
    pub verdict: Verdict,
    /// Whether something that the answer does not rest on agrees with it; not in sessions of older versions.
    #[serde(default)]
    pub independently_checked: bool,
    /// What limits the answer, in words: its findings above a note.
    pub doubts: Vec<String>,
    pub triplets: usize,
    /// All stations followed one prism: the inter-prism metric compares its versions.
    pub one_prism: bool,
    /// What was found of stations 2 and 3.
    pub stations: [StationSummary; 2],
    /// Covariance of (x, y, z, yaw) of station 2, then of station 3 (m, rad).
    pub covariance: Option<[[f64; 8]; 8]>,
    /// |distance error| pooled over the pairs (mm).
    pub inter_prism_mm: Option<Spread>,
    /// The control-point metric of each file of control points (mm).
    pub control_points_mm: Vec<ControlPointMetric>,
    /// The estimates beside the transforms; not in sessions of older versions.
    #[serde(default)]
    pub estimates: Vec<AnswerRow>,
    pub settings: Settings,
}

/// `station1_from_station` of one station, with its σ.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StationSummary {
    /// The station, 2 or 3.
    pub station: usize,
    pub translation_m: [f64; 3],
    /// The whole rotation (x, y, z, w); its yaw is [`StationSummary::yaw_rad`].
    pub quaternion_xyzw: [f64; 4],
    /// One σ of x, y, z (m) and yaw (rad); `None` when the data leaves a direction free.
    pub sigma: Option<[f64; 4]>,
}

impl ResultSummary {
    pub fn of(deployment: &Deployment, analysis: &Analysis, answer: &Answer) -> Self {
        let Answer { calibration, evaluation, .. } = answer;
        let doubts = calibration.findings.iter().filter(|one| one.severity > Severity::Note);
        Self {
            deployment: deployment.name.clone(),
            readings: deployment.tracks.each_ref().map(|track| track.measurements.len()),
            method: calibration.method,
            verdict: calibration.verdict,
            independently_checked: calibration.is_independently_checked(),
            doubts: doubts.map(ToString::to_string).collect(),
            triplets: analysis.pipeline.triplets.len(),
            one_prism: analysis.offer.targets == Targets::OnePrism,
            stations: std::array::from_fn(|k| {
                let transform = &calibration.station1_from_station[k + 1];
                let sigma = calibration.sigma.map(|sigma| sigma[k]);
                StationSummary::new(k + 2, transform, sigma)
            }),
            covariance: calibration.covariance.map(|covariance| {
                std::array::from_fn(|row| std::array::from_fn(|column| covariance[(row, column)]))
            }),
            inter_prism_mm: evaluation.inter_prism_mm,
            control_points_mm: evaluation.control_points_mm.clone(),
            estimates: estimate_rows(deployment, calibration),
            settings: analysis.settings,
        }
    }

    /// "good", "good, not independently checked", "weak" …
    pub fn verdict_in_words(&self) -> String {
        self.verdict.in_words(self.independently_checked)
    }

    /// The file of control points whose median is the largest.
    pub fn worst_control_points(&self) -> Option<&ControlPointMetric> {
        ControlPointMetric::worst(&self.control_points_mm)
    }

    /// Whether two answers come from the same measurements, as far as their names and counts tell.
    pub fn has_same_data(&self, other: &Self) -> bool {
        self.deployment == other.deployment && self.readings == other.readings
    }

    /// Whether it comes from this deployment's measurements, as far as name and counts tell.
    pub fn is_of(&self, deployment: &Deployment) -> bool {
        let readings = deployment.tracks.each_ref().map(|track| track.measurements.len());
        self.deployment == deployment.name && self.readings == readings
    }

    /// [`ResultSummary::covariance`] as a matrix.
    pub fn covariance_matrix(&self) -> Option<SMatrix<f64, 8, 8>> {
        let rows = self.covariance?;
        Some(SMatrix::from_fn(|row, column| rows[row][column]))
    }
}

impl StationSummary {
    /// The summary of station 2 or 3, by its number.
    pub fn new(
        station: usize,
        station1_from_station: &RigidTransform,
        sigma: Option<TransformSigma>,
    ) -> Self {
        let rotation =
            UnitQuaternion::from_rotation_matrix(&station1_from_station.rotation).into_inner();
        // Of the two quaternions of a rotation, the one with w ≥ 0, so that equal rotations look equal.
        let rotation = if rotation.w < 0.0 { -rotation } else { rotation };
        Self {
            station,
            translation_m: station1_from_station.translation_m.into(),
            // No negative zeros either.
            quaternion_xyzw: rotation.coords.map(|part| part + 0.0).into(),
            sigma: sigma
                .map(|TransformSigma { translation_m: t, yaw_rad }| [t.x, t.y, t.z, yaw_rad]),
        }
    }

    /// Maps this station's frame into station 1's.
    pub fn station1_from_station(&self) -> RigidTransform {
        let rotation =
            UnitQuaternion::from_quaternion(Quaternion::from_vector(self.quaternion_xyzw.into()));
        RigidTransform {
            rotation: Rotation3::from(rotation),
            translation_m: Vector3::from(self.translation_m),
        }
    }

    /// Rotation about z, the last of roll, pitch and yaw; in [−π, π].
    pub fn yaw_rad(&self) -> f64 {
        self.station1_from_station().yaw_rad()
    }

    /// One σ of the transform; `None` when the data leaves a direction free.
    pub fn transform_sigma(&self) -> Option<TransformSigma> {
        let [x, y, z, yaw_rad] = self.sigma?;
        Some(TransformSigma { translation_m: Vector3::new(x, y, z), yaw_rad })
    }

    /// The transform's name: "T12" or "T13".
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

    fn summary(settings: &Settings) -> (ResultSummary, [RigidTransform; 3]) {
        let deployment = Sample::Warthog.open().expect("built in");
        let analysis = Analyst::new(deployment.clone().into()).run(settings);
        let answer = analysis.answer.as_ref().expect("an answer");
        let transforms = answer.calibration.station1_from_station;
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
        for (kept, whole) in summary.stations.iter().zip(&transforms[1..]) {
            assert!(whole.tilt_rad() > 1e-7, "the sample's control points are noisy");
            let off = kept.station1_from_station().matrix() - whole.matrix();
            assert!(off.norm() < 1e-12, "{off}");
            // Of its two quaternions the one that everybody writes, also where the yaw is beyond 90 degrees.
            assert!(kept.quaternion_xyzw[3] >= 0.0, "{:?}", kept.quaternion_xyzw);
        }
    }
}
