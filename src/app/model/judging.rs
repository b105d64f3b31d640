//! Estimated trajectories of other systems, evaluated against an open deployment.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::background_value::BackgroundValue;
use resect_core::deployment::Deployment;
use resect_core::deployment::names::{told_apart, without_common_words};
use resect_tools::estimates::{
    EstimatedTrajectory, EstimatesJudgement, Judged, Options, TruthReason,
};
use resect_tools::extrinsics::{Extrinsics, NoExtrinsics};

/// Longest name (letters) that keeps the words which all names share.
const LONGEST_NAME: usize = 16;

/// An added trajectory with its options.
#[derive(Clone, Debug)]
pub struct Added {
    /// The trajectory under a short name that is unique among those added.
    pub estimate: Arc<EstimatedTrajectory>,
    /// Name by its file.
    pub full_name: String,
    /// Index of its colour, which does not change when another trajectory is removed.
    pub colour: usize,
    /// Alignment with the ground truth.
    pub options: Options,
    /// True if the scene draws it.
    pub shown: bool,
}

impl PartialEq for Added {
    /// Trajectories are equal if they are from the same reading of the file, with equal options.
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.estimate, &other.estimate)
            && (self.colour, self.options, self.shown) == (other.colour, other.options, other.shown)
    }
}

impl Added {
    /// Returns the trajectory under its name by its file.
    pub fn under_full_name(&self) -> EstimatedTrajectory {
        EstimatedTrajectory {
            name: self.full_name.clone(),
            ..EstimatedTrajectory::clone(&self.estimate)
        }
    }
}

/// A trajectory in a session: its file and options.
#[derive(Clone, Debug, PartialEq)]
pub struct SavedEstimate {
    pub path: PathBuf,
    /// Topic of the trajectory in a bag; `None` for all trajectories in the file.
    pub topic: Option<String>,
    pub options: Options,
    pub shown: bool,
}

/// Added trajectories and their evaluation.
#[derive(Default)]
pub struct Judging {
    /// Added trajectories, without duplicates, in the order of addition.
    pub added: Vec<Added>,
    /// Trajectories of the session that could not be read; the session keeps them.
    pub missing: Vec<SavedEstimate>,
    pub judgement: BackgroundValue<EstimatesJudgement>,
    /// Pose of each body in that of a ground truth that is a trajectory, in the order of `added`, if it is shown.
    pub extrinsics: BackgroundValue<Vec<Result<Extrinsics, NoExtrinsics>>>,
    pub shows_extrinsics: bool,
    /// Name of a trajectory that is the ground truth; `None` for a deployment with readings.
    pub truth_name: Option<String>,
    /// Evidence by which that trajectory is the ground truth; `None` if it was not chosen among several.
    pub truth_reason: Option<TruthReason>,
    /// Number of changes of the trajectories to evaluate.
    pub version: u64,
}

impl Judging {
    /// Returns no trajectories, to be evaluated against a deployment.
    pub fn against(deployment: &Deployment) -> Self {
        let truth_name = deployment.ground_truth.as_ref().map(|truth| truth.name.clone());
        Self { truth_name, ..Self::default() }
    }

    /// Returns the added trajectories together with these, which replace earlier readings of the same file.
    pub fn with(&self, estimates: Vec<Arc<EstimatedTrajectory>>) -> Vec<Added> {
        let mut added = self.added.clone();
        for estimate in estimates {
            match added.iter_mut().find(|one| one.estimate.is_same(&estimate)) {
                Some(old) => old.estimate = estimate,
                None => {
                    let is_free = |colour: &usize| added.iter().all(|one| one.colour != *colour);
                    let colour = (0..).find(is_free).unwrap_or_default();
                    added.push(Added {
                        full_name: estimate.name.clone(),
                        estimate,
                        colour,
                        options: Options::default(),
                        shown: true,
                    });
                }
            }
        }
        let names = self.short_names(&added);
        for (one, name) in added.iter_mut().zip(names) {
            if one.estimate.name != name {
                Arc::make_mut(&mut one.estimate).name = name;
            }
        }
        added
    }

