//! Flags whose value is one of a few words, each explained in the help.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use resect_core::calibration::{Alignment, Method, PriorMethod};
use resect_core::pipeline::Interpolation;
use resect_io::gnss_solution::SolutionChoice;
use resect_report::named_transform::TransformFormat;
use resect_tools::estimates::{Plane, TrajectoryAlignment};
use resect_tools::experiment::Parameter;
use resect_tools::simulation::Preset;

/// Values with their words and their help (may be empty).
type Choices<T> = &'static [(T, &'static str, &'static str)];

/// Parses one of the words, or the letter with which its help begins: "B: static control points".
pub fn choice<T>(choices: Choices<T>) -> impl TypedValueParser<Value = T>
where
    T: Copy + Send + Sync + 'static,
{
    let words = choices.iter().map(|(_, word, help)| match *help {
        "" => PossibleValue::new(*word),
        help => PossibleValue::new(*word).help(help).aliases(letter(help)),
    });
    PossibleValuesParser::new(words).map(move |word| {
        let chosen =
            choices.iter().find(|(_, own, help)| *own == word || letter(help) == Some(&*word));
        chosen.expect("clap accepts these words only").0
    })
}

fn letter(help: &str) -> Option<&str> {
    help.split_once(": ").map(|(letter, _)| letter).filter(|letter| letter.len() == 1)
}

pub const METHODS: Choices<Method> = &[
    (Method::TwoPoint, "two-point", "A: two points whose relative position is known"),
    (Method::StaticGcp, "static-gcp", "B: static control points"),
    (Method::DynamicGcp, "dynamic-gcp", "C: one moving prism that all stations follow"),
    (Method::InterPrism, "inter-prism", "D: prisms of a rig with known distances"),
    (
        Method::Joint,
        "joint",
        "Beyond the paper: clocks and instrument errors are estimated with the transforms, for one prism or several",
    ),
];

pub const INTERPOLATIONS: Choices<Interpolation> = &[
    (Interpolation::Linear, "linear", "Straight lines between readings"),
    (
        Interpolation::Gp,
        "gp",
        "Gaussian process with a squared-exponential kernel and learned noise",
    ),
    (
        Interpolation::Wnoa,
        "wnoa",
        "Gaussian process with white noise on acceleration: the motion model",
    ),
];

pub const PRIORS: Choices<PriorMethod> = &[
    (
        PriorMethod::ClosedForm,
        "closed-form",
        "One small linear least squares per pair; needs no guess",
    ),
    (PriorMethod::Search, "search", "The paper's two-step search over the speed limit τ_v"),
];

pub const ALIGNMENTS: Choices<Alignment> = &[
    (Alignment::Level, "level", "Translation and yaw: the stations are levelled"),
    (Alignment::Rigid, "rigid", "Roll and pitch as well"),
];

pub const ESTIMATE_ALIGNMENTS: Choices<TrajectoryAlignment> = &[
    (TrajectoryAlignment::None, "none", "Nothing: the estimate is in the ground truth's frame"),
    (TrajectoryAlignment::Rigid, "rigid", "A rotation and a translation (evo's `--align`)"),
    (
        TrajectoryAlignment::Similarity,
        "similarity",
        "A scale too, for one camera alone (evo's `--align --correct_scale`)",
    ),
];

pub const PLANES: Choices<Plane> =
    &[(Plane::Xy, "xy", ""), (Plane::Xz, "xz", ""), (Plane::Yz, "yz", "")];

pub const SOLUTIONS: Choices<SolutionChoice> = &[
    (SolutionChoice::Best, "best", "The most accurate kind in the file: fixed, if there is any"),
    (SolutionChoice::Float, "float", "Fixed and float, each with its σ"),
    (SolutionChoice::All, "all", "All kinds, each with its σ"),
];

pub const PARAMETERS: Choices<Parameter> = &[
    (Parameter::TauR, "tau-r", ""),
    (Parameter::TauA, "tau-a", ""),
    (Parameter::TauE, "tau-e", ""),
    (Parameter::TauS, "tau-s", ""),
    (Parameter::TauL, "tau-l", ""),
    (Parameter::Rate, "rate", ""),
];

pub const PRESETS: Choices<Preset> = &[
    (
        Preset::Warthog,
        "warthog",
        "A Warthog-like rig (about 0.9, 0.8 and 1.0 m) wandering over uneven ground, with control points",
    ),
    (Preset::Hd2Tunnel, "hd2-tunnel", "A small HD2-like rig (0.35 m) up and down a tunnel"),
    (
        Preset::FlatFloor,
        "flat-floor",
        "The Warthog on flat ground, where only the rig resolves the mirror ambiguity",
    ),
    (Preset::UnevenGround, "uneven-ground", "The Warthog where it pitches and rolls more"),
    (Preset::SinglePrism, "single-prism", "One prism that all stations follow, for method C"),
    (Preset::FigureEight, "figure-eight", "Figure-eights: turns to both sides"),
    (
        Preset::ShortBaselines,
        "short-baselines",
        "Figure-eights with prisms a hand's breadth apart: each millimetre of a distance matters",
    ),
    (
        Preset::StraightLine,
        "straight-line",
        "One straight line on flat ground: most directions are not observable",
    ),
    (Preset::Circle, "circle", "Circles on flat ground"),
    (Preset::LShape, "l-shape", "Two straight legs on flat ground with one turn between them"),
    (
        Preset::FieldErrors,
        "field-errors",
        "The Warthog with all errors of real instruments, drawn from the seed with the sizes seen in the field",
    ),
];

pub const TRANSFORM_FORMATS: Choices<TransformFormat> = &[
    (TransformFormat::Urdf, TransformFormat::Urdf.name(), "A fixed joint of a robot description"),
    (
        TransformFormat::Ros2,
        TransformFormat::Ros2.name(),
        "The command static_transform_publisher of ROS 2",
    ),
    (
        TransformFormat::Ros1,
        TransformFormat::Ros1.name(),
        "The command static_transform_publisher of ROS 1",
    ),
    (TransformFormat::Matrix, TransformFormat::Matrix.name(), "A 4×4 matrix"),
    (TransformFormat::Numpy, TransformFormat::Numpy.name(), "A 4×4 matrix in Python's syntax"),
    (TransformFormat::Quaternion, TransformFormat::Quaternion.name(), "x y z qx qy qz qw"),
];

#[cfg(test)]
mod tests {
    use super::*;

    /// Fails if a method or preset is missing here, or if its word differs from its name elsewhere.
    #[test]
    fn every_value_has_its_own_name_as_a_word() {
        fn check<T: Copy + PartialEq + std::fmt::Debug>(
            choices: Choices<T>,
            all: &[T],
            name: impl Fn(T) -> &'static str,
        ) {
            assert_eq!(choices.iter().map(|(value, ..)| *value).collect::<Vec<_>>(), all);
            assert!(choices.iter().all(|(value, word, _)| name(*value) == *word), "{choices:?}");
        }
        check(METHODS, &Method::ALL, Method::name);
        check(PRESETS, &Preset::ALL, Preset::name);
        check(PARAMETERS, &Parameter::ALL, Parameter::flag);
        check(INTERPOLATIONS, &Interpolation::ALL, Interpolation::name);
    }
}
