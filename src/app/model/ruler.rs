//! A distance measured between two points in the scene.

use nalgebra::Vector3;
use resect_core::network::{Pair, PerPair, PerPrism, Prism};

use super::units::Units;

/// A ruler in the scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ruler {
    pub active: bool,
    /// The set ends, at most two.
    pub ends: Vec<RulerEnd>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct RulerEnd {
    /// Position of the end when it was set (m, station 1's frame).
    pub position_m: Vector3<f64>,
    /// Name of the object that the end snapped to.
    pub what: String,
    /// Prism at the cursor with which the end moves.
    pub prism: Option<Prism>,
}

impl Ruler {
    /// Returns the ruler with one more end; a third end starts a new measurement.
    pub fn with(&self, end: RulerEnd) -> Self {
        let mut ends = if self.ends.len() < 2 { self.ends.clone() } else { Vec::new() };
        ends.push(end);
        Self { active: self.active, ends }
    }

    /// Returns the ruler after Esc, which first removes the ends, then the ruler.
    pub fn escaped(&self) -> Self {
        Self { active: self.active && !self.ends.is_empty(), ends: Vec::new() }
    }

    /// Returns the present positions of the ends (m, station 1's frame).
    pub fn ends_m(&self, prisms_m: Option<&PerPrism<Vector3<f64>>>) -> Vec<Vector3<f64>> {
        let now = |end: &RulerEnd| match (end.prism, prisms_m) {
            (Some(prism), Some(prisms_m)) => *prisms_m.get(prism).unwrap_or(&end.position_m),
            _ => end.position_m,
        };
        self.ends.iter().map(now).collect()
    }

    /// Returns the lines of the label; empty until both ends are set.
    pub fn lines(
        &self,
        prisms_m: Option<&PerPrism<Vector3<f64>>>,
        inter_prism_m: Option<&PerPair<f64>>,
        units: Units,
    ) -> Vec<String> {
        let [from_m, to_m] = self.ends_m(prisms_m)[..] else { return Vec::new() };
        let apart_m = to_m - from_m;
        let distance_m = apart_m.norm();
        let mut first = units.length_with_unit(distance_m);
        let ends = (self.ends[0].prism, self.ends[1].prism);
        let pair = if let (Some(a), Some(b)) = ends { Pair::between(a, b) } else { None };
        if let Some(pair) = pair {
            first = format!("prisms {pair}: {first}");
            if let Some(known_m) = inter_prism_m.and_then(|all_m| all_m.get(pair)) {
                let off_mm = 1e3 * (distance_m - known_m);
                first += &format!(", rig {}, {off_mm:+.1} mm", units.length_with_unit(*known_m));
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

#[cfg(test)]
mod tests {
    use super::*;
    use resect_core::network::Number;

    fn end(position_m: [f64; 3], prism: Option<usize>) -> RulerEnd {
        let prism = prism.map(Prism::at);
        RulerEnd { position_m: position_m.into(), what: String::new(), prism }
    }

    #[test]
    fn it_says_distance_parts_and_for_two_prisms_what_the_rig_says() {
        let units = Units::default();
        let ruler = Ruler { active: true, ends: Vec::new() };
        let ruler = ruler.with(end([1.0, 2.0, 3.0], None));
        assert!(ruler.lines(None, None, units).is_empty());
        let ruler = ruler.with(end([4.0, 6.0, 1.0], None));
        assert_eq!(
            ruler.lines(None, None, units),
            ["5.3852 m", "horizontal 5.0000 m, height -2.0000 m"]
        );
        // The ends move with the prisms after they are set.
        let prisms = [[0.0; 3], [0.9031, 0.0, 0.0], [0.0, 0.5, 0.0]].map(Vector3::from).into();
        let ruler = Ruler::default().with(end([7.0; 3], Some(1))).with(end([9.0; 3], Some(0)));
        assert_eq!(
            ruler.lines(Some(&prisms), Some(&[0.9021, 0.5, 1.0].into()), units)[0],
            "prisms 1–2: 0.9031 m, rig 0.9021 m, +1.0 mm"
        );
        // A prism with itself is no pair.
        let ruler = Ruler::default().with(end([7.0; 3], Some(1))).with(end([9.0; 3], Some(1)));
        assert_eq!(ruler.lines(Some(&prisms), Some(&[1.0; 3].into()), units)[0], "0.0000 m");
    }

    #[test]
    fn a_third_end_starts_anew_and_esc_goes_back() {
        let mut ruler = Ruler { active: true, ends: Vec::new() };
        for _ in 0..3 {
            ruler = ruler.with(end([0.0; 3], None));
        }
        assert_eq!(ruler.ends.len(), 1);
        let cleared = ruler.escaped();
        assert!(cleared.active && cleared.ends.is_empty());
        assert!(!cleared.escaped().active);
    }
}
