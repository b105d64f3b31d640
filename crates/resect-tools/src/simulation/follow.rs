//! A driver that follows waypoints: on straight legs between them, and around corners on bends of the vehicle's turning
//! radius. Without room for a bend, the vehicle turns on the spot.

use std::f64::consts::PI;

use nalgebra::Vector2;

use super::planar::{Planar, reacting};
use super::waypoint::Waypoint;
use resect_core::geometry::wrap_to_pi;

/// Shortest distance from a bend's beginning to the corner, and from the corner to its end (m). A wide turn needs more;
/// legs shorter than twice this become one bend.
const ROUNDED_M: f64 = 1.5;
/// Smallest radius of a bend (m); the vehicle turns on the spot instead of a tighter one.
const TIGHTEST_M: f64 = 0.3;
/// Largest rate of rotation of a vehicle (rad/s).
const FASTEST_TURN_RAD_PER_S: f64 = 0.4;
/// Deceleration before a stop (m/s²), and the speed at which the vehicle stops (m/s).
const BRAKE_M_PER_S2: f64 = 0.5;
const CREEP_M_PER_S: f64 = 0.03;

/// A segment of the path.
struct PathPiece {
    shape: Shape,
    length_m: f64,
    speed_m_per_s: f64,
}

enum Shape {
    Line {
        from_m: Vector2<f64>,
        along: Vector2<f64>,
    },
    /// An arc, to the left if `side` is 1 and to the right if it is −1.
    Bend {
        centre_m: Vector2<f64>,
        radius_m: f64,
        from_rad: f64,
        side: f64,
    },
    /// A stop, with a rotation on the spot.
    Stay {
        at: Planar,
        turn_rad: f64,
        for_s: f64,
    },
}

/// State of a vehicle that follows waypoints.
pub struct Follower {
    pieces: Vec<PathPiece>,
    /// Largest speed at the beginning of each segment, from which the vehicle can brake for the later ones; the last entry
    /// is the end.
    enter_m_per_s: Vec<f64>,
    piece: usize,
    /// Distance driven in the current segment (m), or time stood in it (s).
    into: f64,
    speed_m_per_s: f64,
    pose: Planar,
}

impl Follower {
    /// Plans the drive; legs without a speed of their own are driven at `cruise_m_per_s`.
    pub fn new(waypoints: &[Waypoint], turn_radius_m: f64, cruise_m_per_s: f64) -> Self {
        let pieces = pieces(waypoints, turn_radius_m, cruise_m_per_s);
        let mut enter_m_per_s = vec![CREEP_M_PER_S; pieces.len() + 1];
        for (index, piece) in pieces.iter().enumerate().rev() {
            enter_m_per_s[index] = piece.most_m_per_s(piece.length_m, enter_m_per_s[index + 1]);
        }
        let pose = pieces.first().map_or_else(Planar::default, |first| first.shape.at(0.0));
        Self { pieces, enter_m_per_s, piece: 0, into: 0.0, speed_m_per_s: 0.0, pose }
    }

    /// Returns the current pose.
    pub fn pose(&self) -> Planar {
        self.pose
    }

    pub fn has_arrived(&self) -> bool {
        self.piece >= self.pieces.len()
    }

    /// Drives for a time (s). Headings are continuous, without jumps by whole turns.
    pub fn drive(&mut self, for_s: f64) {
        let before_rad = self.pose.heading_rad;
        self.go_on(for_s);
        self.pose.heading_rad = before_rad + wrap_to_pi(self.pose.heading_rad - before_rad);
    }

    fn go_on(&mut self, for_s: f64) {
        let Some(piece) = self.pieces.get(self.piece) else { return };
        if let Shape::Stay { for_s: whole_s, .. } = piece.shape {
            self.speed_m_per_s = 0.0;
            self.into += for_s;
            self.pose = piece.shape.at(self.into.min(whole_s));
            if self.into >= whole_s {
                (self.piece, self.into) = (self.piece + 1, 0.0);
            }
            return;
        }
        let left_m = (piece.length_m - self.into).max(0.0);
        let most = piece.most_m_per_s(left_m, self.enter_m_per_s[self.piece + 1]);
        self.speed_m_per_s = reacting(self.speed_m_per_s, piece.speed_m_per_s).min(most);
        self.into += self.speed_m_per_s * for_s;
        while let Some(piece) = self.pieces.get(self.piece) {
            let stands = matches!(piece.shape, Shape::Stay { .. });
            if stands || self.into < piece.length_m {
                self.into = if stands { 0.0 } else { self.into };
                self.pose = piece.shape.at(self.into);
                return;
            }
            self.pose = piece.shape.at(piece.length_m);
            self.into -= piece.length_m;
            self.piece += 1;
        }
    }
}