    /// Returns unique names without the words that all share, the ground truth's included.
    fn short_names(&self, added: &[Added]) -> Vec<String> {
        let places: Vec<PathBuf> =
            added.iter().map(|one| one.estimate.path.with_extension("")).collect();
        let named = added.iter().zip(&places);
        let named = named.map(|(one, place)| (one.full_name.clone(), Some(place.as_path())));
        let mut names = told_apart(&named.collect::<Vec<_>>());
        names.extend(self.truth_name.clone());
        let mut short = without_common_words(&names, LONGEST_NAME);
        short.truncate(added.len());
        short
    }

    /// Returns the added trajectories together with those read for a session, with the options in the session.
    pub fn with_saved(
        &self,
        estimates: &[Arc<EstimatedTrajectory>],
        saved: &[SavedEstimate],
    ) -> Vec<Added> {
        let of = |estimate: &EstimatedTrajectory| saved.iter().find(|one| one.is_of(estimate));
        let is_named = |path: &Path| {
            estimates.iter().any(|estimate| estimate.path == path && of(estimate).is_some())
        };
        // A file without any trajectory that the session names is treated as newly added.
        let kept = |one: &&Arc<EstimatedTrajectory>| of(one).is_some() || !is_named(&one.path);
        let mut added = self.with(estimates.iter().filter(kept).cloned().collect());
        for one in &mut added {
            if let Some(saved) = of(&one.estimate) {
                (one.options, one.shown) = (saved.options, saved.shown);
            }
        }
        added
    }

    /// Returns the trajectories after a step from `from` to `to` is undone or redone. Keeps those that a session added in
    /// the meantime, which belong to no step.
    pub fn after_step(&self, from: &[Added], to: Vec<Added>) -> Vec<Added> {
        let is_among = |some: &[Added], one: &Added| {
            some.iter().any(|other| other.estimate.is_same(&one.estimate))
        };
        let others = self.added.iter().filter(|one| !is_among(from, one) && !is_among(&to, one));
        let others: Vec<Added> = others.cloned().collect();
        to.into_iter().chain(others).collect()
    }

    /// Replaces the trajectories to evaluate.
    pub fn set(&mut self, added: Vec<Added>) {
        let asked = |one: &Added| (Arc::as_ptr(&one.estimate), one.options);
        if !added.iter().map(asked).eq(self.added.iter().map(asked)) {
            self.version += 1;
        }
        self.added = added;
        if self.added.is_empty() {
            self.judgement.clear();
            self.extrinsics.clear();
        }
    }

    /// Returns the trajectories as a session saves them.
    pub fn saved(&self) -> Vec<SavedEstimate> {
        let one = |added: &Added| SavedEstimate {
            path: added.estimate.path.clone(),
            topic: added.estimate.topic.clone(),
            options: added.options,
            shown: added.shown,
        };
        self.missing.iter().cloned().chain(self.added.iter().map(one)).collect()
    }

    /// Returns the evaluated trajectories, each with the index of its colour.
    pub fn judged(&self) -> impl Iterator<Item = (usize, &Judged)> {
        let judged = self.judgement.newest.iter().flat_map(|judgement| &judgement.judged);
        judged.filter_map(|one| Some((self.of(&one.estimate)?.colour, one)))
    }

    /// Returns the added trajectory of an estimate; `None` once it was removed.
    pub fn of(&self, estimate: &EstimatedTrajectory) -> Option<&Added> {
        self.added.iter().find(|one| one.estimate.is_same(estimate))
    }

    /// Returns the colours of the evaluated trajectories in the scene, in the order of the evaluation; `None` for hidden ones.
    pub fn drawn(&self, judgement: &EstimatesJudgement) -> Vec<Option<usize>> {
        let colour = |one: &Judged| Some(self.of(&one.estimate).filter(|it| it.shown)?.colour);
        judgement.judged.iter().map(colour).collect()
    }
}

impl SavedEstimate {
    fn is_of(&self, estimate: &EstimatedTrajectory) -> bool {
        self.path == estimate.path && (self.topic.is_none() || self.topic == estimate.topic)
    }
}

