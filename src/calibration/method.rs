//! The four calibrations of the paper, and which of them a deployment allows.

use serde::{Deserialize, Serialize};

use super::targets::{Targets, targets};
use crate::deployment::Deployment;
use crate::pipeline::Triplets;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// A: two points whose relative position is known.
    TwoPoint,
    /// B: static control points.
    StaticGcp,
    /// C: one moving prism that all three stations follow.
    DynamicGcp,
    /// D: three prisms of a rig with known distances.
    InterPrism,
}

impl Method {
    pub const ALL: [Self; 4] =
        [Self::TwoPoint, Self::StaticGcp, Self::DynamicGcp, Self::InterPrism];

    /// As scripts write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::TwoPoint => "two-point",
            Self::StaticGcp => "static-gcp",
            Self::DynamicGcp => "dynamic-gcp",
            Self::InterPrism => "inter-prism",
        }
    }

    /// As the paper calls it.
    pub fn letter(self) -> char {
        match self {
            Self::TwoPoint => 'A',
            Self::StaticGcp => 'B',
            Self::DynamicGcp => 'C',
            Self::InterPrism => 'D',
        }
    }

    /// Whether its answer is about the frames of the tracks; that of the others about those of the control points.
    pub fn is_from_tracks(self) -> bool {
        matches!(self, Self::DynamicGcp | Self::InterPrism)
    }

    /// In words.
    pub fn title(self) -> &'static str {
        match self {
            Self::TwoPoint => "two-point resection",
            Self::StaticGcp => "static control points",
            Self::DynamicGcp => "dynamic control points",
            Self::InterPrism => "inter-prism distances",
        }
    }
}

/// Which methods a deployment allows.
#[derive(Clone, Debug, PartialEq)]
pub struct Offer {
    pub targets: Targets,
    /// In the order of [`Method::ALL`]: what the data lacks for the method, in words; `None` where it can run.
    pub lacks: [Option<String>; 4],
}

impl Offer {
    pub fn of(deployment: &Deployment, triplets: &Triplets) -> Self {
        let targets = targets(deployment, triplets);
        Self {
            lacks: Method::ALL.map(|method| lack(method, deployment, triplets, targets)),
            targets,
        }
    }

    pub fn lack(&self, method: Method) -> Option<&str> {
        self.lacks[method as usize].as_deref()
    }

    /// D is what the program is for; one prism for all stations leaves C.
    pub fn default_method(&self) -> Method {
        if self.targets == Targets::OnePrism { Method::DynamicGcp } else { Method::InterPrism }
    }
}

fn lack(
    method: Method,
    deployment: &Deployment,
    triplets: &Triplets,
    targets: Targets,
) -> Option<String> {
    let no_triplets = || Some(format!("triplets: {}", why_no_triplets(deployment)));
    match method {
        Method::TwoPoint => {
            let known = |set: &&crate::deployment::ControlPointSet| {
                set.points.iter().filter(|point| point.serves_resection()).count() >= 2
            };
            (!deployment.control_points.iter().any(|set| known(&set))).then(|| {
                "two points with known coordinates that every station measured (pillars.csv with Two_points.txt, or a \
                 table file,marker_number,x_m,y_m,z_m)"
                    .to_owned()
            })
        }
        Method::StaticGcp => {
            let shared = |station: usize| {
                let both = |p: &&crate::deployment::ControlPoint| {
                    p.readings[0].is_some() && p.readings[station].is_some()
                };
                let sets = deployment.control_points.iter().filter(|set| !set.pillars);
                sets.flat_map(|set| &set.points).filter(both).count()
            };
            let fewest = shared(1).min(shared(2));
            (fewest < super::static_gcp::FEWEST_POINTS).then(|| {
                format!(
                    "{} control points that all stations measured ({fewest} here)",
                    super::static_gcp::FEWEST_POINTS
                )
            })
        }
        Method::DynamicGcp if triplets.is_empty() => no_triplets(),
        Method::DynamicGcp => match targets {
            Targets::ThreePrisms => {
                Some("one prism that all three stations follow; here each has its own".to_owned())
            }
            Targets::OnePrism | Targets::Undecided => None,
        },
        Method::InterPrism => {
            if targets == Targets::OnePrism {
                Some("three prisms; here all three stations follow one".to_owned())
            } else if deployment.rig.is_none() {
                Some("the inter-prism distances (calibration_results.csv, or --rig)".to_owned())
            } else if triplets.is_empty() {
                no_triplets()
            } else {
                None
            }
        }
    }
}

/// Why the pipeline gave nothing, and what to do about it.
pub fn why_no_triplets(deployment: &Deployment) -> String {
    match deployment.tracks.iter().position(|track| track.measurements.is_empty()) {
        Some(station) => format!("station {} has no measurement; all three are needed", station + 1),
        None => "the stations never measured together for longer than τ_l; relax τ_s, τ_l or the outlier filter"
            .to_owned(),
    }
}