impl PathPiece {
    /// Returns the largest speed with `left_m` of the segment left (m), if the next one begins at `next_m_per_s`.
    fn most_m_per_s(&self, left_m: f64, next_m_per_s: f64) -> f64 {
        let braking = (next_m_per_s.powi(2) + 2.0 * BRAKE_M_PER_S2 * left_m).sqrt();
        match self.shape {
            Shape::Line { .. } => braking,
            Shape::Bend { radius_m, .. } => braking.min(radius_m * FASTEST_TURN_RAD_PER_S),
            Shape::Stay { .. } => CREEP_M_PER_S,
        }
    }
}

impl Shape {
    /// Returns the pose at a distance (m) or, for a stop, a time (s) from the segment's beginning.
    fn at(&self, into: f64) -> Planar {
        match self {
            Self::Line { from_m, along } => {
                let at_m = from_m + along * into;
                Planar { x_m: at_m.x, y_m: at_m.y, heading_rad: along.y.atan2(along.x) }
            }
            Self::Bend { centre_m, radius_m, from_rad, side } => {
                let angle = from_rad + side * into / radius_m;
                let at_m = centre_m + Vector2::new(angle.cos(), angle.sin()) * *radius_m;
                Planar { x_m: at_m.x, y_m: at_m.y, heading_rad: angle + side * PI / 2.0 }
            }
            Self::Stay { at, turn_rad, for_s } => {
                let share = if *for_s > 0.0 { into / for_s } else { 1.0 };
                Planar { heading_rad: at.heading_rad + turn_rad * share, ..*at }
            }
        }
    }
}

/// Returns the segments of the path along waypoints.
fn pieces(waypoints: &[Waypoint], turn_radius_m: f64, cruise_m_per_s: f64) -> Vec<PathPiece> {
    let Some(first) = waypoints.first() else { return Vec::new() };
    // Merges consecutive waypoints at one place and adds up their stops.
    let mut stops: Vec<Waypoint> = vec![*first];
    for at in &waypoints[1..] {
        let last = stops.len() - 1;
        match (at.place_m() - stops[last].place_m()).norm() < 1e-6 {
            true => stops[last].stand_s += at.stand_s,
            false => stops.push(*at),
        }
    }
    let along: Vec<Vector2<f64>> =
        stops.windows(2).map(|pair| (pair[1].place_m() - pair[0].place_m()).normalize()).collect();
    let heading_rad = |leg: usize| along.get(leg).map_or(0.0, |along| along.y.atan2(along.x));
    let mut pieces = Vec::new();
    let stay = |at: &Waypoint, heading_rad: f64, turn_rad: f64| {
        let for_s = at.stand_s + turn_rad.abs() / FASTEST_TURN_RAD_PER_S;
        let at = Planar { x_m: at.x_m, y_m: at.y_m, heading_rad };
        PathPiece { shape: Shape::Stay { at, turn_rad, for_s }, length_m: 0.0, speed_m_per_s: 0.0 }
    };
    pieces.push(stay(first, heading_rad(0), 0.0));
    let mut from_m = first.place_m();
    for (leg, to) in stops.iter().enumerate().skip(1).map(|(at, to)| (at - 1, to)) {
        let corner = match (stops.get(leg + 2), to.stand_s > 0.0) {
            (Some(next), false) => {
                let turn_rad = wrap_to_pi(heading_rad(leg + 1) - heading_rad(leg));
                let room_m = (to.place_m() - stops[leg].place_m())
                    .norm()
                    .min((next.place_m() - to.place_m()).norm())
                    / 2.0;
                Corner::of(turn_rad, room_m, turn_radius_m)
            }
            _ => None,
        };
        let before_m = corner.as_ref().map_or(0.0, |corner| corner.before_m);
        let until_m = to.place_m() - along[leg] * before_m;
        let speed_m_per_s = to.speed_m_per_s.unwrap_or(cruise_m_per_s);
        let line = Shape::Line { from_m, along: along[leg] };
        pieces.push(PathPiece {
            shape: line,
            length_m: (until_m - from_m).dot(&along[leg]).max(0.0),
            speed_m_per_s,
        });
        from_m = to.place_m();
        match corner {
            Some(Corner { radius_m, turn_rad, before_m }) => {
                let side = turn_rad.signum();
                let aside = Vector2::new(-along[leg].y, along[leg].x) * side;
                let centre_m = until_m + aside * radius_m;
                let from_rad = (-aside.y).atan2(-aside.x);
                let shape = Shape::Bend { centre_m, radius_m, from_rad, side };
                pieces.push(PathPiece {
                    shape,
                    length_m: radius_m * turn_rad.abs(),
                    speed_m_per_s,
                });
                from_m += along[leg + 1] * before_m;
            }
            None => {
                let turn_rad = match leg + 1 < along.len() {
                    true => wrap_to_pi(heading_rad(leg + 1) - heading_rad(leg)),
                    false => 0.0,
                };
                if to.stand_s > 0.0 || turn_rad.abs() > 1e-6 {
                    pieces.push(stay(to, heading_rad(leg), turn_rad));
                }
            }
        }
    }
    pieces
}

