//! Random training parts, so that errors are those of data that the calibration has not seen.

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use crate::calibration::time_blocks;
use crate::deployment::Deployment;
use crate::pipeline::Triplets;

/// Share that is trained on: the paper's.
const TRAINING_SHARE: f64 = 0.75;

/// How often to split, and from which seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Splits {
    pub repeats: usize,
    pub seed: u64,
}

/// Control points and triplets of a deployment, all or a part.
pub struct Part {
    pub deployment: Deployment,
    pub triplets: Triplets,
}

/// What to calibrate on and what to judge by: everything by itself, or `repeats` random parts by the rest.
pub fn parts(
    deployment: &Deployment,
    triplets: &Triplets,
    splits: Option<Splits>,
) -> Vec<[Part; 2]> {
    let Some(Splits { repeats, seed }) = splits else {
        let whole = || Part { deployment: without_tracks(deployment), triplets: triplets.clone() };
        return vec![[whole(), whole()]];
    };
    (0..repeats)
        .map(|repeat| {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            rng.set_stream(repeat as u64);
            split(deployment, triplets, &mut rng)
        })
        .collect()
}

/// Whole blocks of time go to one side: neighbouring triplets share their readings, and would tell on each other.
fn split(deployment: &Deployment, triplets: &Triplets, rng: &mut ChaCha8Rng) -> [Part; 2] {
    let blocks = time_blocks::of(&triplets.time_s, &triplets.interval);
    let sides = sides(blocks.len(), rng);
    let select = |side: bool| {
        let indices: Vec<usize> = blocks
            .iter()
            .zip(&sides)
            .filter(|(_, training)| **training == side)
            .flat_map(|(block, _)| block.clone())
            .collect();
        triplets.select(&indices)
    };
    let (mut train, mut test) = (without_tracks(deployment), without_tracks(deployment));
    for index in 0..deployment.control_points.len() {
        // Pillars serve method A alone, which judges by the points it leaves out anyway.
        if deployment.control_points[index].pillars {
            continue;
        }
        let points = &deployment.control_points[index].points;
        let sides = self::sides(points.len(), rng);
        for (part, side) in [(&mut train, true), (&mut test, false)] {
            let chosen = points.iter().zip(&sides).filter(|(_, training)| **training == side);
            part.control_points[index].points = chosen.map(|(point, _)| point.clone()).collect();
        }
    }
    [
        Part { deployment: train, triplets: select(true) },
        Part { deployment: test, triplets: select(false) },
    ]
}

/// For each of `count`, whether it is trained on.
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
        ingredients: Vec::new(),
        findings: Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deployment::Sample;
    use crate::pipeline::{self, PipelineSettings};

    #[test]
    fn parts_share_nothing_and_lose_nothing() {
        let deployment = Sample::Warthog.open().expect("built in");
        let triplets = pipeline::run(&deployment, &PipelineSettings::default()).triplets;
        let splits = Some(Splits { repeats: 3, seed: 7 });
        let first = parts(&deployment, &triplets, splits);
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
        let again = parts(&deployment, &triplets, splits);
        assert_eq!(first[2][1].triplets, again[2][1].triplets, "a seed repeats");
    }
}
