//! The paper's four calibration methods and the joint estimate, and the methods that a deployment allows.

use crate::deployment::kinds;
use std::fmt;

use serde::{Deserialize, Serialize};

use super::followed_prisms::{PrismAssignment, followed_prisms, schedule};
use crate::deployment::{ControlPoint, ControlPointSet, Deployment, Finding};
use crate::network::{Number, Pair, PerStation, Prism, PrismSchedule, Station};
use crate::pipeline::Triplets;

/// Fewest control points that determine an answer of method B.
pub const FEWEST_POINTS: usize = 3;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// A: two points whose relative position is known.
    TwoPoint,
    /// B: static control points.
    StaticGcp,
    /// C: one moving prism that all stations follow.
    DynamicGcp,
    /// D: prisms of a rig with known distances.
    InterPrism,
    /// Beyond the paper: estimates the errors that bias C or D, such as clock offsets, with the transforms, for one prism or several.
    #[default]
    Joint,
}

impl Method {
    pub const ALL: [Self; 5] =
        [Self::TwoPoint, Self::StaticGcp, Self::DynamicGcp, Self::InterPrism, Self::Joint];

    /// Returns the method's name in files and scripts.
    pub fn name(self) -> &'static str {
        match self {
            Self::TwoPoint => "two-point",
            Self::StaticGcp => "static-gcp",
            Self::DynamicGcp => "dynamic-gcp",
            Self::InterPrism => "inter-prism",
            Self::Joint => "joint",
        }
    }

    /// Returns the paper's letter for the method; `None` if the paper does not have it.
    pub fn letter(self) -> Option<char> {
        match self {
            Self::TwoPoint => Some('A'),
            Self::StaticGcp => Some('B'),
            Self::DynamicGcp => Some('C'),
            Self::InterPrism => Some('D'),
            Self::Joint => None,
        }
    }

    /// Returns "D", or "joint", for narrow columns.
    pub fn short_name(self) -> String {
        self.letter().map_or_else(|| self.name().to_owned(), String::from)
    }

    /// Returns "D  inter-prism distances", or "joint estimate", for lists.
    pub fn label(self) -> String {
        match self.letter() {
            Some(letter) => format!("{letter}  {}", self.title()),
            None => self.title().to_owned(),
        }
    }

    /// Returns "method D, inter-prism distances", or "the joint estimate", for sentences.
    pub fn in_words(self) -> String {
        match self.letter() {
            Some(_) => format!("{self}, {}", self.title()),
            None => self.to_string(),
        }
    }

    /// Returns true if its answer is about the frames of the tracks; that of other methods is about the frames of the control
    /// points.
    pub fn is_from_tracks(self) -> bool {
        matches!(self, Self::DynamicGcp | Self::InterPrism | Self::Joint)
    }

    /// Returns the method's name in words, without its letter.
    pub fn title(self) -> &'static str {
        match self {
            Self::TwoPoint => "two-point resection",
            Self::StaticGcp => "static control points",
            Self::DynamicGcp => "dynamic control points",
            Self::InterPrism => "inter-prism distances",
            Self::Joint => "joint estimate",
        }
    }
}

/// Writes "method D", or "the joint estimate".
impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.letter() {
            Some(letter) => write!(f, "method {letter}"),
            None => write!(f, "the {}", self.title()),
        }
    }
}

/// Methods that a deployment allows.
#[derive(Clone, Debug, PartialEq)]
pub struct Offer {
    /// The prism that each station follows.
    pub followed: PerStation<Prism>,
    /// True if it is not known whether all follow one prism ([`PrismAssignment::is_undecided`]).
    pub is_undecided: bool,
    /// The data that is missing for each method, in words, in the order of [`Method::ALL`]; `None` if the method can run.
    pub lacks: [Option<String>; Method::ALL.len()],
}

impl Offer {
    pub fn of(deployment: &Deployment, triplets: &Triplets) -> Self {
        let all = triplets.of_all_readings.as_deref().unwrap_or(triplets);
        let followed = followed_prisms(deployment, all);
        let lacks = Method::ALL.map(|method| {
            let triplets = if method == Method::Joint { all } else { triplets };
            lack(method, deployment, triplets, &followed)
        });
        let PrismAssignment { by_station, is_undecided } = followed;
        Self { followed: by_station, is_undecided, lacks }
    }

    pub fn lack(&self, method: Method) -> Option<&str> {
        self.lacks[method as usize].as_deref()
    }

    /// Returns the paper's method for this drive, from which the joint estimate starts: D, or C where all stations follow one
    /// prism.
    pub fn published_method(&self) -> Method {
        published_method(&self.followed)
    }

