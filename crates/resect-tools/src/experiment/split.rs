//! Random training subsets, so that errors are those of data that the calibration has not used.

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

use resect_core::calibration::time_blocks;
use resect_core::deployment::{Deployment, Track};
use resect_core::pipeline::Triplets;

/// Share of the training data, as in the paper.
const TRAINING_SHARE: f64 = 0.75;

/// Number of random splits, and their seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Splits {
    pub repeats: usize,
    pub seed: u64,
}

/// Control points and triplets of a deployment, all or a subset.
pub struct DataSubset {
    pub deployment: Deployment,
    pub triplets: Triplets,
}

/// Training data of each repeat, chosen once and independent of the pipeline's later output.
pub struct SplitPlan {
    repeats: Vec<Training>,
}

struct Training {
    /// Spans of time (s), ends included, in order.
    spans: Vec<[f64; 2]>,
    /// True for points of the training data, for each set of control points; all pillars are.
    points: Vec<Vec<bool>>,
}

impl SplitPlan {
    /// Plan by the deployment's blocks of time. Without splits, one repeat trains and tests on everything.
    pub fn new(deployment: &Deployment, triplets: &Triplets, splits: Option<Splits>) -> Self {
        let Some(Splits { repeats, seed }) = splits else { return Self { repeats: Vec::new() } };
        let blocks = time_blocks::of(&triplets.time_s, &triplets.interval);
        let repeats = (0..repeats)
            .map(|repeat| {
                let mut rng = ChaCha8Rng::seed_from_u64(seed);
                rng.set_stream(repeat as u64);
                let sides = sides(blocks.len(), &mut rng);
                let training = blocks.iter().zip(&sides).filter(|(_, training)| **training);
                let span = |block: &std::ops::Range<usize>| {
                    [triplets.time_s[block.start], triplets.time_s[block.end - 1]]
                };
                let spans = training.map(|(block, _)| span(block)).collect();
                let points = deployment
                    .control_points
                    .iter()
                    .map(|set| self::sides(set.points.len(), &mut rng))
                    .collect();
                Training { spans, points }
            })
            .collect();
        Self { repeats }
    }

    /// Training and test subset of each repeat. The triplets may differ from those of the plan, but must be of the same drive.
    pub fn parts(&self, deployment: &Deployment, triplets: &Triplets) -> Vec<[DataSubset; 2]> {
        if self.repeats.is_empty() {
            let whole = || DataSubset {
                deployment: without_tracks(deployment),
                triplets: triplets.clone(),
            };
            return vec![[whole(), whole()]];
        }
        self.repeats.iter().map(|training| training.split(deployment, triplets)).collect()
    }
}

impl Training {
    /// Assigns whole blocks of time to one side: neighbouring triplets share readings, so they are not independent.
    fn split(&self, deployment: &Deployment, triplets: &Triplets) -> [DataSubset; 2] {
        let trained_on = |time_s: f64| {
            let next = self.spans.partition_point(|[_, end]| *end < time_s);
            self.spans.get(next).is_some_and(|[start, _]| *start <= time_s)
        };
        let select = |side: bool| {
            let indices: Vec<usize> =
                (0..triplets.len()).filter(|i| trained_on(triplets.time_s[*i]) == side).collect();
            triplets.select(&indices)
        };
        let part = |side: bool| {
            let mut deployment = without_tracks(deployment);
            for (set, sides) in deployment.control_points.iter_mut().zip(&self.points) {
                // Pillars serve method A alone, which is tested on the points that it leaves out.
                if !set.pillars {
                    let mut sides = sides.iter();
                    set.points.retain(|_| sides.next() == Some(&side));
                }
            }
            DataSubset { deployment, triplets: select(side) }
        };
        [part(true), part(false)]
    }
}

/// Selects the training data among `count` blocks or points, at random.
fn sides(count: usize, rng: &mut ChaCha8Rng) -> Vec<bool> {
    let training = (TRAINING_SHARE * count as f64).round() as usize;
    let mut sides: Vec<bool> = (0..count).map(|i| i < training).collect();
    sides.shuffle(rng);
    sides
}

/// Copies a deployment without its raw tracks, which the calibrations do not use.
fn without_tracks(deployment: &Deployment) -> Deployment {
    Deployment {
        name: deployment.name.clone(),
        tracks: deployment.tracks.map(|_| Track::default()),
        control_points: deployment.control_points.clone(),
        rig: deployment.rig.clone(),
        prisms: deployment.prisms,
        gnss: None,
        time_corrections: deployment.tracks.map(|_| Vec::new()),
        track_frame: deployment.track_frame,
        as_read: deployment.as_read.clone(),
        overrides: deployment.overrides.clone(),
        ingredients: Vec::new(),
        findings: Vec::new(),
        ground_truth: None,
        restarts_s: deployment.restarts_s.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::{Preset, simulate};
    use resect_core::pipeline;
    use resect_core::pipeline::PipelineSettings;

    fn deployment() -> Deployment {
        let simulated = simulate(Preset::Warthog, 1);
        let control_points = simulated.control_points.clone();
        Deployment { control_points, ..simulated.readings() }
    }

    #[test]
    fn parts_share_nothing_and_lose_nothing() {
        let deployment = deployment();
        let triplets = pipeline::run(&deployment, &PipelineSettings::default()).triplets;
        let splits = Some(Splits { repeats: 3, seed: 7 });
        let first = SplitPlan::new(&deployment, &triplets, splits).parts(&deployment, &triplets);
        assert_eq!(first.len(), 3);
        for [train, test] in &first {
            assert_eq!(train.triplets.len() + test.triplets.len(), triplets.len());
            let share = train.triplets.len() as f64 / triplets.len() as f64;
            assert!((0.65..0.85).contains(&share), "{share}");
            assert!(!train.triplets.time_s.iter().any(|t| test.triplets.time_s.contains(t)));
            for (set, all) in train.deployment.control_points.iter().zip(&deployment.control_points)
            {
                let share = if all.pillars { 1.0 } else { 0.75 };
                assert_eq!(set.points.len(), (share * all.points.len() as f64).round() as usize);
            }
        }
        assert!(first[0][0].triplets != first[1][0].triplets, "repeats differ");
        let again = SplitPlan::new(&deployment, &triplets, splits).parts(&deployment, &triplets);
        assert_eq!(first[2][1].triplets, again[2][1].triplets, "a seed repeats");
    }

    #[test]
    fn what_was_trained_on_is_never_judged_whatever_the_pipeline_makes_of_it() {
        let deployment = deployment();
        let settings = PipelineSettings::default();
        let triplets = pipeline::run(&deployment, &settings).triplets;
        let plan = SplitPlan::new(&deployment, &triplets, Some(Splits { repeats: 2, seed: 1 }));
        let unfiltered =
            PipelineSettings { outlier_filter: false, interval_filter: false, ..settings };
        let others = pipeline::run(&deployment, &unfiltered).triplets;
        let judged = plan.parts(&deployment, &others);
        for ([train, _], [_, test]) in plan.parts(&deployment, &triplets).iter().zip(&judged) {
            let close = |a: f64, b: f64| (a - b).abs() < 1e-9;
            let both = train
                .triplets
                .time_s
                .iter()
                .filter(|t| test.triplets.time_s.iter().any(|other| close(**t, *other)));
            assert_eq!(both.count(), 0);
        }
    }
}
