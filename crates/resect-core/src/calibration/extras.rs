//! What was estimated beside the transforms, as rows of a table.

use super::joint::JointEstimate;
use super::joint::instruments::instruments;
use super::{Calibration, Estimate, Quantity};
use crate::deployment::{Deployment, pair_label};

/// Something that was estimated beside the transforms.
#[derive(Clone, Debug, PartialEq)]
pub struct Extra {
    /// "station 2", "prisms 1–2" or "all stations".
    pub of: String,
    pub name: String,
    pub quantity: Quantity,
    /// How far it is from what is assumed without it.
    pub estimate: Estimate,
    /// One σ of what was known beforehand; `None` where nothing was.
    pub prior: Option<f64>,
    /// Whether the data says that it is not zero.
    pub notable: bool,
}

impl Extra {
    fn new(
        of: String,
        name: impl Into<String>,
        quantity: Quantity,
        estimate: Estimate,
        prior: Option<f64>,
    ) -> Self {
        let notable = estimate.sigmas_from(0.0).abs() > super::estimate::SUPPORTED_SIGMAS;
        Self { of, name: name.into(), quantity, estimate, prior, notable }
    }
}

fn station(index: usize) -> String {
    format!("station {}", index + 1)
}

impl Calibration {
    /// The estimates of a joint estimate beside the transforms: clocks, instruments, inter-prism distances.
    pub fn extras(&self, deployment: &Deployment) -> Vec<Extra> {
        let rig_m = deployment.rig.as_ref().map(|rig| rig.inter_prism_m);
        self.joint().map_or_else(Vec::new, |joint| of_joint(joint, rig_m))
    }
}

fn of_joint(joint: &JointEstimate, rig_m: Option<[f64; 3]>) -> Vec<Extra> {
    let instruments = instruments(joint);
    let mut extras = Vec::new();
    for index in 0..3 {
        if let Some(slot) = usize::checked_sub(index, 1) {
            for (number, drive) in joint.drives.iter().enumerate() {
                let name = match joint.drives.len() {
                    1 => "clock offset".to_owned(),
                    _ => format!("clock offset, drive {}", number + 1),
                };
                let (late_s, prior) = (drive.late_s[slot], Some(joint.sizes.clock_offset_s));
                extras.push(Extra::new(station(index), name, Quantity::Time, late_s, prior));
            }
            let (drift, prior) = (joint.clock_drifts[slot], Some(joint.sizes.clock_drift));
            extras.push(Extra::new(station(index), "clock drift", Quantity::Drift, drift, prior));
        }
        extras.extend(instruments.iter().filter(|error| error.station == index).map(|error| {
            let (kind, known) = (error.kind, Some(error.known));
            let quantity = kind.quantity();
            let row = Extra::new(station(index), kind.name(), quantity, error.estimate, known);
            Extra { notable: error.is_told(), ..row }
        }));
    }
    extras.extend(distances(joint.distances_m, rig_m, joint.sizes.inter_prism_m));
    extras
}

fn distances(
    found_m: Option<[Estimate; 3]>,
    rig_m: Option<[f64; 3]>,
    prior_m: f64,
) -> impl Iterator<Item = Extra> {
    let both = found_m.zip(rig_m);
    (0..3).filter_map(move |pair| {
        let (found_m, rig_m) = both?;
        let Estimate { value, sigma } = found_m[pair];
        let off_m = Estimate { value: value - rig_m[pair], sigma };
        let of = format!("prisms {}", pair_label(pair));
        Some(Extra::new(of, "distance", Quantity::Length, off_m, Some(prior_m)))
    })
}
