//! A distance measured between two things in the scene.

use nalgebra::Vector3;

use super::units::Units;
use crate::deployment::{PAIRS, pair_label};

/// A distance that is measured in the scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ruler {
    pub active: bool,
    /// At most two.
    pub ends: Vec<RulerEnd>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct RulerEnd {
    /// In station 1's frame, when it was set.
    pub position_m: Vector3<f64>,
    /// What it snapped to, in words.
    pub what: String,
    /// A prism of the triangle at the cursor, 0 to 2: the end goes with it.
    pub prism: Option<usize>,
}

impl Ruler {
    /// With one more end; the third starts anew.
    pub fn with(&self, end: RulerEnd) -> Self {
        let mut ends = if self.ends.len() < 2 { self.ends.clone() } else { Vec::new() };
        ends.push(end);
        Self { active: self.active, ends }
    }

    /// What Esc does: first the ends go, then the ruler.
    pub fn escaped(&self) -> Self {
        Self { active: self.active && !self.ends.is_empty(), ends: Vec::new() }
    }

    /// Where its ends are now (m, in station 1's frame).
    pub fn ends_m(&self, prisms_m: Option<&[Vector3<f64>; 3]>) -> Vec<Vector3<f64>> {
        let now = |end: &RulerEnd| match (end.prism, prisms_m) {
            (Some(prism), Some(prisms_m)) => prisms_m[prism],
            _ => end.position_m,
        };
        self.ends.iter().map(now).collect()
    }

    /// What it says, in lines; empty until it has two ends.
    pub fn lines(
        &self,
        prisms_m: Option<&[Vector3<f64>; 3]>,
        inter_prism_m: Option<&[f64; 3]>,
        units: Units,
    ) -> Vec<String> {
        let [from_m, to_m] = self.ends_m(prisms_m)[..] else { return Vec::new() };
        let apart_m = to_m - from_m;
        let distance_m = apart_m.norm();
        let mut first = units.length_with_unit(distance_m);
        let pair = match (self.ends[0].prism, self.ends[1].prism) {
            (Some(a), Some(b)) => PAIRS.iter().position(|pair| *pair == (a.min(b), a.max(b))),
            _ => None,
        };
        if let Some(pair) = pair {
            first = format!("prisms {}: {first}", pair_label(pair));
            if let Some(known_m) = inter_prism_m.map(|all| all[pair]) {
                let off_mm = 1e3 * (distance_m - known_m);
                first += &format!(", rig {}, {off_mm:+.1} mm", units.length_with_unit(known_m));
            }
        }
        let second = format!(
            "horizontal {}, height {}",
            units.length_with_unit(apart_m.xy().norm()),
            if apart_m.z < 0.0 { "" } else { "+" }.to_owned() + &units.length_with_unit(apart_m.z)
        );
        vec![first, second]
    }
}
