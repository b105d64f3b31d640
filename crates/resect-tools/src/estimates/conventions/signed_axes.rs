//! Permutations of the three axes with signs.

use nalgebra::{Matrix3, Vector3};

/// Axes of a frame in terms of those of a file: `y,x,-z` swaps the first two and reverses the third.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SignedAxes {
    /// Number of the file's axis (1 to 3) that becomes x, y and z, negative if it is reversed.
    axes: [i8; 3],
}

/// World frames with names, as axes of east-north-up. All but `optical` are the common ones of navigation.
const NAMED: [(&str, [i8; 3]); 3] =
    [("ned", [2, 1, -3]), ("nwu", [-2, 1, 3]), ("optical", [3, -1, -2])];

impl SignedAxes {
    pub const AS_READ: Self = Self { axes: [1, 2, 3] };

    /// Returns the axes of a name such as `ned`, or of letters such as `yx-z`; `None` if an axis is missing.
    pub fn parse(text: &str) -> Option<Self> {
        if let Some((_, axes)) = NAMED.iter().find(|(name, _)| *name == text) {
            return Some(Self { axes: *axes });
        }
        let (mut axes, mut count, mut sign) = ([0; 3], 0, 1);
        for letter in text.chars() {
            match letter {
                '-' => sign = -1,
                '+' => sign = 1,
                'x' | 'y' | 'z' => {
                    let axis = letter as i8 - 'x' as i8 + 1;
                    if axes.contains(&axis) || axes.contains(&-axis) {
                        return None;
                    }
                    *axes.get_mut(count)? = sign * axis;
                    (count, sign) = (count + 1, 1);
                }
                _ => return None,
            }
        }
        (count == 3).then_some(Self { axes })
    }

    /// Returns true for axes as read, and for those with a name.
    pub fn has_name(self) -> bool {
        self == Self::AS_READ || NAMED.iter().any(|(_, axes)| *axes == self.axes)
    }

    /// Returns the name, or the letters.
    pub fn in_letters(self) -> String {
        if let Some((name, _)) = NAMED.iter().find(|(_, axes)| *axes == self.axes) {
            return (*name).to_owned();
        }
        let letter = |axis: i8| {
            let sign = if axis < 0 { "-" } else { "" };
            format!("{sign}{}", ["x", "y", "z"][axis.unsigned_abs() as usize - 1])
        };
        self.axes.map(letter).concat()
    }

    /// Returns the matrix that transforms the coordinates of the file.
    pub fn matrix(self) -> Matrix3<f64> {
        let row = |axis: i8| {
            let mut row = Vector3::zeros();
            row[axis.unsigned_abs() as usize - 1] = f64::from(axis.signum());
            row.transpose()
        };
        Matrix3::from_rows(&self.axes.map(row))
    }

    /// Returns these axes, and then others in terms of them.
    pub fn then(self, other: Self) -> Self {
        let axis = |axis: i8| axis.signum() * self.axes[axis.unsigned_abs() as usize - 1];
        Self { axes: other.axes.map(axis) }
    }

    /// Returns true if the axes remain right-handed.
    pub fn is_rotation(self) -> bool {
        self.matrix().determinant() > 0.0
    }

    /// Returns all 24 rotations: as read, those with names, then the others.
    pub fn rotations() -> Vec<Self> {
        let mut all = vec![Self::AS_READ];
        all.extend(NAMED.map(|(_, axes)| Self { axes }));
        for order in [[1, 2, 3], [1, 3, 2], [2, 1, 3], [2, 3, 1], [3, 1, 2], [3, 2, 1]] {
            for signs in 0..8 {
                let mut axes: [i8; 3] = order;
                (0..3).filter(|axis| signs >> axis & 1 == 1).for_each(|axis| axes[axis] *= -1);
                let axes = Self { axes };
                if axes.is_rotation() && !all.contains(&axes) {
                    all.push(axes);
                }
            }
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_have_letters_and_names() {
        for (text, row) in [("yx-z", [1.0, 2.0, -3.0]), ("ned", [1.0, 2.0, -3.0])] {
            let axes = SignedAxes::parse(text).expect(text);
            assert_eq!(axes.matrix() * Vector3::new(2.0, 1.0, 3.0), Vector3::from(row));
            assert_eq!(axes.in_letters(), "ned");
        }
        assert_eq!(SignedAxes::parse("-zy+x").expect("axes").in_letters(), "-zyx");
        let [first, second] = ["yx-z", "-zyx"].map(|text| SignedAxes::parse(text).expect("axes"));
        assert_eq!(first.then(second).matrix(), second.matrix() * first.matrix());
        for text in ["", "xy", "xxy", "xyzx", "x-xz", "enu?"] {
            assert_eq!(SignedAxes::parse(text), None, "{text}");
        }
    }

    #[test]
    fn there_are_24_rotations_and_as_read_is_the_first() {
        let all = SignedAxes::rotations();
        assert_eq!((all.len(), all[0]), (24, SignedAxes::AS_READ));
        assert!(all.iter().all(|axes| axes.is_rotation()));
        assert!(!SignedAxes::parse("yxz").expect("axes").is_rotation());
    }
}
