//! Random training parts, so that errors are those of data that the calibration has not seen.

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

use crate::calibration::time_blocks;
use crate::deployment::Deployment;
use crate::pipeline::Triplets;

/// Share that is trained on: the paper's.
const TRAINING_SHARE: f64 = 0.75;

/// How often to split, and from which seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Splits {
    pub repeats: usize,
    pub seed: u64,
}

/// Control points and triplets of a deployment, all or a part.
pub struct Part {
    pub deployment: Deployment,
    pub triplets: Triplets,
}

/// What each repeat trains on: chosen once, whatever the pipeline then makes of the deployment.
pub struct Plan {
    repeats: Vec<Training>,
}

struct Training {
    /// Spans of time (s), ends included, in order.
    spans: Vec<[f64; 2]>,
    /// Whether each point is trained on, for each set of control points; all are, of pillars.
    points: Vec<Vec<bool>>,
}

impl Plan {
    /// A plan by the deployment's blocks of time; without splits one repeat that trains and judges on everything.
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

    /// What to calibrate on and what to judge by, for each repeat. The triplets may be others than those of the plan,
    /// of the same drive.
    pub fn parts(&self, deployment: &Deployment, triplets: &Triplets) -> Vec<[Part; 2]> {
        if self.repeats.is_empty() {
            let whole =
                || Part { deployment: without_tracks(deployment), triplets: triplets.clone() };
            return vec![[whole(), whole()]];
        }
        self.repeats.iter().map(|training| training.split(deployment, triplets)).collect()
    }
}

impl Training {
    /// Whole blocks of time go to one side: neighbouring triplets share their readings, and would tell on each other.
    fn split(&self, deployment: &Deployment, triplets: &Triplets) -> [Part; 2] {
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
                // Pillars serve method A alone, which judges by the points it leaves out anyway.
                if !set.pillars {
                    let mut sides = sides.iter();
                    set.points.retain(|_| sides.next() == Some(&side));
                }
            }
            Part { deployment, triplets: select(side) }
        };
        [part(true), part(false)]
    }
}

/// Whether each of `count` blocks or points is trained on, at random.
fn sides(count: usize, rng: &mut ChaCha8Rng) -> Vec<bool> {
    let training = (TRAINING_SHARE * count as f64).round() as usize;
    let mut sides: Vec<bool> = (0..count).map(|i| i < training).collect();
    sides.shuffle(rng);
    sides
}

/// The calibrations look at triplets; raw tracks need no copies.
fn without_tracks(deployment: &Deployment) -> Deployment {
    Deployment {
        name: deployment.name.clone(),
        tracks: Default::default(),
        control_points: deployment.control_points.clone(),
        rig: deployment.rig.clone(),
        prisms: deployment.prisms,
        gnss: None,
        time_corrections: Default::default(),
        track_frame: deployment.track_frame,
        as_read: deployment.as_read.clone(),
        overrides: deployment.overrides.clone(),
        ingredients: Vec::new(),
        findings: Vec::new(),
        restarts_s: deployment.restarts_s.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline;
    use crate::pipeline::PipelineSettings;
    use crate::simulation::{Preset, simulate};

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
        let first = Plan::new(&deployment, &triplets, splits).parts(&deployment, &triplets);
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
        let again = Plan::new(&deployment, &triplets, splits).parts(&deployment, &triplets);
        assert_eq!(first[2][1].triplets, again[2][1].triplets, "a seed repeats");
    }

    #[test]
    fn what_was_trained_on_is_never_judged_whatever_the_pipeline_makes_of_it() {
        let deployment = deployment();
        let settings = PipelineSettings::default();
        let triplets = pipeline::run(&deployment, &settings).triplets;
        let plan = Plan::new(&deployment, &triplets, Some(Splits { repeats: 2, seed: 1 }));
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
