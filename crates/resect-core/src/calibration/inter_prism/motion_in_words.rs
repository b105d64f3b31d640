//! Descriptions of motions of stations 2 and 3 to which the distances are insensitive, in a surveyor's words.
//!
//! Motions are centred parameters with yaw in metres at the track's radius, so that their components are comparable.

use nalgebra::SVector;

use super::CentredTriplets;

/// Direction in (x, y, z, yaw) of stations 2 and 3, relative to the centroids of their tracks; of any length.
pub type PoseDirection = SVector<f64, 8>;

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
        let [x, y, _] = &data.coordinates[0];
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

/// A component of a motion: its size for stations 2 and 3 (m), and true if both move in the same direction.
struct Share {
    part: MotionComponent,
    amounts: [f64; 2],
    together: bool,
}

impl Share {
    fn largest(&self) -> f64 {
        self.amounts[0].max(self.amounts[1])
    }
}

/// Returns the components of a motion, the largest first.
fn shares(axes: &TrackAxes, motion: &PoseDirection) -> Vec<Share> {
    let [ax, ay] = axes.along;
    let level = [0, 4].map(|at| [motion[at], motion[at + 1]]);
    let one = |part, [second, third]: [f64; 2]| Share {
        part,
        amounts: [second.abs(), third.abs()],
        together: second * third >= 0.0,
    };
    let mut shares = vec![
        one(MotionComponent::Height, [motion[2], motion[6]]),
        one(MotionComponent::Turn, [motion[3], motion[7]]),
    ];
    if axes.long {
        shares.push(one(MotionComponent::Along, level.map(|[x, y]| ax * x + ay * y)));
        shares.push(one(MotionComponent::Across, level.map(|[x, y]| ax * y - ay * x)));
    } else {
        let [second, third] = level;
        shares.push(Share {
            part: MotionComponent::Level,
            amounts: level.map(|[x, y]| x.hypot(y)),
            together: second[0] * third[0] + second[1] * third[1] >= 0.0,
        });
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
    match share.amounts.map(|amount| amount >= said) {
        [true, true] if share.together => format!("stations 2 and 3 {can}{verb}{rest} together"),
        [true, true] => format!("stations 2 and 3 {can}{verb}{rest} in opposite directions"),
        [second, _] => {
            let (station, ending) = (if second { 2 } else { 3 }, if free { "" } else { "s" });
            format!("station {station} {can}{verb}{ending}{rest}")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(motion: [f64; 8], long: bool, free: bool) -> String {
        describe(&TrackAxes { along: [0.0, 1.0], long }, &PoseDirection::from(motion), free)
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
    }
}