/// A bend that rounds a corner.
struct Corner {
    radius_m: f64,
    turn_rad: f64,
    /// Distance from the bend's beginning to the corner, and from the corner to its end (m).
    before_m: f64,
}

impl Corner {
    /// Returns the bend of a corner; `None` for a straight path, or without room for a bend.
    fn of(turn_rad: f64, room_m: f64, turn_radius_m: f64) -> Option<Self> {
        let half = (0.5 * turn_rad.abs()).tan();
        let before_m = (turn_radius_m * half).max(ROUNDED_M).min(room_m);
        let radius_m = before_m / half;
        (turn_rad.abs() > 1e-6 && radius_m > TIGHTEST_M).then_some(Self {
            radius_m,
            turn_rad,
            before_m,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP_S: f64 = 0.01;

    fn waypoint(x_m: f64, y_m: f64, stand_s: f64) -> Waypoint {
        Waypoint { x_m, y_m, speed_m_per_s: None, stand_s }
    }

    /// Returns the pose after every step until the vehicle arrives.
    fn driven(waypoints: &[Waypoint]) -> Vec<Planar> {
        let mut follower = Follower::new(waypoints, 3.5, 0.8);
        let mut poses = vec![follower.pose()];
        while !follower.has_arrived() {
            follower.drive(STEP_S);
            poses.push(follower.pose());
            assert!(poses.len() < 100_000, "never arrives");
        }
        poses
    }

    #[test]
    fn ways_of_all_kinds_are_driven_without_a_jump() {
        let there_and_back = [(0.0, 0.0), (20.0, 0.0), (0.0, 0.0)];
        let corners = [(0.0, 0.0), (20.0, 0.0), (20.0, 20.0), (19.0, 20.5), (30.0, 21.0)];
        let twice = [(0.0, 0.0), (5.0, 0.0), (5.0, 0.0), (5.0, 8.0)];
        for way in [&there_and_back[..], &corners, &twice] {
            let waypoints: Vec<_> = way.iter().map(|(x, y)| waypoint(*x, *y, 0.0)).collect();
            let poses = driven(&waypoints);
            for pair in poses.windows(2) {
                let gone_m = (pair[1].x_m - pair[0].x_m).hypot(pair[1].y_m - pair[0].y_m);
                let turned = wrap_to_pi(pair[1].heading_rad - pair[0].heading_rad);
                assert!(gone_m <= 0.8 * STEP_S + 1e-9, "{gone_m} m at once in {way:?}");
                assert!(
                    turned.abs() <= FASTEST_TURN_RAD_PER_S * STEP_S * 1.2,
                    "{turned} rad at once in {way:?}"
                );
                // The vehicle never moves sideways.
                let heading = Vector2::new(pair[0].heading_rad.cos(), pair[0].heading_rad.sin());
                let gone = Vector2::new(pair[1].x_m - pair[0].x_m, pair[1].y_m - pair[0].y_m);
                assert!(gone.perp(&heading).abs() < 0.02 * STEP_S, "aside in {way:?}");
            }
            let (last, end) = (poses[poses.len() - 1], way[way.len() - 1]);
            assert!((last.x_m - end.0).hypot(last.y_m - end.1) < 1e-6, "{last:?}");
        }
    }

    #[test]
    fn corners_are_as_wide_as_the_vehicle_needs_and_it_stands_as_long_as_it_shall() {
        let poses = driven(&[
            waypoint(0.0, 0.0, 8.0),
            waypoint(20.0, 0.0, 0.0),
            waypoint(20.0, 20.0, 5.0),
            waypoint(20.0, 40.0, 0.0),
        ]);
        let standing = poses.windows(2).filter(|p| p[0].x_m == p[1].x_m && p[0].y_m == p[1].y_m);
        let stood_s = standing.count() as f64 * STEP_S;
        assert!((stood_s - 13.0).abs() < 0.1, "{stood_s}");
        // A bend of radius 3.5 m passes the corner at (√2 − 1) times the radius.
        let nearest_m =
            poses.iter().map(|at| (at.x_m - 20.0).hypot(at.y_m)).fold(f64::INFINITY, f64::min);
        assert!((nearest_m - 3.5 * (2.0_f64.sqrt() - 1.0)).abs() < 0.01, "{nearest_m}");
    }
}