    /// Returns the method of the first answer: the paper's, or the joint estimate of one station, whose track no method of the paper
    /// calibrates.
    pub fn first_method(&self) -> Method {
        if self.followed.len() == 1 { Method::Joint } else { self.published_method() }
    }
}

fn published_method(followed: &PerStation<Prism>) -> Method {
    if Prism::is_one(followed) { Method::DynamicGcp } else { Method::InterPrism }
}

fn lack(
    method: Method,
    deployment: &Deployment,
    triplets: &Triplets,
    followed: &PrismAssignment,
) -> Option<String> {
    let no_triplets = || Some(format!("triplets: {}", why_no_triplets(deployment)));
    let is_one_station = deployment.tracks.len() == 1;
    let another_station = || Some("the readings of another station".to_owned());
    match method {
        Method::TwoPoint => {
            let known = |set: &&ControlPointSet| {
                set.points.iter().filter(|point| point.serves_resection()).count() >= 2
            };
            (!deployment.control_points.iter().any(|set| known(&set))).then(|| {
                "two points with known coordinates that every station measured (pillars.csv with Two_points.txt, or a \
                 table file,marker_number,x_m,y_m,z_m)"
                    .to_owned()
            })
        }
        Method::StaticGcp => {
            let is_read = |point: &ControlPoint, station: Station| {
                point.readings.get(station).is_some_and(Option::is_some)
            };
            let shared = |station: Station| {
                let both = |point: &&ControlPoint| {
                    is_read(point, Station::FIRST) && is_read(point, station)
                };
                let sets = deployment.control_points.iter().filter(|set| !set.pillars);
                sets.flat_map(|set| &set.points).filter(both).count()
            };
            let others = deployment.tracks.numbers().skip(1);
            let Some((fewest, station)) = others.map(|other| (shared(other), other)).min() else {
                return another_station();
            };
            (fewest < FEWEST_POINTS).then(|| {
                format!(
                    "{FEWEST_POINTS} control points that all stations measured (stations 1 and {station} share {fewest} here)"
                )
            })
        }
        Method::DynamicGcp if is_one_station => another_station(),
        Method::DynamicGcp if triplets.is_empty() => no_triplets(),
        Method::DynamicGcp => {
            let is_possible = followed.is_undecided || Prism::is_one(&followed.by_station);
            (!is_possible)
                .then(|| "one prism that all stations follow; here they follow several".to_owned())
        }
        Method::InterPrism => {
            if Prism::is_one(&followed.by_station) && is_one_station {
                another_station()
            } else if Prism::is_one(&followed.by_station) {
                Some("a prism for each station; here all stations follow one".to_owned())
            } else if triplets.is_empty() {
                no_triplets()
            } else {
                lacking_distances(deployment, &schedule(deployment, &followed.by_station))
            }
        }
        Method::Joint => {
            let of_published = match published_method(&followed.by_station) {
                // One station has a joint estimate of its instrument, but no answer of method C.
                Method::DynamicGcp if is_one_station => {
                    no_triplets().filter(|_| triplets.is_empty())
                }
                published => lack(published, deployment, triplets, followed),
            };
            let schedule = schedule(deployment, &followed.by_station);
            let needs_rig = !schedule.is_constant() && schedule.prisms().len() > 1;
            of_published.or_else(|| lacking_distances(deployment, &schedule).filter(|_| needs_rig))
        }
    }
}

/// Returns the distances of the rig that are missing between followed prisms.
fn lacking_distances(deployment: &Deployment, followed: &PrismSchedule) -> Option<String> {
    let Some(rig) = &deployment.rig else {
        let files = "calibration_results.csv, or another file of the rig";
        return Some(format!("the inter-prism distances ({files})"));
    };
    let prisms = Pair::prisms_of(rig.inter_prism_m.len()).unwrap_or(1);
    let all = followed.prisms();
    let beyond = all.iter().find(|prism| prism.index() >= prisms)?;
    Some(format!("the distances of prism {beyond} (the rig has those of {prisms} prisms)"))
}

/// Returns the reason why there are no triplets, with a remedy.
pub fn why_no_triplets(deployment: &Deployment) -> String {
    if deployment.ground_truth.is_some() {
        return "it is a trajectory of another system, without readings of stations".to_owned();
    }
    let is_cause = |finding: &&Finding| finding.kind == kinds::STATIONS_WITHOUT_COMMON_TIME;
    match deployment.tracks.iter().position(|track| track.measurements.is_empty()) {
        Some(station) => format!(
            "station {} has no measurement; to calibrate without it, list the others in deployment.toml (stations = {})",
            station + 1,
            deployment.numbers_with_readings()
        ),
        None if let Some(cause) = deployment.findings.iter().find(is_cause) => cause.to_string(),
        None => "the stations never measured together for longer than τ_l; relax τ_s, τ_l or the outlier filter"
            .to_owned(),
    }
}
