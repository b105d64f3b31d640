//! A driver who follows waypoints: aims at a point a little ahead on the way, and cannot turn tighter than the vehicle does.

use nalgebra::Vector2;

use super::motion::Planar;
use super::scenario::Waypoint;
use crate::geometry::wrap_to_pi;

/// How far ahead on the way a driver aims (m).
const AHEAD_M: f64 = 1.5;

/// How a driver wants to go on.
pub struct Wish {
    pub speed_m_per_s: f64,
    /// 1/m, left positive.
    pub curvature_per_m: f64,
}

/// A driver on the way.
pub struct Follower<'a> {
    waypoints: &'a [Waypoint],
    turn_radius_m: f64,
    /// The waypoint that is driven to.
    next: usize,
    /// How long the vehicle still stands where it is (s).
    stands_s: f64,
}

impl<'a> Follower<'a> {
    pub fn new(waypoints: &'a [Waypoint], turn_radius_m: f64) -> Self {
        let stands_s = waypoints.first().map_or(0.0, |first| first.stand_s);
        Self { waypoints, turn_radius_m, next: 1, stands_s }
    }

    /// At the first waypoint, facing the next one that is elsewhere.
    pub fn start(&self) -> Planar {
        let Some(first) = self.waypoints.first() else { return Planar::default() };
        let away = self.waypoints.iter().map(|other| other.place_m() - first.place_m());
        let heading_rad = away
            .into_iter()
            .find(|away| away.norm() > 1e-6)
            .map_or(0.0, |away| away.y.atan2(away.x));
        Planar { x_m: first.x_m, y_m: first.y_m, heading_rad }
    }

    /// Whether the last waypoint is reached, and the vehicle does not stand there any longer.
    pub fn has_arrived(&self) -> bool {
        self.next >= self.waypoints.len() && self.stands_s <= 0.0
    }

    /// What the driver wants at a place, for the next piece of time (s).
    pub fn wish(&mut self, pose: &Planar, for_s: f64) -> Wish {
        let here_m = Vector2::new(pose.x_m, pose.y_m);
        let standing = self.stands_s > 0.0;
        self.stands_s -= for_s;
        while let Some(to) = self.waypoints.get(self.next).filter(|_| !standing) {
            let leg_m = to.place_m() - self.waypoints[self.next - 1].place_m();
            // What is left of the leg, seen along it.
            let left_m =
                (to.place_m() - here_m).dot(&leg_m.try_normalize(1e-9).unwrap_or_default());
            if left_m > 0.0 {
                break;
            }
            self.next += 1;
            self.stands_s = to.stand_s;
            if to.stand_s > 0.0 {
                break;
            }
        }
        let Some(to) = self.waypoints.get(self.next) else {
            return Wish { speed_m_per_s: 0.0, curvature_per_m: 0.0 };
        };
        let aim_m = self.aim_m(&here_m) - here_m;
        let aside_rad = wrap_to_pi(aim_m.y.atan2(aim_m.x) - pose.heading_rad);
        // The circle through here and there; behind, nothing is tight enough.
        let curvature_per_m = match aside_rad.cos() > 0.0 {
            true => 2.0 * aside_rad.sin() / aim_m.norm().max(0.1),
            false => f64::INFINITY.copysign(aside_rad),
        };
        let most = 1.0 / self.turn_radius_m;
        Wish {
            speed_m_per_s: if standing || self.stands_s > 0.0 { 0.0 } else { to.speed_m_per_s },
            curvature_per_m: curvature_per_m.clamp(-most, most),
        }
    }

    /// The point on the way that is aimed at from a place (m); beyond the last waypoint it goes straight on.
    fn aim_m(&self, here_m: &Vector2<f64>) -> Vector2<f64> {
        let mut from_m = self.waypoints[self.next - 1].place_m();
        let mut ahead_m = AHEAD_M;
        let mut along = Vector2::x();
        for (index, to) in self.waypoints.iter().enumerate().skip(self.next) {
            let leg_m = to.place_m() - from_m;
            let length_m = leg_m.norm();
            if length_m > 1e-9 {
                along = leg_m / length_m;
                // Only the leg that is driven on is partly behind.
                let behind_m = match index == self.next {
                    true => (here_m - from_m).dot(&along).clamp(0.0, length_m),
                    false => 0.0,
                };
                if behind_m + ahead_m <= length_m {
                    return from_m + along * (behind_m + ahead_m);
                }
                ahead_m -= length_m - behind_m;
            }
            from_m = to.place_m();
        }
        from_m + along * ahead_m
    }
}