/// Describes the differences between two lists of trajectories; the text does not change while one number varies.
pub fn change_in_words(before: &[Added], after: &[Added]) -> String {
    let name = |one: &Added| one.estimate.name.clone();
    let lacking = |some: &[Added], in_these: &[Added]| -> Vec<String> {
        let is_there = |one: &Added| in_these.iter().any(|it| it.estimate.is_same(&one.estimate));
        some.iter().filter(|one| !is_there(one)).map(name).collect()
    };
    let both: Vec<[&Added; 2]> = after
        .iter()
        .filter_map(|one| Some([before.iter().find(|it| it.estimate.is_same(&one.estimate))?, one]))
        .collect();
    let where_ = |differs: &dyn Fn(&Added, &Added) -> bool| -> Vec<String> {
        both.iter().filter(|[old, new]| differs(old, new)).map(|[_, new]| name(new)).collect()
    };
    let parts = [
        ("trajectory added", lacking(after, before)),
        ("trajectory removed", lacking(before, after)),
        ("trajectory hidden", where_(&|old, new| old.shown && !new.shown)),
        ("trajectory shown", where_(&|old, new| !old.shown && new.shown)),
        ("alignment", where_(&|old, new| old.options.alignment != new.options.alignment)),
        ("clock", where_(&|old, new| old.options.time_offset_s != new.options.time_offset_s)),
        ("convention", where_(&|old, new| old.options.convention != new.options.convention)),
        ("body", where_(&|old, new| old.options.body != new.options.body)),
        ("trajectory read again", where_(&|old, new| !Arc::ptr_eq(&old.estimate, &new.estimate))),
    ];
    let parts = parts.iter().filter(|(_, names)| !names.is_empty());
    parts
        .map(|(what, names)| format!("{what}: {}", names.join(", ")))
        .collect::<Vec<_>>()
        .join("; ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn estimate(path: &str, topic: Option<&str>) -> Arc<EstimatedTrajectory> {
        let topic = topic.map(str::to_owned);
        let name = topic.clone().unwrap_or_else(|| "slam".to_owned());
        Arc::new(EstimatedTrajectory {
            name,
            path: path.into(),
            topic,
            frames: None,
            poses: vec![],
            covariances: vec![],
            origin: None,
            findings: vec![],
        })
    }

    #[test]
    fn what_a_session_brings_after_a_step_is_not_taken_away_with_it() {
        let [own, saved] = ["slam.tum", "vio.tum"].map(|path| estimate(path, None));
        let mut judging = Judging::default();
        let step = [judging.added.clone(), judging.with(vec![own])];
        judging.set(step[1].clone());
        judging.set(judging.with(vec![saved]));
        let both = judging.added.clone();
        judging.set(judging.after_step(&step[1], step[0].clone()));
        assert_eq!(judging.added, both[1..], "taken back");
        judging.set(judging.after_step(&step[0], step[1].clone()));
        assert_eq!(judging.added.len(), 2, "and done again");
    }

    #[test]
    fn a_session_has_those_of_a_bag_judged_that_it_names_and_each_as_it_was() {
        let [odom, lidar] = ["/odom", "/lidar"].map(|topic| estimate("a.bag", Some(topic)));
        let tum = estimate("slam.tum", None);
        let options = Options { time_offset_s: Some(0.5), ..Options::default() };
        let saved = |path: &str, topic: Option<&str>| SavedEstimate {
            path: path.into(),
            topic: topic.map(str::to_owned),
            options,
            shown: false,
        };
        let read = vec![odom, lidar, tum];
        let restored = |saved: &[SavedEstimate]| -> Vec<(String, bool)> {
            let added = Judging::default().with_saved(&read, saved);
            let is_as_saved = |one: &Added| one.options == options && !one.shown;
            added.iter().map(|one| (one.estimate.name.clone(), is_as_saved(one))).collect()
        };
        let named = |all: &[(&str, bool)]| -> Vec<(String, bool)> {
            all.iter().map(|(name, as_saved)| ((*name).to_owned(), *as_saved)).collect()
        };
        let one = restored(&[saved("a.bag", Some("/lidar")), saved("slam.tum", None)]);
        assert_eq!(one, named(&[("/lidar", true), ("slam", true)]));
        // Older sessions named no topics, and a newly recorded bag may contain other ones.
        let all = restored(&[saved("a.bag", None)]);
        assert_eq!(all, named(&[("/odom", true), ("/lidar", true), ("slam", false)]));
        let other = restored(&[saved("a.bag", Some("/gnss"))]);
        assert_eq!(other, named(&[("/odom", false), ("/lidar", false), ("slam", false)]));
    }
}
