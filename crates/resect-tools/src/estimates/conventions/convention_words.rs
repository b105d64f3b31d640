//! Conventions as words: `wxyz,inverse,cm`.

use std::fmt::{self, Display};
use std::str::FromStr;

use super::convention::{AngleConvention, Convention, Inverted};
use super::left_out_poses::HeldPart;
use super::signed_axes::SignedAxes;

/// Units of length (m).
const LENGTHS: [(&str, f64); 5] =
    [("mm", 1e-3), ("cm", 1e-2), ("km", 1e3), ("in", 0.0254), ("ft", 0.3048)];
/// Units of time (s).
const TIMES: [(&str, f64); 3] = [("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)];
/// The words that a message offers.
pub const WORDS: &str = "give words separated by commas: wxyz, euler=xyz|clockwise, left-handed, inverse, inverse-poses, world=ned|nwu|optical|AXES, axes=AXES, \
    mm|cm|km|in|ft, length=FACTOR, ms|us|ns, time=FACTOR, held|held=positions|held=orientations, unset; AXES are letters such as yx-z";

impl FromStr for Convention {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut convention = Self::AS_READ;
        for word in text.split(',').map(str::trim).filter(|word| !word.is_empty()) {
            convention.add(word).ok_or_else(|| format!("`{word}` is no convention; {WORDS}"))?;
        }
        Ok(convention)
    }
}

impl Convention {
    fn add(&mut self, word: &str) -> Option<()> {
        let factor = |text: &str| {
            text.parse().ok().filter(|factor: &f64| factor.is_finite() && *factor > 0.0)
        };
        let unit = |units: &[(&str, f64)], text: &str| {
            units.iter().find(|(name, _)| *name == text).map(|(_, factor)| *factor)
        };
        match word.split_once('=') {
            None if word == "xyzw" => {}
            None if word == "wxyz" => self.has_w_first = true,
            None if word == "left-handed" => self.is_left_handed = true,
            None if word == "inverse" => self.inverted = Inverted::Orientations,
            None if word == "inverse-poses" => self.inverted = Inverted::Poses,
            None if word == HeldPart::Pose.word() => self.held = Some(HeldPart::Pose),
            None if word == "unset" => self.has_unset_poses = true,
            None => match (unit(&LENGTHS, word), unit(&TIMES, word)) {
                (Some(length_m), _) => self.length_m = length_m,
                (None, time_s) => self.time_s = time_s?,
            },
            Some(("held", "positions")) => self.held = Some(HeldPart::Position),
            Some(("held", "orientations")) => self.held = Some(HeldPart::Orientation),
            Some(("euler", "xyz")) => self.angles = AngleConvention::Xyz,
            Some(("euler", "clockwise")) => self.angles = AngleConvention::Clockwise,
            Some(("world", axes)) => {
                self.world_axes = SignedAxes::parse(axes).filter(|axes| axes.is_rotation())?;
            }
            Some(("axes", axes)) => self.position_axes = SignedAxes::parse(axes)?,
            Some(("length", text)) => {
                self.length_m = unit(&LENGTHS, text).or_else(|| factor(text))?;
            }
            Some(("time", text)) => self.time_s = unit(&TIMES, text).or_else(|| factor(text))?,
            Some(_) => return None,
        }
        Some(())
    }
}

/// Rounds a factor to seven digits.
fn rounded(factor: f64) -> f64 {
    format!("{factor:.6e}").parse().unwrap_or(factor)
}

impl Display for Convention {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let unit = |units: &[(&str, f64)], name: &str, factor: f64| {
            let known = units.iter().find(|(_, known)| *known == factor);
            known.map_or_else(|| format!("{name}={factor}"), |(unit, _)| (*unit).to_owned())
        };
        let mut words: Vec<String> = Vec::new();
        words.extend(self.has_w_first.then(|| "wxyz".to_owned()));
        words.extend(match self.angles {
            AngleConvention::AsRead => None,
            AngleConvention::Xyz => Some("euler=xyz".to_owned()),
            AngleConvention::Clockwise => Some("euler=clockwise".to_owned()),
        });
        words.extend(self.is_left_handed.then(|| "left-handed".to_owned()));
        words.extend(match self.inverted {
            Inverted::Nothing => None,
            Inverted::Orientations => Some("inverse".to_owned()),
            Inverted::Poses => Some("inverse-poses".to_owned()),
        });
        for (name, axes) in [("world", self.world_axes), ("axes", self.position_axes)] {
            let differs = axes != SignedAxes::AS_READ;
            words.extend(differs.then(|| format!("{name}={}", axes.in_letters())));
        }
        words.extend(
            (self.length_m != 1.0).then(|| unit(&LENGTHS, "length", rounded(self.length_m))),
        );
        words.extend((self.time_s != 1.0).then(|| unit(&TIMES, "time", rounded(self.time_s))));
        words.extend(self.held.map(|part| part.word().to_owned()));
        words.extend(self.has_unset_poses.then(|| "unset".to_owned()));
        formatter.write_str(&words.join(","))
    }
}

impl From<Convention> for String {
    fn from(convention: Convention) -> Self {
        convention.to_string()
    }
}

impl TryFrom<String> for Convention {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

/// States a convention of orientations for a message: "read as w x y z in a world of axes ned".
pub fn orientation_in_words(convention: &Convention) -> String {
    let order = match convention.angles {
        AngleConvention::AsRead if convention.has_w_first => "read as w x y z",
        AngleConvention::AsRead => "read as x y z w",
        AngleConvention::Xyz => "read as roll, pitch and yaw about the moving axes x, y, z",
        AngleConvention::Clockwise => "read with a yaw that grows clockwise",
    };
    let inverse = match convention.inverted {
        Inverted::Nothing => "",
        Inverted::Orientations | Inverted::Poses => " of the world in the body",
    };
    let world = match convention.world_axes {
        SignedAxes::AS_READ => String::new(),
        axes => format!(" in a world with the axes {} of that of the positions", axes.in_letters()),
    };
    format!("{order}{inverse}{world}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_conventions_are_the_same() {
        for text in [
            "",
            "wxyz",
            "wxyz,inverse,world=ned,cm,ns",
            "inverse-poses,axes=yxz,length=0.9996,time=2,held,unset",
            "world=-zyx",
            "euler=xyz,left-handed,cm",
            "euler=clockwise,held=positions",
            "held=orientations,unset",
        ] {
            let convention: Convention = text.parse().expect(text);
            assert_eq!(convention.to_string(), text);
        }
        assert_eq!("xyzw, ".parse(), Ok(Convention::AS_READ));
        for text in ["wxyz inverse", "world=yxz", "world=", "cm=2", "length=0", "time=nan", "enu"] {
            assert!(text.parse::<Convention>().is_err_and(|why| why.contains("wxyz")), "{text}");
        }
    }
}
