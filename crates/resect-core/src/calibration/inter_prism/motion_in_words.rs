//! Descriptions of motions of the stations to which the distances are insensitive, in a surveyor's words.
//!
//! Motions are centred parameters with yaw in metres at the track's radius, so that their components are comparable.

use nalgebra::{DVector, Vector2};

use super::CentredTriplets;
use super::prism_network::UNKNOWNS_PER_STATION;
use crate::network::Station;

/// Direction in (x, y, z, yaw) of station 2, then of each further one, relative to the centroids of their tracks; of any length.
pub type PoseDirection = DVector<f64>;

/// Smallest share of the largest component that is described.
const SAID: f64 = 0.5;
/// A track is elongated if its spread across is below this share of that along.
const LONG: f64 = 0.5;

/// Component of a station's motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotionComponent {
    Along,
    Across,
    /// Horizontal, for a track that is not elongated.
    Level,
    Height,
    Turn,
}

impl MotionComponent {
    fn verb(self) -> (&'static str, &'static str) {
        match self {
            Self::Along => ("slide", " along the track"),
            Self::Across => ("shift", " across the track"),
            Self::Level => ("shift", " in plan"),
            Self::Height => ("shift", " vertically"),
            Self::Turn => ("turn", " about the middle of the track"),
        }
    }
}

/// Principal directions of a track in plan.
#[derive(Clone, Copy, Debug)]
pub struct TrackAxes {
    /// Direction of the largest extent of prism 1's track, in station 1's frame; of length 1.
    pub along: [f64; 2],
    /// True if the track is elongated.
    long: bool,
}

impl TrackAxes {
    pub fn of(data: &CentredTriplets) -> Self {
        let [x, y, _] = &data.coordinates[Station::FIRST];
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        for (x, y) in x.iter().zip(y) {
            xx += x * x;
            xy += x * y;
            yy += y * y;
        }
        let angle: f64 = 0.5 * (2.0 * xy).atan2(xx - yy);
        let (middle, half) = (0.5 * (xx + yy), (0.5 * (xx - yy)).hypot(xy));
        let long = (middle - half) < LONG * LONG * (middle + half);
        Self { along: [angle.cos(), angle.sin()], long }
    }
}

/// A component of a motion: its size for each station but the first (m), or its vector in plan.
struct Share {
    part: MotionComponent,
    vectors_m: Vec<Vector2<f64>>,
}

impl Share {
    fn largest(&self) -> f64 {
        self.vectors_m.iter().map(Vector2::norm).fold(0.0, f64::max)
    }
}

/// Returns the components of a motion, the largest first.
fn shares(axes: &TrackAxes, motion: &PoseDirection) -> Vec<Share> {
    let [ax, ay] = axes.along;
    let share = |part, vector_m: &dyn Fn(&[f64]) -> Vector2<f64>| {
        let stations = motion.as_slice().chunks_exact(UNKNOWNS_PER_STATION);
        Share { part, vectors_m: stations.map(vector_m).collect() }
    };
    let size = |size_m: f64| Vector2::new(size_m, 0.0);
    let mut shares = vec![
        share(MotionComponent::Height, &|p| size(p[2])),
        share(MotionComponent::Turn, &|p| size(p[3])),
    ];
    if axes.long {
        shares.push(share(MotionComponent::Along, &|p| size(ax * p[0] + ay * p[1])));
        shares.push(share(MotionComponent::Across, &|p| size(ax * p[1] - ay * p[0])));
    } else {
        shares.push(share(MotionComponent::Level, &|p| Vector2::new(p[0], p[1])));
    }
    shares.sort_by(|a, b| b.largest().total_cmp(&a.largest()));
    shares
}

/// Returns the largest component of a motion.
pub fn leading_part(axes: &TrackAxes, motion: &PoseDirection) -> MotionComponent {
    shares(axes, motion)[0].part
}

/// Describes the one or two largest components of a motion, such as "stations 2 and 3 shift vertically together"; with "can" if
/// `free`.
pub fn describe(axes: &TrackAxes, motion: &PoseDirection, free: bool) -> String {
    let shares = shares(axes, motion);
    let said = SAID * shares[0].largest();
    let phrases: Vec<String> = shares
        .iter()
        .filter(|share| share.largest() >= said)
        .take(2)
        .map(|share| phrase(share, said, free))
        .collect();
    phrases.join(", ")
}

fn phrase(share: &Share, said: f64, free: bool) -> String {
    let (verb, rest) = share.part.verb();
    let can = if free { "can " } else { "" };
    let (numbers, vectors_m): (Vec<usize>, Vec<Vector2<f64>>) = (share.vectors_m.iter())
        .enumerate()
        .filter(|(_, vector_m)| vector_m.norm() >= said)
        .map(|(slot, vector_m)| (slot + 2, vector_m))
        .unzip();
    let stations = stations_in_words(&numbers);
    if numbers.len() == 1 {
        let ending = if free { "" } else { "s" };
        return format!("{stations} {can}{verb}{ending}{rest}");
    }
    let is_together = vectors_m.iter().all(|vector_m| vectors_m[0].dot(vector_m) >= 0.0);
    let how = if is_together { "together" } else { "in opposite directions" };
    format!("{stations} {can}{verb}{rest} {how}")
}

/// Returns some stations by their numbers, such as "station 2", or "stations 2, 3 and 4".
pub fn stations_in_words(numbers: &[usize]) -> String {
    let labels: Vec<String> = numbers.iter().map(usize::to_string).collect();
    match labels.as_slice() {
        [] => String::new(),
        [only] => format!("station {only}"),
        [most @ .., last] => format!("stations {} and {last}", most.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words<const N: usize>(motion: [f64; N], long: bool, free: bool) -> String {
        let motion = PoseDirection::from_column_slice(&motion);
        describe(&TrackAxes { along: [0.0, 1.0], long }, &motion, free)
    }

    #[test]
    fn a_motion_is_said_by_its_largest_parts() {
        let cases = [
            ([0.1, 1.0, 0.0, 0.0, 0.0, 0.1, 0.2, 0.0], true, "station 2 slides along the track"),
            (
                [0.0, 0.0, 0.7, 0.0, 0.1, 0.0, 0.7, 0.2],
                true,
                "stations 2 and 3 shift vertically together",
            ),
            (
                [0.0, 0.1, 0.7, 0.0, 0.1, 0.0, -0.6, 0.2],
                true,
                "stations 2 and 3 shift vertically in opposite directions",
            ),
            (
                [0.6, 0.6, 0.1, 0.0, 0.6, 0.5, 0.0, 0.0],
                false,
                "stations 2 and 3 shift in plan together",
            ),
            (
                [0.0, 0.0, 0.0, -0.8, 0.0, 0.0, 0.5, -0.1],
                true,
                "station 2 turns about the middle of the track, station 3 shifts vertically",
            ),
        ];
        for (motion, long, expected) in cases {
            assert_eq!(words(motion, long, false), expected);
        }
        let free = words([0.0, 1.0, 0.0, 0.0, 0.0, 0.1, 0.0, 0.0], true, true);
        assert_eq!(free, "station 2 can slide along the track");
        let of_four = [0.0, 0.1, 0.7, 0.0, 0.1, 0.0, 0.6, 0.2, 0.0, 0.0, 0.7, 0.0];
        assert_eq!(words(of_four, true, false), "stations 2, 3 and 4 shift vertically together");
    }
}
